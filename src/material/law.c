#include "material/law.h"

#include "material/law_list.h"

#include <string.h>

#define DECLARE_LAW(name) extern const struct dea_law DEA_NAME(dea_law_##name);
DEA_LAW_LIST(DECLARE_LAW)
#undef DECLARE_LAW

static const struct dea_law *const all_laws[] = {
#define LAW_ADDRESS(name) &DEA_NAME(dea_law_##name),
    DEA_LAW_LIST(LAW_ADDRESS)
#undef LAW_ADDRESS
};

enum { LAW_COUNT = sizeof all_laws / sizeof all_laws[0] };

const struct dea_law *const *DEA_NAME(dea_law_all)(size_t *count)
{
  *count = LAW_COUNT;
  return all_laws;
}

const struct dea_law *DEA_NAME(dea_law_find)(const char *name)
{
  for (size_t i = 0; i < LAW_COUNT; i++) {
    if (strcmp(all_laws[i]->name, name) == 0) {
      return all_laws[i];
    }
  }
  return NULL;
}
