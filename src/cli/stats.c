/* SPDX-License-Identifier: Apache-2.0 */
#include "stats.h"

#include <math.h>
#include <sys/resource.h>

#include "json.h"

json_t *stats_object(const RunStats *stats) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  json_t *object = json_object();
  json_object_set_new(object, "read_seconds", json_real(stats->read_seconds));
  json_object_set_new(object, "prepare_seconds", json_real(stats->prepare_seconds));
  json_object_set_new(object, "render_seconds", cli_json_array(stats->render_seconds, stats->repeats));
  json_object_set_new(object, "write_seconds", json_real(stats->write_seconds));
  json_object_set_new(object, "rays", json_integer(stats->render.rays));
  json_object_set_new(object, "segments", json_integer(stats->render.segments));
  json_object_set_new(object, "tolerance", json_real(stats->tolerance));
  json_object_set_new(object, "blend", json_string(stats->blend));
  json_object_set_new(object, "error", isfinite(stats->render.error) ? json_real(stats->render.error) : json_null());
  json_object_set_new(object, "peak_rss_bytes",
                      json_integer((json_int_t)usage.ru_maxrss * 1024)); /* Linux counts in KiB */
  json_object_set_new(object, "volume_bytes", json_integer((json_int_t)stats->volume.bytes));
  json_object_set_new(object, "tetrahedra", json_integer(stats->volume.tetrahedra));
  json_object_set_new(object, "vertices", json_integer(stats->volume.vertices));
  json_object_set_new(object, "threads", json_integer(stats->threads));
  json_object_set_new(object, "isa", json_string(stats->render.isa));
  json_object_set_new(object, "precision", json_string(stats->render.precision));
  json_object_set_new(object, "traversal",
                      json_string(stats->volume.traversal == TETCAST_TRAVERSAL_FACES ? "faces" : "shell"));
  return object;
}
