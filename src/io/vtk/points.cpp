// SPDX-License-Identifier: Apache-2.0
#include "points.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <tuple>

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>

#include "common.hpp"

namespace {

struct Position {
  double x[3];
};

bool operator==(const Position &a, const Position &b) {
  return a.x[0] == b.x[0] && a.x[1] == b.x[1] && a.x[2] == b.x[2];
}

uint64_t hash_of(const Position &position, uint64_t salt) {
  uint64_t hash = salt * 0x9E3779B97F4A7C15u;
  for (const double x : position.x) {
    const double value = x == 0 ? 0 : x; // −0 becomes 0, so that both have the same hash.
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0xFF51AFD7ED558CCDu;
    hash ^= hash >> 32;
  }
  return hash;
}

// A hash table with open addressing, of the numbers of points.
class Table {
public:
  explicit Table(int64_t points) {
    size_t size = 16;
    while (size < 2 * static_cast<size_t>(points))
      size *= 2;
    slots_.assign(size, -1);
  }
  // Returns the first point with this hash that `fits`, or -1.
  template <typename Fits> int64_t find(uint64_t hash, Fits &&fits) const {
    for (size_t at = hash & (slots_.size() - 1); slots_[at] >= 0; at = (at + 1) & (slots_.size() - 1)) {
      if (fits(slots_[at]))
        return slots_[at];
    }
    return -1;
  }
  void add(uint64_t hash, int64_t point) {
    size_t at = hash & (slots_.size() - 1);
    while (slots_[at] >= 0)
      at = (at + 1) & (slots_.size() - 1);
    slots_[at] = static_cast<int32_t>(point);
  }

private:
  std::vector<int32_t> slots_;
};

// The distinct points that were found so far.
template <typename T> class Points {
public:
  Points(T *values, int64_t limit) : values_(values), table_(limit) {}

  int64_t count() const { return count_; }
  Position at(int64_t i) const {
    const T *p = values_ + 3 * i;
    return {{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])}};
  }
  int64_t add(const Position &position, uint64_t hash) {
    for (int k = 0; k < 3; ++k)
      values_[3 * count_ + k] = static_cast<T>(position.x[k]);
    table_.add(hash, count_);
    return count_++;
  }
  const Table &table() const { return table_; }

private:
  T *values_;
  Table table_;
  int64_t count_ = 0;
};

// Points of different pieces that coincide become one, but points of the same piece stay apart, because at a crack a
// piece has several points at one place. There, the second point of a piece becomes one with the second point of
// another.
template <typename T> class ExactMerger {
public:
  ExactMerger(T *values, int64_t limit) : points_(values, limit) { visits_.reserve(static_cast<size_t>(limit)); }

  int64_t take(const Position &position, int32_t piece) {
    const int64_t first = find(position, 0);
    if (first < 0)
      return add(position, piece, 0);
    Visit &visit = visits_[static_cast<size_t>(first)];
    if (visit.piece != piece) {
      visit.piece = piece;
      visit.times = 0;
    }
    const int32_t which = visit.times++;
    const int64_t found = which == 0 ? first : find(position, which);
    return found < 0 ? add(position, piece, which) : found;
  }
  int64_t count() const { return points_.count(); }

private:
  struct Visit {
    int32_t piece, times; // How often the piece has come to this place, which is kept with the first point there.
    int32_t which;        // Which of the points at this place it is.
  };

  int64_t find(const Position &position, int32_t which) const {
    return points_.table().find(hash_of(position, static_cast<uint64_t>(which)), [&](int64_t i) {
      return visits_[static_cast<size_t>(i)].which == which && points_.at(i) == position;
    });
  }
  int64_t add(const Position &position, int32_t piece, int32_t which) {
    visits_.push_back({piece, 1, which});
    return points_.add(position, hash_of(position, static_cast<uint64_t>(which)));
  }

  Points<T> points_;
  std::vector<Visit> visits_;
};

