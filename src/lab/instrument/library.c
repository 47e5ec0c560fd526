#include "lab/instrument/library.h"

#include <dlfcn.h>
#include <string.h>

dea_status dea_library_open(struct dea_context *ctx, const char *file, const char *what,
                            const char *advice, const struct dea_library_symbol *symbols,
                            size_t count, void *table)
{
  void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s is not on this computer (%.200s): %s", what,
                    dlerror(), advice);
  }
  for (size_t i = 0; i < count; i++) {
    void *symbol = dlsym(handle, symbols[i].name);
    if (symbol == NULL) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "%s has no function %s in %.200s: %s", what,
                      symbols[i].name, file, advice);
    }
    // As bytes: C knows no conversion of a data pointer to one of a function.
    memcpy((char *)table + symbols[i].offset, &symbol, sizeof symbol);
  }
  return DEA_OK;
}
