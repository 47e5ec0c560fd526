/* CSV: curves with their events, profiles, variants, and the tables of studies. */
#include "io/csv.h"
#include "io/export.h"

/* Whether a variant is the first of its model and study. */
static bool first_of_study(const struct dea_result *result, size_t i)
{
  const struct dea_curve *curve = &result->variants[i].curve;
  for (size_t k = 0; k < i; k++) {
    if (dea_variant_is(&result->variants[k], curve->model, curve->kind)) {
      return false;
    }
  }
  return true;
}

static dea_status write(struct dea_context *ctx, const struct dea_result *result,
                        const char *directory)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  for (size_t i = 0; i < result->curve_count; i++) {
    DEA_TRY(ctx, dea_csv_write_curve(ctx, &result->curves[i], directory));
    DEA_TRY(ctx, dea_csv_write_events(ctx, &result->curves[i], directory));
  }
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    DEA_TRY(ctx, dea_csv_write_profiles(ctx, result, models[m], "", directory));
  }
  for (size_t i = 0; i < result->variant_count; i++) {
    if (first_of_study(result, i)) {
      const struct dea_curve *curve = &result->variants[i].curve;
      DEA_TRY(ctx, dea_csv_write_variants(ctx, result, curve->model, curve->kind, directory));
      DEA_TRY(ctx, dea_csv_write_profiles(ctx, result, curve->model, curve->kind, directory));
    }
  }
  for (size_t i = 0; i < result->table_count; i++) {
    DEA_TRY(ctx, dea_csv_write_table(ctx, &result->tables[i], directory));
  }
  return DEA_OK;
}

const struct dea_export dea_export_tables = {.write = write};
