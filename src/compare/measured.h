/* What was measured of an actuator: the folder that `dea reduce` writes, or a table alone. */
#pragma once

#include "io/csv.h"
#include "result/compare.h"
#include "table/csv_columns.h"

/* Mean profile of a voltage against rest, lent from the table: z, positive to the fibres, with its
 * scatter from cycle to cycle, over x from the film's centre, rising. */
struct dea_measured_profile {
  double voltage_V;
  struct dea_samples z;
};

/* The first columns of the history, in dea_csv_columns.values; quantities follow. */
enum { DEA_MEASURED_TIME, DEA_MEASURED_VOLTAGE, DEA_MEASURED_QUANTITIES };

struct dea_measured {
  struct dea_measurement *points;        // quantities against the voltage
  struct dea_csv_columns profile_rows;   // of all profiles
  struct dea_measured_profile *profiles; // owned, in the order of the file
  size_t profile_count;
  struct dea_csv_columns history; // times never fall; rows 0: none
  int *history_column;            // [history_count] columns of the context; owned
  size_t history_count;           // of what a history may have
};

/* True for a folder that holds measurement.csv and no results of a run. */
bool dea_measured_is_folder(const char *path);
/* Reads a folder: measurement.csv (dea_measurement_read), and where they are there profiles.csv
 * ('V (kV)', 'x (mm)', 'z (um)', 'z std (um)') and history.csv ('time (s)' and any of 'V (kV)', 'z
 * centre (um)', 'z fibre tip (um)', 'force (mN)' and of what monitors and channels that the context
 * knows show, 'hub z (um)'). A path that is no folder is the first of these
 * files alone. All errors become findings with their place; DEA_E_IO then. out: owned by the
 * caller, NULL on failure. */
dea_status dea_measured_read(struct dea_context *ctx, const char *path, struct dea_measured **out);
/* Voltages below 0 become their size, and charges and currents there turn round, for curves of a
 * model: the response of a film does not know the sign. With a note; not where they are but noise
 * about 0. */
dea_status dea_measurement_fold(struct dea_context *ctx, struct dea_measurement *points);
/* The same with the profiles; the history stays. */
dea_status dea_measured_fold(struct dea_context *ctx, struct dea_measured *measured);
void dea_measured_destroy(struct dea_context *ctx, struct dea_measured *measured);
