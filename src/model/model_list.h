/* All models, in the order in which they are offered. A new one is a folder and a line here. */
// X(name of the `const struct dea_model_type`)
#define DEA_MODEL_LIST(X)                                                                          \
  X(dea_model_lumped)                                                                              \
  X(dea_model_axisymmetric)                                                                        \
  X(dea_model_3d)                                                                                  \
  X(dea_model_reduced)
