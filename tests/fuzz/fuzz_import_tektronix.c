/* Fuzz target: the importer of tektronix. */
#include "fuzz_import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  return fuzz_bytes("tektronix", data, size);
}
