#include "figures/colour_map.h"

#include "base/write_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool of_first_model(const struct dea_result *result, size_t i)
{
  return strcmp(result->surfaces[i].model, result->surfaces[0].model) == 0;
}

/* The last surface that is to be trusted and moves; NULL for none. */
static const struct dea_surface_record *last_trusted(const struct dea_result *result)
{
  const struct dea_surface_record *best = NULL;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if (of_first_model(result, i) && record->voltage_V > 0 &&
        dea_result_doubts(result, record->model, record->voltage_V) == 0) {
      best = record;
    }
  }
  return best;
}

const struct dea_surface_record *dea_surface_choose(const struct dea_result *result,
                                                    double voltage_V)
{
  const struct dea_surface_record *trusted = isnan(voltage_V) ? last_trusted(result) : NULL;
  if (trusted != NULL) {
    return trusted;
  }
  const struct dea_surface_record *best = NULL;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if (of_first_model(result, i) &&
        (best == NULL || isnan(voltage_V) ||
         fabs(record->voltage_V - voltage_V) < fabs(best->voltage_V - voltage_V))) {
      best = record;
    }
  }
  return best;
}

dea_status dea_surface_report(struct dea_context *ctx, const char *figure,
                              const struct dea_surface_record *record, double voltage_V)
{
  const double rounding = 1e-9; // relative, of voltages in steps
  if (!(fabs(record->voltage_V - voltage_V) > rounding * fabs(voltage_V))) { // or NAN
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                         "figure '%s' shows %.6g kV: of those that the run has kept the nearest to "
                         "%.6g kV",
                         figure, 1e-3 * record->voltage_V, 1e-3 * voltage_V);
}

size_t dea_surface_spread(const struct dea_result *result, size_t max,
                          const struct dea_surface_record *out[])
{
  size_t count = 0, seen = 0, taken = 0;
  for (size_t i = 0; i < result->surface_count; i++) {
    count += of_first_model(result, i);
  }
  size_t wanted = count < max ? count : max;
  for (size_t i = 0; i < result->surface_count && taken < wanted; i++) {
    if (of_first_model(result, i) &&
        seen++ == (wanted > 1 ? taken * (count - 1) / (wanted - 1) : count - 1)) {
      out[taken++] = &result->surfaces[i];
    }
  }
  return taken;
}

bool dea_surface_has_shapes(const struct dea_surface_record *record)
{
  char first[32];
  snprintf(first, sizeof first, DEA_SHAPE_FIELD, 1);
  return dea_field_mesh_find(record->mesh, first) != NULL;
}

dea_status dea_colour_map_create(struct dea_context *ctx, const struct dea_result *result,
                                 const struct dea_surface_record *record, size_t pieces,
                                 struct dea_colour_map *out)
{
  *out = (struct dea_colour_map){.voltage_V = record->voltage_V};
  dea_voltage_words(result, record->model, record->voltage_V, out->words);
  DEA_TRY(ctx, dea_surface_lattice_create(ctx, record->mesh, pieces, &out->drawing));
  return DEA_CHAIN(
      ctx, dea_surface_lattice_outlines(ctx, record->mesh, &out->outlines, &out->outline_count));
}

void dea_colour_map_free(struct dea_context *ctx, struct dea_colour_map *picture)
{
  dea_surface_lattice_free(ctx, &picture->drawing);
  dea_free(ctx, picture->outlines);
  picture->outlines = NULL;
}

double dea_nice_below(double largest)
{
  double power = pow(10, floor(log10(largest) + 1e-9)), share = largest / power * (1 + 1e-9);
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

void dea_colour_map_add_palette(struct dea_text *gp, double low_m, double high_m)
{
  double low_um = 1e6 * low_m, high_um = 1e6 * high_m;
  double largest = fmax(fabs(low_um), fabs(high_um));
  if (!(largest > 1e-6)) { // flat: no colours out of rounding
    low_um = -1;
    high_um = largest = 1;
  }
  if (low_um < 0 && high_um > 0 && fmin(-low_um, high_um) > 0.2 * largest) {
    dea_text_add(gp,
                 "set cbrange [%.6g:%.6g]\nset palette defined (0 \"#06193A\", 1 \"#0A4178\", "
                 "2 \"#3B74AC\", 3 \"#95989A\", 4 \"#DBAA5E\", 5 \"#F6CE58\", 6 \"#FFF7B8\")\n",
                 -largest, largest);
  } else {
    dea_text_add(gp,
                 "set cbrange [%.6g:%.6g]\nset palette defined (0 \"#0B1D42\", 1 \"#0B4A80\", "
                 "2 \"#0072B2\", 3 \"#4FA9C9\", 4 \"#A6D3A0\", 5 \"#F0E442\")\n",
                 low_um, high_um);
  }
  dea_text_add(gp, "set cbtics scale 0.4\n");
}

dea_status dea_colour_map_write(struct dea_context *ctx, const struct dea_text *gp,
                                const struct dea_text *dat, const char *name, const char *directory)
{
  char file[80];
  snprintf(file, sizeof file, "%.60s.dat", name);
  DEA_TRY(ctx, dea_text_write(ctx, dat, directory, file));
  snprintf(file, sizeof file, "%.60s.gp", name);
  return DEA_CHAIN(ctx, dea_text_write(ctx, gp, directory, file));
}
