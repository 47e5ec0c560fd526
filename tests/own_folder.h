/* A context and a folder of its own for a program of tests. */
#pragma once

#include "base/context.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static struct dea_context *ctx;
static char folder[512], path[700];

static inline int set_up(void **state)
{
  (void)state;
  char here[400];
  if (getcwd(here, sizeof here) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
    return -1;
  }
  snprintf(folder, sizeof folder, "%s/dea-fields-XXXXXX", here);
  return mkdtemp(folder) != NULL ? 0 : -1;
}

static inline int tear_down(void **state)
{
  (void)state;
  char command[700];
  dea_context_destroy(ctx);
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

static inline const char *in_folder(const char *name)
{
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static inline bool there(const char *name)
{
  struct stat info;
  return stat(in_folder(name), &info) == 0;
}

static inline size_t size_of(const char *name)
{
  struct stat info;
  return stat(in_folder(name), &info) == 0 ? (size_t)info.st_size : 0;
}
