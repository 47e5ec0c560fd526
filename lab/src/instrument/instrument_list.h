/* All kinds of instruments, in the order in which they are offered. A new one is a file and a line
 * here. */
// X(name): instrument_<name>.c with `const struct dea_instrument_type dea_instrument_<name>` and
// its table `const struct dea_record dea_instrument_<name>_record`.
#define DEA_INSTRUMENT_LIST(X)                                                                     \
  X(sim)                                                                                           \
  X(nidaqmx)                                                                                       \
  X(gocator)                                                                                       \
  X(keyence)                                                                                       \
  X(optoncdt)                                                                                      \
  X(scpi)                                                                                          \
  X(shvps)                                                                                         \
  X(ochvps)
