#include "instrument/comedi_library.h"

#include "instrument/library.h"

dea_status dea_comedi_open(struct dea_context *ctx, const char *file,
                           struct dea_comedi_library *out)
{
  static const struct dea_library_symbol symbols[] = {
#define COMEDI_SYMBOL(name, symbol, type, arguments)                                               \
  {symbol, offsetof(struct dea_comedi_library, name)},
      DEA_COMEDI_FUNCTIONS(COMEDI_SYMBOL)
#undef COMEDI_SYMBOL
  };
  DEA_TRY(ctx,
          dea_library_open(ctx, file, "comedilib",
                           "install the package libcomedi0 and the driver of the board, or play "
                           "on another computer with the scripts of 'dea drive --export'",
                           symbols, sizeof symbols / sizeof symbols[0], out));
  out->loglevel(0); // it would write to stderr
  return DEA_OK;
}
