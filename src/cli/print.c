/* What all commands say: findings and failures on stderr, texts and JSON on stdout. */
#include "cli/cli.h"

#include <stdarg.h>
#include <string.h>

static const char *const severity_names[] = {"note", "warning", "error"};

static const char *severity_text(enum dea_severity severity, bool colour)
{
  static const char *const coloured[] = {"\033[36mnote\033[0m", "\033[35mwarning\033[0m",
                                         "\033[1;31merror\033[0m"};
  return colour ? coloured[severity] : severity_names[severity];
}

/* Adds what may come from a file, without what a terminal would obey. */
static void add_plain(struct dea_text *line, const char *text)
{
  const size_t before = line->length;
  dea_text_add(line, "%s", text);
  if (!line->failed) {
    dea_text_flatten(line->data + before);
  }
}

const char *cli_plain(const char *text, char out[CLI_PLAIN_SIZE])
{
  snprintf(out, CLI_PLAIN_SIZE, "%s", text);
  dea_text_flatten(out);
  return out;
}

static void print_line(struct dea_cli *cli, const struct dea_location *location,
                       enum dea_severity severity, const char *text)
{
  struct dea_text line = {.ctx = cli->ctx};
  if (location == NULL || location->file == NULL || location->file[0] == '\0') {
    dea_text_add(&line, "dea: ");
  } else {
    add_plain(&line, location->file);
    if (location->line > 0) {
      dea_text_add(&line, ":%zu:%zu", location->line, location->column);
    }
    dea_text_add(&line, ": ");
  }
  dea_text_add(&line, "%s: ", severity_text(severity, cli->colour));
  add_plain(&line, text);
  fprintf(stderr, "%s\n", line.failed ? text : dea_text_get(&line));
  dea_text_free(&line);
}

/* Whether b stands before a in the same file. */
static bool stands_before(const struct dea_finding *b, const struct dea_finding *a)
{
  const struct dea_location *x = &b->location, *y = &a->location;
  bool same = x->file != NULL && y->file != NULL && strcmp(x->file, y->file) == 0;
  return same && x->line > 0 && y->line > 0 &&
         (x->line < y->line || (x->line == y->line && x->column < y->column));
}

/* Findings in the order of their file, others as they came; some hundreds: insertion. NULL without
 * memory. Owned by the caller. */
static const struct dea_finding **sort(struct dea_context *ctx, const struct dea_finding *findings,
                                       size_t count)
{
  const struct dea_finding **sorted = dea_alloc(ctx, count, sizeof *sorted);
  for (size_t i = 0; sorted != NULL && i < count; i++) {
    size_t k = i;
    for (; k > 0 && stands_before(&findings[i], sorted[k - 1]); k--) {
      sorted[k] = sorted[k - 1];
    }
    sorted[k] = &findings[i];
  }
  return sorted;
}

/* A note that said the same before, of another place. */
static bool is_repeated(const struct dea_finding *const sorted[], size_t i)
{
  for (size_t k = 0; k < i && sorted[i]->severity == DEA_NOTE; k++) {
    if (sorted[k]->severity == DEA_NOTE && strcmp(sorted[k]->text, sorted[i]->text) == 0) {
      return true;
    }
  }
  return false;
}

static void print_findings(struct dea_cli *cli)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(cli->ctx, &count);
  const struct dea_finding **sorted = count > 0 ? sort(cli->ctx, findings, count) : NULL;
  for (size_t i = 0; i < count; i++) {
    const struct dea_finding *finding = sorted != NULL ? sorted[i] : &findings[i];
    bool repeated = sorted != NULL && !cli->verbose && is_repeated(sorted, i);
    if (!repeated && !(finding->severity == DEA_NOTE && cli->quiet)) {
      print_line(cli, &finding->location, finding->severity, finding->text);
    }
  }
  dea_free(cli->ctx, sorted);
}

int cli_report(struct dea_cli *cli, dea_status status)
{
  const bool failed = status != DEA_OK && !cli->refused;
  fflush(stdout);
  cli_progress_clear(cli);
  print_findings(cli);
  bool said = dea_finding_count(cli->ctx, DEA_ERROR) > 0 && status == DEA_E_DESIGN;
  if (failed && !said) {
    const char *message = dea_context_message(cli->ctx);
    print_line(cli, NULL, DEA_ERROR, message[0] != '\0' ? message : dea_status_message(status));
  }
  if (failed && cli->verbose) {
    fprintf(stderr, "dea: in %s\n", dea_context_chain(cli->ctx));
  }
  return dea_status_exit_code(status);
}

dea_status cli_usage_error(struct dea_cli *cli, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  fprintf(stderr, "dea %s: %s: ", cli->command->name, severity_text(DEA_ERROR, cli->colour));
  vfprintf(stderr, format, args);
  fprintf(stderr, "\nTry 'dea %s --help'.\n", cli->command->name);
  va_end(args);
  cli->refused = true;
  return DEA_E_USAGE;
}

void cli_print_json(json_t *json)
{
  json_dumpf(json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
  putchar('\n');
  json_decref(json);
}

dea_status cli_print_text(dea_status status, struct dea_text *text)
{
  status = status == DEA_OK && text->failed ? DEA_E_MEMORY : status;
  if (status == DEA_OK) {
    fputs(dea_text_get(text), stdout);
  }
  dea_text_free(text);
  return status;
}

json_t *cli_findings_json(const struct dea_context *ctx)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  json_t *array = json_array();
  for (size_t i = 0; i < count; i++) {
    const struct dea_location *location = &findings[i].location;
    json_array_append_new(array, json_pack("{s:s, s:s, s:I, s:I, s:s}", "severity",
                                           severity_names[findings[i].severity], "file",
                                           location->file != NULL ? location->file : "", "line",
                                           (json_int_t)location->line, "column",
                                           (json_int_t)location->column, "text", findings[i].text));
  }
  return array;
}
