// SPDX-License-Identifier: Apache-2.0
#include "cell_files.hpp"

#include <cstdio>
#include <map>
#include <numeric>

#include <sys/stat.h>

#include <vtkCell.h>
#include <vtkCellType.h>
#include <vtkDataSetWriter.h>
#include <vtkDoubleArray.h>
#include <vtkGenericCell.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyhedron.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataSetWriter.h>

#ifdef SAMPLES_EXODUS
#include <vtkExodusIIWriter.h>
#endif
#ifdef SAMPLES_CGNS
#include <vtk_cgns.h>
#include VTK_CGNS(cgnslib.h)
#endif
#ifdef SAMPLES_HDF
#include <vtk_hdf5.h>
#endif

#include "gmsh_file.h"

double value_at(const std::array<double, 3> &p) {
  return p[0] + 2 * p[1] + 4 * p[2];
}

namespace {

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;
using Order = std::vector<int>; // the place of node k of another program in VTK's order

// The cell of fixed order with the same nodes as a Lagrange or Bezier one of second order.
int fixed_type(int type) {
  switch (type) {
  case VTK_LAGRANGE_TETRAHEDRON:
  case VTK_BEZIER_TETRAHEDRON:
    return VTK_QUADRATIC_TETRA;
  case VTK_LAGRANGE_HEXAHEDRON:
  case VTK_BEZIER_HEXAHEDRON:
    return VTK_TRIQUADRATIC_HEXAHEDRON;
  case VTK_LAGRANGE_WEDGE:
  case VTK_BEZIER_WEDGE:
    return VTK_BIQUADRATIC_QUADRATIC_WEDGE;
  case VTK_POLYHEDRON:
    return VTK_PENTAGONAL_PRISM;
  default:
    return type;
  }
}

Grid grid_of(const CellSample &cell) {
  auto grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> s;
  s->SetName("s");
  std::vector<vtkIdType> ids;
  for (const auto &p : cell.points) {
    ids.push_back(points->InsertNextPoint(p.data()));
    s->InsertNextValue(value_at(p));
  }
  grid->SetPoints(points);
  grid->Allocate(1);
  if (cell.type == VTK_POLYHEDRON) {
    std::vector<vtkIdType> stream;
    for (const auto &face : cell.faces) {
      stream.push_back(static_cast<vtkIdType>(face.size()));
      stream.insert(stream.end(), face.begin(), face.end());
    }
    grid->InsertNextCell(VTK_POLYHEDRON, static_cast<vtkIdType>(ids.size()), ids.data(),
                         static_cast<vtkIdType>(cell.faces.size()), stream.data());
  } else {
    grid->InsertNextCell(cell.type, static_cast<vtkIdType>(ids.size()), ids.data());
  }
  grid->GetPointData()->SetScalars(s);
  return grid;
}

FILE *create(const std::string &path) {
  FILE *file = std::fopen(path.c_str(), "w");
  if (!file)
    std::perror(path.c_str());
  return file;
}

void write_text(const std::string &path, const std::string &text) {
  FILE *file = create(path);
  std::fputs(text.c_str(), file);
  std::fclose(file);
}

// ── VTK's own ──

template <typename Writer> std::string by_vtk(vtkDataSet *grid, const std::string &path) {
  vtkNew<Writer> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(grid);
  return writer->Write() ? path : "";
}

std::string write_vtu(const CellSample &cell, const std::string &folder) {
  return by_vtk<vtkXMLDataSetWriter>(grid_of(cell), folder + "/a.vtu");
}
std::string write_legacy(const CellSample &cell, const std::string &folder) {
  return by_vtk<vtkDataSetWriter>(grid_of(cell), folder + "/a.vtk");
}

std::string write_list(const CellSample &cell, const std::string &folder, const char *name, const char *text) {
  write_vtu(cell, folder);
  write_text(folder + "/" + name, text);
  return folder + "/" + name;
}

std::string write_pieces(const CellSample &cell, const std::string &folder) {
  return write_list(cell, folder, "a.pvtu",
                    "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid GhostLevel=\"0\"><Piece "
                    "Source=\"a.vtu\"/></PUnstructuredGrid></VTKFile>\n");
}
std::string write_blocks(const CellSample &cell, const std::string &folder) {
  return write_list(cell, folder, "a.vtm",
                    "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><DataSet index=\"0\" "
                    "file=\"a.vtu\"/></vtkMultiBlockDataSet></VTKFile>\n");
}
std::string write_series(const CellSample &cell, const std::string &folder) {
  return write_list(cell, folder, "a.pvd",
                    "<VTKFile type=\"Collection\" version=\"0.1\"><Collection><DataSet timestep=\"1\" "
                    "file=\"a.vtu\"/></Collection></VTKFile>\n");
}

// Structured grids are of one kind of cell.
std::string write_structured(const CellSample &cell, const std::string &folder) {
  if (cell.type != VTK_HEXAHEDRON)
    return "";
  vtkNew<vtkImageData> image;
  image->SetDimensions(2, 2, 2);
  image->SetOrigin(cell.points[0].data());
  vtkNew<vtkDoubleArray> s;
  s->SetName("s");
  for (vtkIdType i = 0; i < 8; ++i) {
    const double *p = image->GetPoint(i);
    s->InsertNextValue(value_at({p[0], p[1], p[2]}));
  }
  image->GetPointData()->SetScalars(s);
  return by_vtk<vtkXMLDataSetWriter>(image, folder + "/a.vti");
}

// ── text ──

std::string write_tetgen(const CellSample &cell, const std::string &folder) {
  if (cell.type != VTK_TETRA)
    return "";
  FILE *file = create(folder + "/a.node");
  std::fprintf(file, "4 3 1 0\n");
  for (int i = 0; i < 4; ++i) {
    const auto &p = cell.points[static_cast<size_t>(i)];
    std::fprintf(file, "%d %.17g %.17g %.17g %.17g\n", i, p[0], p[1], p[2], value_at(p));
  }
  std::fclose(file);
  write_text(folder + "/a.ele", "1 4 0\n0 0 1 2 3\n");
  return folder + "/a.node";
}

std::string write_ensight(const CellSample &cell, const std::string &folder) {
  static const std::map<int, const char *> names = {{VTK_TETRA, "tetra4"},
                                                    {VTK_PYRAMID, "pyramid5"},
                                                    {VTK_WEDGE, "penta6"},
                                                    {VTK_HEXAHEDRON, "hexa8"},
                                                    {VTK_QUADRATIC_TETRA, "tetra10"},
                                                    {VTK_QUADRATIC_PYRAMID, "pyramid13"},
                                                    {VTK_QUADRATIC_WEDGE, "penta15"},
                                                    {VTK_QUADRATIC_HEXAHEDRON, "hexa20"},
                                                    {VTK_POLYHEDRON, "nfaced"}};
  const auto name = names.find(cell.type);
  if (name == names.end())
    return "";
  FILE *file = create(folder + "/a.geo");
  std::fprintf(file, "a\nb\nnode id assign\nelement id assign\npart\n         1\ncell\ncoordinates\n%10zu\n",
               cell.points.size());
  for (size_t k = 0; k < 3; ++k) {
    for (const auto &p : cell.points)
      std::fprintf(file, "%12.5e\n", p[k]);
  }
  std::fprintf(file, "%s\n%10d\n", name->second, 1);
  if (cell.type == VTK_POLYHEDRON) {
    std::fprintf(file, "%10zu\n", cell.faces.size());
    for (const auto &face : cell.faces)
      std::fprintf(file, "%10zu\n", face.size());
    for (const auto &face : cell.faces) {
      for (int corner : face)
        std::fprintf(file, "%10d", corner + 1);
      std::fprintf(file, "\n");
    }
  } else {
    for (size_t i = 0; i < cell.points.size(); ++i)
      std::fprintf(file, "%10zu", i + 1);
    std::fprintf(file, "\n");
  }
  std::fclose(file);
  file = create(folder + "/a.s");
  std::fprintf(file, "s\npart\n         1\ncoordinates\n");
  for (const auto &p : cell.points)
    std::fprintf(file, "%12.5e\n", value_at(p));
  std::fclose(file);
  write_text(folder + "/a.case",
             "FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: a.geo\n\nVARIABLE\nscalar per node: s a.s\n");
  return folder + "/a.case";
}

std::string write_openfoam(const CellSample &cell, const std::string &folder) {
  if (cell.faces.empty() || cell.type == VTK_VOXEL)
    return "";
  if (cell.type == VTK_PENTAGONAL_PRISM || cell.type == VTK_HEXAGONAL_PRISM)
    return ""; // are polyhedra there
  for (const char *name : {"/system", "/constant", "/constant/polyMesh", "/0"})
    mkdir((folder + name).c_str(), 0700);
  const auto head = [](const std::string &kind, const std::string &object) {
    return "FoamFile\n{\n version 2.0;\n format ascii;\n class " + kind + ";\n object " + object + ";\n}\n";
  };
  write_text(folder + "/system/controlDict", head("dictionary", "controlDict") +
                                                 "startFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime "
                                                 "1;\ndeltaT 1;\nwriteControl runTime;\nwriteInterval 1;\n");
  std::string points, faces, owners;
  for (const auto &p : cell.points)
    points += "(" + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + ")\n";
  for (const auto &face : cell.faces) {
    faces += std::to_string(face.size()) + "(";
    for (int corner : face)
      faces += std::to_string(corner) + " ";
    faces += ")\n";
    owners += "0\n";
  }
  const std::string mesh = folder + "/constant/polyMesh/", count = std::to_string(cell.faces.size());
  write_text(mesh + "points",
             head("vectorField", "points") + std::to_string(cell.points.size()) + "\n(\n" + points + ")\n");
  write_text(mesh + "faces", head("faceList", "faces") + count + "\n(\n" + faces + ")\n");
  write_text(mesh + "owner", head("labelList", "owner") + count + "\n(\n" + owners + ")\n");
  write_text(mesh + "neighbour", head("labelList", "neighbour") + "0\n(\n)\n");
  write_text(mesh + "boundary", head("polyBoundaryMesh", "boundary") + "1\n(\nwalls\n{\n type wall;\n nFaces " + count +
                                    ";\n startFace 0;\n}\n)\n");
  write_text(folder + "/0/p", head("volScalarField", "p") +
                                  "dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 7;\nboundaryField\n{\n "
                                  "walls\n {\n type zeroGradient;\n }\n}\n");
  write_text(folder + "/case.foam", "");
  return folder + "/case.foam";
}

Order same(size_t count) {
  Order order(count);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::string write_gmsh(const CellSample &cell, const std::string &folder) {
  struct Type {
    int gmsh;
    Order order;
  };
  static const std::map<int, Type> types = {
      {VTK_TETRA, {4, same(4)}},
      {VTK_HEXAHEDRON, {5, same(8)}},
      {VTK_WEDGE, {6, same(6)}},
      {VTK_PYRAMID, {7, same(5)}},
      {VTK_QUADRATIC_TETRA, {11, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}}},
      {VTK_TRIQUADRATIC_HEXAHEDRON,
       {12, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26}}},
      {VTK_BIQUADRATIC_QUADRATIC_WEDGE, {13, {0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10, 15, 17, 16}}},
      {VTK_TRIQUADRATIC_PYRAMID, {14, {0, 1, 2, 3, 4, 5, 8, 9, 6, 10, 7, 11, 12, 13}}},
      {VTK_QUADRATIC_HEXAHEDRON, {17, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14}}},
      {VTK_QUADRATIC_WEDGE, {18, {0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10}}},
      {VTK_QUADRATIC_PYRAMID, {19, {0, 1, 2, 3, 4, 5, 8, 9, 6, 10, 7, 11, 12}}}};
  const auto type = types.find(cell.type);
  if (type == types.end())
    return "";
  const std::string path = folder + "/a.msh";
  std::vector<int64_t> tags;
  std::vector<double> values;
  std::vector<double> flat;
  for (int k : type->second.order) {
    const auto &p = cell.points[static_cast<size_t>(k)];
    tags.push_back(static_cast<int64_t>(tags.size()) + 1);
    flat.insert(flat.end(), p.begin(), p.end());
    values.push_back(value_at(p));
  }
  const auto count = static_cast<int64_t>(tags.size());
  const GmshElement element = {1, type->second.gmsh, static_cast<int>(count), 1, 0, tags.data()};
  GmshFile to = gmsh_open(path.c_str(), 4, GMSH_LITTLE);
  gmsh_nodes(&to, count, tags.data(), reinterpret_cast<const double(*)[3]>(flat.data()), 0);
  gmsh_elements(&to, 1, &element);
  gmsh_data(&to, "NodeData", "s", 0, 1, count, tags.data(), 0, values.data());
  std::fclose(to.file);
  return path;
}

