#include "output/unit.h"

#include <udunits2.h>

struct dea_unit_table {
  ut_system *system;
};

dea_status dea_unit_table_create(struct dea_context *ctx, struct dea_unit_table **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  ut_error_message_handler before = ut_set_error_message_handler(ut_ignore);
  (*out)->system = ut_read_xml(NULL);
  ut_set_error_message_handler(before);
  if ((*out)->system == NULL) {
    dea_free(ctx, *out);
    *out = NULL;
    return dea_fail(ctx, DEA_E_IO, "the unit database of udunits2 cannot be read");
  }
  return DEA_OK;
}

void dea_unit_table_destroy(struct dea_context *ctx, struct dea_unit_table *table)
{
  if (table != NULL) {
    ut_free_system(table->system);
    dea_free(ctx, table);
  }
}

enum dea_unit_match dea_unit_factor(const struct dea_unit_table *table, const char *unit,
                                    const char *si_unit, double *factor)
{
  ut_error_message_handler before = ut_set_error_message_handler(ut_ignore);
  enum dea_unit_match match = DEA_UNIT_UNKNOWN;
  ut_unit *from = ut_parse(table->system, unit, UT_UTF8);
  ut_unit *to = ut_parse(table->system, si_unit, UT_UTF8);
  if (from != NULL && to != NULL) {
    cv_converter *converter = ut_get_converter(from, to);
    match = DEA_UNIT_OTHER_DIMENSION;
    if (converter != NULL) {
      *factor = cv_convert_double(converter, 1.0);
      match = DEA_UNIT_FITS;
      cv_free(converter);
    }
  }
  ut_free(from);
  ut_free(to);
  ut_set_error_message_handler(before);
  return match;
}
