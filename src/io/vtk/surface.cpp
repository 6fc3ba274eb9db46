// SPDX-License-Identifier: Apache-2.0
// Reads files of surfaces.
#include "surface.hpp"
#include "common.hpp"
#include "files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <unordered_map>

#include <vtkCellArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolygon.h>

#include <tetcast/dataset.h>

using namespace tcv;

template <vtkSmartPointer<vtkPolyData> (*read)(const char *)> static Polygons read_polydata(const char *path) {
  const Capture capture;
  const vtkSmartPointer<vtkPolyData> data = read(path);
  if (capture.failed())
    fail(TETCAST_ERROR_DATA, "%s: truncated or damaged: %s", path, capture.error().c_str());
  Polygons result;
  if (!data->GetPoints())
    return result;
  check_points(path, data->GetPoints());
  const int64_t points = data->GetNumberOfPoints();
  result.points.resize(3 * static_cast<size_t>(points));
  for (int64_t i = 0; i < points; ++i)
    data->GetPoints()->GetPoint(i, &result.points[3 * static_cast<size_t>(i)]);

  vtkNew<vtkIdList> cell;
  check_cells(path, data->GetPolys(), points, "polygon");
  for (int64_t i = 0; i < data->GetPolys()->GetNumberOfCells(); ++i) {
    data->GetPolys()->GetCellAtId(i, cell);
    result.corners.insert(result.corners.end(), cell->begin(), cell->end());
    result.end_polygon();
  }
  check_cells(path, data->GetStrips(), points, "strip");
  for (int64_t i = 0; i < data->GetStrips()->GetNumberOfCells(); ++i) {
    data->GetStrips()->GetCellAtId(i, cell);
    for (int64_t j = 0; j + 2 < cell->GetNumberOfIds(); ++j) {
      const bool odd = j % 2 != 0; // Every other triangle of a strip is turned over.
      result.corners.insert(result.corners.end(), {cell->GetId(j + odd), cell->GetId(j + !odd), cell->GetId(j + 2)});
      result.end_polygon();
    }
  }
  return result;
}

// A row for each format. The content of a file tells its format (file_kind), and the extension does only if the content
// does not.
static const struct {
  const char *kind;
  const char *extension;
  Polygons (*read)(const char *path);
} readers[] = {
    {"STL", ".stl", read_stl},
    {"PLY", ".ply", read_ply},
    {"OFF", ".off", read_off},
    {"", ".obj", read_obj},
    {"VTKFile PolyData", ".vtp", read_polydata<read_vtp>},
    {"vtk POLYDATA", ".vtk", read_polydata<read_legacy_surface>},
};

static Polygons read_polygons(const char *path) {
  const std::string kind = file_kind(file_head(path));
  std::string extensions;
  for (const auto &reader : readers) {
    extensions += (extensions.empty() ? "" : ", ") + std::string(reader.extension);
    if (kind.empty() ? has_extension(path, reader.extension) : kind == reader.kind)
      return reader.read(path);
  }
  refuse(path, kind, "a surface", extensions.c_str());
}

static void check(const char *path, const Polygons &polygons) {
  for (size_t i = 0; i < polygons.points.size(); ++i) {
    if (!std::isfinite(polygons.points[i])) {
      fail(TETCAST_ERROR_DATA, "%s: point %zu: coordinate %c is %g", path, i / 3, "xyz"[i % 3], polygons.points[i]);
    }
  }
  size_t at = 0;
  for (size_t i = 0; i < polygons.ends.size(); ++i) {
    for (; at < polygons.ends[i]; ++at) {
      const int64_t index = polygons.corners[at];
      if (index < 0 || index >= polygons.point_count()) {
        fail(TETCAST_ERROR_DATA, "%s: polygon %zu: a point index is out of range (there are %lld points)", path, i,
             static_cast<long long>(polygons.point_count()));
      }
    }
  }
}

// ── points that coincide become one, polygons become triangles ──

namespace {

using Point = std::array<double, 3>;

struct PointHash {
  size_t operator()(const Point &point) const {
    uint64_t hash = 0;
    for (double value : point) {
      uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return static_cast<size_t>(hash);
  }
};

class Builder {
public:
  explicit Builder(const Polygons &polygons) : polygons_(polygons), merged_(polygons.points.size() / 3, -1) {}

