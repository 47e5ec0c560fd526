/* A command line read by the table of its command. */
#define _GNU_SOURCE // getopt_long, sysconf
#include "cli/cli.h"

#include "base/file.h"
#include "plot/plot.h"
#include "study/design_file.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const struct cli_option cli_common_options[] = {
#define AT(member) .target = offsetof(struct dea_cli, member)
    {"quiet", 'q', CLI_FLAG, NULL, "no progress, no notes", AT(quiet)},
    {"verbose", 'v', CLI_FLAG, NULL, "say more about an error", AT(verbose)},
    {"help", 'h', CLI_FLAG, NULL, "say how the command is used", AT(help)},
#undef AT
    {0}};

const struct cli_option *cli_argument_of(const struct dea_command *command)
{
  const struct cli_option *option = command->options;
  while (option->help != NULL && option->name != NULL) {
    option++;
  }
  return option;
}

/* Puts one value where it belongs. */
static dea_status parse_option(struct dea_cli *cli, const struct cli_option *option,
                               const char *text, void *request)
{
  void *target = (char *)request + option->target;
  if (option->take != NULL) {
    return option->take(cli, option, text, target);
  }
  if (option->kind == CLI_FLAG) {
    *(bool *)target = true;
  } else if (option->most > 1) {
    struct cli_words *words = target;
    if (words->count == option->most) {
      return cli_usage_error(cli, "%s", option->too_many);
    }
    words->at[words->count++] = text;
  } else {
    *(const char **)target = text;
  }
  return DEA_OK;
}

/* The words that are no options. */
static dea_status parse_arguments(struct dea_cli *cli, int count, char **words, void *request)
{
  const struct cli_option *option = cli_argument_of(cli->command);
  const int most = option->help == NULL ? 0 : option->most > 1 ? (int)option->most : 1;
  if (count < (int)option->least) {
    return cli_usage_error(cli, "%s", option->too_few);
  }
  if (count > most) {
    return option->too_many != NULL
               ? cli_usage_error(cli, "%s", option->too_many)
               : cli_usage_error(cli, "'%s' is not expected here", words[most]);
  }
  for (int i = 0; i < count; i++) {
    DEA_TRY(cli->ctx, parse_option(cli, option, words[i], request));
  }
  return DEA_OK;
}

/* Usage error where two are given of options that exclude each other. */
static dea_status check_exclusions(struct dea_cli *cli, const bool given[CLI_OPTIONS_MAX])
{
  const struct cli_option *options = cli->command->options;
  for (size_t first = 0, i = 0; options[first].help != NULL; first = i) {
    size_t count = 0;
    char names[128] = "";
    for (i = first; i == first || options[i].or_before; i++) {
      bool last = options[i + 1].help == NULL || !options[i + 1].or_before;
      size_t used = strlen(names);
      count += given[i];
      if (options[i].name != NULL) {
        snprintf(names + used, sizeof names - used, "%s--%s",
                 i == first ? ""
                 : last     ? " and "
                            : ", ",
                 options[i].name);
      }
    }
    if (count > 1) {
      return cli_usage_error(cli, "%s exclude each other", names);
    }
  }
  return DEA_OK;
}

/* The common option of a letter, or of a name; NULL: none. */
static const struct cli_option *find_common(char letter, const char *name)
{
  for (const struct cli_option *o = cli_common_options; o->help != NULL; o++) {
    if (name != NULL ? strcmp(o->name, name) == 0 : o->letter == letter) {
      return o;
    }
  }
  return NULL;
}

/* Whether a word is common options only, such as --quiet or -vv; sets them. */
static bool parse_common(struct dea_cli *cli, const char *word)
{
  bool is_long = strncmp(word, "--", 2) == 0;
  size_t count = is_long ? 1 : strlen(word) - (word[0] != '\0');
  for (int set = 0; set < 2; set++) {
    for (size_t i = 0; i < count; i++) {
      const struct cli_option *o = find_common(word[1 + i], is_long ? word + 2 : NULL);
      if (word[0] != '-' || o == NULL) {
        return false;
      }
      if (set) {
        *(bool *)((char *)cli + o->target) = true;
      }
    }
  }
  return count > 0;
}

