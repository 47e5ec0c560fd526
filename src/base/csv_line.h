/* Lines and fields of CSV files. */
#ifndef DEA_BASE_CSV_LINE_H
#define DEA_BASE_CSV_LINE_H

#include "base/text.h"

enum { DEA_CSV_FIELD_MAX = 200 }; // bytes of a field; more of it is not looked at

/* The next line of *text that is neither empty nor a comment (#), cut off in place; *text goes to
 * what follows, *line (0 at the start) counts all lines. NULL at the end. */
char *dea_csv_line(char **text, size_t *line);
/* Semicolon, tab or comma: what parts the fields of a header. */
char dea_csv_separator(const char *line);
/* Takes the field at *cursor (trimmed, quotes off) into out[DEA_CSV_FIELD_MAX] and moves to the
 * next; false at the line's end. column: where the field's text starts, from 1. */
bool dea_csv_field(const char *line, const char **cursor, char separator, char *out,
                   size_t *column);
/* Lower case, '_' and '-' as blanks, no blanks at the ends or twice; out[DEA_CSV_FIELD_MAX]. */
void dea_csv_fold(const char *text, char *out);
/* Parts "Z centre (um)" into "z centre", folded, and "um"; both [DEA_CSV_FIELD_MAX]. */
void dea_csv_split_title(const char *title, char *name, char *unit);
/* Number of a whole field, NAN for an empty one; a decimal comma where the separator is none. text
 * may change. false when it is no finite number. */
bool dea_csv_number(char separator, char *text, double *value);
/* A name as one field: in quotes where it has a comma or quotes of its own. */
void dea_csv_add_name(struct dea_text *text, const char *name);

#endif