// ── by libraries ──

std::string write_exodus(const CellSample &cell, const std::string &folder) {
#ifdef SAMPLES_EXODUS
  // Cells that the writer knows. It leaves the order of nodes as it is, where Exodus has the edges between top and
  // bottom before the top's.
  static const std::map<int, Order> orders = {
      {VTK_TETRA, same(4)},
      {VTK_HEXAHEDRON, same(8)},
      {VTK_WEDGE, same(6)},
      {VTK_PYRAMID, same(5)},
      {VTK_QUADRATIC_TETRA, same(10)},
      {VTK_QUADRATIC_HEXAHEDRON, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15}},
      {VTK_QUADRATIC_WEDGE, {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11}},
      {VTK_QUADRATIC_PYRAMID, same(13)}};
  const auto order = orders.find(cell.type);
  if (order == orders.end())
    return "";
  CellSample turned = {cell.type, {}, {}, 0};
  for (int k : order->second)
    turned.points.push_back(cell.points[static_cast<size_t>(k)]);
  return by_vtk<vtkExodusIIWriter>(grid_of(turned), folder + "/a.ex2");
#else
  (void)cell, (void)folder;
  return "";
#endif
}

#ifdef SAMPLES_HDF
template <typename T> void put(hid_t group, const char *name, hid_t type, const std::vector<T> &values, hsize_t width) {
  const hsize_t size[2] = {values.size() / width, width};
  const hid_t space = H5Screate_simple(width > 1 ? 2 : 1, size, nullptr);
  const hid_t set = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
  H5Sclose(space);
}
#endif

