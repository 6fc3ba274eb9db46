/* SPDX-License-Identifier: Apache-2.0 */
/* No ray is lost and no segment doubled: random rays, and rays aimed through every vertex, along every edge and within
 * every face plane, on meshes chosen to hurt; in ray space, and on the screen with vertices moved so that rays meet
 * them exactly. TETCAST_RAYS sets the number of random rays (default 200,000 in all; the long run is 1e8). */
#include "all_kernels.h"

#include <float.h>

/* ── meshes ── */

typedef struct Soup {
  const char *name;
  Cube cube;
  bool box;      /* the cells fill the box `size` exactly */
  bool disjoint; /* the cells overlap nowhere */
  double size[3];
} Soup;

static void stretch(Soup *soup, double x, double y, double z) {
  const double by[3] = {x, y, z};
  for (int64_t i = 0; i < 3 * soup->cube.vertex_count; ++i)
    soup->cube.vertices[i] *= by[i % 3];
  for (int k = 0; k < 3; ++k)
    soup->size[k] *= by[k];
}

static Soup soup_cube(const char *name, int n, double jitter) {
  return (Soup){name, cube_create(n, jitter), true, true, {1, 1, 1}};
}

static void add_cell(Cube *cube, const int64_t cell[4]) {
  cube->cells = realloc(cube->cells, (size_t)(cube->cell_count + 1) * 4 * sizeof *cube->cells);
  memcpy(&cube->cells[4 * cube->cell_count++], cell, 4 * sizeof *cell);
}

/* A flat cell of no volume over every square of the surface, which swaps the square's diagonal. */
static Soup soup_flat(int n) {
  Soup soup = soup_cube("flat cells on the surface", n, 0.5);
  const int64_t m = n + 1, step[3] = {1, m, m * m};
  for (int k = 0; k < 3; ++k) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < n * n; ++i) {
        const int64_t u = step[(k + 1) % 3], v = step[(k + 2) % 3], base = side * n * step[k] + i % n * u + i / n * v;
        add_cell(&soup.cube, (const int64_t[4]){base, base + u, base + v, base + u + v});
      }
    }
  }
  return soup;
}

static Soup soup_one(const char *name, double x, double y, double z) {
  Soup soup = soup_cube(name, 1, 0);
  soup.cube.cell_count = 1;
  soup.box = false;
  stretch(&soup, x, y, z);
  return soup;
}

/* A cube without its middle third. */
static Soup soup_cavity(void) {
  Soup soup = soup_cube("cavity", 6, 0.3);
  int64_t kept = 0;
  for (int64_t i = 0; i < soup.cube.cell_count; ++i) {
    const int64_t c = i / 6, at[3] = {c % 6, c / 6 % 6, c / 36};
    if (at[0] / 2 == 1 && at[1] / 2 == 1 && at[2] / 2 == 1)
      continue;
    memmove(&soup.cube.cells[4 * kept++], &soup.cube.cells[4 * i], 4 * sizeof(int64_t));
  }
  soup.cube.cell_count = kept;
  soup.box = false;
  return soup;
}

/* A mesh that TetGen made, of cells of all shapes around a cavity. */
static Soup soup_tetgen(void) {
  Soup soup = {.name = "TetGen's, with a cavity", .size = {1, 1, 1}, .disjoint = true};
  Cube *cube = &soup.cube;
  FILE *file = fopen(TETCAST_CAVITY, "r");
  assert_non_null(file);
  while (fgetc(file) != '\n') {} /* what it is */
  long vertices, cells, index;
  assert_int_equal(fscanf(file, "%ld %ld", &vertices, &cells), 2);
  cube->vertex_count = vertices;
  cube->cell_count = cells;
  cube->vertices = malloc((size_t)vertices * 3 * sizeof *cube->vertices);
  cube->values = calloc((size_t)vertices, sizeof *cube->values);
  cube->cells = malloc((size_t)cells * 4 * sizeof *cube->cells);
  for (long i = 0; i < 3 * vertices; ++i)
    assert_int_equal(fscanf(file, "%lf", &cube->vertices[i]), 1);
  for (long i = 0; i < 4 * cells; ++i) {
    assert_int_equal(fscanf(file, "%ld", &index), 1);
    cube->cells[i] = index;
  }
  fclose(file);
  return soup;
}

