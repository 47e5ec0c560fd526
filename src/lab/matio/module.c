/* What the loadable module exports, which lab/import/mat.c opens. */
#include "lab/matio/matio_module.h"

extern const struct dea_mat_type dea_matio_module;

const struct dea_mat_type dea_matio_module = {.write = dea_matio_write, .read = dea_matio_read};
