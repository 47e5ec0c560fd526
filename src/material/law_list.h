/* The registered laws, in the order in which they are listed. A new law is one file law_<name>.c
 * that defines dea_law_<name>, and one line here. */
#pragma once

#define DEA_LAW_LIST(X)                                                                            \
  X(neo_hookean)                                                                                   \
  X(mooney_rivlin)                                                                                 \
  X(yeoh)                                                                                          \
  X(third_order)                                                                                   \
  X(gent)                                                                                          \
  X(ogden)                                                                                         \
  X(arruda_boyce)                                                                                  \
  X(hgo)                                                                                           \
  X(compressible_neo_hookean)
