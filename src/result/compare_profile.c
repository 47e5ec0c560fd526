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

/* Puts the places of a half, from the centre outwards, into x and z, and returns how many. */
static size_t fill_half(const struct blend *b, enum dea_half half, double *x, double *z)
{
  const size_t n = b->first->count;
  double largest = 0.0;
  size_t count = 0;
  for (size_t k = 0; k < n; k++) {
    const size_t i = half == DEA_HALF_FIBRE ? k : n - 1 - k;
    const double radius = b->first->columns[RADIUS * n + i], height = blend_get(b, HEIGHT, i);
    const bool outwards = half == DEA_HALF_FIBRE ? radius >= 0.0 : radius <= 0.0;
    // the centre has no direction to move in
    const double at = fabs(radius) > 0.0 ? fabs(radius) + blend_get(b, DISPLACEMENT, i) : 0.0;
    if (outwards && isfinite(at) && isfinite(height) && (count == 0 || at > x[count - 1])) {
      x[count] = at;
      z[count++] = height;
      largest = fmax(largest, fabs(height));
    }
  }
  return largest > 0.0 && count > 1 ? count : 0;
}

dea_status dea_film_line_build(struct dea_arena *memory, const struct dea_result *result,
                               const char *model, double voltage_V, enum dea_half half,
                               struct dea_film_line *out)
{
  struct blend b;
  *out = (struct dea_film_line){0};
  if (!find_blend(result, model, voltage_V, &b)) {
    return DEA_OK;
  }
  const size_t half_count = b.first->count;
  double *x = dea_arena_alloc(memory, 2 * half_count, sizeof *x);
  double *z = dea_arena_alloc(memory, 2 * half_count, sizeof *z);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  const size_t count = fill_half(&b, half, x + half_count, z + half_count);
  size_t first = half_count;
  for (size_t k = 0; k < count; k++) { // the other side, without a centre of its own
    if (x[half_count + k] > 0.0) {
      x[--first] = -x[half_count + k];
      z[first] = z[half_count + k];
    }
  }
  out->samples = (struct dea_samples){half_count + count - first, x + first, z + first, NULL};
  out->directed = b.first->columns[0] < 0.0; // radii rise from there
  out->between_records = b.first != b.second;
  return DEA_OK;
}

dea_status dea_film_line_compare(struct dea_arena *memory, const struct dea_film_line *line,
                                 const struct dea_samples *measured, struct dea_misfit *out)
{
  const size_t n = line->samples.count;
  const struct dea_reading reading = {.margin = n > 0 ? rounding * line->samples.at[n - 1] : 0.0};
  return dea_misfit_compute(memory, dea_point_column_find("centre_z_m"), &line->samples, measured,
                            &reading, out);
}
