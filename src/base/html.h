/* Writing HTML: whatever comes from outside goes through here and arrives as text. */
#pragma once

#include "base/text.h"

/* Adds text so that a browser shows it as it is, in elements and in quoted attributes. Bytes that
 * are not UTF-8 and control signs become U+FFFD. NULL adds nothing. */
void dea_html_text(struct dea_text *out, const char *text);
/* As dea_text_add, but what comes by %s arrives as text like that of dea_html_text, and %.3G is a
 * number like that of dea_html_number with three digits. Of printf's others it knows %%, %d, %zu,
 * %x, %f and %g. */
void dea_html_add(struct dea_text *out, const char *format, ...) DEA_PRINTF(2, 3);
/* "<tag>text</tag>"; tag with its attributes is ours: "td class=\"n\"". */
void dea_html_element(struct dea_text *out, const char *tag, const char *text);
/* A number with so many significant digits and a minus sign; a dash when it is none. */
void dea_html_number(struct dea_text *out, double value, int digits);
/* A number with an error, to the first digit of it; NAN or below 1e-3: to `digits` digits, the rest
 * zeros. */
void dea_html_estimate(struct dea_text *out, double value, double error, int digits);
/* The same as a cell of a table. */
void dea_html_cell(struct dea_text *out, double value, int digits);
/* Label in gnuplot's enhanced text (plot/plot.h): as the inside of an SVG text element with
 * italics, sub- and superscripts, as text without markup, or as the inside of a JSON string. */
enum dea_label_form { DEA_LABEL_SVG, DEA_LABEL_PLAIN, DEA_LABEL_JSON };
void dea_html_label(struct dea_text *out, const char *label, enum dea_label_form form);
/* A finite number with so many digits, else null. */
void dea_html_json_number(struct dea_text *out, double value, int digits);
/* Bytes as base64. */
void dea_html_base64(struct dea_text *out, const void *bytes, size_t length);
