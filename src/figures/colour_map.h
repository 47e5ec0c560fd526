/* What the figures of the film's middle surface share: which one, its colours, its data. */
#pragma once

#include "figures/run_figures.h"
#include "figures/surface_lattice.h"
#include "result/trust.h"

/* The surface of the result's first model with surfaces at the voltage, or the nearest to it; the
 * last one that is to be trusted for NAN, or the last where none is. NULL when there is none; lent.
 */
const struct dea_surface_record *dea_surface_choose(const struct dea_result *result,
                                                    double voltage_V);
/* A note where that is another voltage than the one that was asked for. */
dea_status dea_surface_report(struct dea_context *ctx, const char *figure,
                              const struct dea_surface_record *record, double voltage_V);
/* Up to `max` of them from first to last, evenly; returns their number. */
size_t dea_surface_spread(const struct dea_result *result, size_t max,
                          const struct dea_surface_record *out[]);

/* Whether it has shapes of modes. */
bool dea_surface_has_shapes(const struct dea_surface_record *record);

/* A surface ready to be drawn. */
struct dea_colour_map {
  double voltage_V;
  char words[DEA_VOLTAGE_WORDS]; // what it shows: dea_voltage_words
  struct dea_surface_lattice drawing;
  struct dea_outline *outlines;
  size_t outline_count;
};
/* result: of the record, for its words; NULL: of none. pieces: as in dea_surface_lattice_create.
 * out: dea_colour_map_free, also after a failure. */
dea_status dea_colour_map_create(struct dea_context *ctx, const struct dea_result *result,
                                 const struct dea_surface_record *record, size_t pieces,
                                 struct dea_colour_map *out);
void dea_colour_map_free(struct dea_context *ctx, struct dea_colour_map *picture);

/* Range of colours for displacements between two values [m], and the palette: from dark blue
 * over grey to light yellow around 0 when both signs matter, else from dark to light: lightness
 * rises all the way, so that the sign is there in grey too. Unit of the colours: um. */
void dea_colour_map_add_palette(struct dea_text *gp, double low_m, double high_m);
/* 1, 2 or 5 times a power of ten, at most `largest` > 0. */
double dea_nice_below(double largest);

/* Writes script and data of a figure, NAME.gp and NAME.dat. */
dea_status dea_colour_map_write(struct dea_context *ctx, const struct dea_text *gp,
                                const struct dea_text *dat, const char *name,
                                const char *directory);
