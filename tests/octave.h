/* Runs Octave in the folder of own_folder.h. */
#pragma once

#include "own_folder.h"
#include "testing.h"

#include <string.h>

/* Runs commands, without double quotes and dollars in them; the test fails when Octave does. */
static inline void octave(const char *commands)
{
  char line[4096], said[2048];
  snprintf(line, sizeof line,
           "cd '%s' && octave-cli --no-init-file --eval \"%s; disp('all good')\" 2>&1", folder,
           commands);
  FILE *pipe = popen(line, "r");
  assert_non_null(pipe);
  size_t n = fread(said, 1, sizeof said - 1, pipe);
  said[n] = '\0';
  int code = pclose(pipe);
  if (code != 0 || strstr(said, "all good") == NULL) {
    fail_msg("octave-cli (packages.txt): %s", said);
  }
}

/* Numbers that Octave wrote raw; returns how many. */
static inline size_t read_raw(const char *name, double *values, size_t capacity)
{
  FILE *file = fopen(in_folder(name), "rb");
  assert_non_null(file);
  size_t n = fread(values, sizeof *values, capacity, file);
  fclose(file);
  return n;
}