// Points that are no further apart than a tolerance become one, which is the first of them. If the tolerance is 0, they
// have to coincide.
template <typename T> class NearMerger {
public:
  NearMerger(T *values, int64_t limit, double tolerance) : points_(values, limit), tolerance_(tolerance) {}

  int64_t take(const Position &position, int32_t) {
    const Position box = box_of(position);
    if (tolerance_ == 0) {
      const int64_t found = find(box, position);
      return found < 0 ? points_.add(position, hash_of(box, 0)) : found;
    }
    for (int i = 0; i < 27; ++i) {
      const int64_t found = find({{box.x[0] + i % 3 - 1, box.x[1] + i / 3 % 3 - 1, box.x[2] + i / 9 - 1}}, position);
      if (found >= 0)
        return found;
    }
    return points_.add(position, hash_of(box, 0));
  }
  int64_t count() const { return points_.count(); }

private:
  Position box_of(const Position &position) const { // The edges of a box are as long as the tolerance.
    if (tolerance_ == 0)
      return position;
    Position box;
    for (int k = 0; k < 3; ++k)
      box.x[k] = std::floor(position.x[k] / tolerance_);
    return box;
  }
  int64_t find(const Position &box, const Position &position) const {
    return points_.table().find(hash_of(box, 0), [&](int64_t i) {
      const Position other = points_.at(i);
      double square = 0;
      for (int k = 0; k < 3; ++k)
        square += (other.x[k] - position.x[k]) * (other.x[k] - position.x[k]);
      return tolerance_ == 0 ? other == position : square <= tolerance_ * tolerance_;
    });
  }

  Points<T> points_;
  double tolerance_;
};

template <typename Merger>
void map_points(const std::vector<tcv::Piece> &pieces, Merger *merger, std::vector<tcv::PieceMap> *maps,
                int64_t *merged) {
  for (size_t p = 0; p < pieces.size(); ++p) {
    tcv::PieceMap &map = (*maps)[p];
    vtkPoints *points = pieces[p].grid->GetPoints();
    map.repeats = p > 0 && points && pieces[p - 1].grid->GetPoints() == points;
    const int64_t count = points ? points->GetNumberOfPoints() : 0;
    if (map.repeats)
      map.to = (*maps)[p - 1].to;
    else
      map.to = std::make_shared<std::vector<int64_t>>(static_cast<size_t>(count), -1);
    if (map.repeats && (*maps)[p - 1].dropped_points.empty())
      continue;
    for (int64_t i = 0; i < count; ++i) {
      int64_t &to = (*map.to)[static_cast<size_t>(i)];
      if (to >= 0 || (!map.dropped_points.empty() && map.dropped_points[static_cast<size_t>(i)]))
        continue;
      Position position;
      points->GetPoint(i, position.x);
      const int64_t before = merger->count();
      to = merger->take(position, static_cast<int32_t>(p));
      *merged += merger->count() == before;
    }
  }
}

template <typename Array>
vtkSmartPointer<vtkPoints> merge_as(const std::vector<tcv::Piece> &pieces, int64_t limit, double tolerance,
                                    std::vector<tcv::PieceMap> *maps, int64_t *merged) {
  using T = typename Array::ValueType;
  vtkNew<Array> values;
  values->SetNumberOfComponents(3);
  values->SetNumberOfTuples(limit);
  const auto merge = [&](auto &&merger) {
    map_points(pieces, &merger, maps, merged);
    values->Resize(merger.count()); // This gives back the memory that merging has saved.
    values->SetNumberOfTuples(merger.count());
  };
  if (tolerance < 0)
    merge(ExactMerger<T>(values->GetPointer(0), limit));
  else
    merge(NearMerger<T>(values->GetPointer(0), limit, tolerance));
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(values);
  return points;
}

