#include "explore/design_space.h"

#include "base/file.h"
#include "base/text.h"
#include "base/write_file.h"
#include "device/identity.h"
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
static void resolve(const struct dea_design_space *space, const struct dea_design *design,
                    const struct dea_device *device, struct dea_text *out)
{
  dea_device_identity(design, device, NULL, out);
  dea_text_add(out, "model=%s\nbegin=%d\n", space->model.type->name, space->file->begin.value);
  for (size_t k = 0; k < space->voltage_count; k++) {
    dea_text_add(out, "%.12g V\n", space->voltages_V[k]);
  }
}

static dea_status add_identity(void *user, const struct dea_design *design,
                               const struct dea_device *device)
{
  struct dea_design_space *space = user;
  struct dea_text text = {.ctx = space->model.ctx};
  char hash[65];
  for (size_t k = 0; k < space->voltage_count; k++) { // those of another device
    for (size_t i = 0; i < space->quantity_count; i++) {
      space->seen[k][i] = NAN;
    }
  }
  resolve(space, design, device, &text);
  dea_sha256_hex(dea_text_get(&text), text.length, hash);
  snprintf(space->id, sizeof space->id, "%.16s", hash);
  return dea_text_free(&text);
}

/* Hash of the design as it is, of the variables and of what is kept of a case. */
static dea_status compute_hash(struct dea_design_space *space)
{
  struct dea_text text = {.ctx = space->ctx};
  resolve(space, space->design, space->device, &text);
  for (size_t j = 0; j < space->variable_count; j++) {
    dea_text_add(&text, "variable %s%s", space->params[j].param.name, space->params[j].state);
    for (size_t k = 0; k < space->params[j].tie_count; k++) {
      dea_text_add(&text, " %s", space->params[j].ties[k].param.name);
    }
    dea_text_add(&text, "\n");
  }
  for (size_t i = 0; i < space->quantity_count; i++) {
    dea_text_add(&text, "quantity %s\n", space->quantities[i].key);
  }
  dea_sha256_hex(dea_text_get(&text), text.length, space->hash);
  dea_text_add(&text, "gradients\n");
  dea_sha256_hex(dea_text_get(&text), text.length, space->hash_slopes);
  return dea_text_free(&text);
}

// Evaluation --------------------------------------------------------------------------------------

