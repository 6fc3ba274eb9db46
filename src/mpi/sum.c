/* SPDX-License-Identifier: Apache-2.0 */
/* Sums with the same bits in whatever order they are added up: of integers.
 *
 * With 2^E above the largest magnitude of all numbers that are added, each of them is cut into digits of 40 bits: of
 * 2^(E−40), 2^(E−80) and 2^(E−120). What lies below is dropped, from each number by itself, whatever the others are.
 * Digits are added up as integers of 64 bits, which 2^22 of them don't overflow. A double has 53 bits, so that numbers
 * above 2^(E−67) lose nothing, and the others less than 2^−120 of the largest. */
#include <fenv.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "communicator.h"

enum { DIGIT = 40, DIGITS = 3, AT_A_TIME = 4096, NO_VALUE = -1000000, NOT_FINITE = 1000000 };

static const int64_t most_parts = INT64_C(1) << 22;

/* So many sums are made at a time. */
typedef struct Sums {
  int largest[AT_A_TIME];            /* E of each */
  int of_all[AT_A_TIME];             /* that of all ranks */
  int64_t digits[AT_A_TIME][DIGITS]; /* of what is not finite, how often there is NaN, ∞, −∞ */
  int64_t of_ranks[AT_A_TIME][DIGITS];
} Sums;

static int exponent_of(double x) {
  int exponent;
  if (!isfinite(x))
    return NOT_FINITE;
  if (x == 0)
    return NO_VALUE;
  frexp(x, &exponent);
  return exponent;
}

/* Adds a number to the digits, of which the first begins at 2^largest. All operations are exact, but the first where
 * it drops what is below all digits. */
static void add(double x, int largest, int64_t digits[DIGITS]) {
  if (largest == NO_VALUE)
    return;
  if (largest == NOT_FINITE) {
    if (!isfinite(x))
      ++digits[isnan(x) ? 0 : x > 0 ? 1 : 2];
    return;
  }
  double rest = ldexp(x, -largest);
  for (int k = 0; k < DIGITS; ++k) {
    rest *= 0x1p40;
    const double digit = trunc(rest);
    digits[k] += (int64_t)digit;
    rest -= digit;
  }
}

/* Moves what a digit has beyond its bits to the one before it. Bits are counted towards −∞, so that all digits but the
 * first come to lie in [0, 2^40). */
static void carry(int64_t digits[DIGITS]) {
  for (int k = DIGITS - 1; k > 0; --k) {
    const int64_t low = (int64_t)((uint64_t)digits[k] & ((UINT64_C(1) << DIGIT) - 1));
    digits[k - 1] += (digits[k] - low) / (INT64_C(1) << DIGIT);
    digits[k] = low;
  }
}

/* All terms have one sign, so that nothing cancels; the last two additions and ldexp() may round. */
static double number_of(int64_t digits[DIGITS], int largest) {
  if (largest == NO_VALUE)
    return 0;
  if (largest == NOT_FINITE)
    return digits[0] || (digits[1] && digits[2]) ? (double)NAN : digits[1] ? (double)INFINITY : -(double)INFINITY;
  carry(digits);
  const bool negative = digits[0] < 0;
  if (negative) {
    for (int k = 0; k < DIGITS; ++k)
      digits[k] = -digits[k];
    carry(digits);
  }
  const int64_t low = digits[0] & ((INT64_C(1) << DIGIT) - 1);
  const double high = (double)(digits[0] - low) * 0x1p40, middle = (double)low * 0x1p40 + (double)digits[1];
  const double sum = high + (middle + (double)digits[2] * 0x1p-40);
  return ldexp(negative ? -sum : sum, largest - 2 * DIGIT);
}

/* Adds up values[parts][stride], of which `count` follow each other. */
static TetcastStatus sum_some(TetcastMpi *mpi, const double *values, int64_t parts, int64_t stride, int count,
                              Sums *sums, double *result) {
  memset(sums->digits, 0, sizeof sums->digits);
  for (int i = 0; i < count; ++i) {
    sums->largest[i] = NO_VALUE;
    for (int64_t p = 0; p < parts; ++p) {
      const int exponent = exponent_of(values[p * stride + i]);
      sums->largest[i] = exponent > sums->largest[i] ? exponent : sums->largest[i];
    }
  }
  TetcastStatus status = tc_mpi_check(
      mpi, MPI_Allreduce(sums->largest, sums->of_all, count, MPI_INT, MPI_MAX, mpi->comm), "MPI_Allreduce");
  if (status)
    return status;
  for (int i = 0; i < count; ++i) {
    for (int64_t p = 0; p < parts; ++p)
      add(values[p * stride + i], sums->of_all[i], sums->digits[i]);
  }
  status =
      tc_mpi_check(mpi, MPI_Allreduce(sums->digits, sums->of_ranks, count * DIGITS, MPI_INT64_T, MPI_SUM, mpi->comm),
                   "MPI_Allreduce");
  for (int i = 0; !status && i < count; ++i)
    result[i] = number_of(sums->of_ranks[i], sums->of_all[i]);
  return status;
}

