/* Rows of numbers of a text file into the columns of a table. */
#ifndef DEA_TABLE_TEXT_ROWS_H
#define DEA_TABLE_TEXT_ROWS_H

#include "table/csv_dialect.h"

/* Adds a column for each one that is not of text, with its title (titles: [dialect->count]; units:
 * the same, NULL to find them in the titles), and reads all rows into them. Errors are findings
 * with line and column, DEA_E_IO then. */
dea_status dea_text_rows_read(struct dea_context *ctx, struct dea_slice text,
                              const struct dea_csv_dialect *dialect, const struct dea_slice *titles,
                              const struct dea_slice *units, struct dea_table *out);

#endif
