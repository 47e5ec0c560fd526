#define _XOPEN_SOURCE 700 // sigaction, isatty, SIGVTALRM
#include "base/text.h"
#include "base/version.h"
#include "cli/cli.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const struct dea_command *const cli_commands[] = {
#define COMMAND_ROW(name) &name,
    DEA_COMMAND_LIST(COMMAND_ROW)
#undef COMMAND_ROW
        NULL};
enum { COMMAND_COUNT = sizeof cli_commands / sizeof cli_commands[0] - 1 };

const struct cli_option cli_common_options[] = {
#define AT(member) .target = offsetof(struct dea_cli, member)
    {"quiet", 'q', CLI_FLAG, NULL, "no progress, no notes", AT(quiet)},
    {"verbose", 'v', CLI_FLAG, NULL, "say more about an error", AT(verbose)},
    {"help", 'h', CLI_FLAG, NULL, "say how the command is used", AT(help)},
#undef AT
    {0}};

static volatile sig_atomic_t interrupt_flag, voltage_flag;

static void on_signal(int number)
{
  if (interrupt_flag != 0 && voltage_flag == 0) {
    _exit(128 + number); // a second one: the user means it
  }
  interrupt_flag = 1;
}

/* Whether a line can be written to stderr without waiting: a terminal that is held (Ctrl-S, a
 * connection that is gone) would keep the loop from playing, and the output at its voltage. */
static bool has_room(void)
{
  struct pollfd entry = {.fd = STDERR_FILENO, .events = POLLOUT};
  return poll(&entry, 1, 0) > 0 && (entry.revents & POLLOUT) != 0;
}

/* One line that is rewritten on a terminal, a plain line otherwise. */
static void show_progress(void *user, const char *what, size_t done, size_t total)
{
  const struct dea_cli *cli = user;
  if (cli->quiet || (voltage_flag != 0 && !has_room())) {
    return;
  }
  if (cli->terminal) {
    fprintf(stderr, "\r\033[K%s %zu/%zu%s", what, done, total, done == total ? "\n" : "");
    fflush(stderr);
  } else if (done == total) {
    fprintf(stderr, "%s: %zu points\n", what, done);
  }
}

