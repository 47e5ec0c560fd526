/* What --help and the manual page say, out of the table of commands, their options and the status
 * list. */
#include "base/version.h"
#include "cli/cli.h"

#include <string.h>

enum { WIDTH = 96, LEFT_SIZE = 64 };

/* Adds a word, on a new line where it is too long for this one; no space stands before the first,
 * which is at the margin. */
static void add_token(struct dea_text *out, int margin, int *column, const char *word, size_t n)
{
  if (*column > margin && *column + (int)n > WIDTH) {
    dea_text_add(out, "\n%*s", margin, "");
    *column = margin;
  }
  dea_text_add(out, "%s%.*s", *column > margin ? " " : "", (int)n, word);
  *column += (int)n + (*column > margin);
}

void cli_add_wrapped(struct dea_text *out, int margin, const char *text, size_t length)
{
  int column = margin;
  for (const char *end = text + length; text < end;) {
    size_t n = strcspn(text, " \n");
    n = n < (size_t)(end - text) ? n : (size_t)(end - text);
    add_token(out, margin, &column, text, n);
    text += n;
    text += strspn(text, " \n");
  }
  dea_text_add(out, "\n");
}

/* "dea run DESIGN... [-o DIR] [--arm | --sim]". */
static void add_synopsis(const struct dea_command *command, struct dea_text *out)
{
  char token[256];
  int margin = (int)strlen("Usage: dea ") + (int)strlen(command->name), column = margin + 1;
  dea_text_add(out, "Usage: dea %s", command->name);
  for (int named = 0; named < 2; named++) { // the argument first
    const struct cli_option *next, *o = command->options;
    for (; o->help != NULL; o = next) {
      size_t used = 0;
      for (next = o; next == o || (next->help != NULL && next->or_before); next++) {
        const char letter[] = {'-', next->letter, '\0'};
        bool is_short = next->letter != 0, value = next->kind != CLI_FLAG;
        used += (size_t)snprintf(token + used, sizeof token - used, "%s%s%s%s%s",
                                 next > o           ? " | "
                                 : next->least == 0 ? "["
                                                    : "",
                                 next->name == NULL ? ""
                                 : is_short         ? letter
                                                    : "--",
                                 next->name == NULL || is_short ? "" : next->name,
                                 value && next->name != NULL ? " " : "", value ? next->value : "");
      }
      if ((o->name != NULL) == named) {
        used += (size_t)snprintf(token + used, sizeof token - used, "%s%s",
                                 o->least == 0 ? "]" : "", named && o->most > 1 ? "..." : "");
        add_token(out, margin, &column, token, used);
      }
    }
  }
  dea_text_add(out, "\n");
}

/* The explanation of a row, and the values that there are where they are few. */
static void add_help(struct dea_cli *cli, struct dea_text *out, int margin,
                     const struct cli_option *option)
{
  const struct cli_kind_info *kind = &cli_kinds[option->kind];
  struct dea_text help = {.ctx = out->ctx}, list = {.ctx = out->ctx};
  dea_text_add(&help, "%s", option->help);
  if (kind->few && cli_kind_list(cli, kind, &list) == DEA_OK) {
    const char *separator = ": ";
    for (const char *word = dea_text_get(&list); *word != '\0'; word += strcspn(word, "\n") + 1) {
      dea_text_add(&help, "%s%.*s", separator, (int)strcspn(word, "\n"), word);
      separator = ", ";
    }
  }
  cli_add_wrapped(out, margin, dea_text_get(&help), help.length);
  dea_text_free_in(&help, out);
  dea_text_free_in(&list, out);
}

/* "  -o, --output DIR" into left; its length. */
static int left_of(const struct cli_option *option, char left[LEFT_SIZE])
{
  const char letter[] = {'-', option->letter, ',', '\0'};
  bool value = option->kind != CLI_FLAG;
  return option->name == NULL
             ? snprintf(left, LEFT_SIZE, "  %s", option->value)
             : snprintf(left, LEFT_SIZE, "  %3s --%s%s%s", option->letter != 0 ? letter : "",
                        option->name, value ? " " : "", value ? option->value : "");
}

