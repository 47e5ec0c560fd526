#include "import/scale.h"

#include "base/units.h"
#include "table/titles.h"

#include <stdio.h>
#include <string.h>

static bool is_given(const struct dea_label *label)
{
  return label != NULL && label->text[0] != '\0';
}

/* A whole text as a number without unit. */
static bool bare_number(const char *text, double *value)
{
  struct dea_slice slice = {text, strlen(text)};
  return dea_slice_number(slice, '.', value) && *value == *value;
}

/* A quantity of the mapping: "1 kV", or a number of the column's unit. */
static dea_status read_quantity(struct dea_context *ctx, const struct dea_label *label,
                                const char *key, const char *si, double unit, double *value,
                                bool *good)
{
  char why[DEA_WHY_SIZE], example[40];
  double number;
  if (bare_number(label->text, &number)) {
    *value = number * unit;
    return DEA_OK;
  }
  snprintf(example, sizeof example, "1 %s", si);
  const struct dea_measure due = {si[0] != '\0' ? si : "1", si[0] != '\0' ? example : "1"};
  if (dea_units_read(ctx, label->text, due, value, why)) {
    return DEA_OK;
  }
  *good = false;
  if (why[0] == '\0') {
    return dea_context_status(ctx);
  }
  return dea_finding_add(ctx, DEA_ERROR, label->location, "%s: %s", key, why);
}

/* Factor of the unit; 0: of another dimension than due, 1 without a unit. */
static dea_status read_unit(struct dea_context *ctx, const struct dea_table_column *column,
                            const char *si, const struct dea_label *given, double *factor)
{
  const char *unit = is_given(given) ? given->text : column->unit;
  *factor = 1;
  if (unit[0] == '\0' || si[0] == '\0') {
    return DEA_OK;
  }
  const char *found = dea_title_unit(ctx, unit, factor);
  if (found == NULL && dea_context_status(ctx) != DEA_OK) {
    return dea_context_status(ctx);
  }
  if (found == NULL || strcmp(found, si) != 0) {
    *factor = 0;
  }
  return DEA_OK;
}

dea_status dea_scale_find(struct dea_context *ctx, const struct dea_table_column *column,
                          const char *si, const struct dea_scale_text *text,
                          struct dea_location location, double *factor, double *offset, bool *good)
{
  double unit, number;
  *good = true;
  *offset = 0;
  dea_context_clear(ctx);
  DEA_TRY(ctx, read_unit(ctx, column, si, text->unit, &unit));
  bool says = is_given(text->per_unit) && !bare_number(text->per_unit->text, &number);
  if (unit == 0 && is_given(text->unit)) {
    *good = false;
    return dea_finding_add(ctx, DEA_ERROR, text->unit->location,
                           "'%.40s' is no unit that becomes %s; what 1 in the column stands for is "
                           "said by per_unit, such as '1 %s'",
                           text->unit->text, si, si);
  }
  if (unit == 0 && !says) {
    *good = false;
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "the column '%.60s' is in '%.40s', not in %s: say what 1 of that stands "
                           "for in a mapping (per_unit: 1 %s)",
                           column->name, column->unit, si, si);
  }
  *factor = unit;
  if (is_given(text->per_unit)) {
    DEA_TRY(ctx, read_quantity(ctx, text->per_unit, "per_unit", si, unit, factor, good));
    if (*good && *factor == 0) {
      *good = false;
      return dea_finding_add(ctx, DEA_ERROR, text->per_unit->location, "per_unit must not be 0");
    }
  }
  if (is_given(text->at_zero)) {
    DEA_TRY(ctx, read_quantity(ctx, text->at_zero, "at_zero", si, unit, offset, good));
  }
  return DEA_OK;
}
