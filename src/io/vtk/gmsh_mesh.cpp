// SPDX-License-Identifier: Apache-2.0
// Reads meshes by Gmsh in the formats MSH 1, 2 and 4.1, as text and as bytes of either order. Views become arrays, and
// so do the physical groups.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <list>
#include <map>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>

#include "common.hpp"
#include "formats.hpp"
#include "gmsh_order.hpp"
#include "gmsh_scan.hpp"

namespace {

// These tables reorder the nodes of Gmsh into those of VTK; null stands for the same order. Gmsh numbers the middles of
// edges by the ends of the edges, in rising order, while VTK goes round the cell. VTK has no pyramid of 14 nodes, so
// Gmsh's becomes one of 19, of which the last five are not used.
const short tetrahedron_10[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
const short hexahedron_27[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 13, 9,  16, 18,
                               19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26};
const short wedge_18[] = {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16};
const short pyramid_19[] = {0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12, 13, 0, 0, 0, 0, 0};

struct ElementType {
  int id, nodes;
  unsigned char type; // The type of the cell for VTK.
  int points;         // A cell of that type has so many points.
  const short *order;
};

const ElementType low_types[] = {
    {1, 2, VTK_LINE, 2, nullptr},
    {2, 3, VTK_TRIANGLE, 3, nullptr},
    {3, 4, VTK_QUAD, 4, nullptr},
    {4, 4, VTK_TETRA, 4, nullptr},
    {5, 8, VTK_HEXAHEDRON, 8, nullptr},
    {6, 6, VTK_WEDGE, 6, nullptr},
    {7, 5, VTK_PYRAMID, 5, nullptr},
    {8, 3, VTK_QUADRATIC_EDGE, 3, nullptr},
    {9, 6, VTK_QUADRATIC_TRIANGLE, 6, nullptr},
    {10, 9, VTK_BIQUADRATIC_QUAD, 9, nullptr},
    {11, 10, VTK_QUADRATIC_TETRA, 10, tetrahedron_10},
    {12, 27, VTK_TRIQUADRATIC_HEXAHEDRON, 27, hexahedron_27},
    {13, 18, VTK_BIQUADRATIC_QUADRATIC_WEDGE, 18, wedge_18},
    {14, 14, VTK_TRIQUADRATIC_PYRAMID, 19, pyramid_19},
    {15, 1, VTK_VERTEX, 1, nullptr},
    {16, 8, VTK_QUADRATIC_QUAD, 8, nullptr},
    {17, 20, VTK_QUADRATIC_HEXAHEDRON, 20, hexahedron_27},
    {18, 15, VTK_QUADRATIC_WEDGE, 15, wedge_18},
    {19, 13, VTK_QUADRATIC_PYRAMID, 13, pyramid_19},
};

// Elements of third order and above that have all nodes of their order. Lines and surfaces are not read, but the number
// of their nodes is needed to skip them.
struct HighOrders {
  unsigned char type;
  int first, next[10]; // The lowest order, then the identifiers of that order and the higher ones; 0 at the end.
};

const HighOrders high_orders[] = {
    {VTK_LAGRANGE_CURVE, 3, {26, 27, 28, 62, 63, 64, 65, 66}},
    {VTK_LAGRANGE_TRIANGLE, 3, {21, 23, 25, 42, 43, 44, 45, 46}},
    {VTK_LAGRANGE_QUADRILATERAL, 3, {36, 37, 38, 47, 48, 49, 50, 51}},
    {VTK_LAGRANGE_TETRAHEDRON, 3, {29, 30, 31, 71, 72, 73, 74, 75}},
    {VTK_LAGRANGE_HEXAHEDRON, 3, {92, 93, 94, 95, 96, 97, 98}},
};

int nodes_of(unsigned char type, int n) {
  switch (type) {
  case VTK_LAGRANGE_CURVE:
    return n + 1;
  case VTK_LAGRANGE_TRIANGLE:
    return (n + 1) * (n + 2) / 2;
  case VTK_LAGRANGE_QUADRILATERAL:
    return (n + 1) * (n + 1);
  case VTK_LAGRANGE_TETRAHEDRON:
    return (n + 1) * (n + 2) * (n + 3) / 6;
  default:
    return (n + 1) * (n + 1) * (n + 1);
  }
}

const std::vector<ElementType> &all_types() {
  static std::list<std::vector<short>> orders; // The types refer to these lists, which therefore stay where they are.
  static const std::vector<ElementType> types = [] {
    std::vector<ElementType> list(std::begin(low_types), std::end(low_types));
    for (const HighOrders &high : high_orders) {
      for (int i = 0; high.next[i]; ++i) {
        const int n = high.first + i, nodes = nodes_of(high.type, n);
        const bool tetrahedron = high.type == VTK_LAGRANGE_TETRAHEDRON;
        if (tetrahedron || high.type == VTK_LAGRANGE_HEXAHEDRON)
          orders.push_back(tetrahedron ? tcv::gmsh_tetrahedron(n) : tcv::gmsh_hexahedron(n));
        else
          orders.emplace_back();
        list.push_back({high.next[i], nodes, high.type, nodes, orders.back().empty() ? nullptr : orders.back().data()});
      }
    }
    return list;
  }();
  return types;
}

const ElementType *find_type(int64_t id) {
  for (const ElementType &type : all_types()) {
    if (type.id == id)
      return &type;
  }
  return nullptr;
}

// A section of values. It is read only once it is known which of the steps is wanted.
struct Section {
  enum Kind { OF_NODES, OF_ELEMENTS, OF_ELEMENTS_NODES } kind;
  std::string name;
  double time;
  int64_t components, count;
  tcv::GmshCursor at;
};

class Reader {
public:
  Reader(const tcv::Reading &reading, const std::string &bytes)
      : reading_(reading), in_(reading.path.c_str(), bytes), bytes_(bytes.size()) {}
  void read(tcv::Contents *contents);

private:
  bool old() const { return version_ < 4; }
  bool first() const { return version_ == 1; } // Files of version 1 lack the section $MeshFormat.
  void read_format();
  void read_entities(bool parts);
  void read_nodes();
  void read_node(int64_t i, int extra);
  void read_elements();
  void read_block_of_elements(const ElementType &type, int64_t count, int64_t tags, int64_t group);
  void add_element(const ElementType &type, int64_t tag, int64_t group);
  const ElementType &type_of(int64_t id) const;
  void read_section(const std::string &name, Section::Kind kind);
  void try_section(const std::string &name, Section::Kind kind, tcv::Contents *contents);
  std::string reason_of(const tcv::Failure &failure) const;
  void add_views(vtkUnstructuredGrid *grid, tcv::Contents *contents);
  vtkSmartPointer<vtkDoubleArray> values_of(Section *section);
  void read_corner_values(Section *section, vtkDoubleArray *array);
  tcv::Grid make_grid();

  const tcv::Reading &reading_;
  tcv::GmshCursor in_;
  uint64_t bytes_, taken_ = 0; // The size of the file, and how many bytes arrays have taken so far.
  double version_ = 0;
  // The first physical group of an entity, which goes by its dimension and tag.
  std::map<std::pair<int64_t, int64_t>, int64_t> groups_;
  tcv::GmshTags nodes_, elements_;
  vtkNew<vtkDoubleArray> positions_;
  vtkNew<vtkIdTypeArray> corners_, ends_;
  vtkNew<vtkUnsignedCharArray> types_;
  vtkNew<vtkIntArray> physical_;
  bool grouped_ = false;
  int64_t last_group_ = 0;
  std::vector<int64_t> list_; // The nodes of an element.
  std::vector<Section> sections_;
  std::string section_name_; // The section that is being read, for messages.
};

// ── the mesh ──

void Reader::read_format() {
  version_ = in_.text_number("the version of the format");
  const int64_t binary = in_.text_integer("0 or 1"), size = in_.text_integer("the size of numbers");
  const bool known = (version_ >= 2 && version_ < 3) || version_ == 4.1;
  if (!known) {
    tcv::fail(
        TETCAST_ERROR_UNSUPPORTED,
        "%s: is of version %g of Gmsh's format; 1, 2 and 4.1 are read, which gmsh -save -format msh41 makes of it",
        reading_.path.c_str(), version_);
  }
  if ((binary != 0 && binary != 1) || (binary && size != 8)) { // In text, the size means nothing.
    in_.fail("0 or 1 and numbers of 8 bytes are known, not '%lld %lld'", static_cast<long long>(binary),
             static_cast<long long>(size));
  }
  in_.line();
  if (!binary)
    return;
  in_.begin_bytes();
  const int64_t one = in_.integer("the number 1");
  if (one == 1)
    return;
  if (one != 0x01000000)
    in_.fail("the number 1 is to come, in one order of bytes or the other");
  in_.swap_bytes();
}

// Reads which physical groups the points, curves, surfaces and volumes are in. In a mesh with partitions, it reads the
// same for the parts that these are divided into.
void Reader::read_entities(bool parts) {
  if (old())
    in_.fail("version %g has no section of entities", version_);
  if (parts) {
    in_.size("the number of partitions");
    const int64_t ghosts = in_.count(in_.size("the number of ghosts"), 8, 4, "ghosts");
    for (int64_t i = 0; i < 2 * ghosts; ++i)
      in_.integer("a ghost's number");
  }
  int64_t counts[4];
  for (int64_t &count : counts)
    count = in_.count(in_.size("a number of entities"), 32, 8, "entities");
  const auto skip_list = [&](const char *what) {
    const int64_t count = in_.count(in_.size("a count"), 4, 2, what);
    for (int64_t i = 0; i < count; ++i)
      in_.integer("the number of an entity");
  };
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (int64_t i = 0; i < counts[dimension]; ++i) {
      const int64_t tag = in_.integer("the number of an entity");
      if (parts) {
        in_.integer("a dimension");
        in_.integer("the number of an entity");
        skip_list("partitions");
      }
      for (int k = 0; k < (dimension ? 6 : 3); ++k)
        in_.number("a coordinate");
      const int64_t groups = in_.count(in_.size("a count"), 4, 2, "groups");
      for (int64_t k = 0; k < groups; ++k) {
        const int64_t group = in_.integer("the number of a group");
        if (k == 0)
          // A negative number is that of a group that is turned round.
          groups_[{dimension, tag}] = group < 0 ? -group : group;
      }
      if (dimension > 0)
        skip_list("bounding entities");
    }
  }
}

void Reader::read_node(int64_t i, int extra) {
  for (int k = 0; k < 3; ++k)
    positions_->SetValue(3 * i + k, in_.number("a coordinate"));
  for (int k = 0; k < extra; ++k)
    in_.number("a parameter");
}

void Reader::read_nodes() {
  if (positions_->GetNumberOfTuples() > 0)
    in_.fail("there is a second section $Nodes");
  positions_->SetNumberOfComponents(3);
  int64_t count = 0;
  if (old()) {
    count = in_.count(in_.text_integer("the number of nodes"), 28, 8, "nodes");
    in_.line();
    positions_->SetNumberOfTuples(count);
    for (int64_t i = 0; i < count; ++i) {
      nodes_.add(in_.integer("the number of a node"), i);
      read_node(i, 0);
    }
  } else {
    const int64_t blocks = in_.size("the number of blocks");
    count = in_.size("the number of nodes");
    in_.size("the smallest number of a node");
    in_.size("the largest number of a node");
    positions_->SetNumberOfTuples(in_.count(count, 32, 8, "nodes"));
    int64_t first = 0;
    for (int64_t block = 0; block < blocks; ++block) {
      const int64_t dimension = in_.integer("a dimension");
      in_.integer("the number of an entity");
      const bool parametric = in_.integer("0 or 1") != 0;
      const int64_t here = in_.count(in_.size("a number of nodes"), 32, 8, "nodes");
      if (dimension < 0 || dimension > 3)
        in_.fail("a dimension of %lld", static_cast<long long>(dimension));
      if (here > count - first)
        in_.fail("there are more nodes than the %lld that were claimed", static_cast<long long>(count));
      for (int64_t i = 0; i < here; ++i)
        nodes_.add(in_.size("the number of a node"), first + i);
      for (int64_t i = 0; i < here; ++i)
        read_node(first + i, parametric ? static_cast<int>(dimension) : 0);
      first += here;
    }
    if (first != count)
      in_.fail("there are %lld nodes of the %lld that were claimed", static_cast<long long>(first),
               static_cast<long long>(count));
  }
  int64_t tag;
  if (nodes_.twice(&tag))
    in_.fail("there are two nodes of number %lld", static_cast<long long>(tag));
}

const ElementType &Reader::type_of(int64_t id) const {
  const ElementType *type = find_type(id);
  if (type)
    return *type;
  tcv::fail(TETCAST_ERROR_UNSUPPORTED,
            "%s: holds elements of Gmsh's type %lld, which are not read: above second order only tetrahedra and "
            "hexahedra with all nodes are",
            reading_.path.c_str(), static_cast<long long>(id));
}

// Reads the nodes of an element, which come next. In version 2 an element of several groups is listed once for each of
// them, one after the other.
void Reader::add_element(const ElementType &type, int64_t tag, int64_t group) {
  const int64_t cells = types_->GetNumberOfValues(), start = corners_->GetNumberOfValues();
  list_.resize(static_cast<size_t>(type.nodes));
  for (int64_t &node : list_) {
    const int64_t number = old() ? in_.integer("the number of a node") : in_.size("the number of a node");
    node = nodes_.find(number);
    if (node < 0)
      in_.fail("element %lld is of node %lld, which there is not", static_cast<long long>(tag),
               static_cast<long long>(number));
  }
  const auto point = [&](int k) {
    return static_cast<vtkIdType>(list_[static_cast<size_t>(type.order ? type.order[k] : k)]);
  };
  if (old() && cells > 0 && group != last_group_ && types_->GetValue(cells - 1) == type.type) {
    int same = 0;
    while (same < type.points && corners_->GetValue(start - type.points + same) == point(same))
      ++same;
    if (same == type.points)
      return elements_.add(tag, cells - 1);
  }
  for (int k = 0; k < type.points; ++k)
    corners_->InsertNextValue(point(k));
  ends_->InsertNextValue(start + type.points);
  types_->InsertNextValue(type.type);
  physical_->InsertNextValue(static_cast<int>(group));
  elements_.add(tag, cells);
  last_group_ = group;
  grouped_ = grouped_ || group != 0;
}

void Reader::read_elements() {
  if (positions_->GetNumberOfTuples() == 0)
    in_.fail("there are no nodes before the elements");
  if (types_->GetNumberOfValues() > 0)
    in_.fail("there is a second section $Elements");
  ends_->InsertNextValue(0);
  if (old()) {
    const int64_t count = in_.count(in_.text_integer("the number of elements"), 8, 6, "elements");
    in_.line();
    for (int64_t done = 0; done < count;) {
      int64_t id = 0, here = 1, tags = 0, number = 0;
      if (in_.binary()) {
        id = in_.integer("the type of elements");
        here = in_.integer("a number of elements");
        if (here < 0 || here > count - done)
          in_.fail("a number of %lld elements", static_cast<long long>(here));
      } else {
        number = in_.integer("the number of an element");
        id = in_.integer("the type of an element");
      }
      tags = first() ? 2 : in_.count(in_.integer("a number of tags"), 4, 2, "tags");
      const ElementType &type = type_of(id);
      for (int64_t i = 0; i < here; ++i) {
        if (in_.binary())
          number = in_.integer("the number of an element");
        int64_t group = 0;
        for (int64_t k = 0; k < tags; ++k) {
          const int64_t tag = in_.integer("a tag");
          if (k == 0)
            group = tag;
        }
        if (first() && in_.integer("a number of nodes") != type.nodes)
          in_.fail("element %lld has not the %d nodes of its type", static_cast<long long>(number), type.nodes);
        add_element(type, number, group);
      }
      done += here;
    }
    return;
  }
  const int64_t blocks = in_.size("the number of blocks"), count = in_.size("the number of elements");
  in_.size("the smallest number of an element");
  in_.size("the largest number of an element");
  in_.count(count, 16, 4, "elements");
  for (int64_t block = 0; block < blocks; ++block) {
    const int64_t dimension = in_.integer("a dimension"), entity = in_.integer("the number of an entity");
    const ElementType &type = type_of(in_.integer("the type of elements"));
    const int64_t here = in_.count(in_.size("a number of elements"), 16, 4, "elements");
    const auto group = groups_.find({dimension, entity});
    for (int64_t i = 0; i < here; ++i)
      add_element(type, in_.size("the number of an element"), group == groups_.end() ? 0 : group->second);
  }
  if (types_->GetNumberOfValues() != count) {
    in_.fail("there are %lld elements of the %lld that were claimed",
             static_cast<long long>(types_->GetNumberOfValues()), static_cast<long long>(count));
  }
}

// ── views ──

// Reads the head of a view: strings, of which the first is the name, numbers, of which the first is the time, and the
// integers step, number of components and number of values. The values come next.
void Reader::read_section(const std::string &name, Section::Kind kind) {
  Section section = {kind, "", 0, 0, 0, in_};
  const int64_t strings = in_.text_integer("a number of names");
  in_.line();
  for (int64_t i = 0; i < strings; ++i) {
    if (in_.left() == 0)
      in_.fail("truncated: a name is to come");
    const std::string text = in_.line();
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    if (i == 0)
      section_name_ = section.name = quoted ? text.substr(1, text.size() - 2) : text;
  }
  const int64_t reals = in_.text_integer("a number of times");
  for (int64_t i = 0; i < reals; ++i) {
    const double value = in_.text_number("a time");
    if (i == 0)
      section.time = value;
  }
  const int64_t integers = in_.text_integer("a number of integers");
  for (int64_t i = 0; i < integers; ++i) {
    const int64_t value = in_.text_integer("an integer");
    if (i == 1)
      section.components = value;
    if (i == 2)
      section.count = value;
  }
  if (!std::isfinite(section.time))
    in_.fail("a time of %g", section.time);
  if (section.components < 1 || section.components > 9)
    in_.fail("values of %lld components", static_cast<long long>(section.components));
  const int64_t values = kind == Section::OF_ELEMENTS_NODES ? 1 : section.components;
  in_.count(section.count, 4 + 8 * values, 2 + 2 * values, "values");
  in_.line();
  section.at = in_;
  sections_.push_back(section);
  in_.skip_section(name);
}

// Returns for each node the mean of the values that its elements have there.
void Reader::read_corner_values(Section *section, vtkDoubleArray *array) {
  array->FillValue(0);
  std::vector<int32_t> terms(static_cast<size_t>(array->GetNumberOfTuples()), 0);
  const int64_t width = section->components;
  std::vector<double> values;
  for (int64_t i = 0; i < section->count; ++i) {
    const int64_t cell = elements_.find(section->at.integer("the number of an element"));
    const int64_t nodes = section->at.count(section->at.integer("a number of nodes"), 8 * width, 2 * width, "values");
    values.resize(static_cast<size_t>(nodes * width));
    for (double &value : values)
      value = section->at.number("a value");
    if (cell < 0)
      section->at.fail("a value is of an element that there is not");
    const vtkIdType points = ends_->GetValue(cell + 1) - ends_->GetValue(cell);
    const auto type = std::find_if(all_types().begin(), all_types().end(), [&](const ElementType &one) {
      return one.type == types_->GetValue(cell) && one.points == points;
    });
    if (nodes > type->nodes)
      section->at.fail("an element of %d nodes has values at %lld", type->nodes, static_cast<long long>(nodes));
    for (int k = 0; k < std::min(type->nodes, type->points); ++k) {
      const int from = type->order ? type->order[k] : k;
      if (from >= nodes)
        continue;
      const vtkIdType point = corners_->GetValue(ends_->GetValue(cell) + k);
      for (int64_t c = 0; c < width; ++c)
        array->SetValue(point * width + c,
                        array->GetValue(point * width + c) + values[static_cast<size_t>(from * width + c)]);
      ++terms[static_cast<size_t>(point)];
    }
  }
  for (int64_t i = 0; i < array->GetNumberOfTuples(); ++i) { // Without any, 0/0 gives NaN, which is transparent.
    for (int64_t c = 0; c < width; ++c)
      array->SetValue(i * width + c, array->GetValue(i * width + c) / terms[static_cast<size_t>(i)]);
  }
}

// Makes an array that is NaN where the view has no value.
vtkSmartPointer<vtkDoubleArray> Reader::values_of(Section *section) {
  const bool of_elements = section->kind == Section::OF_ELEMENTS;
  const int64_t count = of_elements ? types_->GetNumberOfValues() : positions_->GetNumberOfTuples(),
                width = section->components;
  taken_ += 8 * static_cast<uint64_t>(count * width);
  if (taken_ / 256 > bytes_)
    section->at.fail("truncated or damaged: there are more views than there is data");
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(section->name.c_str());
  array->SetNumberOfComponents(static_cast<int>(width));
  array->SetNumberOfTuples(count);
  if (section->kind == Section::OF_ELEMENTS_NODES) {
    read_corner_values(section, array);
    return array;
  }
  array->FillValue(std::nan(""));
  for (int64_t i = 0; i < section->count; ++i) {
    const int64_t tag = section->at.integer(of_elements ? "the number of an element" : "the number of a node");
    const int64_t at = (of_elements ? elements_ : nodes_).find(tag);
    if (at < 0)
      section->at.fail("a value is of %s %lld, which there is not", of_elements ? "element" : "node",
                       static_cast<long long>(tag));
    for (int64_t k = 0; k < width; ++k)
      array->SetValue(at * width + k, section->at.number("a value"));
  }
  return array;
}

// Returns what the message says without the name of the file in front of it.
std::string Reader::reason_of(const tcv::Failure &failure) const {
  const std::string place = reading_.path + ": ";
  return failure.text.compare(0, place.size(), place) == 0 ? failure.text.substr(place.size()) : failure.text;
}

// Reads a section of values. The mesh does not depend on it, so a failure is noted and the section is left out.
void Reader::try_section(const std::string &name, Section::Kind kind, tcv::Contents *contents) {
  const tcv::GmshCursor begin = in_;
  section_name_ = "$" + name;
  try {
    read_section(name, kind);
  } catch (const tcv::Failure &failure) {
    in_ = begin;
    in_.skip_section(name); // This fails if the section does not end.
    tcv::note_unread(&contents->unread, {kind == Section::OF_ELEMENTS ? TETCAST_CELL : TETCAST_POINT, section_name_},
                     reason_of(failure));
  }
}

// Adds one section of each view: the last one that is not after the step, or the first one if all are.
void Reader::add_views(vtkUnstructuredGrid *grid, tcv::Contents *contents) {
  for (const Section &section : sections_)
    contents->times.push_back(section.time);
  std::sort(contents->times.begin(), contents->times.end());
  contents->times.erase(std::unique(contents->times.begin(), contents->times.end()), contents->times.end());
  contents->step = tcv::choose_step(reading_.path, *reading_.desc, contents->times);
  const double now = contents->times.empty() ? 0 : contents->times[static_cast<size_t>(contents->step)];
  std::stable_sort(sections_.begin(), sections_.end(),
                   [](const Section &a, const Section &b) { return a.time < b.time; });
  std::vector<Section *> wanted;
  for (Section &section : sections_) {
    const auto found = std::find_if(wanted.begin(), wanted.end(), [&](const Section *one) {
      return one->name == section.name && one->kind == section.kind;
    });
    if (found == wanted.end())
      wanted.push_back(&section);
    else if (section.time <= now)
      *found = &section;
  }
  for (Section *section : wanted) {
    const bool of_elements = section->kind == Section::OF_ELEMENTS;
    const tcv::ArrayName name = {of_elements ? TETCAST_CELL : TETCAST_POINT, section->name};
    if (!tcv::may_name(reading_.desc->only, name.name)) {
      tcv::note_unread(&contents->unread, name, "");
      continue;
    }
    try {
      const auto array = values_of(section);
      if (of_elements)
        grid->GetCellData()->AddArray(array);
      else
        grid->GetPointData()->AddArray(array);
    } catch (const tcv::Failure &failure) {
      tcv::note_unread(&contents->unread, name, reason_of(failure));
    }
  }
}

tcv::Grid Reader::make_grid() {
  auto grid = tcv::Grid::New();
  vtkNew<vtkPoints> points;
  points->SetData(positions_);
  grid->SetPoints(points);
  vtkNew<vtkCellArray> cells;
  cells->SetData(ends_, corners_);
  grid->SetCells(types_, cells);
  return grid;
}

void Reader::read(tcv::Contents *contents) {
  std::string name;
  while (in_.next_section(&name)) {
    if (version_ == 0 && name == "NOD")
      version_ = 1;
    if (version_ == 0 && name != "MeshFormat" && name != "Comments")
      in_.fail("section $MeshFormat is to come first");
    if (name == "MeshFormat" && version_ == 0)
      read_format();
    else if (name == "Entities" || name == "PartitionedEntities")
      read_entities(name[0] == 'P');
    else if (name == (first() ? "NOD" : "Nodes"))
      read_nodes();
    else if (name == (first() ? "ELM" : "Elements"))
      read_elements();
    else {
      if (name == "NodeData")
        try_section(name, Section::OF_NODES, contents);
      else if (name == "ElementData")
        try_section(name, Section::OF_ELEMENTS, contents);
      else if (name == "ElementNodeData")
        try_section(name, Section::OF_ELEMENTS_NODES, contents);
      else
        in_.skip_section(name);
      continue;
    }
    in_.end_section(name);
  }
  if (types_->GetNumberOfValues() == 0)
    in_.fail("holds no elements; truncated?");
  const tcv::Grid grid = make_grid();
  add_views(grid, contents);
  if (grouped_ && !tcv::may_name(reading_.desc->only, "physical")) {
    tcv::note_unread(&contents->unread, {TETCAST_CELL, "physical"}, "");
  } else if (grouped_) {
    physical_->SetName("physical");
    grid->GetCellData()->AddArray(physical_);
  }
  tcv::add_grid(reading_, reading_.block, grid, contents);
}

} // namespace

namespace tcv {

void read_gmsh(const Reading &reading, Contents *contents) {
  const std::string bytes = file_contents(reading.path.c_str());
  const size_t begin = bytes.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos || bytes[begin] != '$') {
    fail(TETCAST_ERROR_DATA,
         "%s: is not a Gmsh file: these begin with $MeshFormat or $NOD; other programs call files .msh, too",
         reading.path.c_str());
  }
  Reader(reading, bytes).read(contents);
}

} // namespace tcv
