/* Gradients of quantities by the model's own (docs/theory/gradients.md). */
#include "explore/design_space.h"

#include "study/force.h"

#include <math.h>

static const double step = 1e-5; // of a number or of its range, to either side

/* Devices with numbers a little to either side. */
struct sides {
  struct dea_design *design[2 * DEA_CASE_PARAMS_MAX];
  struct dea_device *device[2 * DEA_CASE_PARAMS_MAX];
  struct dea_pressed pressed[2 * DEA_CASE_PARAMS_MAX]; // of each design
  struct dea_design_change changes[DEA_CASE_PARAMS_MAX];
  size_t variable[DEA_CASE_PARAMS_MAX]; // of each change
  size_t count;                         // of changes
};

/* What slopes are asked of, at one stop: columns of load points, then motions of monitors. */
struct wanted {
  size_t quantity[DEA_EXPLORE_QUANTITIES_MAX]; // of each
  int columns[DEA_EXPLORE_QUANTITIES_MAX];
  size_t monitors[DEA_EXPLORE_QUANTITIES_MAX];
  enum dea_observed motions[DEA_EXPLORE_QUANTITIES_MAX];
  size_t column_count, monitor_count;
};

/* Whether an objective or a limit is of a quantity. */
static bool is_wanted(const struct dea_design_space *space, size_t i)
{
  bool wanted = false;
  for (size_t k = 0; k < space->file->objective_count; k++) {
    wanted = wanted || space->objectives[k] == (int)i;
  }
  for (size_t l = 0; l < space->limit_count; l++) {
    wanted = wanted || space->limits[l].column == (int)i;
  }
  return wanted;
}

static struct wanted find_wanted(const struct dea_design_space *space, bool held)
{
  struct wanted out = {.column_count = 0};
  for (int of_monitors = 0; of_monitors < 2; of_monitors++) {
    for (size_t i = 0; i < space->quantity_count; i++) {
      const struct dea_explored *quantity = &space->quantities[i];
      if (!is_wanted(space, i) || dea_design_space_is_held(space, i) != held ||
          quantity->source == DEA_EXPLORED_CRITICAL ||
          (quantity->source == DEA_EXPLORED_MONITOR) != (of_monitors == 1) ||
          (of_monitors == 1 && quantity->of.source != DEA_OF_MONITOR)) {
        continue;
      }
      out.quantity[out.column_count + out.monitor_count] = i;
      if (of_monitors == 1) {
        out.monitors[out.monitor_count] = quantity->of.index;
        out.motions[out.monitor_count++] = (enum dea_observed)quantity->of.number;
      } else {
        out.columns[out.column_count++] = quantity->column;
      }
    }
  }
  return out;
}

/* The device with variable j moved by `by`. *device: NULL where it cannot be. */
static dea_status build(struct dea_context *ctx, const struct dea_design_space *space, size_t j,
                        double by, struct dea_design **design, struct dea_device **device)
{
  double p[DEA_CASE_PARAMS_MAX];
  for (size_t i = 0; i < space->variable_count; i++) {
    p[i] = space->now->p[i];
  }
  p[j] += by;
  const dea_status status = dea_device_params_build(ctx, &space->model.file, space->params,
                                                    space->variable_count, p, design, device);
  if (status == DEA_E_DESIGN) { // beyond what the key takes
    dea_context_clear(ctx);
    dea_device_destroy(ctx, *device);
    *device = NULL;
    return DEA_OK;
  }
  return status;
}

/* Adds the change of a variable: to both sides, or to the one where there is a device. */
static dea_status add_change(struct dea_context *ctx, const struct dea_design_space *space,
                             size_t j, const struct dea_device *device, double voltage_V,
                             struct sides *sides)
{
  const struct dea_variable *variable = &space->variables[j];
  const double size = fmax(fabs(space->now->p[j]), variable->high - variable->low);
  struct dea_design_change *change = &sides->changes[sides->count];
  *change = (struct dea_design_change){.voltage_V = {voltage_V, voltage_V}};
  for (size_t k = 0; k < 2; k++) {
    const size_t n = 2 * j + k;
    DEA_TRY(ctx, build(ctx, space, j, (k == 0 ? -step : step) * size, &sides->design[n],
                       &sides->device[n]));
    change->device[k] = sides->device[n] != NULL ? sides->device[n] : device;
    change->width += sides->device[n] != NULL ? step * size : 0;
    if (sides->device[n] != NULL) {
      sides->pressed[n] = (struct dea_pressed){dea_force_indenter(sides->design[n]),
                                               dea_force_first_depth_m(sides->design[n])};
      change->pressed[k] = &sides->pressed[n];
    }
  }
  if (change->width > 0) {
    sides->variable[sides->count++] = j;
  }
  return DEA_OK;
}

