/* SPDX-License-Identifier: Apache-2.0 */
#include "render/outline.h"

#include <math.h>

#include "base/vec3.h"

typedef struct Outline {
  const TcView *view;
  const TetcastArray *stop;
  TetcastFrame *frame;
  int64_t height, first_row; /* of the picture that the frame has rows of */
  const double *color;
  int exponent; /* the volume's unit of length is 2^exponent of the mesh's */
  bool front;   /* the edge under way lies before the mesh, else behind it */
} Outline;

/* A point as the camera sees it: the place in pixels, and its distance along the direction of view, scaled. */
typedef struct Seen {
  double x, y, z;
} Seen;

/* The part of a pixel that a line of one pixel's width covers, at this distance from its middle. */
static double coverage_at(double distance) {
  return distance < 1 ? 1 - distance : 0;
}

/* Whether the rays of a pixel stop before the point of the edge that is z along the direction of view. */
static bool is_hidden(const Outline *o, int64_t x, int64_t y, double z) {
  if (!o->stop)
    return false;
  const TetcastFrame *frame = o->frame;
  double distance = z;
  if (!o->view->orthographic) {
    const double u = o->view->center[0] + (2 * (double)x + 1) / (double)frame->width - 1,
                 v = o->view->center[1] + 1 - (2 * (double)y + 1) / (double)o->height;
    double direction[3];
    for (int k = 0; k < 3; ++k)
      direction[k] = o->view->forward[k] + u * o->view->right[k] + v * o->view->up[k];
    distance *= sqrt(tc_dot(direction, direction));
  }
  return ldexp(distance, o->exponent) > tc_array_double(o->stop, tc_array_stride(o->stop, 1), y * frame->width + x, 0);
}

/* Lays the line's colour over a pixel, or under it. */
static void blend(const Outline *o, int64_t x, int64_t y, double coverage) {
  TetcastFrame *frame = o->frame;
  double rgba[4];
  tc_frame_get(frame, x, y - o->first_row, rgba);
  const double share = o->front ? coverage : coverage * (1 - rgba[3]), kept = o->front ? 1 - coverage : 1;
  for (int k = 0; k < 4; ++k)
    rgba[k] = kept * rgba[k] + share * (k < 3 ? o->color[k] : 1);
  tc_frame_put(frame, x, y - o->first_row, rgba);
}

/* The range of whole numbers in [begin, end) between two numbers of any size. */
static bool whole_range(double from, double to, int64_t begin, int64_t end, int64_t *first, int64_t *last) {
  from = fmax(floor(from), (double)begin);
  to = fmin(ceil(to), (double)(end - 1));
  if (!(from <= to))
    return false;
  *first = (int64_t)from;
  *last = (int64_t)to;
  return true;
}

/* Draws the line between two points, along rows, or along columns where it goes more up and down than to the side. */
static void draw_line(const Outline *o, const Seen *a, const Seen *b) {
  const double dx = b->x - a->x, dy = b->y - a->y, length2 = dx * dx + dy * dy;
  const bool steep = fabs(dy) > fabs(dx);
  const double along = steep ? dy : dx, start = steep ? a->y : a->x, aside = steep ? a->x : a->y,
               slope = along != 0 ? (steep ? dx : dy) / along : 0;
  const int64_t top = o->first_row, bottom = top + o->frame->height, width = o->frame->width;
  int64_t first, last;
  if (!whole_range(fmin(start, start + along) - 2, fmax(start, start + along) + 1, steep ? top : 0,
                   steep ? bottom : width, &first, &last))
    return;
  for (int64_t i = first; i <= last; ++i) {
    const double middle = aside + ((double)i + 0.5 - start) * slope;
    int64_t from, to;
    if (!whole_range(middle - 3, middle + 2, steep ? 0 : top, steep ? width : bottom, &from, &to))
      continue;
    for (int64_t j = from; j <= to; ++j) {
      const int64_t x = steep ? j : i, y = steep ? i : j;
      const double px = (double)x + 0.5 - a->x, py = (double)y + 0.5 - a->y;
      double at = length2 > 0 ? (px * dx + py * dy) / length2 : 0;
      at = at < 0 ? 0 : at > 1 ? 1 : at;
      const double coverage = coverage_at(hypot(px - at * dx, py - at * dy));
      const double z = o->view->orthographic ? a->z + at * (b->z - a->z) : 1 / ((1 - at) / a->z + at / b->z);
      if (coverage > 0 && !is_hidden(o, x, y, z))
        blend(o, x, y, coverage);
    }
  }
}

