/* SPDX-License-Identifier: Apache-2.0 */
#include "optics/sampled.h"

#include <math.h>
#include <string.h>

#include "optics/segment.h"

/* ── making ── */

/* Nodes and weights of n-point Gauss–Legendre quadrature on [0, 1]: Newton's method on the Legendre polynomial. */
static void gauss_legendre(TcSampler *sampler) {
  const int n = sampler->n;
  for (int i = 0; i < n; ++i) {
    double x = cos(acos(-1) * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double change = p1 / slope;
      x -= change;
      if (fabs(change) < 1e-16)
        break;
    }
    sampler->nodes[n - 1 - i] = 0.5 * (1 + x);
    sampler->weights[n - 1 - i] = 1 / ((1 - x * x) * slope * slope);
  }
  if (n == 1) {
    sampler->nodes[0] = 0.5;
    sampler->weights[0] = 1;
  }
  /* The inner integral of a Lagrange polynomial, of degree n − 1, is exact with the same rule scaled to [0, node]. */
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      double sum = 0;
      for (int q = 0; q < n; ++q) {
        const double u = sampler->nodes[i] * sampler->nodes[q];
        double value = 1;
        for (int m = 0; m < n; ++m) {
          if (m != j)
            value *= (u - sampler->nodes[m]) / (sampler->nodes[j] - sampler->nodes[m]);
        }
        sum += sampler->weights[q] * value;
      }
      sampler->inner[i][j] = sampler->nodes[i] * sum;
    }
  }
}

/* Ψ over γ = a / (1 + a) and γ₁ = a₁ / (1 + a₁), each in [0, 1) (Moreland & Angel 2004). */
static void psi_table(TcSampler *sampler) {
  const int n = sampler->n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = (double)i / (n - 1), y = (double)j / (n - 1);
      const TcSegment s = tc_segment(x < 1 ? x / (1 - x) : 1e300, y < 1 ? y / (1 - y) : 1e300);
      sampler->table[i * n + j] = s.w1 + s.transmittance;
    }
  }
}

TetcastStatus tc_sampler_create(TetcastContext *context, TetcastIntegrator integrator, int n, TcSampler **out) {
  TcSampler *sampler;
  if (!tc_allocate_array(context, (void **)&sampler, 1, sizeof *sampler, "integrator"))
    return TETCAST_ERROR_MEMORY;
  memset(sampler, 0, sizeof *sampler);
  sampler->context = context;
  sampler->integrator = integrator;
  sampler->n = n;
  if (integrator == TETCAST_INTEGRATOR_GAUSS)
    gauss_legendre(sampler);
  if (integrator == TETCAST_INTEGRATOR_TABLE) {
    if (!tc_allocate_array(context, (void **)&sampler->table, (int64_t)n * n, sizeof(double),
                           "table of an integrator")) {
      tc_sampler_destroy(sampler);
      return TETCAST_ERROR_MEMORY;
    }
    psi_table(sampler);
  }
  *out = sampler;
  return TETCAST_OK;
}

void tc_sampler_destroy(TcSampler *sampler) {
  if (!sampler)
    return;
  tc_release(sampler->context, sampler->table);
  tc_release(sampler->context, sampler);
}

/* ── light ── */

enum { BLOCK = 64 };

static void end_block(TcLight *light) {
  for (int k = 0; k < 3; ++k) {
    light->color[k] += light->transmittance * light->block_color[k];
    light->block_color[k] = 0;
  }
  light->depth += light->block_depth;
  light->transmittance = exp(-light->depth);
  light->block_depth = 0;
  light->block_transmittance = 1;
  light->block_length = 0;
}

bool tc_light_opaque(const TcLight *light, const TcPieces *pieces) {
  if (light->depth + light->block_depth <= TC_NEARLY_OPAQUE)
    return false;
  const double left = light->transmittance * light->block_transmittance;
  for (int k = 0; k < 3; ++k) {
    const double color = light->color[k] + light->transmittance * light->block_color[k];
    if (left * pieces->largest[k] > 0x1p-54 * color)
      return false;
  }
  return true;
}

void tc_light_end(TcLight *light, double rgba[4]) {
  end_block(light);
  for (int k = 0; k < 3; ++k)
    rgba[k] = light->color[k];
  rgba[3] = -expm1(-light->depth);
}

/* ── one segment ── */

/* A colour already weighted with the segment's own transmittance, and its depth. */
static void add(TcLight *light, const double emitted[3], double depth) {
  for (int k = 0; k < 3; ++k)
    light->block_color[k] += light->block_transmittance * emitted[k];
  light->block_transmittance *= exp(-depth);
  light->block_depth += depth;
  if (++light->block_length == BLOCK)
    end_block(light);
}

static void add_constant(TcLight *light, const TcOptics *o, double length) {
  const double depth = o->extinction * length, alpha = -expm1(-depth);
  add(light, (double[3]){alpha * o->color[0], alpha * o->color[1], alpha * o->color[2]}, depth);
}

void tc_light_add_constant(TcLight *light, const TcPieces *pieces, double length, double s) {
  const TcOptics o = tc_pieces_at(pieces, s);
  add_constant(light, &o, length);
}

