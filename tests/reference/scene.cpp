/* SPDX-License-Identifier: Apache-2.0 */
#include "scene.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>

#include <OpenImageIO/imageio.h>
#include <jansson.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

namespace reference {
namespace {

using Json = std::unique_ptr<json_t, decltype(&json_decref)>;

Json load_json(const std::string &path) {
  json_error_t error;
  Json json(json_load_file(path.c_str(), 0, &error), &json_decref);
  if (!json)
    throw Error(path + ": line " + std::to_string(error.line) + ": " + error.text);
  return json;
}

double number(const json_t *json, const char *what) {
  if (!json_is_number(json))
    throw Error(std::string(what) + ": not a number");
  return json_number_value(json);
}

template <size_t N> std::array<double, N> tuple(const json_t *json, const char *what) {
  if (json_array_size(json) != N)
    throw Error(std::string(what) + ": not an array of " + std::to_string(N) + " numbers");
  std::array<double, N> result;
  for (size_t i = 0; i < N; i++)
    result[i] = number(json_array_get(json, i), what);
  return result;
}

template <size_t N> std::vector<std::array<double, N>> knots(const json_t *json, const char *what) {
  std::vector<std::array<double, N>> result;
  for (size_t i = 0; i < json_array_size(json); i++)
    result.push_back(tuple<N>(json_array_get(json, i), what));
  return result;
}

Transfer parse_transfer(const json_t *json) {
  Transfer transfer;
  transfer.color = knots<4>(json_object_get(json, "color"), "color");
  transfer.extinction = knots<2>(json_object_get(json, "extinction"), "extinction");
  transfer.opacity = knots<2>(json_object_get(json, "opacity"), "opacity");
  if (const json_t *unit = json_object_get(json, "unit_distance"))
    transfer.unit_distance = number(unit, "unit_distance");
  if (transfer.color.empty() || transfer.extinction.empty() == transfer.opacity.empty())
    throw Error("transfer: needs color, and either extinction or opacity");
  return transfer;
}

Camera parse_camera(const json_t *json) {
  Camera camera;
  const struct {
    const char *key;
    double *to;
  } vectors[] = {{"eye", camera.eye}, {"target", camera.target}, {"up", camera.up}};
  for (const auto &vector : vectors) {
    const auto value = tuple<3>(json_object_get(json, vector.key), vector.key);
    std::copy(value.begin(), value.end(), vector.to);
  }
  const json_t *height = json_object_get(json, "ortho");
  camera.orthographic = height != nullptr;
  if (camera.orthographic)
    camera.height = number(height, "ortho");
  else
    camera.fovy = number(json_object_get(json, "fovy"), "fovy");
  return camera;
}

/* The array itself and its component: −1 for the magnitude. */
vtkDataArray *find_array(vtkUnstructuredGrid *grid, const std::string &selector, int &component, bool &of_cells) {
  const auto find = [&](const std::string &name) -> vtkDataArray * {
    vtkDataArray *array = grid->GetPointData()->GetArray(name.c_str());
    of_cells = array == nullptr;
    return array ? array : grid->GetCellData()->GetArray(name.c_str());
  };
  component = -1;
  vtkDataArray *array = find(selector);
  const size_t colon = selector.rfind(':');
  if (!array && colon != std::string::npos) {
    array = find(selector.substr(0, colon));
    const std::string which = selector.substr(colon + 1);
    if (which != "mag")
      component = std::stoi(which);
  } else if (array && array->GetNumberOfComponents() == 1) {
    component = 0;
  }
  if (!array || component >= array->GetNumberOfComponents())
    throw Error("no array " + selector);
  return array;
}

double array_value(vtkDataArray *array, vtkIdType i, int component) {
  if (component >= 0)
    return array->GetComponent(i, component);
  double sum = 0;
  for (int c = 0; c < array->GetNumberOfComponents(); c++)
    sum += array->GetComponent(i, c) * array->GetComponent(i, c);
  return std::sqrt(sum);
}

/* The tetrahedra and the array `selector` (NAME, NAME:2, NAME:mag) of a .vtu. */
Mesh read_mesh(const std::string &path, const std::string &selector) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  if (!reader->CanReadFile(path.c_str()))
    throw Error(path + ": no .vtu that can be read");
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkUnstructuredGrid *grid = reader->GetOutput();
  Mesh mesh;
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); i++) {
    mesh.points.emplace_back();
    grid->GetPoint(i, mesh.points.back().data());
  }
  int component;
  vtkDataArray *array = find_array(grid, selector, component, mesh.of_cells);
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < grid->GetNumberOfCells(); i++) {
    if (grid->GetCellType(i) != VTK_TETRA)
      throw Error(path + ": cell " + std::to_string(i) + " is no tetrahedron");
    grid->GetCellPoints(i, ids);
    mesh.cells.push_back({ids->GetId(0), ids->GetId(1), ids->GetId(2), ids->GetId(3)});
  }
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); i++)
    mesh.values.push_back(array_value(array, i, component));
  return mesh;
}

} // namespace

