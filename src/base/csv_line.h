/* Titles and names of CSV files. */
#pragma once

#include "base/text.h"

enum { DEA_CSV_FIELD_MAX = 200 }; // bytes of a field; more of it is not looked at

/* Lower case, '_' and '-' as blanks, no blanks at the ends or twice; out[DEA_CSV_FIELD_MAX]. */
void dea_csv_fold(const char *text, char *out);
/* Parts "Z centre (um)" into "z centre", folded, and "um"; both [DEA_CSV_FIELD_MAX]. */
void dea_csv_split_title(const char *title, char *name, char *unit);
/* A name as one field: in quotes where it has a comma or quotes of its own. */
void dea_csv_add_name(struct dea_text *text, const char *name);
/* Adds each number behind a comma, nothing behind it where it is not finite. */
void dea_csv_add_numbers(struct dea_text *text, int digits, const double *values, size_t count);
#define DEA_CSV_ADD(text, digits, ...)                                                             \
  dea_csv_add_numbers(text, digits, (const double[]){__VA_ARGS__},                                 \
                      sizeof((const double[]){__VA_ARGS__}) / sizeof(double))
