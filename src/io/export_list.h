/* What is written of every result, in this order. A new one is a file and a line here. */
// X(name): export_<name>.c with `const struct dea_export dea_export_<name>`.
#define DEA_EXPORT_LIST(X)                                                                         \
  X(tables)                                                                                        \
  X(design)                                                                                        \
  X(summary)                                                                                       \
  X(results_h5)
