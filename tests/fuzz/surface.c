/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces: the first letter says by which name the rest is read. */
#include <tetcast/dataset.h>

#include "fuzz.h"

const char *const fuzz_seeds[] = {
    "ssolid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\nendsolid "
    "a\n",
    "oOFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 255 0 0\n4 0 1 2 3\n",
    "bv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1/1 2//3 3/1/1\nf -1 -2 \\\n-3\n",
    "pply\nformat ascii 1.0\ncomment a\nelement vertex 3\nproperty float x\nproperty float y\nproperty double "
    "z\nproperty uchar red\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n",
    "pply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char "
    "z\nelement face 1\n"
    "property list uchar uchar vertex_index\nend_header\nabc\003abc",
    "sbinary header, which is of eighty letters, whatever they say, and not looked at at all.....\001\001\001\001 and "
    "what is not 50 bytes",
    NULL};

static TetcastContext *context;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!context) {
    const TetcastContextDesc desc = {.cookie = tetcast_context_desc_default().cookie, .threads = 1};
    if (tetcast_context_create(&desc, &context) != TETCAST_OK)
      return 0;
  }
  if (size < 2)
    return 0;
  const char *name = data[0] == 's' ? "in.stl" : data[0] == 'o' ? "in.off" : data[0] == 'b' ? "in.obj" : "in.ply";
  TetcastSurface surface;
  if (tetcast_surface_read(context, fuzz_file(name, data + 1, size - 1), &surface) == TETCAST_OK)
    tetcast_surface_release(&surface);
  return 0;
}