/* Draws the edge between two corners, scaled, as far as it lies before the eye. */
static void draw_edge(const Outline *o, double corner[2][3]) {
  const TcView *view = o->view;
  double place[2][3]; /* along right, up and forward */
  double farthest = 0;
  for (int i = 0; i < 2; ++i) {
    double from_eye[3];
    for (int k = 0; k < 3; ++k)
      from_eye[k] = corner[i][k] - view->eye[k];
    place[i][0] = tc_dot(from_eye, view->right) / tc_dot(view->right, view->right);
    place[i][1] = tc_dot(from_eye, view->up) / tc_dot(view->up, view->up);
    place[i][2] = tc_dot(from_eye, view->forward);
    farthest = fmax(farthest, place[i][2]);
  }
  const double nearest = view->orthographic ? 0 : 1e-6 * farthest;
  if (!(farthest > nearest))
    return;
  for (int i = 0; i < 2; ++i) {
    if (place[i][2] >= nearest)
      continue;
    const double part = (nearest - place[i][2]) / (place[!i][2] - place[i][2]);
    for (int k = 0; k < 3; ++k)
      place[i][k] += part * (place[!i][k] - place[i][k]);
    place[i][2] = nearest;
  }
  Seen seen[2];
  for (int i = 0; i < 2; ++i) {
    const double depth = view->orthographic ? 1 : place[i][2];
    seen[i] = (Seen){.x = (place[i][0] / depth - view->center[0] + 1) / 2 * (double)o->frame->width,
                     .y = (1 + view->center[1] - place[i][1] / depth) / 2 * (double)o->height,
                     .z = place[i][2]};
  }
  draw_line(o, &seen[0], &seen[1]);
}

/* Whether the eye sees the outside of the box's face at its lower or upper side along axis k. */
static bool shows_outside(const TcView *view, double box[2][3], int k, int side) {
  if (view->orthographic)
    return side ? view->forward[k] < 0 : view->forward[k] > 0;
  return side ? view->eye[k] > box[1][k] : view->eye[k] < box[0][k];
}

void tc_outline_draw(const TetcastVolume *volume, const TcView *view, const TetcastArray *stop, const double color[3],
                     int64_t height, int64_t first_row, TetcastFrame *frame) {
  Outline outline = {.view = view,
                     .stop = stop,
                     .frame = frame,
                     .height = height,
                     .first_row = first_row,
                     .color = color,
                     .exponent = volume->exponent};
  double box[2][3];
  for (int k = 0; k < 3; ++k) {
    box[0][k] = ldexp(volume->info.bounds[2 * k], -volume->exponent);
    box[1][k] = ldexp(volume->info.bounds[2 * k + 1], -volume->exponent);
  }
  for (int front = 0; front < 2; ++front) { /* what lies behind comes under what is there, what lies before over all */
    outline.front = front;
    for (int i = 0; i < 12; ++i) {
      const int k = i / 4, side[2] = {i & 1, i >> 1 & 1}, axis[2] = {(k + 1) % 3, (k + 2) % 3};
      if ((shows_outside(view, box, axis[0], side[0]) || shows_outside(view, box, axis[1], side[1])) != front)
        continue;
      double corner[2][3];
      for (int end = 0; end < 2; ++end) {
        corner[end][k] = box[end][k];
        for (int j = 0; j < 2; ++j)
          corner[end][axis[j]] = box[side[j]][axis[j]];
      }
      draw_edge(&outline, corner);
    }
  }
}
