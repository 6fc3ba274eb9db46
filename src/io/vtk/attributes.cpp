// SPDX-License-Identifier: Apache-2.0
#include "attributes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkPointData.h>

#include "common.hpp"

namespace {

using tcv::PieceMap;

// An array of the whole grid, and the arrays of the pieces that it is made from.
struct Column {
  std::string name;
  std::vector<vtkDataArray *> parts; // A part is null if its piece lacks the array.
  int components = 0, missing = 0, attribute = -1;
  // `mixed`: the parts differ in their number of components. `numbers`: the array numbers points or cells.
  bool mixed = false, numbers = false;
  vtkSmartPointer<vtkDataArray> whole;
};

Column *column_of(std::vector<Column> *columns, const std::string &name, size_t pieces) {
  for (Column &column : *columns) {
    if (column.name == name)
      return &column;
  }
  columns->emplace_back();
  columns->back().name = name;
  columns->back().parts.resize(pieces);
  return &columns->back();
}

std::vector<Column> columns_of(const std::vector<tcv::Piece> &pieces, TetcastAssociation association,
                               std::vector<tcv::UnreadArray> *unread) {
  const bool of_points = association == TETCAST_POINT;
  std::vector<Column> columns;
  for (size_t p = 0; p < pieces.size(); ++p) {
    vtkUnstructuredGrid *grid = pieces[p].grid;
    vtkDataSetAttributes *attributes = grid->GetPointData();
    if (!of_points)
      attributes = grid->GetCellData();
    const int64_t count = of_points ? grid->GetNumberOfPoints() : grid->GetNumberOfCells();
    for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
      vtkDataArray *array = attributes->GetArray(i);
      const std::string name = array && array->GetName() ? array->GetName() : "";
      if (!array || array->GetNumberOfComponents() < 1 || tcv::is_ghost_array(name))
        continue;
      if (!tcv::has_length(pieces[p].place, {association, name}, array, count, unread))
        continue;
      Column *column = column_of(&columns, name, pieces.size());
      if (column->parts[p])
        continue;
      column->parts[p] = array;
      if (column->components == 0)
        column->components = array->GetNumberOfComponents();
      column->mixed = column->mixed || column->components != array->GetNumberOfComponents();
      if (array == attributes->GetScalars())
        column->attribute = vtkDataSetAttributes::SCALARS;
      if (array == attributes->GetGlobalIds())
        column->attribute = vtkDataSetAttributes::GLOBALIDS;
      if (array == attributes->GetPedigreeIds())
        column->attribute = vtkDataSetAttributes::PEDIGREEIDS;
      column->numbers = column->numbers || tcv::numbers_things(attributes, array);
    }
  }
  for (Column &column : columns) {
    for (size_t p = 0; p < pieces.size(); ++p)
      column.missing += !column.parts[p] && pieces[p].grid->GetNumberOfCells() > 0;
  }
  return columns;
}

// Makes the array of the whole. It has the type of its parts if they all have the same one, and else double. If a part
// is missing, the array has floating-point numbers in any case, because NaN stands for missing values.
void make_whole(Column *column, int64_t count) {
  vtkDataArray *first = nullptr;
  bool same = true;
  for (vtkDataArray *part : column->parts) {
    if (!part)
      continue;
    first = first ? first : part;
    same = same && part->GetDataType() == first->GetDataType();
  }
  const int type = first->GetDataType();
  const bool keep = same && (column->missing == 0 || type == VTK_FLOAT || type == VTK_DOUBLE);
  column->whole = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(keep ? type : VTK_DOUBLE));
  column->whole->SetName(column->name.c_str());
  column->whole->SetNumberOfComponents(column->components);
  if (first->HasAComponentName())
    column->whole->CopyComponentNames(first);
  column->whole->SetNumberOfTuples(count);
  if (column->missing > 0)
    column->whole->Fill(std::numeric_limits<double>::quiet_NaN());
}

