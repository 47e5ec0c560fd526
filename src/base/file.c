#define _POSIX_C_SOURCE 200809L // open, fstat
#include "base/file.h"

#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* What a path is when it is no regular file. */
static const char *kind_name(mode_t mode)
{
  if (S_ISDIR(mode)) {
    return "a directory";
  }
  if (S_ISFIFO(mode)) {
    return "a pipe";
  }
  if (S_ISSOCK(mode)) {
    return "a socket";
  }
  return "a device";
}

static dea_status too_large(struct dea_context *ctx, const char *file, size_t max)
{
  struct dea_location location = {.file = dea_intern(ctx, file)};
  DEA_TRY_MEMORY(location.file != NULL);
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location,
                               "the file is larger than %zu MB, which is too much", max / 1000000));
  return dea_fail(ctx, DEA_E_DESIGN, "'%s' is larger than %zu MB", file, max / 1000000);
}

/* Reads up to max + 1 bytes, so that a file that grew meanwhile is noticed. */
static dea_status read_all(struct dea_context *ctx, int fd, const char *file, size_t max,
                           char **bytes, size_t *length)
{
  size_t capacity = 0, used = 0;
  for (;;) {
    if (used + 1 >= capacity) {
      capacity = 2 * capacity + 16384;
      char *moved = dea_resize(ctx, *bytes, capacity, 1);
      DEA_TRY_MEMORY(moved != NULL);
      *bytes = moved;
    }
    ssize_t got = read(fd, *bytes + used, capacity - used - 1);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      return dea_fail(ctx, DEA_E_IO, "cannot read '%s': %s", file, strerror(errno));
    }
    used += (size_t)got;
    if (used > max) {
      return too_large(ctx, file, max);
    }
    if (got == 0) {
      (*bytes)[used] = '\0';
      *length = used;
      return DEA_OK;
    }
  }
}

dea_status dea_file_read(struct dea_context *ctx, const char *file, size_t max, char **bytes,
                         size_t *length)
{
  *bytes = NULL;
  *length = 0;
  // O_NONBLOCK: opening a pipe that nobody writes to must not hang.
  int fd = open(file, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) {
    return dea_fail(ctx, DEA_E_IO, "cannot open '%s': %s", file, strerror(errno));
  }
  struct stat info;
  dea_status status = DEA_OK;
  if (fstat(fd, &info) != 0) {
    status = dea_fail(ctx, DEA_E_IO, "cannot read '%s': %s", file, strerror(errno));
  } else if (!S_ISREG(info.st_mode)) {
    status = dea_fail(ctx, DEA_E_IO, "'%s' is %s, not a file", file, kind_name(info.st_mode));
  } else if (info.st_size > 0 && (size_t)info.st_size > max) {
    status = too_large(ctx, file, max);
  } else {
    status = read_all(ctx, fd, file, max, bytes, length);
  }
  close(fd);
  if (status != DEA_OK) {
    dea_free(ctx, *bytes);
    *bytes = NULL;
  }
  return status;
}

dea_status dea_path_check_target(struct dea_context *ctx, const char *path)
{
  struct stat own, target;
  if (lstat(path, &own) != 0 || stat(path, &target) != 0) {
    return DEA_OK;
  }
  bool device = S_ISLNK(own.st_mode) && strncmp(path, "/dev/", 5) == 0;
  return !device && (S_ISREG(target.st_mode) || S_ISDIR(target.st_mode))
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO, "%s is %s and is not replaced: give the name of a file",
                        path, device ? "a device" : kind_name(target.st_mode));
}

bool dea_path_is_same(const char *a, const char *b)
{
  struct stat first, second;
  return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

bool dea_file_head(const char *path, void *head, size_t size, size_t *length)
{
  struct stat info;
  int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); // a pipe would be waited for
  bool regular = fd >= 0 && fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  *length = 0;
  for (ssize_t got = 1; regular && got > 0 && *length<size; *length += got> 0 ? (size_t)got : 0) {
    got = read(fd, (char *)head + *length, size - *length);
  }
  if (fd >= 0) {
    close(fd);
  }
  return regular;
}

bool dea_head_is_h5(const void *head, size_t length)
{
  static const char signature[] = "\x89HDF\r\n\x1a\n";
  return length >= sizeof signature - 1 && memcmp(head, signature, sizeof signature - 1) == 0;
}

const char *dea_path_name(const char *path)
{
  const char *slash = strrchr(path, '/');
  return slash != NULL ? slash + 1 : path;
}

const char *dea_path_stem(const char *path, size_t *length)
{
  const char *name = dea_path_name(path), *dot = strrchr(name, '.');
  *length = dot != NULL && dot != name ? (size_t)(dot - name) : strlen(name);
  return name;
}

bool dea_path_ends_with(const char *path, const char *ending)
{
  const size_t length = strlen(path), tail = strlen(ending);
  return length >= tail && strcasecmp(path + length - tail, ending) == 0;
}

char *dea_path_beside(struct dea_context *ctx, const char *file, const char *name)
{
  struct dea_text path = {.ctx = ctx};
  dea_text_add(&path, "%.*s%s", name[0] != '/' ? (int)(dea_path_name(file) - file) : 0, file, name);
  return path.data;
}
