/* The manual page, in mdoc, out of the table of commands, their usage texts and the status list. */
#include "base/version.h"
#include "cli/usage.h"

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
  int last = -1;
  puts(".Sh EXIT STATUS\n.Bl -tag -width Ds");
  for (;;) {
    int next = 256;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
      next = rows[i].code > last && rows[i].code < next ? rows[i].code : next;
    }
    if (next == 256) {
      break;
    }
    printf(".It %d\n", next);
    const char *separator = "";
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
      if (rows[i].code == next && rows[i].message[0] != '\0') {
        fputs(separator, stdout);
        print_roff(rows[i].message);
        separator = ";\n";
      }
    }
    puts("");
    last = next;
  }
  puts(".El");
}

void cli_print_manual(void)
{
  size_t count;
  const struct dea_command *const *commands = cli_commands(&count);
  puts(".Dd $Mdocdate$\n.Dt DEA 1\n.Os libdea " DEA_VERSION "\n.Sh NAME\n.Nm dea\n"
       ".Nd design and simulation of dielectric elastomer actuators\n"
       ".Sh SYNOPSIS\n.Nm\n.Ar command\n.Op Ar arguments\n.Nm\n.Fl \\-version | \\-help\n"
       ".Sh DESCRIPTION\n.Nm\n"
       "reads a design file of a dielectric elastomer actuator and computes stretch, field,\n"
       "displacement and safety margins against voltage, as tables and figures.\n"
       "Results go to standard output or to a folder, everything else to standard error.\n"
       ".Pp\nEvery command also takes:\n.Bl -tag -width Ds");
  for (size_t i = 0; i < CLI_COMMON_COUNT; i++) {
    printf(".It Fl %s , Fl %s\n", cli_common_options[i].letter + 1, cli_common_options[i].name + 1);
    print_roff(cli_common_options[i].explanation);
    puts("");
  }
  puts(".El\n.Sh COMMANDS");
  for (size_t i = 0; i < count; i++) {
    printf(".Ss %s\n", commands[i]->name);
    print_roff(commands[i]->summary);
    puts(commands[i]->summary[0] != '\0' ? "\n.Bd -literal" : ".Bd -literal");
    fputs("Usage: ", stdout);
    print_roff(commands[i]->usage);
    puts(".Ed");
  }
  puts(".Sh ENVIRONMENT\n.Bl -tag -width DEA_MATERIALS\n.It Ev DEA_MATERIALS\n"
       "directories with materials of your own, separated by colons\n"
       ".It Ev NO_COLOR\nmessages have no colours\n.El");
  print_exit_codes();
  puts(".Sh EXAMPLES\nCompute the paper\\(aqs actuator with four fibres:\n.Bd -literal -offset "
       "indent\n"
       "dea examples frdea\\-4 > my.yaml\ndea check my.yaml\ndea run my.yaml\n.Ed");
}
