/* All studies in the order in which they run: the path first, since the sweep reads its limit
 * points; uncertainty after those whose curves it adds bands to. A new one is a file and a line
 * here. */
// X(name of the `const struct dea_study`)
#define DEA_STUDY_LIST(X)                                                                          \
  X(dea_study_path)                                                                                \
  X(dea_study_sweep)                                                                               \
  X(dea_study_force)                                                                               \
  X(dea_study_loading)                                                                             \
  X(dea_study_uncertainty)                                                                         \
  X(dea_study_transient)                                                                           \
  X(dea_study_modal)                                                                               \
  X(dea_study_frequency)                                                                           \
  X(dea_study_states)                                                                              \
  X(dea_study_convergence)                                                                         \
  X(dea_study_compare_design)                                                                      \
  X(dea_study_operating_map)                                                                       \
  X(dea_study_load_line)                                                                           \
  X(dea_study_sensitivity)
