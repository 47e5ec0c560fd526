#include "result/provenance.h"

#include "base/clock.h"
#include "base/text.h"
#include "base/version.h"

#include <hdf5.h>
#include <jansson.h>
#include <lapacke.h>
#include <sha256.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

void dea_sha256_hex(const void *bytes, size_t length, char out[65])
{
  SHA256_CTX hash;
  SHA256_Init(&hash);
  SHA256_Update(&hash, bytes, length);
  SHA256_End(&hash, out);
}

void dea_sha256_file(const char *path, char out[65])
{
  if (SHA256File(path, out) == NULL) {
    out[0] = '\0';
  }
}

void dea_libraries_text(char *out, size_t size)
{
  int major = 0, minor = 0, patch = 0;
  yaml_get_version(&major, &minor, &patch);
  unsigned h5_major = 0, h5_minor = 0, h5_release = 0;
  H5get_libversion(&h5_major, &h5_minor, &h5_release);
  lapack_int la_major = 0, la_minor = 0, la_patch = 0;
  LAPACKE_ilaver(&la_major, &la_minor, &la_patch);
  snprintf(out, size, "libyaml %d.%d.%d, jansson %s, HDF5 %u.%u.%u, LAPACK %d.%d.%d", major, minor,
           patch, jansson_version_str(), h5_major, h5_minor, h5_release, (int)la_major,
           (int)la_minor, (int)la_patch);
}

dea_status dea_provenance_fill(struct dea_context *ctx, const char *input, size_t input_length,
                               const struct dea_override *overrides, size_t override_count,
                               const char *command, struct dea_provenance *provenance)
{
  struct dea_provenance p = {.wall_s = 0.0};
  snprintf(p.program, sizeof p.program, "dea %s", DEA_VERSION);
  snprintf(p.compiler, sizeof p.compiler, "%s", DEA_COMPILER);
  snprintf(p.build, sizeof p.build, "%s", DEA_BUILD_TYPE);
  dea_libraries_text(p.libraries, sizeof p.libraries);
  dea_clock_stamp(p.started);
  dea_sha256_hex(input, input_length, p.input_sha256);
  struct dea_text text = {.ctx = ctx};
  for (size_t i = 0; i < override_count; i++) {
    dea_text_add(&text, "%s=%s\n", overrides[i].key, overrides[i].value);
  }
  p.overrides = text.data;
  p.input = dea_copy_text(ctx, input, input_length);
  p.command = command != NULL ? dea_copy_text(ctx, command, SIZE_MAX) : NULL;
  if (text.failed || p.input == NULL || (command != NULL && p.command == NULL)) {
    dea_free(ctx, p.overrides);
    dea_free(ctx, p.input);
    dea_free(ctx, p.command);
    return DEA_E_MEMORY;
  }
  dea_free(ctx, provenance->overrides);
  dea_free(ctx, provenance->input);
  dea_free(ctx, provenance->command);
  *provenance = p;
  return DEA_OK;
}

void dea_provenance_add_libraries(const char *libraries, struct dea_provenance *provenance)
{
  char *all = provenance->libraries;
  size_t length = strlen(all), capacity = sizeof provenance->libraries - length;
  if (strstr(all, libraries) == NULL) {
    snprintf(all + length, capacity, "%s%s", length > 0 ? ", " : "", libraries);
  }
}
