#define _DEFAULT_SOURCE // flock, pread, pwrite, fsync
#include "lab/drive/supply.h"

#include "base/write_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

static dea_status cannot(struct dea_context *ctx, const char *what, const struct dea_supply *supply)
{
  return dea_fail(ctx, DEA_E_IO,
                  "cannot %s %s, which says whether the supply was left at 0 V: %s; set "
                  "XDG_STATE_HOME to a folder of yours",
                  what, supply->path, strerror(errno));
}

dea_status dea_supply_open(struct dea_context *ctx, const char *folder, const char *address,
                           struct dea_supply *out)
{
  *out = (struct dea_supply){.file = -1};
  if (folder == NULL) {
    return DEA_OK;
  }
  int length = snprintf(out->path, sizeof out->path, "%s/%s", folder, address);
  if (length < 0 || (size_t)length >= sizeof out->path) {
    errno = ENAMETOOLONG;
    return cannot(ctx, "open", out);
  }
  for (char *c = out->path + strlen(folder) + 1; *c != '\0'; c++) {
    *c = isalnum((unsigned char)*c) || *c == '.' ? *c : '-';
  }
  DEA_TRY(ctx, dea_folder_make(ctx, folder));
  int file = open(out->path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) {
    return cannot(ctx, "open", out);
  }
  char text[DEA_SUPPLY_LEFT_SIZE + DEA_INSTRUMENT_MARK_SIZE];
  ssize_t got = pread(file, text, sizeof text - 1, 0);
  text[got > 0 ? got : 0] = '\0';
  const char *second = text + strcspn(text, "\n");
  snprintf(out->left, sizeof out->left, "%.*s", (int)(second - text), text);
  second += *second != '\0';
  snprintf(out->mark, sizeof out->mark, "%.*s", (int)strcspn(second, "\n"), second);
  if (flock(file, LOCK_EX | LOCK_NB) != 0) {
    close(file);
    return dea_fail(ctx, DEA_E_INTERLOCK, "another program drives this supply (%s): %s", address,
                    out->left[0] != '\0' ? out->left : "it has just begun");
  }
  out->file = file;
  return DEA_OK;
}

dea_status dea_supply_leave(struct dea_context *ctx, struct dea_supply *supply, const char *text)
{
  char line[DEA_SUPPLY_LEFT_SIZE + DEA_INSTRUMENT_MARK_SIZE], stamp[32] = "";
  time_t now = time(NULL);
  struct tm utc;
  if (supply->file < 0) {
    return DEA_OK;
  }
  if (gmtime_r(&now, &utc) != NULL) {
    strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%SZ", &utc);
  }
  int length = snprintf(line, sizeof line, "%.180s (%s)\n%s%s", text, stamp, supply->mark,
                        supply->mark[0] != '\0' ? "\n" : "");
  length = text[0] != '\0' ? length : 0;
  if (ftruncate(supply->file, 0) != 0 ||
      pwrite(supply->file, line, (size_t)length, 0) != (ssize_t)length ||
      fsync(supply->file) != 0) {
    return cannot(ctx, "write", supply);
  }
  return DEA_OK;
}

void dea_supply_close(struct dea_supply *supply)
{
  if (supply->file >= 0) {
    close(supply->file);
    supply->file = -1;
  }
}
