/* dea_mex: libdea in MATLAB and Octave; one source for both, compiled by dea_build.m.
 *
 *   [...] = dea_mex(COMMAND, ...)   is what the files of +dea call; people call those
 *
 * Designs, results, actuators and solids stay here, in a table; MATLAB has their numbers, of which
 * none is used twice. A call that fails is an error with an identifier such as "dea:design" and the
 * findings in its message. Nothing is owned where an error may be raised: what the interpreter gave
 * it takes back by itself. */
#include <dea.h>
#include <mex.h>

#include <ctype.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

// Progress and Ctrl-C -----------------------------------------------------------------------------

static struct {
  int quiet;
  time_t told; // last line of progress, or the begin of the run
} run_state;

#ifdef HAVE_OCTAVE // which its mex.h defines

#include <signal.h>

/* What Octave's handler of SIGINT counts up, and the interpreter looks at when we return. */
extern sig_atomic_t octave_interrupt_state;

static int is_interrupted(void)
{
  return octave_interrupt_state > 0;
}

static void clear_interrupt(void)
{
  octave_interrupt_state = 0;
}

/* Not through the interpreter, which would leave the library by an exception on Ctrl-C. */
static void tell(const char *line)
{
  fputs(line, stderr);
}

#else

#ifdef DEA_HAVE_UT // MATLAB's libut, which is not documented
#include <stdbool.h>
extern bool utIsInterruptPending(void);
extern bool utSetInterruptPending(bool pending);

static int is_interrupted(void)
{
  return utIsInterruptPending();
}

static void clear_interrupt(void)
{
  utSetInterruptPending(false);
}
#else
static int is_interrupted(void)
{
  return 0;
}

static void clear_interrupt(void)
{
}
#endif

static void tell(const char *line)
{
  mexPrintf("%s", line);
  mexEvalString("drawnow;"); // else it is shown only at the end
}

#endif

static int on_interrupt(void *user)
{
  (void)user;
  return is_interrupted();
}

/* At most one line a second, none in a run of less than that. */
static void on_progress(void *user, const char *what, size_t done, size_t total)
{
  (void)user;
  char line[200];
  time_t now = time(NULL);
  if (run_state.quiet || now <= run_state.told) {
    return;
  }
  run_state.told = now;
  if (total > 0) {
    snprintf(line, sizeof line, "dea: %s, %lu of %lu\n", what, (unsigned long)done,
             (unsigned long)total);
  } else {
    snprintf(line, sizeof line, "dea: %s, %lu\n", what, (unsigned long)done);
  }
  tell(line);
}

static void on_note(void *user, enum dea_severity severity, const char *text)
{
  (void)user;
  char line[1000];
  if (!run_state.quiet) {
    snprintf(line, sizeof line, "dea: %s%s\n", severity == DEA_NOTE ? "" : "warning: ", text);
    tell(line);
  }
}

// Objects -----------------------------------------------------------------------------------------

enum kind { DESIGN, RESULT, ACTUATOR, SOLID };

static const char *const kind_names[] = {"design", "result", "actuator", "solid"};

struct object {
  uint64_t id;
  enum kind kind;
  void *handle;
};

static dea_context *ctx;
static struct object *objects; // [object_count]
static size_t object_count, object_room;
static uint64_t last_id;

static void release(struct object object)
{
  if (object.kind == DESIGN) {
    dea_design_free(object.handle);
  } else if (object.kind == RESULT) {
    dea_result_free(object.handle);
  } else if (object.kind == ACTUATOR) {
    dea_actuator_free(object.handle);
  } else {
    dea_solid_free(object.handle);
  }
}

static void at_exit(void)
{
  for (size_t i = 0; i < object_count; i++) {
    release(objects[i]);
  }
  free(objects);
  objects = NULL;
  object_count = object_room = 0;
  dea_context_free(ctx);
  ctx = NULL;
}

static void begin(void)
{
  dea_context_options options = DEA_CONTEXT_OPTIONS_INIT;
  options.progress = on_progress;
  options.interrupt = on_interrupt;
  options.note = on_note;
  if (ctx == NULL && dea_context_new(&options, &ctx) != DEA_OK) {
    mexErrMsgIdAndTxt("dea:memory", "%s", dea_error_meaning(DEA_E_MEMORY));
  }
  mexAtExit(at_exit);
}

/* Room for one more object: before it is made, so that none is lost. */
static void make_room(void)
{
  if (object_count == object_room) {
    size_t room = 2 * object_room + 16;
    struct object *moved = realloc(objects, room * sizeof *moved);
    if (moved == NULL) {
      mexErrMsgIdAndTxt("dea:memory", "%s", dea_error_meaning(DEA_E_MEMORY));
    }
    objects = moved;
    object_room = room;
  }
}

// What MATLAB gives -------------------------------------------------------------------------------

struct call {
  int outputs;
  mxArray **out;
  int inputs;
  const mxArray **in;
};

static char *get_text(const struct call *call, int i)
{
  if (!mxIsChar(call->in[i])) {
    mexErrMsgIdAndTxt("dea:argument", "argument %d is not a text", i);
  }
#ifdef HAVE_OCTAVE
  return mxArrayToString(call->in[i]);
#else
  return mxArrayToUTF8String(call->in[i]);
#endif
}

/* NULL for an empty one. */
static char *get_text_or_null(const struct call *call, int i)
{
  return mxIsEmpty(call->in[i]) ? NULL : get_text(call, i);
}

