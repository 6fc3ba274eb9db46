/* SPDX-License-Identifier: Apache-2.0 */
/* The command's files of settings: scenes, and transfer functions, alone or in a scene. */
#include <string.h>

#include "cli.h"
#include "scene_file.h"
#include "transfer_file.h"

#include "fuzz.h"

const char *const fuzz_seeds[] = {
    "{\"input\": \"a.vtu\", \"output\": \"b.exr\", \"array\": \"v:mag\", \"block\": \"a/b\", \"time\": \"t=0.5\", "
    "\"merge_tolerance\": 1e-3,"
    " \"subdivide\": 3, \"transfer\": {\"color\": [[0,1,0,0],[1,0,0.5,1]], \"opacity\": [[0,0],[1,0.9]], "
    "\"unit_distance\": 0.7},"
    " \"camera\": {\"eye\": [1,2,3], \"target\": [0,0,0], \"up\": [0,1,0], \"fovy\": 30}, \"size\": [64,48], "
    "\"samples\": 4,"
    " \"background\": [1,1,1,0.5], \"pixel_type\": \"half\", \"traversal\": \"faces\", \"isa\": \"avx2\", \"threads\": "
    "2, \"quiet\": true}",
    "{\"color\": [[0.1,1,0,0],[2,0,0.3333333333333333,1],[2,1,1,1]], \"extinction\": [[0.3,0],[6,1e300]]}",
    "{\"preset\": \"viridis\", \"range\": [0, 1], \"opacity_model\": \"ospray\", \"camera\": {\"ortho\": 2}, "
    "\"integrator\": \"gauss:3\","
    " \"tolerance\": 0.1, \"channels\": \"error\", \"repeat\": 2, \"stats\": \"s.json\"}",
    NULL};

static TetcastContext *context;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!context)
    context = cli_context_create(1);
  if (!context)
    return 0;
  cli_set_quiet(true);
  char path[512];
  snprintf(path, sizeof path, "%s", fuzz_file("in.json", data, size));
  RenderOptions options = render_options_default(COMMAND_RENDER);
  options.scene = cli_duplicate(path);
  if (scene_file_read(&options) && options.transfer_object) {
    TransferRows rows = {.count = 0};
    TetcastTransferFunction *transfer_function = transfer_file_load(context, &options, &rows);
    transfer_file_release(&rows);
    tetcast_transfer_function_destroy(&transfer_function);
  }
  render_options_release(&options);
  options = render_options_default(COMMAND_RENDER);
  options.transfer = cli_duplicate(path);
  TransferRows rows = {.count = 0};
  TetcastTransferFunction *transfer_function = transfer_file_load(context, &options, &rows);
  transfer_file_release(&rows);
  tetcast_transfer_function_destroy(&transfer_function);
  render_options_release(&options);
  return 0;
}
