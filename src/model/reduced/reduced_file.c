/* A reduced-order model as JSON. */
#include "base/file.h"
#include "base/json.h"
#include "base/version.h"
#include "base/write_file.h"
#include "device/identity.h"
#include "model/reduced/reduced.h"
#include "result/columns.h"
#include "result/provenance.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FORMAT = 2, FILE_MAX = 64 << 20, TERMS = DEA_REDUCED_TERMS };

static const char *const motions[] = {"x",         "y",         "z",           "turn_x",
                                      "turn_y",    "turn_z",    "outwards",    "stretch",
                                      "stretch_x", "stretch_y", "area_stretch"};
enum { MOTIONS = sizeof motions / sizeof motions[0] };

dea_status dea_reduced_hash(struct dea_context *ctx, const struct dea_device *device,
                            const struct dea_model_settings *settings, char out[65])
{
  struct dea_text text = {.ctx = ctx};
  out[0] = '\0';
  if (settings->reduced.design != NULL) {
    const struct dea_listing *values = &settings->reduced.design->values;
    dea_device_identity(settings->reduced.design, device, "compute", &text);
    for (size_t i = 0; i < values->count; i++) {
      if (strncmp(values->items[i].path, "compute.solid", strlen("compute.solid")) == 0) {
        dea_text_add(&text, "%s=%s\n", values->items[i].path, values->items[i].text);
      }
    }
    if (settings->reduced.air_kg_per_m3 > 0) {
      dea_text_add(&text, "air=%.17g\n", settings->reduced.air_kg_per_m3);
    }
    dea_sha256_hex(dea_text_get(&text), text.length, out);
  }
  const bool failed = text.failed;
  dea_text_free(&text);
  return failed ? DEA_E_MEMORY : DEA_OK;
}

// Writing -----------------------------------------------------------------------------------------

static json_t *numbers(const double *values, size_t count)
{
  json_t *array = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(array, json_real(values[i]));
  }
  return array;
}

static size_t coefficients(const struct dea_reduced_spline *s)
{
  return (size_t)(s->cells[0] * s->cells[1] * TERMS * TERMS);
}

static json_t *spline_json(const struct dea_reduced_spline *s)
{
  json_t *object = json_object();
  json_object_set_new(object, "force", numbers(s->breaks[0], (size_t)s->cells[0] + 1));
  json_object_set_new(object, "voltage", numbers(s->breaks[1], (size_t)s->cells[1] + 1));
  json_object_set_new(object, "coefficients", numbers(s->c, coefficients(s)));
  return object;
}

static void add_place(json_t *object, const struct dea_device *device, int column, size_t monitor,
                      int motion)
{
  if (column != 0) {
    dea_json_add_text(object, "column", dea_point_columns[column].key);
  } else {
    dea_json_add_text(object, "monitor", device->layout->monitors[monitor].name);
    dea_json_add_text(object, "motion", motions[motion]);
  }
}

static json_t *order_json(const struct dea_reduced_order *o, const struct dea_device *device)
{
  const struct dea_reduced *core = &o->core;
  json_t *root = json_object(), *outputs = json_array(), *modes = json_array(),
         *coordinate = json_object();
  dea_json_add_count(root, "dea_reduced_order", FORMAT);
  dea_json_add_text(root, "program", DEA_VERSION);
  dea_json_add_text(root, "device", o->device);
  add_place(coordinate, device, o->coordinate.column, o->coordinate.body, o->coordinate.component);
  json_object_set_new(root, "coordinate", coordinate);
  json_object_set_new(root, "range_voltage_V", numbers(o->voltage_V, 2));
  json_object_set_new(root, "range_force", numbers(o->force, 2));
  dea_json_add(root, "stroke", o->stroke);
  dea_json_add(root, "error", o->error);
  dea_json_add(root, "charge_error", o->charge_error);
  dea_json_add(root, "mode_share", o->mode_share);
  dea_json_add(root, "made_s", o->made_s);
  json_object_set_new(root, "even", json_boolean(core->even));
  json_object_set_new(root, "energy", spline_json(&core->energy));
  dea_json_add(root, "middle", core->middle);
  for (int i = 0; i < core->small_count; i++) {
    json_t *mode = json_object();
    json_object_set_new(mode, "mass", numbers(core->modes[i].mass, 3));
    dea_json_add(mode, "share", core->modes[i].share);
    dea_json_add(mode, "voltage_share", core->modes[i].voltage_share);
    json_object_set_new(mode, "voltage_share_by_q", numbers(core->modes[i].by_q, 3));
    json_array_append_new(modes, mode);
  }
  json_object_set_new(root, "modes", modes);
  dea_json_add_count(root, "modes_in_time", (size_t)core->mode_count);
  json_object_set_new(root, "voltage_share_off",
                      numbers(o->share_off, (size_t)core->mode_count + 1));
  dea_json_add(root, "left_Hz", o->left_Hz);
  json_object_set_new(root, "strain", numbers(core->strain, 3));
  dea_json_add(root, "damping", core->damping);
  json_object_set_new(root, "branch_N_per_m",
                      numbers(core->branch_N_per_m, (size_t)core->branch_count));
  json_object_set_new(root, "branch_s", numbers(core->branch_s, (size_t)core->branch_count));
  for (size_t i = 0; i < o->output_count; i++) {
    const struct dea_reduced_output *of = &o->outputs[i];
    json_t *object = spline_json(&of->of);
    add_place(object, device, of->column, of->monitor, (int)of->motion);
    json_array_append_new(outputs, object);
  }
  json_object_set_new(root, "outputs", outputs);
  return root;
}

