// X(name): every figure that is no study's, `const struct dea_figure dea_figure_<name>`.
#define DEA_FIGURE_LIST(X)                                                                         \
  X(displacement)                                                                                  \
  X(stretch)                                                                                       \
  X(field)                                                                                         \
  X(tension)                                                                                       \
  X(force)                                                                                         \
  X(profile)                                                                                       \
  X(map)                                                                                           \
  X(surface)                                                                                       \
  X(section)                                                                                       \
  X(animation)                                                                                     \
  X(mode_shapes)
