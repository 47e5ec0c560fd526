/* Results of the public interface: what studies left, as named arrays and texts. */
#include "api/api.h"

#include "base/write_file.h"
#include "figures/run_figures.h"
#include "io/summary.h"
#include "job/design_of_run.h"
#include "job/job.h"
#include "job/run_folder.h"
#include "plot/plot_svg.h"
#include "result/columns.h"
#include "result/provenance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The options with defaults for what the caller does not know. */
static dea_run_options run_options_of(const dea_run_options *options)
{
  dea_run_options all = DEA_RUN_OPTIONS_INIT;
  if (options != NULL) {
    DOOR_COPY(all, options);
  }
  return all;
}

enum { NAME_SIZE = 4 * DEA_NAME_SIZE };

// The list ---------------------------------------------------------------------------------------

/* An array in the list; its numbers are owned with it. */
struct listed_array {
  dea_array shown;
  char name[NAME_SIZE];
  double values[];
};

/* A list being filled, and where in it. */
struct filling {
  dea_result *result;
  char folder[NAME_SIZE]; // "lumped/sweep"
};

/* Adds an array of that many numbers, to be filled by the caller; NULL after a failure. */
static double *add_array(struct filling *f, const struct dea_column *column, size_t count)
{
  dea_result *result = f->result;
  struct listed_array *array =
      dea_arena_alloc(&result->memory, 1, sizeof *array + count * sizeof array->values[0]);
  result->arrays = api_grow(&result->memory, result->arrays, result->array_count,
                            &result->array_room, sizeof *result->arrays);
  if (result->memory.failed) {
    return NULL;
  }
  snprintf(array->name, sizeof array->name, "%.*s/%s", NAME_SIZE / 2, f->folder, column->key);
  array->shown = (dea_array){.name = array->name,
                             .unit = column->si_unit,
                             .meaning = column->meaning,
                             .rank = 1,
                             .shape = {count, 1, 1},
                             .data = array->values};
  result->arrays[result->array_count++] = &array->shown;
  return array->values;
}

static void add_text(struct filling *f, const char *key, const char *text)
{
  char name[NAME_SIZE];
  snprintf(name, sizeof name, "%.*s%s%s", NAME_SIZE / 2, f->folder, f->folder[0] != '\0' ? "/" : "",
           key);
  text = text != NULL ? text : "";
  api_texts_add(&f->result->texts, name, strlen(name), text, strlen(text));
}

static void enter(struct filling *f, const char *format, ...) DEA_PRINTF(2, 3);
static void enter(struct filling *f, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  vsnprintf(f->folder, sizeof f->folder, format, args);
  va_end(args);
}

/* Points: a column of those quantities that some point has. */
static void add_points(struct filling *f, const struct dea_load_point *points, size_t count)
{
  const struct dea_context *ctx = f->result->ctx->inner;
  for (int c = 0; c < dea_column_count(ctx); c++) {
    const bool any = dea_points_have(points, count, c);
    double *values = any ? add_array(f, dea_column_at(ctx, c), count) : NULL;
    for (size_t i = 0; i < count && values != NULL; i++) {
      values[i] = dea_point_get(&points[i], c);
    }
  }
  for (int k = 0; k < DEA_POINT_STATES && count > 0; k++) {
    const struct dea_point_state *state = &dea_point_states[k];
    const struct dea_column column = {state->key, "1", "1", 1, state->key, state->meaning};
    double *values = add_array(f, &column, count);
    for (size_t i = 0; i < count && values != NULL; i++) {
      values[i] = state->get(&points[i]);
    }
  }
}

/* Events of one kind after the other, each under its name. */
static void add_events(struct filling *f, const struct dea_curve *curve, const char *folder)
{
  for (int kind = DEA_EVENT_PULL_IN; kind <= (int)DEA_EVENT_BREAKDOWN; kind++) {
    struct dea_load_point *points =
        dea_arena_alloc(&f->result->memory, curve->event_count, sizeof *points);
    size_t count = 0;
    for (size_t i = 0; points != NULL && i < curve->event_count; i++) {
      if ((int)curve->events[i].kind == kind) {
        points[count++] = curve->events[i].point;
      }
    }
    enter(f, "%s/%s", folder, dea_event_name((enum dea_event_kind)kind));
    add_points(f, points, count);
  }
}

