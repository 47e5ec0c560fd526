#define _GNU_SOURCE // fileno, mkdtemp, nftw, uselocale
#include "base/write_file.h"

#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <locale.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

char *dea_path_join(struct dea_context *ctx, const char *directory, const char *name)
{
  struct dea_text text = {.ctx = ctx};
  size_t n = strlen(directory);
  dea_text_add(&text, "%s%s%s", directory, n > 0 && directory[n - 1] != '/' ? "/" : "", name);
  return text.data;
}

/* false: no file can have such a long path. */
static bool build_path(const char *directory, const char *name, char out[DEA_PATH_SIZE])
{
  const size_t n = strlen(directory);
  const char *slash = n > 0 && directory[n - 1] != '/' ? "/" : "";
  return snprintf(out, DEA_PATH_SIZE, "%s%s%s", directory, slash, name) < DEA_PATH_SIZE;
}

dea_status dea_path_build(struct dea_context *ctx, const char *directory, const char *name,
                          char out[DEA_PATH_SIZE])
{
  return build_path(directory, name, out)
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO, "the path of '%.60s' is too long", name);
}

dea_status dea_folder_create_temporary(struct dea_context *ctx, const char *word,
                                       char folder[DEA_TEMPORARY_SIZE])
{
  const char *in = getenv("TMPDIR");
  in = in != NULL && in[0] != '\0' ? in : "/tmp";
  dea_status status = DEA_OK;
  if (snprintf(folder, DEA_TEMPORARY_SIZE, "%s/dea-%s-XXXXXX", in, word) >= DEA_TEMPORARY_SIZE) {
    status = dea_fail(ctx, DEA_E_IO, "TMPDIR is too long a name");
  } else if (mkdtemp(folder) == NULL) {
    status = dea_fail(ctx, DEA_E_IO, "cannot make the folder %s: %s", folder, strerror(errno));
  }
  folder[0] = status == DEA_OK ? folder[0] : '\0'; // nothing of another is removed at the end
  return status;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at)
{
  (void)info, (void)kind, (void)at;
  (void)remove(path);
  return 0;
}

void dea_folder_remove_temporary(const char *folder)
{
  enum { FILES_OPEN = 8 };
  (void)nftw(folder, remove_entry, FILES_OPEN, FTW_DEPTH | FTW_PHYS);
}

size_t dea_path_length(const char *path)
{
  size_t length = strlen(path);
  while (length > 1 && path[length - 1] == '/') {
    length--;
  }
  return length;
}

bool dea_path_exists(const char *path)
{
  struct stat info;
  return lstat(path, &info) == 0;
}

bool dea_folder_has(const char *directory, const char *name)
{
  char path[DEA_PATH_SIZE];
  return build_path(directory, name, path) && dea_path_exists(path);
}

bool dea_path_is_folder(const char *path)
{
  struct stat info;
  return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

dea_status dea_folder_visit(struct dea_context *ctx, const char *directory,
                            dea_folder_visitor *visit, void *user)
{
  dea_status status = DEA_OK;
  DIR *folder = opendir(directory);
  for (const struct dirent *entry;
       folder != NULL && status == DEA_OK && (entry = readdir(folder)) != NULL;) {
    char path[DEA_PATH_SIZE];
    if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
      status = dea_path_build(ctx, directory, entry->d_name, path);
      status = status == DEA_OK ? visit(ctx, user, entry->d_name, path) : status;
    }
  }
  if (folder != NULL) {
    closedir(folder);
  }
  return status;
}

dea_status dea_path_refuse(struct dea_context *ctx, const char *directory, const char *name)
{
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, name, path));
  return !dea_path_exists(path)
             ? DEA_OK
             : dea_fail(ctx, DEA_E_IO,
                        "%s/%s already exists; choose another folder, or replace "
                        "what is there with --force",
                        directory, name);
}

dea_status dea_path_create_folders(struct dea_context *ctx, const char *directory, const char *name,
                                   bool force)
{
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, name, path));
  if (!dea_path_exists(path) || dea_path_is_folder(path)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, force ? dea_path_check_target(ctx, path) : dea_path_refuse(ctx, directory, name));
  unlink(path);
  return DEA_OK;
}

void dea_path_forget(struct dea_context *ctx, const char *directory, const char *name)
{
  struct stat info;
  char path[DEA_PATH_SIZE];
  if (dea_path_build(ctx, directory, name, path) == DEA_OK && lstat(path, &info) == 0 &&
      (S_ISREG(info.st_mode) || S_ISLNK(info.st_mode))) {
    unlink(path);
  }
}

