#define _GNU_SOURCE // posix_spawn_file_actions_addchdir_np, pipe2, environ
#include "output/gnuplot.h"

#include "base/file.h"
#include "base/write_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SAID_MAX = 4096, DRAWERS_MAX = 4, SCRIPT_MAX = 80 };

static bool actions_make(posix_spawn_file_actions_t *actions, const char *directory, int pipe_end)
{
  return posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0) == 0 &&
         posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0) == 0 &&
         posix_spawn_file_actions_adddup2(actions, pipe_end, STDERR_FILENO) == 0 &&
         posix_spawn_file_actions_addchdir_np(actions, directory) == 0;
}

/* Starts argv[0] from the PATH in a folder; returns errno's value, 0 when it runs. */
static int start(char *const argv[], const char *directory, int pipe_end, pid_t *child)
{
  posix_spawn_file_actions_t actions;
  int reason = posix_spawn_file_actions_init(&actions);
  if (reason != 0) {
    return reason;
  }
  reason = actions_make(&actions, directory, pipe_end)
               ? posix_spawnp(child, argv[0], &actions, NULL, argv, environ)
               : ENOMEM;
  posix_spawn_file_actions_destroy(&actions);
  return reason;
}

/* Keeps the first bytes of what comes out of a pipe and reads the rest away. */
static void listen(int pipe_end, char *said)
{
  size_t used = 0;
  char rest[512];
  for (;;) {
    bool full = used >= SAID_MAX - 1;
    ssize_t n =
        full ? read(pipe_end, rest, sizeof rest) : read(pipe_end, said + used, SAID_MAX - 1 - used);
    if (n == 0 || (n < 0 && errno != EINTR)) {
      break;
    }
    used += n > 0 && !full ? (size_t)n : 0;
  }
  said[used] = '\0';
}

/* The part of gnuplot's message that says what is wrong: its last line that is not empty. */
static const char *last_line(char *said)
{
  size_t n = strlen(said);
  while (n > 0 && (said[n - 1] == '\n' || said[n - 1] == ' ')) {
    said[--n] = '\0';
  }
  char *newline = strrchr(said, '\n');
  const char *line = newline != NULL ? newline + 1 : said;
  return line + strspn(line, " ");
}

/* A gnuplot that draws some of the figures. */
struct drawer {
  pid_t child;
  int said; // end of the pipe that it complains into
};

static dea_status launch(struct dea_context *ctx, char *const argv[], const char *directory,
                         struct drawer *out)
{
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return dea_fail(ctx, DEA_E_IO, "cannot make a pipe: %s", strerror(errno));
  }
  int reason = start(argv, directory, ends[1], &out->child);
  close(ends[1]);
  if (reason != 0) {
    close(ends[0]);
    if (reason == ENOENT) {
      return dea_fail(ctx, DEA_E_TOOL,
                      "gnuplot is not installed (on Debian: apt install gnuplot-nox); the scripts "
                      "and data of the figures are in %s and can be drawn later",
                      directory);
    }
    return dea_fail(ctx, DEA_E_TOOL, "gnuplot cannot be started: %s", strerror(reason));
  }
  out->said = ends[0];
  return DEA_OK;
}

