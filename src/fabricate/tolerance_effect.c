#include "fabricate/tolerance_effect.h"

#include "device/geometry.h"
#include "result/columns.h"
#include "study/design_gradient.h"

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
  if (status == DEA_OK) {
    status = s->type->solve(ctx, s->model, voltage_V, &s->point);
  }
  DEA_TRY(ctx, answer(ctx, status, there));
  *there = *there && dea_load_point_trusted(&s->point);
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
    there = there && dea_load_point_trusted(&next);
    s->point = there ? next : s->point;
    *voltage_V = there ? voltage : *voltage_V;
  }
  if (!there && !isnan(*voltage_V)) { // it has gone too far
    DEA_TRY(ctx, state_at(ctx, s, *voltage_V, &there));
    *voltage_V = there ? *voltage_V : NAN;
  }
  return DEA_OK;
}

/* What is asked of a gradient there, but for the quantities. */
static struct dea_design_gradient ask_of(const struct solver_state *s, double voltage_V,
                                         const struct dea_design_number *numbers, size_t count)
{
  return (struct dea_design_gradient){.type = s->type,
                                      .model = s->model,
                                      .design = s->design,
                                      .device = s->device,
                                      .voltage_V = voltage_V,
                                      .numbers = numbers,
                                      .number_count = count};
}

// Discs ------------------------------------------------------------------------------------------

/* A displacement that a model answers with, of discs with or without fibres. */
static const struct question {
  const char *model, *what, *column;
  bool fibres;
} questions[] = {
    {"3d", "fibre tip, out of plane", "fibre_tip_z_m", true},
    {"lumped", "fibre tip, out of plane", "fibre_tip_z_m", true},
    {"axisymmetric", "electrode edge, outwards", "electrode_edge_u_m", false},
};

static enum dea_deviation deviation_of(const char *key)
{
  return strcmp(key, "film.thickness") == 0     ? DEA_DEVIATION_THICKNESS
         : strcmp(key, "pre_stretch") == 0      ? DEA_DEVIATION_PRE_STRETCH
         : strncmp(key, "electrodes.", 11) == 0 ? DEA_DEVIATION_ELECTRODE
         : strncmp(key, "frame.", 6) == 0       ? DEA_DEVIATION_FRAME
                                                : DEA_DEVIATION_FIBRE;
}

/* A longer fibre, and more overlap, has its tip nearer to the centre. */
static double sign_of(const char *key)
{
  return strcmp(key, "fibres.length") == 0 || strcmp(key, "fibres.overlap") == 0 ? -1 : 1;
}

/* By the gradient, for all numbers with a tolerance. */
static dea_status differentiate(struct dea_context *ctx, const struct solver_state *s, int column,
                                struct dea_sensitivity *out)
{
  struct dea_design_number all[DEA_NUMBERS_MAX], numbers[DEA_DEVIATION_COUNT];
  double slopes[DEA_DEVIATION_COUNT];
  size_t count, chosen = 0;
  bool there;
  DEA_TRY(ctx, dea_design_numbers(ctx, s->design, s->device, out->voltage_V, all, &count));
  for (size_t i = 0; i < count && chosen < DEA_DEVIATION_COUNT; i++) {
    if (all[i].tolerance > 0) {
      numbers[chosen++] = all[i];
    }
  }
  struct dea_design_gradient ask = ask_of(s, out->voltage_V, numbers, chosen);
  ask.columns = &column;
  ask.column_count = 1;
  DEA_TRY(ctx, answer(ctx, dea_design_gradient_find(ctx, &ask, slopes), &there));
  for (size_t i = 0; i < chosen && there; i++) {
    out->effect_m[deviation_of(numbers[i].key)] =
        sign_of(numbers[i].key) * slopes[i] * numbers[i].tolerance;
  }
  return DEA_OK;
}

/* The displacement with the fibre tips farther from the centre; NAN: none. */
static dea_status ask_moved(struct dea_context *ctx, const struct solver_state *s, int column,
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
                            struct dea_sensitivity *out)
{
  const double by_m =
      dea_length_stretched_m(&s->design->fabrication.tolerance.fibre, s->device->pre_stretch);
  double low = NAN, high = NAN;
  DEA_TRY(ctx, ask_moved(ctx, s, column, -by_m, out->voltage_V, &low));
  DEA_TRY(ctx, ask_moved(ctx, s, column, by_m, out->voltage_V, &high));
  out->effect_m[DEA_DEVIATION_FIBRE] = 0.5 * (high - low);
  return DEA_OK;
}

static dea_status find(struct dea_context *ctx, struct solver_state *s,
                       const struct question *question, struct dea_sensitivity *out)
{
  const int column = dea_point_column_find(question->column);
  *out = (struct dea_sensitivity){
      .model = question->model, .what = question->what, .displacement_m = NAN};
  for (int d = 0; d < DEA_DEVIATION_COUNT; d++) {
    out->effect_m[d] = NAN;
  }
  DEA_TRY(ctx, stand(ctx, s, &out->voltage_V));
  if (isnan(out->voltage_V)) {
    return DEA_OK;
  }
  out->displacement_m = dea_point_get(&s->point, column);
  DEA_TRY(ctx, differentiate(ctx, s, column, out));
  if (question->fibres && isnan(out->effect_m[DEA_DEVIATION_FIBRE])) {
    DEA_TRY(ctx, move_tips(ctx, s, column, out));
  }
  return DEA_OK;
}

