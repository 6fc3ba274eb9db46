// SPDX-License-Identifier: Apache-2.0
// Reads legacy .vtk files. VTK's own loops over their sections write beyond their memory if counts or cells are
// damaged, and give up at numbers such as NaN. Its functions for single words are sound, and are used here.
#include "common.hpp"
#include "files.hpp"
#include "formats.hpp"
#include "numbers.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include <vtkBitArray.h>
#include <vtkByteSwap.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataReader.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>

namespace {

using CellArray = vtkSmartPointer<vtkCellArray>;

class Reader : public vtkDataReader {
public:
  static Reader *New() { VTK_STANDARD_NEW_BODY(Reader); }
  using vtkDataReader::DecodeString;
};

// Why an array can't be read. `behind` says whether the stream is where the next thing begins, as far as one can tell.
struct Unreadable {
  std::string reason;
  bool behind;
};

// The types of values, by the letters that their names begin with. If several rows fit a name, the first counts.
const struct {
  const char *name;
  int type, size; // The type for VTK, and the bytes of a value in the file; 0: values are single bits.
} value_types[] = {{"bit", VTK_BIT, 0},
                   {"char", VTK_CHAR, 1},
                   {"signed_char", VTK_CHAR, 1},
                   {"unsigned_char", VTK_UNSIGNED_CHAR, 1},
                   {"short", VTK_SHORT, 2},
                   {"unsigned_short", VTK_UNSIGNED_SHORT, 2},
                   {"vtkidtype", VTK_ID_TYPE, 4},
                   {"int", VTK_INT, 4},
                   {"unsigned_int", VTK_UNSIGNED_INT, 4},
                   {"long", VTK_LONG, 8},
                   {"unsigned_long", VTK_UNSIGNED_LONG, 8},
                   {"vtktypeint64", VTK_LONG_LONG, 8},
                   {"vtktypeuint64", VTK_UNSIGNED_LONG_LONG, 8},
                   {"float", VTK_FLOAT, 4},
                   {"double", VTK_DOUBLE, 8}};

const char *const attribute_keywords[] = {"scalars",
                                          "vectors",
                                          "normals",
                                          "tensors",
                                          "tensors6",
                                          "field",
                                          "global_ids",
                                          "pedigree_ids",
                                          "edge_flags",
                                          "color_scalars",
                                          "texture_coordinates",
                                          "lookup_table",
                                          "point_data",
                                          "cell_data",
                                          "metadata"};

std::string lower_case(std::string text) {
  for (char &c : text)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

bool is_attribute_keyword(const std::string &word) {
  const std::string lower = lower_case(word);
  return std::any_of(std::begin(attribute_keywords), std::end(attribute_keywords),
                     [&](const char *one) { return lower == one; });
}

void swap_bytes(void *values, int64_t count, int size) {
  if (size == 2)
    vtkByteSwap::Swap2BERange(values, static_cast<size_t>(count));
  if (size == 4)
    vtkByteSwap::Swap4BERange(values, static_cast<size_t>(count));
  if (size == 8)
    vtkByteSwap::Swap8BERange(values, static_cast<size_t>(count));
}

class LegacyFile {
public:
  explicit LegacyFile(const char *path, std::vector<tcv::UnreadArray> *unread = nullptr)
      : path_(path), size_(tcv::file_size(path)), unread_(unread) {
    if (!reader_->OpenVTKFile(path) || !reader_->ReadHeader(path) || !next() || !is("dataset") || !next())
      damaged("the header");
  }
  LegacyFile(const char *path, const char *type, std::vector<tcv::UnreadArray> *unread = nullptr)
      : LegacyFile(path, unread) {
    if (!is(type))
      damaged("the header");
  }
  ~LegacyFile() { reader_->CloseVTKFile(); }
  LegacyFile(const LegacyFile &) = delete;
  LegacyFile &operator=(const LegacyFile &) = delete;

  bool next() { return reader_->ReadString(word_) != 0; } // Goes to the next keyword.
  bool is(const char *keyword) { return std::strcmp(reader_->LowerCase(word_), keyword) == 0; }

  // Reads a section that every dataset may have. Returns false if it is another one.
  bool common_section(vtkPointSet *dataset) {
    if (is("field")) {
      read_field(nullptr);
    } else if (is("metadata")) {
      skip_metadata();
    } else if (is("points") && dataset) {
      const int64_t points = count("POINTS");
      vtkNew<vtkPoints> positions;
      positions->SetData(needed("POINTS", word("POINTS"), points, 3));
      dataset->SetPoints(positions);
    } else {
      return false;
    }
    return true;
  }

  CellArray cells(const char *section) {
    auto result = CellArray::New();
    const int64_t cells = count(section), size = count(section);
    if (reader_->GetFileMajorVersion() >= 5) {
      const auto offsets = part("offsets", cells), indices = part("connectivity", size);
      if (cells > 0 && !result->SetData(offsets, indices))
        damaged(section);
      return result;
    }
    const auto list = needed(section, "int", size, 1);
    const int *stream = static_cast<const int *>(list->GetVoidPointer(0));
    vtkNew<vtkIdTypeArray> offsets, indices;
    offsets->SetNumberOfValues(cells + 1);
    offsets->SetValue(0, 0);
    indices->SetNumberOfValues(size < cells ? 0 : size - cells);
    int64_t at = 0, used = 0;
    for (int64_t i = 0; i < cells; ++i) {
      const int64_t corners = at < size ? stream[at++] : -1;
      if (corners < 0 || corners > size - at || used + corners > indices->GetNumberOfValues()) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: %s: cell %lld does not fit into the %lld numbers there are", path_, section,
                  static_cast<long long>(i), static_cast<long long>(size));
      }
      for (int64_t j = 0; j < corners; ++j)
        indices->SetValue(used++, stream[at++]);
      offsets->SetValue(i + 1, used);
    }
    result->SetData(offsets, indices);
    return result;
  }

