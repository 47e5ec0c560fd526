/* A fit of a device as it was really built: keys of its design, from measured curves of the whole.
 *
 * docs/theory/fit.md says how each number is found, docs/fit.md how it is used. */
#pragma once

#include "identify/device_fit.h"

/* Reads design and measurements, which count from the fit file's folder, and fits. file: lent for
 * as long as the result; profiles: as of dea_fit_run. DEA_E_DESIGN or DEA_E_IO after findings, else
 * as models and least squares give it. fit: freed by the caller, also after a failure. */
dea_status dea_device_fit_run(struct dea_context *ctx, const struct dea_device_file *file,
                              bool profiles, struct dea_device_fit *fit);
void dea_device_fit_free(struct dea_device_fit *fit);
