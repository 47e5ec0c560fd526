/* A comparison as JSON and as figures. */
#ifndef DEA_OUTPUT_COMPARE_OUTPUT_H
#define DEA_OUTPUT_COMPARE_OUTPUT_H

#include "base/json.h"
#include "output/plot.h"
#include "result/compare.h"

/* One comparison with the names of its sides. */
struct dea_compared {
  const struct dea_comparison *comparison;   // lent
  char a[DEA_LABEL_SIZE], b[DEA_LABEL_SIZE]; // names for people: "run-1 lumped"
};

/* Object {quantity, unit, points, rms, largest, largest_at_V, bias, range, relative_rms,
 * relative_largest, std_points, chi_square_per_point, within_1_std, within_2_std, within}; what is
 * of std only where uncertainties are known, `within` only with a tolerance (NAN: none).
 * at_unit: of what the misfit is over, "V". NULL when memory is short. */
json_t *dea_misfit_json(const struct dea_misfit *misfit, const char *at_unit, double tolerance);
/* Object {a, b, quantities: [of dea_misfit_json]}. NULL when memory is short. */
json_t *dea_compared_json(const struct dea_compared *compared, double tolerance);

/* For each quantity compare_KEY.gp, .dat and pictures in directory (made if need be): both curves,
 * and below their difference, with error bars where b has uncertainties. suffix: added to the
 * names,
 * "" when there is only one comparison. */
dea_status dea_compared_draw(struct dea_context *ctx, const struct dea_compared *compared,
                             const char *suffix, const struct dea_plot_format *format,
                             const char *directory);

#endif
