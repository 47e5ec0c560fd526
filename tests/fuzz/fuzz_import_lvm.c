/* Fuzz target: the importer of lvm. */
#include "fuzz_import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  return fuzz_bytes("lvm", data, size);
}