  vtkSmartPointer<vtkUnsignedCharArray> cell_types() {
    const int64_t size = count("CELL_TYPES");
    const auto list = needed("CELL_TYPES", "int", size, 1);
    const int *types = static_cast<const int *>(list->GetVoidPointer(0));
    auto result = vtkSmartPointer<vtkUnsignedCharArray>::New();
    result->SetNumberOfValues(size);
    for (int64_t i = 0; i < size; ++i) {
      if (types[i] < 0 || types[i] > 255) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: there is no cell type %d", path_, static_cast<long long>(i),
                  types[i]);
      }
      result->SetValue(i, static_cast<unsigned char>(types[i]));
    }
    return result;
  }

  // Reads what structured grids have: the section DIMENSIONS, and the sections of evenly spaced grids.
  void dimensions(int result[3]) {
    int64_t points = 1;
    for (int k = 0; k < 3; ++k) {
      const int64_t value = count("DIMENSIONS");
      points = value <= 0 || points > 4096 * size_ / value ? 0 : points * value;
      result[k] = static_cast<int>(value);
      if (points == 0 || value > INT32_MAX) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: DIMENSIONS claim more points than the file can hold, or none", path_);
      }
    }
  }
  void numbers(const char *section, double result[3]) {
    if (tcv::NumberReader(stream()).read(result, 3) < 3)
      damaged(section);
  }
  vtkSmartPointer<vtkDataArray> coordinates(const char *section, int64_t wanted) {
    const int64_t values_here = count(section);
    if (values_here != wanted) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: %s are %lld, not %lld", path_, section, static_cast<long long>(values_here),
                static_cast<long long>(wanted));
    }
    return needed(section, word(section), wanted, 1);
  }

  // Reads the attributes, from the keyword POINT_DATA or CELL_DATA to the end of the file. It notes which arrays can't
  // be read.
  void attributes(vtkDataSet *dataset) {
    vtkDataSetAttributes *target = nullptr;
    int64_t have = 0;
    do {
      const bool points = is("point_data");
      if (points || is("cell_data")) {
        association_ = points ? TETCAST_POINT : TETCAST_CELL;
        target = dataset->GetPointData();
        if (!points)
          target = dataset->GetCellData();
        have = count(points ? "POINT_DATA" : "CELL_DATA");
      } else if (!target) {
        damaged("the keyword", word_);
      } else if (!try_attribute(target, have)) {
        return;
      }
    } while (next());
  }

  [[noreturn]] void damaged(const char *section, const char *word = "") const {
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s%s%s can't be read", path_, section, *word ? " " : "",
              word);
  }