static void add_curve(struct filling *f, const struct dea_curve *curve, const char *folder)
{
  enter(f, "%s", folder);
  add_points(f, curve->points, curve->count);
  add_text(f, "status", dea_status_name(curve->status));
  add_text(f, "stopped", curve->stopped);
  add_events(f, curve, folder);
}

static void add_profile(struct filling *f, const struct dea_profile_record *record)
{
  for (int c = 0; c < DEA_PROFILE_COLUMNS && record->count > 0; c++) {
    double *values = add_array(f, &dea_profile_columns[c], record->count);
    if (values != NULL) {
      memcpy(values, record->columns + (size_t)c * record->count, record->count * sizeof *values);
    }
  }
}

static void add_number(struct filling *f, const char *key, const char *unit, const char *meaning,
                       double value)
{
  const struct dea_column column = {key, unit, unit, 1, key, meaning};
  double *values = isnan(value) ? NULL : add_array(f, &column, 1);
  if (values != NULL) {
    values[0] = value;
  }
}

static void add_profiles(struct filling *f, const struct dea_result *inner)
{
  for (size_t i = 0; i < inner->profile_count; i++) {
    const struct dea_profile_record *record = &inner->profiles[i];
    size_t number = 0;
    for (size_t k = 0; k < i; k++) {
      number += strcmp(inner->profiles[k].model, record->model) == 0;
    }
    enter(f, "%s/profiles/%04zu", record->model, number);
    add_profile(f, record);
    add_number(f, "voltage_V", "V", "voltage between the electrodes", record->voltage_V);
  }
}

static void add_variants(struct filling *f, const struct dea_result *inner)
{
  for (size_t i = 0; i < inner->variant_count; i++) {
    const struct dea_variant *variant = &inner->variants[i];
    char folder[NAME_SIZE];
    size_t number = 0;
    for (size_t k = 0; k < i; k++) {
      number += dea_variant_is(&inner->variants[k], variant->curve.model, variant->curve.kind);
    }
    snprintf(folder, sizeof folder, "%s/%s/%04zu", variant->curve.model, variant->curve.kind,
             number);
    add_curve(f, &variant->curve, folder);
    enter(f, "%s", folder);
    add_text(f, "name", variant->name);
    add_number(f, "refinement", "1", "refinement of the mesh", variant->refinement);
    add_number(f, "unknowns", "1", "unknowns of the system",
               variant->size.unknowns > 0 ? (double)variant->size.unknowns : NAN);
    add_number(f, "wall_s", "s", "time that it took", variant->wall_s);
    enter(f, "%s/profile", folder);
    add_profile(f, &variant->profile);
  }
}

static void add_texts(struct filling *f)
{
  const dea_result *result = f->result;
  const struct dea_provenance *p = &result->inner->provenance;
  f->folder[0] = '\0';
  add_text(f, "title", result->run != NULL ? result->run->title : result->design->title.text);
  add_text(f, "file", result->run != NULL ? result->run->design_file : result->design->file);
  add_text(f, "design", p->input);
  add_text(f, "set", p->overrides);
  add_text(f, "program", p->program);
  add_text(f, "libraries", p->libraries);
  add_text(f, "started", p->started);
  add_text(f, "sha256", p->input_sha256);
}

static dea_status add_meshes(dea_result *result)
{
  struct dea_context *ctx = result->ctx->inner;
  const struct dea_result *inner = result->inner;
  result->meshes = dea_arena_alloc(&result->memory, inner->surface_count, sizeof *result->meshes);
  for (size_t i = 0; i < inner->surface_count && !result->memory.failed; i++) {
    const struct dea_surface_record *record = &inner->surfaces[i];
    char name[2 * DEA_NAME_SIZE];
    snprintf(name, sizeof name, "%s/surface/%04zu", record->model, record->point);
    DEA_TRY(ctx,
            api_mesh_create(ctx, name, record->voltage_V, record->mesh, false, &result->meshes[i]));
    result->mesh_count++;
  }
  return result->memory.failed || result->texts.memory.failed ? DEA_E_MEMORY : DEA_OK;
}

