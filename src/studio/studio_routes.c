#define _POSIX_C_SOURCE 200809L // fstatat
#include "studio/studio_routes.h"

#include "base/assets.h"
#include "base/file.h"
#include "compare/measured.h"
#include "job/report_runs.h"
#include "report/section.h"
#include "result/provenance.h"
#include "studio/studio_files.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char json_mime[] = "application/json", html_mime[] = "text/html; charset=utf-8";

/* A question, and what its answer is of. */
struct dea_studio_route {
  const char *method, *path;
  void (*answer)(struct dea_studio_exchange *w);
  const char *type, *bytes; // of a part of the page
  const size_t *length;
  const char *command, *option, *ending; // a command, and the file that it writes of a design
  enum view { CURVES, FILM, SLIDERS } view;
};

// Replies -----------------------------------------------------------------------------------------

static void respond(struct dea_studio_exchange *w, int status, const char *type, const char *bytes,
                    size_t length)
{
  w->status = status;
  w->type = type;
  w->reply.length = 0;
  dea_text_add_bytes(&w->reply, bytes, length);
}

/* Takes it. */
static void respond_json(struct dea_studio_exchange *w, int status, json_t *json)
{
  char *text = json != NULL ? json_dumps(json, JSON_COMPACT) : NULL;
  respond(w, text != NULL ? status : 500, json_mime, text != NULL ? text : "{}",
          text != NULL ? strlen(text) : 2);
  free(text);
  json_decref(json);
}

/* {error: text}; the texts of findings go before the message. */
static void respond_error(struct dea_studio_exchange *w, int status, const char *text)
{
  respond_json(w, status, json_pack("{s:s}", "error", text));
}

/* What a file or a result says against it is an answer, too: browsers note what has no status 200.
 */
static void respond_failure(struct dea_studio_exchange *w)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(w->ctx, &count);
  struct dea_text text = {.ctx = w->ctx};
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == DEA_ERROR) {
      dea_text_add(&text, "%s:%zu:%zu: %s\n", dea_path_name(findings[i].location.file),
                   findings[i].location.line, findings[i].location.column, findings[i].text);
    }
  }
  dea_text_add(&text, "%s", dea_context_message(w->ctx));
  respond_error(w, 200, dea_text_get(&text));
  dea_text_free(&text);
}

// Arguments ---------------------------------------------------------------------------------------

/* The i-th of that name in the address; NULL: there is none. */
static const char *argument(const struct dea_studio_exchange *w, const char *name, size_t i)
{
  return json_string_value(json_array_get(json_object_get(w->arguments, name), i));
}

/* The name of a file in the folder; after an answer NULL. */
static const char *file_argument(struct dea_studio_exchange *w, const char *name)
{
  const char *file = argument(w, name, 0);
  if (file == NULL || !dea_studio_name_good(file, false)) {
    respond_error(w, 400, "that is no name of a file in this folder");
    return NULL;
  }
  return file;
}

/* Whether what has a name in the folder is a folder itself, and no link to one. */
static bool is_run(const struct dea_studio_exchange *w, const char *name)
{
  char results[DEA_STUDIO_STAMP], path[300];
  snprintf(path, sizeof path, "%s/results.h5", name);
  dea_studio_stamp(w->studio->folder, path, results);
  return dea_studio_name_good(name, false) && results[0] != '\0';
}

/* Adds the name of a file to a command, which must not take it for an option. */
static void add_file(struct dea_studio_line *line, const char *name)
{
  char path[DEA_PATH_SIZE + 2];
  snprintf(path, sizeof path, "%s%s", name[0] == '-' ? "./" : "", name);
  dea_studio_line_add(line, path);
}

// The page and its parts --------------------------------------------------------------------------

static void get_part(struct dea_studio_exchange *w)
{
  respond(w, 200, w->route->type, w->route->bytes, *w->route->length);
}