/* What is wrong with a design that cannot be built. */
static void describe_design(struct dea_design_space *space, struct dea_context *ctx,
                            struct dea_case *io)
{
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  size_t count;
  dea_finding_clear(ctx);
  dea_device_params_build(ctx, &space->model.file, space->params, space->variable_count, io->p,
                          &design, &device);
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
  struct dea_design_space *space = user;
  const size_t count = space->quantity_count;
  space->id[0] = space->model.why[0] = space->why[0] = '\0';
  space->model.ctx = ctx;
  dea_status status =
      dea_device_model_sweep(&space->model, io->has_near ? io->near : NULL, io->p, space->points);
  snprintf(io->id, sizeof io->id, "%s", space->id);
  snprintf(io->why, sizeof io->why, "%.*s", DEA_CASE_WHY_SIZE - 1, space->model.why);
  if (status == DEA_E_UNSUPPORTED || status == DEA_E_ARGUMENT) { // of this design: a mesh
    snprintf(io->why, sizeof io->why, "%.*s", DEA_CASE_WHY_SIZE - 1, dea_context_message(ctx));
    dea_context_clear(ctx);
    return DEA_OK;
  }
  if (status == DEA_E_DOMAIN) {
    io->id[0] = '\0'; // not that of the design to begin from
    describe_design(space, ctx, io);
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  for (size_t k = 0; k < space->voltage_count; k++) {
    for (size_t g = 0; g < space->model.group_count; g++) {
      io->marks[k] |= dea_load_point_flags(&space->points[space->model.groups[g].first + k]);
    }
    for (size_t i = 0; i < count; i++) {
      const struct dea_explored *of = &space->quantities[i];
      const size_t group = dea_design_space_is_held(space, i) ? 1 : 0;
      double *q = &io->q[k * count + i];
      *q = of->source == DEA_EXPLORED_POINT
               ? dea_point_get(&space->points[space->model.groups[group].first + k], of->column)
               : space->seen[k][i];
      if (isnan(*q) && io->why[0] == '\0' && of->source == DEA_EXPLORED_CRITICAL) {
        snprintf(io->why, sizeof io->why, "%s: %.120s", of->key, space->why);
      } else if (isnan(*q) && io->why[0] == '\0') {
        snprintf(io->why, sizeof io->why, "the model does not support %s of this design", of->key);
      }
    }
  }
  return DEA_OK;
}

/* Critical voltages of a device, looked for up to four times the highest that is asked for. They do
 * not depend on the voltage: all stops have the same. */
static dea_status find_critical(struct dea_design_space *space,
                                const struct dea_model_settings *settings,
                                const struct dea_design *design, const struct dea_device *device)
{
  struct dea_context *ctx = space->model.ctx;
  const double last_V = space->voltages_V[space->voltage_count - 1],
               highest_V = fmax(last_V, dea_design_highest_V(design));
  for (size_t i = 0; i < space->quantity_count; i++) {
    const struct dea_explored *quantity = &space->quantities[i];
    const struct dea_critical_request ask = {.type = space->model.type,
                                             .device = device,
                                             .settings = settings,
                                             .kind = quantity->event,
                                             .first_V = highest_V / 4,
                                             .highest_V = 4 * highest_V};
    if (quantity->source != DEA_EXPLORED_CRITICAL) {
      continue;
    }
    DEA_TRY(ctx, dea_critical_find(ctx, &ask, &space->critical[i]));
    if (isnan(space->critical[i].voltage_V)) {
      snprintf(space->why, sizeof space->why, "%s", space->critical[i].why);
    }
    for (size_t k = 0; k < space->voltage_count; k++) {
      space->seen[k][i] = space->critical[i].voltage_V;
    }
  }
  return DEA_OK;
}

/* Where the model knows none, the quantity stays unknown. */
static dea_status find_frequency(struct dea_design_space *space, struct dea_model *model,
                                 size_t stop, double *out)
{
  struct dea_context *ctx = space->model.ctx;
  const struct dea_load_point at = {.voltage_V = space->voltages_V[stop]};
  struct dea_load_point mode;
  struct dea_field_mesh *shapes;
  if (space->model.type->modes != NULL) {
    DEA_TRY(ctx, space->model.type->modes(ctx, model, &at, 1, &mode, &shapes));
    dea_field_mesh_destroy(ctx, shapes);
    *out = mode.frequency_Hz;
  }
  return DEA_OK;
}

/* Keeps what monitors show at a stop, and the lowest frequency. */
static dea_status stand(void *user, struct dea_model *model, const struct dea_design *design,
                        const struct dea_device *device, size_t stop)
{
  struct dea_design_space *space = user;
  struct dea_context *ctx = space->model.ctx;
  struct dea_monitor_set set;
  struct dea_load_point seen = dea_load_point_empty();
  DEA_TRY(ctx, dea_monitor_set_init(ctx, space->model.type, device, &set));
  dea_status status = dea_monitor_set_read(ctx, &set, space->model.type, model, false, &seen);
  for (size_t i = 0; i < space->quantity_count && stop < space->voltage_count; i++) {
    const struct dea_explored *quantity = &space->quantities[i];
    if (quantity->source == DEA_EXPLORED_MONITOR) {
      space->seen[stop][i] = dea_point_get(&seen, quantity->column);
    } else if (quantity->source == DEA_EXPLORED_FREQUENCY && status == DEA_OK) {
      status = find_frequency(space, model, stop, &space->seen[stop][i]);
    }
  }
  dea_monitor_set_free(&set);
  DEA_TRY(ctx, status);
  const struct dea_model_settings settings = dea_model_settings_of(design);
  status =
      stop + 1 == space->voltage_count ? find_critical(space, &settings, design, device) : DEA_OK;
  if (status == DEA_OK && space->add_slopes != NULL) {
    status = space->add_slopes(space, model, device, stop);
  }
  for (size_t i = 0; i < space->quantity_count; i++) {
    dea_critical_end(ctx, &space->critical[i]);
  }
  return status;
}

/* Groups of voltages: the film that moves freely, and where a force is asked for with a tip. */
static dea_status prepare_model(struct dea_design_space *space)
{
  struct dea_device_model *model = &space->model;
  const int force = dea_design_space_quantity(space, "force_N");
  const bool held = force >= 0 && model->type->indent != NULL;
  const size_t n = space->voltage_count, count = held ? 2 * n : n;
  model->ctx = space->ctx;
  model->file = (struct dea_design_bytes){space->design, space->bytes, space->length};
  model->params = space->params;
  model->param_count = space->variable_count;
  model->built = add_identity;
  model->stood = stand;
  model->user = space;
  space->memory.ctx = space->ctx;
  model->voltage_V = dea_arena_alloc(&space->memory, count, sizeof *model->voltage_V);
  space->points = dea_arena_alloc(&space->memory, count, sizeof *space->points);
  DEA_TRY(space->ctx, dea_arena_status(&space->memory));
  for (size_t k = 0; k < count; k++) {
    model->voltage_V[k] = space->voltages_V[k % n];
  }
  model->stop_count = count;
  model->groups[0] = (struct dea_device_group){.first = 0, .count = n};
  model->groups[1] = (struct dea_device_group){.held = true, .first = n, .count = n};
  model->group_count = held ? 2 : 1;
  space->evaluator = (struct dea_evaluator){.user = space,
                                            .param_count = space->variable_count,
                                            .value_count = n * space->quantity_count,
                                            .mark_count = n,
                                            .evaluate = evaluate};
  return DEA_OK;
}

// What is asked -----------------------------------------------------------------------------------

static dea_status read_design(struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  struct dea_context *ctx = space->ctx;
  space->path = dea_path_beside(ctx, file->head.file, file->design.text);
  DEA_TRY_MEMORY(space->path != NULL);
  dea_status status =
      dea_file_read(ctx, space->path, DEA_YAML_SIZE_MAX, &space->bytes, &space->length);
  if (status == DEA_E_IO) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, file->design.location, "design: %s",
                                 dea_context_message(ctx)));
  }
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_design_read_memory(ctx, space->path, space->bytes, space->length, NULL, 0,
                                      &space->design));
  return dea_device_build(ctx, space->design, &space->device);
}

