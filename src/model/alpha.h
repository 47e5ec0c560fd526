/* Weights of generalised-alpha (Chung, Hulbert 1993; docs/theory/time.md, section 3). */
#pragma once

/* Symbol   meaning                                                             unit
 * m, f     a_m and a_f: shares of the begin in accelerations and in forces     1 */
struct dea_alpha {
  double m, f, beta, gamma;
};

/* By the spectral radius, 0 to 1: what a step leaves of a motion too fast for it. */
struct dea_alpha dea_alpha_of(double spectral_radius);
