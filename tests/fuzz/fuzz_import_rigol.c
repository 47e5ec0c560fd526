/* Fuzz target: the importer of rigol. */
#include "fuzz_import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  return fuzz_bytes("rigol", data, size);
}