dea_status dea_sensitivity_find(struct dea_context *ctx, const struct dea_design *design,
                                const struct dea_device *device, struct dea_sensitivity *out)
{
  bool found = false;
  for (size_t q = 0; q < sizeof questions / sizeof questions[0] && !found; q++) {
    if (questions[q].fibres != (device->fibre_count > 0)) {
      continue;
    }
    struct solver_state s = {
        .type = dea_model_find(questions[q].model), .design = design, .device = device};
    const size_t errors = dea_finding_trial_begin(ctx); // the sheet says what is to be said
    const dea_status status = find(ctx, &s, &questions[q], out);
    dea_finding_trial_end(ctx, errors);
    s.type->destroy(ctx, s.model);
    DEA_TRY(ctx, status);
    found = !isnan(out->voltage_V);
  }
  return DEA_OK;
}

// Devices of plies -------------------------------------------------------------------------------

/* A number of a ply and what its tolerance is. */
struct of_ply {
  size_t ply;
  enum dea_ply_deviation deviation;
};

/* Which number of which ply a key is. */
static bool find_ply(const struct dea_layout *layout, const char *key, struct of_ply *out)
{
  static const char *const names[][DEA_PLY_DEVIATIONS] = {{"thickness", "pre_stretch", ""},
                                                          {"", "pre_stretch[0]", "pre_stretch[1]"}};
  char own[DEA_NUMBER_KEY_SIZE];
  for (size_t i = 0; i < layout->ply_count; i++) {
    for (size_t k = 0; k < 2 * DEA_PLY_DEVIATIONS; k++) {
      const size_t d = k % DEA_PLY_DEVIATIONS;
      snprintf(own, sizeof own, "plies.%.80s.%s", layout->plies[i].name,
               names[k / DEA_PLY_DEVIATIONS][d]);
      if (strcmp(own, key) == 0) {
        *out = (struct of_ply){i, (enum dea_ply_deviation)d};
        return true;
      }
    }
  }
  return false;
}

static dea_status differentiate_plies(struct dea_context *ctx, const struct solver_state *s,
                                      struct dea_layout_sensitivity *out)
{
  struct dea_design_number all[DEA_NUMBERS_MAX], numbers[DEA_NUMBERS_MAX];
  struct of_ply places[DEA_NUMBERS_MAX];
  double slopes[DEA_NUMBERS_MAX * DEA_SEEN_MAX];
  const size_t monitors[DEA_SEEN_MAX] = {0, 1, 2};
  size_t count, chosen = 0;
  bool there;
  DEA_TRY(ctx, dea_design_numbers(ctx, s->design, s->device, out->voltage_V, all, &count));
  for (size_t i = 0; i < count; i++) {
    if (all[i].tolerance > 0 && find_ply(s->device->layout, all[i].key, &places[chosen])) {
      numbers[chosen++] = all[i];
    }
  }
  struct dea_design_gradient ask = ask_of(s, out->voltage_V, numbers, chosen);
  ask.monitors = monitors;
  ask.monitor_count = out->seen;
  DEA_TRY(ctx, answer(ctx, dea_design_gradient_find(ctx, &ask, slopes), &there));
  for (size_t i = 0; i < chosen * out->seen && there; i++) {
    const struct of_ply *place = &places[i / out->seen];
    out->effect[place->ply][place->deviation][i % out->seen] =
        slopes[i] * numbers[i / out->seen].tolerance;
  }
  return DEA_OK;
}

static dea_status find_layout(struct dea_context *ctx, struct solver_state *s,
                              struct dea_layout_sensitivity *out)
{
  struct dea_observation seen;
  const struct dea_layout *layout = s->device->layout;
  out->effect = dea_alloc(ctx, layout->ply_count, sizeof *out->effect);
  if (out->effect == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < layout->ply_count * DEA_PLY_DEVIATIONS * DEA_SEEN_MAX; i++) {
    (&out->effect[0][0][0])[i] = NAN;
  }
  out->seen = layout->monitor_count < DEA_SEEN_MAX ? layout->monitor_count : DEA_SEEN_MAX;
  out->voltage_V = NAN;
  if (out->seen == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, stand(ctx, s, &out->voltage_V));
  if (isnan(out->voltage_V)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_model_observe(ctx, s->type, s->model, &seen));
  for (size_t i = 0; i < out->seen; i++) {
    out->motion[i] = dea_observed_main(seen.monitor[i]);
    out->value[i] = seen.monitor[i][out->motion[i]];
  }
  DEA_TRY(ctx, differentiate_plies(ctx, s, out));
  return DEA_OK;
}

dea_status dea_layout_sensitivity_find(struct dea_context *ctx, const struct dea_design *design,
                                       const struct dea_device *device,
                                       struct dea_layout_sensitivity *out)
{
  struct solver_state s = {.type = dea_model_find("3d"), .design = design, .device = device};
  *out = (struct dea_layout_sensitivity){.seen = 0};
  const size_t errors = dea_finding_trial_begin(ctx);
  const dea_status status = find_layout(ctx, &s, out);
  dea_finding_trial_end(ctx, errors);
  s.type->destroy(ctx, s.model);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