int cli_parse_common(struct dea_cli *cli, int argc, char **argv)
{
  int kept = 0;
  for (int i = 0; i < argc; i++) {
    if (!parse_common(cli, argv[i])) {
      argv[kept++] = argv[i];
    }
  }
  argv[kept] = NULL;
  return kept;
}

/* What is written is no pipe or device, and nothing that is read: no other word of the line names
 * it. word: of argv that it is, or begins behind the option in. */
static dea_status check_written(struct dea_cli *cli, int argc, char **argv, int word,
                                const char *file)
{
  DEA_TRY(cli->ctx, dea_path_check_target(cli->ctx, file));
  for (int i = 1; i < argc; i++) {
    const char *equals = argv[i][0] == '-' ? strchr(argv[i], '=') : NULL;
    const char *other = equals != NULL ? equals + 1 : argv[i];
    if (i != word && dea_path_is_same(other, file)) {
      return dea_fail(cli->ctx, DEA_E_IO,
                      "%s is read, and would be written over: give another name", file);
    }
  }
  return DEA_OK;
}

enum { FIRST_LONG = 256 }; // above all letters: what getopt_long answers for the first row

/* The row that getopt_long has found; a usage error, and NULL, where that is wrong. */
static const struct cli_option *find_option(struct dea_cli *cli, int found, const char *word)
{
  const struct cli_option *option = cli->command->options;
  if (found == '?' && optopt != 0 && optopt < FIRST_LONG) { // a letter, perhaps one of several
    cli_usage_error(cli,
                    find_common((char)optopt, NULL) != NULL
                        ? "'-%c' stands alone, not with letters of other options"
                        : "there is no option '-%c'",
                    optopt);
    return NULL;
  }
  if (found == ':' || found == '?') {
    cli_usage_error(cli, found == ':' ? "option '%s' needs a value" : "there is no option '%s'",
                    word);
    return NULL;
  }
  while (found < FIRST_LONG && option->letter != found) {
    option++;
  }
  option += found < FIRST_LONG ? 0 : found - FIRST_LONG;
  if (option->kind != CLI_FLAG && optarg[0] == '\0') { // "$NAME" of a shell that knows no NAME
    cli_usage_error(cli, "option '--%s' has an empty value", option->name);
    return NULL;
  }
  return option;
}

dea_status cli_parse(struct dea_cli *cli, int argc, char **argv, void *request)
{
  struct option longs[CLI_OPTIONS_MAX + 1] = {{0}}, *next = longs;
  bool given[CLI_OPTIONS_MAX] = {false};
  char letters[2 * CLI_OPTIONS_MAX + 2] = ":", *letter = letters + 1;
  const struct cli_option *options = cli->command->options;
  for (const struct cli_option *o = options; o->help != NULL; o++) {
    const bool flag = o->kind == CLI_FLAG;
    if (o->name != NULL) {
      *next++ = (struct option){o->name, flag ? no_argument : required_argument, NULL,
                                FIRST_LONG + (int)(o - options)};
    }
    if (o->letter != 0) {
      letter += sprintf(letter, "%c%s", o->letter, flag ? "" : ":");
    }
  }
  opterr = 0;
  for (int found; (found = getopt_long(argc, argv, letters, longs, NULL)) != -1;) {
    const struct cli_option *option = find_option(cli, found, argv[optind - 1]);
    if (option == NULL) {
      return DEA_E_USAGE;
    }
    given[option - options] = true;
    DEA_TRY(cli->ctx, parse_option(cli, option, optarg, request));
    if (option->kind == CLI_NEW_FILE) {
      DEA_TRY(cli->ctx, check_written(cli, argc, argv, optind - 1, optarg));
    }
  }
  DEA_TRY(cli->ctx, check_exclusions(cli, given));
  return parse_arguments(cli, argc - optind, argv + optind, request);
}

dea_status cli_parse_override(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target)
{
  struct cli_overrides *overrides = target;
  char *equals = strchr(text, '=');
  if (equals == NULL || equals == text || overrides->count == CLI_OVERRIDES_MAX) {
    return cli_usage_error(cli, "--%s takes KEY=VALUE, not '%s'", option->name, text);
  }
  *equals = '\0'; // argv is ours
  overrides->at[overrides->count++] = (struct dea_override){.key = text, .value = equals + 1};
  return DEA_OK;
}