// Copies the tuples of one part into the whole.
class Copier {
public:
  Copier(vtkDataArray *from, vtkDataArray *to) : from_(from), to_(to), components_(to->GetNumberOfComponents()) {
    const int type = from->GetDataType();
    if (type != to->GetDataType() || type == VTK_BIT || !from->HasStandardMemoryLayout())
      return;
    size_ = static_cast<size_t>(components_) * static_cast<size_t>(from->GetDataTypeSize());
    source_ = static_cast<const char *>(from->GetVoidPointer(0));
    target_ = static_cast<char *>(to->GetVoidPointer(0));
  }
  void copy(int64_t from, int64_t to) {
    if (size_ > 0) {
      std::memcpy(target_ + static_cast<size_t>(to) * size_, source_ + static_cast<size_t>(from) * size_, size_);
      return;
    }
    for (int k = 0; k < components_; ++k)
      to_->SetComponent(to, k, from_->GetComponent(from, k));
  }
  bool differs(int64_t from, int64_t to) const {
    if (size_ > 0 && std::memcmp(target_ + static_cast<size_t>(to) * size_, source_ + static_cast<size_t>(from) * size_,
                                 size_) == 0) {
      return false;
    }
    for (int k = 0; k < components_; ++k) {
      const double a = from_->GetComponent(from, k), b = to_->GetComponent(to, k);
      if (a != b && !(std::isnan(a) && std::isnan(b)))
        return true;
    }
    return false;
  }

private:
  vtkDataArray *from_, *to_;
  int components_;
  size_t size_ = 0;
  const char *source_ = nullptr;
  char *target_ = nullptr;
};

class PointJoiner {
public:
  PointJoiner(const std::vector<PieceMap> &maps, int64_t count) : maps_(maps), state_(static_cast<size_t>(count)) {}

  // Goes from the last piece to the first, so that the values of the first one are what remains. The values of points
  // that are marked as duplicates are copied before all others, so that they remain only where nothing else is known.
  void join(Column *column) {
    std::fill(state_.begin(), state_.end(), static_cast<unsigned char>(UNSET));
    for (const bool duplicates : {true, false}) {
      for (size_t p = maps_.size(); p-- > 0;) {
        const bool again =
            maps_[p].repeats && column->parts[p] == column->parts[p - 1] && maps_[p - 1].dropped_points.empty();
        if (column->parts[p] && !again)
          join(column, p, duplicates);
      }
    }
    if (column->numbers)
      return;
    if (differ_.empty())
      differ_.resize(state_.size());
    for (size_t i = 0; i < state_.size(); ++i) {
      if (state_[i] != DIFFERS)
        continue;
      if (differences.points == 0)
        differences.array = column->name;
      differences.points += !differ_[i];
      differ_[i] = 1;
    }
  }

  tcv::Differences differences;

private:
  enum : unsigned char { UNSET, SET, DIFFERS };

  void join(Column *column, size_t p, bool duplicates) {
    const PieceMap &map = maps_[p];
    if (duplicates && map.point_marks.empty())
      return;
    Copier copier(column->parts[p], column->whole);
    for (size_t i = map.to->size(); i-- > 0;) {
      const int64_t to = (*map.to)[i];
      const bool duplicate = !map.point_marks.empty() && map.point_marks[i] & vtkDataSetAttributes::DUPLICATEPOINT;
      if (to < 0 || duplicate != duplicates)
        continue;
      unsigned char &state = state_[static_cast<size_t>(to)];
      if (state != UNSET && copier.differs(static_cast<int64_t>(i), to))
        state = DIFFERS;
      if (state == UNSET)
        state = SET;
      copier.copy(static_cast<int64_t>(i), to);
    }
  }

  const std::vector<PieceMap> &maps_;
  std::vector<unsigned char> state_, differ_;
};

