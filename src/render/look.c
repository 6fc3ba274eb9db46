/* SPDX-License-Identifier: Apache-2.0 */
/* A number for what a scene shows, by which parts of a mesh tell whether all of them show the same. */
#include <string.h>

#include "render/render.h"

/* Fowler, Noll and Vo's hash FNV-1a, of whole numbers of 64 bits in place of bytes. */
static void add(uint64_t *hash, uint64_t number) {
  for (int half = 0; half < 2; ++half, number >>= 32)
    *hash = (*hash ^ (number & UINT32_MAX)) * UINT64_C(0x100000001B3);
}

static void add_numbers(uint64_t *hash, const double *numbers, int64_t count) {
  add(hash, (uint64_t)count);
  for (int64_t i = 0; i < count; ++i) {
    const double number = numbers[i] + 0.0; /* −0 is 0 */
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    add(hash, bits);
  }
}

static void add_transfer(uint64_t *hash, const TetcastTransferFunction *transfer) {
  add_numbers(hash, transfer->color, 4 * transfer->color_count);
  add_numbers(hash, transfer->extinction, 2 * transfer->extinction_count);
}

static void add_lighting(uint64_t *hash, const TcLighting *lighting) {
  const double numbers[] = {lighting->surfaces, lighting->smooth,   lighting->ambient,
                            lighting->diffuse,  lighting->specular, lighting->exponent};
  add_numbers(hash, numbers, sizeof numbers / sizeof *numbers);
  for (int i = 0; i < lighting->light_count; ++i) {
    add_numbers(hash, lighting->light[i].direction, 3);
    add_numbers(hash, lighting->light[i].color, 3);
  }
}

int64_t tc_scene_look(const TetcastScene *scene) {
  uint64_t hash = UINT64_C(0xCBF29CE484222325);
  if (scene->row_count > 0)
    add_numbers(&hash, scene->row_at, scene->row_count);
  for (int i = 0; i < scene->row_count; ++i)
    add_transfer(&hash, scene->rows[i]);
  if (scene->row_count == 0 && scene->transfer)
    add_transfer(&hash, scene->transfer);
  for (int i = 0; i < scene->isosurface_count; ++i) {
    const TetcastIsosurface *s = &scene->isosurfaces[i];
    const double numbers[] = {s->value, s->color[0], s->color[1], s->color[2], s->opacity};
    add_numbers(&hash, numbers, 5);
  }
  for (int i = 0; i < scene->slice_count; ++i) {
    const TetcastSlice *s = &scene->slices[i];
    const double numbers[] = {s->normal[0], s->normal[1], s->normal[2], s->offset, s->opacity};
    add_numbers(&hash, numbers, 5);
  }
  if (scene->isosurface_count > 0)
    add_lighting(&hash, &scene->lighting);
  return (int64_t)(hash >> 2);
}