dea_status dea_explore_unknown(struct dea_context *ctx, const struct dea_label *label,
                               const char *what, const char *const names[], size_t count)
{
  char hint[DEA_HINT_SIZE];
  return dea_finding_add(ctx, DEA_ERROR, label->location, "'%.60s' is no %s%s", label->text, what,
                         dea_name_hint(label->text, names, count, hint));
}

static dea_status no_quantity(struct dea_context *ctx, const struct dea_label *label)
{
  const size_t count = (size_t)dea_column_count(ctx);
  const char **keys = dea_column_keys(ctx);
  const char **all =
      keys != NULL ? dea_resize(ctx, keys, count + DEA_CRITICAL_KINDS, sizeof *all) : NULL;
  if (all == NULL) {
    dea_free(ctx, keys);
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < DEA_CRITICAL_KINDS; i++) {
    all[count + i] = dea_critical_kinds[i].key;
  }
  const dea_status status =
      dea_explore_unknown(ctx, label, "quantity", all, count + DEA_CRITICAL_KINDS);
  dea_free(ctx, all);
  return status;
}

/* Monitor whose name or part of a key the text begins with; NULL: none. */
static const struct dea_layout_monitor *monitor_of(const struct dea_device *device,
                                                   const char *text)
{
  const struct dea_layout *layout = device->layout;
  for (size_t i = 0; i < layout->monitor_count; i++) {
    const struct dea_layout_monitor *monitor = &layout->monitors[i];
    char part[DEA_KEY_PART_SIZE];
    const size_t length = strlen(monitor->name);
    dea_key_part(monitor->name, part);
    if ((strncmp(text, monitor->name, length) == 0 && text[length] == '.') ||
        (strncmp(text, part, strlen(part)) == 0 && text[strlen(part)] == '_')) {
      return monitor;
    }
  }
  return NULL;
}

