/* SPDX-License-Identifier: Apache-2.0 */
/* Isosurfaces between the parts of a ray's segments. A lane is between two of them, in a layer; as long as the scalar
 * is in it at the next face, low ≤ s < high, nothing is met, and that is all that a step has to look at. */
#ifndef TC_GATHER_SURFACES_H
#define TC_GATHER_SURFACES_H

#include "gather/seam.h"

/* Where lanes are among them. A lane that sets out, comes from cells with NaN, or is before the part of its ray that
 * counts doesn't know yet: its `low` is ∞. */
typedef struct TcLayers {
  TcVec low, high;
  TcVec slice; /* the depth of the next slice */
  TcVec veil;  /* what the surfaces so far let through */
  /* If the depth is wanted: the optical depth that is missing until alpha is one half, ∞ once it is; the depth where it
   * is, ∞ until then; the depth where the stretch under way begins. */
  TcVec missing, depth, position;
  TcVec normal[3]; /* of the surface at that depth; 0: it lies at none */
  TcMask entering; /* lanes that set out from the shell */
  int below[TC_LANES];
} TcLayers;

TC_INLINE void tc_layers_begin(TcLayers *layers) {
  layers->low = layers->high = tc_set((TcReal)INFINITY);
  layers->slice = layers->low;
  layers->veil = tc_set(1);
  layers->missing = tc_set((TcReal)0.69314718055994530942);
  layers->depth = layers->position = layers->low;
  for (int k = 0; k < 3; ++k)
    layers->normal[k] = tc_set(0);
  layers->entering = tc_none();
}

/* A stretch of this length with extinctions that go from a / length to a1 / length. With m missing, alpha is one half
 * at the fraction u for which a u + (a1 − a) u²/2 = m; written so, the root has no difference of like numbers. */
TC_INLINE void tc_layers_descend(TcLayers *layers, TcMask mask, TcVec a, TcVec a1, TcVec depth, TcVec length) {
  const TcMask half = tc_and(mask, tc_lt(layers->missing, depth));
  if (TC_UNLIKELY(tc_any(half))) {
    const TcVec twice = layers->missing + layers->missing;
    const TcVec u = twice / (a + tc_sqrt(tc_max(tc_set(0), tc_madd(a1 - a, twice, a * a))));
    layers->depth = tc_select(half, tc_madd(tc_min(u, tc_set(1)), length, layers->position), layers->depth);
  }
  layers->missing =
      tc_select(half, tc_set((TcReal)INFINITY), tc_select(mask, layers->missing - depth, layers->missing));
}

/* What lanes meet. */
typedef struct TcMeeting {
  TcVec color[3], opacity;
  TcVec normal[3]; /* if it is wanted: a unit vector towards the eye */
} TcMeeting;

/* The lanes of `mask` meet surfaces at this depth. */
TC_NOINLINE void tc_layers_step(TcLayers *layers, TcMask mask, const TcMeeting *meeting, const TcVec *depth) {
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const double alpha = (double)TC_AT(meeting->opacity, l), missing = (double)TC_AT(layers->missing, l),
                 more = -log1p(-alpha);
    const bool half = missing < INFINITY && (alpha >= 0.5 || missing < more);
    if (half)
      TC_AT(layers->depth, l) = TC_AT(*depth, l);
    for (int k = 0; half && k < 3; ++k)
      TC_AT(layers->normal[k], l) = TC_AT(meeting->normal[k], l);
    TC_AT(layers->missing, l) = (TcReal)(half ? INFINITY : missing - more);
  }
}

TC_INLINE void tc_layers_forget(TcLayers *layers, TcMask mask) {
  layers->low = tc_select(mask, tc_set((TcReal)INFINITY), layers->low);
}

/* Lanes that have to find their layer. A scalar that may jump from cell to cell has it found in each: only what it does
 * within a cell is a surface. */
TC_INLINE TcMask tc_layers_unknown(const unsigned on, const TcLayers *layers, TcVec s) {
  if (on & TC_CORNERS)
    return tc_and_not(tc_all(), tc_and(tc_le(layers->low, s), tc_lt(s, layers->high)));
  return tc_eq(layers->low, tc_set((TcReal)INFINITY));
}

