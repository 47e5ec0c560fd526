/* Fuzz target: the importer of tdms. */
#include "fuzz_import.h"

FUZZ_IMPORTER("tdms")