/* What a monitor does have; of no monitor the nearest quantity. */
static dea_status refuse(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_label *label)
{
  const struct dea_layout_monitor *monitor = monitor_of(device, label->text);
  struct dea_text known = {.ctx = ctx};
  if (monitor == NULL) {
    return no_quantity(ctx, label);
  }
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    if (dea_observed_has(monitor->kind, (enum dea_observed)k)) {
      dea_text_add(&known, "%s%s", known.length > 0 ? ", " : "", dea_observed_columns[k].key);
    }
  }
  const dea_status status = known.failed
                                ? DEA_E_MEMORY
                                : dea_finding_add(ctx, DEA_ERROR, label->location,
                                                  "'%.60s' is no quantity: of '%.40s' there are %s",
                                                  label->text, monitor->name, dea_text_get(&known));
  dea_text_free(&known);
  return status;
}

static bool is_critical(struct dea_explored *out)
{
  for (int i = 0; i < DEA_CRITICAL_KINDS; i++) {
    const struct dea_critical_kind *critical = &dea_critical_kinds[i];
    if (strcmp(out->key, critical->key) == 0) {
      out->source = DEA_EXPLORED_CRITICAL;
      out->event = critical->kind;
      out->shown =
          (struct dea_column){out->key, "V", "kV", 1e-3, critical->title, critical->meaning};
      return true;
    }
  }
  return false;
}

/* Finds a quantity by the key of a column (dea_column_find) or EVENT_voltage_V. *good: false after
 * a finding at its place. The texts that `shown` lends are those of *out, which stays where it is.
 */
static dea_status find_quantity(struct dea_context *ctx, const struct dea_device *device,
                                const struct dea_label *label, struct dea_explored *out, bool *good)
{
  bool observed = false;
  *good = false;
  *out = (struct dea_explored){.column = -1};
  if (strlen(label->text) >= sizeof out->key) {
    return no_quantity(ctx, label);
  }
  snprintf(out->key, sizeof out->key, "%.79s", label->text);
  if (is_critical(out)) {
    *good = true;
    return DEA_OK;
  }
  if (dea_device_is_observed(device)) { // adds its columns to those that are looked through
    DEA_TRY(ctx, dea_layout_column_find(ctx, device->layout, -1, &out->of, &observed));
  }
  out->column = dea_column_find(ctx, label->text);
  if (out->column >= 0 && dea_device_is_observed(device)) {
    DEA_TRY(ctx, dea_layout_column_find(ctx, device->layout, out->column, &out->of, &observed));
    observed = observed && out->of.source != DEA_OF_MONITOR_ERROR;
  }
  if (out->column < 0 || (out->column >= DEA_LOAD_POINT_COLUMNS && !observed)) {
    return refuse(ctx, device, label);
  }
  out->shown = *dea_column_at(ctx, out->column);
  out->shown.key = out->key; // as the file has it
  out->source = observed                                               ? DEA_EXPLORED_MONITOR
                : out->column == dea_point_column_find("frequency_Hz") ? DEA_EXPLORED_FREQUENCY
                                                                       : DEA_EXPLORED_POINT;
  *good = true;
  return DEA_OK;
}

static dea_status read_quantities(struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  for (size_t i = 0; i < file->quantity_count; i++) {
    struct dea_explored *out = &space->quantities[space->quantity_count];
    const bool twice = dea_design_space_quantity(space, file->quantities[i].text) >= 0;
    bool good;
    DEA_TRY(space->ctx, find_quantity(space->ctx, space->device, &file->quantities[i], out, &good));
    if (twice) {
      DEA_TRY(space->ctx, dea_finding_add(space->ctx, DEA_ERROR, file->quantities[i].location,
                                          "%s is there twice", out->key));
    } else if (good && out->source == DEA_EXPLORED_MONITOR && space->model.type != NULL &&
               space->model.type->observe == NULL) {
      DEA_TRY(space->ctx,
              dea_finding_add(space->ctx, DEA_ERROR, file->quantities[i].location,
                              "model %s does not support monitors", space->model.type->name));
    } else if (good) {
      space->quantity_count++;
    }
  }
  return DEA_OK;
}

