/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures by fewer rays than pixels (Levoy 1990). The picture is covered by squares whose corners are pixels, `coarse`
 * pixels apart, through which rays are cast. A square whose corners differ is cut into four, rays are cast through the
 * new corners, and so on down to squares of two by two pixels, all of which are corners. In squares that are left whole
 * the pixels between are interpolated. What lies between the corners and is seen at none of them is missed: there is
 * no bound on the error.
 *
 * All squares of one size are looked at before any of the next, so which rays are cast, and in which order, depends on
 * the picture alone. */
#include <math.h>
#include <string.h>

#include "base/parallel.h"
#include "render/work.h"

enum {
  CHUNK = TC_TILE * TC_TILE, /* how many rays are cast at a time */
  FINE_PIXELS = 16           /* how many pixels have all their samples cast at a time */
};

typedef struct Adaptive {
  TcRender *render;
  TetcastContext *context;
  int64_t width, height;
  double epsilon;
  int coarse, fine;
  unsigned char *cast; /* [height][width]: 1 where a ray was cast, or is in the list of the next ones */
  double (*rgba)[4];   /* [height][width] */
  int64_t *pixels;     /* [pixel_count]: the pixels through which rays are cast next */
  int64_t pixel_count;
  int64_t *blocks[2]; /* [block_count[i]]: the squares of this size, and of the next, by their first pixels */
  int64_t block_count[2];
  int64_t rays;
  TcJob fine_job, fine_precise;

  const TetcastProgress *progress;
  double done, share; /* how much of the work was done before the loop under way, and how much is done by it */
} Adaptive;

static bool show_progress(void *user, double fraction) {
  const Adaptive *a = user;
  return a->progress->function(a->progress->user, a->done + a->share * fraction);
}

/* A loop that does `share` of all the work, or of what counts as that: how many rays there will be isn't known. */
static TetcastStatus loop(Adaptive *a, int64_t count, TcTask *task, double share) {
  const TetcastProgress progress = {a->progress->function ? show_progress : NULL, a};
  a->share = share;
  const TetcastStatus status = tc_parallel_for(a->context, count, 1, task, a, &progress);
  a->done += share;
  return status;
}

/* ── rays ── */

static bool cast_chunk(const Adaptive *a, int64_t first, TcWorking *working) {
  const TcRender *render = a->render;
  TcSample samples[CHUNK];
  const int64_t count = a->pixel_count - first < CHUNK ? a->pixel_count - first : CHUNK;
  for (int64_t i = 0; i < count; ++i) {
    const int64_t pixel = a->pixels[first + i];
    samples[i] = (TcSample){.x = pixel % a->width, .y = pixel / a->width, .pixel = i};
  }
  memset(working->sums, 0, (size_t)(count * render->job.sums) * sizeof *working->sums);
  if (!render->kernels->samples(&render->job, samples, count, &working->worker, working->sums))
    return false;
  TcGathered gathered = tc_render_gathered(render);
  for (int64_t i = 0; i < count; ++i) {
    gathered.sums = working->sums + i * render->job.sums;
    tc_gathered_pixel(&gathered, a->rgba[a->pixels[first + i]]);
  }
  return true;
}

static bool cast_chunks(void *data, int64_t begin, int64_t end, int worker) {
  const Adaptive *a = data;
  for (int64_t i = begin; i < end; ++i) {
    if (!cast_chunk(a, i * CHUNK, &a->render->workers[worker]))
      return false;
  }
  return true;
}

/* Casts the rays through the pixels of the list, and empties it. */
static TetcastStatus cast_listed(Adaptive *a, double share) {
  a->rays += a->pixel_count;
  const TetcastStatus status = loop(a, (a->pixel_count + CHUNK - 1) / CHUNK, cast_chunks, share);
  a->pixel_count = 0;
  return status;
}

/* Has a ray cast through the pixel, unless there was one already. */
static void want(Adaptive *a, int64_t x, int64_t y) {
  const int64_t pixel = y * a->width + x;
  if (a->cast[pixel])
    return;
  a->cast[pixel] = 1;
  a->pixels[a->pixel_count++] = pixel;
}

/* ── squares ── */

/* A square of `size` pixels from one corner to the next, or what is left of it at the picture's edge. */
typedef struct Block {
  int64_t x0, y0, x1, y1;
} Block;

static Block block_at(const Adaptive *a, int64_t x, int64_t y, int64_t size) {
  return (Block){x, y, x + size < a->width ? x + size : a->width - 1, y + size < a->height ? y + size : a->height - 1};
}

/* Whether any channel differs by epsilon or more from corner to corner; what isn't finite does. */
static bool differs(const Adaptive *a, const Block *b) {
  const double *corner[4] = {a->rgba[b->y0 * a->width + b->x0], a->rgba[b->y0 * a->width + b->x1],
                             a->rgba[b->y1 * a->width + b->x0], a->rgba[b->y1 * a->width + b->x1]};
  for (int k = 0; k < 4; ++k) {
    for (int i = 1; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        if (!(fabs(corner[i][k] - corner[j][k]) < a->epsilon))
          return true;
      }
    }
  }
  return false;
}