/* What there is: {folder, open, designs, runs, tables, folders, jobs}. */
static void get_state(struct dea_studio_exchange *w)
{
  const char *open = w->studio->options.open;
  json_t *state = dea_studio_list(w->studio->folder);
  json_object_set_new(state, "folder", json_string(w->studio->path));
  json_object_set_new(state, "open", json_string(open != NULL ? open : ""));
  json_object_set_new(state, "jobs", dea_studio_jobs_json(w->studio->jobs));
  respond_json(w, 200, state);
}

// Designs and tables ------------------------------------------------------------------------------

/* {text, version} of a file, without a text where it is not in UTF-8; NULL: there is none. */
static json_t *file_json(struct dea_studio_exchange *w, const char *name)
{
  struct dea_text bytes = {.ctx = w->ctx};
  char version[65];
  json_t *json = NULL;
  if (dea_studio_read(w->ctx, w->studio->folder, name, DEA_STUDIO_BODY_MAX, &bytes) == DEA_OK) {
    dea_sha256_hex(bytes.data, bytes.length, version);
    json = json_pack("{s:s}", "version", version);
    json_object_set_new(json, "text", json_stringn(bytes.data, bytes.length));
  }
  dea_text_free(&bytes);
  return json;
}

static void get_design(struct dea_studio_exchange *w)
{
  const char *name = file_argument(w, "name");
  if (name == NULL) {
    return;
  }
  json_t *json = file_json(w, name);
  if (json_object_get(json, "text") == NULL) {
    json_decref(json);
    respond_error(w, 404, "there is no such file, or it is no text in UTF-8");
    return;
  }
  respond_json(w, 200, json);
}

/* Whether the name is of a regular file or of nothing. */
static bool can_write(const struct dea_studio_exchange *w, const char *name)
{
  struct stat file;
  return fstatat(w->studio->folder, name, &file, AT_SYMLINK_NOFOLLOW) != 0 || S_ISREG(file.st_mode);
}

/* Writes the body where the file is still the version that the page knows ("": none is there); else
 * says what is there: {changed, text, version}. */
static void store_file(struct dea_studio_exchange *w)
{
  const char *name = file_argument(w, "name"), *known = argument(w, "version", 0);
  if (name == NULL) {
    return;
  }
  if (!can_write(w, name)) {
    respond_error(w, 403, "a folder or a link has that name");
    return;
  }
  pthread_mutex_lock(&w->studio->write_lock);
  json_t *there = file_json(w, name);
  const char *version = there != NULL ? json_string_value(json_object_get(there, "version")) : "";
  if (strcmp(version, known != NULL ? known : "") != 0) {
    json_t *other =
        there != NULL ? json_incref(there) : json_pack("{s:s, s:s}", "text", "", "version", "");
    json_object_set_new(other, "changed", json_true());
    respond_json(w, 200, other); // no failure, which a browser would note
  } else {
    char now[65];
    dea_sha256_hex(w->body, w->body_length, now);
    if (dea_file_write(w->ctx, name, w->body, w->body_length) == DEA_OK) {
      respond_json(w, 200, json_pack("{s:s}", "version", now));
    } else {
      respond_failure(w);
    }
  }
  json_decref(there);
  pthread_mutex_unlock(&w->studio->write_lock);
}

static void get_file(struct dea_studio_exchange *w)
{
  static const struct {
    const char *ending, *type;
  } types[] = {{".html", "text/html; charset=utf-8"},
               {".svg", "image/svg+xml"},
               {".png", "image/png"},
               {".pdf", "application/pdf"},
               {".csv", "text/plain; charset=utf-8"},
               {".json", "application/json"},
               {".yaml", "text/plain; charset=utf-8"}};
  const char *name = argument(w, "name", 0);
  const char *type = "application/octet-stream";
  enum { FILE_MAX = 256 << 20 };
  w->foreign = true;
  if (name == NULL || !dea_studio_name_good(name, true) ||
      dea_studio_read(w->ctx, w->studio->folder, name, FILE_MAX, &w->reply) != DEA_OK) {
    respond_error(w, 404, "there is no such file in this folder");
    return;
  }
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
    const char *at = strrchr(name, '.');
    type = at != NULL && strcmp(at, types[i].ending) == 0 ? types[i].type : type;
  }
  w->status = 200;
  w->type = type;
}