static double get_number(const struct call *call, int i)
{
  if (!mxIsNumeric(call->in[i]) && !mxIsLogical(call->in[i])) {
    mexErrMsgIdAndTxt("dea:argument", "argument %d is not a number", i);
  }
  return mxGetScalar(call->in[i]);
}

static int get_flag(const struct call *call, int i)
{
  return get_number(call, i) != 0;
}

/* A cell array of texts; NULL for an empty one. */
static const char **get_texts(const struct call *call, int i, size_t *count)
{
  *count = mxIsCell(call->in[i]) ? mxGetNumberOfElements(call->in[i]) : 0;
  const char **texts = *count > 0 ? mxCalloc(*count, sizeof *texts) : NULL;
  for (size_t k = 0; k < *count; k++) {
    const mxArray *one = mxGetCell(call->in[i], (mwIndex)k);
    const struct call of_one = {0, NULL, 1, &one};
    if (one == NULL || !mxIsChar(one)) {
      mexErrMsgIdAndTxt("dea:argument", "item %lu of argument %d is not a text",
                        (unsigned long)k + 1, i);
    }
    texts[k] = get_text(&of_one, 0);
  }
  return texts;
}

static struct object *find_object(const struct call *call, int i, enum kind kind)
{
  uint64_t id = (uint64_t)get_number(call, i);
  for (size_t k = 0; k < object_count; k++) {
    if (objects[k].id == id && objects[k].kind == kind) {
      return &objects[k];
    }
  }
  mexErrMsgIdAndTxt("dea:argument", "this %s is no longer there", kind_names[kind]);
  return NULL;
}

static void *get_handle(const struct call *call, int i, enum kind kind)
{
  return find_object(call, i, kind)->handle;
}

// What MATLAB gets --------------------------------------------------------------------------------

static mxArray *from_text(const char *text)
{
  return mxCreateString(text != NULL ? text : "");
}

/* The library's numbers are row by row, MATLAB's column by column. */
static mxArray *from_array(const dea_array *array)
{
  const size_t *n = array->shape;
  mwSize sizes[3] = {(mwSize)n[0], (mwSize)n[1], (mwSize)n[2]};
  mxArray *out = mxCreateNumericArray(n[2] > 1 ? 3 : 2, sizes, mxDOUBLE_CLASS, mxREAL);
  double *to = mxGetPr(out);
  for (size_t i = 0; i < n[0]; i++) {
    for (size_t j = 0; j < n[1]; j++) {
      for (size_t k = 0; k < n[2]; k++) {
        to[i + n[0] * (j + n[1] * k)] = array->data[(i * n[1] + j) * n[2] + k];
      }
    }
  }
  return out;
}

static mxArray *from_id(uint64_t id)
{
  return mxCreateDoubleScalar((double)id);
}

/* Puts a new object into the table, where there is room, and gives its number. */
static mxArray *from_object(enum kind kind, void *handle)
{
  if (object_count == 0) {
    mexLock(); // as long as there are objects
  }
  struct object object = {++last_id, kind, handle};
  objects[object_count++] = object;
  return from_id(object.id);
}

/* An array of structs with these members. */
static mxArray *make_structs(size_t count, int members, const char **names)
{
  return mxCreateStructMatrix((mwSize)count, 1, members, names);
}

#define MAKE_STRUCTS(count, names) make_structs(count, (int)(sizeof names / sizeof names[0]), names)

static void put(mxArray *structs, size_t i, const char *name, mxArray *value)
{
  mxSetField(structs, (mwIndex)i, name, value);
}

static void put_text(mxArray *structs, size_t i, const char *name, const char *text)
{
  put(structs, i, name, from_text(text));
}

static void put_number(mxArray *structs, size_t i, const char *name, double value)
{
  put(structs, i, name, mxCreateDoubleScalar(value));
}

static mxArray *from_findings(void)
{
  static const char *const severities[] = {"note", "warning", "error"};
  const char *names[] = {"severity", "text", "file", "line", "column"};
  const dea_finding *finding;
  size_t count = 0;
  while (dea_finding_at(ctx, count) != NULL) {
    count++;
  }
  mxArray *out = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (finding = dea_finding_at(ctx, i)) != NULL; i++) {
    put_text(out, i, "severity", severities[finding->severity]);
    put_text(out, i, "text", finding->text);
    put_text(out, i, "file", finding->file);
    put_number(out, i, "line", (double)finding->line);
    put_number(out, i, "column", (double)finding->column);
  }
  return out;
}

// Errors ------------------------------------------------------------------------------------------

/* "dea:not_converged" for DEA_E_NOT_CONVERGED. */
static void name_error(dea_status status, char *out, size_t size)
{
  const char *name = dea_error_name(status);
  name = strncmp(name, "DEA_E_", 6) == 0 ? name + 6 : name;
  snprintf(out, size, "dea:%s", name);
  for (char *c = out; *c != '\0'; c++) {
    *c = (char)tolower((unsigned char)*c);
  }
}