dea_status dea_reduced_order_write(struct dea_context *ctx, const struct dea_reduced_order *order,
                                   const struct dea_device *device, const char *path)
{
  char *text;
  DEA_TRY(ctx, dea_json_text(ctx, order_json(order, device), &text));
  dea_status status = dea_file_write(ctx, path, text, strlen(text));
  dea_free(ctx, text);
  return DEA_CHAIN(ctx, status);
}

// Reading -----------------------------------------------------------------------------------------

/* What is read so far. */
struct reading {
  struct dea_context *ctx;
  struct dea_arena *memory;
  const struct dea_device *device;
  bool wrong; // a number or text is missing
};

static double number(struct reading *r, const json_t *object, const char *key)
{
  const json_t *value = json_object_get(object, key);
  r->wrong = r->wrong || (value != NULL && !json_is_number(value));
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* count: SIZE_MAX: any, and *found of them. */
static double *array(struct reading *r, const json_t *object, const char *key, size_t count,
                     size_t *found)
{
  const json_t *values = json_object_get(object, key);
  const size_t size = json_array_size(values);
  double *out = dea_arena_alloc(r->memory, size + 1, sizeof *out);
  r->wrong = r->wrong || !json_is_array(values) || (count != SIZE_MAX && size != count);
  for (size_t i = 0; i < size && out != NULL; i++) {
    const json_t *value = json_array_get(values, i);
    r->wrong = r->wrong || !json_is_number(value);
    out[i] = json_number_value(value);
  }
  if (found != NULL) {
    *found = size;
  }
  return out;
}

static void numbers_into(struct reading *r, const json_t *object, const char *key, size_t count,
                         double *out)
{
  const double *values = array(r, object, key, count, NULL);
  if (!r->wrong && values != NULL) {
    memcpy(out, values, count * sizeof *out);
  }
}

static void read_spline(struct reading *r, const json_t *object, struct dea_reduced_spline *out)
{
  static const char *const names[2] = {"force", "voltage"};
  for (int k = 0; k < 2; k++) {
    size_t count;
    out->breaks[k] = array(r, object, names[k], SIZE_MAX, &count);
    r->wrong = r->wrong || count < 2 || count > DEA_REDUCED_VOLTAGES_MAX;
    for (size_t i = 1; i < count && out->breaks[k] != NULL; i++) {
      r->wrong = r->wrong || !(out->breaks[k][i] > out->breaks[k][i - 1]);
    }
    out->cells[k] = r->wrong ? 1 : (int)count - 1;
  }
  out->c = array(r, object, "coefficients", coefficients(out), NULL);
}

/* The column, or monitor and motion, that are named. */
static void read_place(struct reading *r, const json_t *object, int *column, size_t *monitor,
                       int *motion)
{
  const char *key = json_string_value(json_object_get(object, "column")),
             *name = json_string_value(json_object_get(object, "monitor")),
             *of = json_string_value(json_object_get(object, "motion"));
  const struct dea_layout *l = r->device->layout;
  *column = key != NULL ? dea_point_column_find(key) : 0;
  *monitor = 0;
  *motion = 0;
  if (key == NULL) {
    while (name != NULL && *monitor < l->monitor_count &&
           strcmp(l->monitors[*monitor].name, name) != 0) {
      ++*monitor;
    }
    while (of != NULL && *motion < MOTIONS && strcmp(motions[*motion], of) != 0) {
      ++*motion;
    }
  }
  r->wrong = r->wrong || *column < 0 ||
             (key == NULL &&
              (name == NULL || of == NULL || *monitor == l->monitor_count || *motion == MOTIONS));
}

static void read_outputs(struct reading *r, const json_t *list, struct dea_reduced_order *o)
{
  o->output_count = json_array_size(list);
  o->outputs = dea_arena_alloc(r->memory, o->output_count + 1, sizeof *o->outputs);
  for (size_t i = 0; i < o->output_count && o->outputs != NULL; i++) {
    struct dea_reduced_output *of = &o->outputs[i];
    int motion;
    read_place(r, json_array_get(list, i), &of->column, &of->monitor, &motion);
    of->motion = (enum dea_observed)motion;
    read_spline(r, json_array_get(list, i), &of->of);
  }
}

static void read_order(struct reading *r, const json_t *root, struct dea_reduced_order *o)
{
  struct dea_reduced *core = &o->core;
  size_t branches;
  r->wrong = json_integer_value(json_object_get(root, "dea_reduced_order")) != FORMAT;
  read_place(r, json_object_get(root, "coordinate"), &o->coordinate.column, &o->coordinate.body,
             &o->coordinate.component);
  o->coordinate.kind = DEA_CONTROL_CONJUGATE;
  numbers_into(r, root, "range_voltage_V", 2, o->voltage_V);
  numbers_into(r, root, "range_force", 2, o->force);
  o->stroke = number(r, root, "stroke");
  o->error = number(r, root, "error");
  o->charge_error = number(r, root, "charge_error");
  o->mode_share = number(r, root, "mode_share");
  o->made_s = number(r, root, "made_s");
  core->even = json_is_true(json_object_get(root, "even"));
  read_spline(r, json_object_get(root, "energy"), &core->energy);
  core->middle = number(r, root, "middle");
  const json_t *modes = json_object_get(root, "modes");
  core->small_count = (int)fmin((double)json_array_size(modes), DEA_REDUCED_MODES);
  core->mode_count = (int)number(r, root, "modes_in_time");
  r->wrong = r->wrong || core->mode_count > core->small_count;
  for (int i = 0; i < core->small_count; i++) {
    const json_t *mode = json_array_get(modes, (size_t)i);
    numbers_into(r, mode, "mass", 3, core->modes[i].mass);
    numbers_into(r, mode, "voltage_share_by_q", 3, core->modes[i].by_q);
    core->modes[i].share = number(r, mode, "share");
    core->modes[i].voltage_share = number(r, mode, "voltage_share");
  }
  if (json_object_get(root, "voltage_share_off") != NULL && !r->wrong) {
    numbers_into(r, root, "voltage_share_off", (size_t)core->mode_count + 1, o->share_off);
    o->left_Hz = number(r, root, "left_Hz");
  }
  numbers_into(r, root, "strain", 3, core->strain);
  core->damping = number(r, root, "damping");
  array(r, root, "branch_s", SIZE_MAX, &branches);
  branches = branches > DEA_REDUCED_BRANCHES ? DEA_REDUCED_BRANCHES : branches;
  core->branch_count = (int)branches;
  numbers_into(r, root, "branch_s", branches, core->branch_s);
  numbers_into(r, root, "branch_N_per_m", branches, core->branch_N_per_m);
  read_outputs(r, json_object_get(root, "outputs"), o);
}

static dea_status check_device(struct dea_context *ctx, const char *path, const json_t *root,
                               const struct dea_device *device,
                               const struct dea_model_settings *settings)
{
  const char *of = json_string_value(json_object_get(root, "device"));
  char hash[65];
  DEA_TRY(ctx, dea_reduced_hash(ctx, device, settings, hash));
  return of == NULL || hash[0] == '\0' || strcmp(of, hash) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN,
                        "%s is a reduced-order model of another device, or in another gas: make it "
                        "anew by "
                        "dea reduce-order",
                        path);
}

