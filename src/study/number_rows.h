/* What tables about the numbers of a design share: columns, texts, and the order of their rows. */
#pragma once

#include "study/numbers.h"
#include "study/study.h"

/* Columns of a number: its key, its value and its unit. */
#define DEA_NUMBER_IN_ROW                                                                          \
  DEA_TEXT_COLUMN("number", "number", "of the design"),                                            \
      DEA_BARE("number_value", "value", "of the number, in its unit"),                             \
      DEA_TEXT_COLUMN("number_unit", "unit", "of the number")
#define DEA_NUMBER_TOLERANCE                                                                       \
  DEA_BARE("tolerance", "tolerance", "of the workshop, in the number's unit")

/* A number as people read it, in a unit that fits. */
void dea_number_text(double value, const char *unit, char *out, size_t size);

/* A tolerance of the workshop and what it changes a quantity by; "" where there is none. */
struct dea_tolerated {
  char tolerance[48], change[48];
};
/* slope: of the quantity, in `unit`, by the number. */
struct dea_tolerated dea_number_tolerated(const struct dea_design_number *number, double slope,
                                          const char *unit);

/* order [count]: places of the sizes above 0, the largest first, equal ones as they come. How many
 * they are. */
size_t dea_numbers_order(const double *sizes, size_t count, size_t *order);
