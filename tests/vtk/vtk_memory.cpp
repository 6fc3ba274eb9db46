// SPDX-License-Identifier: Apache-2.0
// Reading a file takes no more memory than its arrays and what is kept of them, and keeps nothing twice. Each file is
// read by a process of its own, whose peak the kernel knows.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetWriter.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <tetcast/dataset.h>
#include <tetcast/volume.h>

#include "gmsh_file.h"

namespace {

constexpr int N = 64;
constexpr double megabyte = 1 << 20;

struct Peak {
  double read, kept, after; // bytes: most while reading; with the dataset; when it is gone and a volume made
};

// n³ cubes, or 6 n³ tetrahedra, with an array over the points and one over the cells.
vtkSmartPointer<vtkUnstructuredGrid> grid_of(int n, bool tetrahedra) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  const vtkIdType m = n + 1, step[3] = {1, m, m * m};
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> s, c;
  s->SetName("s");
  c->SetName("c");
  for (vtkIdType i = 0; i < m * m * m; ++i) {
    points->InsertNextPoint(static_cast<double>(i % m), static_cast<double>(i / m % m),
                            static_cast<double>(i / (m * m)));
    s->InsertNextValue(static_cast<double>(i));
  }
  vtkNew<vtkCellArray> cells;
  for (vtkIdType i = 0; i < vtkIdType{n} * n * n; ++i) {
    const vtkIdType a = i % n + i / n % n * m + i / (vtkIdType{n} * n) * m * m;
    if (!tetrahedra) {
      const vtkIdType corners[8] = {a,         a + 1,         a + m + 1,         a + m,
                                    a + m * m, a + m * m + 1, a + m * m + m + 1, a + m * m + m};
      cells->InsertNextCell(8, corners);
    }
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int t = 0; tetrahedra && t < 6; ++t) {
      vtkIdType corners[4] = {a, 0, 0, 0};
      for (int k = 0; k < 3; ++k)
        corners[k + 1] = corners[k] + step[order[t][k]];
      cells->InsertNextCell(4, corners);
    }
  }
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i)
    c->InsertNextValue(static_cast<double>(i));
  grid->SetPoints(points);
  grid->SetCells(tetrahedra ? VTK_TETRA : VTK_HEXAHEDRON, cells);
  grid->GetPointData()->AddArray(s);
  grid->GetCellData()->AddArray(c);
  return grid;
}

void write_vtu(int n, bool tetrahedra, bool compressed, const std::string &path) {
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(grid_of(n, tetrahedra));
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  if (!compressed)
    writer->SetCompressorTypeToNone();
  writer->Write();
}

void write_legacy(int n, const std::string &path) {
  vtkNew<vtkDataSetWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(grid_of(n, true));
  writer->SetFileTypeToBinary();
  writer->Write();
}

void write_gmsh(int n, const std::string &path) {
  const auto grid = grid_of(n, true);
  const vtkIdType points = grid->GetNumberOfPoints(), cells = grid->GetNumberOfCells();
  std::vector<double> flat(static_cast<size_t>(3 * points));
  std::vector<int64_t> tags(static_cast<size_t>(points)), nodes(static_cast<size_t>(4 * cells));
  std::vector<GmshElement> elements(static_cast<size_t>(cells));
  for (vtkIdType i = 0; i < points; ++i) {
    grid->GetPoint(i, &flat[static_cast<size_t>(3 * i)]);
    tags[static_cast<size_t>(i)] = i + 1;
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < cells; ++i) {
    const auto at = static_cast<size_t>(i);
    grid->GetCellPoints(i, corners);
    for (size_t k = 0; k < 4; ++k)
      nodes[4 * at + k] = corners->GetId(static_cast<vtkIdType>(k)) + 1;
    elements[at] = {i + 1, 4, 4, 1, 0, &nodes[4 * at]};
  }
  GmshFile to = gmsh_open(path.c_str(), 4, GMSH_LITTLE);
  gmsh_nodes(&to, points, tags.data(), reinterpret_cast<const double(*)[3]>(flat.data()), 0);
  gmsh_elements(&to, cells, elements.data());
  gmsh_data(&to, "NodeData", "s", 0, 1, points, tags.data(), 0, flat.data());
  std::fclose(to.file);
}

double status_of(const char *name) {
  FILE *file = std::fopen("/proc/self/status", "r");
  char line[256];
  double bytes = 0;
  while (file && std::fgets(line, sizeof line, file)) {
    if (std::strncmp(line, name, std::strlen(name)) == 0)
      bytes = std::atof(line + std::strlen(name)) * 1024;
  }
  if (file)
    std::fclose(file);
  return bytes;
}