  void add(size_t begin, size_t end) {
    corners_.clear();
    for (size_t i = begin; i < end; ++i) {
      const int64_t index = merge(static_cast<size_t>(polygons_.corners[i]));
      if (corners_.empty() || corners_.back() != index)
        corners_.push_back(index);
    }
    while (corners_.size() > 1 && corners_.front() == corners_.back())
      corners_.pop_back();
    if (corners_.size() == 3)
      triangle(0, 1, 2);
    if (corners_.size() > 3)
      cut();
  }

  std::vector<double> points;
  std::vector<int64_t> triangles;

private:
  // Numbers the points in the order in which polygons use them. Points that no polygon uses are left out.
  int64_t merge(size_t i) {
    if (merged_[i] >= 0)
      return merged_[i];
    const double *p = &polygons_.points[3 * i];
    const Point point = {p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}; // −0 becomes 0.
    const auto [entry, is_new] = numbers_.emplace(point, static_cast<int64_t>(points.size() / 3));
    if (is_new)
      points.insert(points.end(), point.begin(), point.end());
    return merged_[i] = entry->second;
  }

  void triangle(size_t a, size_t b, size_t c) {
    const int64_t ids[3] = {corners_[a], corners_[b], corners_[c]};
    if (ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0])
      triangles.insert(triangles.end(), ids, ids + 3);
  }

  void cut() {
    const auto count = static_cast<vtkIdType>(corners_.size());
    polygon_->Initialize();
    polygon_->GetPointIds()->SetNumberOfIds(count);
    polygon_->GetPoints()->SetDataTypeToDouble();
    polygon_->GetPoints()->SetNumberOfPoints(count);
    for (vtkIdType i = 0; i < count; ++i) {
      polygon_->GetPointIds()->SetId(i, i);
      polygon_->GetPoints()->SetPoint(i, &points[3 * static_cast<size_t>(corners_[static_cast<size_t>(i)])]);
    }
    cuts_->Reset();
    const bool good = polygon_->Triangulate(cuts_) != 0 && cuts_->GetNumberOfIds() == 3 * (count - 2);
    for (vtkIdType i = 0; i < count - 2; ++i) {
      if (good) {
        triangle(static_cast<size_t>(cuts_->GetId(3 * i)), static_cast<size_t>(cuts_->GetId(3 * i + 1)),
                 static_cast<size_t>(cuts_->GetId(3 * i + 2)));
      } else { // The polygon is degenerate. However it is cut, the surface stays closed.
        triangle(0, static_cast<size_t>(i) + 1, static_cast<size_t>(i) + 2);
      }
    }
  }

  const Polygons &polygons_;
  std::vector<int64_t> merged_; // The number of each point, or −1 if it has not been used so far.
  std::unordered_map<Point, int64_t, PointHash> numbers_;
  std::vector<int64_t> corners_;
  vtkNew<vtkPolygon> polygon_;
  vtkNew<vtkIdList> cuts_;
};

} // namespace

template <typename T> static T *copied(const std::vector<T> &values) {
  const size_t size = values.size() * sizeof(T);
  T *memory = static_cast<T *>(std::malloc(size));
  if (!memory)
    throw std::bad_alloc();
  std::memcpy(memory, values.data(), size);
  return memory;
}

static void read_surface(const char *path, TetcastSurface *surface) {
  const Polygons polygons = read_polygons(path);
  check(path, polygons);
  const Capture capture; // VTK complains about polygons that it can't cut.
  Builder builder(polygons);
  for (size_t i = 0, begin = 0; i < polygons.ends.size(); begin = polygons.ends[i++])
    builder.add(begin, polygons.ends[i]);
  if (builder.triangles.empty())
    fail(TETCAST_ERROR_DATA, "%s: holds no triangles", path);
  surface->vertex_count = static_cast<int64_t>(builder.points.size() / 3);
  surface->triangle_count = static_cast<int64_t>(builder.triangles.size() / 3);
  surface->vertices = copied(builder.points);
  surface->triangles = copied(builder.triangles);
}

TetcastStatus tetcast_surface_read(TetcastContext *context, const char *path, TetcastSurface *surface) {
  if (surface)
    *surface = {};
  if (!context || !path || !surface) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT,
                                 "tetcast_surface_read: context, path and surface must not be NULL");
  }
  const TetcastStatus status = fence(context, path, [&] { read_surface(path, surface); });
  if (status != TETCAST_OK)
    tetcast_surface_release(surface);
  return status;
}

void tetcast_surface_release(TetcastSurface *surface) {
  if (!surface)
    return;
  std::free(surface->vertices);
  std::free(surface->triangles);
  std::free(surface->holes);
  *surface = {};
}
