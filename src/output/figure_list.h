// X(name): every figure is figure_<name>.c with `const struct dea_figure dea_figure_<name>`.
#define DEA_FIGURE_LIST(X)                                                                         \
  X(displacement)                                                                                  \
  X(stretch)                                                                                       \
  X(field)                                                                                         \
  X(tension)                                                                                       \
  X(force)                                                                                         \
  X(tip_force)                                                                                     \
  X(load_line)                                                                                     \
  X(profile)                                                                                       \
  X(map)                                                                                           \
  X(surface)                                                                                       \
  X(section)                                                                                       \
  X(animation)                                                                                     \
  X(history)                                                                                       \
  X(history_force)                                                                                 \
  X(history_current)                                                                               \
  X(modes)                                                                                         \
  X(mode_shapes)                                                                                   \
  X(bode)                                                                                          \
  X(convergence)                                                                                   \
  X(designs)                                                                                       \
  X(design_tips)                                                                                   \
  X(design_profiles)