/* Raises an error unless the status is DEA_OK: the message, for a design with its findings. */
static void check(dea_status status)
{
  static const char *const severities[] = {"note: ", "warning: ", "error: "};
  char id[64], text[8000];
  const dea_finding *finding;
  if (status == DEA_OK) {
    return;
  }
  const char *message = dea_error_message(ctx);
  size_t used = (size_t)snprintf(text, sizeof text, "%.1000s",
                                 message[0] != '\0' ? message : dea_error_meaning(status));
  for (size_t i = 0; status == DEA_E_DESIGN && (finding = dea_finding_at(ctx, i)) != NULL &&
                     used + 700 < sizeof text;
       i++) {
    used += (size_t)snprintf(text + used, sizeof text - used, "\n  ");
    if (finding->line > 0) {
      used += (size_t)snprintf(text + used, sizeof text - used, "%.100s:%lu:%lu: ", finding->file,
                               (unsigned long)finding->line, (unsigned long)finding->column);
    } else if (finding->file[0] != '\0') {
      used += (size_t)snprintf(text + used, sizeof text - used, "%.100s: ", finding->file);
    }
    used += (size_t)snprintf(text + used, sizeof text - used, "%s%.400s",
                             severities[finding->severity], finding->text);
  }
  name_error(status, id, sizeof id);
  mexErrMsgIdAndTxt(id, "%s", text);
}

// Commands: what is there -------------------------------------------------------------------------

static void get_version(struct call *call)
{
  call->out[0] = from_text(dea_version());
}

static mxArray *from_abilities(unsigned abilities)
{
  static const char *const names[] = {"path",    "profile", "indent", "modes",
                                      "respond", "fields",  "time",   "refine"};
  size_t count = 0, used = 0;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    count += (abilities >> i) & 1u;
  }
  mxArray *out = mxCreateCellMatrix(1, (mwSize)count);
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    if ((abilities >> i) & 1u) {
      mxSetCell(out, (mwIndex)used++, from_text(names[i]));
    }
  }
  return out;
}

static void get_models(struct call *call)
{
  const char *names[] = {"name", "title", "abilities", "available", "layout_abilities"};
  const dea_model_info *model;
  size_t count = 0;
  while (dea_model_at(ctx, count) != NULL) {
    count++;
  }
  call->out[0] = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (model = dea_model_at(ctx, i)) != NULL; i++) {
    put_text(call->out[0], i, "name", model->name);
    put_text(call->out[0], i, "title", model->title);
    put(call->out[0], i, "abilities", from_abilities(model->abilities));
    put(call->out[0], i, "available", mxCreateLogicalScalar(model->available != 0));
    put(call->out[0], i, "layout_abilities", from_abilities(model->layout_abilities));
  }
}

static void get_studies(struct call *call)
{
  const char *names[] = {"name", "needs"};
  const dea_study_info *study;
  size_t count = 0;
  while (dea_study_at(ctx, count) != NULL) {
    count++;
  }
  call->out[0] = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (study = dea_study_at(ctx, i)) != NULL; i++) {
    put_text(call->out[0], i, "name", study->name);
    put_text(call->out[0], i, "needs", study->needs);
  }
}

static void get_findings(struct call *call)
{
  call->out[0] = from_findings();
}

/* One that is not there is no error: its destructor may run after clear or exit. */
static void free_object(struct call *call)
{
  uint64_t id = (uint64_t)get_number(call, 1);
  for (size_t i = 0; i < object_count; i++) {
    if (objects[i].id == id) {
      release(objects[i]);
      objects[i] = objects[--object_count];
      if (object_count == 0) {
        mexUnlock();
      }
      return;
    }
  }
}

// Commands: designs -------------------------------------------------------------------------------

static void open_design(struct call *call)
{
  dea_design *design;
  check(dea_design_open(ctx, get_text(call, 1), &design));
  call->out[0] = from_object(DESIGN, design);
}

static void parse_design(struct call *call)
{
  dea_design *design;
  check(dea_design_parse(ctx, get_text(call, 1), get_text(call, 2), &design));
  call->out[0] = from_object(DESIGN, design);
}

static void copy_design(struct call *call)
{
  dea_design *copy;
  check(dea_design_copy(ctx, get_handle(call, 1, DESIGN), &copy));
  call->out[0] = from_object(DESIGN, copy);
}

static void set_design(struct call *call)
{
  size_t keys, values;
  dea_design *design = get_handle(call, 1, DESIGN);
  const char **key = get_texts(call, 2, &keys), **value = get_texts(call, 3, &values);
  if (keys != values) {
    mexErrMsgIdAndTxt("dea:argument", "%lu keys and %lu values", (unsigned long)keys,
                      (unsigned long)values);
  }
  check(dea_design_set_all(ctx, design, key, value, keys));
}

static void put_value(mxArray *structs, size_t i, const dea_value *value)
{
  static const char *const origins[] = {"absent", "default", "given", "set"};
  put_text(structs, i, "key", value->key);
  put_text(structs, i, "text", value->text);
  put_number(structs, i, "si", value->si);
  put_text(structs, i, "unit", value->unit);
  put_text(structs, i, "origin", origins[value->origin]);
  put_number(structs, i, "line", (double)value->line);
  put_number(structs, i, "column", (double)value->column);
}

static mxArray *make_values(size_t count)
{
  const char *names[] = {"key", "text", "si", "unit", "origin", "line", "column"};
  return MAKE_STRUCTS(count, names);
}

static void get_value(struct call *call)
{
  const dea_value *value;
  check(dea_design_get(ctx, get_handle(call, 1, DESIGN), get_text(call, 2), &value));
  call->out[0] = make_values(1);
  put_value(call->out[0], 0, value);
}

static void get_values(struct call *call)
{
  const dea_design *design = get_handle(call, 1, DESIGN);
  const dea_value *value;
  size_t count = 0;
  while (dea_design_value_at(design, count) != NULL) {
    count++;
  }
  call->out[0] = make_values(count);
  for (size_t i = 0; (value = dea_design_value_at(design, i)) != NULL; i++) {
    put_value(call->out[0], i, value);
  }
}

