/* Fuzz target: the importer of rigol. */
#include "fuzz_import.h"

FUZZ_IMPORTER("rigol")