/* Depth and colour by the trapezoidal rule, emission as if both were constant at these. */
static void add_trapezoid(TcLight *light, const TcPieces *pieces, double length, double s0, double s1) {
  const TcOptics a = tc_pieces_at(pieces, s0), b = tc_pieces_at(pieces, s1);
  const double depth = 0.5 * (a.extinction + b.extinction) * length, alpha = -0.5 * expm1(-depth);
  add(light,
      (double[3]){alpha * (a.color[0] + b.color[0]), alpha * (a.color[1] + b.color[1]),
                  alpha * (a.color[2] + b.color[2])},
      depth);
}

/* ∫ c κ e^−τ at n nodes, with τ at a node from the polynomial through κ at all nodes: Gauss collocation, of order 2n.
 */
static void add_gauss(TcLight *light, const TcPieces *pieces, const TcSampler *sampler, double length, double s0,
                      double s1) {
  const int n = sampler->n;
  TcOptics o[TETCAST_MAX_GAUSS];
  double depth = 0, emitted[3] = {0, 0, 0};
  for (int i = 0; i < n; ++i) {
    o[i] = tc_pieces_at(pieces, s0 + (s1 - s0) * sampler->nodes[i]);
    o[i].extinction = fmin(o[i].extinction, TC_LARGEST_COLOR); /* times a colour it must not overflow */
    depth += sampler->weights[i] * o[i].extinction * length;
  }
  for (int i = 0; i < n; ++i) {
    double inner = 0;
    for (int j = 0; j < n; ++j)
      inner += sampler->inner[i][j] * o[j].extinction * length;
    const double weight =
        sampler->weights[i] * o[i].extinction * length * exp(-fmax(inner, 0)); /* a polynomial may undershoot */
    for (int k = 0; k < 3; ++k)
      emitted[k] += weight * o[i].color[k];
  }
  add(light, emitted, depth);
}

/* Bilinear in the table. */
static double psi_from_table(const TcSampler *sampler, double a, double a1) {
  const int n = sampler->n;
  const double x = a / (1 + a) * (n - 1), y = a1 / (1 + a1) * (n - 1);
  const int i = x < n - 2 ? (int)x : n - 2, j = y < n - 2 ? (int)y : n - 2;
  const double u = x - i, v = y - j, *t = &sampler->table[i * n + j];
  return (1 - u) * ((1 - v) * t[0] + v * t[1]) + u * ((1 - v) * t[n] + v * t[n + 1]);
}

/* The closed form with a tabulated Ψ, on one linear piece. */
static void add_table_part(TcLight *light, const TcSampler *sampler, const TcPiece *piece, double length, double s0,
                           double s1) {
  const TcOptics near = tc_piece_at(piece, s0), far = tc_piece_at(piece, s1);
  const double a = fmin(near.extinction * length, 1e300), a1 = fmin(far.extinction * length, 1e300),
               depth = 0.5 * a + 0.5 * a1;
  const double psi = psi_from_table(sampler, a, a1), transmittance = exp(-depth);
  double emitted[3];
  for (int k = 0; k < 3; ++k)
    emitted[k] = near.color[k] - far.color[k] * transmittance + (far.color[k] - near.color[k]) * psi;
  add(light, emitted, depth);
}

/* Cut at the knots. The lengths of parts come from differences of scalars, not of positions along the segment: nothing
 * cancels. */
static void add_table(TcLight *light, const TcPieces *pieces, const TcSampler *sampler, double length, double s0,
                      double s1) {
  const double whole = fabs(s1 - s0);
  const int step = s0 <= s1 ? 1 : -1;
  const TcPiece *piece = &pieces->pieces[s0 <= s1 ? tc_piece_above(pieces, s0) : tc_piece_below(pieces, s0)];
  if (s0 == s1) {
    add_table_part(light, sampler, piece, length, s0, s1);
    return;
  }
  for (; s0 != s1; piece += step) {
    const double end = step > 0 ? fmin(piece->high, s1) : fmax(piece->low, s1);
    add_table_part(light, sampler, piece, length * (fabs(end - s0) / whole), s0, end);
    s0 = end;
  }
}

void tc_light_add_sampled(TcLight *light, const TcPieces *pieces, const TcSampler *sampler, double length, double s0,
                          double s1) {
  const int n = sampler->n;
  switch (sampler->integrator) {
  case TETCAST_INTEGRATOR_MIDPOINT:
    for (int i = 0; i < n; ++i)
      tc_light_add_constant(light, pieces, length / n, s0 + (s1 - s0) * ((i + 0.5) / n));
    break;
  case TETCAST_INTEGRATOR_TRAPEZOID:
    for (int i = 0; i < n; ++i) {
      add_trapezoid(light, pieces, length / n, s0 + (s1 - s0) * ((double)i / n), s0 + (s1 - s0) * ((i + 1.0) / n));
    }
    break;
  case TETCAST_INTEGRATOR_GAUSS:
    add_gauss(light, pieces, sampler, length, s0, s1);
    break;
  case TETCAST_INTEGRATOR_TABLE:
    add_table(light, pieces, sampler, length, s0, s1);
    break;
  case TETCAST_INTEGRATOR_EXACT:
    break; /* by the kernels themselves */
  }
}
