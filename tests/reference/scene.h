/* SPDX-License-Identifier: Apache-2.0 */
/* What is rendered, as it stands in the files: doubles, not yet turned into anything. */
#ifndef TETCAST_REFERENCE_SCENE_H
#define TETCAST_REFERENCE_SCENE_H

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace reference {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Mesh {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<int64_t, 4>> cells;
  std::vector<double> values; /* one per point, or one per cell, or four per cell in the order of its points */
  bool of_cells = false, of_corners = false;
};

struct Transfer {
  std::vector<std::array<double, 4>> color;      /* value, red, green, blue */
  std::vector<std::array<double, 2>> extinction; /* value, extinction; or */
  std::vector<std::array<double, 2>> opacity;    /* value, opacity in [0, 1] */
  double unit_distance = 1;
  bool linear_opacity = false; /* extinction = opacity / unit_distance */
};

struct Camera {
  double eye[3], target[3], up[3];
  bool orthographic = false;
  double fovy = 30;  /* degrees */
  double height = 0; /* orthographic */
};

struct Scene {
  Mesh mesh;
  Transfer transfer;
  Camera camera;
  int64_t width = 0, height = 0;
  int64_t samples = 1;                     /* rays in a row of a pixel: the square root of the scene file's number */
  std::vector<std::array<double, 4>> clip; /* normals n and offsets d: what has n·x >= d for all of them is seen */
  std::vector<double> stop;                /* of each pixel: where its rays end; none: nowhere */
};

/* Reads a scene file as `tetcast render --save-scene` writes it, and the mesh it names. Throws Error. */
Scene read_scene(const std::string &path);

/* Reads a transfer function as `tetcast render --transfer` does. Throws Error. */
Transfer read_transfer(const std::string &path);

/* RGBA, row 0 at the top. Throws Error. */
std::vector<double> read_image(const std::string &path, int64_t width, int64_t height);
void write_image(const std::string &path, const std::vector<double> &pixels, int64_t width, int64_t height);

} // namespace reference

#endif
