// SPDX-License-Identifier: Apache-2.0
#include "plc.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <new>

#include <fcntl.h>
#include <unistd.h>

#define TETLIBRARY
#define terminatetetgen terminatetetgen_that_frees_twice
#include <tetgen.h>
#undef terminatetetgen

#include "io/floating.hpp"

// TetGen 1.5 calls this function when it fails. Its own version frees the mesh and throws, whereupon the mesh's
// destructor frees it again. The version here only throws, and it takes the place of the other, as the dynamic linker
// finds it first.
__attribute__((visibility("default"))) void terminatetetgen(tetgenmesh *, int code);
void terminatetetgen(tetgenmesh *, int code) {
  throw code;
}

namespace tetcast_tetgen {

void fail(TetcastStatus status, const char *format, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  throw Failure{status, text};
}

namespace {

constexpr uint32_t COOKIE = 0x7e76e4;

// TetGen prints messages on standard output whatever it is told, so that is redirected while it works.
class Silence {
public:
  Silence() {
    std::fflush(stdout);
    int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    saved_ = nowhere < 0 ? -1 : fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    if (saved_ >= 0) {
      dup2(nowhere, STDOUT_FILENO);
    }
    if (nowhere >= 0) {
      close(nowhere);
    }
  }
  ~Silence() {
    std::fflush(stdout);
    if (saved_ >= 0) {
      dup2(saved_, STDOUT_FILENO);
      close(saved_);
    }
  }
  Silence(const Silence &) = delete;
  Silence &operator=(const Silence &) = delete;

private:
  int saved_ = -1;
};

// A complex in the form that TetGen takes. The arrays still belong to us.
class Input {
public:
  explicit Input(Plc &plc) : polygons_(plc.polygon_ends.size()), facets_(plc.facets.size()) {
    for (std::size_t i = 0, start = 0; i < polygons_.size(); start = plc.polygon_ends[i++]) {
      polygons_[i] = {plc.corners.data() + start, (int)(plc.polygon_ends[i] - start)};
    }
    Facet start = {0, 0};
    for (std::size_t i = 0; i < facets_.size(); start = plc.facets[i++]) {
      int holes = (int)(plc.facets[i].holes_end - start.holes_end);
      facets_[i] = {polygons_.data() + start.polygons_end, (int)(plc.facets[i].polygons_end - start.polygons_end),
                    holes > 0 ? plc.facet_holes.data() + 3 * start.holes_end : nullptr, holes};
    }
    io.pointlist = plc.points.data();
    io.numberofpoints = (int)(plc.points.size() / 3);
    io.facetlist = facets_.data();
    io.numberoffacets = (int)facets_.size();
    io.holelist = plc.holes.empty() ? nullptr : plc.holes.data();
    io.numberofholes = (int)(plc.holes.size() / 3);
  }
  ~Input() { io.initialize(); } // Otherwise its destructor would free our arrays.
  Input(const Input &) = delete;
  Input &operator=(const Input &) = delete;