static TetcastStatus check_sum(TetcastMpi *mpi, const double *values, int64_t parts, int64_t count,
                               const double *sums) {
  if (parts < 0 || count < 0)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%" PRId64 " parts of %" PRId64 " values", parts,
                                 count);
  if ((parts > 0 && count > 0 && !values) || (count > 0 && !sums))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "%s is NULL", sums ? "values" : "sums");
  if (parts > most_parts)
    return tetcast_context_error(mpi->context, TETCAST_ERROR_LIMIT,
                                 "sums of %" PRId64 " parts, at most %" PRId64 " are possible", parts, most_parts);
  return TETCAST_OK;
}

static TetcastStatus sum(TetcastMpi *mpi, const double *values, int64_t parts, int64_t count, double *result) {
  int64_t same[2] = {count, -count}, all = 0;
  Sums *sums = NULL;
  TetcastStatus status = check_sum(mpi, values, parts, count, result);
  if (!status && !(sums = malloc(sizeof *sums)))
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: sums", mpi->rank);
  status = tc_mpi_agree(mpi, status, same, 2);
  if (!status && same[0] != -same[1])
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                   "sums of %" PRId64 " and of %" PRId64 " values: ranks differ", -same[1], same[0]);
  if (!status)
    status = tc_mpi_check(mpi, MPI_Allreduce(&parts, &all, 1, MPI_INT64_T, MPI_SUM, mpi->comm), "MPI_Allreduce");
  if (!status && all > most_parts)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_LIMIT,
                                   "sums of %" PRId64 " parts, at most %" PRId64 " are possible", all, most_parts);
  for (int64_t first = 0; !status && first < count; first += AT_A_TIME) {
    const int some = (int)(count - first < AT_A_TIME ? count - first : AT_A_TIME);
    status = sum_some(mpi, parts ? values + first : NULL, parts, count, some, sums, result + first);
  }
  free(sums);
  return status;
}

/* In the default environment of floating point, whatever the host's is. */
TetcastStatus tetcast_mpi_sum(TetcastMpi *mpi, const double *values, int64_t parts, int64_t count, double *sums) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  fenv_t environment;
  fegetenv(&environment);
  fesetenv(FE_DFL_ENV);
  const TetcastStatus status = sum(mpi, values, parts, count, sums);
  fesetenv(&environment);
  return status;
}

/* ── statistics ── */

/* What all parts must have in common. */
typedef struct Shape {
  double range[2], gradient_range[2];
  int bins, gradient_bins;
} Shape;

static Shape shape_of(const TetcastStatistics *s) {
  Shape shape;
  memset(&shape, 0, sizeof shape);
  memcpy(shape.range, s->range, sizeof shape.range);
  shape.bins = s->bins;
  shape.gradient_bins = s->gradient_bins;
  if (s->gradient_bins)
    memcpy(shape.gradient_range, s->gradient_range, sizeof shape.gradient_range);
  return shape;
}

static bool is_same(const Shape *a, const Shape *b) {
  return a->range[0] == b->range[0] && a->range[1] == b->range[1] && a->bins == b->bins &&
         a->gradient_bins == b->gradient_bins && a->gradient_range[0] == b->gradient_range[0] &&
         a->gradient_range[1] == b->gradient_range[1];
}

static int64_t size_of(const Shape *shape) {
  const int64_t bins = shape->bins;
  return 4 + bins + 2 * (bins + 1) + bins * shape->gradient_bins;
}

/* The places of all numbers, one behind the other; returns how many arrays there are. */
static int arrays_of(TetcastStatistics *s, double *arrays[8], int64_t counts[8]) {
  double *single[4] = {&s->total, &s->unknown, &s->below, &s->above};
  for (int i = 0; i < 4; ++i)
    arrays[i] = single[i], counts[i] = 1;
  arrays[4] = s->volume, counts[4] = s->bins;
  arrays[5] = s->area, counts[5] = (int64_t)s->bins + 1;
  arrays[6] = s->gradient, counts[6] = (int64_t)s->bins + 1;
  arrays[7] = s->joint, counts[7] = (int64_t)s->bins * s->gradient_bins;
  return s->joint ? 8 : 7;
}

static void copy_numbers(const TetcastStatistics *from, double *to) {
  double *arrays[8];
  int64_t counts[8];
  TetcastStatistics copy = *from;
  const int count = arrays_of(&copy, arrays, counts);
  for (int i = 0; i < count; to += counts[i++])
    memcpy(to, arrays[i], (size_t)counts[i] * sizeof *to);
}

static void set_numbers(const double *from, TetcastStatistics *to) {
  double *arrays[8];
  int64_t counts[8];
  const int count = arrays_of(to, arrays, counts);
  for (int i = 0; i < count; from += counts[i++])
    memcpy(arrays[i], from, (size_t)counts[i] * sizeof *from);
}

