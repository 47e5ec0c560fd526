#define _DEFAULT_SOURCE // flock, pread, pwrite, fsync
#include "drive/supply.h"

#include "base/clock.h"
#include "base/write_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

static const double poll_s = 0.01;

static dea_status cannot(struct dea_context *ctx, const char *what, const struct dea_supply *supply)
{
  return dea_fail(ctx, DEA_E_IO,
                  "cannot %s %s, which says whether the supply was left at 0 V: %s; set "
                  "XDG_STATE_HOME to a folder of yours",
                  what, supply->path, strerror(errno));
}

/* Brings a new name to the disk, with all folders that may be new. */
static void sync_name(const struct dea_supply *supply)
{
  char name[sizeof supply->path], *slash;
  memcpy(name, supply->path, sizeof name);
  do {
    dea_folder_sync(name);
    slash = strrchr(name, '/');
    if (slash != NULL) {
      *slash = '\0';
    }
  } while (slash != NULL && name[0] != '\0');
}

/* Opens both files, and locks nothing. folder: not NULL. */
static dea_status open_files(struct dea_context *ctx, const char *folder, const char *address,
                             struct dea_supply *out)
{
  char ask[sizeof out->path + 8];
  int length = snprintf(out->path, sizeof out->path, "%s/%s", folder, address);
  if (length < 0 || (size_t)length >= sizeof out->path) {
    errno = ENAMETOOLONG;
    return cannot(ctx, "open", out);
  }
  for (char *c = out->path + strlen(folder) + 1; *c != '\0'; c++) {
    *c = isalnum((unsigned char)*c) || *c == '.' ? *c : '-';
  }
  DEA_TRY(ctx, dea_folder_create(ctx, folder));
  snprintf(ask, sizeof ask, "%s.asked", out->path);
  bool is_new = !dea_path_exists(out->path);
  out->file = open(out->path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  out->ask = out->file < 0 ? -1 : open(ask, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (out->ask < 0) {
    dea_status status = cannot(ctx, "open", out);
    dea_supply_close(out);
    return status;
  }
  if (is_new) {
    sync_name(out);
  }
  return DEA_OK;
}

static void read_left(struct dea_supply *supply)
{
  char text[DEA_SUPPLY_LEFT_SIZE + DEA_INSTRUMENT_MARK_SIZE + DEA_INSTRUMENT_HOST_SIZE];
  ssize_t got = pread(supply->file, text, sizeof text - 1, 0);
  text[got > 0 ? got : 0] = '\0';
  const char *second = text + strcspn(text, "\n");
  snprintf(supply->left, sizeof supply->left, "%.*s", (int)(second - text), text);
  if (got < 0) { // which does not say that nothing was left
    snprintf(supply->left, sizeof supply->left, "its file cannot be read: %s", strerror(errno));
  }
  second += *second != '\0';
  const char *third = second + strcspn(second, "\n");
  snprintf(supply->mark, sizeof supply->mark, "%.*s", (int)(third - second), second);
  third += *third != '\0';
  snprintf(supply->host, sizeof supply->host, "%.*s", (int)strcspn(third, "\n"), third);
}

/* Tries until the time is over. */
static bool lock(int file, double until_s)
{
  while (flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (dea_clock_s() >= until_s) {
      return false;
    }
    dea_clock_wait(poll_s);
  }
  return true;
}

static dea_status is_driven(struct dea_context *ctx, const char *address,
                            const struct dea_supply *supply)
{
  return dea_fail(ctx, DEA_E_INTERLOCK, "another program drives this supply (%s): %s", address,
                  supply->left[0] != '\0' ? supply->left : "it has just begun");
}

dea_status dea_supply_open(struct dea_context *ctx, const char *folder, const char *address,
                           struct dea_supply *out)
{
  *out = (struct dea_supply){.file = -1, .ask = -1};
  if (folder == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, open_files(ctx, folder, address, out));
  bool locked = lock(out->file, 0);
  read_left(out);
  if (!locked) {
    dea_supply_close(out);
    return is_driven(ctx, address, out);
  }
  return DEA_OK;
}

dea_status dea_supply_request(struct dea_context *ctx, const char *folder, const char *address,
                              double wait_s, struct dea_supply *out)
{
  double until_s = dea_clock_s() + wait_s;
  *out = (struct dea_supply){.file = -1, .ask = -1};
  if (folder == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, open_files(ctx, folder, address, out));
  bool locked = lock(out->ask, until_s) && lock(out->file, until_s);
  read_left(out);
  if (!locked) {
    close(out->file); // which nobody may write but who has it
    out->file = -1;
    return is_driven(ctx, address, out);
  }
  return DEA_OK;
}

bool dea_supply_is_asked(const struct dea_supply *supply)
{
  if (supply->ask < 0) {
    return false;
  }
  if (flock(supply->ask, LOCK_SH | LOCK_NB) != 0) {
    return errno == EWOULDBLOCK;
  }
  flock(supply->ask, LOCK_UN);
  return false;
}

bool dea_supply_release(struct dea_supply *supply, double within_s)
{
  double until_s = dea_clock_s() + within_s;
  flock(supply->file, LOCK_UN);
  while (dea_supply_is_asked(supply) && dea_clock_s() < until_s) {
    dea_clock_wait(poll_s);
  }
  if (!lock(supply->file, until_s)) {
    return false;
  }
  read_left(supply);
  return true;
}

dea_status dea_supply_leave(struct dea_context *ctx, struct dea_supply *supply, const char *text)
{
  char line[DEA_SUPPLY_LEFT_SIZE + DEA_INSTRUMENT_MARK_SIZE + DEA_INSTRUMENT_HOST_SIZE];
  char stamp[DEA_STAMP_SIZE];
  if (supply->file < 0) {
    return DEA_OK;
  }
  bool more = supply->mark[0] != '\0' || supply->host[0] != '\0';
  int length =
      snprintf(line, sizeof line, "%.180s (%s)\n%s%s%s%s", text, dea_clock_stamp(stamp),
               supply->mark, more ? "\n" : "", supply->host, supply->host[0] != '\0' ? "\n" : "");
  length = text[0] != '\0' ? length : 0;
  // over what stood there, which stays on a disk that is full: an empty file would say "at 0 V"
  if (pwrite(supply->file, line, (size_t)length, 0) != (ssize_t)length ||
      ftruncate(supply->file, length) != 0 || fsync(supply->file) != 0) {
    return cannot(ctx, "write", supply);
  }
  return DEA_OK;
}

void dea_supply_close(struct dea_supply *supply)
{
  if (supply->file >= 0) {
    close(supply->file);
  }
  if (supply->ask >= 0) {
    close(supply->ask);
  }
  supply->file = supply->ask = -1;
}