  tetgenio io;

private:
  std::vector<tetgenio::polygon> polygons_;
  std::vector<tetgenio::facet> facets_;
};

// Scales the coordinates by a power of two that brings the largest extent into [1, 2), which is exact. In TetGen,
// coordinates as large as 1e200 would overflow, and tiny ones would underflow. Returns the exponent. An extent of 0
// along an axis is refused, as it makes TetGen end the process.
int scale_to_unit(Plc &plc) {
  double low[3], high[3];
  for (std::size_t i = 0; i < plc.points.size(); i++) {
    double x = plc.points[i];
    low[i % 3] = i < 3 ? x : std::fmin(low[i % 3], x);
    high[i % 3] = i < 3 ? x : std::fmax(high[i % 3], x);
  }
  double half[3]; // These are half of the differences, as the difference of two finite numbers may be infinite.
  for (int j = 0; j < 3; j++) {
    half[j] = high[j] / 2 - low[j] / 2;
  }
  double largest = std::fmax(half[0], std::fmax(half[1], half[2]));
  if (!(half[0] > largest * 1e-300 && half[1] > largest * 1e-300 && half[2] > largest * 1e-300)) {
    fail(TETCAST_ERROR_DATA, "the surface is flat and has no inside");
  }
  int exponent = std::ilogb(largest) + 1;
  for (std::vector<double> *array : {&plc.points, &plc.holes, &plc.facet_holes}) {
    for (double &x : *array) {
      x = std::scalbn(x, -exponent);
    }
  }
  return exponent;
}

// Returns the volume that the facets enclose, if they all face the same way, as those of surfaces should. Otherwise it
// is an estimate.
double enclosed_volume(const Plc &plc) {
  double volume = 0;
  const double *o = plc.points.data();
  for (std::size_t i = 0, start = 0; i < plc.polygon_ends.size(); start = plc.polygon_ends[i++]) {
    for (std::size_t j = start + 1; j + 1 < plc.polygon_ends[i]; j++) {
      const double *a = o + 3 * plc.corners[start], *b = o + 3 * plc.corners[j], *c = o + 3 * plc.corners[j + 1];
      for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        volume += (a[k] - o[k]) * ((b[l] - o[l]) * (c[m] - o[m]) - (b[m] - o[m]) * (c[l] - o[l])) / 6;
      }
    }
  }
  return std::fmin(std::fabs(volume), 8); // The scaled body lies in a box whose edges are shorter than 2.
}

void tetrahedralize_quietly(tetgenbehavior &behavior, tetgenio &in, tetgenio &out) {
  Silence silence;
  tetrahedralize(&behavior, &in, &out);
}

// Returns what a code that TetGen throws means, as its documentation says.
[[noreturn]] void explain(int code, Plc &plc, int exponent) {
  switch (code) {
  case 1:
    fail(TETCAST_ERROR_MEMORY, "TetGen ran out of memory");
  case 3: {
    int64_t count = 0;
    double at[3] = {0, 0, 0};
    try {
      tetgenbehavior diagnose;
      diagnose.plc = diagnose.diagnose = diagnose.quiet = 1;
      Input in(plc);
      tetgenio out;
      tetrahedralize_quietly(diagnose, in.io, out);
      count = out.numberoftrifaces;
      for (int i = 0; count > 0 && i < 9; i++) {
        at[i % 3] += std::scalbn(out.pointlist[3 * out.trifacelist[i / 3] + i % 3] / 3, exponent);
      }
    } catch (int) {
      count = 0;
    }
    if (count > 0) {
      fail(TETCAST_ERROR_DATA, "the surface intersects itself: %lld triangles meet others, the first near (%g, %g, %g)",
           (long long)count, at[0], at[1], at[2]);
    }
    fail(TETCAST_ERROR_DATA, "the surface intersects itself");
  }
  case 4:
    fail(TETCAST_ERROR_DATA, "the surface has features too small beside its size (TetGen's code 4)");
  case 5:
    fail(TETCAST_ERROR_DATA, "two facets of the surface lie too close to each other (TetGen's code 5)");
  case 10:
    fail(TETCAST_ERROR_DATA, "TetGen can't use the surface (its code 10): do all its points lie in a plane?");
  default:
    fail(TETCAST_ERROR_DATA, "TetGen gave up with an internal error (its code %d)", code);
  }
}

TetcastStatus make_mesh(TetcastContext *context, const double *points, int64_t point_count, const int *tetrahedra,
                        int64_t tetrahedron_count, TetcastMesh **mesh) {
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = {points, TETCAST_TYPE_FLOAT64, point_count, 0};
  desc.tetrahedra = {tetrahedra, TETCAST_TYPE_INT32, tetrahedron_count, 0};
  return tetcast_mesh_create(context, &desc, mesh);
}

TetcastStatus fill(TetcastContext *context, Plc &plc, const TetcastTetgenDesc &desc, TetcastMesh **mesh) {
  int exponent = scale_to_unit(plc);
  tetgenbehavior behavior;
  char switches[] = "pQFB";
  char bounded[] = "pQFBq";
  bool bounds = desc.quality > 0 || desc.max_volume > 0;
  behavior.parse_commandline(bounds ? bounded : switches);
  if (bounds) {
    behavior.optlevel = 0; // The optimisation at the end would keep neither of the bounds.
  }
  // These are not set by switches, because how TetGen reads numbers there depends on the locale.
  if (desc.quality > 0) {
    behavior.minratio = desc.quality;
  }
  if (desc.max_volume > 0) {
    behavior.fixedvolume = 1;
    behavior.maxvolume = std::scalbn(desc.max_volume, -3 * exponent);
    if (enclosed_volume(plc) / behavior.maxvolume > (double)MAX_COUNT) {
      fail(TETCAST_ERROR_LIMIT, "cells of volume %g would be more than %lld", desc.max_volume, (long long)MAX_COUNT);
    }
  }
  tetgenio out;
  try {
    Input in(plc);
    tetrahedralize_quietly(behavior, in.io, out);
  } catch (int code) {
    explain(code, plc, exponent);
  }
  if (out.numberoftetrahedra == 0) {
    fail(TETCAST_ERROR_DATA, "there is nothing inside the surface: it is open, or every part of it is a hole");
  }
  for (int i = 0; i < 3 * out.numberofpoints; i++) {
    out.pointlist[i] = std::scalbn(out.pointlist[i], exponent);
  }
  return make_mesh(context, out.pointlist, out.numberofpoints, out.tetrahedronlist, out.numberoftetrahedra, mesh);
}

void check_desc(const TetcastTetgenDesc &desc) {
  if (desc.cookie != COOKIE) {
    fail(TETCAST_ERROR_ARGUMENT, "the TetcastTetgenDesc was not initialised with tetcast_tetgen_desc_default()");
  }
  if (desc.quality != 0 && !(desc.quality > 1 && std::isfinite(desc.quality))) {
    fail(TETCAST_ERROR_ARGUMENT, "quality is %g: it must be above 1, or 0 for none", desc.quality);
  }
  if (!(desc.max_volume >= 0 && std::isfinite(desc.max_volume))) {
    fail(TETCAST_ERROR_ARGUMENT, "max_volume is %g: it must be above 0, or 0 for no limit", desc.max_volume);
  }
}

// Runs `work(desc)`, and turns whatever it throws into a status and a message.
template <typename Work>
TetcastStatus fenced(TetcastContext *context, const TetcastTetgenDesc *desc, TetcastMesh **mesh, Work work) {
  const FloatingPoint guard;
  if (!mesh) {
    return tetcast_context_error(context, TETCAST_ERROR_ARGUMENT, "mesh is NULL");
  }
  *mesh = nullptr;
  try {
    TetcastTetgenDesc settings = desc ? *desc : tetcast_tetgen_desc_default();
    check_desc(settings);
    return work(settings);
  } catch (const Failure &failure) {
    return tetcast_context_error(context, failure.status, "%s", failure.text.c_str());
  } catch (const std::bad_alloc &) {
    return tetcast_context_error(context, TETCAST_ERROR_MEMORY, "out of memory");
  } catch (...) {
    return tetcast_context_error(context, TETCAST_ERROR_DATA, "TetGen failed");
  }
}

bool ends_with(const std::string &text, const char *end) {
  std::size_t n = std::strlen(end);
  return text.size() > n && text.compare(text.size() - n, n, end) == 0;
}

} // namespace
} // namespace tetcast_tetgen

