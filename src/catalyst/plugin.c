/* SPDX-License-Identifier: Apache-2.0 */
/* libcatalyst-tetcast.so: an implementation of Catalyst 2, which a simulation loads by its name at run time:
 * CATALYST_IMPLEMENTATION_NAME=tetcast CATALYST_IMPLEMENTATION_PATHS=…/lib/catalyst. README.md has what it takes. */
#include <stddef.h>

#include <tetcast/context.h>
#include <tetcast/version.h>

#include "conduit.h"
#include "host.h"
#include "steps.h"

/* As Catalyst's catalyst_impl.h has it; it looks for one of this name. */
struct catalyst_impl {
  int version;
  int (*initialize)(const ConduitNode *params);
  int (*execute)(const ConduitNode *params);
  int (*finalize)(const ConduitNode *params);
  int (*about)(ConduitNode *params);
  int (*results)(ConduitNode *params);
};
extern const struct catalyst_impl catalyst_api_impl;

/* One call of the host's. */
typedef struct Call {
  int (*work)(const struct Call *call);
  const ConduitNode *params;
  ConduitNode *out;
  void *caller; /* an address in Catalyst */
} Call;

static bool bound, broken; /* broken: memory ran out, and what there is can't be relied on */

static int do_work(void *argument) {
  const Call *call = argument;
  bound = bound || conduit_bind(call->caller);
  return bound ? call->work(call) : STEPS_INVALID;
}

static int perform(Call *call) {
  if (broken)
    return STEPS_FAILED;
  const int code = host_call(do_work, call);
  broken = code < 0;
  return broken ? STEPS_FAILED : code;
}

static int begin(const Call *call) {
  return steps_begin(call->params);
}

static int execute_step(const Call *call) {
  return steps_execute(call->params);
}

static int end(const Call *call) {
  (void)call;
  return steps_end();
}

static int tell(const Call *call) {
  conduit_set_text(call->out, "catalyst/implementation", "tetcast");
  conduit_set_text(call->out, "catalyst/tetcast/version", tetcast_version_string());
  return STEPS_DONE;
}

static int report(const Call *call) {
  steps_results(call->out);
  return STEPS_DONE;
}

static int initialize(const ConduitNode *params) {
  return perform(&(Call){.work = begin, .params = params, .caller = __builtin_return_address(0)});
}

static int execute(const ConduitNode *params) {
  return perform(&(Call){.work = execute_step, .params = params, .caller = __builtin_return_address(0)});
}

static int finalize(const ConduitNode *params) {
  return perform(&(Call){.work = end, .params = params, .caller = __builtin_return_address(0)});
}

static int about(ConduitNode *params) {
  return perform(&(Call){.work = tell, .out = params, .caller = __builtin_return_address(0)});
}

static int results(ConduitNode *params) {
  return perform(&(Call){.work = report, .out = params, .caller = __builtin_return_address(0)});
}

__attribute__((visibility("default"))) const struct catalyst_impl catalyst_api_impl = {.version = 1,
                                                                                       .initialize = initialize,
                                                                                       .execute = execute,
                                                                                       .finalize = finalize,
                                                                                       .about = about,
                                                                                       .results = results};