static dea_status folder_make_one(struct dea_context *ctx, const char *directory)
{
  if (mkdir(directory, 0777) == 0 || (errno == EEXIST && dea_path_is_folder(directory))) {
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_IO, "cannot make the folder %s: %s", directory,
                  errno == EEXIST ? "a file has that name" : strerror(errno));
}

dea_status dea_folder_create(struct dea_context *ctx, const char *directory)
{
  if (directory[0] == '\0') {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the name of the folder is empty");
  }
  char *path = dea_copy_text(ctx, directory, SIZE_MAX);
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = DEA_OK;
  for (char *c = path + 1; *c != '\0' && status == DEA_OK; c++) {
    if (*c == '/' && c[-1] != '/') {
      *c = '\0';
      if (!dea_path_is_folder(path)) {
        status = folder_make_one(ctx, path);
      }
      *c = '/';
    }
  }
  status = status == DEA_OK ? folder_make_one(ctx, path) : status;
  dea_free(ctx, path);
  return status;
}

void dea_folder_sync(const char *path)
{
  char folder[4096];
  const char *slash = strrchr(path, '/');
  size_t length = slash == NULL ? 0 : slash == path ? 1 : (size_t)(slash - path);
  if (length >= sizeof folder) {
    return;
  }
  memcpy(folder, path, length);
  folder[length] = '\0';
  int file = open(length > 0 ? folder : ".", O_RDONLY | O_CLOEXEC | O_DIRECTORY);
  if (file >= 0) {
    (void)fsync(file);
    close(file);
  }
}

char *dea_partial_name(struct dea_context *ctx, const char *path)
{
  const char *slash = strrchr(path, '/');
  int folder = slash != NULL ? (int)(slash - path) + 1 : 0;
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text, "%.*s.%s.%ld.part", folder, path, path + folder, (long)getpid());
  return text.data;
}

dea_status dea_partial_finish(struct dea_context *ctx, const char *partial, const char *path)
{
  dea_status status = dea_path_check_target(ctx, path);
  if (status == DEA_OK && rename(partial, path) != 0) {
    status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", path, strerror(errno));
  }
  if (status != DEA_OK) {
    unlink(partial);
  }
  return status;
}

bool dea_write_all(int file, const void *bytes, size_t length)
{
  for (const char *from = bytes; length > 0;) {
    const ssize_t n = write(file, from, length);
    if (n < 0 && errno != EINTR) {
      return false;
    }
    from += n > 0 ? n : 0;
    length -= n > 0 ? (size_t)n : 0;
  }
  return true;
}

/* Writes all of a new file; errno says what went wrong. */
static bool write_new(const char *path, const char *bytes, size_t length)
{
  unlink(path); // left by a process of the same number that was killed
  int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) {
    return false;
  }
  bool good = dea_write_all(file, bytes, length);
  int reason = errno;
  if (close(file) != 0 && good) {
    return false;
  }
  errno = reason;
  return good;
}

dea_status dea_file_write(struct dea_context *ctx, const char *path, const char *bytes,
                          size_t length)
{
  char *partial = dea_partial_name(ctx, path);
  DEA_TRY_MEMORY(partial != NULL);
  dea_status status;
  if (write_new(partial, bytes, length)) {
    status = dea_partial_finish(ctx, partial, path);
  } else {
    status = dea_fail(ctx, DEA_E_IO, "cannot write %s: %s", path, strerror(errno));
    unlink(partial);
  }
  dea_free(ctx, partial);
  return status;
}

dea_status dea_file_write_into(struct dea_context *ctx, const char *directory, const char *name,
                               const char *bytes, size_t length)
{
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, name, path));
  return dea_file_write(ctx, path, bytes, length);
}

dea_status dea_text_write_path(struct dea_context *ctx, struct dea_text *text, const char *path)
{
  const dea_status status =
      text->failed ? DEA_E_MEMORY : dea_file_write(ctx, path, dea_text_get(text), text->length);
  dea_text_free(text);
  return status;
}

dea_status dea_text_write(struct dea_context *ctx, struct dea_text *text, const char *directory,
                          const char *name)
{
  const dea_status status =
      text->failed ? DEA_E_MEMORY
                   : dea_file_write_into(ctx, directory, name, dea_text_get(text), text->length);
  dea_text_free(text);
  return status;
}

dea_status dea_text_file_write(struct dea_context *ctx, const char *directory, const char *name,
                               const char *text)
{
  return dea_file_write_into(ctx, directory, name, text, strlen(text));
}

void *dea_c_locale_enter(void)
{
  locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", duplocale(uselocale((locale_t)0)));
  return c_locale != (locale_t)0 ? (void *)uselocale(c_locale) : NULL;
}

void dea_c_locale_leave(void *before)
{
  if (before != NULL) {
    freelocale(uselocale((locale_t)before));
  }
}