/* `below` isosurfaces are below lane l. */
TC_INLINE void tc_layers_set(const TcSurfaces *surfaces, TcLayers *layers, int l, int below) {
  layers->below[l] = below;
  TC_AT(layers->low, l) = below > 0 ? (TcReal)surfaces->surface[below - 1].value : (TcReal)-INFINITY;
  TC_AT(layers->high, l) = below < surfaces->count ? (TcReal)surfaces->surface[below].value : (TcReal)INFINITY;
}

/* The lanes of `mask` find where they are. */
TC_INLINE void tc_layers_locate(const TcSurfaces *surfaces, TcLayers *layers, TcMask mask, TcVec s) {
  for (unsigned lanes = tc_bits(mask); lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    int below = 0, above = surfaces->count;
    while (below < above) {
      const int middle = (below + above) / 2;
      if (surfaces->surface[middle].value <= (double)TC_AT(s, l))
        below = middle + 1;
      else
        above = middle;
    }
    tc_layers_set(surfaces, layers, l, below);
  }
}

/* The lanes of `mask` find the next slice that is not before `depth`, or lies behind it. */
TC_NOINLINE void tc_layers_next_slice(const TcSurfaces *surfaces, const TcPacket *walk, TcMask mask, bool behind,
                                      TcVec depth, TcLayers *layers) {
  TcVec next = tc_set((TcReal)INFINITY);
  for (int i = 0; i < surfaces->slice_count; ++i) {
    const TcMask ahead = behind ? tc_lt(depth, walk->slice[i]) : tc_le(depth, walk->slice[i]);
    next = tc_select(ahead, tc_min(next, walk->slice[i]), next);
  }
  layers->slice = tc_select(mask, next, layers->slice);
}

/* The gradient at `fraction` of the way that lane l went through a cell. */
static void tc_surface_gradient(const TcGatherJob *job, const TcPassage *passage, int l, double fraction,
                                double gradient[3]) {
  const TcCrossed *entry = passage->entry;
  const TcPacket *walk = passage->walk;
  if (job->surfaces->smooth) {
    for (int i = 0; i < 3; ++i)
      gradient[i] = 0;
    for (int k = 0; k < 3; ++k) {
      const float *first = job->surfaces->smooth->at[TC_AT(entry->id[k], l)],
                  *last = job->surfaces->smooth->at[TC_AT(walk->v[k].id, l)];
      const double from = (1 - fraction) * (double)TC_AT(entry->barycentric[k], l),
                   to = fraction * (double)TC_AT(walk->at.barycentric[k], l);
      for (int i = 0; i < 3; ++i)
        gradient[i] += from * (double)first[i] + to * (double)last[i];
    }
    return;
  }
  /* The cell's vertices are those of the face where the ray came in and the one that is new in the other. */
  uint32_t id[4] = {TC_AT(entry->id[0], l), TC_AT(entry->id[1], l), TC_AT(entry->id[2], l), 0};
  for (int k = 0; k < 3; ++k) {
    const uint32_t other = TC_AT(walk->v[k].id, l);
    if (other != id[0] && other != id[1] && other != id[2])
      id[3] = other;
  }
  if (job->values->association == TETCAST_CORNER)
    tc_sort4(id);
  double position[4][3], value[4], six_volumes;
  for (int k = 0; k < 4; ++k) {
    tc_volume_vertex(job->values->volume, id[k], position[k]);
    value[k] = (job->values->association == TETCAST_CORNER ? tc_rows_value(job->values, passage->cell[l], k)
                                                           : tc_rows_value(job->values, id[k], 0)) /
               job->values->largest;
  }
  tc_cell_gradient(position, value, gradient, &six_volumes);
}

TC_INLINE void tc_meet(TcMeeting *meeting, int l, const double color[3], double opacity) {
  for (int k = 0; k < 3; ++k)
    TC_AT(meeting->color[k], l) = (TcReal)color[k];
  TC_AT(meeting->opacity, l) = (TcReal)opacity;
}

