/* What all commands say: findings and failures on stderr, texts and JSON on stdout. */
#include "cli/cli.h"

#include <stdarg.h>

static const char *const severity_names[] = {"note", "warning", "error"};

static const char *severity_text(enum dea_severity severity, bool colour)
{
  static const char *const coloured[] = {"\033[36mnote\033[0m", "\033[35mwarning\033[0m",
                                         "\033[1;31merror\033[0m"};
  return colour ? coloured[severity] : severity_names[severity];
}

static void print_place(const struct dea_location *location)
{
  if (location->file == NULL || location->file[0] == '\0') {
    fputs("dea: ", stderr);
  } else if (location->line == 0) {
    fprintf(stderr, "%s: ", location->file);
  } else {
    fprintf(stderr, "%s:%zu:%zu: ", location->file, location->line, location->column);
  }
}

int cli_report(struct dea_cli *cli, dea_status status)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(cli->ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == DEA_NOTE && cli->quiet) {
      continue;
    }
    print_place(&findings[i].location);
    fprintf(stderr, "%s: %s\n", severity_text(findings[i].severity, cli->colour), findings[i].text);
  }
  bool said = dea_finding_count(cli->ctx, DEA_ERROR) > 0 && status == DEA_E_DESIGN;
  if (status != DEA_OK && !said) {
    const char *message = dea_context_message(cli->ctx);
    fprintf(stderr, "dea: %s: %s\n", severity_text(DEA_ERROR, cli->colour),
            message[0] != '\0' ? message : dea_status_message(status));
  }
  if (status != DEA_OK && cli->verbose) {
    fprintf(stderr, "dea: in %s\n", dea_context_chain(cli->ctx));
  }
  dea_finding_clear(cli->ctx);
  return dea_status_exit_code(status);
}

int cli_usage_error(struct dea_cli *cli, const struct dea_command *command, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  fprintf(stderr, "dea %s: %s: ", command->name, severity_text(DEA_ERROR, cli->colour));
  vfprintf(stderr, format, args);
  fprintf(stderr, "\nTry 'dea %s --help'.\n", command->name);
  va_end(args);
  return dea_status_exit_code(DEA_E_USAGE);
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