static const char *severity_text(enum dea_severity severity, bool colour)
{
  static const char *const plain[] = {"note", "warning", "error"};
  static const char *const coloured[] = {"\033[36mnote\033[0m", "\033[35mwarning\033[0m",
                                         "\033[1;31merror\033[0m"};
  return colour ? coloured[severity] : plain[severity];
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

static void print_help(void)
{
  puts("dea - design and simulation of dielectric elastomer actuators\n\n"
       "Usage: dea COMMAND [arguments]\n       dea --version | --help\n\nCommands:");
  for (int i = 0; i < COMMAND_COUNT; i++) {
    printf("  %-12s %s\n", cli_commands[i]->name, cli_commands[i]->summary);
  }
  puts(
      "\nBefore or after the command: --quiet, --verbose. 'dea COMMAND --help' says more.\n"
      "Exit codes: 0 ok, 1 comparison out of tolerance, 2 usage, 3 bad design, 4 not converged or\n"
      "no equilibrium (partial results kept), 5 file or program, 6 instrument or interlock,\n"
      "130 interrupted.\n\n"
      "Start with:  dea examples frdea-4 > my.yaml && dea run my.yaml");
}

static const struct dea_command *find_command(const char *name)
{
  const char *names[COMMAND_COUNT];
  for (int i = 0; i < COMMAND_COUNT; i++) {
    names[i] = cli_commands[i]->name;
    if (strcmp(names[i], name) == 0) {
      return cli_commands[i];
    }
  }
  const char *nearest = dea_nearest_name(name, names, COMMAND_COUNT);
  fprintf(stderr, "dea: '%s' is not a command", name);
  fprintf(stderr, nearest != NULL ? "; did you mean '%s'?\n" : "; see 'dea --help'\n", nearest);
  return NULL;
}

/* Takes the options common to all commands out of argv; returns the new argc. */
static int take_common_options(struct dea_cli *cli, int argc, char **argv)
{
  int kept = 0;
  for (int i = 0; i < argc; i++) {
    const struct cli_option *o = cli_common_options;
    for (; o->help != NULL; o++) {
      const char letter[] = {'-', o->letter, '\0'};
      bool is_long = strncmp(argv[i], "--", 2) == 0 && strcmp(argv[i] + 2, o->name) == 0;
      if (is_long || strcmp(argv[i], letter) == 0) {
        *(bool *)((char *)cli + o->target) = true;
        break;
      }
    }
    if (o->help == NULL) {
      argv[kept++] = argv[i];
    }
  }
  argv[kept] = NULL;
  return kept;
}

static void watch_signals(void)
{
  struct sigaction action = {.sa_handler = on_signal};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
}

void cli_voltage_is_on(void)
{
  // The terminal is closed, limits of time, what batch systems and timers send: all would end the
  // program at once.
  static const int ending[] = {SIGHUP,  SIGQUIT, SIGALRM,   SIGUSR1,
                               SIGUSR2, SIGXCPU, SIGVTALRM, SIGPROF};
  // A stopped program leaves the voltage where it is; a file that is too long is an error to write.
  static const int ignored[] = {SIGTSTP, SIGTTOU, SIGTTIN, SIGXFSZ};
  struct sigaction action = {.sa_handler = on_signal}, before;
  sigemptyset(&action.sa_mask);
  voltage_flag = 1;
  for (size_t i = 0; i < sizeof ending / sizeof ending[0]; i++) {
    // what was ignored before stays so: `nohup` asks for it
    if (sigaction(ending[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
      sigaction(ending[i], &action, NULL);
    }
  }
  for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++) {
    signal(ignored[i], SIG_IGN);
  }
}

static int run_command(struct dea_cli *cli, int argc, char **argv)
{
  const struct dea_command *command = find_command(argv[0]);
  if (command == NULL) {
    return dea_status_exit_code(DEA_E_USAGE);
  }
  if (cli->help) {
    struct dea_text usage = {.ctx = cli->ctx};
    dea_text_add(&usage, "%s\n\n", command->summary);
    cli_add_usage(command, &usage);
    return cli_report(cli, cli_print_text(DEA_OK, &usage));
  }
  watch_signals();
  if (cli->follower && command != &cmd_run) {
    return 0; // nothing to compute together
  }
  char *request = dea_alloc(cli->ctx, 1, command->request_size);
  if (request == NULL) {
    return cli_report(cli, DEA_E_MEMORY);
  }
  if (command->defaults != NULL) {
    memcpy(request, command->defaults, command->request_size);
  }
  int code = cli_parse(cli, command, argc, argv, request);
  code = code != 0 ? code : command->run(cli, request);
  dea_free(cli->ctx, request);
  return code;
}

/* Standard files that the caller has closed become /dev/null; else the first result file would get
 * their number and what is printed would end in it. */
static void open_standard_files(void)
{
  int fd = open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= STDERR_FILENO) {
    fd = open("/dev/null", O_RDWR);
  }
  if (fd >= 0) {
    close(fd);
  }
}

/* Whether mpirun started this process beside a first one, which alone prints and writes files. */
static bool is_follower(void)
{
  static const char *const names[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    const char *rank = getenv(names[i]);
    if (rank != NULL && rank[0] != '\0') {
      return strcmp(rank, "0") != 0;
    }
  }
  return false;
}

static bool silence(void)
{
  return freopen("/dev/null", "w", stdout) != NULL && freopen("/dev/null", "w", stderr) != NULL;
}

/* Output that could not be written is a failure; a reader of a pipe that has had enough (head)
 * needs no message. */
static int finish_output(int code)
{
  struct stat file;
  bool lost = ferror(stdout) != 0; // some earlier flush
  lost = fflush(stdout) != 0 || lost;
  if (lost && !(fstat(STDOUT_FILENO, &file) == 0 && S_ISFIFO(file.st_mode))) {
    fputs("dea: error: standard output could not be written completely; is its disk full?\n",
          stderr);
  }
  return lost && code == 0 ? dea_status_exit_code(DEA_E_IO) : code;
}

int main(int argc, char **argv)
{
  open_standard_files();
  struct dea_cli cli = {.follower = is_follower()};
  if (cli.follower && !silence()) {
    return dea_status_exit_code(DEA_E_IO);
  }
  cli.terminal = isatty(STDERR_FILENO) == 1;
  cli.colour = cli.terminal && getenv("NO_COLOR") == NULL;
  if (dea_context_create(NULL, &cli.ctx) != DEA_OK) {
    fputs("dea: out of memory\n", stderr);
    return dea_status_exit_code(DEA_E_MEMORY);
  }
  struct dea_text line = {.ctx = cli.ctx};
  for (int i = 0; i < argc; i++) {
    dea_text_add(&line, "%s%s", i > 0 ? " " : "", i > 0 ? argv[i] : "dea");
  }
  cli.command_line = dea_text_get(&line);
  dea_context_set_progress(cli.ctx, show_progress, &cli);
  dea_context_set_interrupt(cli.ctx, &interrupt_flag);
  int code = 0;
  argc = take_common_options(&cli, argc, argv);
  if (argc >= 2 && strcmp(argv[1], "help") == 0) { // "dea help run" as "dea run --help"
    cli.help = true;
    argc--;
    argv++;
  }
  if (argc < 2) {
    print_help();
    code = cli.help ? 0 : dea_status_exit_code(DEA_E_USAGE);
  } else if (strcmp(argv[1], "--version") == 0) {
    printf("dea %s\n", DEA_VERSION);
  } else {
    code = run_command(&cli, argc - 1, argv + 1);
  }
  dea_text_free(&line);
  dea_context_destroy(cli.ctx);
  return finish_output(code);
}
