/* SPDX-License-Identifier: Apache-2.0 */
/* Faces are brought together by a counting sort on their smallest vertex, then, in each bucket of a few dozen, by their
 * two others: no hash table, memory proportional to the mesh, and the buckets are independent of each other. */
#include "mesh/adjacency.h"

#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"

/* Face k of a cell is opposite its k-th smallest vertex; its number is 4 · cell + k. */
typedef struct Face {
  uint32_t middle, high; /* the two larger vertices, the bucket is the smallest */
  uint32_t opposite;
  uint64_t number;
} Face;

typedef struct Build {
  TetcastContext *context;
  int64_t cell_count, vertex_count;
  uint32_t (*sorted)[4];   /* the vertices of each cell, ascending */
  uint64_t *bucket;        /* [vertex_count + 1]: where the faces of a smallest vertex begin */
  uint64_t *faces;         /* [4 · cell_count]: face numbers by bucket, sorted within it after find_duplicates() */
  TcCell *cells;
  _Atomic(unsigned char) *duplicate; /* [cell_count] or NULL */
  atomic_llong duplicates, boundary, nonmanifold, shell;
  atomic_bool out_of_memory;
} Build;

static Face face_of(const Build *build, uint64_t number) {
  const uint32_t *v = build->sorted[number >> 2];
  switch (number & 3) { /* the smallest vertex is v[0], or v[1] for the face opposite v[0] */
  case 0: return (Face){v[2], v[3], v[0], number};
  case 1: return (Face){v[2], v[3], v[1], number};
  case 2: return (Face){v[1], v[3], v[2], number};
  default: return (Face){v[1], v[2], v[3], number};
  }
}

static bool same_face(const Face *a, const Face *b) { return a->middle == b->middle && a->high == b->high; }

static int compare_faces(const void *left, const void *right) {
  const Face *a = left, *b = right;
  if (a->middle != b->middle) return a->middle < b->middle ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  if (a->opposite != b->opposite) return a->opposite < b->opposite ? -1 : 1;
  return a->number < b->number ? -1 : a->number > b->number;
}

static void sort_faces(Face *faces, size_t count) {
  if (count > 48) {
    qsort(faces, count, sizeof *faces, compare_faces);
    return;
  }
  for (size_t i = 1; i < count; ++i) {
    const Face face = faces[i];
    size_t j = i;
    for (; j > 0 && compare_faces(&face, &faces[j - 1]) < 0; --j) faces[j] = faces[j - 1];
    faces[j] = face;
  }
}

/* Runs `visit` over each bucket's faces, sorted. */
enum { SMALL_BUCKET = 256 };

static bool load_bucket(Build *build, int64_t vertex, bool sorted, Face *small, Face **faces, size_t *count) {
  const uint64_t begin = build->bucket[vertex];
  *count = (size_t)(build->bucket[vertex + 1] - begin);
  *faces = small;
  if (*count > SMALL_BUCKET) {
    *faces = tc_allocate(build->context, (int64_t)*count, sizeof **faces);
    if (!*faces) {
      atomic_store(&build->out_of_memory, true);
      return false;
    }
  }
  for (size_t i = 0; i < *count; ++i) (*faces)[i] = face_of(build, build->faces[begin + i]);
  if (!sorted) {
    sort_faces(*faces, *count);
    for (size_t i = 0; i < *count; ++i) build->faces[begin + i] = (*faces)[i].number;
  }
  return true;
}

/* Sorts the buckets and marks every cell whose four vertices an earlier cell has. */
static bool find_duplicates(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  Face small[SMALL_BUCKET], *faces;
  size_t count;
  for (int64_t vertex = begin; vertex < end; ++vertex) {
    if (!load_bucket(build, vertex, false, small, &faces, &count)) return false;
    for (size_t i = 1; i < count; ++i) {
      if (same_face(&faces[i], &faces[i - 1]) && faces[i].opposite == faces[i - 1].opposite && (faces[i].number & 3) == 3) {
        build->duplicate[faces[i].number >> 2] = 1;
        atomic_fetch_add(&build->duplicates, 1);
      }
    }
    if (faces != small) tc_release(build->context, faces);
  }
  return true;
}