using namespace tetcast_tetgen;

TetcastTetgenDesc tetcast_tetgen_desc_default(void) {
  return {COOKIE, 1.4, 0};
}

TetcastStatus tetcast_tetgen_mesh(TetcastContext *context, const TetcastSurface *surface, const TetcastTetgenDesc *desc,
                                  TetcastMesh **mesh) {
  return fenced(context, desc, mesh, [&](const TetcastTetgenDesc &settings) {
    if (!context || !surface) {
      fail(TETCAST_ERROR_ARGUMENT, "%s is NULL", context ? "surface" : "context");
    }
    Plc plc = plc_from_surface(*surface);
    return fill(context, plc, settings, mesh);
  });
}

TetcastStatus tetcast_tetgen_mesh_file(TetcastContext *context, const char *path, const TetcastTetgenDesc *desc,
                                       TetcastMesh **mesh) {
  return fenced(context, desc, mesh, [&](const TetcastTetgenDesc &settings) {
    if (!context || !path) {
      fail(TETCAST_ERROR_ARGUMENT, "%s is NULL", context ? "path" : "context");
    }
    std::string name = path;
    if (ends_with(name, ".node") || ends_with(name, ".ele")) {
      Cells cells = cells_read(name.substr(0, name.find_last_of('.')));
      return make_mesh(context, cells.points.data(), (int64_t)cells.points.size() / 3, cells.tetrahedra.data(),
                       (int64_t)cells.tetrahedra.size() / 4, mesh);
    }
    if (!ends_with(name, ".poly") && !ends_with(name, ".smesh")) {
      fail(TETCAST_ERROR_ARGUMENT, "%s: not .poly, .smesh, .node or .ele", path);
    }
    Plc plc = plc_read(name); // Its messages name the file already.
    try {
      return fill(context, plc, settings, mesh);
    } catch (Failure &failure) {
      failure.text = name + ": " + failure.text;
      throw;
    }
  });
}