/* Keeps the normal of a surface that lane l meets, given of any length; 0 if it has none. */
static void tc_meet_normal(const TcPacket *walk, int l, const double normal[3], TcMeeting *meeting) {
  double length = 0, along = 0;
  for (int k = 0; k < 3; ++k)
    length += normal[k] * normal[k], along += normal[k] * TC_AT(walk->along[k], l);
  length = along > 0 ? -sqrt(length) : sqrt(length);
  for (int k = 0; k < 3; ++k)
    TC_AT(meeting->normal[k], l) = (TcReal)(length != 0 ? normal[k] / length : 0);
}

/* The shares of light that arrive at `fraction` of the way that lane l went through a cell; NULL: all of it. */
static const double *tc_surface_open(const TcSurfaces *surfaces, const TcPassage *passage, int l, double fraction,
                                     double open[1 + TETCAST_MAX_LIGHTS]) {
  const int width = surfaces->open_width;
  if (!surfaces->open)
    return NULL;
  for (int i = 0; i < width; ++i)
    open[i] = 0;
  for (int k = 0; k < 3; ++k) {
    const float *first = surfaces->open + (size_t)width * TC_AT(passage->entry->id[k], l),
                *last = surfaces->open + (size_t)width * TC_AT(passage->walk->v[k].id, l);
    const double from = (1 - fraction) * (double)TC_AT(passage->entry->barycentric[k], l),
                 to = fraction * (double)TC_AT(passage->walk->at.barycentric[k], l);
    for (int i = 0; i < width; ++i)
      open[i] += from * (double)first[i] + to * (double)last[i];
  }
  return open;
}

/* Light on a surface with this normal, of any length, at `fraction` of the way through a cell; `away` if the normal
 * points away from the eye. */
static void tc_meet_light(const TcGatherJob *job, const TcPassage *passage, int l, double fraction, double normal[3],
                          bool away, double color[3]) {
  double along[3], open[1 + TETCAST_MAX_LIGHTS];
  for (int k = 0; k < 3; ++k) {
    along[k] = TC_AT(passage->walk->along[k], l);
    normal[k] = away ? -normal[k] : normal[k];
  }
  const TcReflection seen = tc_light_reflection(job->surfaces->lighting, along, normal,
                                                tc_surface_open(job->surfaces, passage, l, fraction, open));
  for (int k = 0; k < 3; ++k)
    color[k] = color[k] * seen.factor[k] + seen.highlight[k];
}

/* Lane l meets isosurface `i`, from below if the scalar rises along the ray. */
static void tc_meet_isosurface(const TcGatherJob *job, const TcPassage *passage, int l, int i, bool rises,
                               double fraction, TcMeeting *meeting) {
  const TetcastIsosurface *surface = &job->surfaces->surface[i];
  double color[3] = {surface->color[0], surface->color[1], surface->color[2]}, gradient[3];
  if (passage->partial)
    fraction = (double)TC_AT(passage->from, l) + fraction * (double)(TC_AT(passage->to, l) - TC_AT(passage->from, l));
  if (job->surfaces->lighting || job->surfaces->normal)
    tc_surface_gradient(job, passage, l, fraction, gradient);
  if (job->surfaces->normal)
    tc_meet_normal(passage->walk, l, gradient, meeting);
  if (job->surfaces->lighting)
    tc_meet_light(job, passage, l, fraction, gradient, rises, color);
  tc_meet(meeting, l, color, surface->opacity);
}

/* What the transfer function has at the scalar s in the cell that lane l was in. */
static TcOptics tc_surface_optics(const TcGatherJob *job, const TcPassage *passage, int l, double s) {
  if (!job->second || !job->second->cell)
    return tc_pieces_at(job->pieces, s);
  const double place = job->second->cell[passage->cell[l]];
  return tc_second_at(job->second, job->pieces, isnan(place) ? 0 : place, s);
}

