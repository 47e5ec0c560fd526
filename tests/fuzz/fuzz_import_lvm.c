/* Fuzz target: the importer of lvm. */
#include "fuzz_import.h"

FUZZ_IMPORTER("lvm")
