#define _POSIX_C_SOURCE 200809L // access
#include "base/module.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

bool dea_module_find(const char *file, char *out, size_t size)
{
  const char *const folders[] = {getenv("DEA_MODULES"), DEA_INSTALL_MODULE_DIR,
                                 DEA_BUILD_MODULE_DIR};
  for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
    if (folders[i] != NULL && folders[i][0] != '\0') {
      snprintf(out, size, "%s/%s", folders[i], file);
      if (access(out, R_OK) == 0) {
        return true;
      }
    }
  }
  return false;
}

dea_status dea_module_open(struct dea_context *ctx, const char *file, const char *symbol,
                           const char *what, const char *advice, const void **out)
{
  char path[4096];
  *out = NULL;
  if (!dea_module_find(file, path, sizeof path)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "%s is not here: %s; DEA_MODULES may name the folder of %s", what, advice,
                    file);
  }
  // it stays open; what it needs itself is found here (-z now), what its libraries need when called
  void *handle = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
  *out = handle != NULL ? dlsym(handle, symbol) : NULL;
  if (*out == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s cannot be loaded: %.300s", what, dlerror());
  }
  return DEA_OK;
}