/* Lane l meets a slice where the scalar is s. Of several at one depth one is seen. */
static void tc_meet_slice(const TcGatherJob *job, const TcPassage *passage, const TcLayers *layers, int l, double s,
                          TcMeeting *meeting) {
  int i = 0;
  while (i < job->surfaces->slice_count - 1 && TC_AT(passage->walk->slice[i], l) != TC_AT(layers->slice, l))
    ++i;
  const TcOptics optics = tc_surface_optics(job, passage, l, s);
  if (job->surfaces->normal)
    tc_meet_normal(passage->walk, l, job->surfaces->slice[i].normal, meeting);
  tc_meet(meeting, l, optics.color, job->surfaces->slice_opacity[i]);
}

/* The part of a pixel that the edges of a face cover, about a pixel wide, for a ray along `along` that meets the face
 * at this distance from where it starts, by the ray's distance from the nearest of the three lines. */
static double tc_edge_coverage(const TcSurfaces *surfaces, const double along[3], double distance,
                               const double position[3][3], const double barycentric[3]) {
  double beside[3][3], nearest = INFINITY;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      beside[i][k] = 0; /* from the hit to the vertex */
      for (int j = 0; j < 3; ++j)
        beside[i][k] += barycentric[j] * (position[i][k] - position[j][k]);
    }
    const double away = tc_dot(beside[i], along);
    for (int k = 0; k < 3; ++k)
      beside[i][k] -= away * along[k];
  }
  for (int i = 0; i < 3; ++i) {
    const double *a = beside[i], *b = beside[(i + 1) % 3], edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double area[3];
    tc_cross(a, b, area);
    const double length = sqrt(tc_dot(edge, edge));
    nearest = fmin(nearest, length > 0 ? sqrt(tc_dot(area, area)) / length : sqrt(tc_dot(a, a)));
  }
  const TcView *view = surfaces->view;
  const double size = surfaces->pixel * (view->orthographic ? 1 : distance * tc_dot(along, view->forward));
  return nearest < size ? 1 - nearest / size : 0;
}

/* Lane l meets the boundary where the scalar is s, at the face where it enters a cell or at the one where it leaves it.
 */
static void tc_meet_boundary(const TcGatherJob *job, const TcPassage *passage, int l, bool enter, double s,
                             TcMeeting *meeting) {
  const TetcastBoundary *boundary = &job->surfaces->boundary;
  double color[3], position[3][3], edge[2][3], normal[3];
  const TcOptics optics = tc_surface_optics(job, passage, l, s);
  memcpy(color, boundary->colored ? boundary->color : optics.color, sizeof color);
  if (job->surfaces->lighting || job->surfaces->normal || boundary->edges) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t id = enter ? TC_AT(passage->entry->id[k], l) : TC_AT(passage->walk->v[k].id, l);
      tc_volume_vertex(job->values->volume, id, position[k]);
    }
    for (int k = 0; k < 3; ++k)
      edge[0][k] = position[1][k] - position[0][k], edge[1][k] = position[2][k] - position[0][k];
    tc_cross(edge[0], edge[1], normal);
    if (job->surfaces->normal)
      tc_meet_normal(passage->walk, l, normal, meeting);
  }
  if (job->surfaces->lighting) {
    double toward = 0;
    for (int k = 0; k < 3; ++k)
      toward -= normal[k] * TC_AT(passage->walk->along[k], l);
    tc_meet_light(job, passage, l, enter ? 0 : 1, normal, toward < 0, color);
  }
  if (boundary->edges) {
    const TcPacket *walk = passage->walk;
    const TcVec *weight = enter ? passage->entry->barycentric : walk->at.barycentric;
    const double along[3] = {TC_AT(walk->along[0], l), TC_AT(walk->along[1], l), TC_AT(walk->along[2], l)},
                 barycentric[3] = {(double)TC_AT(weight[0], l), (double)TC_AT(weight[1], l),
                                   (double)TC_AT(weight[2], l)},
                 depth = (double)(enter ? TC_AT(passage->entry->z, l) : TC_AT(walk->at.z, l));
    const double coverage = tc_edge_coverage(job->surfaces, along, depth + TC_AT(walk->start, l),
                                             (const double(*)[3])position, barycentric);
    for (int k = 0; k < 3; ++k)
      color[k] += coverage * (boundary->edge_color[k] - color[k]);
  }
  tc_meet(meeting, l, color, boundary->opacity);
}

#endif
