/* SPDX-License-Identifier: Apache-2.0 */
/* The reference against integrals that are known in closed form, and against itself in a wider type. */
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>

#include "caster.h"
#include "cube.h"

extern "C" {
#include <cmocka.h>
}

using namespace reference;

namespace {

/* Looks along +z at a square of 2 × 2 pixels whose rays are at x, y = 0.26 and 0.74. */
Scene scene_of(Mesh mesh, Transfer transfer) {
  Scene scene;
  scene.mesh = std::move(mesh);
  scene.transfer = std::move(transfer);
  scene.camera = {{0.5, 0.5, -1}, {0.5, 0.5, 0}, {0, 1, 0}, true, 0, 0.96};
  scene.width = scene.height = 2;
  return scene;
}

Mesh corner(std::vector<double> values, bool of_cells) {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, std::move(values), of_cells};
}

void near(Extended value, Extended expected, Extended tolerance) {
  if (!(std::abs(value - expected) <= tolerance)) {
    std::fprintf(stderr, "%.20Lg, should be %.20Lg\n", value, expected);
    fail();
  }
}

std::array<Extended, 4> cast(const Scene &scene, Vector<Extended> origin, Vector<Extended> direction) {
  return Caster<Extended>(scene).ray_rgba({origin, direction, {}});
}

const Transfer gray = {{{0, 0.25, 0.5, 1}}, {{0, 3}}, {}};

void constant_in_one_cell(void **) {
  for (const bool of_cells : {false, true}) {
    Scene scene = scene_of(corner(std::vector<double>(of_cells ? 1 : 4, 0.5), of_cells), gray);
    for (int turn = 0; turn < 2; turn++) {
      const auto rgba = cast(scene, {0.25, 0.125, -1}, {0, 0, 1});
      const Extended alpha = -std::expm1(-3 * 0.625L);
      near(rgba[3], alpha, 1e-18L);
      near(rgba[0], alpha / 4, 1e-18L);
      near(rgba[2], alpha, 1e-18L);
      near(cast(scene, {0.25, 0.125, 2}, {0, 0, -1})[3], alpha, 1e-18L);                     /* from the other side */
      near(cast(scene, {0.25, 0.125, 0.5}, {0, 0, 1})[3], -std::expm1(-3 * 0.125L), 1e-18L); /* from inside */
      near(cast(scene, {0.25, 0.125, 2}, {0, 0, 1})[3], 0, 0);                               /* looking away */
      near(cast(scene, {0.75, 0.75, -1}, {0, 0, 1})[3], 0, 0);                               /* passing by */
      std::swap(scene.mesh.cells[0][0], scene.mesh.cells[0][1]);                             /* order is free */
    }
  }
}

/* s = z, κ = 2z, c = z: C = ∫ 2z² exp(−z²) = √π/2 erf(1) − 1/e */
void linear_across_a_cube(void **) {
  const Transfer transfer = {{{0, 0, 1, 0}, {1, 1, 1, 0}}, {{0, 0}, {1, 2}}, {}};
  const Extended expected = std::sqrt(pi<Extended>()) / 2 * std::erf(1.0L) - std::exp(-1.0L);
  for (int n = 1; n <= 5; n++)
    for (double jitter : {0.0, 0.2}) {
      const Scene scene = scene_of(cube(n, jitter, [](auto &p) { return p[2]; }), transfer);
      const auto rgba = Caster<Extended>(scene).pixel_rgba(0, 1);
      const Extended tolerance = jitter > 0 ? 1e-15L : 5e-19L; /* a moved vertex carries a rounded value */
      near(rgba[0], expected, tolerance);
      near(rgba[1], -std::expm1(-1.0L), tolerance);
      near(rgba[2], 0, 0);
      near(rgba[3], -std::expm1(-1.0L), tolerance);
    }
}

