/* Columns of the quantities of load points and profiles: the same key, unit, factor and header for
 * CSV, JSON, HDF5, figures and comparisons.
 *
 * A column of load points is a number. The first DEA_LOAD_POINT_COLUMNS are the members of struct
 * dea_load_point; those that follow are of the monitors and channels of the devices that a context
 * has seen (result/observation.h), and mean the same in all of its results. */
#pragma once

#include "base/arena.h"
#include "base/text.h"
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

/* Number of the member whose key that is, or -1. */
int dea_point_column_find(const char *key);
/* Columns that a context has, members and monitors; NULL: the members alone. */
int dea_column_count(const struct dea_context *ctx);
/* One of them; lent until the context dies. */
const struct dea_column *dea_column_at(const struct dea_context *ctx, int column);
/* Number of the column of a key; of a monitor's or channel's also without its unit ("hub_z" for
 * "hub_z_m") or with the point of older versions ("hub.z_m"); -1. */
int dea_column_find(const struct dea_context *ctx, const char *key);
/* Keys of all columns, [dea_column_count]; owned by the caller, NULL on failure. */
const char **dea_column_keys(struct dea_context *ctx);
/* dea_name_hint of them; where none is near `otherwise` and their list, NULL: nothing. */
dea_status dea_column_hint(struct dea_context *ctx, const char *text, const char *otherwise,
                           char out[DEA_HINT_SIZE]);
/* Adds a column, whose texts are copied, unless there is one of that key. */
dea_status dea_column_add(struct dea_context *ctx, const struct dea_column *column, int *out);
/* Name as a part of a key: each run of ASCII characters but letters and digits is one "_". */
enum { DEA_KEY_PART_SIZE = 48 };
void dea_key_part(const char *name, char out[DEA_KEY_PART_SIZE]);

/* Values of columns that are no members; owned by an arena. */
struct dea_monitor_values {
  size_t count;
  struct dea_monitor_value {
    int column;
    double value;
  } at[];
};

/* Numbers of NAN for these columns [count]; NULL on failure. */
struct dea_monitor_values *dea_monitor_values_create(struct dea_arena *memory, const int *columns,
                                                     size_t count);
/* A copy; NULL for NULL, and on failure. */
struct dea_monitor_values *dea_monitor_values_copy(struct dea_arena *memory,
                                                   const struct dea_monitor_values *values);

/* Value of a column at a point [SI]; NAN: it has none. */
double dea_point_get(const struct dea_load_point *point, int column);
/* Of a column that is no member, only where the point has a place for it. */
void dea_point_set(struct dea_load_point *point, int column, double value_si);
/* True when at least one of the points has a number in that column. */
bool dea_points_have(const struct dea_load_point *points, size_t count, int column);

/* Key of what is said of a column by a word and in a unit: "hub_z_error_m" of "hub_z_m". */
enum { DEA_ERROR_KEY_SIZE = 128 };
void dea_column_word_key(const struct dea_column *column, const char *word, const char *si_unit,
                         char out[DEA_ERROR_KEY_SIZE]);
/* Column of the estimated error of that column, or -1. */
int dea_point_error_column(const struct dea_context *ctx, int column);
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