static void get_design_yaml(struct call *call)
{
  const char *text;
  check(dea_design_text(ctx, get_handle(call, 1, DESIGN), &text));
  call->out[0] = from_text(text);
}

static void save_design(struct call *call)
{
  check(dea_design_write(ctx, get_handle(call, 1, DESIGN), get_text(call, 2)));
}

static void check_design(struct call *call)
{
  check(dea_design_check(ctx, get_handle(call, 1, DESIGN)));
  call->out[0] = from_findings();
}

static void get_design_svg(struct call *call)
{
  const char *svg;
  check(dea_design_svg(ctx, get_handle(call, 1, DESIGN), &svg));
  call->out[0] = from_text(svg);
}

// Commands: runs and results ----------------------------------------------------------------------

/* design, models, studies, folder, replace, resume, figures, quiet -> result, status. With one
 * output a run that ended early is an error and its points are lost; with two they are kept, and
 * so does the script that calls go on after Ctrl-C. */
static void run(struct call *call)
{
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  const dea_design *design = get_handle(call, 1, DESIGN);
  dea_result *result = NULL;
  options.models = get_texts(call, 2, &options.model_count);
  options.studies = get_texts(call, 3, &options.study_count);
  options.folder = get_text_or_null(call, 4);
  options.replace = get_flag(call, 5);
  options.resume = get_flag(call, 6);
  options.no_figures = !get_flag(call, 7);
  run_state.quiet = get_flag(call, 8);
  run_state.told = time(NULL);
  dea_status status = dea_run(ctx, design, &options, &result);
  if (result == NULL || (status != DEA_OK && call->outputs < 2)) {
    dea_result_free(result);
    check(status);
  }
  if (status == DEA_E_INTERRUPTED) {
    clear_interrupt();
  }
  call->out[0] = from_object(RESULT, result);
  if (call->outputs > 1) {
    call->out[1] = from_text(status == DEA_OK ? "" : dea_error_message(ctx));
  }
}

static void open_result(struct call *call)
{
  dea_result *result;
  check(dea_result_open(ctx, get_text(call, 1), &result));
  call->out[0] = from_object(RESULT, result);
}

static void get_arrays(struct call *call)
{
  const char *names[] = {"name", "unit", "meaning", "size"};
  const dea_result *result = get_handle(call, 1, RESULT);
  const dea_array *array;
  size_t count = 0;
  while (dea_result_array_at(result, count) != NULL) {
    count++;
  }
  call->out[0] = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (array = dea_result_array_at(result, i)) != NULL; i++) {
    mxArray *size = mxCreateDoubleMatrix(1, 3, mxREAL);
    for (size_t k = 0; k < 3; k++) {
      mxGetPr(size)[k] = (double)array->shape[k];
    }
    put_text(call->out[0], i, "name", array->name);
    put_text(call->out[0], i, "unit", array->unit);
    put_text(call->out[0], i, "meaning", array->meaning);
    put(call->out[0], i, "size", size);
  }
}

static void get_array(struct call *call)
{
  const dea_array *array;
  check(dea_result_array(ctx, get_handle(call, 1, RESULT), get_text(call, 2), &array));
  call->out[0] = from_array(array);
  if (call->outputs > 1) {
    call->out[1] = from_text(array->unit);
  }
  if (call->outputs > 2) {
    call->out[2] = from_text(array->meaning);
  }
}

static void get_result_text(struct call *call)
{
  const char *text;
  check(dea_result_text(ctx, get_handle(call, 1, RESULT), get_text(call, 2), &text));
  call->out[0] = from_text(text);
}

static void get_figure(struct call *call)
{
  const char *svg;
  check(dea_result_svg(ctx, get_handle(call, 1, RESULT), get_text(call, 2), &svg));
  call->out[0] = from_text(svg);
}

/* result, folder, replace, figures */
static void write_result(struct call *call)
{
  dea_run_options options = DEA_RUN_OPTIONS_INIT;
  const dea_result *result = get_handle(call, 1, RESULT);
  const char *folder = get_text(call, 2);
  options.replace = get_flag(call, 3);
  options.no_figures = !get_flag(call, 4);
  check(dea_result_write(ctx, result, folder, &options));
}

static void save_result(struct call *call)
{
  check(dea_result_save(ctx, get_handle(call, 1, RESULT), get_text(call, 2)));
}

static void get_result_design(struct call *call)
{
  dea_design *design;
  check(dea_result_design(ctx, get_handle(call, 1, RESULT), &design));
  call->out[0] = from_object(DESIGN, design);
}

// Commands: meshes --------------------------------------------------------------------------------

/* Nodes count from 1, as MATLAB does; one row a cell. */
static mxArray *from_cells(const dea_mesh *mesh)
{
  const char *names[] = {"order", "order_z", "nodes"};
  mxArray *out = MAKE_STRUCTS(mesh->cells_count, names);
  for (size_t b = 0; b < mesh->cells_count; b++) {
    const dea_cells *cells = mesh->cells[b];
    mxArray *nodes =
        mxCreateDoubleMatrix((mwSize)cells->count, (mwSize)cells->nodes_per_cell, mxREAL);
    double *to = mxGetPr(nodes);
    for (size_t i = 0; i < cells->count * cells->nodes_per_cell; i++) {
      to[i / cells->nodes_per_cell + cells->count * (i % cells->nodes_per_cell)] =
          1.0 + cells->nodes[i];
    }
    put_number(out, b, "order", cells->order);
    put_number(out, b, "order_z", cells->order_z);
    put(out, b, "nodes", nodes);
  }
  return out;
}