// Runs in a process of its own; false: something is wrong there.
template <typename T> bool apart(T *result, const std::function<bool(T *)> &work) {
  int ends[2];
  if (pipe(ends) != 0)
    return false;
  const pid_t child = fork();
  if (child == 0) {
    T own = {};
    const bool good = work(&own) && write(ends[1], &own, sizeof own) == sizeof own;
    _exit(good ? 0 : 1);
  }
  close(ends[1]);
  const bool good = child > 0 && read(ends[0], result, sizeof *result) == sizeof *result;
  close(ends[0]);
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0 && good;
}

bool measure(const std::string &small, const std::string &path, Peak *peak) {
  TetcastContextDesc desc = tetcast_context_desc_default();
  TetcastContext *context = nullptr;
  TetcastDataset *dataset = nullptr;
  TetcastMesh *mesh = nullptr;
  TetcastVolume *volume = nullptr;
  if (tetcast_context_create(&desc, &context) != TETCAST_OK)
    return false;
  if (tetcast_dataset_read(context, small.c_str(), nullptr, &dataset) != TETCAST_OK)
    return false; // loads all that there is to load
  tetcast_dataset_destroy(&dataset);
  const double before = status_of("VmRSS:");
  if (tetcast_dataset_read(context, path.c_str(), nullptr, &dataset) != TETCAST_OK)
    return false;
  peak->read = status_of("VmHWM:") - before;
  peak->kept = status_of("VmRSS:") - before;
  if (tetcast_dataset_mesh(dataset, &mesh) != TETCAST_OK ||
      tetcast_volume_create(context, mesh, nullptr, &volume) != TETCAST_OK)
    return false;
  tetcast_mesh_destroy(&mesh);
  tetcast_dataset_destroy(&dataset);
  TetcastVolumeInfo info;
  tetcast_volume_info(volume, &info);
  peak->after = status_of("VmRSS:") - before - static_cast<double>(info.bytes);
  tetcast_volume_destroy(&volume);
  tetcast_context_destroy(&context);
  return true;
}

} // namespace

int main() {
#ifdef __SANITIZE_ADDRESS__
  std::puts("skipped: a sanitizer holds memory back");
  return 77;
#endif
  if (status_of("VmHWM:") == 0) {
    std::puts("skipped: the kernel does not tell a process's peak");
    return 77;
  }
  const char *temporary = std::getenv("TMPDIR");
  std::string folder = std::string(temporary ? temporary : "/tmp") + "/tetcast-memory-XXXXXX";
  if (!mkdtemp(&folder[0]))
    return 1;
  const double cubes = N * N * N, points = (N + 1) * (N + 1) * (N + 1), tets = 6 * cubes;
  const double tet_arrays = 32 * points + tets * (32 + 8 + 1 + 8), cube_arrays = 32 * points + cubes * (64 + 8 + 1 + 8);
  const double tet_kept = 32 * points + tets * (32 + 8), cube_kept = 32 * points + cubes * 8 + tets * (16 + 4);
  const struct {
    const char *name;
    std::function<void(int, const std::string &)> write;
    double read, kept; // bytes that it may take
  } cases[] = {
      {"raw.vtu", [](int n, const std::string &path) { write_vtu(n, true, false, path); }, tet_arrays, tet_kept},
      {"compressed.vtu", [](int n, const std::string &path) { write_vtu(n, true, true, path); }, tet_arrays, tet_kept},
      {"legacy.vtk", [](int n, const std::string &path) { write_legacy(n, path); }, tet_arrays, tet_kept},
      {"cubes.vtu", [](int n, const std::string &path) { write_vtu(n, false, false, path); }, cube_arrays + cube_kept,
       cube_kept},
      {"mesh.msh", [](int n, const std::string &path) { write_gmsh(n, path); }, 40 * points + 56 * tets + tet_arrays,
       tet_kept},
  };
  int failures = 0;
  for (const auto &one : cases) {
    const std::string small = folder + "/small-" + one.name, large = folder + "/" + one.name;
    bool done = false;
    Peak peak = {};
    const bool good = apart<bool>(&done,
                                  [&](bool *) {
                                    one.write(3, small);
                                    one.write(N, large);
                                    return true;
                                  }) &&
                      apart<Peak>(&peak, [&](Peak *result) { return measure(small, large, result); });
    const double slack = 5 * megabyte; // of allocators
    const bool right = good && peak.read <= 1.02 * one.read + slack && peak.kept <= 1.02 * one.kept + slack &&
                       peak.after <= slack + 5 * megabyte;
    std::printf("%-15s read %6.1f of %6.1f MB, kept %6.1f of %6.1f, after %6.1f%s\n", one.name, peak.read / megabyte,
                one.read / megabyte, peak.kept / megabyte, one.kept / megabyte, peak.after / megabyte,
                right ? "" : ": WRONG");
    failures += !right;
    unlink(small.c_str());
    unlink(large.c_str());
  }
  rmdir(folder.c_str());
  return failures != 0;
}
