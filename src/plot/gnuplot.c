/* Drawing by a gnuplot process. */
#define _POSIX_C_SOURCE 200809L // sysconf, getpid
#include "plot/plot.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/program.h"
#include "base/write_file.h"
#include "plot/finish.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { DRAWERS_MAX = 4, SCRIPT_MAX = 80 };

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

/* Moves a picture into the folder of the figures. */
static dea_status move(struct dea_context *ctx, void *user, const char *name, const char *path)
{
  const struct dea_plot_folder *f = user;
  char target[DEA_PATH_SIZE];
  if (name[0] == '.') {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_path_build(ctx, f->path, name, target));
  DEA_TRY(ctx, dea_path_check_target(ctx, target));
  return rename(path, target) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", target, strerror(errno));
}

/* Starts a gnuplot for the figures first, first + stride, ... */
static dea_status launch(const struct dea_plot_folder *f, char *folder, size_t first, size_t stride,
                         struct dea_program *out)
{
  // without the user's start-up files
  char program[] = "gnuplot", defaults[] = "-d", execute[] = "-e";
  struct dea_arena memory = {.ctx = f->ctx};
  char **argv = dea_arena_alloc(&memory, f->count + 5, sizeof *argv);
  char *scripts = dea_arena_alloc(&memory, f->count, SCRIPT_MAX);
  int reason = ENOMEM;
  if (!memory.failed) {
    char *const start[] = {program, defaults, execute, folder};
    size_t n = sizeof start / sizeof start[0];
    memcpy(argv, start, sizeof start);
    for (size_t i = first; i < f->count; i += stride, n++) {
      argv[n] = scripts + SCRIPT_MAX * i;
      snprintf(argv[n], SCRIPT_MAX, "%s.gp", f->names[i]);
    }
    reason = dea_program_start(argv, f->path, false, out);
  }
  const dea_status status = dea_arena_status(&memory);
  dea_arena_free(&memory);
  if (status != DEA_OK || reason == 0) {
    return status;
  }
  return reason == ENOENT
             ? dea_fail(f->ctx, DEA_E_TOOL,
                        "gnuplot is not installed (on Debian: apt install gnuplot-nox); the "
                        "scripts and data of the figures are in %s and can be drawn later",
                        f->path)
             : dea_fail(f->ctx, DEA_E_TOOL, "gnuplot cannot be started: %s", strerror(reason));
}

static dea_status draw(const struct dea_plot_folder *f, const char *drawing)
{
  struct dea_text folder = {.ctx = f->ctx};
  struct dea_program drawers[DRAWERS_MAX];
  size_t wanted = drawer_count(f->count), running = 0;
  dea_text_add(&folder, "dea_folder = \"%s/\"", dea_path_name(drawing));
  dea_status status = folder.failed ? DEA_E_MEMORY : DEA_OK;
  while (status == DEA_OK && running < wanted) {
    status = launch(f, folder.data, running, wanted, &drawers[running]);
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
static dea_status draw_all(struct dea_plot_folder *f)
{
  char name[40], drawing[DEA_PATH_SIZE];
  snprintf(name, sizeof name, ".drawing.%ld", (long)getpid());
  DEA_TRY(f->ctx, dea_path_build(f->ctx, f->path, name, drawing));
  DEA_TRY(f->ctx, dea_folder_create(f->ctx, drawing));
  dea_status status = draw(f, drawing);
  for (size_t i = 0; i < f->count && status == DEA_OK; i++) {
    status = dea_picture_finish(f->ctx, drawing, f->path, f->names[i], f->format);
  }
  status = status == DEA_OK ? dea_folder_visit(f->ctx, drawing, move, f) : status;
  dea_folder_remove_temporary(drawing);
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