static mxArray *from_field(const dea_field *field)
{
  static const char *const kinds[] = {"values", "vector", "axis"};
  const char *names[] = {"unit", "meaning", "kind", "of_cells"};
  mxArray *out = MAKE_STRUCTS(1, names);
  put_text(out, 0, "unit", field->array->unit);
  put_text(out, 0, "meaning", field->array->meaning);
  put_text(out, 0, "kind", kinds[field->kind]);
  put(out, 0, "of_cells", mxCreateLogicalScalar(field->of_cells != 0));
  return out;
}

static mxArray *from_mesh(const dea_mesh *mesh)
{
  const char *names[] = {"name",   "voltage_V", "points", "cells",
                         "fields", "about",     "fold",   "symmetry_angle_rad"};
  const dea_array points = {"points", "m", "", 2, {mesh->point_count, 3, 1}, mesh->points_m};
  mxArray *out = MAKE_STRUCTS(1, names), *fields = make_structs(1, 0, NULL),
          *about = make_structs(1, 0, NULL);
  for (size_t i = 0; i < mesh->field_count; i++) {
    const char *name = mesh->fields[i]->array->name;
    mxAddField(fields, name);
    mxAddField(about, name);
    put(fields, 0, name, from_array(mesh->fields[i]->array));
    put(about, 0, name, from_field(mesh->fields[i]));
  }
  put_text(out, 0, "name", mesh->name);
  put_number(out, 0, "voltage_V", mesh->voltage_V);
  put(out, 0, "points", from_array(&points));
  put(out, 0, "cells", from_cells(mesh));
  put(out, 0, "fields", fields);
  put(out, 0, "about", about);
  put_number(out, 0, "fold", mesh->fold);
  put_number(out, 0, "symmetry_angle_rad", mesh->symmetry_angle_rad);
  return out;
}

static void get_meshes(struct call *call)
{
  const dea_result *result = get_handle(call, 1, RESULT);
  const dea_mesh *mesh;
  size_t count = 0;
  while (dea_result_mesh_at(result, count) != NULL) {
    count++;
  }
  call->out[0] = mxCreateCellMatrix(1, (mwSize)count);
  for (size_t i = 0; (mesh = dea_result_mesh_at(result, i)) != NULL; i++) {
    mxSetCell(call->out[0], (mwIndex)i, from_text(mesh->name));
  }
}

/* result, name, whole */
static void get_mesh(struct call *call)
{
  const dea_mesh *mesh;
  check(dea_result_mesh(ctx, get_handle(call, 1, RESULT), get_text(call, 2), get_flag(call, 3),
                        &mesh));
  call->out[0] = from_mesh(mesh);
}

// Commands: actuators -----------------------------------------------------------------------------

static void open_actuator(struct call *call)
{
  dea_actuator *actuator;
  check(dea_actuator_open(ctx, get_handle(call, 1, DESIGN), get_text(call, 2), &actuator));
  call->out[0] = from_object(ACTUATOR, actuator);
}

static void solve_actuator(struct call *call)
{
  run_state.quiet = 1;
  check(dea_actuator_solve(ctx, get_handle(call, 1, ACTUATOR), get_number(call, 2)));
}

/* actuator, depth_m, radius_m, shape */
static void indent_actuator(struct call *call)
{
  static const char *const shapes[] = {"sphere", "flat", "cylinder"};
  const char *shape = get_text(call, 4);
  int i = DEA_SPHERE;
  while (i <= (int)DEA_LYING_CYLINDER && strcmp(shape, shapes[i]) != 0) {
    i++;
  }
  if (i > (int)DEA_LYING_CYLINDER) {
    mexErrMsgIdAndTxt("dea:argument",
                      "there is no indenter '%.50s', only sphere, flat and cylinder", shape);
  }
  run_state.quiet = 1;
  check(dea_actuator_indent(ctx, get_handle(call, 1, ACTUATOR), (dea_indenter_shape)i,
                            get_number(call, 3), get_number(call, 2)));
}

static void get_quantity(struct call *call)
{
  double value;
  check(dea_actuator_get(ctx, get_handle(call, 1, ACTUATOR), get_text(call, 2), &value));
  call->out[0] = mxCreateDoubleScalar(value);
}

static void get_actuator_mesh(struct call *call)
{
  const dea_mesh *mesh;
  check(dea_actuator_mesh(ctx, get_handle(call, 1, ACTUATOR), &mesh));
  call->out[0] = from_mesh(mesh);
}

// Commands: solids --------------------------------------------------------------------------------

/* A member of struct i of an array of structs. */
static const mxArray *get_member(const mxArray *structs, size_t i, const char *name)
{
  const mxArray *member = mxIsStruct(structs) ? mxGetField(structs, (mwIndex)i, name) : NULL;
  if (member == NULL) {
    mexErrMsgIdAndTxt("dea:argument", "there is no member '%s'", name);
  }
  return member;
}

/* Its numbers, column by column; NULL for an empty one. */
static const double *get_numbers(const mxArray *from, size_t *count)
{
  *count = mxGetNumberOfElements(from);
  if (*count > 0 && (!mxIsDouble(from) || mxIsComplex(from))) {
    mexErrMsgIdAndTxt("dea:argument", "an array of doubles is due");
  }
  return *count > 0 ? mxGetPr(from) : NULL;
}

