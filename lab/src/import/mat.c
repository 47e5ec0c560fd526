#define _POSIX_C_SOURCE 200809L // unlink
#include "import/mat.h"

#include "base/module.h"
#include "base/write_file.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

static const char module_file[] = "dea_matio_module.so";

enum { NAME_MAX_LENGTH = 63 };

bool dea_mat_find(char *out, size_t size)
{
  return dea_module_find(module_file, out, size);
}

static dea_status open_module(struct dea_context *ctx, const struct dea_mat_type **out)
{
  const void *type = NULL;
  DEA_TRY(ctx, dea_module_open(ctx, module_file, "dea_matio_module", "what reads .mat files",
                               "it is built when libmatio-dev is installed", &type));
  *out = type;
  return DEA_OK;
}

/* MATLAB's rule for names. */
static bool is_name(const char *name)
{
  size_t n = 0;
  while (n <= NAME_MAX_LENGTH && (isalnum((unsigned char)name[n]) || (n > 0 && name[n] == '_'))) {
    n++;
  }
  return n > 0 && n <= NAME_MAX_LENGTH && name[n] == '\0' && isalpha((unsigned char)name[0]);
}

static dea_status check_variable(struct dea_context *ctx, const struct dea_mat_variable *variable,
                                 enum dea_mat_version version)
{
  // of version 5: 31 bits for the length of a variable with its header
  const size_t most = (INT32_MAX - 1024) / sizeof(double);
  if (!is_name(variable->name)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "'%.80s' cannot be a variable's name in MATLAB: letters, digits and '_', at "
                    "most %d of them, a letter first",
                    variable->name, (int)NAME_MAX_LENGTH);
  }
  size_t count = variable->text != NULL ? strlen(variable->text) : variable->count;
  if (version == DEA_MAT_5 && count > most) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the variable '%s' has %zu values, more than the %zu that version 5 of .mat "
                    "files can hold; write version 7.3",
                    variable->name, count, most);
  }
  return DEA_OK;
}

dea_status dea_mat_write(struct dea_context *ctx, const char *file,
                         const struct dea_mat_variable *variables, size_t count,
                         enum dea_mat_version version)
{
  const struct dea_mat_type *type = NULL;
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, check_variable(ctx, &variables[i], version));
  }
  DEA_TRY(ctx, open_module(ctx, &type));
  char *partial = dea_partial_name(ctx, file);
  DEA_TRY_MEMORY(partial != NULL);
  unlink(partial); // left by a process of the same number that was killed
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): open_module sets it or fails
  dea_status status = type->write(ctx, partial, variables, count, version);
  if (status == DEA_OK) {
    status = dea_partial_finish(ctx, partial, file);
  } else {
    unlink(partial);
  }
  dea_free(ctx, partial);
  return status;
}

dea_status dea_mat_read(struct dea_context *ctx, const char *file, struct dea_table *out)
{
  const struct dea_mat_type *type = NULL;
  DEA_TRY(ctx, open_module(ctx, &type));
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): open_module sets it or fails
  return type->read(ctx, file, out);
}
