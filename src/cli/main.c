#define _POSIX_C_SOURCE 200809L // isatty, fstat
#include "base/text.h"
#include "base/version.h"
#include "cli/bench.h"
#include "cli/cli.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct dea_command *const commands[] = {
#define COMMAND_ROW(name) &name,
    DEA_COMMAND_LIST(COMMAND_ROW)
#undef COMMAND_ROW
        NULL};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] - 1 };

static void print_help(void)
{
  puts("dea - design and simulation of dielectric elastomer actuators\n\n"
       "Usage: dea COMMAND [arguments]\n       dea --version | --help\n\nCommands:");
  for (int i = 0; i < COMMAND_COUNT; i++) {
    printf("  %-12s %s\n", commands[i]->name, commands[i]->summary);
  }
  puts(
      "\nBefore or after the command: --quiet, --verbose. 'dea COMMAND --help' says more.\n"
      "Exit codes: 0 ok, 1 comparison out of tolerance, 2 usage, 3 bad design, 4 not converged or\n"
      "no equilibrium (partial results kept), 5 file or program, 6 instrument or interlock,\n"
      "130 interrupted.\n\n"
      "Start with:  dea examples frdea-4 > my.yaml && dea run my.yaml");
}

/* The command that does what another word asks for, or NULL. */
static const char *meant_by(const char *word)
{
  static const struct {
    const char *word, *command;
  } others[] = {{"maximise", "optimise"}, {"optimize", "optimise"}, {"calibrate", "fit"},
                {"identify", "fit"},      {"simulate", "run"},      {"solve", "run"},
                {"compute", "run"},       {"samples", "sweep"},     {"validate", "check"},
                {"lint", "check"},        {"draw", "plot"},         {"figures", "plot"},
                {"view", "report"},       {"play", "drive"},        {"measure", "drive"},
                {"new", "examples"},      {"init", "examples"},     {"material", "materials"},
                {"make", "fab"},          {"fabricate", "fab"},     {"analyse", "reduce"},
                {"analyze", "reduce"},    {"evaluate", "reduce"},   {"convert", "import"},
                {"export", "recording"}};
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
    if (strcmp(others[i].word, word) == 0) {
      return others[i].command;
    }
  }
  return NULL;
}

static const struct dea_command *find_command(const char *name)
{
  const char *names[COMMAND_COUNT];
  for (int i = 0; i < COMMAND_COUNT; i++) {
    names[i] = commands[i]->name;
    if (strcmp(names[i], name) == 0) {
      return commands[i];
    }
  }
  const char *nearest = meant_by(name);
  nearest = nearest != NULL ? nearest : dea_nearest_name(name, names, COMMAND_COUNT);
  fprintf(stderr, "dea: '%s' is not a command", name);
  fprintf(stderr, nearest != NULL ? "; did you mean '%s'?\n" : "; see 'dea --help'\n", nearest);
  return NULL;
}

/* DEA_E_USAGE where the command is not for several ranks: the first would wait for others. */
static dea_status check_ranks(const struct dea_cli *cli)
{
  return cli->ranks == 1 || cli->command->on_ranks
             ? DEA_OK
             : dea_fail(cli->ctx, DEA_E_USAGE,
                        "dea %s runs in one process, and mpirun has started %d; use mpirun for "
                        "one large case of dea run, -j for many cases of dea sweep and dea "
                        "optimise",
                        cli->command->name, cli->ranks);
}

static dea_status run_command(struct dea_cli *cli, int argc, char **argv)
{
  const struct dea_command *command = cli->command;
  if (cli->help) {
    struct dea_text usage = {.ctx = cli->ctx};
    dea_text_add(&usage, "%s\n\n", command->summary);
    cli_add_usage(cli, command, &usage);
    return cli_print_text(DEA_OK, &usage);
  }
  cli_watch(cli);
  void *request = dea_alloc(cli->ctx, 1, command->request_size);
  DEA_TRY_MEMORY(request != NULL);
  if (command->defaults != NULL) {
    memcpy(request, command->defaults, command->request_size);
  }
  dea_status status = cli_parse(cli, argc, argv, request);
  status = status == DEA_OK ? check_ranks(cli) : status;
  status = status == DEA_OK ? command->run(cli, request) : status;
  dea_free(cli->ctx, request);
  return status;
}

/* Standard files that the caller has closed become /dev/null; else the first result file would get
 * their number and what is printed would end in it. Whether standard output was closed. */
static bool open_standard_files(void)
{
  bool closed = fcntl(STDOUT_FILENO, F_GETFD) < 0;
  int fd = open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= STDERR_FILENO) {
    fd = open("/dev/null", O_RDWR);
  }
  if (fd >= 0) {
    close(fd);
  }
  return closed;
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

/* Processes that mpirun has started, 1 where it has not. */
static int count_ranks(void)
{
  const char *count = getenv("OMPI_COMM_WORLD_SIZE");
  count = count != NULL ? count : getenv("PMI_SIZE");
  const long ranks = count != NULL ? strtol(count, NULL, 10) : 1;
  return ranks > 1 ? (int)ranks : 1;
}

static bool silence(void)
{
  return freopen("/dev/null", "w", stdout) != NULL && freopen("/dev/null", "w", stderr) != NULL;
}

static bool wants_json(int argc, char **argv)
{
  bool wants = false;
  for (int i = 1; i < argc; i++) {
    wants = wants || strcmp(argv[i], "--json") == 0;
  }
  return wants;
}

/* Output that could not be written is a failure, and what --json writes to a standard output that
 * was closed; a reader of a pipe that has had enough (head)
 * needs no message. */
static int finish_output(int code, bool wanted_closed)
{
  struct stat file;
  if (wanted_closed && code == 0) {
    fputs("dea: error: standard output is closed, and --json writes there\n", stderr);
    return dea_status_exit_code(DEA_E_IO);
  }
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
  cli_bench_enter(argv);
  bool closed = open_standard_files();
  struct dea_cli cli = {.commands = commands, .follower = is_follower(), .ranks = count_ranks()};
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
  int code = 0;
  argc = cli_parse_common(&cli, argc, argv);
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
    cli.command = find_command(argv[1]);
    code = cli.command == NULL ? dea_status_exit_code(DEA_E_USAGE)
                               : cli_report(&cli, run_command(&cli, argc - 1, argv + 1));
  }
  dea_text_free(&line);
  dea_context_destroy(cli.ctx);
  return finish_output(code, closed && wants_json(argc, argv));
}
