/* All kinds of waveforms, in the order in which they are offered. A new one is a file and a line
 * here. */
// X(name): wave_<name>.c with `const struct dea_wave_type dea_wave_<name>` and its table
// `const struct dea_record dea_wave_<name>_record`.
#define DEA_WAVE_LIST(X)                                                                           \
  X(constant)                                                                                      \
  X(step)                                                                                          \
  X(ramp)                                                                                          \
  X(square)                                                                                        \
  X(sine)                                                                                          \
  X(triangle)                                                                                      \
  X(chirp)                                                                                         \
  X(burst)                                                                                         \
  X(staircase)                                                                                     \
  X(table)
