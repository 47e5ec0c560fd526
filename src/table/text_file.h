/* Bytes of a text file, whatever its encoding, as text that slices are taken of. */
#pragma once

#include "table/imported_table.h"
#include "table/slices.h"

/* Hands the bytes as text to a reader: without a byte order mark, UTF-16 with one as UTF-8, and so
 * text of Shift-JIS, GB 18030 and Windows-1251. UTF-8 and Latin-1 stay as they are: what is not
 * ASCII is in names only, which dea_table_add converts. Letters that may be of several encodings
 * are a finding, and DEA_E_IO, as is a byte 0, which says that it is no text. */
dea_status dea_text_file_read(struct dea_context *ctx, const unsigned char *bytes, size_t length,
                              dea_status (*read)(struct dea_context *ctx, struct dea_slice text,
                                                 struct dea_table *out),
                              struct dea_table *out);
/* Whether the first bytes are text. */
bool dea_text_file_is(const unsigned char *head, size_t length);
