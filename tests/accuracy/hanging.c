/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices that hang in a larger cell's face: one face of a hexahedron against four. A linear field must give its
 * analytic integral there, in every pixel: what is lost in a gap, or counted twice, shows as optical depth. */
#include "support.h"

enum { W = 120, H = 90, POINTS = 4 + 9 + 9, CELLS = 5 };

static void
rotate(double v[3]) { /* two plane rotations, and off the origin: what was in a plane is so but for rounding */
  const double c = cos(0.7), s = sin(0.7), d = cos(1.9), e = sin(1.9);
  const double x = c * v[0] - s * v[1], y = s * v[0] + c * v[1], z = v[2];
  v[0] = x + 0.3;
  v[1] = d * y - e * z + 0.1;
  v[2] = e * y + d * z - 0.7;
}

static void rotate_back(double v[3], bool point) {
  const double c = cos(0.7), s = sin(0.7), d = cos(1.9), e = sin(1.9);
  const double x = v[0] - 0.3 * point, q = v[1] - 0.1 * point, r = v[2] + 0.7 * point, y = d * q + e * r;
  v[0] = c * x + s * y;
  v[1] = -s * x + c * y;
  v[2] = -e * q + d * r;
}

static double field_at(const double *p) {
  return 3 + 0.5 * p[0] - 0.75 * p[1] + 0.25 * p[2];
}

/* A cube, and four bars beside it that meet in the middle of its face. */
static TetcastCut *cut_cells(Fixture *fixture, bool single, double p[POINTS][3]) {
  int64_t cells[CELLS][8] = {{0, 4, 6, 1, 2, 10, 12, 3}}; /* x = 0: y fastest, then z; x = 1 and 2: 3 × 3 */
  int count = 0;
  for (int i = 0; i < 4; ++i, ++count)
    memcpy(p[count], (double[3]){0, i % 2, i / 2}, sizeof p[0]);
  for (int i = 0; i < 18; ++i, ++count)
    memcpy(p[count], (double[3]){1 + i / 9, i % 3 / 2.0, i % 9 / 3 / 2.0}, sizeof p[0]);
  for (int i = 0; i < 4; ++i) {
    const int64_t a = 4 + i % 2 + 3 * (i / 2), b = a + 9;
    memcpy(cells[i + 1], (int64_t[8]){a, b, b + 1, a + 1, a + 3, b + 3, b + 4, a + 4}, sizeof cells[0]);
  }
  for (int i = 0; i < POINTS; ++i) {
    rotate(p[i]);
    for (int k = 0; single && k < 3; ++k)
      p[i][k] = (double)(float)p[i][k];
  }
  TetcastCellsDesc desc = tetcast_cells_desc_default();
  desc.vertices = (TetcastArray){p, TETCAST_TYPE_FLOAT64, POINTS, 0};
  desc.connectivity = (TetcastArray){cells, TETCAST_TYPE_INT64, CELLS, 0};
  TetcastCut *cut = NULL;
  assert_int_equal(tetcast_cells_cut(fixture->context, &desc, &cut), TETCAST_OK);
  return cut;
}

static Body body_with(Fixture *fixture, TetcastTraversal traversal, bool single) {
  double p[POINTS][3], values[POINTS];
  TetcastCut *cut = cut_cells(fixture, single, p);
  for (int i = 0; i < POINTS; ++i)
    values[i] = field_at(p[i]);
  TetcastMeshDesc desc = tetcast_mesh_desc_default();
  desc.vertices = (TetcastArray){p, TETCAST_TYPE_FLOAT64, POINTS, 0};
  desc.tetrahedra = tetcast_cut_tetrahedra(cut);
  TetcastMesh *mesh = NULL;
  assert_int_equal(tetcast_mesh_create(fixture->context, &desc, &mesh), TETCAST_OK);
  const Body body = body_of(fixture->context, mesh, traversal, values, POINTS, TETCAST_POINT);
  tetcast_mesh_destroy(&mesh);
  tetcast_cut_destroy(&cut);
  return body;
}

/* White, of an extinction that is the field. */
static TetcastTransferFunction *linear(TetcastContext *context) {
  const double color[4] = {0, 1, 1, 1}, extinction[2][2] = {{0, 0}, {10, 10}};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = color;
  desc.color_count = 1;
  desc.extinction = extinction[0];
  desc.extinction_count = 2;
  TetcastTransferFunction *transfer = NULL;
  assert_int_equal(tetcast_transfer_function_create(context, &desc, &transfer), TETCAST_OK);
  return transfer;
}