/* A second cube moved by (x, y, z): touching at a corner, an edge or a side, with vertices of its own. */
static Soup soup_two(const char *name, double x, double y, double z) {
  Soup soup = soup_cube(name, 2, 0.3), other = soup_cube(name, 2, 0.3);
  Cube *a = &soup.cube, *b = &other.cube;
  const int64_t n = a->vertex_count;
  a->vertices = realloc(a->vertices, (size_t)(2 * n) * 3 * sizeof *a->vertices);
  a->values = realloc(a->values, (size_t)(2 * n) * sizeof *a->values);
  memcpy(a->values + n, b->values, (size_t)n * sizeof *b->values);
  for (int64_t i = 0; i < n; ++i) {
    const double by[3] = {x, y, z};
    for (int k = 0; k < 3; ++k)
      a->vertices[3 * (n + i) + k] = b->vertices[3 * i + k] + by[k];
  }
  a->vertex_count *= 2;
  for (int64_t i = 0; i < b->cell_count; ++i) {
    int64_t cell[4];
    for (int k = 0; k < 4; ++k)
      cell[k] = b->cells[4 * i + k] + n;
    add_cell(a, cell);
  }
  cube_destroy(b);
  soup.box = false;
  if (x == 1 && y == 0 && z == 0) {
    soup.box = true;
    soup.size[0] = 2;
  }
  return soup;
}

/* A cube of six cells beside one of 48, which share the corners between them: of the finer side five vertices hang in
 * the other's face. */
static Soup soup_hanging(void) {
  Soup soup = soup_cube("hanging vertices", 1, 0), other = soup_cube("", 2, 0.3);
  Cube *a = &soup.cube, *b = &other.cube;
  int64_t number[27];
  a->vertices = realloc(a->vertices, (size_t)(8 + 27) * 3 * sizeof *a->vertices);
  a->values = realloc(a->values, (size_t)(8 + 27) * sizeof *a->values);
  for (int64_t i = 0; i < 27; ++i) {
    double p[3];
    for (int k = 0; k < 3; ++k)
      p[k] = b->vertices[3 * i + k] + (k == 0);
    number[i] = a->vertex_count;
    for (int64_t j = 0; j < 8; ++j) {
      if (!memcmp(&a->vertices[3 * j], p, sizeof p))
        number[i] = j;
    }
    if (number[i] < a->vertex_count)
      continue;
    memcpy(&a->vertices[3 * number[i]], p, sizeof p);
    a->values[a->vertex_count++] = b->values[i];
  }
  assert_int_equal(a->vertex_count, 8 + 27 - 4);
  for (int64_t i = 0; i < b->cell_count; ++i) {
    int64_t cell[4];
    for (int k = 0; k < 4; ++k)
      cell[k] = number[b->cells[4 * i + k]];
    add_cell(a, cell);
  }
  cube_destroy(b);
  soup.size[0] = 2;
  return soup;
}

/* ── one ray several ways ── */

enum { QUEUE = 32 };

/* What has the length of a ray measured: the plain way, one lane that crosses every cell for itself, and all kernels
 * that walk. */
typedef struct Caster {
  Fixture fixture;
  const Soup *soup;
  TetcastMesh *mesh;
  TetcastVolume *volume[2]; /* shell, faces */
  TcJob job[2];             /* the length alone */
  TcWorker workers[2][ALL_KERNELS];
  int64_t rays;
  TcLine queue[QUEUE]; /* rays that go through the kernels together */
  double queue_length[QUEUE];
  int queued;
} Caster;

