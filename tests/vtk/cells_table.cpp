// SPDX-License-Identifier: Apache-2.0
// Reads a cell of every type from every format that has such, and compares what went well with the table in the manual.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include <tetcast/dataset.h>

#include "cell_files.hpp"

namespace {

std::string complaint;
void remember(void *, TetcastSeverity, const char *text) {
  complaint = text;
}

const char *name_of(const TetcastDataset *dataset) {
  const char *name = "";
  int64_t count = 0;
  return tetcast_dataset_cell_type(dataset, 0, &name, &count) && count == 1 &&
                 !tetcast_dataset_cell_type(dataset, 1, nullptr, nullptr)
             ? name
             : "";
}

// Whether the tetrahedra fill the cell, and the field is as written.
bool is_right(TetcastContext *context, const TetcastDataset *dataset, const CellSample &cell) {
  const std::string name = name_of(dataset);
  const TetcastCutInfo cut = tetcast_dataset_cut(dataset);
  TetcastMesh *mesh = nullptr;
  TetcastField *s = nullptr, *p = nullptr;
  TetcastMeshHealth health;
  bool right = !name.empty() && cut.folded == 0 && cut.open == 0 &&
               tetcast_dataset_mesh(dataset, &mesh) == TETCAST_OK &&
               tetcast_mesh_health(context, mesh, &health) == TETCAST_OK &&
               std::fabs(health.volume / cell.volume - 1) < 1e-5 && health.components == 1;
  const bool at_points =
      right && (tetcast_dataset_field(dataset, "s", &s, nullptr) == TETCAST_OK ||
                tetcast_dataset_field(dataset, "attribute_0", &s, nullptr) == TETCAST_OK); // TetGen's have no names
  if (at_points) {
    for (int64_t i = 0; i < tetcast_mesh_vertex_count(mesh); ++i) {
      std::array<double, 3> at;
      tetcast_mesh_vertex(mesh, i, at.data());
      right = right && std::fabs(tetcast_field_value(s, i) - value_at(at)) < 1e-4;
    }
  } else if (right) { // OpenFOAM's are in cells
    right = tetcast_dataset_field(dataset, "p", &p, nullptr) == TETCAST_OK;
    for (int64_t i = 0; right && i < tetcast_mesh_tetrahedron_count(mesh); ++i)
      right = std::fabs(tetcast_field_value(p, i) - 7) < 1e-4;
  }
  tetcast_field_destroy(&s);
  tetcast_field_destroy(&p);
  tetcast_mesh_destroy(&mesh);
  return right;
}

// "" or what is wrong; *name: what tetcast calls the type.
std::string try_cell(TetcastContext *context, const CellSample &cell, const std::string &path, std::string *name) {
  TetcastDataset *dataset = nullptr;
  complaint.clear();
  const TetcastStatus status = tetcast_dataset_read(context, path.c_str(), nullptr, &dataset);
  std::string wrong = status ? complaint : is_right(context, dataset, cell) ? "" : "not the cell that was written";
  if (!status)
    *name = name_of(dataset);
  tetcast_dataset_destroy(&dataset);
  return wrong;
}

// The lines of the manual between the markers, as rows of trimmed fields.
std::vector<std::vector<std::string>> table_in(const char *manual) {
  std::ifstream file(manual);
  std::vector<std::vector<std::string>> rows;
  bool within = false;
  for (std::string line; std::getline(file, line);) {
    if (line == ".\\\" cells")
      within = true;
    else if (line == ".\\\" end of cells")
      within = false;
    else if (within && line.compare(0, 1, "|") == 0) {
      std::vector<std::string> row;
      std::stringstream fields(line.substr(1));
      for (std::string field; std::getline(fields, field, '|');) {
        const size_t first = field.find_first_not_of(' ');
        row.push_back(first == std::string::npos ? "" : field.substr(first, field.find_last_not_of(' ') + 1 - first));
      }
      rows.push_back(row);
    }
  }
  return rows;
}

} // namespace

int main(int argc, char **argv) {
  if (argc != 2)
    return 2;
  static const int types[] = {10, 11, 12, 13, 14, 15, 16, 42, 24, 25, 26, 27,
                              29, 31, 32, 33, 37, 71, 72, 73, 78, 79, 80};
  TetcastContextDesc desc = tetcast_context_desc_default();
  desc.message = remember;
  TetcastContext *context = nullptr;
  if (tetcast_context_create(&desc, &context) != TETCAST_OK)
    return 1;
  const char *temporary = std::getenv("TMPDIR");
  std::string root = std::string(temporary ? temporary : "/tmp") + "/tetcast-cells-XXXXXX";
  if (!mkdtemp(&root[0]))
    return 1;

  std::vector<std::string> formats;
  const char *extensions;
  for (int i = 0; tetcast_dataset_format(i, nullptr, &extensions); ++i)
    formats.push_back(std::string(extensions).substr(0, std::string(extensions).find(' ')));
  std::vector<std::vector<std::string>> table = {{"cell"}};
  for (const std::string &format : formats)
    table[0].push_back(format);
  int done = 0;
  for (int type : types) {
    const CellSample cell = cell_sample(type);
    std::vector<std::string> row = {""};
    for (const std::string &format : formats) {
      const std::string folder = root + "/" + std::to_string(type) + format;
      if (std::system(("mkdir '" + folder + "'").c_str()) != 0)
        return 1;
      const std::string path = write_cell(cell, format, folder);
      std::string name;
      const std::string wrong = path.empty() ? "" : try_cell(context, cell, path, &name);
      if (!wrong.empty())
        std::cerr << "cell type " << type << ", " << format << ": " << wrong << "\n";
      if (row[0].empty())
        row[0] = name;
      if (!name.empty() && wrong.empty() && name != row[0])
        std::cerr << "cell type " << type << ", " << format << ": is a " << name << "\n";
      const bool right = !path.empty() && wrong.empty() && name == row[0];
      row.push_back(right ? "+" : "");
      done += right;
    }
    table.push_back(row);
  }
  tetcast_context_destroy(&context);
  const bool removed = std::system(("rm -rf '" + root + "'").c_str()) == 0;

  // A build may lack formats; those it has are to be as the manual says.
  const auto wanted = table_in(argv[1]);
  bool same = wanted.size() == table.size();
  for (size_t i = 0; same && i < table.size(); ++i) {
    for (size_t k = 0; same && k < table[i].size(); ++k) {
      size_t at = 0;
      while (k > 0 && at < wanted[0].size() && wanted[0][at] != formats[k - 1])
        ++at;
      same = at < wanted[i].size() && wanted[i][at] == table[i][k];
    }
  }
  std::cout << done << " of formats and cells are read\n";
  if (same && removed)
    return 0;
  std::cout << "The table in the manual is not what this build does:\n\n";
  for (const auto &row : table) {
    for (const std::string &field : row)
      std::cout << "| " << field << (field.empty() ? "" : " ");
    std::cout << "|\n";
  }
  return 1;
}
