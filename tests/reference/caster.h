/* SPDX-License-Identifier: Apache-2.0 */
/* Rays against every tetrahedron, one by one: a cell is the intersection of four half-spaces. */
#ifndef TETCAST_REFERENCE_CASTER_H
#define TETCAST_REFERENCE_CASTER_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "optics.h"
#include "real.h"
#include "scene.h"

namespace reference {

template <class Real> struct Ray {
  Vector<Real> origin;
  Vector<Real> direction; /* of length one */
  Vector<Real> aside{};   /* to be added to the origin: the sum may have more digits than Real, far from zero */
  Real end = HUGE_VAL;    /* where it ends */
};

/* The ray through the point (x, y) of the picture: 0, 0 is its upper left corner and width, height its lower right. */
template <class Real> Ray<Real> camera_ray(const Scene &scene, Real x, Real y) {
  const Camera &camera = scene.camera;
  const Vector<Real> eye = vector_from<Real>(camera.eye);
  const Vector<Real> forward = normalized(vector_from<Real>(camera.target) - eye);
  const Vector<Real> right = normalized(cross(forward, vector_from<Real>(camera.up)));
  const Vector<Real> up = cross(right, forward);
  const Real half = camera.orthographic ? Real(camera.height) / 2 : tangent(Real(camera.fovy) / 360 * pi<Real>());
  const Real across = (2 * x - scene.width) / scene.height * half;
  const Real upward = (scene.height - 2 * y) / scene.height * half;
  const Vector<Real> offset = across * right + upward * up;
  if (camera.orthographic)
    return {eye, forward, offset};
  return {eye, normalized(forward + offset), {}};
}

/* Sample k of pixel (i, j). */
template <class Real> Ray<Real> sample_ray(const Scene &scene, int64_t i, int64_t j, int64_t k) {
  const int64_t n = scene.samples;
  Ray<Real> ray = camera_ray<Real>(scene, i + (k % n + Real(0.5)) / n, j + (k / n + Real(0.5)) / n);
  if (!scene.stop.empty())
    ray.end = scene.stop[size_t(j * scene.width + i)];
  return ray;
}

/* What of a ray the scene's half-spaces leave, and its own end. False: nothing. */
template <class Real> bool interval_of(const Scene &scene, const Ray<Real> &ray, Real &begin, Real &end) {
  begin = 0;
  end = ray.end;
  for (const auto &plane : scene.clip) {
    const Vector<Real> normal = vector_from<Real>(plane.data());
    const Real distance = dot(normal, ray.origin) - plane[3] + dot(normal, ray.aside);
    const Real speed = dot(normal, ray.direction);
    if (speed > 0)
      begin = std::max(begin, -distance / speed);
    else if (speed < 0)
      end = std::min(end, -distance / speed);
    else if (distance < 0)
      return false;
  }
  return begin < end;
}

/* Six times the signed volume; `scale` receives the sum of the products' magnitudes that it is made of. */
template <class Real> Real six_volumes(const std::array<Vector<Real>, 4> &p, Real &scale) {
  const Vector<Real> a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const auto size = [](Vector<Real> v) { return Vector<Real>{absolute(v.x), absolute(v.y), absolute(v.z)}; };
  const Vector<Real> i = size(a), j = size(b), k = size(c);
  scale = i.x * (j.y * k.z + j.z * k.y) + i.y * (j.z * k.x + j.x * k.z) + i.z * (j.x * k.y + j.y * k.x);
  return dot(cross(a, b), c);
}

/* Triangle of a cell with its plane; the normal points out of the cell and has twice the triangle's area. */
template <class Real> struct Face {
  size_t corner[3];
  Vector<Real> normal;
};

/* Corner i's face, computed in the order of the vertices' numbers: two cells get the same plane to the last bit, so
 * that what is rounded out of the one is rounded into the other. */
template <class Real>
Face<Real> face_of(const std::array<Vector<Real>, 4> &p, const std::array<int64_t, 4> &vertices, size_t i) {
  static constexpr size_t corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  Face<Real> face{{corners[i][0], corners[i][1], corners[i][2]}, {}};
  bool flipped = false;
  for (const auto &[j, k] : {std::pair<size_t, size_t>{0, 1}, {1, 2}, {0, 1}})
    if (vertices[face.corner[j]] > vertices[face.corner[k]]) {
      std::swap(face.corner[j], face.corner[k]);
      flipped = !flipped;
    }
  const Vector<Real> a = p[face.corner[0]];
  face.normal = cross(p[face.corner[1]] - a, p[face.corner[2]] - a);
  if (flipped)
    face.normal = Real(-1) * face.normal;
  return face;
}

/* The scalar where a ray pierces a face, in ratio of the areas into which the point divides it. */
template <class Real>
Real face_scalar(const Face<Real> &face, const std::array<Vector<Real>, 4> &p, const Real s[4], Vector<Real> point) {
  Real sum = 0, weighted = 0;
  Real low = s[face.corner[0]], high = low;
  for (size_t i = 0; i < 3; i++) {
    const size_t here = face.corner[i], b = face.corner[(i + 1) % 3], c = face.corner[(i + 2) % 3];
    const Real area = dot(face.normal, cross(p[b] - point, p[c] - point));
    sum += area;
    weighted += area * s[here];
    low = std::min(low, s[here]);
    high = std::max(high, s[here]);
  }
  return std::min(std::max(weighted / sum, low), high);
}

/* Cuts the ray with the cell that has corners p, in positive order and relative to the ray's origin, and scalars s. A
 * ray that runs in a face, or along an edge, belongs to the cell into which it would come if moved a little in a
 * direction that no mesh is likely to have: to one only. */
template <class Real>
bool clip(const std::array<Vector<Real>, 4> &p, const std::array<int64_t, 4> &vertices, const Real s[4],
          Vector<Real> direction, Segment<Real> &segment) {
  const Vector<Real> aside{Real(0.3141592), Real(0.2718281), Real(0.5772156)};
  Face<Real> entry{}, exit{};
  bool entered = false, left = false;
  for (size_t i = 0; i < 4; i++) {
    const Face<Real> face = face_of(p, vertices, i);
    const Real distance = dot(face.normal, p[face.corner[0]]);
    const Real speed = dot(face.normal, direction); /* inside: speed·t ≤ distance */
    if (speed == 0) {
      if (distance < 0 || (distance == 0 && dot(face.normal, aside) > 0))
        return false;
      continue;
    }
    const Real t = distance / speed;
    if (speed < 0 && (!entered || t > segment.t0)) {
      entered = true;
      segment.t0 = t;
      entry = face;
    } else if (speed > 0 && (!left || t < segment.t1)) {
      left = true;
      segment.t1 = t;
      exit = face;
    }
  }
  if (!entered || !left || !(segment.t0 < segment.t1) || !(segment.t1 > 0))
    return false;
  segment.s0 = face_scalar(entry, p, s, segment.t0 * direction);
  segment.s1 = face_scalar(exit, p, s, segment.t1 * direction);
  if (segment.t0 < 0) {
    segment.s0 += -segment.t0 / (segment.t1 - segment.t0) * (segment.s1 - segment.s0);
    segment.t0 = 0;
  }
  return true;
}

template <class Real> class Caster {
public:
  explicit Caster(const Scene &scene) : scene_(scene), optics_(scene.transfer) {
    std::set<std::array<int64_t, 4>> seen;
    for (size_t i = 0; i < scene.mesh.cells.size(); i++)
      add_cell(i, seen);
  }

  /* What the ray crosses of the cells, in its order. `folded` is set if cells overlap along it: what is seen there is
   * not defined. */
  std::vector<Segment<Real>> segments(const Ray<Real> &ray, bool *folded = nullptr) const {
    std::vector<Segment<Real>> found;
    Real begin, end;
    if (!interval_of(scene_, ray, begin, end))
      return found;
    for (size_t i : candidates(ray)) {
      std::array<Vector<Real>, 4> p;
      for (size_t j = 0; j < 4; j++)
        p[j] = point(cells_[i].vertices[j]) - ray.origin - ray.aside;
      const Real s[4] = {cells_[i].values[0], cells_[i].values[1], cells_[i].values[2], cells_[i].values[3]};
      Segment<Real> segment;
      if (clip(p, cells_[i].vertices, s, ray.direction, segment))
        found.push_back(segment);
    }
    std::sort(found.begin(), found.end(), [](const auto &a, const auto &b) { return a.t0 < b.t0; });
    Real seen = 0;
    for (const auto &segment : found) {
      if (folded && std::min(seen, segment.t1) - segment.t0 > Real(1e-15) * segment.t1)
        *folded = true;
      seen = std::max(seen, segment.t1);
    }
    std::vector<Segment<Real>> left;
    for (const auto &segment : found) {
      if (!(segment.t0 < end && segment.t1 > begin))
        continue;
      Segment<Real> part = segment;
      const Real slope = (segment.s1 - segment.s0) / (segment.t1 - segment.t0);
      if (segment.t0 < begin) {
        part.t0 = begin;
        part.s0 += (begin - segment.t0) * slope;
      }
      if (segment.t1 > end) {
        part.t1 = end;
        part.s1 += (end - segment.t1) * slope;
      }
      left.push_back(part);
    }
    return left;
  }

  std::array<Real, 4> ray_rgba(const Ray<Real> &ray, bool *folded = nullptr) const {
    Integral<Real> integral(optics_);
    for (const auto &segment : segments(ray, folded))
      if (!integral.opaque())
        integral.add(segment);
    return integral.rgba();
  }

  /* `shift` moves the rays. */
  std::array<Real, 4> pixel_rgba(int64_t i, int64_t j, bool *folded = nullptr, Vector<Real> shift = {}) const {
    std::array<Real, 4> sum{};
    const int64_t n = scene_.samples;
    for (int64_t k = 0; k < n * n; k++) {
      Ray<Real> ray = sample_ray<Real>(scene_, i, j, k);
      ray.aside = ray.aside + shift;
      const auto rgba = ray_rgba(ray, folded);
      for (size_t c = 0; c < 4; c++)
        sum[c] += rgba[c] / (n * n);
    }
    return sum;
  }

  /* By how much a pixel changes if its rays are moved by a few roundings of the largest coordinate. */
  Real pixel_change(int64_t i, int64_t j) const {
    double size = 0;
    for (size_t k = 0; k < 3; k++)
      size = std::max(size, std::abs(scene_.camera.eye[k]));
    for (const auto &p : scene_.mesh.points)
      for (double x : p)
        size = std::max(size, std::abs(x));
    const Real step = Real(0x1p-50) * size;
    const auto here = pixel_rgba(i, j);
    Real change = 0;
    const Real zero = 0;
    for (const Vector<Real> &shift :
         {Vector<Real>{step, zero, zero}, Vector<Real>{-step, zero, zero}, Vector<Real>{zero, step, zero},
          Vector<Real>{zero, -step, zero}, Vector<Real>{zero, zero, step}, Vector<Real>{zero, zero, -step}}) {
      const auto there = pixel_rgba(i, j, nullptr, shift);
      for (size_t c = 0; c < 4; c++)
        change = std::max(change, absolute(there[c] - here[c]));
    }
    return change;
  }

private:
  struct Cell {
    std::array<int64_t, 4> vertices;
    std::array<double, 4> values;
  };

  Vector<Real> point(int64_t i) const { return vector_from<Real>(scene_.mesh.points[size_t(i)].data()); }

  /* Leaves out what can't be seen: cells without volume, the second of two equal cells, values that are no numbers. */
  void add_cell(size_t index, std::set<std::array<int64_t, 4>> &seen) {
    const Mesh &mesh = scene_.mesh;
    Cell cell{mesh.cells[index], {}};
    std::array<size_t, 4> corner{0, 1, 2, 3};
    auto sorted = cell.vertices;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end() || !seen.insert(sorted).second)
      return;
    std::array<Vector<Real>, 4> p;
    for (size_t j = 0; j < 4; j++)
      p[j] = point(cell.vertices[j]);
    Real scale;
    const Real volume = six_volumes(p, scale);
    if (absolute(volume) <= Real(1e-18) * scale)
      return; /* flat to the last bit: no ray is inside for a length that counts, and its faces' sides are not known */
    if (volume < 0) {
      std::swap(cell.vertices[0], cell.vertices[1]);
      std::swap(corner[0], corner[1]);
    }
    for (size_t j = 0; j < 4; j++) {
      cell.values[j] = mesh.values[mesh.of_cells     ? index
                                   : mesh.of_corners ? 4 * index + corner[j]
                                                     : size_t(cell.vertices[j])];
      if (!std::isfinite(cell.values[j]))
        return;
    }
    double center[3], radius = 0;
    for (size_t k = 0; k < 3; k++) {
      center[k] = 0;
      for (int64_t v : cell.vertices)
        center[k] += mesh.points[size_t(v)][k] / 4;
    }
    for (int64_t v : cell.vertices) {
      const auto &q = mesh.points[size_t(v)];
      radius = std::max(radius, std::hypot(q[0] - center[0], q[1] - center[1], q[2] - center[2]));
    }
    cells_.push_back(cell);
    x_.push_back(center[0]);
    y_.push_back(center[1]);
    z_.push_back(center[2]);
    radius_.push_back(radius);
  }