private:
  using Array = vtkSmartPointer<vtkDataArray>;

  std::istream &stream() { return *reader_->GetIStream(); }
  bool binary() { return reader_->GetFileType() == VTK_BINARY; }

  // Reads the attribute whose keyword has been read. Returns false if nothing behind it can be read any more.
  bool try_attribute(vtkDataSetAttributes *target, int64_t have) {
    name_ = word_;
    std::string reason;
    try {
      attribute(target, have);
      return true;
    } catch (const Unreadable &unreadable) {
      reason = unreadable.reason;
    } catch (const tcv::Failure &failure) {
      const std::string place = std::string(path_) + ": ";
      reason = failure.text.compare(0, place.size(), place) == 0 ? failure.text.substr(place.size()) : failure.text;
    }
    lose(reason);
    stream().clear();
    while (!binary() && next()) { // Goes to where the next thing begins.
      if (!is_attribute_keyword(word_))
        continue;
      stream().seekg(-static_cast<std::streamoff>(std::strlen(word_)), std::ios::cur);
      return true;
    }
    return false;
  }

  void lose(const std::string &reason) {
    if (unread_)
      tcv::note_unread(unread_, {association_, name_}, reason);
  }

  void attribute(vtkDataSetAttributes *target, int64_t have) {
    static const struct {
      const char *keyword;
      int components, attribute;
    } plain[] = {
        {"vectors", 3, vtkDataSetAttributes::VECTORS},      {"normals", 3, vtkDataSetAttributes::NORMALS},
        {"tensors", 9, vtkDataSetAttributes::TENSORS},      {"tensors6", 6, vtkDataSetAttributes::TENSORS},
        {"global_ids", 1, vtkDataSetAttributes::GLOBALIDS}, {"pedigree_ids", 1, vtkDataSetAttributes::PEDIGREEIDS},
        {"edge_flags", 1, vtkDataSetAttributes::EDGEFLAG}};
    if (is("scalars"))
      return read_scalars(target, have);
    if (is("field"))
      return read_field(target);
    if (is("metadata"))
      return skip_metadata();
    if (is("lookup_table"))
      return skip_lookup_table();
    if (is("color_scalars")) {
      begin_array(word("COLOR_SCALARS"));
      const int64_t components = count("COLOR_SCALARS");
      return add(target, values(binary() ? "unsigned_char" : "float", have, components), -1);
    }
    if (is("texture_coordinates")) {
      begin_array(word("TEXTURE_COORDINATES"));
      const int64_t components = count("TEXTURE_COORDINATES");
      return add(target, values(word("TEXTURE_COORDINATES"), have, components), -1);
    }
    for (const auto &entry : plain) {
      if (!is(entry.keyword))
        continue;
      begin_array(word(entry.keyword));
      return add(target, values(word(entry.keyword), have, entry.components), entry.attribute);
    }
    damaged("the keyword", word_);
  }

  // Reads "SCALARS name type [components]", which "LOOKUP_TABLE name" follows as a rule.
  void read_scalars(vtkDataSetAttributes *target, int64_t have) {
    char line[256], name[256] = "", type[256] = "";
    int components = 1;
    if (!reader_->ReadLine(line) || std::sscanf(line, "%255s %255s %d", name, type, &components) < 2)
      damaged("SCALARS");
    begin_array(name);
    skip_table_name();
    add(target, values(type, have, components), vtkDataSetAttributes::SCALARS);
  }

  // Reads the line LOOKUP_TABLE if it comes next. If it does not, the stream stays where it was, at the end of the line
  // before.
  void skip_table_name() {
    static const std::string keyword = "lookup_table";
    std::istream &in = stream();
    const std::istream::pos_type here = in.tellg();
    std::string letters;
    while (letters.size() < keyword.size()) {
      const int c = in.get();
      if (c == EOF || (letters.empty() && binary() && c == 0))
        break;
      if (!(letters.empty() && c <= ' '))
        letters += static_cast<char>(c);
      else if (binary())
        break; // Anything may be a number here.
    }
    in.clear();
    if (lower_case(letters) == keyword) {
      word("LOOKUP_TABLE");
      return;
    }
    in.seekg(here);
    in.seekg(-1, std::ios::cur);
  }

  // Reads "FIELD name count", and then for each array its name, its numbers of components and tuples, and its type.
  // Without a target it passes over the arrays.
  void read_field(vtkDataSetAttributes *target) {
    word("FIELD");
    const int64_t arrays = count("FIELD");
    for (int64_t i = 0; i < arrays; ++i) {
      std::string name = word("FIELD");
      while (is("metadata")) { // These belong to the array before.
        skip_metadata();
        name = word("FIELD");
      }
      if (name == "NULL_ARRAY")
        continue;
      begin_array(name);
      const int64_t components = count("FIELD"), tuples = count("FIELD");
      try {
        const Array array = values(word("FIELD"), tuples, components);
        if (target && array)
          add(target, array, -1);
      } catch (const Unreadable &unreadable) {
        if (!unreadable.behind)
          throw;
        if (target)
          lose(unreadable.reason);
      }
    }
  }

  void skip_lookup_table() {
    word("LOOKUP_TABLE");
    values(binary() ? "unsigned_char" : "float", count("LOOKUP_TABLE"), 4);
  }

  void skip_metadata() { // They end with an empty line.
    char line[256];
    reader_->ReadLine(line);
    while (reader_->ReadLine(line) && line[0] != '\0') {}
  }

  Array part(const char *keyword, int64_t size) {
    if (!next() || !is(keyword))
      damaged("the list of cells");
    const Array numbers = needed("the list of cells", word(keyword), size, 1);
    const int type = numbers->GetDataType();
    if (type != VTK_INT && type != VTK_LONG && type != VTK_LONG_LONG && type != VTK_ID_TYPE)
      damaged("the list of cells");
    return numbers;
  }

  // Reads values that a mesh can't do without, and fails if that is not possible.
  Array needed(const char *section, const std::string &type, int64_t tuples, int64_t components) {
    try {
      const Array array = values(type, tuples, components);
      if (array)
        return array;
      damaged(section);
    } catch (const Unreadable &unreadable) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s can't be read: %s", path_, section,
                unreadable.reason.c_str());
    }
  }

  // Reads the values that come next. Returns null for strings, which are passed over.
  Array values(const std::string &type_name, int64_t tuples, int64_t components) {
    const std::string lower = lower_case(type_name);
    // A byte holds eight bits, which are values, too.
    if (components < 1 || components > 8 * size_ || tuples > 8 * size_ / components) {
      throw Unreadable{std::to_string(tuples) + " × " + std::to_string(components) +
                           " values are more than the file can hold",
                       false};
    }
    const int64_t count = tuples * components;
    if (lower.compare(0, 6, "string") == 0 || lower.compare(0, 11, "utf8_string") == 0)
      return skip_strings(count), nullptr;
    const auto *type = std::find_if(std::begin(value_types), std::end(value_types), [&](const auto &one) {
      return lower.compare(0, std::strlen(one.name), one.name) == 0 &&
             (std::strcmp(one.name, "char") != 0 || lower == "char");
    });
    if (type == std::end(value_types))
      throw Unreadable{"there is no type '" + type_name + "'", false};
    const int64_t left = size_ - static_cast<int64_t>(stream().tellg());
    const int64_t bytes = type->size ? count * type->size : (count + 7) / 8;
    if (binary() ? bytes > left : count > (left + 1) / 2)
      throw Unreadable{"it has less data than the " + std::to_string(count) + " values it should have", false};
    return binary() ? binary_values(type->type, type->size, tuples, components)
                    : text_values(type->type, tuples, components);
  }

  static Array make_array(int type, int64_t tuples, int64_t components) {
    auto array = Array::Take(vtkDataArray::CreateDataArray(type));
    array->SetNumberOfComponents(static_cast<int>(components));
    array->SetNumberOfTuples(tuples);
    return array;
  }

  // Reads values as bytes. They begin behind the end of the line, and each has its most significant byte first.
  Array binary_values(int type, int size, int64_t tuples, int64_t components) {
    std::istream &in = stream();
    for (int c = in.get(); c != '\n' && c != EOF; c = in.get()) {}
    const int64_t count = tuples * components;
    const bool narrow = type == VTK_ID_TYPE; // VTK writes these as four bytes.
    Array array = make_array(narrow ? VTK_INT : type, tuples, components);
    const int64_t bytes = size ? count * size : (count + 7) / 8;
    if (bytes > 0)
      in.read(static_cast<char *>(array->GetVoidPointer(0)), bytes);
    if (!in)
      throw Unreadable{"it ends early", false};
    if (size > 1)
      swap_bytes(array->GetVoidPointer(0), count, size);
    if (!narrow)
      return array;
    auto wide = vtkSmartPointer<vtkIdTypeArray>::New();
    wide->DeepCopy(array);
    return wide;
  }

  template <typename T> void read_text(T *values, int64_t count, bool *overflowed) {
    tcv::NumberReader reader(stream());
    const int64_t have = reader.read(values, count);
    *overflowed = reader.overflowed();
    if (have == count)
      return;
    const std::string bad = reader.word();
    if (bad.empty())
      throw Unreadable{"it has " + std::to_string(have) + " of " + std::to_string(count) + " values", false};
    const std::string reason =
        "line " + std::to_string(line()) + ": '" + bad.substr(0, 40) + "' is not a number of its type";
    std::string word = bad;
    // Passes over the rest of the values. If one is a keyword, there are fewer than the file says.
    for (int64_t i = have + 1;; ++i) {
      if (is_attribute_keyword(word)) {
        stream().seekg(-static_cast<std::streamoff>(word.size()), std::ios::cur);
        throw Unreadable{word == bad ? "it has " + std::to_string(have) + " of " + std::to_string(count) + " values"
                                     : reason,
                         false};
      }
      if (i >= count || !(stream() >> word))
        break;
    }
    throw Unreadable{reason, true};
  }

  // Reads values as text. Some files say that their values are float, though these have more digits or a larger range;
  // the array is then of double.
  Array text_values(int type, int64_t tuples, int64_t components) {
    const int64_t count = tuples * components;
    const auto start = stream().tellg();
    bool overflowed = false;
    if (type == VTK_BIT) {
      Array array = make_array(VTK_UNSIGNED_CHAR, tuples, components);
      read_text(static_cast<unsigned char *>(array->GetVoidPointer(0)), count, &overflowed);
      auto bits = vtkSmartPointer<vtkBitArray>::New();
      bits->DeepCopy(array);
      return bits;
    }
    Array array = make_array(type, tuples, components);
    switch (type) { vtkTemplateMacro(read_text(static_cast<VTK_TT *>(array->GetVoidPointer(0)), count, &overflowed)); }
    if (!overflowed || type != VTK_FLOAT)
      return array;
    stream().clear();
    stream().seekg(start);
    array = make_array(VTK_DOUBLE, tuples, components);
    read_text(static_cast<double *>(array->GetVoidPointer(0)), count, &overflowed);
    return array;
  }

  // Passes over strings. In text there is one a line. In binary, each has its length in front, whose first two bits say
  // how many bytes the length itself has.
  void skip_strings(int64_t count) {
    std::istream &in = stream();
    std::string line;
    std::getline(in, line);
    for (int64_t i = 0; i < count && in; ++i) {
      if (!binary()) {
        std::getline(in, line);
        continue;
      }
      const int first = in.get();
      const int more = first >> 6 == 3 ? 0 : first >> 6 == 2 ? 1 : first >> 6 == 1 ? 3 : 7;
      uint64_t length = static_cast<uint64_t>(first & (more == 7 ? 255 : 63));
      for (int k = 0; k < more; ++k)
        length = length << 8 | static_cast<uint64_t>(in.get() & 255);
      if (first == EOF || length > static_cast<uint64_t>(size_))
        throw Unreadable{"its strings are damaged", false};
      in.seekg(static_cast<std::streamoff>(length), std::ios::cur);
    }
    if (!in)
      throw Unreadable{"it ends early", false};
  }

  // Returns the number of the line that the stream has come to, counted from 1.
  int64_t line() {
    std::istream &in = stream();
    in.clear();
    const auto here = in.tellg();
    in.seekg(0);
    int64_t lines = 1;
    std::vector<char> part(1 << 16);
    for (int64_t left = here; left > 0;) {
      in.read(part.data(), std::min<int64_t>(left, static_cast<int64_t>(part.size())));
      const auto got = in.gcount();
      if (got <= 0)
        break;
      lines += std::count(part.begin(), part.begin() + got, '\n');
      left -= got;
    }
    in.clear();
    in.seekg(here);
    return lines;
  }

  void begin_array(const std::string &name) {
    std::vector<char> decoded(name.size() + 1); // Names have %20 and the like in them.
    reader_->DecodeString(decoded.data(), name.c_str());
    name_ = decoded.data();
  }

  void add(vtkDataSetAttributes *target, vtkDataArray *array, int attribute) {
    if (!array)
      return;
    if (target->HasArray(name_.c_str()))
      return lose("it is the second of that name");
    array->SetName(name_.c_str());
    const int index = target->AddArray(array);
    if (attribute >= 0 && !target->GetAbstractAttribute(attribute))
      target->SetActiveAttribute(index, attribute);
  }

  std::string word(const char *section) {
    if (!next())
      damaged(section);
    return word_;
  }

  int64_t count(const char *section) {
    vtkIdType value = -1;
    if (!reader_->Read(&value))
      damaged(section);
    if (value < 0 || value > size_) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: %s claims a count of %lld, which the file can't hold", path_, section,
                static_cast<long long>(value));
    }
    return value;
  }

  const char *path_;
  int64_t size_;
  std::vector<tcv::UnreadArray> *unread_;
  vtkNew<Reader> reader_;
  char word_[256] = "";
  std::string name_; // The name of the array that is being read.
  TetcastAssociation association_ = TETCAST_POINT;
};

