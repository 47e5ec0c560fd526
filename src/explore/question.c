#include "explore/question.h"

#include "base/file.h"
#include "base/text.h"
#include "base/write_file.h"
#include "device/identity.h"
#include "explore/from_fit.h"
#include "result/columns.h"
#include "result/provenance.h"
#include "study/design_file.h"
#include "study/observe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Identity ----------------------------------------------------------------------------------------

/* All that the device depends on, and with which model at which voltages it is computed from where.
 */
static void resolve(const struct dea_question *question, const struct dea_design *design,
                    const struct dea_device *device, struct dea_text *out)
{
  dea_device_identity(design, device, NULL, out);
  dea_text_add(out, "model=%s\nbegin=%d\n", question->model.type->name,
               question->file->begin.value);
  for (size_t k = 0; k < question->voltage_count; k++) {
    dea_text_add(out, "%.12g V\n", question->voltages_V[k]);
  }
}

static dea_status take_id(void *user, const struct dea_design *design,
                          const struct dea_device *device)
{
  struct dea_question *question = user;
  struct dea_text text = {.ctx = question->model.ctx};
  char hash[65];
  for (size_t k = 0; k < question->voltage_count; k++) { // those of another device
    for (size_t i = 0; i < question->quantity_count; i++) {
      question->seen[k][i] = NAN;
    }
  }
  resolve(question, design, device, &text);
  dea_sha256_hex(dea_text_get(&text), text.length, hash);
  snprintf(question->id, sizeof question->id, "%.16s", hash);
  const bool failed = text.failed;
  dea_text_free(&text);
  return failed ? DEA_E_MEMORY : DEA_OK;
}

/* Hash of the design as it is, of the variables and of what is kept of a case. */
static dea_status take_hash(struct dea_question *question)
{
  struct dea_text text = {.ctx = question->ctx};
  resolve(question, question->design, question->device, &text);
  for (size_t j = 0; j < question->variable_count; j++) {
    dea_text_add(&text, "variable %s%s", question->params[j].param.name, question->params[j].state);
    for (size_t k = 0; k < question->params[j].tie_count; k++) {
      dea_text_add(&text, " %s", question->params[j].ties[k].param.name);
    }
    dea_text_add(&text, "\n");
  }
  for (size_t i = 0; i < question->quantity_count; i++) {
    dea_text_add(&text, "quantity %s\n", question->quantities[i].key);
  }
  dea_sha256_hex(dea_text_get(&text), text.length, question->hash);
  dea_text_add(&text, "gradients\n");
  dea_sha256_hex(dea_text_get(&text), text.length, question->hash_slopes);
  const bool failed = text.failed;
  dea_text_free(&text);
  return failed ? DEA_E_MEMORY : DEA_OK;
}

// Evaluation --------------------------------------------------------------------------------------

/* What is wrong with a design that cannot be built. */
static void tell_design(struct dea_question *question, struct dea_context *ctx, struct dea_case *io)
{
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  size_t count;
  const struct dea_design_bytes file = {question->path, question->bytes, question->length};
  dea_finding_clear(ctx);
  dea_device_params_build(ctx, &file, question->params, question->variable_count, io->p, &design,
                          &device);
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = count; i-- > 0;) { // the first error
    if (findings[i].severity == DEA_ERROR) {
      snprintf(io->why, sizeof io->why, "%.*s", DEA_CASE_WHY_SIZE - 1, findings[i].text);
    }
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
}

