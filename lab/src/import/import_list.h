/* The formats of files that can be imported; the first that recognises a file reads it. */
#pragma once

// X(name of the `const struct dea_importer`)
#define DEA_IMPORTER_LIST(X)                                                                       \
  X(dea_import_tdms)                                                                               \
  X(dea_import_lvm)                                                                                \
  X(dea_import_mat)                                                                                \
  X(dea_import_trios)                                                                              \
  X(dea_import_comsol)                                                                             \
  X(dea_import_tektronix)                                                                          \
  X(dea_import_rigol)                                                                              \
  X(dea_import_csv)