/* Keeps the slope of a quantity at the last voltage. */
static void set_slope(const struct dea_design_space *space, size_t quantity, size_t variable,
                      double slope)
{
  const size_t value = (space->voltage_count - 1) * space->quantity_count + quantity;
  space->now->q[space->evaluator.value_count + value * space->variable_count + variable] = slope;
}

static dea_status find(struct dea_context *ctx, const struct dea_design_space *space,
                       struct dea_model *model, const struct sides *sides, bool held)
{
  const struct wanted wanted = find_wanted(space, held);
  double slopes[DEA_CASE_PARAMS_MAX * DEA_EXPLORE_QUANTITIES_MAX];
  const size_t count = wanted.column_count + wanted.monitor_count;
  const struct dea_gradient_request ask = {.changes = sides->changes,
                                           .change_count = sides->count,
                                           .columns = wanted.columns,
                                           .column_count = wanted.column_count,
                                           .monitors = wanted.monitors,
                                           .monitor_count = wanted.monitor_count,
                                           .motions = wanted.motions};
  if (count == 0) {
    return DEA_OK;
  }
  const dea_status status = space->model.type->gradient(ctx, model, &ask, slopes);
  if (dea_status_ends(status)) {
    return status;
  }
  if (status != DEA_OK) { // none at this design
    dea_context_clear(ctx);
    return DEA_OK;
  }
  for (size_t c = 0; c < sides->count; c++) {
    for (size_t i = 0; i < count; i++) {
      set_slope(space, wanted.quantity[i], sides->variable[c], slopes[c * count + i]);
    }
  }
  return DEA_OK;
}

/* Slopes of critical voltages. */
static dea_status find_critical(struct dea_context *ctx, const struct dea_design_space *space,
                                const struct sides *sides)
{
  double slopes[DEA_CASE_PARAMS_MAX];
  for (size_t i = 0; i < space->quantity_count; i++) {
    if (space->quantities[i].source != DEA_EXPLORED_CRITICAL || !is_wanted(space, i)) {
      continue;
    }
    const dea_status status =
        dea_critical_slopes(ctx, &space->critical[i], sides->changes, sides->count, slopes);
    if (dea_status_ends(status)) {
      return status;
    }
    if (status != DEA_OK) { // none at this design
      dea_context_clear(ctx);
      continue;
    }
    for (size_t c = 0; c < sides->count; c++) {
      set_slope(space, i, sides->variable[c], slopes[c]);
    }
  }
  return DEA_OK;
}

static dea_status add_slopes(const struct dea_design_space *space, struct dea_model *model,
                             const struct dea_device *device, size_t stop)
{
  struct dea_context *ctx = space->model.ctx;
  const size_t last = space->voltage_count - 1;
  struct sides sides = {.count = 0};
  dea_status status = DEA_OK;
  if (stop != last && stop != space->voltage_count + last) {
    return DEA_OK;
  }
  for (size_t j = 0; j < space->variable_count && status == DEA_OK; j++) {
    if (space->variables[j].value_count == 0) {
      status = add_change(ctx, space, j, device, space->voltages_V[last], &sides);
    }
  }
  if (status == DEA_OK && sides.count > 0) {
    status = find(ctx, space, model, &sides, stop != last);
  }
  if (status == DEA_OK && sides.count > 0 && stop == last) {
    status = find_critical(ctx, space, &sides);
  }
  for (size_t n = 0; n < 2 * space->variable_count; n++) {
    dea_device_destroy(ctx, sides.device[n]);
    dea_design_destroy(ctx, sides.design[n]);
  }
  return status;
}

static dea_status evaluate(void *user, struct dea_context *ctx, struct dea_case *io)
{
  struct dea_design_space *space = user;
  space->now = io;
  space->add_slopes = add_slopes;
  const dea_status status = space->evaluator.evaluate(space, ctx, io);
  space->add_slopes = NULL;
  return status;
}

struct dea_evaluator dea_design_space_with_slopes(const struct dea_design_space *space)
{
  struct dea_evaluator out = space->evaluator;
  const int method = space->file->method.value;
  out.gradients = space->model.type->gradient != NULL &&
                  (method == DEA_SLSQP || method == DEA_MMA) &&
                  space->file->gradients.value == DEA_SLOPES_MODEL;
  if (out.gradients && dea_evaluator_values(&out) <= DEA_CASE_VALUES_MAX) {
    out.evaluate = evaluate;
  } else {
    out.gradients = false;
  }
  return out;
}