static dea_status evaluate(void *user, struct dea_context *ctx, struct dea_case *io)
{
  struct dea_question *question = user;
  const size_t count = question->quantity_count;
  question->id[0] = question->model.why[0] = question->why[0] = '\0';
  question->model.ctx = ctx;
  dea_status status =
      io->has_near
          ? dea_device_model_sweep_from(&question->model, io->near, io->p, question->points)
          : dea_device_model_sweep(&question->model, io->p, question->points);
  snprintf(io->id, sizeof io->id, "%s", question->id);
  snprintf(io->why, sizeof io->why, "%.*s", DEA_CASE_WHY_SIZE - 1, question->model.why);
  if (status == DEA_E_UNSUPPORTED || status == DEA_E_ARGUMENT) { // of this design: a mesh
    snprintf(io->why, sizeof io->why, "%.*s", DEA_CASE_WHY_SIZE - 1, dea_context_message(ctx));
    dea_context_clear(ctx);
    return DEA_OK;
  }
  if (status == DEA_E_DOMAIN) {
    io->id[0] = '\0'; // not that of the design to begin from
    tell_design(question, ctx, io);
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  for (size_t k = 0; k < question->voltage_count; k++) {
    for (size_t g = 0; g < question->model.group_count; g++) {
      io->marks[k] |= dea_load_point_flags(&question->points[question->model.groups[g].first + k]);
    }
    for (size_t i = 0; i < count; i++) {
      const struct dea_load_point *point =
          &question
               ->points[question->model.groups[dea_question_is_held(question, i) ? 1 : 0].first +
                        k];
      double *q = &io->q[k * count + i];
      *q = !question->quantities[i].is_critical && !question->quantities[i].is_seen &&
                   !question->quantities[i].is_frequency
               ? dea_point_get(point, question->quantities[i].column)
               : question->seen[k][i];
      if (isnan(*q) && io->why[0] == '\0' && question->quantities[i].is_critical) {
        snprintf(io->why, sizeof io->why, "%s: %.120s", question->quantities[i].key, question->why);
      } else if (isnan(*q) && io->why[0] == '\0') {
        snprintf(io->why, sizeof io->why, "the model knows no %s of this design",
                 question->quantities[i].key);
      }
    }
  }
  return DEA_OK;
}

/* Critical voltages of a device, looked for up to four times the highest that is asked for. They do
 * not depend on the voltage: all stops have the same. */
static dea_status find_critical(struct dea_question *question,
                                const struct dea_model_settings *settings,
                                const struct dea_design *design, const struct dea_device *device)
{
  struct dea_context *ctx = question->model.ctx;
  const double last_V = question->voltages_V[question->voltage_count - 1],
               highest_V = fmax(last_V, dea_design_highest_V(design));
  for (size_t i = 0; i < question->quantity_count; i++) {
    const struct dea_explored *quantity = &question->quantities[i];
    const struct dea_critical_ask ask = {.type = question->model.type,
                                         .device = device,
                                         .settings = settings,
                                         .kind = quantity->event,
                                         .first_V = highest_V / 4,
                                         .highest_V = 4 * highest_V};
    if (!quantity->is_critical) {
      continue;
    }
    DEA_TRY(ctx, dea_critical_find(ctx, &ask, &question->critical[i]));
    if (isnan(question->critical[i].voltage_V)) {
      snprintf(question->why, sizeof question->why, "%s", question->critical[i].why);
    }
    for (size_t k = 0; k < question->voltage_count; k++) {
      question->seen[k][i] = question->critical[i].voltage_V;
    }
  }
  return DEA_OK;
}

/* Where the model knows none, the quantity stays unknown. */
static dea_status find_frequency(struct dea_question *question, struct dea_model *model,
                                 size_t stop, double *out)
{
  struct dea_context *ctx = question->model.ctx;
  const struct dea_load_point at = {.voltage_V = question->voltages_V[stop]};
  struct dea_load_point mode;
  struct dea_field_mesh *shapes;
  if (question->model.type->modes != NULL) {
    DEA_TRY(ctx, dea_model_modes(ctx, question->model.type, model, &at, 1, &mode, &shapes));
    dea_field_mesh_destroy(ctx, shapes);
    *out = mode.frequency_Hz;
  }
  return DEA_OK;
}

/* Keeps what monitors show at a stop, and the lowest frequency. */
static dea_status stand(void *user, struct dea_model *model, const struct dea_design *design,
                        const struct dea_device *device, size_t stop)
{
  struct dea_question *question = user;
  struct dea_context *ctx = question->model.ctx;
  struct dea_monitor_set set;
  struct dea_load_point seen = dea_load_point_empty();
  DEA_TRY(ctx, dea_monitor_set_init(ctx, question->model.type, device, &set));
  dea_status status = dea_monitor_set_read(ctx, &set, question->model.type, model, false, &seen);
  for (size_t i = 0; i < question->quantity_count && stop < question->voltage_count; i++) {
    const struct dea_explored *quantity = &question->quantities[i];
    if (quantity->is_seen) {
      question->seen[stop][i] = dea_point_get(&seen, quantity->column);
    } else if (quantity->is_frequency && status == DEA_OK) {
      status = find_frequency(question, model, stop, &question->seen[stop][i]);
    }
  }
  dea_monitor_set_free(&set);
  DEA_TRY(ctx, status);
  const struct dea_model_settings settings = dea_model_settings_of(design);
  status = stop + 1 == question->voltage_count ? find_critical(question, &settings, design, device)
                                               : DEA_OK;
  if (status == DEA_OK && question->stood != NULL) {
    status = question->stood(question, model, device, stop);
  }
  for (size_t i = 0; i < question->quantity_count; i++) {
    dea_critical_end(ctx, &question->critical[i]);
  }
  return status;
}

/* Groups of voltages: the film that moves freely, and where a force is asked for with a tip. */
static dea_status prepare_model(struct dea_question *question)
{
  struct dea_device_model *model = &question->model;
  const int force = dea_question_quantity(question, "force_N");
  const bool held = force >= 0 && model->type->indent != NULL;
  const size_t n = question->voltage_count, count = held ? 2 * n : n;
  model->ctx = question->ctx;
  model->name = question->path;
  model->bytes = question->bytes;
  model->length = question->length;
  model->params = question->params;
  model->param_count = question->variable_count;
  model->built = take_id;
  model->stood = stand;
  model->user = question;
  question->memory.ctx = question->ctx;
  model->voltage_V = dea_arena_alloc(&question->memory, count, sizeof *model->voltage_V);
  question->points = dea_arena_alloc(&question->memory, count, sizeof *question->points);
  DEA_TRY(question->ctx, dea_arena_status(&question->memory));
  for (size_t k = 0; k < count; k++) {
    model->voltage_V[k] = question->voltages_V[k % n];
  }
  model->stop_count = count;
  model->groups[0] = (struct dea_device_group){.first = 0, .count = n};
  model->groups[1] = (struct dea_device_group){.held = true, .first = n, .count = n};
  model->group_count = held ? 2 : 1;
  question->evaluator = (struct dea_evaluator){.user = question,
                                               .param_count = question->variable_count,
                                               .value_count = n * question->quantity_count,
                                               .mark_count = n,
                                               .evaluate = evaluate};
  return DEA_OK;
}

// What is asked -----------------------------------------------------------------------------------

static dea_status find_model(struct dea_question *question)
{
  const struct dea_label *label = &question->file->model;
  const char *names[16];
  size_t count, n = 0;
  const struct dea_model_type *const *all = dea_model_all(&count);
  question->model.type = dea_model_find(label->text);
  for (; n < count && n < 16; n++) {
    names[n] = all[n]->name;
  }
  return question->model.type != NULL
             ? DEA_OK
             : dea_explore_unknown(question->ctx, label, "model", names, n);
}

static dea_status read_design(struct dea_question *question)
{
  const struct dea_explore_file *file = question->file;
  struct dea_context *ctx = question->ctx;
  question->path = dea_path_beside(ctx, file->head.file, file->design.text);
  if (question->path == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status =
      dea_file_read(ctx, question->path, DEA_YAML_SIZE_MAX, &question->bytes, &question->length);
  if (status == DEA_E_IO) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, file->design.location, "design: %s",
                                 dea_context_message(ctx)));
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_design_read_memory(ctx, question->path, question->bytes, question->length, NULL,
                                      0, &question->design));
  DEA_TRY(ctx, dea_device_build(ctx, question->design, &question->device));
  return DEA_OK;
}

