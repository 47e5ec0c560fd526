#define _DEFAULT_SOURCE // flock, gethostname, pread
#include "base/folder_lock.h"

#include "base/clock.h"
#include "base/write_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

struct dea_folder_lock {
  int file;
  char path[DEA_PATH_SIZE];
};

static dea_status is_taken(struct dea_context *ctx, const char *directory, int file)
{
  char who[200];
  ssize_t got = pread(file, who, sizeof who - 1, 0);
  who[got > 0 ? got : 0] = '\0';
  who[strcspn(who, "\n")] = '\0';
  return dea_fail(ctx, DEA_E_IO,
                  "another run writes into %s%s%s%s; wait for it or take another folder", directory,
                  who[0] != '\0' ? " (" : "", who, who[0] != '\0' ? ")" : "");
}

/* Whether the open file is still the one of that name: the last holder removes it. */
static bool is_there(int file, const char *path)
{
  struct stat own, named;
  return fstat(file, &own) == 0 && stat(path, &named) == 0 && own.st_ino == named.st_ino &&
         own.st_dev == named.st_dev;
}

/* Who has it, for others; it holds without. */
static void sign(int file)
{
  char text[200], host[80] = "", stamp[DEA_STAMP_SIZE];
  gethostname(host, sizeof host - 1);
  int length = snprintf(text, sizeof text, "process %ld on %s since %s\n", (long)getpid(), host,
                        dea_clock_stamp(stamp));
  if (ftruncate(file, 0) == 0) {
    dea_write_all(file, text, (size_t)length);
  }
}

static dea_status acquire(struct dea_context *ctx, const char *directory,
                          struct dea_folder_lock *lock)
{
  for (;;) {
    lock->file = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock->file < 0) {
      return dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", lock->path, strerror(errno));
    }
    if (flock(lock->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      return is_taken(ctx, directory, lock->file);
    }
    if (is_there(lock->file, lock->path)) {
      sign(lock->file);
      return DEA_OK;
    }
    close(lock->file);
    lock->file = -1;
  }
}

static void release(struct dea_context *ctx, struct dea_folder_lock *lock)
{
  if (lock->file >= 0) {
    close(lock->file);
  }
  dea_free(ctx, lock);
}

dea_status dea_folder_lock(struct dea_context *ctx, const char *directory,
                           struct dea_folder_lock **out)
{
  *out = NULL;
  struct dea_folder_lock *lock = dea_alloc(ctx, 1, sizeof *lock);
  DEA_TRY_MEMORY(lock != NULL);
  lock->file = -1;
  dea_status status = dea_path_build(ctx, directory, DEA_FOLDER_LOCK_FILE, lock->path);
  status = status == DEA_OK ? acquire(ctx, directory, lock) : status;
  DEA_TRY_ELSE(ctx, status, release(ctx, lock));
  *out = lock;
  return DEA_OK;
}

void dea_folder_unlock(struct dea_context *ctx, struct dea_folder_lock *lock)
{
  if (lock != NULL) {
    unlink(lock->path); // while it is held
    release(ctx, lock);
  }
}
