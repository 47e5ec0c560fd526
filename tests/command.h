/* Runs the command `dea` in a shell and reads what it says. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "testing.h"

enum { COMMAND_TEXT_MAX = 1 << 20 };

/* Folder of the test program, made by command_set_up and removed by command_tear_down. */
static char command_folder[512];
static char command_out[COMMAND_TEXT_MAX]; // standard output of the last run
static char command_err[COMMAND_TEXT_MAX]; // standard error of the last run
static const char *command_before = "";    // what stands before the command: a program that runs it

static inline int command_set_up(void **state)
{
  char here[400];
  if (getcwd(here, sizeof here) == NULL) { // where ctest runs: the build
    return -1;
  }
  snprintf(command_folder, sizeof command_folder, "%s/dea-test-XXXXXX", here);
  return mkdtemp(command_folder) != NULL ? 0 : -1;
}

static inline int command_tear_down(void **state)
{
  char text[600];
  snprintf(text, sizeof text, "rm -rf '%s'", command_folder);
  return system(text);
}

static inline void command_read_in(const char *folder, const char *name, char *out)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  size_t length = fread(out, 1, COMMAND_TEXT_MAX - 1, file);
  out[length] = '\0';
  fclose(file);
}

static inline void command_read(const char *name, char *out)
{
  command_read_in(command_folder, name, out);
}

/* Runs "dea <arguments>" in command_folder; returns its exit code. "@" stands for the source tree.
 */
static inline int command_run(const char *arguments)
{
  static char text[8192];
  size_t used = (size_t)snprintf(text, sizeof text, "cd '%s' && XDG_STATE_HOME='%s/state' %s '%s' ",
                                 command_folder, command_folder, command_before, DEA_COMMAND);
  for (const char *c = arguments; *c != '\0' && used + 600 < sizeof text; c++) {
    if (*c == '@') {
      used += (size_t)snprintf(text + used, sizeof text - used, "%s", DEA_SOURCE_DIR);
    } else {
      text[used++] = *c;
    }
  }
  snprintf(text + used, sizeof text - used, " >out.txt 2>err.txt </dev/null");
  int status = system(text);
  command_read("out.txt", command_out);
  command_read("err.txt", command_err);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/* A text holds all of these parts. */
#define assert_contains(text, ...)                                                                 \
  do {                                                                                             \
    const char *const parts_[] = {__VA_ARGS__};                                                    \
    for (size_t k_ = 0; k_ < sizeof parts_ / sizeof parts_[0]; k_++) {                             \
      if (strstr((text), parts_[k_]) == NULL) {                                                    \
        fail_msg("'%s' is not in:\n%s", parts_[k_], (text));                                       \
      }                                                                                            \
    }                                                                                              \
  } while (0)

/* An exit code and a part of what is printed are wanted: on stderr, or on stdout. */
static inline void command_says(const char *arguments, int code, const char *stream,
                                const char *message)
{
  int found = command_run(arguments);
  if (found != code || strstr(stream, message) == NULL) {
    fail_msg("dea %s: exit code %d, wanted %d with '%s':\n%s", arguments, found, code, message,
             stream);
  }
}

static inline void command_expect(const char *arguments, int code, const char *message)
{
  command_says(arguments, code, command_err, message);
}

static inline void command_prints(const char *arguments, int code, const char *message)
{
  command_says(arguments, code, command_out, message);
}

/* Writes a file into command_folder. */
static inline void command_write(const char *name, const char *text)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
  fclose(file);
}

/* Makes a folder in command_folder. */
static inline void command_folder_make(const char *name)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  assert_int_equal(mkdir(path, 0777), 0);
}
