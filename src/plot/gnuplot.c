/* Drawing by a gnuplot process. */
#define _POSIX_C_SOURCE 200809L // unlinkat, renameat, dirfd
#include "plot/plot.h"

#include "base/file.h"
#include "base/program.h"
#include "base/write_file.h"
#include "plot/finish.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { DRAWERS_MAX = 4, SCRIPT_MAX = 80 };

static dea_status launch(struct dea_context *ctx, char *const argv[], const char *directory,
                         struct dea_program *out)
{
  int reason = dea_program_start(argv, directory, false, out);
  if (reason == ENOENT) {
    return dea_fail(ctx, DEA_E_TOOL,
                    "gnuplot is not installed (on Debian: apt install gnuplot-nox); the scripts "
                    "and data of the figures are in %s and can be drawn later",
                    directory);
  }
  if (reason != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "gnuplot cannot be started: %s", strerror(reason));
  }
  return DEA_OK;
}

/* Waits for its end; also after an interruption, so that figures of what there is are drawn. */
static dea_status finish(struct dea_context *ctx, const struct dea_program *drawer,
                         const char *directory)
{
  char said[DEA_PROGRAM_SAID];
  int number;
  if (dea_program_wait(NULL, drawer, INFINITY, said, &number) == DEA_PROGRAM_DONE) {
    return DEA_OK;
  }
  if (dea_interrupted(ctx)) {
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while drawing");
  }
  const char *last = dea_last_lines(said, 1); // says what is wrong
  return dea_fail(ctx, DEA_E_TOOL, "gnuplot failed in %s: %s", directory, last + strspn(last, " "));
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
    } else if (dea_path_check_target(ctx, path) != DEA_OK) {
      status = dea_context_status(ctx);
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
static dea_status launch_some(const struct dea_plot_folder *f, char *folder, size_t first,
                              size_t stride, struct dea_program *out)
{
  char **argv = dea_alloc(f->ctx, f->count + 5, sizeof *argv);
  char *scripts = dea_alloc(f->ctx, f->count, SCRIPT_MAX);
  dea_status status = DEA_E_MEMORY;
  if (argv != NULL && scripts != NULL) {
    char program[] = "gnuplot", defaults[] = "-d", execute[] = "-e";
    size_t n = 4;
    argv[0] = program;
    argv[1] = defaults; // without the user's start-up files
    argv[2] = execute;
    argv[3] = folder;
    for (size_t i = first; i < f->count; i += stride) {
      snprintf(scripts + SCRIPT_MAX * i, SCRIPT_MAX, "%s.gp", f->names[i]);
      argv[n++] = scripts + SCRIPT_MAX * i;
    }
    status = launch(f->ctx, argv, f->path, out);
  }
  dea_free(f->ctx, scripts);
  dea_free(f->ctx, argv);
  return status;
}

static dea_status draw(const struct dea_plot_folder *f, const char *drawing)
{
  struct dea_text folder = {.ctx = f->ctx};
  struct dea_program drawers[DRAWERS_MAX];
  size_t wanted = drawer_count(f->count), running = 0;
  dea_text_add(&folder, "dea_folder = \"%s/\"", dea_path_name(drawing));
  dea_status status = folder.failed ? DEA_E_MEMORY : DEA_OK;
  while (status == DEA_OK && running < wanted) {
    status = launch_some(f, folder.data, running, wanted, &drawers[running]);
    running += status == DEA_OK;
  }
  for (size_t i = 0; i < running; i++) { // all of them, also after a failure
    dea_status one = finish(f->ctx, &drawers[i], f->path);
    status = status == DEA_OK ? one : status;
  }
  dea_text_free(&folder);
  return status;
}

/* The pictures take their names only when they are complete. */
static dea_status draw_all(const struct dea_plot_folder *f)
{
  char name[40];
  snprintf(name, sizeof name, ".drawing.%ld", (long)getpid());
  char *drawing = dea_path_join(f->ctx, f->path, name);
  DEA_TRY_MEMORY(drawing != NULL);
  dea_status status = dea_folder_create(f->ctx, drawing);
  if (status == DEA_OK) {
    status = draw(f, drawing);
    for (size_t i = 0; i < f->count && status == DEA_OK; i++) {
      status = dea_picture_finish(f->ctx, drawing, f->path, f->names[i], f->format);
    }
    if (status == DEA_OK) {
      status = empty_folder(f->ctx, drawing, f->path, true);
    } else {
      empty_folder(f->ctx, drawing, f->path, false);
    }
  }
  dea_free(f->ctx, drawing);
  return status;
}

dea_status dea_plot_folder_name(struct dea_plot_folder *folder, const char *name)
{
  char(*names)[sizeof *folder->names] =
      dea_resize(folder->ctx, folder->names, folder->count + 1, sizeof *names);
  DEA_TRY_MEMORY(names != NULL);
  folder->names = names;
  snprintf(names[folder->count++], sizeof *names, "%s", name);
  return DEA_OK;
}

dea_status dea_plot_folder_add(struct dea_plot_folder *folder, struct dea_plot *plot,
                               dea_status status)
{
  if (status == DEA_OK && dea_plot_shows(plot)) {
    status = dea_plot_write(folder->ctx, plot, folder->format, folder->path);
    status = status == DEA_OK ? dea_plot_folder_name(folder, plot->name) : status;
  }
  dea_plot_destroy(folder->ctx, plot);
  return status;
}

dea_status dea_plot_folder_draw(struct dea_plot_folder *folder, dea_status status)
{
  const struct dea_plot_format *format = folder->format;
  if (status == DEA_OK && folder->count > 0 && (format->svg || format->pdf || format->png)) {
    status = draw_all(folder);
  }
  dea_free(folder->ctx, folder->names);
  folder->names = NULL;
  folder->count = 0;
  return status;
}

dea_status dea_gnuplot_create_folders(struct dea_context *ctx, const char *directory,
                                      const char *name, bool force)
{
  static const char *const outcomes[] = {"", ".gp", ".dat", ".svg", ".pdf", ".png"};
  for (size_t i = 0; i < sizeof outcomes / sizeof outcomes[0]; i++) {
    char file[128];
    snprintf(file, sizeof file, "%.119s%s", name, outcomes[i]);
    DEA_TRY(ctx, dea_path_create_folders(ctx, directory, file, force));
  }
  return DEA_OK;
}