/* Fills the list of arrays and texts of a result. */
static dea_status list_result(dea_result *result)
{
  struct filling f = {.result = result};
  const struct dea_result *inner = result->inner;
  add_texts(&f);
  for (size_t i = 0; i < inner->curve_count; i++) {
    char folder[NAME_SIZE];
    snprintf(folder, sizeof folder, "%s/%s", inner->curves[i].model, inner->curves[i].kind);
    add_curve(&f, &inner->curves[i], folder);
  }
  add_profiles(&f, inner);
  add_variants(&f, inner);
  return add_meshes(result);
}

// Handles ----------------------------------------------------------------------------------------

/* Frees what a handle owns. */
static void clear(struct dea_result_handle *result)
{
  struct dea_context *ctx = result->ctx->inner;
  for (size_t i = 0; i < result->mesh_count; i++) {
    api_mesh_free(ctx, result->meshes[i]);
  }
  dea_arena_free(&result->texts.memory);
  dea_arena_free(&result->memory);
  dea_free(ctx, result->summary);
  dea_text_free(&result->svg);
  if (result->run != NULL) {
    dea_run_destroy(ctx, result->run);
  } else {
    dea_result_destroy(ctx, result->inner);
  }
  dea_device_destroy(ctx, result->device);
  dea_design_destroy(ctx, result->design);
}

void dea_result_free(dea_result *result)
{
  if (result != NULL) {
    struct dea_context *ctx = result->ctx->inner;
    clear(result);
    dea_free(ctx, result);
  }
}

/* Of what is to be computed or was read. */
static struct dea_result_handle empty_handle(dea_context *ctx)
{
  struct dea_context *inner = ctx->inner;
  return (struct dea_result_handle){
      .ctx = ctx, .memory = {.ctx = inner}, .texts.memory = {.ctx = inner}, .svg = {.ctx = inner}};
}

/* A handle for what was computed; takes the contents, also on failure. */
static dea_status create_result(struct dea_result_handle contents, dea_result **out)
{
  struct dea_context *inner = contents.ctx->inner;
  dea_result *result = dea_alloc(inner, 1, sizeof *result);
  *out = NULL;
  if (result == NULL) {
    clear(&contents);
    return DEA_E_MEMORY;
  }
  *result = contents;
  DEA_TRY_ELSE(inner, list_result(result), dea_result_free(result));
  *out = result;
  return DEA_OK;
}

const dea_array *dea_result_array_at(const dea_result *result, size_t index)
{
  return index < result->array_count ? result->arrays[index] : NULL;
}

dea_status dea_result_array(dea_context *ctx, const dea_result *result, const char *name,
                            const dea_array **out)
{
  const char *key = strrchr(name, '/');
  const int column = key != NULL ? dea_column_find(ctx->inner, key + 1) : -1; // "hub_z"
  *out = NULL;
  for (size_t i = 0; i < result->array_count; i++) {
    const char *full = result->arrays[i]->name;
    const size_t folder = key != NULL ? (size_t)(key + 1 - name) : 0;
    if (strcmp(full, name) == 0 ||
        (column >= 0 && strncmp(full, name, folder) == 0 &&
         strcmp(full + folder, dea_column_at(ctx->inner, column)->key) == 0)) {
      *out = result->arrays[i];
      return DEA_OK;
    }
  }
  const char **known = dea_alloc(ctx->inner, result->array_count, sizeof *known);
  DEA_TRY_MEMORY(known != NULL);
  for (size_t i = 0; i < result->array_count; i++) {
    known[i] = result->arrays[i]->name;
  }
  dea_status status = dea_unknown_name(ctx->inner, "array", name, known, result->array_count);
  dea_free(ctx->inner, known);
  return status;
}

static dea_status get_summary(dea_context *ctx, dea_result *result, const char **out)
{
  DEA_TRY(ctx->inner, api_check_owner(ctx, result->ctx, "result"));
  if (result->summary == NULL) {
    DEA_TRY(ctx->inner, dea_summary_text(ctx->inner, result->inner, &result->summary));
  }
  *out = result->summary;
  return DEA_OK;
}