std::string write_hdf(const CellSample &cell, const std::string &folder) {
#ifdef SAMPLES_HDF
  if (cell.type == VTK_POLYHEDRON)
    return ""; // this version of the format has none
  const std::string path = folder + "/a.vtkhdf";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t two = 2;
  const hid_t pair = H5Screate_simple(1, &two, nullptr), single = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 16);
  H5Tset_strpad(text, H5T_STR_NULLPAD);
  const hid_t version = H5Acreate2(group, "Version", H5T_NATIVE_INT64, pair, H5P_DEFAULT, H5P_DEFAULT);
  const int64_t numbers[2] = {1, 0};
  H5Awrite(version, H5T_NATIVE_INT64, numbers);
  const hid_t kind = H5Acreate2(group, "Type", text, single, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(kind, text, "UnstructuredGrid");
  std::vector<double> points, s;
  std::vector<int64_t> ids;
  for (const auto &p : cell.points) {
    points.insert(points.end(), p.begin(), p.end());
    s.push_back(value_at(p));
    ids.push_back(static_cast<int64_t>(ids.size()));
  }
  const auto count = static_cast<int64_t>(ids.size());
  put(group, "NumberOfPoints", H5T_NATIVE_INT64, std::vector<int64_t>{count}, 1);
  put(group, "NumberOfCells", H5T_NATIVE_INT64, std::vector<int64_t>{1}, 1);
  put(group, "NumberOfConnectivityIds", H5T_NATIVE_INT64, std::vector<int64_t>{count}, 1);
  put(group, "Points", H5T_NATIVE_DOUBLE, points, 3);
  put(group, "Connectivity", H5T_NATIVE_INT64, ids, 1);
  put(group, "Offsets", H5T_NATIVE_INT64, std::vector<int64_t>{0, count}, 1);
  put(group, "Types", H5T_NATIVE_UCHAR, std::vector<unsigned char>{static_cast<unsigned char>(cell.type)}, 1);
  const hid_t data = H5Gcreate2(group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  put(data, "s", H5T_NATIVE_DOUBLE, s, 1);
  H5Gclose(data);
  H5Aclose(version);
  H5Aclose(kind);
  H5Tclose(text);
  H5Sclose(pair);
  H5Sclose(single);
  H5Gclose(group);
  H5Fclose(file);
  return path;
#else
  (void)cell, (void)folder;
  return "";
#endif
}

std::string write_cgns(const CellSample &cell, const std::string &folder) {
#ifdef SAMPLES_CGNS
  struct Type {
    CGNS_ENUMT(ElementType_t) cgns;
    Order order;
  };
  static const std::map<int, Type> types = {
      {VTK_TETRA, {CGNS_ENUMV(TETRA_4), same(4)}},
      {VTK_PYRAMID, {CGNS_ENUMV(PYRA_5), same(5)}},
      {VTK_WEDGE, {CGNS_ENUMV(PENTA_6), same(6)}},
      {VTK_HEXAHEDRON, {CGNS_ENUMV(HEXA_8), same(8)}},
      {VTK_QUADRATIC_TETRA, {CGNS_ENUMV(TETRA_10), same(10)}},
      {VTK_QUADRATIC_PYRAMID, {CGNS_ENUMV(PYRA_13), same(13)}},
      {VTK_QUADRATIC_WEDGE, {CGNS_ENUMV(PENTA_15), {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11}}},
      {VTK_BIQUADRATIC_QUADRATIC_WEDGE,
       {CGNS_ENUMV(PENTA_18), {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11, 15, 16, 17}}},
      {VTK_QUADRATIC_HEXAHEDRON,
       {CGNS_ENUMV(HEXA_20), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15}}},
      {VTK_TRIQUADRATIC_HEXAHEDRON, {CGNS_ENUMV(HEXA_27), {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 16, 17,
                                                           18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26}}}};
  const auto type = types.find(cell.type);
  if (type == types.end() && cell.type != VTK_POLYHEDRON)
    return "";
  const std::string path = folder + "/a.cgns";
  int file, base, zone, id, solution;
  if (cg_open(path.c_str(), CG_MODE_WRITE, &file) != CG_OK)
    return "";
  const auto count = cell.points.size();
  const cgsize_t sizes[3] = {static_cast<cgsize_t>(count), 1, 0};
  cg_base_write(file, "base", 3, 3, &base);
  cg_zone_write(file, base, "zone", sizes, CGNS_ENUMV(Unstructured), &zone);
  std::vector<double> values(count);
  const char *const axes[3] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < count; ++i)
      values[i] = cell.points[i][k];
    cg_coord_write(file, base, zone, CGNS_ENUMV(RealDouble), axes[k], values.data(), &id);
  }
  if (cell.type == VTK_POLYHEDRON) {
    const auto faces = static_cast<cgsize_t>(cell.faces.size());
    std::vector<cgsize_t> corners, ends = {0}, sides, side_ends = {0, faces};
    for (const auto &face : cell.faces) {
      for (int corner : face)
        corners.push_back(corner + 1);
      ends.push_back(static_cast<cgsize_t>(corners.size()));
      sides.push_back(static_cast<cgsize_t>(sides.size()) + 1);
    }
    cg_poly_section_write(file, base, zone, "faces", CGNS_ENUMV(NGON_n), 1, faces, 0, corners.data(), ends.data(), &id);
    cg_poly_section_write(file, base, zone, "cells", CGNS_ENUMV(NFACE_n), faces + 1, faces + 1, 0, sides.data(),
                          side_ends.data(), &id);
  } else {
    std::vector<cgsize_t> nodes;
    for (int k : type->second.order)
      nodes.push_back(k + 1);
    cg_section_write(file, base, zone, "cells", type->second.cgns, 1, 1, 0, nodes.data(), &id);
  }
  cg_sol_write(file, base, zone, "solution", CGNS_ENUMV(Vertex), &solution);
  for (size_t i = 0; i < count; ++i)
    values[i] = value_at(cell.points[i]);
  cg_field_write(file, base, zone, solution, CGNS_ENUMV(RealDouble), "s", values.data(), &id);
  return cg_close(file) == CG_OK ? path : "";