static void caster_begin(Caster *caster, const Soup *soup) {
  memset(caster, 0, sizeof *caster);
  assert_int_equal(fixture_begin(&caster->fixture, 2, 0), TETCAST_OK);
  caster->soup = soup;
  caster->mesh = cube_mesh(caster->fixture.context, &soup->cube);
  for (int i = 0; i < 2; ++i) {
    caster->volume[i] =
        volume_of(caster->fixture.context, caster->mesh, i ? TETCAST_TRAVERSAL_FACES : TETCAST_TRAVERSAL_SHELL);
    caster->job[i] = (TcJob){.kernel = TC_KERNEL_trace, .shell = &caster->volume[i]->shell, .sums = 1};
    for (int k = 0; k < ALL_KERNELS; ++k) {
      assert_true(
          tc_worker_begin(caster->fixture.context, all_kernels[k].kernels, &caster->job[i], &caster->workers[i][k]));
    }
  }
}

static double size_of(const Soup *soup) {
  return fmax(soup->size[0], fmax(soup->size[1], soup->size[2]));
}

static void compare(const Soup *soup, int kernel, int ray, double length, double plain) {
  assert_true(isfinite(length) && length >= 0);
  if (soup->disjoint && !(fabs(length - plain) <= 1e-13 * size_of(soup))) {
    fail_msg("%s: %s kernel, ray %d: %.17g, the plain way %.17g", soup->name, all_kernels[kernel].kernels->name, ray,
             length, plain);
  }
}

/* The queued rays by every kernel that this processor runs: the length inside is that of the plain way. */
static void flush(Caster *caster) {
  for (int k = 0; k < ALL_KERNELS; ++k) {
    if (!kernel_runs(k, caster->volume[0]))
      continue;
    double sums[QUEUE] = {0};
    TcWorker *worker = &caster->workers[0][k];
    assert_true(all_kernels[k].kernels->cast(&caster->job[0], caster->queue, caster->queued, worker, sums));
    assert_int_equal(worker->lost, 0);
    for (int j = 0; j < caster->queued; ++j) {
      compare(caster->soup, k, j, ldexp(sums[j], caster->volume[0]->exponent), caster->queue_length[j]);
    }
  }
  caster->queued = 0;
}

static void caster_end(Caster *caster) {
  flush(caster);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < ALL_KERNELS; ++k)
      tc_worker_end(caster->fixture.context, &caster->workers[i][k]);
    tetcast_volume_destroy(&caster->volume[i]);
  }
  tetcast_mesh_destroy(&caster->mesh);
  fixture_end(&caster->fixture);
}

/* Length inside, in the mesh's unit, and number of segments: by the plain walk, or by the kernel that crosses every
 * cell for itself. */
static double length_of(Caster *caster, int traversal, const double eye[3], const double direction[3],
                        int64_t *segments) {
  const TetcastVolume *volume = caster->volume[traversal];
  TcLine line = {.direction = {direction[0], direction[1], direction[2]}, .end = INFINITY};
  for (int k = 0; k < 3; ++k)
    line.eye[k] = ldexp(eye[k], -volume->exponent);
  double length = 0;
  if (traversal == 0) {
    const PlainScene scene = {.shell = &volume->shell};
    const PlainRay ray = {.line = line};
    const PlainResult result = plain_cast(&scene, &ray, &length);
    assert_false(result.lost);
    *segments = result.segments;
  } else {
    TcWorker *worker = &caster->workers[1][0];
    const int64_t before = worker->segments;
    assert_true(tc_kernels_one.cast(&caster->job[1], &line, 1, worker, &length));
    assert_int_equal(worker->lost, 0);
    *segments = worker->segments - before;
  }
  assert_true(isfinite(length) && length >= 0);
  length = ldexp(length, volume->exponent);
  if (traversal == 0) {
    caster->queue_length[caster->queued] = length;
    caster->queue[caster->queued++] = line;
    if (caster->queued == QUEUE)
      flush(caster);
  }
  return length;
}

/* The part of the ray inside the box [0, size]³ made larger by `margin` on every side; long double. */
static long double chord(const double size[3], const double eye[3], const double direction[3], long double margin) {
  long double enter = 0, leave = LDBL_MAX;
  for (int k = 0; k < 3; ++k) {
    const long double low = -margin - eye[k], high = size[k] + margin - eye[k];
    if (direction[k] == 0) {
      if (low > 0 || high < 0)
        return 0;
      continue;
    }
    enter = fmaxl(enter, fminl(low / direction[k], high / direction[k]));
    leave = fminl(leave, fmaxl(low / direction[k], high / direction[k]));
  }
  return leave > enter ? leave - enter : 0;
}

