/* SPDX-License-Identifier: Apache-2.0 */
/* The studies of the user's scene: as it is, and with its extinction scaled. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "clip.h"
#include "converge.h"
#include "progress.h"

/* About how long a rendering takes, in units of the exact one. */
static double weight(const ConvergeRow *row) {
  switch (row->integrator) {
  case TETCAST_INTEGRATOR_MIDPOINT:
    return 0.5 + 0.3 * row->n;
  case TETCAST_INTEGRATOR_TRAPEZOID:
    return 0.5 + 0.6 * row->n;
  case TETCAST_INTEGRATOR_GAUSS:
    return 0.5 + 0.6 * row->n;
  case TETCAST_INTEGRATOR_TABLE:
    return 2.5;
  default:
    return row->packets ? 0.15 : row->adaptive > 0 ? 0.5 : 1;
  }
}

static double check_weight(const Converge *converge) {
  return 0.02 * converge->options.repeat * converge->work;
}

/* Whether the scene runs in a packet kernel: that depends on what is asked for, the processor, and the scene itself. */
static TetcastStatus find_packets(Converge *converge, bool *packets) {
  TetcastFrameDesc frame_desc = tetcast_frame_desc_default();
  frame_desc.width = frame_desc.height = 1;
  TetcastFrame *frame = NULL;
  TetcastRenderDesc desc = tetcast_render_desc_default();
  desc.isa = (TetcastIsa)converge->options.isa;
  TetcastRenderStats stats = {.isa = "scalar"};
  TetcastStatus status = tetcast_frame_create(converge->context, &frame_desc, &frame);
  if (status == TETCAST_OK)
    status = tetcast_scene_render(converge->stage.scene, &converge->stage.camera, &desc, frame, &stats);
  tetcast_frame_destroy(&frame);
  *packets = strcmp(stats.isa, "scalar") != 0;
  return status;
}

/* The exact row and the ladder of tolerances. */
static void plan_exact(Converge *converge, ConvergeRow row) {
  converge_plan(converge, row);
  for (int digits = 1; digits <= 9; digits++) {
    row.tolerance = pow(10, -digits);
    converge_plan(converge, row);
  }
}

int converge_plan_scene(Converge *converge) {
  static const int powers[] = {1, 2, 4, 8, 16, 32, 64, 0}, nodes[] = {1, 2, 3, 4, 6, 8, 12, 16, 0},
                   sides[] = {4, 8, 16, 32, 64, 128, 256, 512, 1024, 0};
  static const struct {
    TetcastIntegrator integrator;
    const int *ladder;
    int fixed; /* in the study of stiffness */
  } others[] = {{TETCAST_INTEGRATOR_MIDPOINT, powers, 8},
                {TETCAST_INTEGRATOR_TRAPEZOID, powers, 8},
                {TETCAST_INTEGRATOR_GAUSS, nodes, 4},
                {TETCAST_INTEGRATOR_TABLE, sides, 256}};
  const int repeats = (int)converge->options.repeat, first = converge->count;
  bool packets;
  const TetcastStatus status = find_packets(converge, &packets);
  if (status != TETCAST_OK)
    return cli_failed(status);
  ConvergeRow exact = {.study = STUDY_TIME, .repeats = repeats, .scale = 1};
  plan_exact(converge, exact);
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    for (const int *n = others[i].ladder; *n; n++) {
      ConvergeRow row = exact;
      row.integrator = others[i].integrator;
      row.n = *n;
      converge_plan(converge, row);
    }
  for (int digits = 1; digits <= 5; digits++) {
    ConvergeRow row = exact;
    row.adaptive = pow(10, -digits);
    converge_plan(converge, row);
  }
  exact.packets = true;
  if (packets)
    plan_exact(converge, exact);
  for (int exponent = -6; exponent <= 9; exponent++) {
    ConvergeRow row = {.study = STUDY_STIFFNESS, .repeats = 1, .scale = pow(10, exponent)};
    converge_plan(converge, row);
    row.tolerance = 1e-6;
    converge_plan(converge, row);
    row.tolerance = 0;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
      row.integrator = others[i].integrator;
      row.n = others[i].fixed;
      converge_plan(converge, row);
    }
  }
  for (int i = first; i < converge->count; i++)
    converge->work += converge->rows[i].repeats * weight(&converge->rows[i]);
  converge->work += check_weight(converge);
  return CLI_DONE;
}

