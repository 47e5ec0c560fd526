#include "fabricate/tolerance_effect.h"

#include "device/geometry.h"
#include "fabricate/fab_plan.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { QUARTERS = 4 };

// Where a model stands ---------------------------------------------------------------------------

struct solver_state {
  const struct dea_model_type *type;
  const struct dea_design *design;
  const struct dea_device *device;
  struct dea_model *model;     // NULL: none
  struct dea_load_point point; // where it stands
};

/* Failures of a model are an answer; only want of memory and an interruption are not. */
static dea_status answer(struct dea_context *ctx, dea_status status, bool *there)
{
  *there = status == DEA_OK;
  if (status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

/* A new model at a voltage, if it comes to a state there that is to be trusted. */
static dea_status state_at(struct dea_context *ctx, struct solver_state *s, double voltage_V,
                           bool *there)
{
  s->type->destroy(ctx, s->model);
  s->model = NULL;
  dea_status status = dea_model_create(ctx, s->type, s->design, s->device, &s->model);
  status = status == DEA_OK ? s->type->solve(ctx, s->model, voltage_V, &s->point) : status;
  DEA_TRY(ctx, answer(ctx, status, there));
  *there = *there && dea_load_point_valid(&s->point);
  return DEA_OK;
}

/* Whether the film is taut at a voltage, if its tension goes on as from one point to the next: with
 * the square of the voltage. Of a model that does not support tension: yes. */
static bool stays_taut(const struct dea_load_point *from, const struct dea_load_point *to,
                       double voltage_V)
{
  const double a = from->voltage_V * from->voltage_V, b = to->voltage_V * to->voltage_V;
  const double slope = (to->min_tension_N_per_m - from->min_tension_N_per_m) / (b - a);
  const double next = to->min_tension_N_per_m + slope * (voltage_V * voltage_V - b);
  return !(to->min_tension_N_per_m < 0 || next < 0);
}

/* Goes up by quarters of the highest voltage. A quarter at which the film would be slack is not
 * asked for: it takes long, and its shape is one of several. */
static dea_status stand(struct dea_context *ctx, struct solver_state *s, double *voltage_V)
{
  const double highest = dea_design_highest_V(s->design);
  struct dea_load_point last, next;
  bool there = false;
  *voltage_V = NAN;
  if (!(highest > 0)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, state_at(ctx, s, 0, &there));
  last = s->point;
  for (int quarter = 1; quarter <= QUARTERS && there; quarter++) {
    const double voltage = highest * quarter / QUARTERS;
    if (quarter > 1 && !stays_taut(&last, &s->point, voltage)) {
      return DEA_OK;
    }
    last = s->point;
    DEA_TRY(ctx, answer(ctx, s->type->solve(ctx, s->model, voltage, &next), &there));
    there = there && dea_load_point_valid(&next);
    s->point = there ? next : s->point;
    *voltage_V = there ? voltage : *voltage_V;
  }
  if (!there && !isnan(*voltage_V)) { // it has gone too far
    DEA_TRY(ctx, state_at(ctx, s, *voltage_V, &there));
    *voltage_V = there ? *voltage_V : NAN;
  }
  return DEA_OK;
}

// What is asked ----------------------------------------------------------------------------------

/* A displacement of a disc without monitors that a model answers with. */
static const struct question {
  const char *model, *name, *motion, *column;
  bool fibres;
} questions[] = {
    {"3d", "fibre tip", "out of plane", "fibre_tip_z_m", true},
    {"lumped", "fibre tip", "out of plane", "fibre_tip_z_m", true},
    {"axisymmetric", "electrode edge", "outwards", "electrode_edge_u_m", false},
};

/* The ply that a key is of; DEA_LAYOUT_NONE. */
static size_t ply_of(const struct dea_layout *layout, const char *key)
{
  char start[DEA_NUMBER_KEY_SIZE];
  for (size_t i = 0; i < layout->ply_count; i++) {
    snprintf(start, sizeof start, "plies.%.80s.", layout->plies[i].name);
    if (strncmp(key, start, strlen(start)) == 0) {
      return i;
    }
  }
  return DEA_LAYOUT_NONE;
}

/* Numbers with a tolerance, and the row of those that are shown as one. */
static dea_status find_numbers(struct dea_context *ctx, const struct solver_state *s,
                               struct dea_tolerance_effects *out)
{
  const struct dea_layout *layout = s->device->layout;
  size_t count, kept = 0;
  DEA_TRY(ctx, dea_design_numbers(ctx, s->design, s->device, 0, false, out->number, &count));
  for (size_t i = 0; i < count; i++) {
    if (!(out->number[i].tolerance > 0)) {
      continue;
    }
    const char *key = out->number[i].key, *end = strrchr(key, '.');
    const size_t ply = ply_of(layout, key);
    const size_t like = ply == DEA_LAYOUT_NONE ? ply : dea_ply_like(layout, ply);
    out->first[kept] = kept;
    for (size_t k = 0; k < kept && like != ply; k++) {
      const char *other = strrchr(out->number[k].key, '.');
      if (ply_of(layout, out->number[k].key) == like && strcmp(other, end) == 0) {
        out->first[kept] = k;
      }
    }
    out->number[kept++] = out->number[i];
  }
  out->number_count = kept;
  return DEA_OK;
}

/* A longer fibre, and more overlap, has its tip nearer to the centre. */
static double sign_of(const char *key)
{
  return strcmp(key, "fibres.length") == 0 || strcmp(key, "fibres.overlap") == 0 ? -1 : 1;
}

/* By the gradient, of the column or, where that is < 0, of the monitors. */
static dea_status differentiate(struct dea_context *ctx, const struct solver_state *s, int column,
                                struct dea_tolerance_effects *out)
{
  static const size_t monitors[DEA_SEEN_MAX] = {0, 1, 2};
  double slopes[DEA_NUMBERS_MAX * DEA_SEEN_MAX];
  const size_t seen = out->seen_count;
  bool there;
  const struct dea_design_gradient ask = {.type = s->type,
                                          .model = s->model,
                                          .design = s->design,
                                          .device = s->device,
                                          .voltage_V = out->voltage_V,
                                          .numbers = out->number,
                                          .number_count = out->number_count,
                                          .columns = &column,
                                          .column_count = column >= 0 ? seen : 0,
                                          .monitors = monitors,
                                          .monitor_count = column >= 0 ? 0 : seen};
  DEA_TRY(ctx, answer(ctx, dea_design_gradient_find(ctx, &ask, slopes), &there));
  for (size_t i = 0; i < out->number_count * seen; i++) {
    const struct dea_design_number *number = &out->number[i / seen];
    out->effect[i / seen][i % seen] =
        there ? sign_of(number->key) * slopes[i] * number->tolerance : NAN;
  }
  return DEA_OK;
}

/* The displacement with the fibre tips farther from the centre; NAN: none. */
static dea_status solve_moved(struct dea_context *ctx, const struct solver_state *s, int column,
                              double by_m, double voltage_V, double *out)
{
  struct dea_device moved = *s->device;
  struct solver_state other = {.type = s->type, .design = s->design, .device = &moved};
  moved.fibre_tip_radius_m += by_m;
  moved.fibre_length_m -= by_m;
  moved.fibre_overlap_m -= by_m;
  bool there = false;
  if (moved.fibre_tip_radius_m > 0 && moved.fibre_length_m > 0) {
    const dea_status status = state_at(ctx, &other, voltage_V, &there);
    other.type->destroy(ctx, other.model);
    DEA_TRY(ctx, status);
  }
  *out = there ? dea_point_get(&other.point, column) : NAN;
  return DEA_OK;
}

/* Where fibre tips lie on the electrode's edge the gradient's mesh cannot follow them (nor is an
 * overlap of 0 a number): half of the difference from minus to plus. */
static dea_status move_tips(struct dea_context *ctx, const struct solver_state *s, int column,
                            struct dea_tolerance_effects *out)
{
  const double by_m =
      dea_length_stretched_m(&s->design->fabrication.tolerance.fibre, s->device->pre_stretch);
  double low = NAN, high = NAN;
  size_t at = 0;
  while (at < out->number_count && strncmp(out->number[at].key, "fibres.", 7) != 0) {
    at++;
  }
  if (!(by_m > 0) || (at < out->number_count && !isnan(out->effect[at][0])) ||
      at == DEA_NUMBERS_MAX) {
    return DEA_OK;
  }
  DEA_TRY(ctx, solve_moved(ctx, s, column, -by_m, out->voltage_V, &low));
  DEA_TRY(ctx, solve_moved(ctx, s, column, by_m, out->voltage_V, &high));
  if (at == out->number_count) {
    out->number[at] = (struct dea_design_number){
        .key = "fibres.tip_radius", .value = s->device->fibre_tip_radius_m, .unit = "m"};
    out->number[at].tolerance = by_m;
    out->first[at] = at;
    out->number_count++;
  }
  out->effect[at][0] = 0.5 * (high - low);
  return DEA_OK;
}

/* Where the monitors are. */
static dea_status observe_monitors(struct dea_context *ctx, const struct solver_state *s,
                                   struct dea_tolerance_effects *out)
{
  const struct dea_layout *layout = s->device->layout;
  struct dea_observation observed;
  DEA_TRY(ctx, dea_model_observe(ctx, s->type, s->model, &observed));
  for (size_t i = 0; i < layout->monitor_count && i < DEA_SEEN_MAX; i++) {
    const enum dea_observed motion = dea_observed_main(observed.monitor[i]);
    out->seen[out->seen_count++] =
        (struct dea_seen){layout->monitors[i].name, dea_observed_columns[motion].header,
                          motion <= DEA_OBSERVED_Z, observed.monitor[i][motion]};
  }
  return DEA_OK;
}

/* question: NULL: of monitors. */
static dea_status find(struct dea_context *ctx, struct solver_state *s,
                       const struct question *question, struct dea_tolerance_effects *out)
{
  const int column = question != NULL ? dea_point_column_find(question->column) : -1;
  out->model = s->type->name;
  DEA_TRY(ctx, stand(ctx, s, &out->voltage_V));
  if (isnan(out->voltage_V)) {
    return DEA_OK;
  }
  if (question != NULL) {
    out->seen[out->seen_count++] =
        (struct dea_seen){question->name, question->motion, true, dea_point_get(&s->point, column)};
  } else {
    DEA_TRY(ctx, observe_monitors(ctx, s, out));
  }
  DEA_TRY(ctx, differentiate(ctx, s, column, out));
  return question != NULL && question->fibres ? move_tips(ctx, s, column, out) : DEA_OK;
}

static dea_status solve_model(struct dea_context *ctx, struct solver_state s,
                              const struct question *question, struct dea_tolerance_effects *out)
{
  const size_t errors = dea_finding_trial_begin(ctx); // the sheet says what is to be said
  const dea_status status = find(ctx, &s, question, out);
  dea_finding_trial_end(ctx, errors);
  s.type->destroy(ctx, s.model);
  return status;
}

dea_status dea_tolerance_effects_find(struct dea_context *ctx, const struct dea_design *design,
                                      const struct dea_device *device, bool solve,
                                      struct dea_tolerance_effects *out)
{
  struct solver_state s = {.type = dea_model_find("3d"), .design = design, .device = device};
  *out = (struct dea_tolerance_effects){.model = s.type->name, .voltage_V = NAN};
  DEA_TRY(ctx, find_numbers(ctx, &s, out));
  if (!solve) {
    return DEA_OK;
  }
  if (device->layout->monitor_count > 0) {
    return DEA_CHAIN(ctx, solve_model(ctx, s, NULL, out));
  }
  for (size_t q = 0; device->disc && q < sizeof questions / sizeof questions[0]; q++) {
    if (questions[q].fibres == (device->fibre_count > 0) && isnan(out->voltage_V)) {
      s.type = dea_model_find(questions[q].model);
      DEA_TRY(ctx, solve_model(ctx, s, &questions[q], out));
    }
  }
  return DEA_OK;
}

const double *dea_tolerance_effect(const struct dea_tolerance_effects *effects, const char *key)
{
  for (size_t i = 0; i < effects->number_count; i++) {
    if (strncmp(effects->number[i].key, key, strlen(key)) == 0) {
      return effects->effect[i];
    }
  }
  return NULL;
}