dea_status dea_result_text(dea_context *ctx, dea_result *result, const char *name, const char **out)
{
  *out = NULL;
  if (strcmp(name, "summary") == 0) {
    return get_summary(ctx, result, out);
  }
  for (size_t i = 0; i < result->texts.count; i++) {
    if (strcmp(result->texts.at[i].key, name) == 0) {
      *out = result->texts.at[i].value;
      return DEA_OK;
    }
  }
  return dea_unknown_name(ctx->inner, "text", name, NULL, 0);
}

// Figures and files ------------------------------------------------------------------------------

enum { KEY_LINE = 22, KEY_COLUMN = 300, MARGIN = 8 };

// web/report.css, without variables: not every program that shows SVG knows them
static const char style[] =
    "svg{font-family:'DejaVu Sans',Helvetica,Arial,sans-serif}text{font-size:13px;fill:#1c2430}"
    ".tics text{font-size:12px;fill:#566173}.it{font-style:italic}.small{font-size:75%}"
    ".grid path{stroke:#d9dee6;fill:none}.frame{stroke:#566173;stroke-width:1.2;fill:none}"
    ".line{fill:none;stroke-width:2.2;stroke-linejoin:round}.dashed{stroke-dasharray:7 5}"
    ".dotted{stroke-dasharray:1.5 4}.mark{fill:#fff;stroke-width:1.6}.band{fill:#f6e3d8}"
    ".limits path{stroke:#707070;stroke-dasharray:4 3}.limits text{font-size:12px}"
    ".c0{stroke:#0072b2}.c1{stroke:#d55e00}.c2{stroke:#009e73}.c3{stroke:#b85c94}.c4{stroke:#"
    "c98a00}"
    ".c5{stroke:#3d9fd6}.c6{stroke:#1c2430}.c7{stroke:#707070}";

/* A drawing within a fragment. */
struct drawing {
  const char *inside; // after "<svg"
  size_t length;      // up to and with "</svg>"
  double width, height;
  const char *after;
};

/* The next drawing, of those with this beginning; false when there is none. */
static bool next_drawing(const char *from, const char *begin, struct drawing *out)
{
  const char *start = strstr(from, begin);
  const char *end = start != NULL ? strstr(start, "</svg>") : NULL;
  const char *box = start != NULL ? strstr(start, "viewBox=\"0 0 ") : NULL;
  if (end == NULL || box == NULL || box > end) {
    return false;
  }
  char *rest;
  out->inside = start + strlen("<svg");
  out->after = end + strlen("</svg>");
  out->length = (size_t)(out->after - out->inside);
  out->width = strtod(box + strlen("viewBox=\"0 0 "), &rest);
  out->height = strtod(rest, NULL);
  return true;
}

static bool is_sample(const struct drawing *drawing)
{
  return strncmp(drawing->inside, " class=\"sample\"", strlen(" class=\"sample\"")) == 0;
}

static void add_drawing(struct dea_text *out, const struct drawing *drawing, double x, double y)
{
  dea_text_add(out, "<svg x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\"%.*s\n", x, y,
               drawing->width, drawing->height, (int)drawing->length, drawing->inside);
}

/* The lines of a plot's key below it; returns where they end. */
static double add_key(struct dea_text *out, const char *fragment, double y)
{
  struct drawing sample;
  int count = 0;
  for (const char *at = fragment; next_drawing(at, "<svg class=\"sample\"", &sample); count++) {
    const char *end = strstr(sample.after, "</li>");
    const int row = count / 2;
    double x = MARGIN + count % 2 * KEY_COLUMN, line = y + row * KEY_LINE;
    int length = end != NULL ? (int)(end - sample.after) : 0;
    add_drawing(out, &sample, x, line);
    dea_text_add(out, "<text x=\"%.0f\" y=\"%.0f\">%.*s</text>\n", x + 36, line + 11, length,
                 sample.after);
    at = sample.after;
  }
  const int rows = (count + 1) / 2;
  return y + rows * KEY_LINE;
}

/* Adds the drawings of a fragment of the report's page as one SVG of its own: one below the other,
 * with the page's colours and the key of a plot. */
