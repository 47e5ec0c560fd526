/* Text of a DXF file. */
#pragma once

#include <stdbool.h>

enum { DEA_DXF_TEXT_SIZE = 256 };

/* How the bytes of a file are letters; zero-initialise. */
struct dea_dxf_text {
  char page[24];     // codepage as iconv calls it; "": not known
  bool utf8;         // bytes are UTF-8, as of version AC1021 (2007) on
  bool page_guessed; // some text was no UTF-8, and no codepage is known: CP1252 was taken
  void *converter;   // of the page, NULL: not yet opened; owned
};

/* The codepage by the file's header, $DWGCODEPAGE: "ANSI_1252". */
void dea_dxf_text_set_page(struct dea_dxf_text *as, const char *name);
/* Text as UTF-8, in place, with its escapes \U+XXXX and \M+NXXXX; cut where it does not fit. */
void dea_dxf_text_decode(struct dea_dxf_text *as, char text[DEA_DXF_TEXT_SIZE]);
void dea_dxf_text_free(struct dea_dxf_text *as);
