/* Tables of the quantities of load points and profiles: the same key, unit, factor and header for
 * CSV, JSON, HDF5, figures and comparisons. */
#ifndef DEA_RESULT_COLUMNS_H
#define DEA_RESULT_COLUMNS_H

#include "result/load_point.h"
#include "result/profile.h"

#define DEA_COLUMN_ONE(member, si, display, factor, header, meaning) +1
enum {
  DEA_PROFILE_COLUMNS = 0 DEA_PROFILE_LIST(DEA_COLUMN_ONE),
  DEA_LOAD_POINT_COLUMNS = 0 DEA_LOAD_POINT_LIST(DEA_COLUMN_ONE),
};
#undef DEA_COLUMN_ONE

/* key: member name; display value = factor * SI value. Header in files: "header (unit)", without
 * the parentheses for the unit "1". */
struct dea_column {
  const char *key, *si_unit, *display_unit;
  double factor;
  const char *header, *meaning;
};

/* Tables in the order of the lists; static storage. */
extern const struct dea_column dea_point_columns[DEA_LOAD_POINT_COLUMNS];
extern const struct dea_column dea_profile_columns[DEA_PROFILE_COLUMNS];

/* Number of the column whose key that is, or -1. */
int dea_point_column_find(const char *key);
/* Value of a column at a point [SI]; column < DEA_LOAD_POINT_COLUMNS. */
double dea_point_get(const struct dea_load_point *point, int column);
void dea_point_set(struct dea_load_point *point, int column, double value_si);
/* True when at least one of the points has a number in that column. */
bool dea_points_have(const struct dea_load_point *points, size_t count, int column);

/* Column of the estimated error of that column, or -1. */
int dea_point_error_column(int column);
/* Whether the number in that column is an upper bound and no prediction: z and force of a point
 * with DEA_FLAG_BOUND. */
bool dea_point_is_bound(const struct dea_load_point *point, int column);

/* What of a point is no quantity: whole numbers, the same key in CSV, JSON, HDF5 and dea.h. */
struct dea_point_state {
  const char *key, *meaning;
  int (*get)(const struct dea_load_point *point);
};
enum { DEA_POINT_STATES = 4 }; // stable, unstable_modes, trusted, flags (a sum of powers of two)
extern const struct dea_point_state dea_point_states[DEA_POINT_STATES];
/* The one of that key, or NULL. */
const struct dea_point_state *dea_point_state_find(const char *key);

/* Names of the kinds of events in files: "pull_in", "snap_back", "slack", "breakdown". */
const char *dea_event_name(enum dea_event_kind kind);
/* Kind of that name; false when there is none. */
bool dea_event_find(const char *name, enum dea_event_kind *kind);

#endif
