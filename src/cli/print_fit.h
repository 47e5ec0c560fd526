/* What `dea fit` prints. */
#pragma once

#include "identify/breakdown_fit.h"
#include "identify/device_fit.h"
#include "identify/life_fit.h"

void cli_print_fit(const struct dea_fit *fit);
void cli_print_device_fit(const struct dea_device_fit *fit);

/* Weibull's law of breakdown. */
void cli_print_breakdown_fit(const struct dea_breakdown_fit *fit);

/* Lives of specimens, and Weibull's law of them. */
void cli_print_life_fit(const struct dea_life_fit *fit);