/* Links the two cells of each face; any other number of cells makes it a shell face of each. */
static bool link_cells(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  Build *build = data;
  Face small[SMALL_BUCKET], *faces;
  size_t count;
  for (int64_t vertex = begin; vertex < end; ++vertex) {
    if (!load_bucket(build, vertex, true, small, &faces, &count)) return false;
    for (size_t i = 0, n; i < count; i += n) {
      n = 1;
      while (i + n < count && same_face(&faces[i], &faces[i + n])) ++n;
      if (n == 2) {
        const uint64_t a = faces[i].number, b = faces[i + 1].number;
        build->cells[a >> 2].neighbor[a & 3] = (uint32_t)(b >> 2);
        build->cells[b >> 2].neighbor[b & 3] = (uint32_t)(a >> 2);
      } else {
        for (size_t j = 0; j < n; ++j) build->cells[faces[i + j].number >> 2].neighbor[faces[i + j].number & 3] = TC_SHELL;
        atomic_fetch_add(&build->shell, (long long)n);
        atomic_fetch_add(n == 1 ? &build->boundary : &build->nonmanifold, 1);
      }
    }
    if (faces != small) tc_release(build->context, faces);
  }
  return true;
}

/* Takes the mesh's cells but those with a vertex twice, and, on the second round, those marked as duplicates. */
static int64_t take_cells(const TetcastMesh *mesh, Build *build, TcAdjacency *result, const Build *previous) {
  int64_t count = 0, next = 0;
  for (int64_t i = 0; i < mesh->tetrahedra.count; ++i) {
    int64_t v[4];
    tc_mesh_tetrahedron(mesh, i, v);
    uint32_t *s = build->sorted[count];
    for (int k = 0; k < 4; ++k) s[k] = (uint32_t)v[k];
    tc_sort4(s);
    if (s[0] == s[1] || s[1] == s[2] || s[2] == s[3]) {
      ++result->collapsed;
      continue;
    }
    if (previous && previous->duplicate[next++]) continue;
    if (result->source) result->source[count] = (uint32_t)i;
    ++count;
  }
  return count;
}

static void fill_buckets(Build *build) {
  memset(build->bucket, 0, (size_t)(build->vertex_count + 1) * sizeof *build->bucket);
  for (int64_t i = 0; i < build->cell_count; ++i) {
    build->bucket[build->sorted[i][0]] += 3;
    build->bucket[build->sorted[i][1]] += 1;
  }
  uint64_t sum = 0;
  for (int64_t v = 0; v <= build->vertex_count; ++v) { /* to the end of each bucket: filled downwards, it becomes the beginning */
    sum += build->bucket[v];
    build->bucket[v] = sum;
  }
  for (int64_t i = build->cell_count - 1; i >= 0; --i) {
    const uint64_t number = (uint64_t)i * 4;
    for (uint64_t k = 3; k >= 1; --k) build->faces[--build->bucket[build->sorted[i][0]]] = number + k;
    build->faces[--build->bucket[build->sorted[i][1]]] = number;
  }
}

/* Gives each shell face its number and its record. */
static void collect_shell(Build *build, TcAdjacency *result) {
  int64_t next = 0;
  for (int64_t i = 0; i < build->cell_count; ++i) {
    const uint32_t *v = build->sorted[i];
    for (int k = 0; k < 4; ++k) {
      if (build->cells[i].neighbor[k] != TC_SHELL) continue;
      TcShellFace *face = &result->shell[next];
      for (int j = 0, n = 0; j < 4; ++j) {
        if (j != k) face->vertex[n++] = v[j];
      }
      face->cell = (uint32_t)i;
      build->cells[i].neighbor[k] = TC_SHELL | (uint32_t)next++;
    }
  }
}

static TetcastStatus out_of_memory(const Build *build) {
  return tc_error(build->context, TETCAST_ERROR_MEMORY, "out of memory: adjacency of %lld cells", (long long)build->cell_count);
}