static void get_list(struct dea_studio_exchange *w)
{
  const char *name = file_argument(w, "name");
  json_t *list = name != NULL ? dea_studio_list_in(w->studio->folder, name) : NULL;
  if (name != NULL && list == NULL) {
    respond_error(w, 404, "there is no such folder");
  } else if (name != NULL) {
    respond_json(w, 200, list);
  }
}

// Questions to the command ------------------------------------------------------------------------

enum { QUESTION_S = 30 };

/* What a command says, as JSON, into `key` of an answer that shows the command; what is no JSON is
 * an error. */
static json_t *find_command(struct dea_studio_exchange *w, const struct dea_studio_line *line,
                            const char *key)
{
  struct dea_text out = {.ctx = w->ctx}, err = {.ctx = w->ctx}, shown = {.ctx = w->ctx};
  int code = -1;
  const dea_status status = dea_studio_run_command(w->ctx, w->studio->options.program, line,
                                                   QUESTION_S, &out, &err, &code);
  json_t *json = json_object(), *said = NULL;
  dea_studio_line_show(line, &shown);
  if (status == DEA_OK) {
    said = json_loadb(out.data, out.length, JSON_ALLOW_NUL, NULL);
  }
  if (said != NULL) {
    json_object_set_new(json, key, said);
  } else {
    const char *text = status == DEA_OK && err.length > 0 ? err.data : dea_context_message(w->ctx);
    json_t *error = json_string(text);
    json_object_set_new(json, "error", error != NULL ? error : json_string("?"));
  }
  json_object_set_new(json, "command", json_string(dea_text_get(&shown)));
  dea_text_free(&shown);
  dea_text_free(&out);
  dea_text_free(&err);
  return json;
}

/* A path for a file in the scratch folder. */
static dea_status build_scratch_path(struct dea_studio_exchange *w, const char *ending,
                                     char out[DEA_PATH_SIZE])
{
  char name[40];
  pthread_mutex_lock(&w->studio->write_lock);
  snprintf(name, sizeof name, "%u.%s", ++w->studio->scratch_count, ending);
  pthread_mutex_unlock(&w->studio->write_lock);
  return dea_path_build(w->ctx, w->studio->scratch, name, out);
}

/* "dea check DESIGN --svg FILE", or of another command. */
static void build_line(struct dea_studio_line *line, const char *command, const char *design,
                       const char *option, const char *file)
{
  *line = (struct dea_studio_line){.count = 0};
  dea_studio_line_add(line, command);
  add_file(line, design);
  dea_studio_line_add(line, option);
  add_file(line, file);
}

/* What a command says of a design, and the file that it writes: {COMMAND, ENDING, command}. */
static void query_file(struct dea_studio_exchange *w, const char *command, const char *design,
                       const char *shown, const char *option, const char *ending)
{
  struct dea_studio_line line;
  struct dea_text by_hand = {.ctx = w->ctx};
  char file[DEA_PATH_SIZE], *bytes = NULL, name[280];
  size_t length;
  if (build_scratch_path(w, ending, file) != DEA_OK) {
    respond_failure(w);
    return;
  }
  build_line(&line, command, design, option, file);
  dea_studio_line_add(&line, "--json");
  json_t *json = find_command(w, &line, command);
  if (dea_path_exists(file) &&
      dea_file_read(w->ctx, file, DEA_STUDIO_BODY_MAX, &bytes, &length) == DEA_OK) {
    json_object_set_new(json, ending, json_stringn(bytes, length));
    dea_free(w->ctx, bytes);
  }
  unlink(file);
  snprintf(name, sizeof name, "%.*s.%s", (int)strcspn(shown, "."), shown, ending);
  build_line(&line, command, shown, option, name);
  dea_studio_line_show(&line, &by_hand);
  json_object_set_new(json, "command", json_string(dea_text_get(&by_hand)));
  dea_text_free(&by_hand);
  respond_json(w, 200, json);
}