static void read_voltages(struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  space->voltage_count = file->voltage_count > 0 ? file->voltage_count : 1;
  space->voltages_V[0] = dea_design_highest_V(space->design);
  for (size_t k = 0; k < file->voltage_count; k++) {
    space->voltages_V[k] = file->voltages_V[k].si;
  }
}

/* What goes together of a variable. */
static dea_status check_variable(struct dea_design_space *space,
                                 const struct dea_variable *variable)
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
  return wrong == NULL
             ? DEA_OK
             : dea_finding_add(space->ctx, DEA_ERROR, name->location, "%s: %s", name->text, wrong);
}

/* What a search misses a variable by, and the one value of one that only scatters. */
static dea_status read_scatter(struct dea_design_space *space, struct dea_variable *variable)
{
  struct dea_context *ctx = space->ctx;
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
static dea_status read_ties(struct dea_design_space *space, struct dea_variable *variable)
{
  struct dea_context *ctx = space->ctx;
  const struct dea_explore_variable *text = variable->text;
  const struct dea_device_param_source source = {space->design, space->device, .whole = true};
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

static dea_status read_variable(struct dea_design_space *space,
                                const struct dea_explore_variable *text,
                                struct dea_variable *variable)
{
  struct dea_context *ctx = space->ctx;
  struct dea_fit_parameter_text param = text->text;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  *variable = (struct dea_variable){.text = text, .low = NAN, .high = NAN};
  if (param.start.text[0] == '\0' && space->file->objective_count == 0) { // a sweep has none
    param.start = text->value_count > 0 ? text->values[0] : text->text.low;
  }
  if (param.prior_std.text[0] == '\0' || param.prior.text[0] == '\0') {
    const char c = param.prior.text[0]; // of a material, or missing, which is said later
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))) {
      param.prior.text[0] = param.prior_std.text[0] = '\0';
    }
  }
  const struct dea_device_param_source source = {space->design, space->device, .whole = true};
  DEA_TRY(ctx, dea_device_param_build(ctx, &param, &source, &variable->param));
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    return DEA_OK;
  }
  DEA_TRY(ctx, read_ties(space, variable));
  variable->low = text->text.low.text[0] != '\0' ? variable->param.param.low : NAN;
  variable->high = text->text.high.text[0] != '\0' ? variable->param.param.high : NAN;
  for (size_t i = 0; i < text->value_count; i++) {
    DEA_TRY(ctx,
            dea_device_param_number(ctx, &variable->param, &text->values[i], &variable->values[i]));
  }
  variable->value_count = text->value_count;
  DEA_TRY(ctx, read_scatter(space, variable));
  const size_t steps = text->steps.origin != DEA_ABSENT ? (size_t)text->steps.si : 0;
  const double span = variable->high - variable->low;
  if (steps > DEA_EXPLORE_VALUES_MAX || (variable->param.whole && span >= DEA_EXPLORE_VALUES_MAX)) {
    return dea_finding_add(ctx, DEA_ERROR, text->text.name.location, "%s: at most %d values",
                           text->text.name.text, DEA_EXPLORE_VALUES_MAX);
  }
  DEA_TRY(ctx, check_variable(space, variable));
  const size_t own = variable->param.whole && steps == 0 && span >= 0 ? (size_t)span + 1 : steps;
  for (size_t i = 0; variable->value_count == 0 && i < own; i++) {
    variable->values[i] =
        own == 1 ? variable->low : variable->low + span * (double)i / (double)(own - 1);
  }
  variable->value_count = variable->value_count > 0 ? variable->value_count : own;
  return DEA_OK;
}

static dea_status read_variables(struct dea_design_space *space)
{
  const struct dea_explore_file *file = space->file;
  for (size_t j = 0; j < file->variable_count; j++) {
    DEA_TRY(space->ctx, read_variable(space, &file->variables[j], &space->variables[j]));
    space->params[j] = space->variables[j].param;
    space->params[j].ties = space->variables[j].ties;
  }
  space->variable_count = file->variable_count;
  return DEA_OK;
}

/* Number of a quantity of the file by its key; after a finding -1. */
static dea_status find_column(const struct dea_design_space *space, const struct dea_label *label,
                              int *out)
{
  *out = dea_design_space_quantity(space, label->text);
  return *out >= 0 ? DEA_OK
                   : dea_finding_add(space->ctx, DEA_ERROR, label->location,
                                     "'%.60s' is none of the quantities of this file", label->text);
}

