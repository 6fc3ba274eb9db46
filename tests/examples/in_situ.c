/* SPDX-License-Identifier: Apache-2.0 */
/* A simulation that speaks Catalyst 2: heat in a grid of points, handed over in place at each step. It knows nothing of
 * tetcast, which is named when it is started:
 *     CATALYST_IMPLEMENTATION_NAME=tetcast CATALYST_IMPLEMENTATION_PATHS=/where/tetcast/is/lib/catalyst ./in_situ */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <catalyst.h>

enum { N = 24, POINTS = N * N * N, STEPS = 40 };

static double heat[POINTS], next[POINTS];

static void solve(void) {
  for (int i = 0; i < POINTS; i++) {
    const int at[3] = {i % N, i / N % N, i / N / N}, step[3] = {1, N, N * N};
    double sum = 0;
    for (int k = 0; k < 3; k++) { /* no heat flows out */
      sum += heat[at[k] > 0 ? i - step[k] : i] - heat[i];
      sum += heat[at[k] < N - 1 ? i + step[k] : i] - heat[i];
    }
    next[i] = heat[i] + 0.15 * sum;
  }
  memcpy(heat, next, sizeof heat);
}

/* What is said once: which scene, how often. */
static int begin(void) {
  conduit_node *params = conduit_node_create();
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/scene", "{\"array\": \"heat\", \"size\": [320, 240]}");
  conduit_node_set_path_char8_str(params, "catalyst/tetcast/output", "heat.###.png");
  conduit_node_set_path_int64(params, "catalyst/tetcast/every", 20);
  const int status = (int)catalyst_initialize(params);
  conduit_node_destroy(params);
  return status;
}

/* What is said at each step: the number, and where the mesh and its fields lie. */
static int show(int step) {
  static const char *const dims[3] = {"coordsets/coords/dims/i", "coordsets/coords/dims/j", "coordsets/coords/dims/k"};
  conduit_node *params = conduit_node_create();
  conduit_node_set_path_int64(params, "catalyst/state/timestep", step);
  conduit_node_set_path_float64(params, "catalyst/state/time", 0.15 * step);
  conduit_node_set_path_char8_str(params, "catalyst/channels/grid/type", "mesh");
  conduit_node *mesh = conduit_node_fetch(params, "catalyst/channels/grid/data");
  conduit_node_set_path_char8_str(mesh, "coordsets/coords/type", "uniform");
  for (int k = 0; k < 3; k++)
    conduit_node_set_path_int64(mesh, dims[k], N);
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/type", "uniform");
  conduit_node_set_path_char8_str(mesh, "topologies/mesh/coordset", "coords");
  conduit_node_set_path_char8_str(mesh, "fields/heat/association", "vertex");
  conduit_node_set_path_char8_str(mesh, "fields/heat/topology", "mesh");
  conduit_node_set_path_external_float64_ptr(mesh, "fields/heat/values", heat, POINTS);
  const int status = (int)catalyst_execute(params);
  conduit_node_destroy(params);
  return status;
}

int main(void) {
  for (int i = 0; i < POINTS; i++)
    heat[i] = exp(-0.05 * (pow(i % N - 8, 2) + pow(i / N % N - 12, 2) + pow(i / N / N - 15, 2)));
  int status = begin();
  for (int step = 0; step <= STEPS && status == 0; step++) {
    status = show(step);
    solve();
  }
  conduit_node *params = conduit_node_create();
  const int last = (int)catalyst_finalize(params);
  conduit_node_destroy(params);
  if (status != 0 || last != 0)
    fprintf(stderr, "Catalyst: status %d, then %d\n", status, last);
  return status || last;
}
