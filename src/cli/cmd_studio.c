#define _GNU_SOURCE // environ, POSIX_SPAWN_SETSID
#include "base/file.h"
#include "base/write_file.h"
#include "cli/cli.h"
#include "studio/studio.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct request {
  const char *what; // folder or design; NULL: here
  double port;
  bool no_browser;
};

extern char **environ;

static dea_status parse_port(struct dea_cli *cli, const struct cli_option *option, const char *text,
                             void *target)
{
  double *port = target;
  char after;
  (void)option;
  return sscanf(text, "%lf%c", port, &after) == 1 && *port >= 0 && *port <= 65535 &&
                 *port == (int)*port
             ? DEA_OK
             : cli_usage_error(cli, "'%s' is no port; one from 1024 to 65535", text);
}

static void open_browser(const char *page)
{
  pid_t process;
  char *const argv[] = {(char *)"xdg-open", (char *)(uintptr_t)page, NULL};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t own; // Ctrl-C here is not for the browser
  if (posix_spawn_file_actions_init(&actions) != 0 || posix_spawnattr_init(&own) != 0) {
    return;
  }
  posix_spawnattr_setflags(&own, POSIX_SPAWN_SETSID);
  for (int file = 0; file < 3; file++) { // what a browser says is no output of ours
    posix_spawn_file_actions_addopen(&actions, file, "/dev/null", O_RDWR, 0);
  }
  (void)posix_spawnp(&process, argv[0], &actions, &own, argv, environ);
  posix_spawnattr_destroy(&own);
  posix_spawn_file_actions_destroy(&actions);
}

/* Goes to a folder, where runs name files, or to that of a design, whose name is *design then. */
static dea_status enter(struct dea_context *ctx, const char *what, const char **design)
{
  char folder[4096];
  const char *name = dea_path_name(what);
  *design = dea_path_is_folder(what) ? NULL : name;
  if (*design != NULL && !dea_path_exists(what)) {
    return dea_fail(ctx, DEA_E_IO, "there is no folder or design %s", what);
  }
  const int length = *design == NULL ? INT_MAX : (int)(name - what);
  snprintf(folder, sizeof folder, "%.*s%s", length, what, length == 0 ? "." : "");
  return chdir(folder) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO, "cannot open the folder %s: %s", folder, strerror(errno));
}

static dea_status serve(struct dea_cli *cli, const struct request *request,
                        struct dea_studio_options *options)
{
  struct dea_studio *studio;
  DEA_TRY(cli->ctx, dea_studio_start(cli->ctx, options, &studio));
  printf("%s\n", dea_studio_address(studio));
  fflush(stdout);
  if (!cli->quiet) {
    fprintf(stderr, "dea studio of %s; Ctrl-C ends it. The address is a key: keep it.\n",
            request->what != NULL ? request->what : "this folder");
  }
  if (!request->no_browser) {
    open_browser(dea_studio_doorway(studio));
  }
  dea_studio_serve(studio);
  dea_studio_stop(studio);
  return DEA_OK;
}

/* Designs that can be copied: examples of devices, but not those of commands. */
static size_t choose(const struct cli_data_list *list, struct dea_studio_example *out)
{
  size_t count = 0;
  for (size_t i = 0; i < list->count; i++) {
    const char *name = list->files[i].name;
    if ((strchr(name, '/') == NULL && strcmp(name, "protocol.yaml") != 0) ||
        strncmp(name, "devices/", strlen("devices/")) == 0) {
      out[count++] = (struct dea_studio_example){name, list->files[i].path};
    }
  }
  return count;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct cli_data_list list;
  char program[4096] = "";
  struct dea_studio_options options = {.program = program, .port = (int)request->port};
  if (readlink("/proc/self/exe", program, sizeof program - 1) <= 0) {
    return dea_fail(cli->ctx, DEA_E_IO, "where this program lies is not known");
  }
  dea_status status = cli_examples_find(cli->ctx, ".yaml", &list);
  struct dea_studio_example *examples = dea_alloc(cli->ctx, list.count, sizeof *examples);
  status = examples != NULL ? status : DEA_E_MEMORY;
  if (status == DEA_OK) {
    status = enter(cli->ctx, request->what != NULL ? request->what : ".", &options.open);
  }
  if (status == DEA_OK) {
    options.example_count = choose(&list, examples);
    options.examples = examples;
    setenv("NO_COLOR", "1", 1); // what runs say is shown in the page
    status = serve(cli, request, &options);
  }
  dea_free(cli->ctx, examples);
  cli_data_free(cli->ctx, &list);
  return status;
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_FILE, "FOLDER",
     "folder of designs and runs, or one of its designs; here if not given", CLI_AT(what),
     .too_many = "one folder at a time"},
    {"port", 0, CLI_TEXT, "N", "port of 127.0.0.1; a free one if not given", CLI_AT(port),
     parse_port},
    {"no-browser", 0, CLI_FLAG, NULL, "only print the address", CLI_AT(no_browser)},
    {0}};

const struct dea_command cmd_studio = {
    .name = "studio",
    .summary = "Edit, draw, run and compare the designs of a folder in a page of the browser",
    .about = "Serves the page on this computer only (127.0.0.1), to who has the address that is "
             "printed, until Ctrl-C. All that it makes are files in the folder, and runs go on as "
             "long as it does; it has no way to the bench.",
    CLI_RUN};
