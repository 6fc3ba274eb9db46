/* SPDX-License-Identifier: Apache-2.0 */
#include "sight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "clip.h"

/* A pixel shows something from the first level of eight bits on, and is opaque from the last. */
static const double visible = 1.0 / 255, opaque = 254.5 / 255;
static const double degree = 3.14159265358979323846 / 180;

/* Small pictures of the scene, or of its mesh as uniform matter. */
typedef struct Probe {
  const Run *run;
  TetcastScene *uniform; /* the mesh without cells that touch a NaN; NULL: coefficients, which have a channel for it */
  double extinction;     /* the extinction of that matter */
  double size;           /* the diagonal of the mesh's bounds */
} Probe;

/* ── what the pixels say ── */

static void load_pixel(const TetcastFrame *frame, int64_t number, double rgba[4]) {
  const int64_t width = tetcast_frame_width(frame);
  const char *row = (const char *)tetcast_frame_pixels(frame) + number / width * tetcast_frame_row_stride(frame);
  const int64_t first = 4 * (number % width);
  for (int k = 0; k < 4; k++)
    rgba[k] = tetcast_frame_type(frame) == TETCAST_TYPE_FLOAT64 ? ((const double *)(const void *)row)[first + k]
                                                                : (double)((const float *)(const void *)row)[first + k];
}

typedef struct Look {
  double most_alpha, most_color;
  bool seen;        /* whether some pixel differs from the background */
  bool translucent; /* whether some pixel is neither empty nor opaque */
} Look;

/* Looks at pixels, from the middle on, until it is clear that the picture shows something. */
static Look look_at(const Run *run) {
  const TetcastFrame *frame = run->frame;
  const bool floating = render_options_floating(&run->options);
  const double *background = run->options.background, gain = render_options_gain(&run->options);
  const int64_t count = tetcast_frame_width(frame) * tetcast_frame_height(frame);
  Look look = {0};
  for (int64_t i = 0; i < count && !(look.seen && look.translucent); i++) {
    double rgba[4];
    load_pixel(frame, (count / 2 + i) % count, rgba);
    look.most_alpha = fmax(look.most_alpha, rgba[3]);
    look.translucent = look.translucent || (rgba[3] >= visible && rgba[3] < opaque);
    double change = floating ? rgba[3] : rgba[3] * (1 - background[3]);
    for (int k = 0; k < 3; k++) {
      change = fmax(change, fabs(floating ? rgba[k] : rgba[k] * gain - rgba[3] * background[3] * background[k]));
      look.most_color = fmax(look.most_color, fabs(rgba[k]));
    }
    look.seen = look.seen || change >= visible || (rgba[3] >= visible && change >= visible / 2);
  }
  return look;
}

/* ── what small pictures say ── */