/* Waits for its end. */
static dea_status finish(struct dea_context *ctx, const struct drawer *drawer,
                         const char *directory)
{
  char said[SAID_MAX];
  listen(drawer->said, said);
  close(drawer->said);
  int state = 0;
  while (waitpid(drawer->child, &state, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) {
    return DEA_OK;
  }
  if (dea_interrupted(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while drawing");
  }
  return dea_fail(ctx, DEA_E_TOOL, "gnuplot failed in %s: %s", directory, last_line(said));
}

/* How many draw at a time: starting one costs as much as a small figure. */
static size_t drawer_count(size_t figures)
{
  long cores = sysconf(_SC_NPROCESSORS_ONLN);
  size_t most = cores < 1 ? 1 : cores > DRAWERS_MAX ? DRAWERS_MAX : (size_t)cores;
  size_t wanted = (figures + 1) / 2;
  return wanted < most ? wanted : most;
}

/* Moves all files of a folder into the one above it, or removes them, and removes the folder. */
static dea_status empty_folder(struct dea_context *ctx, const char *from, const char *to, bool keep)
{
  dea_status status = DEA_OK;
  DIR *folder = opendir(from);
  for (struct dirent *entry; folder != NULL && (entry = readdir(folder)) != NULL;) {
    if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) {
      continue;
    }
    if (!keep || status != DEA_OK) {
      unlinkat(dirfd(folder), entry->d_name, 0);
      continue;
    }
    char *path = dea_path_join(ctx, to, entry->d_name);
    if (path == NULL) {
      status = DEA_E_MEMORY;
      unlinkat(dirfd(folder), entry->d_name, 0);
    } else if (renameat(dirfd(folder), entry->d_name, AT_FDCWD, path) != 0) {
      status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", path, strerror(errno));
      unlinkat(dirfd(folder), entry->d_name, 0);
    }
    dea_free(ctx, path);
  }
  if (folder != NULL) {
    closedir(folder);
  }
  rmdir(from);
  return status;
}

/* Starts a gnuplot for the figures first, first + stride, ... */
static dea_status launch_some(struct dea_context *ctx, const char *directory, char *folder,
                              const char *const names[], size_t count, size_t first, size_t stride,
                              struct drawer *out)
{
  char **argv = dea_alloc(ctx, count + 5, sizeof *argv);
  char *scripts = dea_alloc(ctx, count, SCRIPT_MAX);
  dea_status status = DEA_E_MEMORY;
  if (argv != NULL && scripts != NULL) {
    char program[] = "gnuplot", defaults[] = "-d", execute[] = "-e";
    size_t n = 4;
    argv[0] = program;
    argv[1] = defaults; // without the user's start-up files
    argv[2] = execute;
    argv[3] = folder;
    for (size_t i = first; i < count; i += stride) {
      snprintf(scripts + SCRIPT_MAX * i, SCRIPT_MAX, "%s.gp", names[i]);
      argv[n++] = scripts + SCRIPT_MAX * i;
    }
    status = launch(ctx, argv, directory, out);
  }
  dea_free(ctx, scripts);
  dea_free(ctx, argv);
  return status;
}

static dea_status draw(struct dea_context *ctx, const char *directory, const char *drawing,
                       const char *const names[], size_t count)
{
  struct dea_text folder = {.ctx = ctx};
  struct drawer drawers[DRAWERS_MAX];
  size_t wanted = drawer_count(count), running = 0;
  dea_text_add(&folder, "dea_folder = \"%s/\"", dea_path_name(drawing));
  dea_status status = folder.failed ? DEA_E_MEMORY : DEA_OK;
  while (status == DEA_OK && running < wanted) {
    status =
        launch_some(ctx, directory, folder.data, names, count, running, wanted, &drawers[running]);
    running += status == DEA_OK;
  }
  for (size_t i = 0; i < running; i++) { // all of them, also after a failure
    dea_status one = finish(ctx, &drawers[i], directory);
    status = status == DEA_OK ? one : status;
  }
  dea_text_free(&folder);
  return status;
}

dea_status dea_gnuplot_draw(struct dea_context *ctx, const char *directory,
                            const char *const names[], size_t count)
{
  if (count == 0) {
    return DEA_OK;
  }
  char name[40];
  snprintf(name, sizeof name, ".drawing.%ld", (long)getpid());
  char *drawing = dea_path_join(ctx, directory, name);
  if (drawing == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = dea_folder_make(ctx, drawing);
  if (status == DEA_OK) {
    status = draw(ctx, directory, drawing, names, count);
    if (status == DEA_OK) {
      status = empty_folder(ctx, drawing, directory, true);
    } else {
      empty_folder(ctx, drawing, directory, false);
    }
  }
  dea_free(ctx, drawing);
  return status;
}