static TetcastStatus run(const TetcastMesh *mesh, Build *build, TcAdjacency *result, const TetcastProgress *progress) {
  TetcastContext *context = build->context;
  const int64_t all = mesh->tetrahedra.count;
  build->vertex_count = mesh->vertices.count;
  if (!tc_allocate_array(context, (void **)&build->sorted, all, sizeof *build->sorted, "cells") ||
      !tc_allocate_array(context, (void **)&build->bucket, build->vertex_count + 1, sizeof *build->bucket, "faces") ||
      !tc_allocate_array(context, (void **)&build->faces, all * 4, sizeof *build->faces, "faces") ||
      !tc_allocate_array(context, (void **)&build->duplicate, all, 1, "cells")) {
    return TETCAST_ERROR_MEMORY;
  }
  memset((void *)build->duplicate, 0, (size_t)all);
  build->cell_count = take_cells(mesh, build, result, NULL);
  fill_buckets(build);
  TetcastStatus status = tc_parallel_for(context, build->vertex_count, 4096, find_duplicates, build, progress);
  if (atomic_load(&build->out_of_memory)) return out_of_memory(build);
  if (status) return status;
  result->duplicates = atomic_load(&build->duplicates);
  if (result->collapsed + result->duplicates > 0) { /* numbers shift: note where cells came from; rare, so simply once more */
    if (!tc_allocate_array(context, (void **)&result->source, all, sizeof *result->source, "cells")) return TETCAST_ERROR_MEMORY;
    result->collapsed = 0;
    build->cell_count = take_cells(mesh, build, result, build);
    fill_buckets(build);
    memset((void *)build->duplicate, 0, (size_t)all);
    status = tc_parallel_for(context, build->vertex_count, 4096, find_duplicates, build, progress);
    if (atomic_load(&build->out_of_memory)) return out_of_memory(build);
    if (status) return status;
  }
  tc_release(context, (void *)build->duplicate);
  build->duplicate = NULL;

  result->cell_count = build->cell_count;
  if (!tc_allocate_array(context, (void **)&result->cells, build->cell_count, sizeof *result->cells, "cells")) {
    return TETCAST_ERROR_MEMORY;
  }
  build->cells = result->cells;
  for (int64_t i = 0; i < build->cell_count; ++i) {
    const uint32_t *v = build->sorted[i];
    build->cells[i].vertex_xor = v[0] ^ v[1] ^ v[2] ^ v[3];
  }
  status = tc_parallel_for(context, build->vertex_count, 4096, link_cells, build, progress);
  if (atomic_load(&build->out_of_memory)) return out_of_memory(build);
  if (status) return status;
  result->nonmanifold = atomic_load(&build->nonmanifold);
  result->boundary = atomic_load(&build->boundary);
  result->shell_count = atomic_load(&build->shell);
  if (result->shell_count > TC_MAX_COUNT) {
    return tc_error(context, TETCAST_ERROR_LIMIT, "%lld boundary faces: at most %d can be held", (long long)result->shell_count,
                    (int)TC_MAX_COUNT);
  }
  if (!tc_allocate_array(context, (void **)&result->shell, result->shell_count, sizeof *result->shell, "boundary faces")) {
    return TETCAST_ERROR_MEMORY;
  }
  collect_shell(build, result);
  return TETCAST_OK;
}

TetcastStatus tc_adjacency_build(const TetcastMesh *mesh, bool keep_vertices, const TetcastProgress *progress,
                                 TcAdjacency *result) {
  memset(result, 0, sizeof *result);
  result->context = mesh->context;
  Build build;
  memset(&build, 0, sizeof build);
  build.context = mesh->context;
  const TetcastStatus status = run(mesh, &build, result, progress);
  if (keep_vertices) result->vertices = build.sorted;
  else tc_release(build.context, build.sorted);
  tc_release(build.context, build.bucket);
  tc_release(build.context, build.faces);
  tc_release(build.context, (void *)build.duplicate);
  if (status) tc_adjacency_clear(result);
  return status;
}

void tc_adjacency_drop_links(TcAdjacency *adjacency) {
  tc_release(adjacency->context, adjacency->cells);
  tc_release(adjacency->context, adjacency->shell);
  adjacency->cells = NULL;
  adjacency->shell = NULL;
  adjacency->shell_count = 0;
}

void tc_adjacency_clear(TcAdjacency *adjacency) {
  tc_release(adjacency->context, adjacency->vertices);
  tc_release(adjacency->context, adjacency->cells);
  tc_release(adjacency->context, adjacency->shell);
  tc_release(adjacency->context, adjacency->source);
  memset(adjacency, 0, sizeof *adjacency);
}
