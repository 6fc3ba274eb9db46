/* SPDX-License-Identifier: Apache-2.0 */
/* Error against run time: what is measured, row by row. */
#ifndef TETCAST_CLI_CONVERGE_H
#define TETCAST_CLI_CONVERGE_H

#include "brute.h"
#include "render_options.h"
#include "stage.h"

typedef enum ConvergeStudy {
  STUDY_TIME,       /* the scene as it is */
  STUDY_STIFFNESS,  /* its extinction scaled */
  STUDY_REFINE,     /* an analytic field on finer and finer meshes: all of the error */
  STUDY_INTEGRATION /* the same meshes: the error against the exact integral on that mesh */
} ConvergeStudy;

/* One rendering, planned and then filled in. */
typedef struct ConvergeRow {
  ConvergeStudy study;
  TetcastIntegrator integrator;
  int n;            /* samples per segment, nodes, or table entries a side; 0: exact */
  double tolerance; /* 0: none */
  double adaptive;  /* the epsilon of a picture by few rays; 0: by all */
  double scale;     /* of the extinction */
  int level;        /* refinement: cells along an edge of the cube; 0: not of a mesh of that kind */
  bool packets;     /* in STUDY_TIME, in which the other rows are held to the scalar kernel, to be fair */

  const char *precision, *isa; /* of the kernel that ran */
  int64_t cells, segments;
  int repeats, timed; /* renderings planned, and done so far */
  double *times;      /* [repeats], in order */
  double seconds;     /* their median */
  double max_error, rms_error;
  double bound; /* on the error, as the library states it; NaN: it does not */
  double peak;  /* largest value of any channel in the exact picture */
} ConvergeRow;

typedef struct Converge {
  RenderOptions options;
  char *command; /* as it was called */
  bool scene_studies, refine_study;
  Stage stage;
  TetcastContext *context; /* of the stage or of the refinement study alone */
  ConvergeRow *rows;
  int count, capacity;

  BruteRay *rays; /* [ray_count], of the brute-force reference; NULL: not cast yet */
  int ray_count;
  int rays_wanted;      /* how many rays there were to be */
  bool rays_blank;      /* whether none of them shows anything, though the picture does */
  int rays_beside;      /* how many rays ran in faces or along edges, and were decided by rays beside them */
  int rays_replaced;    /* how many rays could not be decided, and were replaced by others */
  int rays_undecided;   /* how many rays could not be decided with a scaled extinction; the most of any scale */
  double check_max;     /* the largest error of the exact pictures against the brute-force reference, over its rays */
  double check_stiff;   /* the same over all scaled extinctions */
  double check_scale;   /* the scale at which check_stiff was found */
  double analytic_step; /* the last change of the analytic reference when its steps were halved */
  int64_t lost;         /* the number of lost rays, over all renderings */

  double work, done, step; /* for the progress bar: all of the work, that before the current step, that of the step */
} Converge;

enum {
  CONVERGE_RAYS = 64,         /* the most rays that are checked by brute force */
  CONVERGE_REFINE_WIDTH = 96, /* the picture of the refinement study */
  CONVERGE_REFINE_HEIGHT = 72
};

/* The most tests of a ray against a cell for which the brute-force reference is cast. With larger meshes it has fewer
 * rays, but always eight. */
#define CONVERGE_TESTS 4e7

/* If the light of rays beside a ray differs by more than this, the ray is undecided. Differences to the brute-force
 * reference that are larger than this are reported as faults. */
#define CONVERGE_TRUST 1e-9

/* Appends a row to the plan. */
ConvergeRow *converge_plan(Converge *converge, ConvergeRow row);

/* Plan the renderings of a study; the sum of their weights goes to converge->work. The first returns an exit code: it
 * has to find out which kernel the scene runs in. */
int converge_plan_scene(Converge *converge);
void converge_plan_refine(Converge *converge);

/* Perform what was planned; exit codes. */
int converge_run_scene(Converge *converge);
int converge_run_refine(Converge *converge);

/* Renders a row's picture into `frame` once more, a step of work of this weight, and notes time, segments and bound. */
TetcastStatus converge_render(Converge *converge, const TetcastScene *scene, const TetcastCamera *camera,
                              TetcastFrame *frame, ConvergeRow *row, double weight);

/* Starts a step of the work of this weight; the callback shows how far all of it is. */
TetcastProgress converge_progress(Converge *converge, double weight);

/* Sets max_error and rms_error from two pictures of `count` values; infinity if any is not finite. */
void converge_compare(ConvergeRow *row, const double *picture, const double *truth, int64_t count);

/* "midpoint", "tolerance", …: what a row's curve is called. */
const char *converge_name(const ConvergeRow *row);

/* The exact row by packets of STUDY_TIME; NULL: the scene runs in the scalar kernel alone. */
const ConvergeRow *converge_packets(const Converge *converge);

/* The least-squares slope of log max_error (or rms_error) over log n of a curve of STUDY_TIME, or over log mesh size of
 * a curve of the other two; NaN where fewer than two points are clear of rounding. */
double converge_slope(const Converge *converge, ConvergeStudy study, TetcastIntegrator integrator, bool rms);

/* Writes the data, and the scripts that draw them, into the folder. False after a message. */
bool converge_write_csv(const Converge *converge, const char *folder);
bool converge_write_report(const Converge *converge, const char *folder);
bool converge_write_plots(const Converge *converge, const char *folder);

/* Draws the plots in the folder by gnuplot. */
bool converge_draw_plots(const Converge *converge, const char *folder);

#endif