static dea_status read_root(struct dea_context *ctx, const char *path, const json_t *root,
                            const struct dea_device *device,
                            const struct dea_model_settings *settings,
                            struct dea_reduced_order *out)
{
  struct reading r = {.ctx = ctx, .memory = &out->memory, .device = device};
  if (!json_is_integer(json_object_get(root, "dea_reduced_order"))) {
    return dea_fail(ctx, DEA_E_DESIGN, "%s is no file of dea reduce-order", path);
  }
  DEA_TRY(ctx, check_device(ctx, path, root, device, settings));
  read_order(&r, root, out);
  DEA_TRY(ctx, dea_arena_status(&out->memory));
  return r.wrong ? dea_fail(ctx, DEA_E_DESIGN,
                            "%s lacks numbers of a reduced-order model: make it anew by "
                            "dea reduce-order",
                            path)
                 : DEA_OK;
}

dea_status dea_reduced_order_read(struct dea_context *ctx, const char *path,
                                  const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_reduced_order **out)
{
  json_error_t error;
  char *bytes;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, path, FILE_MAX, &bytes, &length));
  json_t *root = json_loadb(bytes, length, 0, &error);
  dea_free(ctx, bytes);
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    json_decref(root);
    return DEA_E_MEMORY;
  }
  (*out)->memory.ctx = ctx;
  dea_status status = root == NULL
                          ? dea_fail(ctx, DEA_E_DESIGN, "%s cannot be read: %s", path, error.text)
                          : read_root(ctx, path, root, device, settings, *out);
  json_decref(root);
  if (status != DEA_OK) {
    dea_reduced_order_destroy(ctx, *out);
    *out = NULL;
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}
