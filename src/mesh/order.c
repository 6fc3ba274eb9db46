/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/order.h"

#include <math.h>
#include <string.h>

#include "base/parallel.h"

/* ── radix sort, least significant digit first ── */

enum { DIGIT_BITS = 11, BLOCK = 1 << 15, MOST_BLOCKS = 256, GRAIN = 1 << 14 };

typedef struct Sort {
  const uint64_t *from;
  uint64_t *to;
  int64_t count, block;
  int shift, digits;   /* the digit of this pass: its place in the record, how many values it has */
  uint32_t *histogram; /* [blocks][digits]: how many, then where the next goes */
} Sort;

static uint32_t *histogram_of(const Sort *sort, int64_t block) {
  return sort->histogram + block * sort->digits;
}

static bool count_digits(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Sort *sort = data;
  for (int64_t block = begin; block < end; ++block) {
    uint32_t *histogram = histogram_of(sort, block);
    memset(histogram, 0, (size_t)sort->digits * sizeof *histogram);
    const int64_t first = block * sort->block,
                  last = first + sort->block < sort->count ? first + sort->block : sort->count;
    for (int64_t i = first; i < last; ++i)
      ++histogram[(sort->from[i] >> sort->shift) & (uint64_t)(sort->digits - 1)];
  }
  return true;
}

static bool move_records(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const Sort *sort = data;
  for (int64_t block = begin; block < end; ++block) {
    uint32_t *next = histogram_of(sort, block);
    const int64_t first = block * sort->block,
                  last = first + sort->block < sort->count ? first + sort->block : sort->count;
    for (int64_t i = first; i < last; ++i) {
      sort->to[next[(sort->from[i] >> sort->shift) & (uint64_t)(sort->digits - 1)]++] = sort->from[i];
    }
  }
  return true;
}

/* Digit by digit over all blocks: where each block's records with that digit begin. */
static void accumulate(Sort *sort, int64_t blocks) {
  uint32_t sum = 0;
  for (int digit = 0; digit < sort->digits; ++digit) {
    for (int64_t block = 0; block < blocks; ++block) {
      uint32_t *entry = histogram_of(sort, block) + digit;
      const uint32_t count = *entry;
      *entry = sum;
      sum += count;
    }
  }
}

TetcastStatus tc_sort_records(TetcastContext *context, uint64_t **records, uint64_t **scratch, int64_t count,
                              uint32_t largest) {
  int bits = 0;
  while (bits < 32 && largest >> bits)
    ++bits;
  if (bits == 0 || count < 2)
    return TETCAST_OK;
  const int passes = (bits + DIGIT_BITS - 1) / DIGIT_BITS, width = (bits + passes - 1) / passes;
  Sort sort = {.count = count, .block = BLOCK, .digits = 1 << width};
  if (sort.block * MOST_BLOCKS < count)
    sort.block = (count + MOST_BLOCKS - 1) / MOST_BLOCKS;
  const int64_t blocks = (count + sort.block - 1) / sort.block;
  if (!tc_allocate_array(context, (void **)&sort.histogram, blocks * sort.digits, sizeof *sort.histogram, "sorting")) {
    return TETCAST_ERROR_MEMORY;
  }
  for (int pass = 0; pass < passes; ++pass) {
    sort.from = *records;
    sort.to = *scratch;
    sort.shift = 32 + pass * width;
    tc_parallel_for(context, blocks, 1, count_digits, &sort, NULL);
    accumulate(&sort, blocks);
    tc_parallel_for(context, blocks, 1, move_records, &sort, NULL);
    uint64_t *sorted = *scratch;
    *scratch = *records;
    *records = sorted;
  }
  tc_release(context, sort.histogram);
  return TETCAST_OK;
}

int64_t tc_find_record(const uint64_t *records, int64_t count, uint32_t key) {
  int64_t low = 0;
  while (low < count) {
    const int64_t middle = low + (count - low) / 2;
    if (tc_record_key(records[middle]) < key)
      low = middle + 1;
    else
      count = middle;
  }
  return low;
}

/* ── Hilbert's curve ── */

enum { CURVE_BITS = 20, HALF_BITS = CURVE_BITS * 3 / 2, STATES = 24 };

/* The curve passes the eight parts of a cube in the order of a Gray code that is mirrored and turned. A state is the
 * corner where it comes in and the axis along which it goes on: for a part, its place in the order and the state inside
 * it (Hamilton, Compact Hilbert indices, 2006). */
typedef struct Curve {
  unsigned char place[STATES][8], next[STATES][8];
} Curve;

static unsigned turn_left(unsigned bits, unsigned by) {
  return (bits << by % 3 | bits >> (3 - by % 3)) & 7;
}

static unsigned trailing_ones(unsigned bits) {
  return bits & 1 ? 1 + trailing_ones(bits >> 1) : 0;
}

