#define _GNU_SOURCE // O_NOFOLLOW, O_PATH
#include "studio/studio_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAME_MAX_LENGTH = 200, FILES_MAX = 2000 };

/* One part of a path [length]. */
static bool part_good(const char *part, size_t length)
{
  if (length == 0 || length > NAME_MAX_LENGTH || part[0] == '.') {
    return false;
  }
  for (size_t i = 0; i < length; i++) {
    if ((unsigned char)part[i] < 0x20 || part[i] == 0x7f || part[i] == '\\') {
      return false;
    }
  }
  return true;
}

bool dea_studio_name_good(const char *name, bool deep)
{
  for (;;) {
    const size_t length = strcspn(name, "/");
    if (!part_good(name, length)) {
      return false;
    }
    if (name[length] == '\0') {
      return true;
    }
    if (!deep) {
      return false;
    }
    name += length + 1;
  }
}

/* Opens a regular file to read, or a folder; -1 where there is none. */
static int open_in(int folder, const char *name, bool directory)
{
  char part[NAME_MAX_LENGTH + 1];
  int at = dea_studio_name_good(name, true) ? fcntl(folder, F_DUPFD_CLOEXEC, 0) : -1;
  while (at >= 0 && *name != '\0') { // one after the other, so that none is a link
    const size_t length = strcspn(name, "/");
    const bool last = name[length] == '\0';
    memcpy(part, name, length);
    part[length] = '\0';
    const int below = openat(at, part,
                             O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK |
                                 (last && !directory ? 0 : O_DIRECTORY));
    close(at);
    at = below;
    name += length + (last ? 0 : 1);
  }
  struct stat file;
  if (at >= 0 && !directory && (fstat(at, &file) != 0 || !S_ISREG(file.st_mode))) {
    close(at);
    at = -1;
  }
  return at;
}

dea_status dea_studio_read(struct dea_context *ctx, int folder, const char *name, size_t max,
                           struct dea_text *out)
{
  char chunk[16384];
  const int file = open_in(folder, name, false);
  if (file < 0) {
    return dea_fail(ctx, DEA_E_IO, "there is no file %s in the folder", name);
  }
  ssize_t got;
  while ((got = read(file, chunk, sizeof chunk)) > 0 && out->length <= max) {
    dea_text_add_bytes(out, chunk, (size_t)got);
  }
  close(file);
  if (out->length > max) {
    return dea_fail(ctx, DEA_E_IO, "%s has more than %zu bytes", name, max);
  }
  dea_text_add_bytes(out, "", 0); // a text also of an empty file
  if (out->failed) {
    return dea_context_status(ctx);
  }
  return got < 0 ? dea_fail(ctx, DEA_E_IO, "cannot read %s: %s", name, strerror(errno)) : DEA_OK;
}

void dea_studio_stamp(int folder, const char *name, char out[DEA_STUDIO_STAMP])
{
  struct stat file;
  const int at = open_in(folder, name, false);
  out[0] = '\0';
  if (at >= 0 && fstat(at, &file) == 0) {
    snprintf(out, DEA_STUDIO_STAMP, "%lld.%09ld-%lld-%llx", (long long)file.st_mtim.tv_sec,
             file.st_mtim.tv_nsec, (long long)file.st_size, (unsigned long long)file.st_ino);
  }
  if (at >= 0) {
    close(at);
  }
}

static void stamp_in(int folder, const char *name, const char *file, char out[DEA_STUDIO_STAMP])
{
  char path[NAME_MAX_LENGTH + 24];
  snprintf(path, sizeof path, "%s/%s", name, file);
  dea_studio_stamp(folder, path, out);
}

/* Adds what a name of the folder is to the lists. */
static void add_entry(int folder, const char *name, json_t *lists)
{
  char stamp[DEA_STUDIO_STAMP];
  struct stat file;
  if (fstatat(folder, name, &file, AT_SYMLINK_NOFOLLOW) != 0) {
    return;
  }
  if (S_ISDIR(file.st_mode)) {
    stamp_in(folder, name, "results.h5", stamp);
    if (stamp[0] == '\0') {
      json_array_append_new(json_object_get(lists, "folders"), json_string(name));
      stamp_in(folder, name, "emulator.json", stamp);
      if (stamp[0] != '\0') {
        json_array_append_new(json_object_get(lists, "sweeps"),
                              json_pack("{s:s, s:s}", "name", name, "stamp", stamp));
      }
      return;
    }
    char report[DEA_STUDIO_STAMP], state[DEA_STUDIO_STAMP], summary[DEA_STUDIO_STAMP];
    stamp_in(folder, name, "report.html", report);
    stamp_in(folder, name, "3d_state.h5", state);
    stamp_in(folder, name, "summary.json", summary);
    json_array_append_new(json_object_get(lists, "runs"),
                          json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", name, "stamp", stamp,
                                    "report", report, "state", state, "summary", summary));
  } else if (S_ISREG(file.st_mode) &&
             (dea_text_ends_with(name, ".yaml") || dea_text_ends_with(name, ".yml"))) {
    dea_studio_stamp(folder, name, stamp);
    json_array_append_new(json_object_get(lists, "designs"),
                          json_pack("{s:s, s:s}", "name", name, "stamp", stamp));
  } else if (S_ISREG(file.st_mode) && dea_text_ends_with(name, ".csv")) {
    json_array_append_new(json_object_get(lists, "tables"), json_string(name));
  }
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
  return strcmp((*a)->d_name, (*b)->d_name);
}

static int is_shown(const struct dirent *entry)
{
  return dea_studio_name_good(entry->d_name, false);
}

/* Calls for each name of a folder that is shown, in their order. */
static void list_names(int folder, void (*add)(int folder, const char *name, json_t *to),
                       json_t *to)
{
  struct dirent **entries = NULL;
  const int count = scandirat(folder, ".", &entries, is_shown, by_name);
  for (int i = 0; i < count; i++) {
    if (i < FILES_MAX) {
      add(folder, entries[i]->d_name, to);
    }
    free(entries[i]);
  }
  free(entries);
}

json_t *dea_studio_list(int folder)
{
  json_t *lists =
      json_pack("{s:[], s:[], s:[], s:[], s:[]}", "designs", "runs", "tables", "folders", "sweeps");
  list_names(folder, add_entry, lists);
  return lists;
}

static void add_file(int folder, const char *name, json_t *names)
{
  struct stat file;
  if (fstatat(folder, name, &file, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(file.st_mode)) {
    json_array_append_new(names, json_string(name));
  }
}

json_t *dea_studio_list_in(int folder, const char *name)
{
  const int at = open_in(folder, name, true);
  if (at < 0) {
    return NULL;
  }
  json_t *names = json_array();
  list_names(at, add_file, names);
  close(at);
  return names;
}