// Checks polyhedra. They are written as a stream: the number of faces, and then for each face its number of points and
// the points.
void check_face_streams(const char *path, vtkUnsignedCharArray *types, vtkCellArray *cells, int64_t point_count) {
  for (int64_t i = 0; i < cells->GetNumberOfCells(); ++i) {
    if (types->GetValue(i) != VTK_POLYHEDRON)
      continue;
    vtkIdType size;
    const vtkIdType *stream;
    cells->GetCellAtId(i, size, stream);
    int64_t at = 1;
    bool good = size > 0 && stream[0] >= 4;
    for (int64_t face = 0; good && face < stream[0]; ++face) {
      const int64_t corners = at < size ? stream[at++] : -1;
      good = corners >= 3 && corners <= size - at;
      for (int64_t j = 0; good && j < corners; ++j, ++at)
        good = stream[at] >= 0 && stream[at] < point_count;
    }
    if (!good || at != size) {
      tcv::fail(TETCAST_ERROR_DATA, "%s: cell %lld: the list of the polyhedron's faces is damaged", path,
                static_cast<long long>(i));
    }
  }
}

// Checks that offsets lie within the list. Indices are checked by those who use them.
void check_offsets(const char *path, vtkCellArray *cells) {
  tcv::check_cells(path, cells, -1, "cell");
}

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const char *path, std::vector<tcv::UnreadArray> *unread) {
  LegacyFile file(path, "unstructured_grid", unread);
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  CellArray cells;
  vtkSmartPointer<vtkUnsignedCharArray> types;
  while (file.next()) {
    if (file.common_section(grid))
      continue;
    if (file.is("cells")) {
      cells = file.cells("CELLS");
    } else if (file.is("cell_types")) {
      types = file.cell_types();
      if (!cells || cells->GetNumberOfCells() != types->GetNumberOfValues()) {
        tcv::fail(TETCAST_ERROR_DATA, "%s: CELL_TYPES of %lld cells, but CELLS has %lld", path,
                  static_cast<long long>(types->GetNumberOfValues()),
                  static_cast<long long>(cells ? cells->GetNumberOfCells() : 0));
      }
      // The grid learns of its cells only now, as the lists of points of polyhedra have other numbers in them.
      check_offsets(path, cells);
      check_face_streams(path, types, cells, grid->GetNumberOfPoints());
      grid->SetCells(types, cells);
    } else {
      file.attributes(grid);
      break;
    }
  }
  if (cells && !types)
    tcv::fail(TETCAST_ERROR_DATA, "%s: truncated: there are CELLS, but no CELL_TYPES", path);
  return grid;
}