/* Sum over all cells of the length inside: each cell as an intersection of half-spaces, in long double. */
static long double brute_force(const Cube *cube, const double eye[3], const double direction[3]) {
  long double sum = 0;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    long double enter = 0, leave = LDBL_MAX, p[4][3];
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 3; ++k)
        p[j][k] = (long double)cube->vertices[3 * cube->cells[4 * i + j] + k] - eye[k];
    }
    for (int j = 0; j < 4; ++j) {
      const long double *a = p[(j + 1) & 3], *b = p[(j + 2) & 3], *c = p[(j + 3) & 3];
      long double n[3], inside = 0, at = 0, along = 0;
      for (int k = 0; k < 3; ++k) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        n[k] = (b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]);
      }
      for (int k = 0; k < 3; ++k) {
        inside += n[k] * (p[j][k] - a[k]);
        at += n[k] * a[k];
        along += n[k] * direction[k];
      }
      if (inside == 0) { /* flat */
        leave = 0;
        break;
      }
      if (inside < 0) {
        at = -at;
        along = -along;
      } /* inside where along · t ≥ at */
      if (along > 0)
        enter = fmaxl(enter, at / along);
      else if (along < 0)
        leave = fminl(leave, at / along);
      else if (at > 0)
        leave = 0;
    }
    if (leave > enter)
      sum += leave - enter;
  }
  return sum;
}

typedef enum Aim { RANDOM, AIMED } Aim;

static void check(Caster *caster, const double eye[3], const double direction[3], Aim aim) {
  const Soup *soup = caster->soup;
  int64_t segments[2];
  double length[2];
  for (int i = 0; i < 2; ++i)
    length[i] = length_of(caster, i, eye, direction, &segments[i]);
  ++caster->rays;
  const double scale = size_of(soup);
#define WHERE "%s: eye (%a, %a, %a) direction (%a, %a, %a): walk %.17g (%ld), faces %.17g (%ld)"
#define WHAT                                                                                                           \
  soup->name, eye[0], eye[1], eye[2], direction[0], direction[1], direction[2], length[0], (long)segments[0],          \
      length[1], (long)segments[1]
  if (soup->disjoint && !(fabs(length[0] - length[1]) <= 1e-13 * scale))
    fail_msg(WHERE, WHAT);
  if (soup->box) {
    /* The chord of some ray within a few roundings of coordinates: for most rays that is one number. */
    const long double least = chord(soup->size, eye, direction, -4e-16L * scale),
                      most = chord(soup->size, eye, direction, 4e-16L * scale);
    if (!(length[0] >= least - 1e-13L * scale && length[0] <= most + 1e-13L * scale)) {
      fail_msg(WHERE ", chord %.17Lg to %.17Lg", WHAT, least, most);
    }
  }
  if (aim == RANDOM && soup->disjoint && caster->rays % 16 == 0) {
    const long double reference = brute_force(&soup->cube, eye, direction);
    if (!(fabsl(length[0] - reference) <= 1e-12L * scale))
      fail_msg(WHERE ", brute force %.17Lg", WHAT, reference);
  }
}

/* ── rays ── */

static void random_direction(uint64_t *seed, double d[3]) {
  double norm;
  do {
    norm = 0;
    for (int k = 0; k < 3; ++k) {
      d[k] = 2 * uniform(seed) - 1;
      norm += d[k] * d[k];
    }
  } while (norm > 1 || norm < 1e-4);
  for (int k = 0; k < 3; ++k)
    d[k] /= sqrt(norm);
}

/* A ray through `point` along `d`, from outside; along an axis the components stay exact. */
static void shoot(Caster *caster, const double point[3], const double d[3], Aim aim) {
  double eye[3];
  const double back = 3 * size_of(caster->soup);
  for (int k = 0; k < 3; ++k)
    eye[k] = point[k] - back * d[k];
  check(caster, eye, d, aim);
}

static void normalized(double d[3]) {
  const double norm = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (int k = 0; k < 3; ++k)
    d[k] /= norm;
}