static dea_status take_quantities(struct dea_question *question)
{
  const struct dea_explore_file *file = question->file;
  for (size_t i = 0; i < file->quantity_count; i++) {
    struct dea_explored *out = &question->quantities[question->quantity_count];
    const bool twice = dea_question_quantity(question, file->quantities[i].text) >= 0;
    bool good;
    DEA_TRY(question->ctx,
            dea_explored_find(question->ctx, question->device, &file->quantities[i], out, &good));
    if (twice) {
      DEA_TRY(question->ctx, dea_finding_add(question->ctx, DEA_ERROR, file->quantities[i].location,
                                             "%s is there twice", out->key));
    } else if (good && out->is_seen && question->model.type != NULL &&
               question->model.type->observe == NULL) {
      DEA_TRY(question->ctx,
              dea_finding_add(question->ctx, DEA_ERROR, file->quantities[i].location,
                              "model %s knows no monitors", question->model.type->name));
    } else if (good) {
      question->quantity_count++;
    }
  }
  return DEA_OK;
}

static void take_voltages(struct dea_question *question)
{
  const struct dea_explore_file *file = question->file;
  question->voltage_count = file->voltage_count > 0 ? file->voltage_count : 1;
  question->voltages_V[0] = dea_design_highest_V(question->design);
  for (size_t k = 0; k < file->voltage_count; k++) {
    question->voltages_V[k] = file->voltages_V[k].si;
  }
}