vtkSmartPointer<vtkDataSet> read_image(LegacyFile *file) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  while (file->next()) {
    double numbers[3];
    int dimensions[3];
    if (file->common_section(nullptr))
      continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      image->SetDimensions(dimensions);
    } else if (file->is("origin")) {
      file->numbers("ORIGIN", numbers);
      image->SetOrigin(numbers);
    } else if (file->is("spacing") || file->is("aspect_ratio")) {
      file->numbers("SPACING", numbers);
      image->SetSpacing(numbers);
    } else {
      file->attributes(image);
      break;
    }
  }
  return image;
}

vtkSmartPointer<vtkDataSet> read_rectilinear(LegacyFile *file) {
  auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
  int dimensions[3] = {0, 0, 0};
  while (file->next()) {
    if (file->common_section(nullptr))
      continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      grid->SetDimensions(dimensions);
    } else if (file->is("x_coordinates")) {
      grid->SetXCoordinates(file->coordinates("X_COORDINATES", dimensions[0]));
    } else if (file->is("y_coordinates")) {
      grid->SetYCoordinates(file->coordinates("Y_COORDINATES", dimensions[1]));
    } else if (file->is("z_coordinates")) {
      grid->SetZCoordinates(file->coordinates("Z_COORDINATES", dimensions[2]));
    } else {
      file->attributes(grid);
      break;
    }
  }
  vtkDataArray *const axes[3] = {grid->GetXCoordinates(), grid->GetYCoordinates(), grid->GetZCoordinates()};
  for (int k = 0; k < 3; ++k) { // VTK makes an array of a single value if there is none.
    if (axes[k]->GetNumberOfTuples() != dimensions[k])
      file->damaged("the list of coordinates");
  }
  return grid;
}