dea_status cli_parse_quantity(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target)
{
  char why[DEA_WHY_SIZE];
  double *value = target;
  if (!dea_units_read(cli->ctx, text, option->measure, value, why)) {
    return why[0] == '\0' ? dea_context_status(cli->ctx)
                          : cli_usage_error(cli, "--%s: %s", option->name, why);
  }
  return *value > 0.0 || !option->positive
             ? DEA_OK
             : cli_usage_error(cli, "--%s '%s': must be more than 0, such as %s", option->name,
                               text, option->measure.example);
}

dea_status cli_parse_formats(struct dea_cli *cli, const struct cli_option *option, const char *text,
                             void *target)
{
  struct dea_plot_format *format = target;
  (void)option;
  format->svg = format->pdf = format->png = false;
  for (const char *word = text;; word++) {
    size_t n = strcspn(word, ",");
    bool *which = n != 3                         ? NULL
                  : strncmp(word, "svg", n) == 0 ? &format->svg
                  : strncmp(word, "pdf", n) == 0 ? &format->pdf
                  : strncmp(word, "png", n) == 0 ? &format->png
                                                 : NULL;
    if (which == NULL) {
      return cli_usage_error(cli, "'%s' is not a list of svg, pdf, png", text);
    }
    *which = true;
    word += n;
    if (*word == '\0') {
      return DEA_OK;
    }
  }
}

dea_status cli_parse_width(struct dea_cli *cli, const struct cli_option *option, const char *text,
                           void *target)
{
  struct dea_plot_format *format = target;
  const char *end;
  double width_mm = dea_text_to_double(text, &end);
  (void)option;
  if (end == text || (*end != '\0' && strcmp(end, "mm") != 0 && strcmp(end, " mm") != 0) ||
      !(width_mm >= 40.0) || !(width_mm <= 400.0)) {
    return cli_usage_error(cli, "'%s' is not a width of 40 to 400 mm", text);
  }
  format->width_m = 1e-3 * width_mm;
  return DEA_OK;
}

bool cli_read_share(const char *text, double *share)
{
  const char *end;
  *share = dea_text_to_double(text, &end);
  if (end == text || !isfinite(*share)) {
    return false;
  }
  if (strcmp(end, "%") == 0 || strcmp(end, " %") == 0) {
    *share /= 100.0;
    return true;
  }
  return *end == '\0';
}

dea_status cli_keep_text(struct dea_text *text, const char **out)
{
  *out = text->failed ? NULL : dea_intern(text->ctx, dea_text_get(text));
  dea_text_free(text);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

dea_status cli_output_name(struct dea_cli *cli, const char *file, const char *ending,
                           const char **name)
{
  size_t length;
  const char *stem = dea_path_stem(file, &length);
  struct dea_text made = {.ctx = cli->ctx};
  if (*name != NULL) {
    return DEA_OK;
  }
  dea_text_add(&made, "%.*s.%s", (int)length, stem, ending);
  return cli_keep_text(&made, name);
}

dea_status cli_with_device(struct dea_cli *cli, const char *file,
                           const struct cli_overrides *overrides, cli_device_work *work,
                           const void *request)
{
  struct dea_design *design = NULL;
  struct dea_device *device = NULL;
  dea_status status = dea_design_read(cli->ctx, file, overrides->at, overrides->count, &design);
  status = status == DEA_OK ? dea_device_build(cli->ctx, design, &device) : status;
  status = status == DEA_OK ? work(cli, request, design, device) : status;
  dea_device_destroy(cli->ctx, device);
  dea_design_destroy(cli->ctx, design);
  return status;
}

dea_status cli_parse_processes(struct dea_cli *cli, const struct cli_option *option,
                               const char *text, void *target)
{
  char *end;
  const double count = strtod(text, &end);
  if (*end != '\0' || !(count >= 1 && count <= 256) || count != floor(count)) {
    return cli_usage_error(cli, "--%s: '%.20s' is no number from 1 to 256", option->name, text);
  }
  *(double *)target = count;
  return DEA_OK;
}

size_t cli_processes(double given)
{
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  return given > 0 ? (size_t)given : cores > 0 ? (size_t)cores : 1;
}