void join_cells(const std::vector<tcv::Piece> &pieces, const std::vector<PieceMap> &maps, Column *column) {
  int64_t at = 0;
  for (size_t p = 0; p < pieces.size(); ++p) {
    const int64_t cells = pieces[p].grid->GetNumberOfCells();
    vtkDataArray *part = column->parts[p];
    if (!part) {
      for (int64_t i = 0; i < cells; ++i)
        at += maps[p].keeps_cell(static_cast<size_t>(i));
      continue;
    }
    Copier copier(part, column->whole);
    for (int64_t i = 0; i < cells; ++i) {
      if (maps[p].keeps_cell(static_cast<size_t>(i)))
        copier.copy(i, at++);
    }
  }
}

template <typename Join>
void join(const tcv::Reading &reading, const char *what, int64_t count, std::vector<Column> *columns,
          vtkDataSetAttributes *target, Join &&join_one) {
  for (Column &column : *columns) {
    if (column.mixed) {
      tetcast_context_message(reading.context, TETCAST_SEVERITY_WARNING,
                              "%s: %s array '%s' has not the same number of components in all pieces and is left out",
                              reading.path.c_str(), what, column.name.c_str());
      continue;
    }
    make_whole(&column, count);
    join_one(&column);
    const int index = target->AddArray(column.whole);
    if (column.attribute >= 0 && !target->GetAbstractAttribute(column.attribute))
      target->SetActiveAttribute(index, column.attribute);
    column.whole = nullptr; // `target` owns it now.
  }
}

void warn_of_missing(const tcv::Reading &reading, size_t pieces, const std::vector<Column> &points,
                     const std::vector<Column> &cells) {
  int64_t count = 0;
  const Column *first = nullptr;
  for (const auto *columns : {&points, &cells}) {
    for (const Column &column : *columns) {
      if (column.missing == 0 || column.mixed || column.numbers)
        continue;
      first = first ? first : &column;
      ++count;
    }
  }
  if (!first)
    return;
  tetcast_context_message(
      reading.context, TETCAST_SEVERITY_WARNING,
      "%s: %lld %s missing in some of the %zu pieces, which are transparent then, first '%s' in %d of them",
      reading.path.c_str(), static_cast<long long>(count), count == 1 ? "array is" : "arrays are", pieces,
      first->name.c_str(), first->missing);
}

} // namespace

namespace tcv {

bool is_ghost_array(const std::string &name) {
  return name == "vtkGhostType" || name == "vtkGhostLevels";
}

bool numbers_things(vtkDataSetAttributes *attributes, vtkDataArray *array) {
  const std::string name = array->GetName() ? array->GetName() : "";
  return array == attributes->GetGlobalIds() || array == attributes->GetPedigreeIds() ||
         name == "vtkOriginalPointIds" || name == "vtkOriginalCellIds";
}

bool has_length(const std::string &place, const ArrayName &name, vtkDataArray *array, int64_t count,
                std::vector<UnreadArray> *unread) {
  if (array->GetNumberOfTuples() == count)
    return true;
  note_unread(unread, name,
              (place.empty() ? "" : place + ": ") + "it has " + std::to_string(array->GetNumberOfTuples()) +
                  " values for " + std::to_string(count) + " " + word_of(name.association) + "s");
  return false;
}

void join_arrays(const Reading &reading, const std::vector<Piece> &pieces, const std::vector<PieceMap> &maps,
                 vtkUnstructuredGrid *grid, Differences *differences, std::vector<UnreadArray> *unread) {
  auto points = columns_of(pieces, TETCAST_POINT, unread);
  PointJoiner joiner(maps, grid->GetNumberOfPoints());
  join(reading, "point", grid->GetNumberOfPoints(), &points, grid->GetPointData(),
       [&](Column *column) { joiner.join(column); });
  *differences = joiner.differences;
  auto cells = columns_of(pieces, TETCAST_CELL, unread);
  join(reading, "cell", grid->GetNumberOfCells(), &cells, grid->GetCellData(),
       [&](Column *column) { join_cells(pieces, maps, column); });
  warn_of_missing(reading, pieces.size(), points, cells);
}

} // namespace tcv