// Sorts points and returns where each has gone. Points with the same coordinates stay in their order.
template <typename T> std::vector<int64_t> sort_values(T *values, int64_t count) {
  struct Point {
    T x[3];
    int64_t number;
  };
  std::vector<Point> order(static_cast<size_t>(count));
  for (int64_t i = 0; i < count; ++i)
    order[static_cast<size_t>(i)] = {{values[3 * i], values[3 * i + 1], values[3 * i + 2]}, i};
  std::sort(order.begin(), order.end(), [](const Point &a, const Point &b) {
    return std::tie(a.x[0], a.x[1], a.x[2], a.number) < std::tie(b.x[0], b.x[1], b.x[2], b.number);
  });
  std::vector<int64_t> place(static_cast<size_t>(count));
  for (int64_t i = 0; i < count; ++i) {
    const Point &point = order[static_cast<size_t>(i)];
    place[static_cast<size_t>(point.number)] = i;
    std::copy(point.x, point.x + 3, values + 3 * i);
  }
  return place;
}

} // namespace

namespace tcv {

void drop_nonfinite(vtkUnstructuredGrid *grid, PieceMap *map) {
  vtkPoints *points = grid->GetPoints();
  const int64_t count = points ? points->GetNumberOfPoints() : 0;
  if (count == 0 || first_nonfinite(points->GetData()) < 0)
    return;
  std::vector<unsigned char> bad;
  for (int64_t i = 0; i < count; ++i) {
    double p[3];
    points->GetPoint(i, p);
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
      continue;
    if (map->dropped_points.empty())
      map->dropped_points.assign(static_cast<size_t>(count), 0);
    if (map->dropped_points[static_cast<size_t>(i)])
      continue; // It has been left out together with the ghosts.
    if (bad.empty())
      bad.assign(static_cast<size_t>(count), 0);
    bad[static_cast<size_t>(i)] = map->dropped_points[static_cast<size_t>(i)] = 1;
    ++map->nonfinite_points;
  }
  if (map->nonfinite_points == 0)
    return;
  if (map->dropped_cells.empty())
    map->dropped_cells.assign(static_cast<size_t>(grid->GetNumberOfCells()), 0);
  for (int64_t i = 0; i < grid->GetNumberOfCells(); ++i) {
    vtkIdType size;
    const vtkIdType *corners;
    grid->GetCells()->GetCellAtId(i, size, corners);
    unsigned char &dropped = map->dropped_cells[static_cast<size_t>(i)];
    if (dropped || std::none_of(corners, corners + size, [&](vtkIdType j) { return bad[static_cast<size_t>(j)]; }))
      continue;
    dropped = 1;
    ++map->nonfinite_cells;
  }
}

vtkSmartPointer<vtkPoints> merge_points(const std::vector<Piece> &pieces, double tolerance, std::vector<PieceMap> *maps,
                                        int64_t *merged) {
  int64_t limit = 0;
  bool single = true;
  for (size_t p = 0; p < pieces.size(); ++p) {
    vtkPoints *points = pieces[p].grid->GetPoints();
    if (!points || (p > 0 && pieces[p - 1].grid->GetPoints() == points))
      continue;
    limit += points->GetNumberOfPoints();
    single = single && points->GetDataType() == VTK_FLOAT;
  }
  if (limit >= INT32_MAX) {
    fail(TETCAST_ERROR_LIMIT, "%s: %lld points are more than can be addressed", pieces[0].place.c_str(),
         static_cast<long long>(limit));
  }
  return single ? merge_as<vtkFloatArray>(pieces, limit, tolerance, maps, merged)
                : merge_as<vtkDoubleArray>(pieces, limit, tolerance, maps, merged);
}

void sort_points(vtkPoints *points, std::vector<PieceMap> *maps) {
  vtkDataArray *values = points->GetData();
  std::vector<int64_t> place; // of each point, in the new order
  if (auto *singles = vtkFloatArray::FastDownCast(values))
    place = sort_values(singles->GetPointer(0), values->GetNumberOfTuples());
  else
    place = sort_values(vtkDoubleArray::FastDownCast(values)->GetPointer(0), values->GetNumberOfTuples());
  for (PieceMap &map : *maps) {
    if (map.repeats)
      continue; // It shares what the piece before has.
    for (int64_t &to : *map.to)
      to = to < 0 ? to : place[static_cast<size_t>(to)];
  }
}

} // namespace tcv
