/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices that cutting adds, each a linear combination of vertices there were. */
#include <string.h>

#include "mesh/cut.h"

/* Moves `used` things of `size` bytes to room for `count`. */
static bool move(TetcastContext *context, void **array, int64_t used, int64_t count, size_t size) {
  void *larger;
  if (!tc_allocate_array(context, &larger, count, size, "added vertices"))
    return false;
  if (*array && used)
    memcpy(larger, *array, (size_t)used * size);
  tc_release(context, *array);
  *array = larger;
  return true;
}

bool tc_cut_points_reserve(TcCutPoints *points, int64_t count, int64_t entries) {
  TetcastContext *context = points->context;
  if (count > points->point_room || !points->start) {
    const bool first = !points->start;
    if (!move(context, (void **)&points->start, points->count + 1, count + 1, sizeof *points->start))
      return false;
    if (first)
      points->start[0] = 0;
    points->point_room = count;
  }
  if (entries > points->entry_room || !points->source) {
    if (!move(context, (void **)&points->source, points->entries, entries, sizeof *points->source) ||
        !move(context, (void **)&points->weight, points->entries, entries, sizeof *points->weight)) {
      return false;
    }
    points->entry_room = entries;
  }
  return true;
}

static uint64_t hash(const TcPointKey *key) {
  uint64_t h = 0;
  for (int k = 0; k < 4; ++k) {
    h = (h ^ key->vertex[k] ^ (uint64_t)key->share[k] << 32) * UINT64_C(0x9e3779b97f4a7c15);
    h ^= h >> 29;
  }
  return h;
}

/* The key's slot, or the free one where it belongs. */
static uint32_t *slot_of(const TcCutPoints *points, const TcPointKey *key) {
  const uint64_t mask = (uint64_t)points->slots - 1;
  uint64_t at = hash(key) & mask;
  while (points->slot[at] && memcmp(&points->key[points->slot[at] - 1], key, sizeof *key) != 0)
    at = (at + 1) & mask;
  return &points->slot[at];
}

int64_t tc_cut_points_find(const TcCutPoints *points, const TcPointKey *key) {
  return points->slots ? (int64_t)*slot_of(points, key) - 1 : -1;
}

/* Twice as much of what is kept by key. */
static bool grow_keys(TcCutPoints *points) {
  const int64_t slots = points->slots ? 2 * points->slots : 1024, room = slots / 2;
  if (!move(points->context, (void **)&points->p, points->count, room, sizeof *points->p) ||
      !move(points->context, (void **)&points->key, points->count, room, sizeof *points->key)) {
    return false;
  }
  tc_release(points->context, points->slot);
  points->slots = 0;
  if (!tc_allocate_array(points->context, (void **)&points->slot, slots, sizeof *points->slot, "added vertices"))
    return false;
  memset(points->slot, 0, (size_t)slots * sizeof *points->slot);
  points->slots = slots;
  for (int64_t i = 0; i < points->count; ++i)
    *slot_of(points, &points->key[i]) = (uint32_t)i + 1;
  return true;
}

bool tc_cut_points_add(TcCutPoints *points, const TcPointKey *key, const double p[3], int64_t entries) {
  if (2 * points->count >= points->slots && !grow_keys(points))
    return false;
  const int64_t i = points->count++;
  points->entries += entries;
  points->start[i + 1] = points->entries;
  points->key[i] = *key;
  memcpy(points->p[i], p, sizeof points->p[i]);
  *slot_of(points, key) = (uint32_t)i + 1;
  return true;
}

void tc_cut_points_forget_keys(TcCutPoints *points) {
  tc_release(points->context, points->p);
  tc_release(points->context, points->key);
  tc_release(points->context, points->slot);
  points->p = NULL;
  points->key = NULL;
  points->slot = NULL;
  points->slots = 0;
}

void tc_cut_points_clear(TcCutPoints *points) {
  tc_cut_points_forget_keys(points);
  tc_release(points->context, points->start);
  tc_release(points->context, points->source);
  tc_release(points->context, points->weight);
  *points = (TcCutPoints){.context = points->context};
}
