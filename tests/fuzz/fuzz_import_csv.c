/* Fuzz target: the importer of csv. */
#include "fuzz_import.h"

FUZZ_IMPORTER("csv")