static void add_svg(struct dea_text *out, const char *fragment)
{
  struct dea_text inside = {.ctx = out->ctx};
  struct drawing drawing;
  double width = 0, y = MARGIN;
  for (const char *at = fragment; next_drawing(at, "<svg", &drawing); at = drawing.after) {
    if (!is_sample(&drawing)) {
      add_drawing(&inside, &drawing, MARGIN, y);
      width = drawing.width > width ? drawing.width : width;
      y += drawing.height + MARGIN;
    }
  }
  y = add_key(&inside, fragment, y);
  dea_text_add(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
               "viewBox=\"0 0 %.0f %.0f\"><style>%s</style>"
               "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n%s</svg>\n",
               width + 2 * MARGIN, y, width + 2 * MARGIN, y, style, dea_text_get(&inside));
  dea_text_free_in(&inside, out);
}

/* Draws a figure into svg; nothing when it has nothing to show. */
static dea_status draw(struct dea_context *ctx, const struct dea_result *inner,
                       const struct dea_figure *figure, struct dea_text *svg)
{
  struct dea_plot *plot;
  struct dea_text fragment = {.ctx = ctx};
  DEA_TRY(ctx, dea_plot_create(ctx, figure->name, figure->caption, &plot));
  dea_status status = figure->build(ctx, inner, plot);
  if (status == DEA_OK && dea_plot_shows(plot)) {
    void *locale = dea_c_locale_enter();
    dea_plot_add_svg(&fragment, plot, 1);
    add_svg(svg, dea_text_get(&fragment));
    dea_c_locale_leave(locale);
    status = fragment.failed || svg->failed ? DEA_E_MEMORY : DEA_OK;
  }
  dea_text_free(&fragment);
  dea_plot_destroy(ctx, plot);
  return status;
}

dea_status dea_result_svg(dea_context *ctx, dea_result *result, const char *figure,
                          const char **out)
{
  const char *known[DEA_FIGURES_MAX];
  size_t count = dea_figure_names(true, known);
  const struct dea_figure *one;
  bool found = figure[0] == '\0';
  *out = NULL;
  DEA_TRY(ctx->inner, api_check_owner(ctx, result->ctx, "result"));
  dea_text_free(&result->svg);
  for (size_t i = 0; (one = dea_figure_get(i)) != NULL && result->svg.length == 0; i++) {
    if (one->build != NULL && (figure[0] == '\0' || strcmp(one->name, figure) == 0)) {
      found = true;
      DEA_TRY(ctx->inner, draw(ctx->inner, result->inner, one, &result->svg));
    }
  }
  if (!found) {
    return dea_unknown_name(ctx->inner, "figure", figure, known, count);
  }
  if (result->svg.length == 0) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the result has nothing to show in figure '%.60s'",
                    figure);
  }
  *out = dea_text_get(&result->svg);
  return DEA_OK;
}

dea_status dea_result_write(dea_context *ctx, const dea_result *result, const char *folder,
                            const dea_run_options *options)
{
  const dea_run_options all = run_options_of(options);
  const struct dea_run_folder_options inner = {.force = all.replace != 0,
                                               .no_figures = all.no_figures != 0};
  DEA_TRY(ctx->inner, dea_run_folder_prepare(ctx->inner, folder, inner.force));
  return DEA_CHAIN(ctx->inner, dea_run_folder_write(ctx->inner, result->inner, folder, &inner));
}

dea_status dea_result_save(dea_context *ctx, const dea_result *result, const char *path)
{
  return DEA_CHAIN(ctx->inner, dea_results_h5_write(ctx->inner, result->inner, path));
}

/* The design that was computed, read again; one that this version does not understand is left out,
 * with a note. */
static dea_status read_design(struct dea_context *ctx, struct dea_result_handle *contents)
{
  dea_status status = dea_design_of_run(ctx, contents->run, &contents->design, &contents->device);
  if (status == DEA_OK) {
    contents->inner->design = contents->design;
    contents->inner->device = contents->device;
    return DEA_OK;
  }
  dea_device_destroy(ctx, contents->device);
  dea_design_destroy(ctx, contents->design);
  contents->device = NULL;
  contents->design = NULL;
  if (status == DEA_E_MEMORY) {
    return status;
  }
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "the design of this result is not understood by this version");
}