/* Whole numbers, less `first`; NULL for an empty one. */
static int *get_whole(const mxArray *from, int first, size_t *count)
{
  const double *numbers = get_numbers(from, count);
  int *out = numbers != NULL ? mxCalloc(*count, sizeof *out) : NULL;
  for (size_t i = 0; i < *count; i++) {
    if (!(numbers[i] >= 0 && numbers[i] <= INT_MAX)) {
      mexErrMsgIdAndTxt("dea:argument", "%g is no number of something", numbers[i]);
    }
    out[i] = (int)numbers[i] - first;
  }
  return out;
}

/* One that counts from 1. */
static size_t get_index(double from)
{
  if (!(from >= 1 && from <= INT_MAX)) {
    mexErrMsgIdAndTxt("dea:argument", "%g is no number of something: they count from 1", from);
  }
  return (size_t)from - 1;
}

/* x, y, z; NULL for an empty one. */
static const double *get_vector(const mxArray *from)
{
  size_t count;
  const double *out = get_numbers(from, &count);
  if (count != 0 && count != 3) {
    mexErrMsgIdAndTxt("dea:argument", "three numbers are due, not %lu", (unsigned long)count);
  }
  return out;
}

static double member_number(const mxArray *structs, size_t i, const char *name)
{
  const mxArray *one = get_member(structs, i, name);
  const struct call of_one = {0, NULL, 1, &one};
  return get_number(&of_one, 0);
}

/* NULL for an empty one. */
static char *member_text(const mxArray *structs, size_t i, const char *name)
{
  const mxArray *one = get_member(structs, i, name);
  const struct call of_one = {0, NULL, 1, &one};
  return get_text_or_null(&of_one, 0);
}

static void take_vector(const double *from, double out[3])
{
  for (int i = 0; from != NULL && i < 3; i++) {
    out[i] = from[i];
  }
}

static const dea_part *take_part(const mxArray *parts, size_t i)
{
  dea_part *out = mxCalloc(1, sizeof *out);
  out->size = sizeof *out;
  out->law = member_text(parts, i, "law");
  out->parameters = get_numbers(get_member(parts, i, "parameters"), &out->parameter_count);
  out->young_modulus_Pa = member_number(parts, i, "young_modulus_Pa");
  out->poisson_ratio = member_number(parts, i, "poisson_ratio");
  out->bulk_modulus_Pa = member_number(parts, i, "bulk_modulus_Pa");
  out->pre_stretch = member_number(parts, i, "pre_stretch");
  out->permittivity = member_number(parts, i, "permittivity");
  out->electrode_gap_m = member_number(parts, i, "electrode_gap_m");
  out->density_kg_per_m3 = member_number(parts, i, "density_kg_per_m3");
  out->channel_above = (int)member_number(parts, i, "channel_above");
  out->channel_below = (int)member_number(parts, i, "channel_below");
  return out;
}

static const dea_body *take_body(const mxArray *bodies, size_t i)
{
  dea_body *out = mxCalloc(1, sizeof *out);
  out->size = sizeof *out;
  out->curve = member_text(bodies, i, "curve");
  out->nodes = get_whole(get_member(bodies, i, "nodes"), 1, &out->node_count);
  take_vector(get_vector(get_member(bodies, i, "low_m")), out->low_m);
  take_vector(get_vector(get_member(bodies, i, "high_m")), out->high_m);
  take_vector(get_vector(get_member(bodies, i, "centre_m")), out->centre_m);
  return out;
}

static dea_fill *take_fills(const mxArray *fills, size_t count)
{
  dea_fill *out = mxCalloc(count + 1, sizeof *out);
  for (size_t i = 0; i < count; i++) {
    out[i].ply = get_index(member_number(fills, i, "ply"));
    out[i].group = member_text(fills, i, "group");
    out[i].part = get_index(member_number(fills, i, "part"));
  }
  return out;
}

/* points_m and cells: one column a point and a cell. */
static void take_mesh(const mxArray *from, dea_solid_options *out)
{
  size_t count, nodes;
  const double *elements = get_vector(get_member(from, 0, "elements"));
  const double *box = get_vector(get_member(from, 0, "box_m"));
  out->order = (int)member_number(from, 0, "order");
  out->order_z = (int)member_number(from, 0, "order_z");
  take_vector(box, out->box_m);
  for (int i = 0; box != NULL && elements != NULL && i < 3; i++) {
    out->elements[i] = get_index(elements[i]) + 1;
  }
  out->points_m = get_numbers(get_member(from, 0, "points_m"), &count);
  out->point_count = count / 3;
  out->cells = get_whole(get_member(from, 0, "cells"), 1, &count);
  nodes = (size_t)(out->order + 1) * (size_t)(out->order + 1) * (size_t)(out->order_z + 1);
  if (out->order < 1 || out->order_z < 1 || count % nodes != 0) {
    mexErrMsgIdAndTxt("dea:argument", "cells of order %d and %d have %lu nodes", out->order,
                      out->order_z, (unsigned long)nodes);
  }
  out->cell_count = count / nodes;
  out->part_of = get_whole(get_member(from, 0, "part_of"), 1, &count);
  if (count != 0 && count != out->cell_count) {
    mexErrMsgIdAndTxt("dea:argument", "parts of %lu cells for %lu", (unsigned long)count,
                      (unsigned long)out->cell_count);
  }
}