/* What the studies share. */
typedef struct Pictures {
  TetcastFrame *frame;
  double *exact;
  int64_t width, height;
  TetcastTransferFunction *scaled; /* NULL: the scene's own */
} Pictures;

static const TetcastTransferFunction *current(const Converge *converge, const Pictures *pictures) {
  return pictures->scaled ? pictures->scaled : converge->stage.transfer_function;
}

/* The scene's transfer function with another extinction. */
static TetcastStatus scale_extinction(Converge *converge, double scale, TetcastTransferFunction **scaled) {
  const TetcastTransferFunction *own = converge->stage.transfer_function;
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = tetcast_transfer_function_color(own, &desc.color_count);
  const double *extinction = tetcast_transfer_function_extinction(own, &desc.extinction_count);
  const size_t size = sizeof(double) * 2 * (size_t)desc.extinction_count;
  double *rows = memcpy(cli_allocate(size), extinction, size);
  for (int64_t i = 0; i < desc.extinction_count; i++)
    rows[2 * i + 1] = fmin(rows[2 * i + 1] * scale, 1e300);
  desc.extinction = rows;
  tetcast_transfer_function_destroy(scaled);
  TetcastStatus status = tetcast_transfer_function_create(converge->context, &desc, scaled);
  free(rows);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(converge->stage.scene, *scaled);
  return status;
}

/* The pixel of ray number i. Three of four rays go through pixels that show something, chosen by steps of the golden
 * ratio among all such pixels; the fourth goes through any pixel. */
static int64_t pixel_of(int i, const int64_t *shown, int64_t shown_count, int64_t count) {
  const double at = fmod(0.5 + i * 0.6180339887498949, 1);
  return i % 4 == 3 || shown_count == 0 ? (int64_t)(at * (double)count) : shown[(int64_t)(at * (double)shown_count)];
}

/* Casts the rays of the check. Those that the reference can't decide are replaced, as long as there is hope for others.
 */
static TetcastStatus trace_reference(Converge *converge, const Pictures *pictures) {
  const Stage *stage = &converge->stage;
  const int64_t count = pictures->width * pictures->height;
  int64_t *shown = cli_allocate(sizeof *shown * (size_t)count), shown_count = 0;
  for (int64_t i = 0; i < count; i++)
    if (pictures->exact[4 * i + 3] > 0)
      shown[shown_count++] = i;
  const double affordable = CONVERGE_TESTS / (double)tetcast_mesh_tetrahedron_count(stage->mesh);
  const int rays = affordable < 8 ? 8 : affordable > CONVERGE_RAYS ? CONVERGE_RAYS : (int)affordable;
  converge->rays_wanted = rays;
  converge->rays = cli_allocate(sizeof *converge->rays * (size_t)rays);
  const TetcastProgress progress = converge_progress(converge, check_weight(converge));
  bool going = true;
  int clip_count;
  TetcastHalfSpace *clip = clip_half_spaces(&converge->options, &clip_count);
  converge->rays_blank = shown_count > 0;
  for (int i = 0; i < 4 * rays && converge->ray_count < rays && going; i++) {
    BruteRay *ray = &converge->rays[converge->ray_count];
    BruteLight light;
    brute_trace(ray, stage->mesh, stage->field, clip, clip_count, &stage->camera, pictures->width, pictures->height,
                pixel_of(i, shown, shown_count, count));
    brute_shade(ray, stage->transfer_function, &light);
    if (light.spread > CONVERGE_TRUST) {
      brute_release(ray);
      converge->rays_replaced++;
    } else {
      converge->ray_count++;
      converge->rays_beside += light.beside;
      converge->rays_blank = converge->rays_blank && !(light.high[3] > 0);
    }
    going = progress.function(progress.user, fmin(1, (double)converge->ray_count / rays));
  }
  free(shown);
  free(clip);
  return going ? TETCAST_OK : TETCAST_ERROR_CANCELLED;
}