/* What goes together of a variable. */
static dea_status check_variable(struct dea_question *question, const struct dea_variable *variable)
{
  const struct dea_explore_variable *text = variable->text;
  const struct dea_label *name = &text->text.name;
  const char *wrong = NULL;
  const bool range = !isnan(variable->low) && !isnan(variable->high);
  const bool spread = text->distribution.value != DEA_UNIFORM && variable->scatter == 0;
  if (variable->value_count > 0 && (range || spread || text->steps.origin != DEA_ABSENT)) {
    wrong = "give values, or low and high, or a distribution";
  } else if (spread &&
             (isnan(variable->param.param.prior) || isnan(variable->param.param.prior_std))) {
    wrong = "this distribution needs mean and std";
  } else if (text->distribution.value == DEA_LOGNORMAL && variable->param.param.prior <= 0) {
    wrong = "the median of a lognormal distribution is above 0";
  } else if (!spread && !isnan(variable->param.param.prior)) {
    wrong = "mean and std are of a normal or lognormal distribution";
  } else if (variable->value_count == 0 && !spread && !range) {
    wrong = "give low and high, or values";
  }
  return wrong == NULL ? DEA_OK
                       : dea_finding_add(question->ctx, DEA_ERROR, name->location, "%s: %s",
                                         name->text, wrong);
}

/* What a search misses a variable by, and the one value of one that only scatters. */
static dea_status take_scatter(struct dea_question *question, struct dea_variable *variable)
{
  struct dea_context *ctx = question->ctx;
  const struct dea_explore_variable *text = variable->text;
  const struct dea_label *name = &text->text.name;
  if (text->scatter.text[0] == '\0') {
    return DEA_OK;
  }
  if (variable->param.whole) {
    return dea_finding_add(ctx, DEA_ERROR, text->scatter.location,
                           "%s: a whole number does not scatter", name->text);
  }
  DEA_TRY(ctx, dea_device_param_number(ctx, &variable->param, &text->scatter, &variable->scatter));
  if (!(variable->scatter > 0)) {
    return isnan(variable->scatter) ? DEA_OK // said
                                    : dea_finding_add(ctx, DEA_ERROR, text->scatter.location,
                                                      "%s: a scatter is more than 0", name->text);
  }
  const bool alone = variable->value_count == 0 && isnan(variable->low) && isnan(variable->high);
  if (alone && isnan(variable->param.designed)) {
    return dea_finding_add(ctx, DEA_ERROR, name->location,
                           "%s: the design has no value that could scatter", name->text);
  }
  if (alone) {
    variable->values[variable->value_count++] = variable->param.designed;
  }
  return DEA_OK;
}

/* Other numbers of the design that take the value of a variable: of the same unit, and of the same
 * film, stretched or not. */
static dea_status take_ties(struct dea_question *question, struct dea_variable *variable)
{
  struct dea_context *ctx = question->ctx;
  const struct dea_explore_variable *text = variable->text;
  const struct dea_device_param_source source = {question->design, question->device, .whole = true};
  struct dea_device_param *param = &variable->param;
  for (size_t i = 0; i < text->also_count; i++) {
    const struct dea_label *name = &text->also[i];
    struct dea_device_param *tie = &variable->ties[param->tie_count];
    bool good = false;
    *tie = (struct dea_device_param){.state = ""};
    snprintf(tie->param.name, sizeof tie->param.name, "%s", name->text);
    DEA_TRY(ctx, dea_device_param_find(ctx, &source, name, tie, &good));
    if (!good) {
      continue;
    }
    if (strcmp(tie->param.unit, param->param.unit) != 0 || strcmp(tie->state, param->state) != 0 ||
        tie->whole != param->whole) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, name->location,
                                   "%s (%s%s) cannot take the values of %s (%s%s)", name->text,
                                   tie->param.unit, tie->state, text->text.name.text,
                                   param->param.unit, param->state));
    } else if (strcmp(name->text, text->text.name.text) == 0) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, name->location,
                                   "%s: this is the variable itself", name->text));
    } else {
      param->tie_count++;
    }
  }
  return DEA_OK;
}

