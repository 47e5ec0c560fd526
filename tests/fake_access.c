/* access() without the modules of the program, for LD_PRELOAD: as if they had not been built. */
#define _GNU_SOURCE // faccessat
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

__attribute__((visibility("default"))) int access(const char *path, int mode)
{
  if (strstr(path, "_module.so") != NULL) {
    errno = ENOENT;
    return -1;
  }
  return faccessat(AT_FDCWD, path, mode, 0);
}
