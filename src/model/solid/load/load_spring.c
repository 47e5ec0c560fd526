/* Spring of one component of a node against the outside: U(y) with F = dU/dy, y = x - place. A
 * table is a monotone cubic through its points, and U its integral; beyond its ends it goes on
 * straight. */
#include "model/solid/load/loads.h"
#include "result/compare.h"

#include <math.h>
#include <string.h>

struct dea_spring {
  size_t node, component;
  double unit_m;          // displacement over this is x
  double now, goal;       // place of the outer end
  size_t count;           // of the table
  double *at, *force;     // [count] y, F
  double *slope, *energy; // [count] dF/dy; U from the first point
};

/* Slopes at the points, and U from 0 at the first one. */
static void fill_table(struct dea_spring *s)
{
  for (size_t i = 0; i < s->count; i++) {
    s->slope[i] = dea_interpolate_slope(s->at, s->force, s->count, i);
    if (i > 0) {
      double h = s->at[i] - s->at[i - 1];
      s->energy[i] = s->energy[i - 1] + h / 2 * (s->force[i - 1] + s->force[i]) +
                     h * h / 12 * (s->slope[i - 1] - s->slope[i]);
    }
  }
}

static dea_status check_options(struct dea_context *ctx, const struct dea_spring_options *options)
{
  if (options->component < 0 || options->component > 2 || !(options->unit_m >= 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a spring holds component 0, 1 or 2 of a node");
  }
  if (options->count == 0) {
    return options->stiffness >= 0
               ? DEA_OK
               : dea_fail(ctx, DEA_E_ARGUMENT, "the stiffness of a spring is 0 or more");
  }
  bool good = options->count > 1;
  for (size_t i = 0; i < options->count; i++) {
    good = good && isfinite(options->at[i]) && isfinite(options->force[i]) &&
           (i == 0 || options->at[i] > options->at[i - 1]);
  }
  return good ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "the table of a spring takes two points or more of rising displacement");
}

dea_status dea_spring_create(struct dea_context *ctx, const struct dea_spring_options *options,
                             struct dea_arena *memory, struct dea_spring **out)
{
  const double line[2] = {0, 1}, pull[2] = {0, options->stiffness};
  const bool table = options->count > 0;
  const size_t count = table ? options->count : 2;
  DEA_TRY(ctx, check_options(ctx, options));
  struct dea_spring *s = dea_arena_alloc(memory, 1, sizeof *s);
  double *at = dea_arena_alloc(memory, 4 * count, sizeof *at);
  DEA_TRY(ctx, dea_arena_status(memory));
  s->node = options->node;
  s->component = (size_t)options->component;
  s->unit_m = options->unit_m > 0 ? options->unit_m : 1;
  s->now = s->goal = options->place;
  s->count = count;
  s->at = at;
  s->force = at + count;
  s->slope = s->force + count;
  s->energy = s->slope + count;
  memcpy(s->at, table ? options->at : line, count * sizeof *s->at);
  memcpy(s->force, table ? options->force : pull, count * sizeof *s->force);
  fill_table(s);
  *out = s;
  return DEA_OK;
}

void dea_spring_move(struct dea_spring *spring, double place)
{
  spring->goal = place;
}

/* U, F and dF/dy at y. */
static void value_at(const struct dea_spring *s, double y, double out[3])
{
  size_t last = s->count - 1, i = 1;
  if (!(y > s->at[0]) || y >= s->at[last]) { // NAN too: u is checked by the elements
    size_t end = y >= s->at[last] ? last : 0;
    double past_end = y - s->at[end];
    out[0] = s->energy[end] + past_end * (s->force[end] + 0.5 * past_end * s->slope[end]);
    out[1] = s->force[end] + past_end * s->slope[end];
    out[2] = s->slope[end];
    return;
  }
  while (s->at[i] < y) {
    i++;
  }
  double h = s->at[i] - s->at[i - 1], x = (y - s->at[i - 1]) / h;
  double f = s->force[i - 1], rise = s->force[i] - f, m = h * s->slope[i - 1], n = h * s->slope[i];
  double two = 3 * rise - 2 * m - n, three = m + n - 2 * rise; // F = f + m x + two x^2 + three x^3
  out[0] = s->energy[i - 1] + h * x * (f + x * (m / 2 + x * (two / 3 + x * three / 4)));
  out[1] = f + x * (m + x * (two + x * three));
  out[2] = (m + x * (2 * two + x * 3 * three)) / h;
}

double dea_spring_force(const struct dea_spring *spring, double x)
{
  double value[3];
  value_at(spring, x - spring->now, value);
  return value[1];
}

static dea_status evaluate(const void *self, size_t piece, const double *u,
                           enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct dea_spring *s = self;
  double value[3];
  (void)piece;
  value_at(s, u[3 * s->node + s->component] / s->unit_m - s->now, value);
  out->node_count = 1;
  out->nodes[0] = (int)s->node;
  out->energy_J = value[0];
  memset(out->g, 0, 3 * sizeof *out->g);
  memset(out->K, 0, level >= DEA_TANGENT ? 9 * sizeof *out->K : 0);
  out->g[s->component] = value[1] / s->unit_m;
  if (level >= DEA_TANGENT) {
    out->K[4 * s->component] = value[2] / (s->unit_m * s->unit_m);
  }
  return DEA_OK;
}

struct dea_solid_load dea_spring_load(struct dea_spring *spring)
{
  return (struct dea_solid_load){.self = spring,
                                 .piece_count = 1,
                                 .evaluate = evaluate,
                                 .parameter_count = 1,
                                 .now = &spring->now,
                                 .goal = &spring->goal};
}
