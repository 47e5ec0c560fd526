/* Fuzz target: the folder of a reduced measurement. The first byte says which of its files the rest
 * is; the others are good. */
#define _GNU_SOURCE // mkdtemp
#include "fuzz.h"

#include "compare/measured.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char folder[] = "/tmp/fuzz-measured-XXXXXX";
static const char *const names[] = {"measurement.csv", "profiles.csv", "history.csv"};

static void in_folder(int file, char path[80])
{
  snprintf(path, 80, "%s/%s", folder, names[file]);
}

static void remove_folder(void)
{
  char path[80];
  for (int i = 0; i < 3; i++) {
    in_folder(i, path);
    remove(path);
  }
  rmdir(folder);
}

static void put(int file, const void *bytes, size_t size)
{
  char path[80];
  in_folder(file, path);
  FILE *out = fopen(path, "wb");
  if (out == NULL || fwrite(bytes, 1, size, out) != size || fclose(out) != 0) {
    abort();
  }
}

/* One context for all inputs: reading the unit table takes longer than reading a file. */
static struct dea_context *context(void)
{
  static struct dea_context *ctx;
  if (ctx == NULL) {
    if (mkdtemp(folder) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
      abort();
    }
    atexit(remove_folder);
  }
  return ctx;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static const char good[] = "V (kV),z centre (um)\n1,2\n";
  struct dea_context *ctx = context();
  struct dea_measured *measured;
  char path[80];
  if (size == 0) {
    return 0;
  }
  int file = data[0] % 3;
  for (int i = 1; i < 3; i++) {
    in_folder(i, path);
    remove(path);
  }
  put(0, good, sizeof good - 1);
  put(file, data + 1, size - 1);
  dea_status status = dea_measured_read(ctx, folder, &measured);
  fuzz_check_message(ctx, status);
  size_t rows = 0;
  for (size_t i = 0; status == DEA_OK && i < measured->profile_count; i++) {
    rows += measured->profiles[i].z.count;
  }
  if (status == DEA_OK && rows != measured->profile_rows.rows) {
    __builtin_trap(); // a row in no profile, or in two
  }
  dea_measured_destroy(ctx, measured);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
