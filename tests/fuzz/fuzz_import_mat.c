/* Fuzz target: the importer of .mat files, which reads from a file, by the module with libmatio. */
#define _GNU_SOURCE // memfd_create
#include "fuzz_import.h"

#include "import/mat.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  static char name[64];
  static int file = -1;
  if (file < 0) {
    char module[4096];
    if (!dea_mat_find(module, sizeof module)) {
      fprintf(stderr, "what reads .mat files was not built: nothing would be tried\n");
      exit(1);
    }
    file = memfd_create("fuzz.mat", 0);
    snprintf(name, sizeof name, "/proc/self/fd/%d", file);
  }
  if (ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size) {
    fuzz_table(ctx, "mat", name, NULL, 0);
  }
  return 0;
}
