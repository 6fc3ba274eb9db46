/* SPDX-License-Identifier: Apache-2.0 */
/* The one file that knows Embree, 3.13 or 4. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "volume/embree.h"

#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"

#if TETCAST_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <tetcast/version.h>

/* Embree sees the sphere as the unit sphere. There, a line's start and direction rounded to float are off by at most
 * 2^−24 each per coordinate; over a length of at most 4 + 4 that moves it by less than 2^−20. A box's own rounding adds
 * 2^−24 and Embree's slab test, with RTC_SCENE_FLAG_ROBUST, a few 2^−24 of lengths ≤ 8. */
#define MARGIN 0x1p-18

/* Embree is given the caller's primitives in pairs, as neighbours in number are neighbours in space. That halves the
 * time and the memory that building takes. Queries find more candidates that aren't met, which costs 2 to 4 % of a
 * frame. */
enum { PAIR = 2 };

/* From so many of the caller's primitives on, several threads build. */
enum { MANY = 1 << 16 };

struct TcEmbree {
  TetcastContext *context;
  RTCDevice device;
  RTCScene scene;
  double center[3], inverse_radius;
  TcBoundsFunction *bounds;
  const void *user;
  uint32_t count;
  atomic_llong bytes;
  atomic_int error; /* Embree's error while building */
};

typedef struct Query {
#if RTC_VERSION_MAJOR >= 4
  struct RTCRayQueryContext context;
#else
  struct RTCIntersectContext context;
#endif
  TcCandidateFunction *candidate;
  TcPacketCandidateFunction *packet_candidate; /* called in its place for packets */
  void *query;
} Query;

const char *tetcast_embree_version_string(void) {
#define STRING_(x) #x
#define STRING(x)  STRING_(x)
  return STRING(RTC_VERSION_MAJOR) "." STRING(RTC_VERSION_MINOR) "." STRING(RTC_VERSION_PATCH);
}

/* The end of the caller's primitives that Embree's `pair` stands for; they begin at PAIR · pair. */
static uint32_t end_of(const TcEmbree *embree, uint32_t pair) {
  const uint32_t begin = PAIR * pair;
  return embree->count - begin < PAIR ? embree->count : begin + PAIR;
}

static void bounds_function(const struct RTCBoundsFunctionArguments *arguments) {
  const TcEmbree *embree = arguments->geometryUserPtr;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (uint32_t i = PAIR * arguments->primID; i < end_of(embree, arguments->primID); ++i) {
    double l[3], h[3];
    embree->bounds(embree->user, i, l, h);
    for (int k = 0; k < 3; ++k) {
      low[k] = l[k] < low[k] ? l[k] : low[k];
      high[k] = h[k] > high[k] ? h[k] : high[k];
    }
  }
  float lower[3], upper[3];
  for (int k = 0; k < 3; ++k) {
    lower[k] = (float)((low[k] - embree->center[k]) * embree->inverse_radius - MARGIN);
    upper[k] = (float)((high[k] - embree->center[k]) * embree->inverse_radius + MARGIN);
  }
  struct RTCBounds *box = arguments->bounds_o;
  box->lower_x = lower[0], box->lower_y = lower[1], box->lower_z = lower[2];
  box->upper_x = upper[0], box->upper_y = upper[1], box->upper_z = upper[2];
}

/* Hands the candidate on and never accepts a hit, so that Embree goes on to the next. */
static void intersect_function(const struct RTCIntersectFunctionNArguments *arguments) {
  const Query *query = (const Query *)(const void *)arguments->context;
  const uint32_t begin = PAIR * arguments->primID, end = end_of(arguments->geometryUserPtr, arguments->primID);
  if (query->candidate) {
    for (uint32_t i = begin; i < end && arguments->valid[0]; ++i)
      query->candidate(query->query, i);
    return;
  }
  /* A ray's id is its lane's bit, however many of a packet Embree hands on together; `valid` is 0 or −1. It is the
   * eleventh of a packet's arrays: what RTCRayN_id() says, which is there in C++ only. */
  const unsigned *id = (const unsigned *)(const void *)arguments->rayhit + 10 * arguments->N;
  unsigned lanes = 0;
  for (unsigned i = 0; i < arguments->N; ++i)
    lanes |= (unsigned)arguments->valid[i] & id[i];
  for (uint32_t i = begin; i < end; ++i)
    query->packet_candidate(query->query, i, lanes);
}

static bool memory_monitor(void *user, ssize_t bytes, bool post) {
  (void)post;
  TcEmbree *embree = user;
  atomic_fetch_add(&embree->bytes, (long long)bytes);
  return true;
}

/* ── building ── */

/* Reads Embree's error of this thread, which also clears it. Embree allocates the place where it notes a thread's
 * errors at the first reading. This must not happen when memory is short, as Embree would end the process. */
static enum RTCError take_error(RTCDevice device) {
  return rtcGetDeviceError(device);
}