static void get_of_design(struct dea_studio_exchange *w)
{
  const struct dea_studio_route *r = w->route;
  const char *name = file_argument(w, "name");
  if (name != NULL && can_write(w, name)) { // a link would lead out
    query_file(w, r->command, name, name, r->option, r->ending);
  } else if (name != NULL) {
    respond_error(w, 404, "there is no such file in this folder");
  }
}

static void get_schema(struct dea_studio_exchange *w)
{
  static const char *const kinds[] = {"--explore", "--fit", "--fit-device", "--fit-breakdown",
                                      "--fit-life"};
  const char *of = argument(w, "of", 0);
  struct dea_studio_line line = {.count = 0};
  dea_studio_line_add(&line, "schema");
  dea_studio_line_add(&line, "--json");
  for (size_t i = 0; of != NULL && i < sizeof kinds / sizeof kinds[0]; i++) {
    if (strcmp(kinds[i] + 2, of) == 0) {
      dea_studio_line_add(&line, kinds[i]);
    }
  }
  respond_json(w, 200, find_command(w, &line, "schema"));
}

/* Adds the runs and the table that the address names, or those of a body; false after an answer. */
static bool add_runs(struct dea_studio_exchange *w, const json_t *runs, const char *measured,
                     struct dea_studio_line *line, const char *option)
{
  size_t i;
  const json_t *run;
  json_array_foreach(runs, i, run)
  {
    const char *name = json_string_value(run);
    if (name == NULL || !is_run(w, name)) {
      respond_error(w, 404, "there is no such run in this folder");
      return false;
    }
    add_file(line, name);
  }
  if (measured != NULL && (!dea_studio_name_good(measured, false) || !can_write(w, measured))) {
    respond_error(w, 404, "there is no such table in this folder");
    return false;
  }
  if (measured != NULL && option != NULL) {
    dea_studio_line_add(line, option);
  }
  if (measured != NULL) {
    add_file(line, measured);
  }
  return true;
}

/* The misfit of runs to a table or to the last of them: {compare, command}. */
static void get_compare(struct dea_studio_exchange *w)
{
  struct dea_studio_line line = {.count = 0};
  dea_studio_line_add(&line, "compare");
  if (json_array_size(json_object_get(w->arguments, "run")) == 0) {
    respond_error(w, 400, "runs are needed");
    return;
  }
  if (add_runs(w, json_object_get(w->arguments, "run"), argument(w, "measured", 0), &line, NULL)) {
    dea_studio_line_add(&line, "--json");
    respond_json(w, 200, find_command(w, &line, "compare"));
  }
}

// Runs as HTML, by sections of the report ---------------------------------------------------------

enum { RUNS_MAX = 6 };

static dea_status add_sections(struct dea_report *report)
{
  DEA_TRY(report->ctx, dea_section_compare(report));
  if (report->count == 1) {
    static const dea_run_section sections[] = {dea_section_curves, dea_section_studies,
                                               dea_section_limits};
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
      DEA_TRY(report->ctx, sections[i](report, &report->runs[0]));
    }
  }
  return report->text.failed ? DEA_E_MEMORY : DEA_OK;
}

/* A section of one run as a page of its own with the report's script. */
static dea_status add_page(struct dea_report *report, dea_run_section section)
{
  dea_text_add(&report->text,
               "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
               "<title>Run</title><style>%s</style></head><body><nav hidden><ul></ul></nav><main>",
               dea_asset_style);
  const size_t before = report->text.length;
  DEA_TRY(report->ctx, section(report, &report->runs[0]));
  if (report->text.length == before) {
    dea_text_add(&report->text, "<p>This run has %s.</p>",
                 section == dea_section_membrane ? "no film in space" : "nothing between points");
  }
  dea_text_add(&report->text, "</main><script>%s</script></body></html>\n", dea_asset_script);
  return report->text.failed ? DEA_E_MEMORY : DEA_OK;
}

