/* Fuzz target: the importer of comsol. */
#include "fuzz_import.h"

FUZZ_IMPORTER("comsol")