static TetcastStatus report(TetcastContext *context, enum RTCError error) {
  if (error == RTC_ERROR_NONE)
    return TETCAST_OK;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    return tc_error(context, TETCAST_ERROR_MEMORY, "out of memory in Embree");
  return tc_error(context, TETCAST_ERROR_EMBREE, "Embree reports error %d", (int)error);
}

/* Where memory is short, it is refused here rather than beneath Embree and TBB, which can't bear that at every place:
 * what building takes is tried first. 16 MiB for what the two make once; a primitive takes 72 bytes at the most, as
 * measured. */
static bool memory_suffices(int64_t count) {
  void *reserve = malloc(((size_t)16 << 20) + 96 * (size_t)count);
  free(reserve);
  return reserve != NULL;
}

static TetcastStatus make_scene(TcEmbree *embree) {
  embree->scene = rtcNewScene(embree->device);
  TetcastStatus status = report(embree->context, take_error(embree->device));
  if (status)
    return status;
  rtcSetSceneFlags(embree->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);
  status = report(embree->context, take_error(embree->device));
  if (status)
    return status;
  rtcSetGeometryUserPrimitiveCount(geometry, (embree->count + PAIR - 1) / PAIR);
  rtcSetGeometryUserData(geometry, embree);
  rtcSetGeometryBoundsFunction(geometry, bounds_function, NULL);
  rtcSetGeometryIntersectFunction(geometry, intersect_function);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree->scene, geometry);
  rtcReleaseGeometry(geometry);
  return report(embree->context, take_error(embree->device));
}

/* How many threads build: no more than TBB counts processors, so that each finds a place in its arena, and only one if
 * there is little to do. */
static int builders(const TcEmbree *embree) {
  int threads = tc_context_threads(embree->context), processors = 1;
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0)
    processors = CPU_COUNT(&set);
  if (embree->count < MANY)
    threads = 1;
  return threads < processors ? threads : processors;
}

static bool build(void *data, int64_t begin, int64_t end, int worker) {
  (void)begin, (void)end, (void)worker;
  TcEmbree *embree = data;
  take_error(embree->device);
  rtcJoinCommitScene(embree->scene);
  const enum RTCError error = take_error(embree->device);
  if (error != RTC_ERROR_NONE)
    atomic_store(&embree->error, (int)error);
  return true;
}

/* Threads are ours, which join in: TBB, were it to start one that the system refuses, would end the process. Its arena
 * has no places but for such guests. */
static TetcastStatus make(TcEmbree *embree) {
  if (!memory_suffices(embree->count))
    return tc_error(embree->context, TETCAST_ERROR_MEMORY, "out of memory: Embree");
  take_error(NULL);
  embree->device = rtcNewDevice("user_threads=4096,set_affinity=0");
  if (!embree->device) {
    const enum RTCError error = take_error(NULL);
    return report(embree->context, error == RTC_ERROR_NONE ? RTC_ERROR_UNKNOWN : error);
  }
  take_error(embree->device);
  rtcSetDeviceMemoryMonitorFunction(embree->device, memory_monitor, embree);
  const TetcastStatus status = make_scene(embree);
  if (status)
    return status;
  tc_parallel_for(embree->context, builders(embree), 1, build, embree, NULL);
  return report(embree->context, (enum RTCError)atomic_load(&embree->error));
}

TetcastStatus tc_embree_create(TetcastContext *context, int64_t count, const double center[3], double radius,
                               TcBoundsFunction *bounds, const void *user, TcEmbree **out) {
  TcEmbree *embree;
  if (!tc_allocate_array(context, (void **)&embree, 1, sizeof *embree, "Embree"))
    return TETCAST_ERROR_MEMORY;
  memset(embree, 0, sizeof *embree);
  embree->context = context;
  memcpy(embree->center, center, sizeof embree->center);
  embree->inverse_radius = 1 / radius;
  embree->bounds = bounds;
  embree->user = user;
  embree->count = (uint32_t)count;
  atomic_init(&embree->bytes, 0);
  atomic_init(&embree->error, (int)RTC_ERROR_NONE);
  const TetcastStatus status = make(embree);
  if (status) {
    tc_embree_destroy(embree);
    return status;
  }
  *out = embree;
  return TETCAST_OK;
}

void tc_embree_destroy(TcEmbree *embree) {
  if (!embree)
    return;
  if (embree->scene)
    rtcReleaseScene(embree->scene);
  if (embree->device)
    rtcReleaseDevice(embree->device);
  tc_release(embree->context, embree);
}

size_t tc_embree_bytes(const TcEmbree *embree) {
  const long long bytes = atomic_load(&embree->bytes);
  return bytes > 0 ? (size_t)bytes : 0;
}

/* The start of a ray for Embree: the point of its line that is nearest to the centre, moved back by two radii, out of
 * the sphere. */
