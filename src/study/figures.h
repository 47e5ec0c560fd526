/* The figures of all studies: what output draws, and all that it knows of studies. */
#pragma once

#include "result/figure.h"

/* The i-th figure of all studies, in their order; NULL beyond the last. Static storage. */
const struct dea_figure *dea_study_figure(size_t i);