/* Has the corners of a square cast, and if it can be cut, has it looked at when they are. */
static void add_block(Adaptive *a, int list, int64_t x, int64_t y, int64_t size) {
  const Block b = block_at(a, x, y, size);
  want(a, b.x0, b.y0);
  want(a, b.x1, b.y0);
  want(a, b.x0, b.y1);
  want(a, b.x1, b.y1);
  if (size > 1)
    a->blocks[list][a->block_count[list]++] = y * a->width + x;
}

/* Cuts those of the squares of this size that differ. */
static void cut_blocks(Adaptive *a, int list, int64_t size) {
  const int64_t half = size / 2;
  a->block_count[!list] = 0;
  for (int64_t i = 0; i < a->block_count[list]; ++i) {
    const Block b = block_at(a, a->blocks[list][i] % a->width, a->blocks[list][i] / a->width, size);
    if (!differs(a, &b))
      continue;
    for (int k = 0; k < 4; ++k) {
      const int64_t x = b.x0 + (k & 1) * half, y = b.y0 + (k >> 1) * half;
      if ((x < b.x1 || !(k & 1)) && (y < b.y1 || !(k >> 1)))
        add_block(a, !list, x, y, half);
    }
  }
}

/* How many squares of this size lie side by side; a picture that is one pixel wide has one. */
static int64_t blocks_along(int64_t pixels, int64_t size) {
  return pixels > 1 ? (pixels - 2) / size + 1 : 1;
}

/* The squares to begin with, along Morton's curve, so that rays which are cast together see much the same cells. */
static void first_blocks(Adaptive *a) {
  const int64_t columns = blocks_along(a->width, a->coarse), rows = blocks_along(a->height, a->coarse);
  int64_t side = 1;
  while (side < columns || side < rows)
    side *= 2;
  for (int64_t i = 0; i < side * side; ++i) {
    const int64_t x = tc_even_bits(i), y = tc_even_bits(i >> 1);
    if (x < columns && y < rows)
      add_block(a, 0, x * a->coarse, y * a->coarse, a->coarse);
  }
}

/* Interpolates the pixels of a square through which no ray was cast. Of its last column and row it has only those of
 * the picture's edge, as the others are those of its neighbours. */
static void fill(const Adaptive *a, int64_t x0, int64_t y0, int64_t size) {
  const Block b = block_at(a, x0, y0, size);
  if (size == 1)
    return;
  if (differs(a, &b)) {
    const int64_t half = size / 2;
    for (int k = 0; k < 4; ++k) {
      const int64_t x = b.x0 + (k & 1) * half, y = b.y0 + (k >> 1) * half;
      if ((x < b.x1 || !(k & 1)) && (y < b.y1 || !(k >> 1)))
        fill(a, x, y, half);
    }
    return;
  }
  const double(*row0)[4] = (const double(*)[4])a->rgba + b.y0 * a->width, (*row1)[4] = row0 + (b.y1 - b.y0) * a->width;
  for (int64_t y = b.y0; y < b.y1 + (b.y1 == a->height - 1); ++y) {
    const double v = b.y1 > b.y0 ? (double)(y - b.y0) / (double)(b.y1 - b.y0) : 0;
    for (int64_t x = b.x0; x < b.x1 + (b.x1 == a->width - 1); ++x) {
      const double u = b.x1 > b.x0 ? (double)(x - b.x0) / (double)(b.x1 - b.x0) : 0;
      double *rgba = a->rgba[y * a->width + x];
      for (int k = 0; k < 4 && !a->cast[y * a->width + x]; ++k) {
        rgba[k] =
            (1 - v) * ((1 - u) * row0[b.x0][k] + u * row0[b.x1][k]) + v * ((1 - u) * row1[b.x0][k] + u * row1[b.x1][k]);
      }
    }
  }
}

static bool fill_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Adaptive *a = data;
  for (int64_t row = begin; row < end; ++row) {
    for (int64_t i = 0; i < blocks_along(a->width, a->coarse); ++i)
      fill(a, i * a->coarse, row * a->coarse, a->coarse);
  }
  return true;
}

/* ── several rays in a pixel ── */