/* With extinction that rises to 2A at z = 1, or falls from it, and c = z: an error function and Dawson's integral. */
void rising_and_falling(void **) {
  for (const double a : {0.5, 3.0, 20.0}) {
    Transfer transfer = {{{0, 0, 1, 0}, {1, 1, 1, 0}}, {{0, 0}, {1, 2 * a}}, {}};
    const Extended end = std::exp(Extended(-a)), root = std::sqrt(Extended(a));
    Extended term = 1, dawson = 0;
    for (int k = 0; k < 200; term *= Extended(a) / ++k)
      dawson += term / (2 * k + 1);
    for (int n : {1, 2, 4}) {
      const auto field = [](auto &p) { return p[2]; };
      transfer.extinction = {{0, 0}, {1, 2 * a}};
      near(Caster<Extended>(scene_of(cube(n, 0, field), transfer)).pixel_rgba(0, 1)[0],
           std::sqrt(pi<Extended>()) / (2 * root) * std::erf(root) - end, 1e-18L);
      transfer.extinction = {{0, 2 * a}, {1, 0}};
      near(Caster<Extended>(scene_of(cube(n, 0, field), transfer)).pixel_rgba(0, 1)[0], end * (dawson - 1), 1e-18L);
    }
  }
}

/* κ = 2; colour rises from 0.25 to 0.75 and is constant beyond. */
void bends(void **) {
  const Transfer transfer = {{{0.25, 0, 1, 1}, {0.75, 1, 1, 0}}, {{0, 2}}, {}};
  for (int n : {1, 2, 8}) {
    const auto rgba = Caster<Extended>(scene_of(cube(n, 0, [](auto &p) { return p[2]; }), transfer)).pixel_rgba(0, 1);
    near(rgba[0], std::exp(-0.5L) - std::exp(-1.5L) - std::exp(-2.0L), 1e-18L);
    near(rgba[1], 1 - std::exp(-2.0L), 1e-18L);
    near(rgba[2], 1 - std::exp(-0.5L) + std::exp(-1.5L), 1e-18L);
  }
}

/* Nothing below 0.25, then κ = 5 in red to 0.625, then κ = 7 in green: steps in both curves, at the same value. */
void steps(void **) {
  const Transfer transfer = {{{0.625, 1, 0, 0}, {0.625, 0, 1, 0}}, {{0.25, 0}, {0.25, 5}, {0.625, 5}, {0.625, 7}}, {}};
  const Extended first = std::exp(-5 * 0.375L), second = std::exp(-7 * 0.375L);
  for (int n : {1, 3, 4}) {
    const auto field = [](auto &p) { return p[2]; };
    const auto rgba = Caster<Extended>(scene_of(cube(n, 0, field), transfer)).pixel_rgba(1, 0);
    near(rgba[0], 1 - first, 2e-17L); /* thirds are rounded */
    near(rgba[1], first * (1 - second), 2e-17L);
    near(rgba[3], 1 - first * second, 2e-17L);
  }
  /* at a step's very value the later knot holds */
  const Scene scene = scene_of(cube(2, 0, [](auto &) { return 0.625; }), transfer);
  const auto rgba = Caster<Extended>(scene).pixel_rgba(1, 0);
  near(rgba[0], 0, 0);
  near(rgba[1], -std::expm1(-7.0L), 1e-18L);
}

void opacity(void **) {
  const auto field = [](auto &) { return 0.5; };
  Transfer transfer = {{{0, 1, 1, 1}}, {}, {{0, 0.75}}, 0.5};
  near(Caster<Extended>(scene_of(cube(2, 0, field), transfer)).pixel_rgba(0, 0)[3], 0.9375L, 1e-18L);
  transfer.opacity = {{0, 1}}; /* κ = 53 ln 2 / u */
  transfer.unit_distance = 53;
  near(Caster<Extended>(scene_of(cube(2, 0, field), transfer)).pixel_rgba(0, 0)[3], 0.5L, 1e-18L);
}

/* Relative accuracy where next to nothing is emitted, and no trouble where everything is absorbed at once. */
void thin_and_thick(void **) {
  Scene scene = scene_of(cube(3, 0.2, [](auto &p) { return p[2]; }), {{{0, 0, 1, 1}, {1, 1, 1, 1}}, {{0, 1e-300}}, {}});
  const auto thin = Caster<Extended>(scene).pixel_rgba(0, 0);
  near(thin[0] / 1e-300, 0.5L, 1e-15L);
  near(thin[3] / 1e-300, 1, 1e-18L);
  scene.transfer.extinction = {{0, 0}, {1, 1e300}};
  const auto thick = Caster<Extended>(scene).pixel_rgba(0, 0);
  near(thick[0], 0, 1e-149L);
  near(thick[1], 1, 2e-18L);
  near(thick[3], 1, 0);
}