dea_status dea_result_open(dea_context *ctx, const char *path, dea_result **out)
{
  struct dea_context *inner = api_begin(ctx);
  struct dea_result_handle contents = empty_handle(ctx);
  *out = NULL;
  DEA_TRY(inner, dea_run_read(inner, path, &contents.run));
  contents.inner = contents.run->result;
  DEA_TRY_ELSE(inner, read_design(inner, &contents), clear(&contents));
  return DEA_CHAIN(inner, create_result(contents, out));
}

dea_status dea_result_design(dea_context *ctx, const dea_result *result, dea_design **out)
{
  const struct dea_provenance *p = &result->inner->provenance;
  *out = NULL;
  api_begin(ctx);
  if (p->input == NULL) {
    return dea_fail(ctx->inner, DEA_E_UNSUPPORTED, "the result does not have its design");
  }
  return DEA_CHAIN(
      ctx->inner,
      api_design_create(ctx, result->run != NULL ? result->run->design_file : result->design->file,
                        p->input, p->overrides, out));
}

// dea_run: design -> models -> studies -> result -------------------------------------------------

/* The models that are asked for, or those of the design. */
static dea_status choose_models(dea_context *ctx, const dea_run_options *options,
                                const struct dea_design *design, struct dea_job *job)
{
  bool given = options->model_count > 0;
  size_t count = given ? options->model_count : design->compute.model_count;
  if (count > DEA_DESIGN_MODELS_MAX) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "%zu models are too many", count);
  }
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx->inner,
            api_model_find(ctx, given ? options->models[i] : design->compute.models[i].text,
                           &job->models[i]));
    for (size_t k = 0; k < i; k++) {
      if (job->models[k] == job->models[i]) {
        return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the model '%s' is given twice",
                        job->models[i]->name);
      }
    }
  }
  job->model_count = count;
  return DEA_OK;
}

/* What is built for a run; all owned by the caller, also after a failure. */
static dea_status prepare(dea_context *ctx, const dea_design *design,
                          struct dea_result_handle *contents)
{
  struct dea_context *inner = ctx->inner;
  DEA_TRY(inner, api_design_build(inner, design, &contents->design, &contents->device));
  DEA_TRY(inner, dea_result_create(inner, contents->design, contents->device, &contents->inner));
  return dea_provenance_fill(inner, design->bytes, design->length, design->settings.at,
                             design->settings.count, NULL, &contents->inner->provenance);
}

/* Studies, and the folder. The status of the studies comes before that of the folder. */
static dea_status compute(dea_context *ctx, struct dea_job *job, struct dea_result *result,
                          bool *began)
{
  char message[1024];
  dea_status status = dea_job_run(ctx->inner, job, result, began);
  snprintf(message, sizeof message, "%s", dea_context_message(ctx->inner));
  dea_status written = *began ? dea_job_write(ctx->inner, job, result) : DEA_OK;
  dea_job_end(ctx->inner, job);
  if (status != DEA_OK && *began) {
    dea_fail(ctx->inner, status, "%s", message); // not what the writer said
  }
  return status != DEA_OK ? status : written;
}

dea_status dea_run(dea_context *ctx, const dea_design *design, const dea_run_options *options,
                   dea_result **out)
{
  struct dea_context *inner = api_begin(ctx);
  struct dea_result_handle contents = empty_handle(ctx);
  const dea_run_options all = run_options_of(options);
  struct dea_job job = {.studies = all.study_count > 0 ? all.studies : NULL,
                        .study_count = all.study_count,
                        .folder = all.folder,
                        .force = all.replace != 0,
                        .resume = all.resume != 0,
                        .no_figures = all.no_figures != 0};
  bool began = false;
  *out = NULL;
  ctx->running = true;
  dea_status status = prepare(ctx, design, &contents);
  status = status == DEA_OK ? choose_models(ctx, &all, contents.design, &job) : status;
  status = status == DEA_OK ? compute(ctx, &job, contents.inner, &began) : status;
  ctx->running = false;
  if (!began) {
    clear(&contents);
    return dea_fail_chain(inner, status, __func__, __FILE__, __LINE__);
  }
  dea_status made = create_result(contents, out);
  return made != DEA_OK ? made : status;
}