static bool stands_out(const Adaptive *a, int64_t x, int64_t y) {
  static const int step[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  const double *own = a->rgba[y * a->width + x];
  for (int i = 0; i < 4; ++i) {
    const int64_t u = x + step[i][0], v = y + step[i][1];
    if (u < 0 || u >= a->width || v < 0 || v >= a->height)
      continue;
    const double *other = a->rgba[v * a->width + u];
    for (int k = 0; k < 4; ++k) {
      if (!(fabs(own[k] - other[k]) < a->epsilon))
        return true;
    }
  }
  return false;
}

static bool refine_pixels(void *data, int64_t begin, int64_t end, int worker) {
  const Adaptive *a = data;
  const TcRender *render = a->render;
  const int sums = render->job.sums;
  TcWorking *working = &render->workers[worker];
  TcSample samples[CHUNK];
  TcGathered gathered = tc_render_gathered(render);
  for (int64_t chunk = begin; chunk < end; ++chunk) {
    const int64_t first = chunk * FINE_PIXELS,
                  pixels = a->pixel_count - first < FINE_PIXELS ? a->pixel_count - first : FINE_PIXELS;
    memset(working->sums, 0, (size_t)(pixels * sums) * sizeof *working->sums);
    for (int64_t i = 0; i < pixels * a->fine;) {
      int64_t count = 0;
      for (; count < CHUNK && i < pixels * a->fine; ++count, ++i) {
        const int64_t pixel = a->pixels[first + i / a->fine];
        samples[count] = (TcSample){pixel % a->width, pixel / a->width, i / a->fine, (int)(i % a->fine)};
      }
      if (!render->kernels->samples(&a->fine_job, samples, count, &working->worker, working->sums))
        return false;
    }
    for (int64_t i = 0; i < pixels * sums; ++i)
      working->sums[i] /= a->fine;
    for (int64_t i = 0; i < pixels; ++i) {
      gathered.sums = working->sums + i * sums;
      tc_gathered_pixel(&gathered, a->rgba[a->pixels[first + i]]);
    }
  }
  return true;
}

/* Casts several rays through those pixels that differ from one of their neighbours. */
static TetcastStatus refine(Adaptive *a) {
  a->fine_job = a->render->job;
  tc_sample_grid(a->fine, &a->fine_job.samples_x, &a->fine_job.samples_y);
  if (a->fine_job.precise_job) {
    a->fine_precise = *a->fine_job.precise_job;
    tc_sample_grid(a->fine, &a->fine_precise.samples_x, &a->fine_precise.samples_y);
    a->fine_job.precise_job = &a->fine_precise;
  }
  for (int64_t y = 0; y < a->height; ++y) {
    for (int64_t x = 0; x < a->width; ++x) {
      if (stands_out(a, x, y))
        a->pixels[a->pixel_count++] = y * a->width + x;
    }
  }
  a->rays += a->pixel_count * a->fine;
  return loop(a, (a->pixel_count + FINE_PIXELS - 1) / FINE_PIXELS, refine_pixels, 1 - a->done);
}

/* ── all of it ── */

static bool store_rows(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Adaptive *a = data;
  for (int64_t y = begin; y < end; ++y) {
    for (int64_t x = 0; x < a->width; ++x)
      tc_frame_put(a->render->frame, x, y, a->rgba[y * a->width + x]);
  }
  return true;
}

static bool reserve(Adaptive *a) {
  const int64_t count = a->width * a->height, blocks = (a->width / 2 + 1) * (a->height / 2 + 1);
  const bool ok = tc_allocate_array(a->context, (void **)&a->cast, count, sizeof *a->cast, "pixels") &&
                  tc_allocate_array(a->context, (void **)&a->rgba, count, sizeof *a->rgba, "pixels") &&
                  tc_allocate_array(a->context, (void **)&a->pixels, count, sizeof *a->pixels, "pixels") &&
                  tc_allocate_array(a->context, (void **)&a->blocks[0], blocks, sizeof *a->blocks[0], "pixels") &&
                  tc_allocate_array(a->context, (void **)&a->blocks[1], blocks, sizeof *a->blocks[1], "pixels");
  if (ok)
    memset(a->cast, 0, (size_t)count * sizeof *a->cast);
  return ok;
}

static void release(Adaptive *a) {
  tc_release(a->context, a->cast);
  tc_release(a->context, a->rgba);
  tc_release(a->context, a->pixels);
  tc_release(a->context, a->blocks[0]);
  tc_release(a->context, a->blocks[1]);
}

TetcastStatus tc_adaptive_run(TcRender *render, const TetcastRenderDesc *desc, int64_t *rays) {
  Adaptive a = {.render = render,
                .context = render->scene->context,
                .width = render->job.width,
                .height = render->job.height,
                .epsilon = desc->adaptive_epsilon,
                .coarse = desc->adaptive_coarse,
                .fine = desc->adaptive_fine,
                .progress = &desc->progress};
  TetcastStatus status = reserve(&a) ? TETCAST_OK : TETCAST_ERROR_MEMORY;
  if (!status) {
    first_blocks(&a);
    status = cast_listed(&a, 0.25);
  }
  int list = 0;
  for (int64_t size = a.coarse; !status && size > 1; size /= 2, list = !list) {
    cut_blocks(&a, list, size);
    status = cast_listed(&a, 0.5 * (1 - a.done));
  }
  if (!status)
    status = tc_parallel_for(a.context, blocks_along(a.height, a.coarse), 1, fill_rows, &a, NULL);
  if (!status && a.fine > 1)
    status = refine(&a);
  if (!status)
    status = tc_parallel_for(a.context, a.height, 64, store_rows, &a, NULL);
  release(&a);
  *rays = a.rays;
  return status;
}
