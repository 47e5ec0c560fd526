/* A reduction as files: tables, JSON, figures. */
#pragma once

#include "base/json.h"
#include "base/text.h"
#include "plot/plot.h"
#include "reduce/reduce.h"

enum { DEA_REDUCTION_SCHEMA = 1, DEA_REDUCED_SERIES_MAX = 20000 };

/* What is reduced of a cycle, in words and display units. */
struct dea_reduced_meaning {
  const char *name;    // "z centre"
  const char *key;     // "centre"
  const char *si_unit; // "m"
  const char *unit;    // "um"
  double factor;       // SI -> unit
};
extern const struct dea_reduced_meaning dea_reduced_meanings[DEA_REDUCED_KINDS];
/* True when some level has a mean of that kind. */
bool dea_reduced_has(const struct dea_reduction *reduction, enum dea_reduced_kind kind);
/* The first kind of displacement that some level has, else force; DEA_REDUCED_KINDS: none. */
enum dea_reduced_kind dea_reduced_main(const struct dea_reduction *reduction);

/* The first of displacements and force of which rise times are known; else the main one. */
enum dea_reduced_kind dea_reduced_timed(const struct dea_reduction *reduction);

/* A row of measurement.csv: all levels of one voltage. std: the larger of the standard deviation
 * from cycle to cycle and the root mean square of the uncertainties that the noise gives a cycle.
 */
struct dea_reduced_row {
  double voltage_V;
  size_t cycles, levels;                                  // levels: how many from the first on
  double mean[DEA_REDUCED_KINDS], std[DEA_REDUCED_KINDS]; // std: of one cycle
  double uncertainty[DEA_REDUCED_KINDS];                  // of the mean, NAN: not known
};
/* Largest size of a level's voltage; 0 without levels. */
double dea_reduced_highest_V(const struct dea_reduction *reduction);
/* The row that begins with a level. */
struct dea_reduced_row dea_reduced_row_at(const struct dea_reduction *reduction, size_t level);

/* Voltage and all series at common times, from every sample where they are few, else from the
 * smallest and the largest sample of each of even stretches of time, so that edges stay. */
struct dea_reduced_series {
  size_t rows;
  bool thinned;
  double *time_s, *voltage_V;        // [rows], owned
  double *values[DEA_REDUCED_KINDS]; // [rows], owned; NULL: not measured
};
dea_status dea_reduced_series_fill(struct dea_context *ctx, const struct dea_recording *recording,
                                   const struct dea_reduction *reduction, size_t most,
                                   struct dea_reduced_series *out);
void dea_reduced_series_free(struct dea_context *ctx, struct dea_reduced_series *table);

/* Writes measurement.csv, levels.csv, cycles.csv, life.csv, discharges.csv, profiles.csv,
 * history.csv; those that would hold nothing are left out. */
dea_status dea_reduction_write_tables(struct dea_context *ctx,
                                      const struct dea_recording *recording,
                                      const struct dea_reduction *reduction, const char *directory);
/* Everything, with the context's notes; command: NULL for none. */
json_t *dea_reduction_json(struct dea_context *ctx, const struct dea_recording *recording,
                           const struct dea_reduction *reduction, const char *command);
/* Draws profiles, history, amplitude and cycles, as far as there is something to show. */
dea_status dea_reduction_draw(struct dea_context *ctx, const struct dea_recording *recording,
                              const struct dea_reduction *reduction,
                              const struct dea_plot_format *format, const char *directory);

/* Makes the folder and takes the files of an earlier reduction out of it; DEA_E_IO when it has one
 * and force is not set. */
dea_status dea_reduction_folder(struct dea_context *ctx, const char *directory, bool force);
/* All of the above into that folder, reduction.json last but the figures. */
dea_status dea_reduction_write(struct dea_context *ctx, const struct dea_recording *recording,
                               const struct dea_reduction *reduction, const char *command,
                               const struct dea_plot_format *format, const char *directory);
