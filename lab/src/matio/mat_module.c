/* What the loadable module exports, which lab/import/mat.c opens. */
#include "base/module.h"
#include "matio/matio_module.h"

extern DEA_MODULE_SYMBOL const struct dea_mat_type dea_matio_module;

const struct dea_mat_type dea_matio_module = {.write = dea_matio_write, .read = dea_matio_read};