static dea_status read_limit(struct dea_design_space *space, const struct dea_explore_limit *text)
{
  struct dea_limit *limit = &space->limits[space->limit_count++];
  struct dea_context *ctx = space->ctx;
  *limit = (struct dea_limit){-1, NAN, NAN};
  DEA_TRY(ctx, find_column(space, &text->quantity, &limit->column));
  if (limit->column < 0) {
    return DEA_OK;
  }
  const struct dea_column *column = &space->quantities[limit->column].shown;
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

static dea_status resolve_file(struct dea_design_space *space)
{
  struct dea_context *ctx = space->ctx;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  const struct dea_label *model = &space->file->model;
  DEA_TRY(ctx, dea_model_seek(ctx, model->text, model->location, &space->model.type));
  DEA_TRY(ctx, read_design(space));
  DEA_TRY(ctx, read_quantities(space));
  DEA_TRY(ctx, dea_from_fit_read(ctx, space->design, space->device, space->file));
  DEA_TRY(ctx, read_variables(space));
  for (size_t i = 0; i < space->file->limit_count; i++) {
    DEA_TRY(ctx, read_limit(space, &space->file->limits[i]));
  }
  for (size_t k = 0; k < space->file->objective_count; k++) {
    DEA_TRY(ctx, find_column(space, &space->file->objectives[k].quantity, &space->objectives[k]));
  }
  read_voltages(space);
  const size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the file '%s' has %zu error%s", space->file->head.file,
                    found, found > 1 ? "s" : "");
  }
  DEA_TRY(ctx, dea_model_check(ctx, space->model.type, space->design, space->device));
  DEA_TRY(ctx, compute_hash(space));
  return prepare_model(space);
}

dea_status dea_design_space_read(struct dea_context *ctx, const char *file,
                                 struct dea_design_space **out)
{
  *out = NULL;
  struct dea_design_space *space = dea_alloc(ctx, 1, sizeof *space);
  DEA_TRY_MEMORY(space != NULL);
  space->ctx = ctx;
  void *read;
  dea_status status = dea_fit_head_read(ctx, file, &dea_explore_form, &read);
  space->file = read;
  if (status == DEA_OK) {
    void *before = dea_c_locale_enter();
    status = resolve_file(space);
    dea_c_locale_leave(before);
  }
  DEA_TRY_ELSE(ctx, status, dea_design_space_destroy(space));
  *out = space;
  return DEA_OK;
}

void dea_design_space_destroy(struct dea_design_space *space)
{
  if (space != NULL) {
    space->model.ctx = space->ctx;
    dea_device_model_end(&space->model);
    dea_arena_free(&space->memory);
    dea_device_destroy(space->ctx, space->device);
    dea_design_destroy(space->ctx, space->design);
    dea_free(space->ctx, space->bytes);
    dea_free(space->ctx, space->path);
    dea_fit_head_destroy(space->ctx, space->file);
    dea_free(space->ctx, space);
  }
}

int dea_design_space_quantity(const struct dea_design_space *space, const char *key)
{
  for (size_t i = 0; i < space->quantity_count; i++) {
    if (strcmp(space->quantities[i].key, key) == 0) {
      return (int)i;
    }
  }
  return -1;
}

bool dea_design_space_is_held(const struct dea_design_space *space, size_t quantity)
{
  return space->model.group_count > 1 && strcmp(space->quantities[quantity].key, "force_N") == 0;
}

double dea_limit_margin(const struct dea_design_space *space, const struct dea_limit *limit,
                        const double *q)
{
  const double value =
      q[(space->voltage_count - 1) * space->quantity_count + (size_t)limit->column];
  const double above = isnan(limit->above)
                           ? INFINITY
                           : (value - limit->above) / (limit->above != 0 ? fabs(limit->above) : 1);
  const double below = isnan(limit->below)
                           ? INFINITY
                           : (limit->below - value) / (limit->below != 0 ? fabs(limit->below) : 1);
  return isnan(value) ? NAN : fmin(above, below);
}