void transparent_and_left_out(void **) {
  Mesh mesh = corner({1, 1, 1, 1}, false);
  mesh.cells.push_back({3, 1, 0, 2}); /* the same again */
  mesh.cells.push_back({0, 1, 1, 2}); /* no volume */
  mesh.points.push_back({0.5, 0.5, 0});
  mesh.values.push_back(1);
  mesh.cells.push_back({0, 1, 2, 4}); /* flat */
  Scene scene = scene_of(mesh, gray);
  near(cast(scene, {0.25, 0.25, -1}, {0, 0, 1})[3], -std::expm1(-1.5L), 1e-18L);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL}) {
    scene.mesh.values[3] = value;
    near(cast(scene, {0.25, 0.25, -1}, {0, 0, 1})[3], 0, 0);
  }
}

/* Which pixel is where: a cell far to the upper right of the middle, as the camera sees it. */
void picture_is_upright(void **) {
  Scene scene = scene_of(corner({1, 1, 1, 1}, false), gray);
  scene.width = 40;
  scene.height = 20;
  for (const bool orthographic : {true, false}) {
    /* seen along −z with +y up, x to the right: the cell is at x ∈ [0, 1], y ∈ [0, 1] */
    scene.camera = {{-1, -0.5, 10}, {-1, -0.5, 0}, {0, 1, 0}, orthographic, 30, 5.4};
    const Caster<Extended> caster(scene);
    assert_true(caster.pixel_rgba(24, 7)[3] > 0.5L);
    assert_true(caster.pixel_rgba(24, 12)[3] == 0);
    assert_true(caster.pixel_rgba(15, 7)[3] == 0);
    assert_true(caster.pixel_rgba(15, 12)[3] == 0);
  }
  /* a field of 90° from the eye: the middle of the upper edge is at 45° */
  scene.camera.fovy = 90;
  const auto ray = camera_ray<Extended>(scene, 20, 0);
  near(ray.direction.y, std::sqrt(0.5L), 1e-18L);
  near(ray.direction.z, -std::sqrt(0.5L), 1e-18L);
  near(camera_ray<Extended>(scene, 40, 10).direction.x, 2 / std::sqrt(5.0L), 1e-18L);
}

/* Rays in faces, along edges and through vertices belong to one cell, not to none nor to several. */
void along_faces_and_edges(void **) {
  Scene scene = scene_of(cube(4, 0, [](auto &) { return 0.5; }), {{{0, 1, 1, 1}}, {{0, 1}}, {}});
  const Caster<Extended> caster(scene);
  const Extended third = std::sqrt(1 / 3.0L), half = std::sqrt(0.5L);
  const auto depth = [&](Vector<Extended> origin, Vector<Extended> direction) {
    return -std::log1p(-caster.ray_rgba({origin, direction, {}})[3]);
  };
  for (Extended x : {0.125L, 0.25L, 0.3125L, 0.5L, 0.75L})
    for (Extended y : {0.25L, 0.3125L, 0.5L}) {
      near(depth({x, y, -2}, {0, 0, 1}), 1, 1e-17L);
      near(depth({x, 3, y}, {0, -1, 0}), 1, 1e-17L);
      near(depth({-1, x, y}, {1, 0, 0}), 1, 1e-17L);
      near(depth({x - 0.5L, y, -0.5L}, {half, 0, half}), (1 - x) / half, 1e-17L);
    }
  near(depth({-1, -1, -1}, {third, third, third}), std::sqrt(3.0L), 1e-17L);
  near(depth({2, 2, 2}, {-third, -third, -third}), std::sqrt(3.0L), 1e-17L);
  near(depth({2, -1, -1}, {-third, third, third}), std::sqrt(3.0L), 1e-17L);
}