/* Optical depth of a ray: the chord in the box times the extinction in its middle. */
static double depth_of(const double eye[3], const double direction[3]) {
  double o[3], d[3], enter = 0, leave = INFINITY;
  memcpy(o, eye, sizeof o);
  memcpy(d, direction, sizeof d);
  rotate_back(o, true);
  rotate_back(d, false);
  for (int k = 0; k < 3; ++k) {
    const double a = -o[k] / d[k], b = ((k == 0 ? 2 : 1) - o[k]) / d[k];
    enter = fmax(enter, fmin(a, b));
    leave = fmin(leave, fmax(a, b));
  }
  if (leave <= enter)
    return 0;
  double middle[3], norm = 0;
  for (int k = 0; k < 3; ++k) {
    middle[k] = eye[k] + (enter + leave) / 2 * direction[k];
    norm += direction[k] * direction[k];
  }
  return (leave - enter) * sqrt(norm) * field_at(middle);
}

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int k = 0; k < 3; ++k)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The largest difference to what is expected. */
static double largest_error(const double *pixels, const TetcastCamera *camera) {
  double forward[3], right[3], up[3], lengths[3] = {0, 0, 0}, largest = 0;
  int seen = 0;
  for (int k = 0; k < 3; ++k)
    forward[k] = camera->target[k] - camera->eye[k];
  cross(forward, camera->up, right);
  cross(right, forward, up);
  for (int k = 0; k < 3; ++k)
    lengths[0] += forward[k] * forward[k], lengths[1] += right[k] * right[k], lengths[2] += up[k] * up[k];
  for (int i = 0; i < W * H; ++i) {
    const double x = (2 * (i % W + 0.5) / W - 1) * W / H, y = 1 - 2 * (i / W + 0.5) / H;
    const bool flat = camera->projection == TETCAST_ORTHOGRAPHIC;
    const double scale = flat ? camera->height / 2 : tan(camera->fovy * acos(-1) / 360);
    double eye[3], direction[3];
    for (int k = 0; k < 3; ++k) {
      const double aside = scale * (x * right[k] / sqrt(lengths[1]) + y * up[k] / sqrt(lengths[2]));
      eye[k] = camera->eye[k] + (flat ? aside : 0);
      direction[k] = forward[k] / sqrt(lengths[0]) + (flat ? 0 : aside);
    }
    const double alpha = -expm1(-depth_of(eye, direction));
    seen += alpha > 0.5;
    for (int c = 0; c < 4; ++c)
      largest = fmax(largest, fabs(pixels[4 * i + c] - alpha));
  }
  assert_true(seen > W * H / 20);
  return largest;
}

static void test_pictures(void **state) {
  (void)state;
  Fixture fixture;
  assert_int_equal(fixture_begin(&fixture, 2, 0), TETCAST_OK);
  TetcastTransferFunction *transfer = linear(fixture.context);
  for (int single = 0; single < 2; ++single) {
    for (int traversal = 0; traversal < 2; ++traversal) {
      Body body = body_with(&fixture, traversal ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL, single);
      for (int view = 0; view < 12; ++view) {
        double middle[3] = {1, 0.5, 0.5}, eye[3] = {1 + 4 * cos(view), 0.5 + 4 * sin(view), 0.5 + 2 * sin(3.0 * view)};
        if (view == 10)
          memcpy(eye, (double[3]){1, 5, 0.5}, sizeof eye); /* along the face between */
        if (view == 11)
          memcpy(eye, (double[3]){0.9, 0.4, 0.3}, sizeof eye); /* within the cube */
        rotate(middle);
        rotate(eye);
        TetcastCamera camera = camera_of(eye[0], eye[1], eye[2], middle[0], middle[1], middle[2]);
        camera.projection = view % 2 ? TETCAST_PERSPECTIVE : TETCAST_ORTHOGRAPHIC;
        camera.height = 3;
        double *pixels = picture(fixture.context, &body, transfer, &camera, W, H, NULL);
        const double error = largest_error(pixels, &camera);
        if (!(error <= (single ? 1e-5 : 1e-13)))
          fail_msg("traversal %d, view %d, single %d: off by %g", traversal, view, single, error);
        free(pixels);
      }
      body_destroy(&body);
    }
  }
  tetcast_transfer_function_destroy(&transfer);
  fixture_end(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pictures)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