/* A scene that shows the mesh by this extinction everywhere, of all values that are finite. */
static TetcastScene *uniform_scene(const Run *run, double extinction) {
  static const double gray[4] = {0, 1, 1, 1};
  const double knot[2] = {0, extinction};
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = gray;
  desc.color_count = 1;
  desc.extinction = knot;
  desc.extinction_count = 1;
  TetcastContext *context = run->stage.context;
  TetcastTransferFunction *transfer_function = NULL;
  TetcastScene *scene = NULL;
  TetcastStatus status = tetcast_transfer_function_create(context, &desc, &transfer_function);
  if (status == TETCAST_OK)
    status = tetcast_scene_create(context, run->stage.volume, &scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_share_field(scene, run->stage.scene);
  if (status == TETCAST_OK)
    status = tetcast_scene_set_transfer_function(scene, transfer_function);
  if (status == TETCAST_OK)
    status = clip_scene(scene, &run->options);
  tetcast_transfer_function_destroy(&transfer_function);
  if (status != TETCAST_OK)
    tetcast_scene_destroy(&scene);
  return scene;
}

/* Renders a picture, whose rays may stop; the largest alpha in it, or path length in the mesh if `lengths` says so.
 * NaN: it failed. */
static double largest_before(const Run *run, const TetcastScene *scene, const TetcastCamera *camera, int64_t width,
                             int64_t height, bool lengths, const TetcastArray *stop) {
  TetcastFrameDesc desc = tetcast_frame_desc_default();
  desc.width = width;
  desc.height = height;
  desc.channels = lengths ? TETCAST_CHANNEL_PATH_LENGTH : 0;
  TetcastRenderDesc render = tetcast_render_desc_default();
  render.stop = stop;
  TetcastFrame *frame = NULL;
  TetcastStatus status = tetcast_frame_create(run->stage.context, &desc, &frame);
  if (status == TETCAST_OK)
    status = tetcast_scene_render(scene, camera, &render, frame, NULL);
  const double *values = NULL;
  if (status == TETCAST_OK)
    values = lengths ? tetcast_frame_channel(frame, TETCAST_CHANNEL_PATH_LENGTH) : tetcast_frame_pixels(frame);
  double largest = values ? 0 : (double)NAN;
  for (int64_t i = 0; values && i < width * height; i++)
    largest = fmax(largest, lengths ? values[i] : values[4 * i + 3]);
  tetcast_frame_destroy(&frame);
  return largest;
}

static double largest_of(const Run *run, const TetcastScene *scene, const TetcastCamera *camera, int64_t width,
                         int64_t height, bool lengths) {
  return largest_before(run, scene, camera, width, height, lengths, NULL);
}

/* Whether rays of the picture's camera, or another, meet anything, in a picture of the same shape with 256 pixels a
 * side at most. */
static bool meets(const Probe *probe, const TetcastScene *scene, const TetcastCamera *camera) {
  const double *size = probe->run->options.size, scale = fmax(1, fmax(size[0], size[1]) / 256);
  const int64_t width = (int64_t)fmax(1, round(size[0] / scale)), height = (int64_t)fmax(1, round(size[1] / scale));
  return largest_of(probe->run, scene, camera, width, height, !probe->uniform) > 0;
}

static const double *matter(const Run *run, int64_t *count) {
  return tetcast_transfer_function_extinction(run->stage.transfer_function, count);
}

/* The extinction at a value. */
static double extinction_at(const double *knots, int64_t count, double value) {
  int64_t after = 0;
  while (after < count && knots[2 * after] <= value)
    after++;
  const double *a = knots + 2 * (after > 0 ? after - 1 : 0), *b = knots + 2 * (after < count ? after : count - 1);
  return a == b || a[0] == b[0] ? a[1] : a[1] + (b[1] - a[1]) * ((value - a[0]) / (b[0] - a[0]));
}

/* The largest extinction that values from range[0] to range[1] have. */
static double largest_extinction(const Run *run, const double range[2]) {
  int64_t count;
  const double *knots = matter(run, &count);
  double largest = fmax(extinction_at(knots, count, range[0]), extinction_at(knots, count, range[1]));
  for (int64_t i = 0; i < count; i++)
    if (knots[2 * i] >= range[0] && knots[2 * i] <= range[1])
      largest = fmax(largest, knots[2 * i + 1]);
  return largest;
}

/* ── why nothing is seen ── */

/* The camera's own axes, of length 1, as camera.h states them. */
typedef struct Axes {
  double forward[3], right[3], up[3];
  double half; /* of the picture's height: at distance 1, or everywhere if it is orthographic */
} Axes;

static void normalize(double v[3]) {
  const double length = hypot(hypot(v[0], v[1]), v[2]);
  for (int k = 0; k < 3; k++)
    v[k] /= length;
}

static void cross(const double a[3], const double b[3], double product[3]) {
  for (int k = 0; k < 3; k++)
    product[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static Axes axes_of(const TetcastCamera *camera) {
  Axes axes;
  for (int k = 0; k < 3; k++)
    axes.forward[k] = camera->target[k] - camera->eye[k];
  normalize(axes.forward);
  cross(axes.forward, camera->up, axes.right);
  normalize(axes.right);
  cross(axes.right, axes.forward, axes.up);
  axes.half = camera->projection == TETCAST_PERSPECTIVE ? tan(camera->fovy / 2 * degree) : camera->height / 2;
  return axes;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const char between_rays[] =
    "the mesh falls between the rays of the pixels: it is too small, too thin, or too far away for them";

/* Tells where the mesh lies, as seen from a camera whose rays don't meet it. */
static const char *explain_camera(const Run *run) {
  const TetcastCamera *camera = &run->stage.camera;
  const double *bounds = run->stage.info.bounds, aspect = run->options.size[0] / run->options.size[1];
  const Axes axes = axes_of(camera);
  bool behind = true, past[4] = {true, true, true, true}; /* right, left, above, below the picture */
  for (int corner = 0; corner < 8; corner++) {
    double from[3];
    for (int k = 0; k < 3; k++)
      from[k] = bounds[2 * k + (corner >> k & 1)] - camera->eye[k];
    const double depth = dot(from, axes.forward),
                 half = axes.half * (camera->projection == TETCAST_PERSPECTIVE ? depth : 1);
    const double x = dot(from, axes.right), y = dot(from, axes.up);
    behind = behind && !(depth > 0);
    past[0] = past[0] && x > half * aspect;
    past[1] = past[1] && -x > half * aspect;
    past[2] = past[2] && y > half;
    past[3] = past[3] && -y > half;
  }
  if (behind)
    return "the mesh lies behind the camera, which looks away from it";
  if (past[0] || past[1] || past[2] || past[3])
    return "the camera looks past the mesh";
  return between_rays;
}

/* Where the transfer function has an extinction, in words; for free(). */
static char *explain_support(const Run *run) {
  int64_t count, first = 0, last;
  const double *knots = matter(run, &count);
  while (first < count && !(knots[2 * first + 1] > 0))
    first++;
  for (last = count - 1; last > first && !(knots[2 * last + 1] > 0);)
    last--;
  if (first == count)
    return cli_duplicate("it is 0 for every value");
  const double above = first > 0 ? knots[2 * first - 2] : 0, below = last + 1 < count ? knots[2 * last + 2] : 0;
  if (first > 0 && last + 1 < count)
    return cli_print("only values between %g and %g have one", above, below);
  return first > 0 ? cli_print("only values above %g have one", above)
                   : cli_print("only values below %g have one", below);
}

/* The scene with every extinction that is not 0 as large as that of the probe. */
static bool meets_matter(const Probe *probe) {
  const Run *run = probe->run;
  TetcastTransferFunctionDesc desc = tetcast_transfer_function_desc_default();
  desc.color = tetcast_transfer_function_color(run->stage.transfer_function, &desc.color_count);
  const double *knots = matter(run, &desc.extinction_count);
  double *scaled = cli_allocate(sizeof *scaled * 2 * (size_t)desc.extinction_count);
  for (int64_t i = 0; i < desc.extinction_count; i++) {
    scaled[2 * i] = knots[2 * i];
    scaled[2 * i + 1] = knots[2 * i + 1] > 0 ? probe->extinction : 0;
  }
  desc.extinction = scaled;
  TetcastTransferFunction *transfer_function = NULL;
  bool result = true;
  if (tetcast_transfer_function_create(run->stage.context, &desc, &transfer_function) == TETCAST_OK &&
      tetcast_scene_set_transfer_function(probe->uniform, transfer_function) == TETCAST_OK)
    result = meets(probe, probe->uniform, &run->stage.camera);
  tetcast_transfer_function_destroy(&transfer_function);
  free(scaled);
  return result;
}

/* Whether there would be something to see without the clip. */
static bool is_clipped_away(const Probe *probe, TetcastScene *scene) {
  const RenderOptions *options = &probe->run->options;
  if (!render_options_given(options, OPTION_CLIP) && !render_options_given(options, OPTION_CLIP_BOX))
    return false;
  bool result = tetcast_scene_set_clip(scene, NULL, 0) == TETCAST_OK && meets(probe, scene, &probe->run->stage.camera);
  return clip_scene(scene, options) == TETCAST_OK && result;
}

/* Whether all rays stop before they meet anything. */
static bool is_stopped(const Probe *probe, const TetcastScene *scene) {
  const Run *run = probe->run;
  const TetcastArray stop = picture_stop(run);
  return run->stop && largest_before(run, scene, &run->stage.camera, (int64_t)run->options.size[0],
                                     (int64_t)run->options.size[1], !probe->uniform, &stop) == 0;
}

/* Why nothing is seen of parts over ranks, as far as one rank can tell alone, without small pictures. */
static char *explain_parts(const Run *run, const Look *look) {
  const char *camera = explain_camera(run);
  if (strcmp(camera, between_rays))
    return cli_duplicate(camera);
  return look->most_alpha > 0 ? cli_print("alpha is %.2g at most", look->most_alpha)
                              : cli_duplicate("no ray meets anything that has an extinction");
}

static char *explain_blank(const Probe *probe, const Look *look) {
  const Run *run = probe->run;
  const TetcastVolumeInfo *info = &run->stage.info;
  TetcastScene *scene = probe->uniform ? probe->uniform : run->stage.scene;
  const char *of = run->stage.array ? " of array " : "", *array = run->stage.array ? run->stage.array : "";
  if (!meets(probe, scene, &run->stage.camera)) {
    if (is_clipped_away(probe, scene))
      return cli_duplicate("the clip leaves nothing of what the camera sees");
    const TetcastCamera whole = tetcast_camera_default(info->bounds, run->options.size[0] / run->options.size[1]);
    if (run->stage.nonfinite > 0 && !meets(probe, scene, &whole))
      return cli_print("all cells are transparent, as they touch values%s%s that are NaN or infinite", of, array);
    return cli_duplicate(explain_camera(run));
  }
  if (is_stopped(probe, scene))
    return cli_duplicate("what is there lies beyond the depths of --stop-depth");
  if (!probe->uniform)
    return cli_print(
        "what the camera sees has no extinction and no emission to speak of: alpha is %.2g at most, radiance %.2g",
        look->most_alpha, look->most_color);
  if (look->most_alpha >= visible)
    return cli_duplicate("what is there has the colours of the background");
  if (render_options_blend(&run->options) != TETCAST_BLEND_COMPOSITE)
    return cli_duplicate("what the camera sees is too small for these pixels");
  if (render_options_surfaces_alone(&run->options))
    return cli_duplicate("no surface lies in what the camera sees, or all of them are transparent");
  const double extinction = largest_extinction(run, run->stage.range);
  if (!(extinction > 0)) {
    char *support = explain_support(run);
    char *text = cli_print("the extinction is 0 for all values%s%s, which go from %g to %g; %s", of, array,
                           run->stage.range[0], run->stage.range[1], support);
    free(support);
    return text;
  }
  if (!meets_matter(probe))
    return cli_duplicate("no value that the camera sees has an extinction");
  return cli_print("alpha is %.2g at most: the extinction, up to %.3g per unit of length, is too small for a mesh that "
                   "measures %.3g, or "
                   "the unit_distance of the opacity is too large",
                   look->most_alpha, extinction, probe->size);
}

/* ── walls ── */

/* The ray through the middle of a pixel, as camera.h states it. */
static void pixel_ray(const Run *run, int64_t number, double origin[3], double direction[3]) {
  const TetcastCamera *camera = &run->stage.camera;
  const double *size = run->options.size;
  const Axes axes = axes_of(camera);
  const bool perspective = camera->projection == TETCAST_PERSPECTIVE;
  const int64_t width = (int64_t)size[0];
  const double x = (2 * ((double)(number % width) + 0.5) / size[0] - 1) * size[0] / size[1] * axes.half;
  const double y = (1 - 2 * ((double)(number / width) + 0.5) / size[1]) * axes.half;
  for (int k = 0; k < 3; k++) {
    const double offset = x * axes.right[k] + y * axes.up[k];
    origin[k] = camera->eye[k] + (perspective ? 0 : offset);
    direction[k] = axes.forward[k] + (perspective ? offset : 0);
  }
  normalize(direction);
}

/* What one ray sees that starts `along` an axis from an origin and looks ahead (1) or back (-1): its path in the mesh,
 * or its alpha in the scene. */
static double cast(const Probe *probe, const double origin[3], const double direction[3], double along, int sense,
                   bool path) {
  TetcastCamera camera = {.projection = TETCAST_PERSPECTIVE, .fovy = 1};
  int least = 0;
  double reach = probe->size; /* far enough for the direction not to be rounded */
  for (int k = 0; k < 3; k++)
    reach = fmax(reach, fabs(origin[k]) + along);
  for (int k = 0; k < 3; k++) {
    camera.eye[k] = origin[k] + along * direction[k];
    camera.target[k] = camera.eye[k] + sense * reach * direction[k];
    if (fabs(direction[k]) < fabs(direction[least]))
      least = k;
  }
  camera.up[least] = 1;
  const TetcastScene *scene = probe->run->stage.scene;
  if (!path)
    return largest_of(probe->run, scene, &camera, 1, 1, false);
  if (!probe->uniform)
    return largest_of(probe->run, scene, &camera, 1, 1, true);
  return -log1p(-largest_of(probe->run, probe->uniform, &camera, 1, 1, false)) / probe->extinction;
}

/* Whether a pixel is opaque within the first hundredth of its ray's path through the mesh. */
static bool is_walled(const Probe *probe, int64_t pixel) {
  double origin[3], direction[3], far = probe->size;
  pixel_ray(probe->run, pixel, origin, direction);
  for (int k = 0; k < 3; k++)
    far = fmax(far, 4 * fmax(fabs(probe->run->stage.info.bounds[2 * k] - origin[k]),
                             fabs(probe->run->stage.info.bounds[2 * k + 1] - origin[k])));
  const double whole = cast(probe, origin, direction, 0, 1, true);
  if (!(whole > 0) || cast(probe, origin, direction, 0, -1, true) > 0) /* the eye is inside: nothing is before it */
    return false;
  double near = 0;
  for (int i = 0; i < 50; i++) {
    const double middle = (near + far) / 2;
    if (cast(probe, origin, direction, middle, 1, true) > 0.99 * whole)
      near = middle;
    else
      far = middle;
  }
  return cast(probe, origin, direction, near, -1, false) >= opaque;
}

/* Whether of the pixels that are covered, all of which are opaque, so many as are looked at are so by their outermost
 * layer. */
static bool is_wall(const Probe *probe) {
  enum { LOOKS = 9 };
  const TetcastFrame *frame = probe->run->frame;
  const int64_t count = tetcast_frame_width(frame) * tetcast_frame_height(frame);
  int64_t covered = 0;
  double rgba[4];
  for (int64_t i = 0; i < count; i++) {
    load_pixel(frame, i, rgba);
    covered += rgba[3] >= visible;
  }
  int64_t passed = 0, looked = 0;
  for (int64_t i = 0; i < count && looked < LOOKS; i++) {
    load_pixel(frame, i, rgba);
    if (!(rgba[3] >= visible) || passed++ != (2 * looked + 1) * covered / (2 * LOOKS))
      continue;
    looked++;
    if (!is_walled(probe, i))
      return false;
  }
  return looked > 0;
}

static char *explain_wall(const Run *run) {
  const char *text =
      "the picture is a wall: every pixel is opaque within the first hundredth of its way through the mesh";
  if (render_options_direct(&run->options))
    return cli_duplicate(text);
  return cli_print("%s; an extinction less than the present one, up to %.3g per unit of length, lets more be seen",
                   text, largest_extinction(run, run->stage.range));
}

char *sight_fault(const Run *run) {
  const Look look = look_at(run);
  const bool direct = render_options_direct(&run->options);
  const bool data = direct && render_options_floating(&run->options); /* which have a unit, and may be small or large */
  bool blank = !look.seen;
  if (direct) /* what is not 0 but too dark is told apart */
    blank = look.most_color == 0 && (data ? look.most_alpha == 0 : look.most_alpha < visible);
  const bool projected =
      render_options_blend(&run->options) != TETCAST_BLEND_COMPOSITE; /* in which nothing hides anything */
  const bool surfaces = render_options_surfaces(&run->options);       /* which may well be opaque */
  const bool solid = !data && !projected && !surfaces && look.seen && !look.translucent;
  const double *bounds = run->stage.info.bounds;
  if (run->stage.others) {
    char *reason = blank ? explain_parts(run, &look) : NULL;
    char *fault = reason ? cli_print("the picture shows nothing: %s", reason) : NULL;
    free(reason);
    return fault;
  }
  Probe probe = {.run = run};
  for (int k = 0; k < 3; k++)
    probe.size = hypot(probe.size, bounds[2 * k + 1] - bounds[2 * k]);
  if ((!blank && !solid) || !isfinite(probe.size))
    return NULL;
  probe.extinction = blank ? fmin(1e9 / probe.size, 1e300) : 1 / probe.size;
  if (!direct)
    probe.uniform = uniform_scene(run, probe.extinction);
  char *text = NULL;
  if (blank && (probe.uniform || direct)) {
    char *reason = explain_blank(&probe, &look);
    text = cli_print("the picture shows nothing: %s", reason);
    free(reason);
  } else if ((probe.uniform || direct) && is_wall(&probe)) {
    text = explain_wall(run);
  }
  tetcast_scene_destroy(&probe.uniform);
  return text;
}