static void start_of(const TcEmbree *embree, const double from_center[3], const double direction[3], float start[3]) {
  double p[3], along = 0;
  for (int k = 0; k < 3; ++k) {
    p[k] = from_center[k] * embree->inverse_radius;
    along += p[k] * direction[k];
  }
  for (int k = 0; k < 3; ++k)
    start[k] = (float)(p[k] - (along + 2) * direction[k]);
}

/* Sets up `query`, and calls an rtcIntersect function with what comes before and after the rays. */
#if RTC_VERSION_MAJOR >= 4
#define INTERSECT(query, is_coherent, call)                                                                            \
  do {                                                                                                                 \
    rtcInitRayQueryContext(&(query).context);                                                                          \
    struct RTCIntersectArguments arguments;                                                                            \
    rtcInitIntersectArguments(&arguments);                                                                             \
    arguments.flags = (is_coherent) ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;                     \
    arguments.context = &(query).context;                                                                              \
    call;                                                                                                              \
  } while (0)
#define RAYS(query, rays) (rays), &arguments
#else
#define INTERSECT(query, is_coherent, call)                                                                            \
  do {                                                                                                                 \
    rtcInitIntersectContext(&(query).context);                                                                         \
    (query).context.flags =                                                                                            \
        (is_coherent) ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;                   \
    call;                                                                                                              \
  } while (0)
#define RAYS(query, rays) &(query).context, (rays)
#endif

void tc_embree_query(const TcEmbree *embree, const double from_center[3], const double direction[3],
                     TcCandidateFunction *candidate, void *user) {
  float start[3];
  start_of(embree, from_center, direction, start);
  struct RTCRayHit ray = {.ray = {.org_x = start[0],
                                  .org_y = start[1],
                                  .org_z = start[2],
                                  .dir_x = (float)direction[0],
                                  .dir_y = (float)direction[1],
                                  .dir_z = (float)direction[2],
                                  .tfar = 4,
                                  .mask = UINT32_MAX},
                          .hit = {.geomID = RTC_INVALID_GEOMETRY_ID,
                                  .primID = RTC_INVALID_GEOMETRY_ID,
                                  .instID = {RTC_INVALID_GEOMETRY_ID}}};
  Query query = {.candidate = candidate, .query = user};
  INTERSECT(query, false, rtcIntersect1(embree->scene, RAYS(query, &ray)));
}

/* Sets up rays of a packet of either width. */
#define FILL(rays)                                                                                                     \
  do {                                                                                                                 \
    for (int i = 0; i < width; ++i) {                                                                                  \
      const double p[3] = {from_center[i], from_center[width + i], from_center[2 * width + i]};                        \
      const double d[3] = {direction[i], direction[width + i], direction[2 * width + i]};                              \
      float start[3];                                                                                                  \
      start_of(embree, p, d, start);                                                                                   \
      (rays).ray.org_x[i] = start[0], (rays).ray.org_y[i] = start[1], (rays).ray.org_z[i] = start[2];                  \
      (rays).ray.dir_x[i] = (float)d[0], (rays).ray.dir_y[i] = (float)d[1], (rays).ray.dir_z[i] = (float)d[2];         \
      (rays).ray.tnear[i] = 0, (rays).ray.tfar[i] = 4, (rays).ray.time[i] = 0;                                         \
      (rays).ray.mask[i] = UINT32_MAX, (rays).ray.id[i] = 1U << i, (rays).ray.flags[i] = 0;                            \
      (rays).hit.geomID[i] = (rays).hit.primID[i] = (rays).hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;                 \
      valid[i] = lanes >> i & 1 ? -1 : 0;                                                                              \
    }                                                                                                                  \
  } while (0)

/* Whether lines go nearly the same way, so that it pays to look at boxes for all of them at once. */
static bool coherent(int width, unsigned lanes, const double *direction) {
  const int first = lanes ? __builtin_ctz(lanes) : 0;
  for (; lanes; lanes &= lanes - 1) {
    const int i = __builtin_ctz(lanes);
    for (int k = 0; k < 3; ++k) {
      if (fabs(direction[k * width + i] - direction[k * width + first]) > 0.125)
        return false;
    }
  }
  return true;
}

/* Where the processor has no such packets, Embree takes them apart. */
void tc_embree_query_packet(const TcEmbree *embree, int width, unsigned lanes, const double *from_center,
                            const double *direction, TcPacketCandidateFunction *candidate, void *user) {
  Query query = {.packet_candidate = candidate, .query = user};
  _Alignas(64) int valid[16];
  const bool together = coherent(width, lanes, direction);
  if (width == 16) {
    struct RTCRayHit16 rays;
    FILL(rays);
    INTERSECT(query, together, rtcIntersect16(valid, embree->scene, RAYS(query, &rays)));
  } else {
    struct RTCRayHit8 rays;
    FILL(rays);
    INTERSECT(query, together, rtcIntersect8(valid, embree->scene, RAYS(query, &rays)));
  }
}