vtkSmartPointer<vtkDataSet> read_structured(LegacyFile *file) {
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  int dimensions[3];
  while (file->next()) {
    if (file->common_section(grid))
      continue;
    if (file->is("dimensions")) {
      file->dimensions(dimensions);
      grid->SetDimensions(dimensions);
    } else {
      file->attributes(grid);
      break;
    }
  }
  return grid;
}

} // namespace

namespace tcv {

void read_legacy_grid(const Reading &reading, Contents *contents) {
  const auto grid = captured(reading.context, reading.path.c_str(),
                             [&] { return read_grid(reading.path.c_str(), &contents->unread); });
  add_grid(reading, reading.block, grid, contents);
}

void read_legacy_structured(const Reading &reading, Contents *contents) {
  const auto grid = captured(reading.context, reading.path.c_str(), [&] {
    LegacyFile file(reading.path.c_str(), &contents->unread);
    if (file.is("rectilinear_grid"))
      return read_rectilinear(&file);
    return file.is("structured_grid") ? read_structured(&file) : read_image(&file);
  });
  add_grid(reading, reading.block, grid, contents);
}

vtkSmartPointer<vtkPolyData> read_legacy_surface(const char *path) {
  LegacyFile file(path, "polydata");
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  while (file.next()) {
    if (file.common_section(surface))
      continue;
    if (file.is("polygons"))
      surface->SetPolys(file.cells("POLYGONS"));
    else if (file.is("triangle_strips"))
      surface->SetStrips(file.cells("TRIANGLE_STRIPS"));
    else if (file.is("vertices") || file.is("lines"))
      file.cells("VERTICES or LINES");
    else if (file.is("cell_data") || file.is("point_data"))
      break; // The dataset is a surface, and its shape is all that is needed.
    else
      file.damaged("a section");
  }
  return surface;
}

} // namespace tcv