/* Runs that are read: reads what is beside them, and draws. */
static dea_status draw_runs(struct dea_context *ctx, const struct dea_report_run *runs,
                            size_t count, const char *measured, enum view view,
                            struct dea_text *out)
{
  const struct dea_report_options options = {.measurement = measured};
  struct dea_report report = {
      .ctx = ctx, .options = &options, .runs = runs, .count = count, .level = 3, .text = *out};
  struct dea_measured *beside = NULL;
  dea_status status = DEA_OK;
  if (measured != NULL) {
    status = dea_measured_read(ctx, measured, &beside);
    status = status == DEA_OK ? dea_measured_fold(ctx, beside) : status;
    report.measurement = beside != NULL ? beside->points : NULL;
  }
  if (status == DEA_OK) {
    void *before = dea_c_locale_enter();
    status = view == CURVES ? add_sections(&report)
             : view == FILM ? add_page(&report, dea_section_membrane)
                            : add_page(&report, dea_section_explorer);
    dea_c_locale_leave(before);
  }
  *out = report.text;
  dea_measured_destroy(ctx, beside);
  return status;
}

/* Of the sweeps that are there the first of the run's design. */
static dea_status find_sweep(struct dea_context *ctx, const json_t *sweeps,
                             struct dea_report_run *run, char **bytes)
{
  for (size_t i = 0; i < json_array_size(sweeps) && run->emulator == NULL; i++) {
    const json_t *name = json_object_get(json_array_get(sweeps, i), "name");
    dea_free(ctx, *bytes);
    *bytes = NULL;
    const dea_status status = dea_report_runs_explore(ctx, json_string_value(name), run, 1, bytes);
    if (status == DEA_E_MEMORY) {
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
    dea_context_clear(ctx); // it is of another design, or just being written
  }
  return DEA_OK;
}

/* Adds HTML whose numbers the page's script finds. names: of runs, at most RUNS_MAX, also ones that
 * go on; measured: a table beside them, NULL: none; sweeps [{name}]: folders of
 * sweeps over numbers of designs. One thread at a time. DEA_E_IO as dea_run_read, or of the table
 * after findings.
 */
static dea_status add_runs_html(struct dea_context *ctx, const json_t *names, const char *measured,
                                const json_t *sweeps, enum view view, struct dea_text *out)
{
  struct dea_report_run runs[RUNS_MAX] = {{0}};
  const char *paths[RUNS_MAX];
  char *emulator = NULL;
  const size_t count = json_array_size(names);
  for (size_t i = 0; i < count; i++) {
    paths[i] = json_string_value(json_array_get(names, i));
  }
  dea_status status = dea_report_runs_open(ctx, paths, count, runs);
  if (status == DEA_OK && view == SLIDERS) {
    status = find_sweep(ctx, sweeps, &runs[0], &emulator);
  }
  for (size_t i = 0; i < count && status == DEA_OK; i++) { // they are known by their folders here
    snprintf(runs[i].title, sizeof runs[i].title, "%s", paths[i]);
  }
  status = status == DEA_OK ? draw_runs(ctx, runs, count, measured, view, out) : status;
  dea_free(ctx, emulator);
  dea_report_runs_close(ctx, runs, count);
  return DEA_CHAIN(ctx, status);
}

/* CURVES: figures of one run, with their limits, or of several beside each other; FILM: the film of
 * the first in space, SLIDERS: its explorer, as pages of their own. */
static void get_runs(struct dea_studio_exchange *w)
{
  const enum view view = w->route->view;
  const json_t *runs = json_object_get(w->arguments, "run");
  const char *measured = argument(w, "measured", 0);
  struct dea_studio_line unused = {.count = 0};
  const size_t asked = json_array_size(runs);
  if (!add_runs(w, runs, measured, &unused, NULL)) {
    return;
  }
  if (asked == 0 || asked > RUNS_MAX) {
    respond_error(w, 400, "1 to 6 runs can be shown at a time");
    return;
  }
  struct dea_text out = {.ctx = w->ctx};
  json_t *lists = view == SLIDERS ? dea_studio_list(w->studio->folder) : NULL;
  pthread_mutex_lock(&w->studio->results_lock);
  const dea_status status =
      add_runs_html(w->ctx, runs, measured, json_object_get(lists, "sweeps"), view, &out);
  pthread_mutex_unlock(&w->studio->results_lock);
  if (status == DEA_OK && !out.failed) {
    respond(w, 200, html_mime, dea_text_get(&out), out.length);
    w->foreign = view != CURVES;
  } else {
    respond_failure(w);
  }
  json_decref(lists);
  dea_text_free(&out);
}

// Examples ----------------------------------------------------------------------------------------

static const struct dea_studio_example *example_argument(struct dea_studio_exchange *w)
{
  const char *name = argument(w, "name", 0);
  for (size_t i = 0; name != NULL && i < w->studio->options.example_count; i++) {
    if (strcmp(w->studio->options.examples[i].name, name) == 0) {
      return &w->studio->options.examples[i];
    }
  }
  respond_error(w, 404, "there is no such example");
  return NULL;
}

/* The rest of the first line that begins with a word; "" where there is none. */
static void find_line(const char *text, const char *word, char *out, size_t size)
{
  out[0] = '\0';
  for (const char *line = text; line != NULL; line = strchr(line, '\n')) {
    line += *line == '\n';
    if (strncmp(line, word, strlen(word)) == 0) {
      const char *rest = line + strlen(word);
      snprintf(out, size, "%.*s", (int)strcspn(rest, "\r\n"), rest);
      return;
    }
  }
}

static void get_examples(struct dea_studio_exchange *w)
{
  json_t *list = json_array();
  for (size_t i = 0; i < w->studio->options.example_count; i++) {
    const struct dea_studio_example *example = &w->studio->options.examples[i];
    char title[200], *bytes = NULL;
    size_t length;
    if (dea_file_read(w->ctx, example->path, DEA_STUDIO_BODY_MAX, &bytes, &length) == DEA_OK) {
      find_line(bytes, "title: ", title, sizeof title);
      json_array_append_new(list, json_pack("{s:s, s:s}", "name", example->name, "title", title));
      dea_free(w->ctx, bytes);
    }
  }
  respond_json(w, 200, list);
}

static void get_picture(struct dea_studio_exchange *w)
{
  const struct dea_studio_example *example = example_argument(w);
  if (example != NULL) {
    query_file(w, "check", example->path, example->name, "--svg", "svg");
  }
}

/* Writes what an example says under a name that no file has. */
static bool copy_text(struct dea_studio_exchange *w, const char *text, size_t length,
                      const char *to)
{
  struct stat file;
  bool done = false;
  pthread_mutex_lock(&w->studio->write_lock);
  if (fstatat(w->studio->folder, to, &file, AT_SYMLINK_NOFOLLOW) == 0) {
    respond_error(w, 409, "a file of that name is there");
  } else if (dea_file_write(w->ctx, to, text, length) != DEA_OK) {
    respond_failure(w);
  } else {
    done = true;
  }
  pthread_mutex_unlock(&w->studio->write_lock);
  return done;
}

/* Files beside an example that it names, a drawing for one, come along; those that are there
 * stay. */
static void copy_beside(struct dea_studio_exchange *w, const struct dea_studio_example *example,
                        const char *text)
{
  static const char ends[] = " \t\r\n,}]'\"";
  for (const char *at = strstr(text, "file: "); at != NULL; at = strstr(at + 1, "file: ")) {
    char name[200], *bytes = NULL;
    const char *from = at + strlen("file: ");
    size_t length;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(from, ends), from);
    char *path =
        dea_studio_name_good(name, false) ? dea_path_beside(w->ctx, example->path, name) : NULL;
    if (path != NULL &&
        dea_file_read(w->ctx, path, DEA_STUDIO_BODY_MAX, &bytes, &length) == DEA_OK) {
      copy_text(w, bytes, length, name);
    }
    dea_free(w->ctx, bytes);
    dea_free(w->ctx, path);
  }
}

