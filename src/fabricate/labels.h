/* Words in files: those beside a sheet, and text of a design that other programs read. */
#pragma once

#include "base/text.h"
#include "fabricate/workshop.h"

/* "frdea-4.yaml: Frame of the pre-stretch; seen from ...; 2 copies, ...". */
void dea_sheet_labels(const struct dea_workshop *workshop, size_t index, struct dea_text *out);
/* Height of letters with which it fits beside the sheet [m]. */
double dea_sheet_labels_height(const struct dea_sheet_layout *layout);

/* Next letter of UTF-8 text, 0 at its end: control characters become spaces, what is not UTF-8
 * becomes U+FFFD. */
unsigned dea_letter_next(const char **text);
/* Text of a design inside XML or HTML: its special letters as entities, always good UTF-8. */
void dea_xml_add(struct dea_text *out, const char *text);