/* A scaled world with scaled extinction is the same picture. */
void scaling(void **) {
  const auto field = [](auto &p) { return p[0] * p[0] + p[2]; };
  const Transfer transfer = {{{0, 1, 0, 0}, {2, 0, 0, 1}}, {{0.5, 0}, {0.75, 9}, {1, 0}}, {}};
  const Scene scene = scene_of(cube(3, 0.2, field), transfer);
  const auto expected = Caster<Extended>(scene).pixel_rgba(1, 1);
  for (const double scale : {0x1p-40, 0x1p40}) {
    Scene scaled = scene;
    for (auto &p : scaled.mesh.points)
      for (double &x : p)
        x *= scale;
    for (auto &knot : scaled.transfer.extinction)
      knot[1] /= scale;
    for (size_t k = 0; k < 3; k++) {
      scaled.camera.eye[k] *= scale;
      scaled.camera.target[k] *= scale;
    }
    scaled.camera.height *= scale;
    const auto rgba = Caster<Extended>(scaled).pixel_rgba(1, 1);
    for (size_t c = 0; c < 4; c++)
      near(rgba[c], expected[c], 1e-18L);
  }
}

/* Far from zero, where the spacing of doubles is a hundred thousandth of a cell. */
void translation(void **) {
  Scene scene = scene_of(cube(4, 0, [](auto &p) { return p[0] * p[0] + p[2]; }),
                         {{{0, 1, 0, 0}, {2, 0, 0, 1}}, {{0.5, 0}, {0.5, 90}, {0.6, 90}, {0.6, 0}}, {}});
  scene.camera.target[0] += 0.3125;
  for (const bool orthographic : {true, false}) {
    scene.camera.orthographic = orthographic;
    scene.camera.fovy = 35;
    const auto expected = Caster<Extended>(scene).pixel_rgba(1, 1);
    Scene moved = scene;
    for (auto &p : moved.mesh.points)
      for (double &x : p)
        x += 0x1p34;
    for (size_t k = 0; k < 3; k++) {
      moved.camera.eye[k] += 0x1p34;
      moved.camera.target[k] += 0x1p34;
    }
    const auto rgba = Caster<Extended>(moved).pixel_rgba(1, 1);
    for (size_t c = 0; c < 4; c++)
      near(rgba[c], expected[c], 1e-18L);
  }
}

#ifdef TETCAST_REFERENCE_QUAD
void wider_type_agrees(void **) {
  const auto field = [](auto &p) { return std::sin(5 * p[0]) * p[1] + std::cos(7 * p[2] * p[0]); };
  Scene scene = scene_of(cube(6, 0.25, field), {{{-1, 1, 0, 0}, {0, 0, 1, 0}, {0, 1, 1, 0}, {1, 0, 0, 1}},
                                                {{-0.5, 0}, {-0.499, 1e3}, {-0.498, 0}, {0.25, 0}, {0.25, 20}, {2, 0}},
                                                {}});
  scene.camera = {{1.7, 2.1, 2.9}, {0.5, 0.4, 0.5}, {0.1, 1, 0.2}, false, 25, 0};
  scene.width = scene.height = 16;
  const Caster<Extended> caster(scene);
  const Caster<Quad> wider(scene);
  Extended seen = 0;
  for (int64_t i = 0; i < 256; i++) {
    const auto a = caster.pixel_rgba(i % 16, i / 16);
    const auto b = wider.pixel_rgba(i % 16, i / 16);
    for (size_t c = 0; c < 4; c++)
      near(a[c], Extended(b[c]), 1e-15L);
    seen += a[3];
  }
  assert_true(seen > 50);
}
#endif

} // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(constant_in_one_cell),
      cmocka_unit_test(linear_across_a_cube),
      cmocka_unit_test(rising_and_falling),
      cmocka_unit_test(bends),
      cmocka_unit_test(steps),
      cmocka_unit_test(opacity),
      cmocka_unit_test(thin_and_thick),
      cmocka_unit_test(transparent_and_left_out),
      cmocka_unit_test(picture_is_upright),
      cmocka_unit_test(scaling),
      cmocka_unit_test(along_faces_and_edges),
      cmocka_unit_test(translation),
#ifdef TETCAST_REFERENCE_QUAD
      cmocka_unit_test(wider_type_agrees),
#endif
  };
  return cmocka_run_group_tests(tests, nullptr, nullptr);
}