/* Through each vertex: along the axes, along each edge at it, within each face at it, and anyhow. */
static void aimed_rays(Caster *caster, uint64_t *seed) {
  const Cube *cube = &caster->soup->cube;
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    if (test_short() && i % 4 != 0)
      continue;
    for (int j = 0; j < 4; ++j) {
      const double *a = &cube->vertices[3 * cube->cells[4 * i + j]],
                   *b = &cube->vertices[3 * cube->cells[4 * i + (j + 1) % 4]],
                   *c = &cube->vertices[3 * cube->cells[4 * i + (j + 2) % 4]];
      double d[3];
      random_direction(seed, d);
      shoot(caster, a, d, AIMED);
      for (int k = 0; k < 3; ++k) {
        const double axis[3] = {k == 0, k == 1, k == 2},
                     back[3] = {-(double)(k == 0), -(double)(k == 1), -(double)(k == 2)};
        shoot(caster, a, axis, AIMED);
        shoot(caster, a, back, AIMED);
      }
      for (int k = 0; k < 3; ++k)
        d[k] = b[k] - a[k];
      if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] == 0)
        continue;
      normalized(d);
      shoot(caster, a, d, AIMED); /* along an edge */
      const double u = 2 * uniform(seed) - 1, v = 2 * uniform(seed) - 1;
      for (int k = 0; k < 3; ++k)
        d[k] = u * (b[k] - a[k]) + v * (c[k] - a[k]);
      normalized(d);
      double inside[3];
      for (int k = 0; k < 3; ++k)
        inside[k] = (a[k] + b[k] + c[k]) / 3;
      shoot(caster, inside, d, AIMED); /* within a face's plane */
      shoot(caster, a, d, AIMED);
    }
  }
}

/* ── on the screen ── */

/* FINE · SIDE positions a side are so many that moving vertices to them is less than what Embree's boxes are widened
 * by. */
enum { SIDE = 1 << 20, FINE = 1 << 10, SIGHTS = 6, RANDOM_POSITIONS = 500 };

/* Rays of a picture, at positions on a grid of FINE · SIDE points a side. */
typedef struct Positions {
  TcSample *samples;
  int64_t count;
} Positions;

/* A position is a column or a row of that grid. */
static int64_t position_of(double coordinate, double origin) {
  return (int64_t)floor((coordinate + origin) * FINE);
}

static void add_position(Positions *positions, int64_t column, int64_t row) {
  const int64_t all = (int64_t)SIDE * FINE;
  if (column < 0 || row < 0 || column >= all || row >= all)
    return;
  positions->samples[positions->count] = (TcSample){.x = column / FINE,
                                                    .y = row / FINE,
                                                    .pixel = positions->count,
                                                    .sample = (int)(row % FINE * FINE + column % FINE)};
  ++positions->count;
}

