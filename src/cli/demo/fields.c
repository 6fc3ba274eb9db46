/* SPDX-License-Identifier: Apache-2.0 */
#include "fields.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "laplace.h"

static const double pi = 3.14159265358979323846;

/* What the formulas may need to know. */
typedef struct Setup {
  const double *parameters;
  double low[3], size[3]; /* bounds of the mesh */
  double inner, outer;    /* least and largest distance of a vertex from the origin */
} Setup;

/* g · x */
static double linear(const Setup *setup, const double x[3]) {
  const double *g = setup->parameters;
  return g[0] * x[0] + g[1] * x[1] + g[2] * x[2];
}

/* |x − c| */
static double radius(const Setup *setup, const double x[3]) {
  const double *c = setup->parameters;
  return hypot(hypot(x[0] - c[0], x[1] - c[1]), x[2] - c[2]);
}

/* splitmix64 (Steele, Lea, Flood 2014), as a number in [0, 1) */
static double random_number(uint64_t *state) {
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Σ aᵢ exp(−|x − cᵢ|² / 2w²), centres at random in the bounds, aᵢ in [½, 1), w in parts of their diagonal */
static double gaussians(const Setup *setup, const double x[3]) {
  const double diagonal = hypot(hypot(setup->size[0], setup->size[1]), setup->size[2]);
  const double width = setup->parameters[1] * diagonal;
  uint64_t state = (uint64_t)setup->parameters[2];
  double sum = 0;
  for (int i = 0; i < (int)setup->parameters[0]; i++) {
    double squares = 0;
    for (int j = 0; j < 3; j++) {
      const double d = (x[j] - setup->low[j] - setup->size[j] * random_number(&state)) / width;
      squares += d * d;
    }
    sum += (0.5 + 0.5 * random_number(&state)) * exp(-0.5 * squares);
  }
  return sum;
}

/* sin X cos Y + sin Y cos Z + sin Z cos X, X = 2πx/λ: Schoen's minimal surface where it is 0, nearly */
static double gyroid(const Setup *setup, const double x[3]) {
  const double largest = fmax(setup->size[0], fmax(setup->size[1], setup->size[2]));
  const double k = 2 * pi / (setup->parameters[0] > 0 ? setup->parameters[0] : largest / 3);
  return sin(k * x[0]) * cos(k * x[1]) + sin(k * x[1]) * cos(k * x[2]) + sin(k * x[2]) * cos(k * x[0]);
}

/* Real spherical harmonic, normalised over the sphere: P_lm(cos θ) cos mφ for m ≥ 0, … sin |m|φ for m < 0, without
 * the sign (−1)^m. P_lm by the recurrences in m and l. */
static double harmonic(int l, int m, const double x[3]) {
  const int order = abs(m);
  const double r = hypot(hypot(x[0], x[1]), x[2]);
  const double z = r > 0 ? x[2] / r : 1;
  const double s = r > 0 ? hypot(x[0], x[1]) / r : 0;
  double p = 1, before = 0;
  for (int i = 1; i <= order; i++)
    p *= (2 * i - 1) * s;
  for (int i = order + 1; i <= l; i++) {
    const double next = ((2 * i - 1) * z * p - (i + order - 1) * before) / (i - order);
    before = p;
    p = next;
  }
  const double angle = order * atan2(x[1], x[0]);
  const double norm = sqrt((2 * l + 1) / (4 * pi) * (m ? 2 : 1) * tgamma(l - order + 1) / tgamma(l + order + 1));
  return norm * p * (m < 0 ? sin(angle) : cos(angle));
}

/* ψ_nlm = √((2/na)³ (n−l−1)! / (2n (n+l)!)) e^(−ρ/2) ρ^l L_(n−l−1)^(2l+1)(ρ) Y_lm, ρ = 2r/na: the hydrogen atom's
 * orbitals in their real form (e.g. Griffiths, Introduction to Quantum Mechanics, § 4.2) */
static double orbital(const Setup *setup, const double x[3]) {
  const int n = (int)setup->parameters[0], l = (int)setup->parameters[1];
  const double scale = 2 / (n * setup->parameters[3]);
  const double rho = scale * hypot(hypot(x[0], x[1]), x[2]);
  double laguerre = 1, before = 0;
  for (int i = 1; i < n - l; i++) {
    const double next = ((2 * i + 2 * l - rho) * laguerre - (i + 2 * l) * before) / i;
    before = laguerre;
    laguerre = next;
  }
  const double norm = sqrt(scale * scale * scale * tgamma(n - l) / (2 * n * tgamma(n + l + 1)));
  return norm * exp(-rho / 2) * pow(rho, l) * laguerre * harmonic(l, (int)setup->parameters[2], x);
}

/* |ψ|² */
static double hydrogen(const Setup *setup, const double x[3]) {
  const double psi = orbital(setup, x);
  return psi * psi;
}

/* Heat conducted through a shell from 1 inside to 0 outside, and a convective pattern on it:
 * b (r − t) / (r (b − t)) + A Y_lm sin(π (r − b) / (t − b)), b and t the radii of the shell about the origin: where
 * models of the Earth's mantle start from (Zhong et al., Geochemistry Geophysics Geosystems 9, 2008) */
static double shell(const Setup *setup, const double x[3]) {
  const double b = setup->inner, t = setup->outer, r = hypot(hypot(x[0], x[1]), x[2]);
  if (!(b > 0 && t > b))
    return 0;
  const double pattern = harmonic((int)setup->parameters[0], (int)setup->parameters[1], x);
  return b * (r - t) / (r * (b - t)) + setup->parameters[2] * pattern * sin(pi * (r - b) / (t - b));
}

typedef struct Kind {
  const char *name, *form, *help;
  double (*value)(const Setup *setup, const double x[3]); /* NULL: laplace_solve(problem) */
  LaplaceProblem problem;
  int least, most; /* parameters */
  double defaults[FIELD_PARAMETERS];
} Kind;

static const Kind kinds[] = {
    {"linear", "[:gx,gy,gz]", "g . x; default 0,0,1", linear, 0, 3, 3, {0, 0, 1, 0}},
    {"radius", "[:cx,cy,cz]", "distance from a point; default 0,0,0", radius, 0, 3, 3, {0}},
    {"gaussians",
     "[:n,width,seed]",
     "n bells at random places; default 12,0.06,1",
     gaussians,
     0,
     1,
     3,
     {12, 0.06, 1, 0}},
    {"gyroid", "[:wavelength]", "default: a third of the body", gyroid, 0, 1, 1, {0}},
    {"hydrogen", ":n,l,m[,a]", "|psi|^2 of an orbital, Bohr radius a (1)", hydrogen, 0, 3, 4, {1, 0, 0, 1}},
    {"orbital", ":n,l,m[,a]", "psi itself, the real form", orbital, 0, 3, 4, {1, 0, 0, 1}},
    {"shell", ":l,m[,A]", "heat in a shell, pattern Y_lm by A (0.5)", shell, 0, 2, 3, {1, 0, 0.5, 0}},
    {"heat", "", "steady heat, cavities at 1, outside at 0", NULL, LAPLACE_HEAT, 0, 0, {0}},
    {"glow", "", "steady heat made inside, surface at 0", NULL, LAPLACE_GLOW, 0, 0, {0}},
    {"flow", "", "speed of a potential flow along x", NULL, LAPLACE_FLOW, 0, 0, {0}},
};

enum { KIND_COUNT = sizeof kinds / sizeof *kinds };

const char *field_name(int i) {
  return i >= 0 && i < KIND_COUNT ? kinds[i].name : NULL;
}

void field_print_help(void) {
  for (int i = 0; i < KIND_COUNT; i++)
    printf("          %s%-*s %s\n", kinds[i].name, (int)(25 - strlen(kinds[i].name)), kinds[i].form, kinds[i].help);
}

static bool whole_numbers(const double *numbers, int count) {
  for (int i = 0; i < count; i++)
    if (numbers[i] != floor(numbers[i]) || fabs(numbers[i]) > 1e6)
      return false;
  return true;
}

/* What is wrong with the parameters, NULL if nothing. */
static const char *check(const Kind *kind, const double p[FIELD_PARAMETERS]) {
  if (kind->value == gaussians &&
      !(whole_numbers(p, 1) && whole_numbers(p + 2, 1) && p[0] >= 1 && p[0] <= 1000 && p[1] > 0 && p[2] >= 0))
    return "expected n from 1 to 1000, width above 0, a whole number as seed";
  if (kind->value == gyroid && !(p[0] >= 0))
    return "expected a wavelength above 0";
  if ((kind->value == hydrogen || kind->value == orbital) &&
      !(whole_numbers(p, 3) && p[0] >= 1 && p[0] <= 20 && p[1] >= 0 && p[1] < p[0] && fabs(p[2]) <= p[1] && p[3] > 0))
    return "expected whole numbers n from 1 to 20, l from 0 to n - 1, m from -l to l, and a above 0";
  if (kind->value == shell && !(whole_numbers(p, 2) && p[0] >= 0 && p[0] <= 20 && fabs(p[1]) <= p[0]))
    return "expected whole numbers l from 0 to 20 and m from -l to l";
  return NULL;
}

int field_parse(const char *text, FieldSpec *spec) {
  const size_t length = strcspn(text, ":");
  int i = 0;
  while (i < KIND_COUNT && (strlen(kinds[i].name) != length || strncmp(kinds[i].name, text, length) != 0))
    i++;
  if (i == KIND_COUNT) {
    char *word = cli_print("%.*s", (int)length, text);
    CliGuess guess = {.word = word};
    for (int k = 0; k < KIND_COUNT; k++)
      cli_guess(&guess, kinds[k].name);
    char *hint = cli_guess_text(&guess);
    const int code = cli_usage_error("mesh", "--field %s: there is no such field%s", text, hint);
    free(hint);
    free(word);
    return code;
  }
  const Kind *kind = &kinds[i];
  *spec = (FieldSpec){.name = kind->name, .kind = i};
  memcpy(spec->parameters, kind->defaults, sizeof spec->parameters);
  const bool given = text[length] == ':';
  const int count = given ? cli_parse_numbers(text + length + 1, ',', kind->most, spec->parameters) : 0;
  const bool optional = kind->form[0] != ':';
  if (given ? count < kind->least || count == 0 : !optional)
    return cli_usage_error("mesh", "--field %s: expected %s%s", text, kind->name, kind->form);
  const char *reason = check(kind, spec->parameters);
  return reason ? cli_usage_error("mesh", "--field %s: %s", text, reason) : -1;
}

TetcastStatus field_compute(TetcastContext *context, const TetcastMesh *mesh, const FieldSpec *spec, double *values) {
  const Kind *kind = &kinds[spec->kind];
  if (!kind->value)
    return laplace_solve(context, mesh, kind->problem, values);
  double bounds[6];
  tetcast_mesh_bounds(mesh, bounds);
  Setup setup = {.parameters = spec->parameters, .inner = HUGE_VAL};
  for (int j = 0; j < 3; j++) {
    setup.low[j] = bounds[2 * j];
    setup.size[j] = bounds[2 * j + 1] - bounds[2 * j];
  }
  const int64_t count = tetcast_mesh_vertex_count(mesh);
  double x[3];
  for (int64_t i = 0; i < count; i++) {
    tetcast_mesh_vertex(mesh, i, x);
    const double r = hypot(hypot(x[0], x[1]), x[2]);
    setup.inner = fmin(setup.inner, r);
    setup.outer = fmax(setup.outer, r);
  }
  for (int64_t i = 0; i < count; i++) {
    tetcast_mesh_vertex(mesh, i, x);
    values[i] = kind->value(&setup, x);
  }
  return TETCAST_OK;
}