/* The error of an exact picture is its difference to the brute-force reference, on the rays of the reference. */
static void check_exact(Converge *converge, const Pictures *pictures, ConvergeRow *row) {
  const double *pixels = tetcast_frame_pixels(pictures->frame);
  double largest = 0, squares = 0;
  int checked = 0;
  for (int i = 0; i < converge->ray_count; i++) {
    BruteLight light;
    brute_shade(&converge->rays[i], current(converge, pictures), &light);
    if (light.spread > CONVERGE_TRUST)
      continue;
    const double error = brute_error(&light, pixels + 4 * converge->rays[i].pixel);
    largest = fmax(largest, error);
    squares += error * error;
    checked++;
  }
  if (converge->ray_count - checked > converge->rays_undecided)
    converge->rays_undecided = converge->ray_count - checked;
  row->max_error = largest;
  row->rms_error = checked > 0 ? sqrt(squares / checked) : 0;
  if (row->study == STUDY_TIME)
    converge->check_max = fmax(converge->check_max, largest);
  else if (largest > converge->check_stiff) {
    converge->check_stiff = largest;
    converge->check_scale = row->scale;
  }
}

static double peak_of(const Pictures *pictures) {
  double peak = 0;
  for (int64_t i = 0; i < 4 * pictures->width * pictures->height; i++)
    peak = fmax(peak, pictures->exact[i]);
  return peak;
}

static TetcastStatus run_row(Converge *converge, Pictures *pictures, int number) {
  ConvergeRow *row = &converge->rows[number];
  TetcastStatus status = TETCAST_OK;
  const bool exact = row->integrator == TETCAST_INTEGRATOR_EXACT && row->tolerance == 0 && row->adaptive == 0;
  if (exact && row->study == STUDY_STIFFNESS)
    status = scale_extinction(converge, row->scale, &pictures->scaled);
  if (status == TETCAST_OK)
    status =
        converge_render(converge, converge->stage.scene, &converge->stage.camera, pictures->frame, row, weight(row));
  if (status != TETCAST_OK || row->timed > 1)
    return status;
  row->cells = converge->stage.info.tetrahedra;
  const double *pixels = tetcast_frame_pixels(pictures->frame);
  const int64_t count = 4 * pictures->width * pictures->height;
  if (exact) {
    if (!row->packets) /* a study's truth is one and the same for all of its rows */
      memcpy(pictures->exact, pixels, sizeof(double) * (size_t)count);
    row->peak = peak_of(pictures);
    if (!converge->rays) {
      status = trace_reference(converge, pictures);
      stage_drop_dataset(&converge->stage);
    }
    if (status == TETCAST_OK)
      check_exact(converge, pictures, row);
  } else {
    row->peak = converge->rows[number - 1].peak;
    converge_compare(row, pixels, pictures->exact, count);
  }
  return status;
}

int converge_run_scene(Converge *converge) {
  Pictures pictures = {.width = (int64_t)converge->options.size[0], .height = (int64_t)converge->options.size[1]};
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = pictures.width;
  desc.height = pictures.height;
  pictures.exact = cli_allocate(sizeof(double) * 4 * (size_t)(pictures.width * pictures.height));
  TetcastStatus status = tetcast_frame_create(converge->context, &desc, &pictures.frame);
  /* The repeats take turns, so that what else the machine does for a while does not fall on one integrator alone.
   * Before each turn a rendering that is not timed: memory is there, and caches hold the mesh. */
  for (int pass = 0; pass < (int)converge->options.repeat && status == TETCAST_OK; pass++) {
    status = tetcast_scene_render(converge->stage.scene, &converge->stage.camera, NULL, pictures.frame, NULL);
    for (int i = 0; i < converge->count && status == TETCAST_OK; i++)
      if (converge->rows[i].study == STUDY_TIME)
        status = run_row(converge, &pictures, i);
  }
  for (int i = 0; i < converge->count && status == TETCAST_OK; i++)
    if (converge->rows[i].study == STUDY_STIFFNESS)
      status = run_row(converge, &pictures, i);
  free(pictures.exact);
  tetcast_frame_destroy(&pictures.frame);
  tetcast_transfer_function_destroy(&pictures.scaled);
  if (status != TETCAST_OK)
    return cli_failed(status);
  if (converge->rays_blank)
    cli_warning("the exact picture could not be checked: all %d rays that were tried and show something run in faces "
                "between cells of different "
                "values, or along silhouettes",
                converge->rays_replaced);
  const double worst = fmax(converge->check_max, converge->check_stiff);
  if (!(worst <= CONVERGE_TRUST))
    cli_warning(
        "the exact picture and the brute-force reference differ by %.2g: errors in the report mean nothing below "
        "that; %s",
        worst,
        converge->stage.info.traversal == TETCAST_TRAVERSAL_SHELL
            ? "if the mesh's cells overlap, --traversal faces is right"
            : "please report this");
  return CLI_DONE;
}
