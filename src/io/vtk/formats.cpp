// SPDX-License-Identifier: Apache-2.0
// The formats that volume meshes are read from. Whatever lists formats takes them from the table in this file.
#include "formats.hpp"

#include <cstring>

#include <unistd.h>

#include "common.hpp"
#include "files.hpp"
#include "plugin.hpp"

namespace {

// A file's content tells its format (file_kind), and its extension does only if the content does not. A row without a
// name is another kind of the format in the row above it.
const struct {
  const char *name, *extensions, *kind;
  void (*read)(const tcv::Reading &reading, tcv::Contents *contents);
  const char *plugin; // The program tetcast-vtk-PLUGIN reads the format; null: this library does.
} formats[] = {
    {"VTK XML, unstructured grid", ".vtu", "VTKFile UnstructuredGrid", tcv::read_vtu, nullptr},
    {"VTK XML, structured grid", ".vti .vtr .vts", "VTKFile ImageData", tcv::read_vti, nullptr},
    {nullptr, ".vtr", "VTKFile RectilinearGrid", tcv::read_vtr, nullptr},
    {nullptr, ".vts", "VTKFile StructuredGrid", tcv::read_vts, nullptr},
    {"VTK XML, in pieces", ".pvtu .pvti .pvtr .pvts", "VTKFile PUnstructuredGrid", tcv::read_pieces, nullptr},
    {nullptr, "", "VTKFile PImageData", tcv::read_pieces, nullptr},
    {nullptr, "", "VTKFile PRectilinearGrid", tcv::read_pieces, nullptr},
    {nullptr, "", "VTKFile PStructuredGrid", tcv::read_pieces, nullptr},
    {"VTK XML, blocks", ".vtm .vtmb", "VTKFile vtkMultiBlockDataSet", tcv::read_blocks, nullptr},
    {"VTK legacy", ".vtk", "vtk UNSTRUCTURED_GRID", tcv::read_legacy_grid, nullptr},
    {nullptr, "", "vtk STRUCTURED_POINTS", tcv::read_legacy_structured, nullptr},
    {nullptr, "", "vtk RECTILINEAR_GRID", tcv::read_legacy_structured, nullptr},
    {nullptr, "", "vtk STRUCTURED_GRID", tcv::read_legacy_structured, nullptr},
    {"ParaView's time series", ".pvd .series", "VTKFile Collection", tcv::read_pvd, nullptr},
    {nullptr, "", "JSON", tcv::read_series, nullptr},
    {"Exodus II", ".ex2 .exo .e .g", "NetCDF", tcv::read_exodus, "exodus"},
    {nullptr, "", "HDF5", tcv::read_exodus, "exodus"},
    {"VTKHDF", ".vtkhdf .hdf", "HDF5 VTKHDF", tcv::read_vtkhdf, "hdf"},
    {"EnSight 6 and Gold", ".case .encas", "EnSight", tcv::read_ensight, "ensight"},
    {"CGNS", ".cgns", "HDF5 CGNS", tcv::read_cgns, "cgns"},
    {nullptr, "", "ADF", tcv::read_cgns, "cgns"},
    {"OpenFOAM", ".foam", "OpenFOAM", tcv::read_openfoam, "openfoam"},
    {"Gmsh 1, 2 and 4.1", ".msh", "Gmsh", tcv::read_gmsh, nullptr},
    {"TetGen", ".node .ele", "TetGen", tcv::read_tetgen, nullptr}, // Only the extension tells it.
};

bool one_of(const char *path, const char *extensions) {
  const std::string all = extensions;
  for (size_t at = 0; at < all.size();) {
    const size_t end = std::min(all.find(' ', at), all.size());
    if (tcv::has_extension(path, all.substr(at, end - at).c_str()))
      return true;
    at = end + 1;
  }
  return false;
}

// Returns whether a file of this kind consists of one block alone. Files of the other kinds may have several.
bool is_one_block(const std::string &kind) {
  const bool xml =
      kind.compare(0, 8, "VTKFile ") == 0 && kind != "VTKFile vtkMultiBlockDataSet" && kind != "VTKFile Collection";
  return xml || kind.compare(0, 4, "vtk ") == 0;
}

// Returns whether what this function reads are lists of other files.
bool reads_lists(void (*read)(const tcv::Reading &reading, tcv::Contents *contents)) {
  return read == tcv::read_pieces || read == tcv::read_blocks || read == tcv::read_pvd || read == tcv::read_series;
}

bool available(const char *plugin) {
  return !plugin || tcv::plugin_exists(plugin);
}

} // namespace

namespace tcv {

void read_contents(const Reading &reading, Contents *contents) {
  const char *path = reading.path.c_str();
  // OpenFOAM's file is empty, so its extension tells.
  const std::string kind = has_extension(path, ".foam") ? "OpenFOAM" : file_kind(file_head(path));
  std::string extensions;
  for (const auto &format : formats) {
    if (format.name)
      extensions += (extensions.empty() ? "" : " ") + std::string(format.extensions);
    if (kind.empty() ? !one_of(path, format.extensions) : kind != format.kind)
      continue;
    if (!contents->files || reads_lists(format.read))
      return format.read(reading, contents);
    if (reading.depth > 0)
      contents->files->push_back(reading.path);
    return;
  }
  refuse(path, kind, "a volume mesh", extensions.c_str());
}

void read_part(const Reading &of, const std::string &path, const std::string &block, Contents *contents) {
  if (of.depth >= 8)
    fail(TETCAST_ERROR_DATA, "%s: is listed by a file that lists a file …, eight times over", path.c_str());
  if (contents->files && access(path.c_str(), R_OK) != 0) {
    contents->files->push_back(path); // Whoever reads it will notice.
    return;
  }
  try {
    const std::string kind = file_kind(file_head(path.c_str()));
    const bool wanted = block_wanted(block, of.desc->block);
    if (is_surface(kind) || (!block.empty() && !wanted && is_one_block(kind))) {
      list_block(block, contents);
      contents->surfaces += is_surface(kind) && wanted;
      return;
    }
    read_contents({of.context, of.desc, path, block, of.depth + 1}, contents);
  } catch (const Failure &failure) {
    throw Failure{failure.status, of.path + ": " + failure.text};
  }
}

int64_t choose_step(const std::string &path, const TetcastDatasetDesc &desc, const std::vector<double> &times) {
  return choose_step(path, desc.step, desc.time, times);
}

} // namespace tcv

bool tetcast_dataset_format(int i, const char **name, const char **extensions) {
  for (const auto &format : formats) {
    if (!format.name || !available(format.plugin) || i-- != 0)
      continue;
    if (name)
      *name = format.name;
    if (extensions)
      *extensions = format.extensions;
    return true;
  }
  return false;
}