static void take_plies(const mxArray *from, dea_solid_options *out)
{
  size_t count;
  const mxArray *fills = get_member(from, 0, "fills");
  out->msh_file = member_text(from, 0, "msh_file");
  out->msh_unit_m = member_number(from, 0, "msh_unit_m");
  out->ply_thickness_m = get_numbers(get_member(from, 0, "ply_thickness_m"), &out->ply_count);
  const int *elements = get_whole(get_member(from, 0, "ply_elements"), 0, &count);
  if (count != 0 && count != out->ply_count) {
    mexErrMsgIdAndTxt("dea:argument", "numbers of elements of %lu plies for %lu",
                      (unsigned long)count, (unsigned long)out->ply_count);
  }
  size_t *through = count > 0 ? mxCalloc(count, sizeof *through) : NULL;
  for (size_t i = 0; i < count; i++) {
    through[i] = (size_t)elements[i];
  }
  out->ply_elements = through;
  out->fill_count = mxIsStruct(fills) ? mxGetNumberOfElements(fills) : 0;
  out->fills = take_fills(fills, out->fill_count);
}

/* parts, bodies, options: structs as dea.Part, dea.Body and dea.Solid make them. */
static void new_solid(struct call *call)
{
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  const mxArray *parts = call->in[1], *bodies = call->in[2];
  dea_solid *solid;
  options.part_count = mxIsStruct(parts) ? mxGetNumberOfElements(parts) : 0;
  options.body_count = mxIsStruct(bodies) ? mxGetNumberOfElements(bodies) : 0;
  const dea_part **part = mxCalloc(options.part_count + 1, sizeof *part);
  const dea_body **body = mxCalloc(options.body_count + 1, sizeof *body);
  for (size_t i = 0; i < options.part_count; i++) {
    part[i] = take_part(parts, i);
  }
  for (size_t i = 0; i < options.body_count; i++) {
    body[i] = take_body(bodies, i);
  }
  options.parts = part;
  options.bodies = body;
  take_mesh(call->in[3], &options);
  take_plies(call->in[3], &options);
  check(dea_solid_new(ctx, &options, &solid));
  call->out[0] = from_object(SOLID, solid);
}

/* solid, components, displacement (empty: free), low, high, curve, nodes (empty: by the place) */
static void hold(struct call *call)
{
  dea_solid *solid = get_handle(call, 1, SOLID);
  int components = (int)get_number(call, 2);
  const double *move = get_vector(call->in[3]), *low = get_vector(call->in[4]);
  const double *high = get_vector(call->in[5]);
  const char *curve = get_text_or_null(call, 6);
  size_t count;
  const int *nodes = get_whole(call->in[7], 1, &count);
  if (nodes != NULL) {
    check(dea_solid_hold_nodes(ctx, solid, nodes, count, components, move));
  } else if (curve != NULL) {
    check(dea_solid_hold_curve(ctx, solid, curve, low, high, components, move));
  } else {
    check(dea_solid_hold(ctx, solid, low, high, components, move));
  }
}

/* solid, body, components, shift, turn (both empty: free) */
static void hold_body(struct call *call)
{
  check(dea_solid_hold_body(ctx, get_handle(call, 1, SOLID), get_index(get_number(call, 2)),
                            (int)get_number(call, 3), get_vector(call->in[4]),
                            get_vector(call->in[5])));
}

/* solid, body, force, moment */
static void push_body(struct call *call)
{
  double force[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  take_vector(get_vector(call->in[3]), force);
  take_vector(get_vector(call->in[4]), moment);
  check(dea_solid_push_body(ctx, get_handle(call, 1, SOLID), get_index(get_number(call, 2)), force,
                            moment));
}

/* solid, body, component, place, stiffness, table's displacements and forces (empty: none) */
static void add_spring(struct call *call)
{
  dea_body_spring spring = DEA_BODY_SPRING_INIT;
  size_t forces;
  spring.body = get_index(get_number(call, 2));
  spring.component = (int)get_number(call, 3);
  spring.place = get_number(call, 4);
  spring.stiffness = get_number(call, 5);
  spring.at = get_numbers(call->in[6], &spring.count);
  spring.force = get_numbers(call->in[7], &forces);
  if (forces != spring.count) {
    mexErrMsgIdAndTxt("dea:argument", "%lu displacements and %lu forces",
                      (unsigned long)spring.count, (unsigned long)forces);
  }
  check(dea_solid_add_spring(ctx, get_handle(call, 1, SOLID), &spring));
}

static void move_spring(struct call *call)
{
  check(dea_solid_move_spring(ctx, get_handle(call, 1, SOLID), get_index(get_number(call, 2)),
                              get_number(call, 3)));
}

/* solid, traction, low, high */
static void pull(struct call *call)
{
  double traction[3] = {0, 0, 0};
  take_vector(get_vector(call->in[2]), traction);
  check(dea_solid_pull(ctx, get_handle(call, 1, SOLID), get_vector(call->in[3]),
                       get_vector(call->in[4]), traction));
}

static void set_channel(struct call *call)
{
  check(dea_solid_set_channel(ctx, get_handle(call, 1, SOLID), (int)get_number(call, 2),
                              get_number(call, 3)));
}

static void solve_solid(struct call *call)
{
  run_state.quiet = 1;
  check(dea_solid_solve(ctx, get_handle(call, 1, SOLID), get_number(call, 2)));
}

static void find_charges(struct call *call)
{
  check(dea_solid_find_charges(ctx, get_handle(call, 1, SOLID)));
}

static void find_modes(struct call *call)
{
  check(dea_solid_modes(ctx, get_handle(call, 1, SOLID), get_index(get_number(call, 2)) + 1));
}

/* solid, voltage, step, unit */
static void begin_path(struct call *call)
{
  check(dea_solid_path_begin(ctx, get_handle(call, 1, SOLID), get_number(call, 2),
                             get_number(call, 3), get_number(call, 4)));
}

static void step_path(struct call *call)
{
  run_state.quiet = 1;
  check(dea_solid_path_step(ctx, get_handle(call, 1, SOLID)));
}

/* A number or an array by its name, and its unit. */
static void get_of_solid(struct call *call)
{
  dea_solid *solid = get_handle(call, 1, SOLID);
  const char *name = get_text(call, 2), *unit = "";
  const dea_array *array;
  double number;
  if (dea_solid_number(ctx, solid, name, &number) == DEA_OK) {
    call->out[0] = mxCreateDoubleScalar(number);
  } else {
    check(dea_solid_array(ctx, solid, name, &array));
    call->out[0] = from_array(array);
    unit = array->unit;
  }
  if (call->outputs > 1) {
    call->out[1] = from_text(unit);
  }
}

static void get_solid_mesh(struct call *call)
{
  const dea_mesh *mesh;
  check(dea_solid_mesh(ctx, get_handle(call, 1, SOLID), &mesh));
  call->out[0] = from_mesh(mesh);
}

static void get_settings(struct call *call)
{
  const char *names[] = {"name", "unit", "meaning", "value"};
  const dea_solid *solid = get_handle(call, 1, SOLID);
  const dea_solid_setting *setting;
  size_t count = 0;
  while (dea_solid_setting_at(ctx, solid, count) != NULL) {
    count++;
  }
  call->out[0] = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (setting = dea_solid_setting_at(ctx, solid, i)) != NULL; i++) {
    put_text(call->out[0], i, "name", setting->name);
    put_text(call->out[0], i, "unit", setting->unit);
    put_text(call->out[0], i, "meaning", setting->meaning);
    put_number(call->out[0], i, "value", setting->value);
  }
}