static void make_curve(Curve *curve) {
  for (unsigned entry = 0; entry < 8; ++entry) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned w = 0; w < 8; ++w) {
        const unsigned part = turn_left(w ^ w >> 1, axis + 1) ^ entry;
        const unsigned even = w ? (w - 1) / 2 * 2 : 0; /* where the curve inside part w comes in and what way it goes */
        const unsigned way = w == 0 ? 0 : trailing_ones(w & 1 ? w : w - 1) % 3;
        const unsigned inner_entry = entry ^ turn_left(even ^ even >> 1, axis + 1), inner_axis = (axis + way + 1) % 3;
        curve->place[entry * 3 + axis][part] = (unsigned char)w;
        curve->next[entry * 3 + axis][part] = (unsigned char)(inner_entry * 3 + inner_axis);
      }
    }
  }
}

static uint64_t follow(const Curve *curve, const uint32_t at[3]) {
  uint64_t index = 0;
  unsigned state = 0;
  for (int bit = CURVE_BITS - 1; bit >= 0; --bit) {
    const unsigned part = (at[0] >> bit & 1) | (at[1] >> bit & 1) << 1 | (at[2] >> bit & 1) << 2;
    index = index << 3 | curve->place[state][part];
    state = curve->next[state][part];
  }
  return index;
}

uint64_t tc_hilbert_index(const uint32_t at[3]) {
  Curve curve;
  make_curve(&curve);
  return follow(&curve, at);
}

/* ── vertices along it ── */

typedef struct Order {
  const TetcastMesh *mesh;
  Curve curve;
  double low[3], size; /* halved, so that no difference overflows */
  uint64_t *keys, *records, *scratch;
  uint32_t *order;
} Order;

static bool find_places(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Order *order = data;
  for (int64_t i = begin; i < end; ++i) {
    double p[3];
    uint32_t at[3];
    tc_mesh_vertex(order->mesh, i, p);
    for (int k = 0; k < 3; ++k) { /* vertices that no cell uses may be anywhere; nothing has a size: NaN */
      const double place = (0.5 * p[k] - order->low[k]) / order->size;
      at[k] = place >= 1 ? (1 << CURVE_BITS) - 1 : place > 0 ? (uint32_t)(place * (1 << CURVE_BITS)) : 0;
    }
    order->keys[i] = follow(&order->curve, at);
    order->records[i] = tc_record((uint32_t)(order->keys[i] & ((1u << HALF_BITS) - 1)), (uint32_t)i);
  }
  return true;
}

static bool take_upper_halves(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Order *order = data;
  for (int64_t i = begin; i < end; ++i) {
    const uint32_t vertex = tc_record_value(order->records[i]);
    order->records[i] = tc_record((uint32_t)(order->keys[vertex] >> HALF_BITS), vertex);
  }
  return true;
}

static bool take_values(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Order *order = data;
  for (int64_t i = begin; i < end; ++i)
    order->order[i] = tc_record_value(order->records[i]);
  return true;
}

static TetcastStatus run(TetcastContext *context, Order *order, int64_t count) {
  if (!tc_allocate_array(context, (void **)&order->keys, count, sizeof *order->keys, "vertex order") ||
      !tc_allocate_array(context, (void **)&order->records, count, sizeof *order->records, "vertex order") ||
      !tc_allocate_array(context, (void **)&order->scratch, count, sizeof *order->scratch, "vertex order") ||
      !tc_allocate_array(context, (void **)&order->order, count, sizeof *order->order, "vertex order")) {
    return TETCAST_ERROR_MEMORY;
  }
  const uint32_t largest = (1u << HALF_BITS) - 1;
  tc_parallel_for(context, count, GRAIN, find_places, order, NULL);
  TetcastStatus status = tc_sort_records(context, &order->records, &order->scratch, count, largest);
  if (status)
    return status;
  tc_parallel_for(context, count, GRAIN, take_upper_halves, order, NULL);
  status = tc_sort_records(context, &order->records, &order->scratch, count, largest);
  if (status)
    return status;
  tc_parallel_for(context, count, GRAIN, take_values, order, NULL);
  return TETCAST_OK;
}

TetcastStatus tc_order_vertices(const TetcastMesh *mesh, uint32_t **out) {
  TetcastContext *context = mesh->context;
  Order order = {.mesh = mesh};
  make_curve(&order.curve);
  for (int k = 0; k < 3; ++k) {
    order.low[k] = 0.5 * mesh->bounds[2 * k];
    order.size = fmax(order.size, 0.5 * mesh->bounds[2 * k + 1] - order.low[k]);
  }
  const TetcastStatus status = run(context, &order, mesh->vertices.count);
  tc_release(context, order.keys);
  tc_release(context, order.records);
  tc_release(context, order.scratch);
  if (status)
    tc_release(context, order.order);
  else
    *out = order.order;
  return status;
}
