#include "result/compare_profile.h"

#include <math.h>
#include <string.h>

enum { RADIUS, DISPLACEMENT, HEIGHT = 6 }; // of dea_profile_columns

static const double same_voltage = 0.005; // share that counts as the same
static const double rounding = 1e-9;      // of places that passed through millimetres

/* A voltage as profiles of a model have it: `share` of the second, the rest of the first. */
struct blend {
  const struct dea_profile_record *first, *second;
  double share;
};

static bool same_places(const struct dea_profile_record *a, const struct dea_profile_record *b)
{
  return a->count == b->count && memcmp(a->columns, b->columns, a->count * sizeof *a->columns) == 0;
}

/* false when the model has no profile at that voltage. */
static bool find_blend(const struct dea_result *result, const char *model, double voltage_V,
                       struct blend *out)
{
  const struct dea_profile_record *nearest = NULL, *before = NULL;
  *out = (struct blend){0};
  for (size_t i = 0; i < result->profile_count; i++) {
    const struct dea_profile_record *r = &result->profiles[i];
    if (strcmp(r->model, model) != 0 || r->count == 0) {
      continue;
    }
    double off = fabs(r->voltage_V - voltage_V);
    if (off <= same_voltage * fabs(voltage_V) &&
        (nearest == NULL || off < fabs(nearest->voltage_V - voltage_V))) {
      nearest = r;
    }
    if (out->first == NULL && before != NULL && same_places(before, r) &&
        (before->voltage_V - voltage_V) * (r->voltage_V - voltage_V) < 0.0) {
      double share = (voltage_V - before->voltage_V) / (r->voltage_V - before->voltage_V);
      *out = (struct blend){before, r, share};
    }
    before = r;
  }
  if (nearest != NULL) {
    *out = (struct blend){nearest, nearest, 0.0};
  }
  return out->first != NULL;
}

static double blend_get(const struct blend *b, size_t column, size_t i)
{
  size_t at = column * b->first->count + i;
  return (1.0 - b->share) * b->first->columns[at] + b->share * b->second->columns[at];
}

/* Adds the places of a half, from the centre outwards. */
static void fill_line(const struct blend *b, enum dea_half half, struct dea_film_line *line)
{
  size_t n = b->first->count;
  double largest = 0.0;
  for (size_t k = 0; k < n; k++) {
    size_t i = half == DEA_HALF_FIBRE ? k : n - 1 - k;
    double radius = b->first->columns[RADIUS * n + i], z = blend_get(b, HEIGHT, i);
    bool outwards = half == DEA_HALF_FIBRE ? radius >= 0.0 : radius <= 0.0;
    double x = fabs(radius) + blend_get(b, DISPLACEMENT, i);
    x = fabs(radius) > 0.0 ? x : 0.0; // the centre has no direction to move in
    if (outwards && isfinite(x) && isfinite(z) &&
        (line->count == 0 || x > line->x_m[line->count - 1])) {
      line->x_m[line->count] = x;
      line->z_m[line->count++] = z;
      largest = fmax(largest, fabs(z));
    }
  }
  if (largest == 0.0 || line->count < 2) {
    line->count = 0;
  }
}

dea_status dea_film_line_make(struct dea_context *ctx, const struct dea_result *result,
                              const char *model, double voltage_V, enum dea_half half,
                              struct dea_film_line *out)
{
  struct blend b;
  *out = (struct dea_film_line){0};
  if (!find_blend(result, model, voltage_V, &b)) {
    return DEA_OK;
  }
  out->x_m = dea_alloc(ctx, b.first->count, sizeof *out->x_m);
  out->z_m = dea_alloc(ctx, b.first->count, sizeof *out->z_m);
  if (out->x_m == NULL || out->z_m == NULL) {
    dea_film_line_free(ctx, out);
    return DEA_E_MEMORY;
  }
  out->directed = b.first->columns[0] < 0.0; // radii rise from there
  out->between_records = b.first != b.second;
  fill_line(&b, half, out);
  return DEA_OK;
}

void dea_film_line_free(struct dea_context *ctx, struct dea_film_line *line)
{
  dea_free(ctx, line->x_m);
  dea_free(ctx, line->z_m);
  *line = (struct dea_film_line){0};
}

dea_status dea_film_line_compare(struct dea_context *ctx, const struct dea_film_line *line,
                                 const double *x_m, const double *z_m, const double *z_std_m,
                                 size_t count, struct dea_misfit *out)
{
  DEA_TRY(ctx, dea_misfit_make(ctx, dea_point_column_find("centre_z_m"), count, out));
  double edge_m = line->count > 0 ? line->x_m[line->count - 1] : 0.0;
  for (size_t i = 0; i < count; i++) {
    double at_m = fabs(x_m[i]);
    at_m = at_m <= (1.0 + rounding) * edge_m ? fmin(at_m, edge_m) : at_m;
    double z = dea_interpolate_linear(line->x_m, line->z_m, line->count, at_m);
    dea_misfit_add(out, x_m[i], z, z_m[i], z_std_m != NULL ? z_std_m[i] : NAN);
  }
  if (out->count > 0) {
    dea_misfit_summarise(out);
  }
  return DEA_OK;
}
