/* The emulator of a sparse grid: its file, and its values at designs between. */
#include "base/write_file.h"
#include "explore/explore_sweep.h"
#include "io/sparse_grid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An emulator and what it lends. */
struct work {
  const struct dea_design_space *space;
  struct dea_arena memory;
  struct dea_emulator emulator;
  char device[65];
};

/* The cases of a plan, which are all done, into *w. */
static dea_status gather(struct work *w, const struct dea_plan *plan)
{
  const struct dea_design_space *space = w->space;
  const size_t keys = space->variable_count, volts = space->voltage_count,
               each = space->evaluator.value_count;
  struct dea_emulator_key *of = dea_arena_alloc(&w->memory, keys, sizeof *of);
  const struct dea_column **columns =
      dea_arena_alloc(&w->memory, space->quantity_count, sizeof *columns);
  double *values = dea_arena_alloc(&w->memory, plan->count * each, sizeof *values);
  unsigned *flags = dea_arena_alloc(&w->memory, plan->count * volts, sizeof *flags);
  DEA_TRY(space->ctx, dea_arena_status(&w->memory));
  DEA_TRY(space->ctx, dea_emulator_device(space->ctx, space->design, space->device, w->device));
  for (size_t j = 0; j < keys; j++) {
    const struct dea_device_param *param = &space->params[j];
    of[j] = (struct dea_emulator_key){param->param.name, param->param.unit, space->variables[j].low,
                                      space->variables[j].high, param->designed};
  }
  for (size_t q = 0; q < space->quantity_count; q++) {
    columns[q] = &space->quantities[q].shown;
  }
  for (size_t c = 0; c < plan->count; c++) {
    memcpy(values + c * each, plan->cases[c]->q, each * sizeof *values);
    memcpy(flags + c * volts, plan->cases[c]->marks, volts * sizeof *flags);
  }
  w->emulator = (struct dea_emulator){.model = space->model.type->name,
                                      .device = w->device,
                                      .keys = of,
                                      .key_count = keys,
                                      .case_count = plan->count,
                                      .voltage_count = volts,
                                      .quantity_count = space->quantity_count,
                                      .level = (int)space->file->level.si,
                                      .nodes = plan->nodes,
                                      .voltages_V = space->voltages_V,
                                      .quantities = columns,
                                      .values = values,
                                      .flags = flags};
  return DEA_OK;
}

/* Shares of the ranges: the design's values, or those that are given. What is wrong with these
 * becomes findings. */
static dea_status find_shares(const struct work *w, const struct dea_sweep_options *options,
                              double *share)
{
  const struct dea_design_space *space = w->space;
  struct dea_context *ctx = space->ctx;
  const char *names[DEA_CASE_PARAMS_MAX];
  for (size_t j = 0; j < space->variable_count; j++) {
    share[j] = space->params[j].designed;
    names[j] = space->params[j].param.name;
  }
  for (size_t i = 0; i < options->at_count; i++) {
    struct dea_label label = {.location = {"--at", 0, 0}};
    size_t j = 0;
    while (j < space->variable_count && strcmp(names[j], options->at[i].key) != 0) {
      j++;
    }
    snprintf(label.text, sizeof label.text, "%s",
             j < space->variable_count ? options->at[i].value : options->at[i].key);
    DEA_TRY(ctx, j < space->variable_count
                     ? dea_device_param_number(ctx, &space->params[j], &label, &share[j])
                     : dea_explore_unknown(ctx, &label, "variable", names, space->variable_count));
  }
  if (dea_finding_count(ctx, DEA_ERROR) > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "--at has errors");
  }
  for (size_t j = 0; j < space->variable_count; j++) {
    const struct dea_variable *of = &space->variables[j];
    char text[3][80];
    if (!(share[j] >= of->low && share[j] <= of->high)) {
      dea_device_param_show(&space->params[j], share[j], text[0]);
      dea_device_param_show(&space->params[j], of->low, text[1]);
      dea_device_param_show(&space->params[j], of->high, text[2]);
      return dea_fail(ctx, DEA_E_DESIGN, "%s: %s is outside the range that was computed, %s to %s",
                      names[j], text[0], text[1], text[2]);
    }
    share[j] = (share[j] - of->low) / (of->high - of->low);
  }
  return DEA_OK;
}

static dea_status add_rows(struct work *w, const double *share, struct dea_text *out)
{
  const struct dea_emulator *e = &w->emulator;
  const size_t numbers = e->voltage_count * e->quantity_count;
  double *values = dea_arena_alloc(&w->memory, numbers, sizeof *values),
         *errors = dea_arena_alloc(&w->memory, numbers, sizeof *errors);
  unsigned *flags = dea_arena_alloc(&w->memory, e->voltage_count, sizeof *flags);
  char words[DEA_FLAGS_SIZE];
  DEA_TRY(w->space->ctx, dea_arena_status(&w->memory));
  DEA_TRY(w->space->ctx, dea_emulator_at(w->space->ctx, e, share, e->voltages_V, e->voltage_count,
                                         values, errors, flags));
  dea_text_add(out, "voltage_V (V)");
  for (size_t q = 0; q < e->quantity_count; q++) {
    const struct dea_column *of = e->quantities[q];
    dea_text_add(out, ",%s (%s),error (%s)", of->key, of->si_unit, of->si_unit);
  }
  dea_text_add(out, ",flags\n");
  for (size_t k = 0; k < e->voltage_count; k++) {
    dea_text_add(out, "%.12g", e->voltages_V[k]);
    for (size_t i = k * e->quantity_count; i < (k + 1) * e->quantity_count; i++) {
      dea_text_add(out, isnan(values[i]) ? ",," : ",%.15g,%.3g", values[i], errors[i]);
    }
    dea_text_add(out, ",%s\n", dea_flags_text(flags[k], words));
  }
  return DEA_OK;
}

static dea_status emulate(struct work *w, const struct dea_sweep_options *options, char **at)
{
  struct dea_context *ctx = w->space->ctx;
  struct dea_text out = {.ctx = ctx};
  double share[DEA_CASE_PARAMS_MAX];
  char *json;
  DEA_TRY(ctx, dea_json_text(ctx, dea_emulator_json(&w->emulator), &json));
  dea_status status = dea_text_file_write(ctx, options->folder, "emulator.json", json);
  dea_free(ctx, json);
  if (status == DEA_OK && options->at_count > 0) {
    status = find_shares(w, options, share);
    status = status == DEA_OK ? add_rows(w, share, &out) : status;
    status = status == DEA_OK && out.failed ? DEA_E_MEMORY : status;
    *at = status == DEA_OK ? dea_copy_text(ctx, dea_text_get(&out), out.length) : NULL;
    dea_text_free(&out);
  }
  return status;
}

dea_status dea_sweep_emulate(const struct dea_design_space *space, const struct dea_plan *plan,
                             const struct dea_sweep_options *options, char **at)
{
  struct dea_context *ctx = space->ctx;
  struct work w = {.space = space, .memory = {.ctx = ctx}};
  dea_status status = gather(&w, plan);
  if (status == DEA_OK) {
    status = dea_emulator_build(ctx, &w.emulator);
    status = status == DEA_OK ? emulate(&w, options, at) : status;
    dea_emulator_free(ctx, &w.emulator);
  }
  dea_arena_free(&w.memory);
  return status;
}
