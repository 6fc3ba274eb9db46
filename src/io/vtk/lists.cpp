// SPDX-License-Identifier: Apache-2.0
// Reads XML files that list other files: pieces, blocks and time steps.
#include "lists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <unistd.h>

#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include "common.hpp"
#include "formats.hpp"

namespace {

using Element = vtkSmartPointer<vtkXMLDataElement>;

// Returns the element below VTKFile that is named as its type says, or else `name`.
Element read_list(const tcv::Reading &reading, const char *name) {
  const char *path = reading.path.c_str();
  const Element root =
      tcv::captured(reading.context, path, [&] { return Element::Take(vtkXMLUtilities::ReadElementFromFile(path)); });
  const char *type = root ? (name ? name : root->GetAttribute("type")) : nullptr;
  const Element list = type ? root->FindNestedElementWithName(type) : nullptr;
  if (!list)
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: is not the XML it should be", path);
  return list;
}

bool is_named(vtkXMLDataElement *element, const char *name) {
  return element->GetName() && std::string(element->GetName()) == name;
}

std::string file_of(const tcv::Reading &reading, vtkXMLDataElement *element, const char *attribute) {
  const char *file = element->GetAttribute(attribute);
  if (!file || !*file)
    tcv::fail(TETCAST_ERROR_DATA, "%s: an element %s names no file (%s)", reading.path.c_str(), element->GetName(),
              attribute);
  return tcv::beside(reading.path, file);
}

void read_group(const tcv::Reading &reading, vtkXMLDataElement *group, const std::string &path, int depth,
                tcv::Contents *contents) {
  if (depth > 64)
    tcv::fail(TETCAST_ERROR_DATA, "%s: blocks within blocks are more than 64 deep", reading.path.c_str());
  int number = -1;
  for (int i = 0; i < group->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement *element = group->GetNestedElement(i);
    const bool leaf = is_named(element, "DataSet");
    if (!leaf && !is_named(element, "Block") && !is_named(element, "Piece"))
      continue;
    ++number;
    const char *name = element->GetAttribute("name"), *index = element->GetAttribute("index");
    const std::string own = name && *name ? name : index && *index ? index : std::to_string(number);
    const bool piece = leaf && is_named(group, "Piece"); // A piece goes by the name of its block.
    const std::string whole = piece ? path : path.empty() ? own : path + "/" + own;
    if (!leaf) {
      read_group(reading, element, whole, depth + 1, contents);
      continue;
    }
    if (!element->GetAttribute("file"))
      continue; // The block is empty.
    tcv::read_part(reading, file_of(reading, element, "file"), whole, contents);
  }
}

} // namespace

namespace tcv {

// Returns the path of `file`, which the file at `path` names. Programs on Windows write paths such as sub\a.vtu. Here
// that could be the name of a file, but mostly is not.
std::string beside(const std::string &path, const std::string &file) {
  const size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  const auto place = [&](const std::string &name) { return name[0] == '/' ? name : folder + name; };
  const std::string given = place(file);
  if (file.find('\\') == std::string::npos || access(given.c_str(), F_OK) == 0)
    return given;
  std::string turned = file;
  std::replace(turned.begin(), turned.end(), '\\', '/');
  return place(turned);
}

void read_pieces(const Reading &reading, Contents *contents) {
  const Element list = read_list(reading, nullptr);
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement *piece = list->GetNestedElement(i);
    if (is_named(piece, "Piece"))
      read_part(reading, file_of(reading, piece, "Source"), reading.block, contents);
  }
}

void read_blocks(const Reading &reading, Contents *contents) {
  read_group(reading, read_list(reading, nullptr), reading.block, 0, contents);
}

void read_pvd(const Reading &reading, Contents *contents) {
  const Element list = read_list(reading, "Collection");
  std::vector<Step> steps;
  bool timed = false;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement *element = list->GetNestedElement(i);
    if (!is_named(element, "DataSet"))
      continue;
    double time = 0;
    const char *text = element->GetAttribute("timestep");
    if (text)
      time = number_of(text);
    if (!std::isfinite(time))
      fail(TETCAST_ERROR_DATA, "%s: '%s' is not a time", reading.path.c_str(), text);
    timed = timed || text;
    steps.push_back({time, file_of(reading, element, "file")});
  }
  read_steps(reading, std::move(steps), timed, contents);
}

void read_steps(const Reading &reading, std::vector<Step> steps, bool timed, Contents *contents) {
  const char *path = reading.path.c_str();
  if (steps.empty())
    fail(TETCAST_ERROR_DATA, "%s: lists no files", path);
  std::stable_sort(steps.begin(), steps.end(), [](const Step &a, const Step &b) { return a.time < b.time; });
  std::vector<double> times;
  for (const Step &step : steps) {
    if (timed && (times.empty() || step.time != times.back()))
      times.push_back(step.time);
  }
  const int64_t chosen = choose_step(reading.path, *reading.desc, times);
  TetcastDatasetDesc desc = *reading.desc;
  desc.step = 0;
  desc.time = std::numeric_limits<double>::quiet_NaN();
  Reading one = reading;
  one.desc = &desc;
  for (const Step &step : steps) {
    if (!timed || step.time == times[static_cast<size_t>(chosen)])
      read_part(one, step.path, reading.block, contents);
  }
  contents->times = times;
  contents->step = chosen;
}

} // namespace tcv
