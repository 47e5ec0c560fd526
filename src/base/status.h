/* Status codes: one list for code, name, process exit code, message.
 *
 * Codes below DEA_STATUS_SUSPECT leave every object passed in as it was; from it on the object that
 * was being worked on holds only what its documentation promises (for example the points that were
 * computed before the failure). */
#pragma once

// X(code, exit code of the command, message)
#define DEA_STATUS_LIST(X)                                                                         \
  X(DEA_OK, 0, "success")                                                                          \
  X(DEA_E_DIFFERS, 1, "the comparison is out of tolerance")                                        \
  X(DEA_E_USAGE, 2, "the command line is not understood")                                          \
  X(DEA_E_ARGUMENT, 2, "an argument of a library call is out of range")                            \
  X(DEA_E_UNSUPPORTED, 2, "this build cannot do that")                                             \
  X(DEA_E_DESIGN, 3, "the design file has errors")                                                 \
  X(DEA_E_IO, 5, "a file could not be read or written")                                            \
  X(DEA_E_TOOL, 5, "an external program failed or is missing")                                     \
  X(DEA_E_INSTRUMENT, 6, "an instrument failed")                                                   \
  X(DEA_E_INTERLOCK, 6, "a limit of the bench would be or was exceeded")                           \
  X(DEA_E_MEMORY, 5, "out of memory")                                                              \
  X(DEA_E_DOMAIN, 4, "a material law was asked beyond its domain")                                 \
  X(DEA_STATUS_SUSPECT, 4, "")                                                                     \
  X(DEA_E_NOT_CONVERGED, 4, "the solver did not converge")                                         \
  X(DEA_E_NO_EQUILIBRIUM, 4, "there is no equilibrium at this load")                               \
  X(DEA_E_INTERRUPTED, 130, "interrupted")                                                         \
  X(DEA_E_SLACK, 4, "the film loses its tension")                                                  \
  X(DEA_E_INVERTED, 4, "an element of the mesh turns inside out")

typedef enum dea_status {
#define DEA_STATUS_ENUM(code, exit_code, message) code,
  DEA_STATUS_LIST(DEA_STATUS_ENUM)
#undef DEA_STATUS_ENUM
} dea_status;

/* Text of a status, never NULL; static storage. */
const char *dea_status_message(dea_status status);
/* Symbol of a status such as "DEA_E_IO", never NULL; static storage. */
const char *dea_status_name(dea_status status);
/* Exit code that the command `dea` gives for a status. */
int dea_status_exit_code(dea_status status);
