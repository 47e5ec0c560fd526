/* Fuzz target: the importer of tektronix. */
#include "fuzz_import.h"

FUZZ_IMPORTER("tektronix")