Transfer read_transfer(const std::string &path) {
  return parse_transfer(load_json(path).get());
}

Scene read_scene(const std::string &path) {
  const Json json = load_json(path);
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const json_t *transfer = json_object_get(json.get(), "transfer");
  const char *input = json_string_value(json_object_get(json.get(), "input"));
  const char *array = json_string_value(json_object_get(json.get(), "array"));
  if (!transfer || !input || !array)
    throw Error(path + ": not a complete scene: input, array or transfer is missing");
  Scene scene;
  if (json_is_string(transfer))
    scene.transfer = read_transfer((folder / json_string_value(transfer)).string());
  else
    scene.transfer = parse_transfer(transfer);
  if (const char *model = json_string_value(json_object_get(json.get(), "opacity_model")))
    scene.transfer.linear_opacity = std::strcmp(model, "unit-distance") != 0;
  scene.camera = parse_camera(json_object_get(json.get(), "camera"));
  const auto size = tuple<2>(json_object_get(json.get(), "size"), "size");
  scene.width = int64_t(size[0]);
  scene.height = int64_t(size[1]);
  if (const json_t *samples = json_object_get(json.get(), "samples")) {
    scene.samples = std::lround(std::sqrt(number(samples, "samples")));
    if (double(scene.samples * scene.samples) != number(samples, "samples"))
      throw Error(path + ": samples: only squares are known here");
  }
  scene.clip = knots<4>(json_object_get(json.get(), "clip"), "clip");
  if (const json_t *json_box = json_object_get(json.get(), "clip_box")) {
    const auto box = tuple<6>(json_box, "clip_box");
    for (size_t i = 0; i < 6; i++) {
      const double sign = i % 2 ? -1 : 1;
      std::array<double, 4> half_space{0, 0, 0, sign * box[i]};
      half_space[i / 2] = sign;
      scene.clip.push_back(half_space);
    }
  }
  scene.mesh = read_mesh((folder / input).string(), array);
  return scene;
}

std::vector<double> read_image(const std::string &path, int64_t width, int64_t height) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input)
    throw Error(path + ": " + OIIO::geterror());
  const OIIO::ImageSpec &spec = input->spec();
  if (spec.width != width || spec.height != height || spec.nchannels != 4 || spec.format != OIIO::TypeDesc::DOUBLE)
    throw Error(path + ": not an image of " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels of four doubles");
  std::vector<double> pixels(size_t(width * height * 4));
  if (!input->read_image(0, 0, 0, 4, OIIO::TypeDesc::DOUBLE, pixels.data()))
    throw Error(path + ": " + input->geterror());
  return pixels;
}

void write_image(const std::string &path, const std::vector<double> &pixels, int64_t width, int64_t height) {
  const auto output = OIIO::ImageOutput::create(path);
  const OIIO::ImageSpec spec(int(width), int(height), 4, OIIO::TypeDesc::DOUBLE);
  if (!output)
    throw Error(path + ": " + OIIO::geterror());
  if (!output->open(path, spec) || !output->write_image(OIIO::TypeDesc::DOUBLE, pixels.data()) || !output->close())
    throw Error(path + ": " + output->geterror());
}

} // namespace reference