static void post_copy(struct dea_studio_exchange *w)
{
  const struct dea_studio_example *example = example_argument(w);
  const char *to = example != NULL ? file_argument(w, "to") : NULL;
  char *bytes = NULL;
  size_t length;
  if (to == NULL) {
    return;
  }
  if (dea_file_read(w->ctx, example->path, DEA_STUDIO_BODY_MAX, &bytes, &length) != DEA_OK) {
    respond_failure(w);
    return;
  }
  if (copy_text(w, bytes, length, to)) {
    copy_beside(w, example, bytes);
    respond_json(w, 200, json_pack("{s:s}", "name", to));
  }
  dea_free(w->ctx, bytes);
}

// Runs --------------------------------------------------------------------------------------------

/* Adds "--model NAME" for each of a list; false where one is no plain word. */
static bool add_models(struct dea_studio_line *line, const json_t *models)
{
  size_t i;
  const json_t *model;
  json_array_foreach(models, i, model)
  {
    const char *text = json_string_value(model);
    if (text == NULL || text[0] == '\0' ||
        text[strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789-")] != '\0' || text[0] == '-') {
      return false;
    }
    dea_studio_line_add(line, "--model");
    dea_studio_line_add(line, text);
  }
  return true;
}

/* Takes out of a body what a job is about. */
static const char *text_of(const json_t *body, const char *key)
{
  return json_string_value(json_object_get(body, key));
}

/* A job that reads a file and writes a folder: {action, file, output, ...}; false after an answer.
 */
static bool build_file_job(struct dea_studio_exchange *w, const json_t *body, const char *action,
                           struct dea_studio_line *line)
{
  const char *file = text_of(body, "file"), *output = text_of(body, "output");
  const bool run = strcmp(action, "run") == 0;
  struct stat info;
  if (file == NULL || output == NULL || !dea_studio_name_good(file, false) || !can_write(w, file) ||
      !dea_studio_name_good(output, false) ||
      (fstatat(w->studio->folder, output, &info, AT_SYMLINK_NOFOLLOW) == 0 &&
       !S_ISDIR(info.st_mode))) {
    respond_error(w, 400, "a file of this folder and a folder for what comes of it are needed");
    return false;
  }
  dea_studio_line_add(line, action);
  add_file(line, file);
  dea_studio_line_add(line, "-o");
  add_file(line, output);
  if (strcmp(action, "fab") == 0 || strcmp(action, "fit") == 0 ||
      json_is_true(json_object_get(body, "force"))) {
    dea_studio_line_add(line, "--force");
  }
  if (run && json_is_true(json_object_get(body, "resume"))) {
    dea_studio_line_add(line, "--resume");
  }
  if (run && !add_models(line, json_object_get(body, "models"))) {
    respond_error(w, 400, "names of models are small letters, digits and '-'");
    return false;
  }
  return true;
}

/* A report of runs, into the first one's folder: {action, runs, measured}. */
static bool build_report(struct dea_studio_exchange *w, const json_t *body,
                         struct dea_studio_line *line)
{
  const json_t *runs = json_object_get(body, "runs");
  if (json_array_size(runs) == 0 || json_array_size(runs) > RUNS_MAX) {
    respond_error(w, 400, "1 to 6 runs make a report");
    return false;
  }
  dea_studio_line_add(line, "report");
  return add_runs(w, runs, text_of(body, "measured"), line, "--measurement");
}

static void post_job(struct dea_studio_exchange *w)
{
  static const char *const actions[] = {"run", "fab", "fit", "sweep", "optimise", "report"};
  json_t *body = json_loadb(w->body, w->body_length, 0, NULL);
  struct dea_studio_line line = {.count = 0};
  const char *action = text_of(body, "action"), *subject = text_of(body, "file"),
             *output = text_of(body, "output");
  bool known = false;
  for (size_t i = 0; action != NULL && i < sizeof actions / sizeof actions[0]; i++) {
    known = known || strcmp(action, actions[i]) == 0;
  }
  const bool report = known && strcmp(action, "report") == 0;
  if (report) {
    subject = output = json_string_value(json_array_get(json_object_get(body, "runs"), 0));
  }
  if (!known) {
    respond_error(w, 400, "actions are run, fab, fit, sweep, optimise and report");
  } else if (report ? build_report(w, body, &line) : build_file_job(w, body, action, &line)) {
    struct dea_text shown = {.ctx = w->ctx};
    dea_studio_line_show(&line, &shown);
    json_t *facts = json_pack("{s:s, s:s, s:s, s:s}", "action", action, "subject", subject,
                              "output", output, "command", dea_text_get(&shown));
    dea_text_free(&shown);
    const int id = dea_studio_jobs_add(w->studio->jobs, facts, &line);
    respond_json(w, 200,
                 id > 0
                     ? json_pack("{s:i}", "id", id)
                     : json_pack("{s:s}", "error", "another one writes there, or too many wait"));
  }
  json_decref(body);
}

static void post_stop(struct dea_studio_exchange *w)
{
  json_t *body = json_loadb(w->body, w->body_length, 0, NULL);
  const int id = (int)json_integer_value(json_object_get(body, "id"));
  json_decref(body);
  if (dea_studio_jobs_stop(w->studio->jobs, id)) {
    respond_json(w, 200, json_object());
  } else {
    respond_error(w, 404, "that does not run");
  }
}

// -------------------------------------------------------------------------------------------------

void dea_studio_answer(struct dea_studio_exchange *w)
{
  static const struct dea_studio_route routes[] = {
      {"GET", "", get_part, html_mime, dea_asset_studio_page,
       .length = &dea_asset_studio_page_length},
      {"GET", "studio.css", get_part, "text/css; charset=utf-8", dea_asset_studio_style,
       .length = &dea_asset_studio_style_length},
      {"GET", "studio.js", get_part, "text/javascript; charset=utf-8", dea_asset_studio_script,
       .length = &dea_asset_studio_script_length},
      {"GET", "state", .answer = get_state},
      {"GET", "design", .answer = get_design},
      {"PUT", "design", .answer = store_file},
      {"GET", "check", get_of_design, .command = "check", .option = "--svg", .ending = "svg"},
      {"GET", "mesh", get_of_design, .command = "mesh", .option = "-o", .ending = "msh"},
      {"GET", "schema", .answer = get_schema},
      {"GET", "compare", .answer = get_compare},
      {"GET", "curves", get_runs, .view = CURVES},
      {"GET", "film", get_runs, .view = FILM},
      {"GET", "sliders", get_runs, .view = SLIDERS},
      {"GET", "examples", .answer = get_examples},
      {"GET", "picture", .answer = get_picture},
      {"GET", "file", .answer = get_file},
      {"GET", "list", .answer = get_list},
      {"POST", "copy", .answer = post_copy},
      {"POST", "job", .answer = post_job},
      {"POST", "stop", .answer = post_stop}};
  bool path_known = false;
  for (size_t i = 0; i < sizeof routes / sizeof routes[0]; i++) {
    if (strcmp(routes[i].path, w->path) == 0) {
      path_known = true;
      if (strcmp(routes[i].method, w->method) == 0) {
        w->route = &routes[i];
        w->route->answer(w);
        return;
      }
    }
  }
  respond_error(w, path_known ? 405 : 404, path_known ? "not that way" : "there is no such thing");
}
