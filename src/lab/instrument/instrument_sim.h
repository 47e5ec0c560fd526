/* The simulated bench, for tests: what is true. */
#ifndef DEA_LAB_INSTRUMENT_INSTRUMENT_SIM_H
#define DEA_LAB_INSTRUMENT_INSTRUMENT_SIM_H

#include "lab/instrument/instrument.h"
#include "lab/instrument/sim_bench.h"

/* Plays the protocol's sequence, from sample 0 at time 0 on, to an opened bench that nothing was
 * played to, and gives the truth at times that rise: at the last sample not after each. states:
 * [count]. */
dea_status dea_sim_truth(struct dea_context *ctx, struct dea_instrument *instrument,
                         const struct dea_protocol *protocol, const double *time_s, size_t count,
                         struct dea_sim_state *states);

#endif