static void set_setting(struct call *call)
{
  check(dea_solid_set(ctx, get_handle(call, 1, SOLID), get_text(call, 2), get_number(call, 3)));
}

static void get_laws(struct call *call)
{
  const char *names[] = {"name", "title", "parameters"};
  const dea_law_info *law;
  size_t count = 0;
  while (dea_law_at(ctx, count) != NULL) {
    count++;
  }
  call->out[0] = MAKE_STRUCTS(count, names);
  for (size_t i = 0; (law = dea_law_at(ctx, i)) != NULL; i++) {
    put_text(call->out[0], i, "name", law->name);
    put_text(call->out[0], i, "title", law->title);
    put_text(call->out[0], i, "parameters", law->parameters);
  }
}

// -------------------------------------------------------------------------------------------------

static const struct {
  const char *name;
  int inputs; // after the name
  void (*function)(struct call *call);
} commands[] = {
    {"version", 0, get_version},
    {"models", 0, get_models},
    {"studies", 0, get_studies},
    {"findings", 0, get_findings},
    {"free", 1, free_object},
    {"design_open", 1, open_design},
    {"design_parse", 2, parse_design},
    {"design_copy", 1, copy_design},
    {"design_set", 3, set_design},
    {"design_get", 2, get_value},
    {"design_values", 1, get_values},
    {"design_yaml", 1, get_design_yaml},
    {"design_save", 2, save_design},
    {"design_check", 1, check_design},
    {"design_svg", 1, get_design_svg},
    {"run", 8, run},
    {"result_open", 1, open_result},
    {"result_arrays", 1, get_arrays},
    {"result_array", 2, get_array},
    {"result_text", 2, get_result_text},
    {"result_figure", 2, get_figure},
    {"result_write", 4, write_result},
    {"result_save", 2, save_result},
    {"result_design", 1, get_result_design},
    {"result_meshes", 1, get_meshes},
    {"result_mesh", 3, get_mesh},
    {"actuator_open", 2, open_actuator},
    {"actuator_solve", 2, solve_actuator},
    {"actuator_indent", 4, indent_actuator},
    {"actuator_get", 2, get_quantity},
    {"actuator_mesh", 1, get_actuator_mesh},
    {"laws", 0, get_laws},
    {"solid_new", 3, new_solid},
    {"solid_hold", 7, hold},
    {"solid_hold_body", 5, hold_body},
    {"solid_push_body", 4, push_body},
    {"solid_add_spring", 7, add_spring},
    {"solid_move_spring", 3, move_spring},
    {"solid_pull", 4, pull},
    {"solid_set_channel", 3, set_channel},
    {"solid_solve", 2, solve_solid},
    {"solid_find_charges", 1, find_charges},
    {"solid_modes", 2, find_modes},
    {"solid_path_begin", 4, begin_path},
    {"solid_path_step", 1, step_path},
    {"solid_get", 2, get_of_solid},
    {"solid_mesh", 1, get_solid_mesh},
    {"solid_settings", 1, get_settings},
    {"solid_set", 3, set_setting},
};

void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[])
{
  struct call call = {nlhs, plhs, nrhs, prhs};
  if (nrhs < 1) {
    mexErrMsgIdAndTxt("dea:argument", "dea_mex is for the functions of the package dea");
  }
  const char *name = get_text(&call, 0);
  begin();
  make_room();
  for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
    if (strcmp(commands[i].name, name) == 0) {
      if (nrhs - 1 != commands[i].inputs) {
        mexErrMsgIdAndTxt("dea:argument", "%s takes %d arguments, not %d", name, commands[i].inputs,
                          nrhs - 1);
      }
      commands[i].function(&call);
      return;
    }
  }
  mexErrMsgIdAndTxt("dea:argument", "dea_mex has no command '%.50s'", name);
}
