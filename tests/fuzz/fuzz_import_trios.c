/* Fuzz target: the importer of trios. */
#include "fuzz_import.h"

FUZZ_IMPORTER("trios")