#else
  (void)cell, (void)folder;
  return "";
#endif
}

} // namespace

CellSample cell_sample(int type) {
  const auto own = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(fixed_type(type)));
  CellSample cell = {type, {}, {}, 0};
  const double *p = own->GetParametricCoords();
  for (int i = 0; i < own->GetNumberOfPoints(); ++i, p += 3)
    cell.points.push_back({p[0] - 0.5, p[1] - 0.25, p[2] + 0.125});
  if (type == VTK_QUADRATIC_PYRAMID ||
      type == VTK_TRIQUADRATIC_PYRAMID) { // whose parameters are not those of a straight one
    static const size_t ends[8][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
    for (size_t e = 0; e < 8; ++e) {
      for (size_t k = 0; k < 3; ++k)
        cell.points[5 + e][k] = (cell.points[ends[e][0]][k] + cell.points[ends[e][1]][k]) / 2;
    }
  }
  switch (fixed_type(type)) {
  case VTK_TETRA:
  case VTK_QUADRATIC_TETRA:
    cell.volume = 1.0 / 6;
    break;
  case VTK_PYRAMID:
  case VTK_QUADRATIC_PYRAMID:
  case VTK_TRIQUADRATIC_PYRAMID:
    cell.volume = (cell.points[4][2] - cell.points[0][2]) / 3;
    break;
  case VTK_WEDGE:
  case VTK_QUADRATIC_WEDGE:
  case VTK_QUADRATIC_LINEAR_WEDGE:
  case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
    cell.volume = 0.5;
    break;
  case VTK_PENTAGONAL_PRISM:
  case VTK_HEXAGONAL_PRISM: {
    const size_t n = cell.points.size() / 2;
    for (size_t i = 0; i < n; ++i) {
      const auto &a = cell.points[i], &b = cell.points[(i + 1) % n];
      cell.volume += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    break;
  }
  default:
    cell.volume = 1;
  }
  for (vtkIdType i = 0; i < own->GetNumberOfPoints(); ++i)
    own->PointIds->SetId(i, i);
  const bool straight = own->IsLinear() && type != VTK_VOXEL;
  for (int i = 0; straight && i < own->GetNumberOfFaces(); ++i) {
    cell.faces.emplace_back();
    for (const vtkIdType corner : *own->GetFace(i)->PointIds)
      cell.faces.back().push_back(static_cast<int>(corner));
  }
  return cell;
}

std::string write_cell(const CellSample &cell, const std::string &extension, const std::string &folder) {
  static const std::map<std::string, std::string (*)(const CellSample &, const std::string &)> writers = {
      {".vtu", write_vtu},      {".vti", write_structured}, {".pvtu", write_pieces},   {".vtm", write_blocks},
      {".vtk", write_legacy},   {".pvd", write_series},     {".ex2", write_exodus},    {".vtkhdf", write_hdf},
      {".case", write_ensight}, {".cgns", write_cgns},      {".foam", write_openfoam}, {".msh", write_gmsh},
      {".node", write_tetgen}};
  const auto writer = writers.find(extension);
  return writer == writers.end() ? "?"
                                 : writer->second(cell, folder); // "?": can't be read, so that a new format is noticed
}