static dea_status take_variable(struct dea_question *question,
                                const struct dea_explore_variable *text,
                                struct dea_variable *variable)
{
  struct dea_context *ctx = question->ctx;
  struct dea_fit_parameter_text param = text->text;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  *variable = (struct dea_variable){.text = text, .low = NAN, .high = NAN};
  if (param.start.text[0] == '\0' && question->file->objective_count == 0) { // a sweep has none
    param.start = text->value_count > 0 ? text->values[0] : text->text.low;
  }
  if (param.prior_std.text[0] == '\0' || param.prior.text[0] == '\0') {
    const char c = param.prior.text[0]; // of a material, or missing, which is said later
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))) {
      param.prior.text[0] = param.prior_std.text[0] = '\0';
    }
  }
  const struct dea_device_param_source source = {question->design, question->device, .whole = true};
  DEA_TRY(ctx, dea_device_param_make(ctx, &param, &source, &variable->param));
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    return DEA_OK;
  }
  DEA_TRY(ctx, take_ties(question, variable));
  variable->low = text->text.low.text[0] != '\0' ? variable->param.param.low : NAN;
  variable->high = text->text.high.text[0] != '\0' ? variable->param.param.high : NAN;
  for (size_t i = 0; i < text->value_count; i++) {
    DEA_TRY(ctx,
            dea_device_param_number(ctx, &variable->param, &text->values[i], &variable->values[i]));
  }
  variable->value_count = text->value_count;
  DEA_TRY(ctx, take_scatter(question, variable));
  const size_t steps = text->steps.origin != DEA_ABSENT ? (size_t)text->steps.si : 0;
  const double span = variable->high - variable->low;
  if (steps > DEA_EXPLORE_VALUES_MAX || (variable->param.whole && span >= DEA_EXPLORE_VALUES_MAX)) {
    return dea_finding_add(ctx, DEA_ERROR, text->text.name.location, "%s: at most %d values",
                           text->text.name.text, DEA_EXPLORE_VALUES_MAX);
  }
  DEA_TRY(ctx, check_variable(question, variable));
  const size_t own = variable->param.whole && steps == 0 && span >= 0 ? (size_t)span + 1 : steps;
  for (size_t i = 0; variable->value_count == 0 && i < own; i++) {
    variable->values[i] =
        own == 1 ? variable->low : variable->low + span * (double)i / (double)(own - 1);
  }
  variable->value_count = variable->value_count > 0 ? variable->value_count : own;
  return DEA_OK;
}

static dea_status take_variables(struct dea_question *question)
{
  const struct dea_explore_file *file = question->file;
  for (size_t j = 0; j < file->variable_count; j++) {
    DEA_TRY(question->ctx, take_variable(question, &file->variables[j], &question->variables[j]));
    question->params[j] = question->variables[j].param;
    question->params[j].ties = question->variables[j].ties;
  }
  question->variable_count = file->variable_count;
  return DEA_OK;
}

static dea_status take_limit(struct dea_question *question, const struct dea_explore_limit *text)
{
  struct dea_limit *limit = &question->limits[question->limit_count++];
  struct dea_context *ctx = question->ctx;
  *limit = (struct dea_limit){dea_question_quantity(question, text->quantity.text), NAN, NAN};
  if (limit->column < 0) {
    return dea_finding_add(ctx, DEA_ERROR, text->quantity.location,
                           "'%.60s' is none of the quantities of this file", text->quantity.text);
  }
  const struct dea_column *column = &question->quantities[limit->column].shown;
  struct dea_device_param number = {.state = "", .param = {.unit = column->si_unit}};
  snprintf(number.param.name, sizeof number.param.name, "%.39s", column->key);
  if (text->above.text[0] != '\0') {
    DEA_TRY(ctx, dea_device_param_number(ctx, &number, &text->above, &limit->above));
  }
  if (text->below.text[0] != '\0') {
    DEA_TRY(ctx, dea_device_param_number(ctx, &number, &text->below, &limit->below));
  }
  if (limit->above >= limit->below) {
    return dea_finding_add(ctx, DEA_ERROR, text->below.location,
                           "%s cannot be above %s and below %s", column->key, text->above.text,
                           text->below.text);
  }
  return text->above.text[0] != '\0' || text->below.text[0] != '\0'
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR, text->quantity.location,
                               "a limit needs above or below");
}

static dea_status take_objectives(struct dea_question *question)
{
  const struct dea_explore_file *file = question->file;
  for (size_t k = 0; k < file->objective_count; k++) {
    const struct dea_label *label = &file->objectives[k].quantity;
    question->objectives[k] = dea_question_quantity(question, label->text);
    if (question->objectives[k] < 0) {
      DEA_TRY(question->ctx,
              dea_finding_add(question->ctx, DEA_ERROR, label->location,
                              "'%.60s' is none of the quantities of this file", label->text));
    }
  }
  return DEA_OK;
}