/* Through each vertex, through the middle of each edge, and anywhere. The vertices' positions are even. */
static Positions positions_of(const Caster *caster, const TcScreen *screen, uint64_t *seed) {
  const TetcastVolume *volume = caster->volume[0];
  const Cube *cube = &caster->soup->cube;
  const double *vertices = screen->vertices;
  int64_t(*at)[2] = malloc((size_t)cube->vertex_count * sizeof *at);
  Positions positions = {malloc((size_t)(10 * cube->cell_count + RANDOM_POSITIONS) * sizeof *positions.samples), 0};
  for (int64_t i = 0; i < cube->vertex_count; ++i) {
    at[volume->vertex_source[i]][0] = position_of(vertices[4 * i], screen->x0);
    at[volume->vertex_source[i]][1] = position_of(vertices[4 * i + 1], screen->y0);
  }
  for (int64_t i = 0; i < cube->cell_count; ++i) {
    for (int j = 0; j < 4; ++j) {
      const int64_t *a = at[cube->cells[4 * i + j]];
      add_position(&positions, a[0], a[1]);
      for (int k = 0; k < j; ++k) {
        const int64_t *b = at[cube->cells[4 * i + k]];
        add_position(&positions, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
      }
    }
  }
  for (int i = 0; i < RANDOM_POSITIONS; ++i) {
    const double all = (double)SIDE * FINE;
    add_position(&positions, (int64_t)(uniform(seed) * all), (int64_t)(uniform(seed) * all));
  }
  free(at);
  return positions;
}

/* The lengths of rays of a picture by every kernel, against the plain way, with vertices moved to where the rays are.
 */
static void check_screen(Caster *caster, const TetcastCamera *camera, uint64_t *seed) {
  TcJob job = caster->job[0];
  TcScreen screen;
  const int exponent = caster->volume[0]->exponent;
  job.width = job.height = SIDE;
  job.samples_x = job.samples_y = FINE;
  assert_int_equal(tc_view_create(caster->fixture.context, camera, caster->volume[0], 1, &job.view), TETCAST_OK);
  assert_true(project_all(&job, &screen));
  double *vertices = screen.vertices;
  for (int64_t i = 0; i < 4 * caster->volume[0]->vertex_count; ++i) {
    if (i % 4 < 2)
      vertices[i] = (2 * floor(vertices[i] * FINE / 2) + 0.5) / FINE;
  }
  const Positions rays = positions_of(caster, &screen, seed);
  const PlainScene scene = {.shell = job.shell, .screen = &screen};
  double *plain = malloc((size_t)rays.count * sizeof *plain), *sums = malloc((size_t)rays.count * sizeof *sums);
  for (int64_t i = 0; i < rays.count; ++i) {
    const TcSample *s = &rays.samples[i];
    const PlainRay ray = plain_ray(&job.view, SIDE, SIDE, FINE, FINE, s->x, s->y, s->sample, &screen);
    assert_false(plain_cast(&scene, &ray, &plain[i]).lost);
  }
  for (int k = 0; k < ALL_KERNELS; ++k) {
    if (!kernel_runs(k, caster->volume[0]))
      continue;
    TcWorker *worker = &caster->workers[0][k];
    memset(sums, 0, (size_t)rays.count * sizeof *sums);
    assert_true(all_kernels[k].kernels->samples(&job, rays.samples, rays.count, worker, sums));
    assert_int_equal(worker->lost, 0);
    for (int64_t i = 0; i < rays.count; ++i)
      compare(caster->soup, k, (int)i, ldexp(sums[i], exponent), ldexp(plain[i], exponent));
  }
  caster->rays += rays.count;
  free(plain);
  free(sums);
  free(rays.samples);
  free(screen.vertices);
}

/* From all sides and along the axes, in parallel and in perspective. */
static void check_screens(Caster *caster, uint64_t *seed) {
  const double *size = caster->soup->size;
  for (int i = 0; i < 2 * SIGHTS; ++i) {
    TetcastCamera camera = {.up = {0, 1, 0}, .fovy = 30, .height = 2 * size_of(caster->soup)};
    double d[3];
    random_direction(seed, d);
    if (i >= SIGHTS) { /* along an axis */
      for (int k = 0; k < 3; ++k)
        d[k] = k == i % 3;
      camera.up[1] = i % 3 != 1;
      camera.up[2] = i % 3 == 1;
    }
    for (int k = 0; k < 3; ++k) {
      camera.target[k] = 0.5 * size[k];
      camera.eye[k] = camera.target[k] + 4 * size_of(caster->soup) * d[k];
    }
    camera.projection = i % 2 ? TETCAST_ORTHOGRAPHIC : TETCAST_PERSPECTIVE;
    check_screen(caster, &camera, seed);
  }
}

static int64_t random_ray_count(void) {
  const char *text = getenv("TETCAST_RAYS");
  return text ? (int64_t)strtod(text, NULL) : test_short() ? 20000 : 200000;
}

static void run(Soup soup, double share) {
  Caster caster;
  caster_begin(&caster, &soup);
  uint64_t seed = 11;
  aimed_rays(&caster, &seed);
  const int64_t aimed = caster.rays, count = (int64_t)((double)random_ray_count() * share);
  for (int64_t i = 0; i < count; ++i) {
    double point[3], d[3];
    for (int k = 0; k < 3; ++k)
      point[k] = (uniform(&seed) * 1.1 - 0.05) * soup.size[k];
    random_direction(&seed, d);
    if (i % 4 == 1)
      d[i / 4 % 3] *= 1e-9; /* nearly within a plane of the grid: grazing */
    if (i % 4 == 3) {       /* scaled with the body, so that the long way is found as well */
      for (int k = 0; k < 3; ++k)
        d[k] *= soup.size[k];
    }
    normalized(d);
    shoot(&caster, point, d, RANDOM);
  }
  const int64_t before = caster.rays;
  check_screens(&caster, &seed);
  printf("%-28s %6ld cells %9ld aimed and %10ld random rays, %ld on the screen\n", soup.name,
         (long)soup.cube.cell_count, (long)aimed, (long)count, (long)(caster.rays - before));
  caster_end(&caster);
  cube_destroy(&soup.cube);
}

static void regular_cube(void **state) {
  (void)state;
  run(soup_cube("Kuhn-cut cube", 4, 0), 0.2);
}
static void jittered_cube(void **state) {
  (void)state;
  run(soup_cube("jittered cube", 4, 0.5), 0.3);
}
static void single_cell(void **state) {
  (void)state;
  run(soup_one("single cell", 1, 1, 1), 0.1);
}
static void cavity(void **state) {
  (void)state;
  run(soup_cavity(), 0.1);
}
static void tetgen_cavity(void **state) {
  (void)state;
  run(soup_tetgen(), 0.1);
}
static void flat_cells(void **state) {
  (void)state;
  run(soup_flat(3), 0.1);
}
static void needle(void **state) {
  (void)state;
  run(soup_one("needle", 1e-8, 1e-8, 1), 0.05);
}

static void slivers(void **state) {
  (void)state;
  Soup soup = soup_cube("slivers of aspect 1e8", 3, 0.5);
  stretch(&soup, 1, 1, 1e-8);
  run(soup, 0.05);
}

static void touching(void **state) {
  (void)state;
  run(soup_two("touching at a vertex", 1, 1, 1), 0.03);
  run(soup_two("touching along an edge", 1, 1, 0), 0.03);
  run(soup_two("touching at a face", 1, 0, 0), 0.04);
  run(soup_hanging(), 0.04);
}

/* Cells of random vertices, overlapping, collapsed, doubled, many at a face: whatever it means, it ends, and loses no
 * ray. */
static void random_cells_terminate(void **state) {
  (void)state;
  uint64_t seed = 99;
  for (int round = 0; round < 300; ++round) {
    Soup soup = soup_cube("random cells", 2, 0.5);
    soup.box = soup.disjoint = false;
    const int64_t few = 5 + round % 22;
    for (int64_t i = 0; i < 4 * soup.cube.cell_count; ++i)
      soup.cube.cells[i] = (int64_t)(uniform(&seed) * (double)few);
    soup.cube.cells[0] = 0, soup.cube.cells[1] = 1, soup.cube.cells[2] = 3,
    soup.cube.cells[3] = 4; /* one that is a cell */
    if (round % 3 == 0) {
      for (int64_t i = 0; i < 3 * soup.cube.vertex_count; ++i)
        soup.cube.vertices[i] = floor(3 * uniform(&seed)) / 2; /* degenerate */
    }
    Caster caster;
    caster_begin(&caster, &soup);
    for (int i = 0; i < 200; ++i) {
      double point[3], d[3];
      for (int k = 0; k < 3; ++k)
        point[k] = i % 2 ? uniform(&seed) : 0.5;
      random_direction(&seed, d);
      if (i % 5 == 0)
        d[0] = 0, d[1] = 0, d[2] = 1;
      shoot(&caster, point, d, RANDOM);
    }
    if (round % 10 == 0)
      check_screens(&caster, &seed);
    caster_end(&caster);
    cube_destroy(&soup.cube);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(regular_cube),  cmocka_unit_test(jittered_cube),
      cmocka_unit_test(single_cell),   cmocka_unit_test(cavity),
      cmocka_unit_test(tetgen_cavity), cmocka_unit_test(flat_cells),
      cmocka_unit_test(needle),        cmocka_unit_test(slivers),
      cmocka_unit_test(touching),      cmocka_unit_test(random_cells_terminate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
