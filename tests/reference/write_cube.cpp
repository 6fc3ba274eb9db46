/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a cube of tetrahedra that is hard on a renderer, as a .vtu without the help of a library:
 *     wave      smooth, at the points
 *     plateau   0, 1, 2, 3 at the points: whole cells lie at a value where a transfer function may step
 *     holes     as wave, with NaN and infinity at some points
 *     material  of the cells */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "cube.h"

using namespace reference;

namespace {

struct Appended {
  std::string xml, data;

  template <class T> void add(const char *type, const char *name, const std::vector<T> &values, int components = 1) {
    xml += std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(data.size()) + "\"/>\n";
    const uint64_t bytes = values.size() * sizeof(T);
    data.append(reinterpret_cast<const char *>(&bytes), sizeof bytes);
    data.append(reinterpret_cast<const char *>(values.data()), bytes);
  }
};

std::string document(const Mesh &mesh, double scale, double offset) {
  std::vector<double> wave = mesh.values, plateau, holes = mesh.values, material, coordinates;
  for (const auto &p : mesh.points) {
    plateau.push_back(std::floor(std::fmod(2.5 * (p[0] + p[1] + p[2]), 4)));
    for (double x : p)
      coordinates.push_back(offset + scale * x);
  }
  for (size_t i = 0; i < holes.size(); i += 17)
    holes[i] = i % 2 ? HUGE_VAL : std::numeric_limits<double>::quiet_NaN();
  std::vector<int64_t> connectivity, offsets;
  for (size_t i = 0; i < mesh.cells.size(); i++) {
    connectivity.insert(connectivity.end(), mesh.cells[i].begin(), mesh.cells[i].end());
    offsets.push_back(int64_t(connectivity.size()));
    material.push_back(double(i * 7 % 11));
  }
  Appended appended;
  appended.xml = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                 "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
                 std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" + std::to_string(mesh.cells.size()) +
                 "\">\n<PointData Scalars=\"wave\">\n";
  appended.add("Float64", "wave", wave);
  appended.add("Float64", "plateau", plateau);
  appended.add("Float64", "holes", holes);
  appended.xml += "</PointData>\n<CellData>\n";
  appended.add("Float64", "material", material);
  appended.xml += "</CellData>\n<Points>\n";
  appended.add("Float64", "Points", coordinates, 3);
  appended.xml += "</Points>\n<Cells>\n";
  appended.add("Int64", "connectivity", connectivity);
  appended.add("Int64", "offsets", offsets);
  appended.add("UInt8", "types", std::vector<uint8_t>(mesh.cells.size(), 10));
  appended.xml += "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  return appended.xml + appended.data + "\n</AppendedData>\n</VTKFile>\n";
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 7) {
    std::fprintf(stderr, "usage: write_cube FILE.vtu N JITTER THICKNESS SCALE OFFSET\n"
                         "THICKNESS of the layer of cells above the middle, in edges of the others\n");
    return 2;
  }
  const int n = std::atoi(argv[2]);
  const double thickness = std::atof(argv[4]);
  Mesh mesh = cube(n, std::atof(argv[3]), [](const auto &) { return 0.0; });
  const size_t layer = size_t(n + 1) * size_t(n + 1), first = size_t(n / 2 + 1) * layer;
  if (thickness != 1)
    for (size_t i = first; i < first + layer; i++) {
      mesh.points[i] = mesh.points[i - layer];
      mesh.points[i][2] += thickness / n;
    }
  for (size_t i = 0; i < mesh.points.size(); i++) {
    const auto &p = mesh.points[i];
    mesh.values[i] = std::sin(7 * p[0]) * std::cos(5 * p[1] + 1) + p[2] * p[2] + 0.25 * std::sin(11 * p[0] * p[2]);
  }
  const std::string text = document(mesh, std::atof(argv[5]), std::atof(argv[6]));
  std::FILE *file = std::fopen(argv[1], "wb");
  const bool written = file && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return file && std::fclose(file) == 0 && written ? 0 : 1;
}