static dea_status resolve_file(struct dea_question *question)
{
  struct dea_context *ctx = question->ctx;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, find_model(question));
  DEA_TRY(ctx, read_design(question));
  DEA_TRY(ctx, take_quantities(question));
  DEA_TRY(ctx, dea_from_fit_take(ctx, question->design, question->device, question->file));
  DEA_TRY(ctx, take_variables(question));
  for (size_t i = 0; i < question->file->limit_count; i++) {
    DEA_TRY(ctx, take_limit(question, &question->file->limits[i]));
  }
  DEA_TRY(ctx, take_objectives(question));
  take_voltages(question);
  const size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the file '%s' has %zu error%s", question->file->head.file,
                    found, found > 1 ? "s" : "");
  }
  DEA_TRY(ctx, dea_model_check(ctx, question->model.type, question->design, question->device));
  DEA_TRY(ctx, take_hash(question));
  return prepare_model(question);
}

dea_status dea_question_read(struct dea_context *ctx, const char *file, struct dea_question **out)
{
  *out = NULL;
  struct dea_question *question = dea_alloc(ctx, 1, sizeof *question);
  if (question == NULL) {
    return DEA_E_MEMORY;
  }
  question->ctx = ctx;
  dea_status status = dea_explore_file_read(ctx, file, &question->file);
  if (status == DEA_OK) {
    void *before = dea_c_locale_enter();
    status = resolve_file(question);
    dea_c_locale_leave(before);
  }
  if (status != DEA_OK) {
    dea_question_destroy(question);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = question;
  return DEA_OK;
}

void dea_question_destroy(struct dea_question *question)
{
  if (question != NULL) {
    question->model.ctx = question->ctx;
    dea_device_model_end(&question->model);
    dea_arena_free(&question->memory);
    dea_device_destroy(question->ctx, question->device);
    dea_design_destroy(question->ctx, question->design);
    dea_free(question->ctx, question->bytes);
    dea_free(question->ctx, question->path);
    dea_explore_file_destroy(question->ctx, question->file);
    dea_free(question->ctx, question);
  }
}

bool dea_question_warms(const struct dea_question *question)
{
  return question->model.type->load != NULL && question->file->begin.value == DEA_BEGIN_NEAREST;
}

bool dea_variable_range(const struct dea_variable *variable, double *low, double *high)
{
  *low = variable->low;
  *high = variable->high;
  for (size_t i = 0; i < variable->value_count; i++) {
    *low = i == 0 ? variable->values[i] : fmin(*low, variable->values[i]);
    *high = i == 0 ? variable->values[i] : fmax(*high, variable->values[i]);
  }
  return !isnan(*low) && !isnan(*high);
}

int dea_question_quantity(const struct dea_question *question, const char *key)
{
  for (size_t i = 0; i < question->quantity_count; i++) {
    if (strcmp(question->quantities[i].key, key) == 0) {
      return (int)i;
    }
  }
  return -1;
}

bool dea_question_is_held(const struct dea_question *question, size_t quantity)
{
  return question->model.group_count > 1 &&
         strcmp(question->quantities[quantity].key, "force_N") == 0;
}

/* A word at voltage k, which several have to say. */
static void name_at(const struct dea_question *question, const char *word, size_t k, char *out,
                    size_t size)
{
  if (question->voltage_count == 1) {
    snprintf(out, size, "%s", word);
  } else {
    snprintf(out, size, "%s@%.6g", word, question->voltages_V[k]);
  }
}

void dea_question_value_name(const struct dea_question *question, size_t i, char *out, size_t size)
{
  const size_t count = question->quantity_count;
  name_at(question, question->quantities[i % count].key, i / count, out, size);
}

void dea_question_flags_name(const struct dea_question *question, size_t k, char *out, size_t size)
{
  name_at(question, "flags", k, out, size);
}

double dea_limit_margin(const struct dea_question *question, const struct dea_limit *limit,
                        const double *q)
{
  const double value =
      q[(question->voltage_count - 1) * question->quantity_count + (size_t)limit->column];
  const double above = isnan(limit->above)
                           ? INFINITY
                           : (value - limit->above) / (limit->above != 0 ? fabs(limit->above) : 1);
  const double below = isnan(limit->below)
                           ? INFINITY
                           : (limit->below - value) / (limit->below != 0 ? fabs(limit->below) : 1);
  return isnan(value) ? NAN : fmin(above, below);
}