/* Statistics of nothing: those of a mesh without cells. */
static TetcastStatus create_empty(TetcastContext *context, const Shape *shape, TetcastStatistics **statistics) {
  static const double nothing[3];
  static const int32_t none[4];
  TetcastMeshDesc mesh_desc = tetcast_mesh_desc_default();
  TetcastFieldDesc field_desc = tetcast_field_desc_default();
  TetcastStatisticsDesc desc = tetcast_statistics_desc_default();
  mesh_desc.vertices = (TetcastArray){nothing, TETCAST_TYPE_FLOAT64, 0, 0};
  mesh_desc.tetrahedra = (TetcastArray){none, TETCAST_TYPE_INT32, 0, 0};
  field_desc.values = (TetcastArray){nothing, TETCAST_TYPE_FLOAT64, 0, 0};
  memcpy(desc.range, shape->range, sizeof desc.range);
  memcpy(desc.gradient_range, shape->gradient_range, sizeof desc.gradient_range);
  desc.bins = shape->bins;
  desc.gradient_bins = shape->gradient_bins;
  TetcastMesh *mesh = NULL;
  TetcastField *field = NULL;
  TetcastStatus status = tetcast_mesh_create(context, &mesh_desc, &mesh);
  if (!status)
    status = tetcast_field_create(context, &field_desc, &field);
  if (!status)
    status = tetcast_statistics_create(context, mesh, field, &desc, statistics);
  tetcast_field_destroy(&field);
  tetcast_mesh_destroy(&mesh);
  return status;
}

static TetcastStatus check_parts(TetcastMpi *mpi, const TetcastStatistics *const *parts, int64_t count,
                                 TetcastStatistics **whole) {
  if (!whole || count < 0 || (count > 0 && !parts))
    return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "statistics of %" PRId64 " parts, or NULL",
                                 count);
  for (int64_t i = 0; i < count; ++i) {
    if (!parts[i])
      return tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "statistics of part %" PRId64 " are NULL", i);
  }
  return TETCAST_OK;
}

/* Brings the shape of the first part of the lowest rank that has one to all, who compare theirs with it. */
static TetcastStatus share_shape(TetcastMpi *mpi, const TetcastStatistics *const *parts, int64_t count, Shape *shape) {
  int64_t from = count > 0 ? mpi->size - mpi->rank : 0;
  TetcastStatus status = tc_mpi_agree(mpi, TETCAST_OK, &from, 1);
  if (!status && from == 0)
    status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT, "no rank has statistics");
  if (status)
    return status;
  if (mpi->size - from == mpi->rank)
    *shape = shape_of(parts[0]);
  status = tc_mpi_broadcast(mpi, mpi->size - (int)from, shape, sizeof *shape);
  for (int64_t i = 0; !status && i < count; ++i) {
    const Shape own = shape_of(parts[i]);
    if (!is_same(&own, shape))
      status = tetcast_context_error(mpi->context, TETCAST_ERROR_ARGUMENT,
                                     "statistics of part %" PRId64 " of rank %d are of %d bins from %g to %g, "
                                     "those of others of %d from %g to %g, or of other gradients",
                                     i, mpi->rank, own.bins, own.range[0], own.range[1], shape->bins, shape->range[0],
                                     shape->range[1]);
  }
  return tc_mpi_agree(mpi, status, NULL, 0);
}

TetcastStatus tetcast_mpi_statistics(TetcastMpi *mpi, const TetcastStatistics *const *parts, int64_t count,
                                     TetcastStatistics **whole) {
  if (!mpi)
    return TETCAST_ERROR_ARGUMENT;
  if (whole)
    *whole = NULL;
  Shape shape;
  TetcastStatus status = tc_mpi_agree(mpi, check_parts(mpi, parts, count, whole), NULL, 0);
  if (!status)
    status = share_shape(mpi, parts, count, &shape);
  if (status)
    return status;
  const int64_t size = size_of(&shape);
  double *numbers = count < INT64_MAX / 64 / size ? malloc((size_t)((count + 1) * size) * sizeof *numbers) : NULL;
  TetcastStatistics *made = NULL;
  status = numbers ? create_empty(mpi->context, &shape, &made)
                   : tetcast_context_error(mpi->context, TETCAST_ERROR_MEMORY, "rank %d: out of memory: statistics",
                                           mpi->rank);
  status = tc_mpi_agree(mpi, status, NULL, 0);
  for (int64_t i = 0; !status && i < count; ++i)
    copy_numbers(parts[i], numbers + (i + 1) * size);
  if (!status)
    status = tetcast_mpi_sum(mpi, numbers + size, count, size, numbers);
  if (!status)
    set_numbers(numbers, made);
  else
    tetcast_statistics_destroy(mpi->context, &made);
  free(numbers);
  *whole = made;
  return status;
}