void cli_add_usage(struct dea_cli *cli, const struct dea_command *command, struct dea_text *out)
{
  char left[LEFT_SIZE];
  int margin = 0;
  add_synopsis(command, out);
  dea_text_add(out, command->about != NULL ? "\n" : "");
  for (const char *line = command->about; line != NULL; line = strchr(line, '\n')) {
    line += line > command->about;
    cli_add_wrapped(out, 0, line, strcspn(line, "\n"));
  }
  for (const struct cli_option *o = command->options; o->help != NULL; o++) {
    int n = left_of(o, left);
    margin = n + 2 > margin ? n + 2 : margin;
  }
  dea_text_add(out, margin > 0 ? "\n" : "");
  for (const struct cli_option *o = command->options; o->help != NULL; o++) {
    left_of(o, left);
    dea_text_add(out, "%-*s", margin, left);
    add_help(cli, out, margin, o);
  }
}

// The manual page --------------------------------------------------------------------------------

/* Text of a manual page; a line that starts with a dot or a quote would be a request. */
static void print_roff(const char *text)
{
  bool line_start = true;
  for (; *text != '\0'; text++) {
    if (line_start && (*text == '.' || *text == '\'')) {
      fputs("\\&", stdout);
    }
    if (*text == '\\') {
      fputs("\\e", stdout);
    } else if (*text == '-') {
      fputs("\\-", stdout);
    } else {
      putchar(*text);
    }
    line_start = *text == '\n';
  }
}

static void print_exit_codes(void)
{
  struct row {
    int code;
    const char *message;
  };
  static const struct row rows[] = {
#define CODE_ROW(code, exit_code, message) {exit_code, message},
      DEA_STATUS_LIST(CODE_ROW)
#undef CODE_ROW
  };
  puts(".Sh EXIT STATUS\n.Bl -tag -width Ds");
  for (int code = 0; code < 256; code++) {
    bool any = false;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
      if (rows[i].code == code && rows[i].message[0] != '\0') {
        printf(any ? ";\n" : ".It %d\n", code);
        print_roff(rows[i].message);
        any = true;
      }
    }
    fputs(any ? "\n" : "", stdout);
  }
  puts(".El");
}

dea_status cli_print_manual(struct dea_cli *cli)
{
  dea_status status = DEA_OK;
  puts(".Dd $Mdocdate$\n.Dt DEA 1\n.Os libdea " DEA_VERSION "\n.Sh NAME\n.Nm dea\n"
       ".Nd design and simulation of dielectric elastomer actuators\n"
       ".Sh SYNOPSIS\n.Nm\n.Ar command\n.Op Ar arguments\n.Nm\n.Fl \\-version | \\-help\n"
       ".Sh DESCRIPTION\n.Nm\n"
       "reads a design file of a dielectric elastomer actuator and computes stretch, field,\n"
       "displacement and safety margins against voltage, as tables and figures.\n"
       "Results go to standard output or to a folder, everything else to standard error.\n"
       ".Pp\nEvery command also takes:\n.Bl -tag -width Ds");
  for (const struct cli_option *o = cli_common_options; o->help != NULL; o++) {
    printf(".It Fl %c , Fl -%s\n%s\n", o->letter, o->name, o->help);
  }
  puts(".El\n.Sh COMMANDS");
  for (size_t i = 0; cli->commands[i] != NULL && status == DEA_OK; i++) {
    struct dea_text usage = {.ctx = cli->ctx};
    cli_add_usage(cli, cli->commands[i], &usage);
    printf(".Ss %s\n", cli->commands[i]->name);
    print_roff(cli->commands[i]->summary);
    puts("\n.Bd -literal");
    print_roff(dea_text_get(&usage));
    puts(".Ed");
    status = dea_text_free(&usage);
  }
  puts(".Sh ENVIRONMENT\n.Bl -tag -width DEA_MATERIALS\n.It Ev DEA_MATERIALS\n"
       "directories with materials of your own, separated by colons\n"
       ".It Ev NO_COLOR\nmessages have no colours\n.El");
  print_exit_codes();
  puts(".Sh EXAMPLES\nCompute the paper\\(aqs actuator with four fibres:\n.Bd -literal -offset "
       "indent\n"
       "dea examples frdea\\-4 > my.yaml\ndea check my.yaml\ndea run my.yaml\n.Ed");
  return status;
}