  /* Cells whose bounding sphere, made larger by far more than double arithmetic loses, the ray meets. */
  std::vector<size_t> candidates(const Ray<Real> &ray) const {
    const Vector<Real> from = ray.origin + ray.aside;
    const double ox = double(from.x), oy = double(from.y), oz = double(from.z);
    const double dx = double(ray.direction.x), dy = double(ray.direction.y), dz = double(ray.direction.z);
    constexpr size_t block = 256;
    std::vector<size_t> found;
    for (size_t first = 0; first < cells_.size(); first += block) {
      const size_t count = std::min(block, cells_.size() - first);
      double excess[block];
      for (size_t i = 0; i < count; i++) {
        const double x = x_[first + i] - ox, y = y_[first + i] - oy, z = z_[first + i] - oz;
        const double cx = y * dz - z * dy, cy = z * dx - x * dz, cz = x * dy - y * dx;
        const double away = std::abs(x) + std::abs(y) + std::abs(z) + std::abs(ox) + std::abs(oy) + std::abs(oz);
        const double radius = 1.000001 * radius_[first + i] + 1e-12 * away;
        const double behind = -(x * dx + y * dy + z * dz) - radius;
        excess[i] = std::max(cx * cx + cy * cy + cz * cz - radius * radius, behind);
      }
      for (size_t i = 0; i < count; i++)
        if (!(excess[i] > 0))
          found.push_back(first + i);
    }
    return found;
  }

  const Scene &scene_;
  const Optics<Real> optics_;
  std::vector<Cell> cells_;
  std::vector<double> x_, y_, z_, radius_;
};

} // namespace reference

#endif
