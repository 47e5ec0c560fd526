#include "result/columns.h"

#include <math.h>
#include <string.h>

#define COLUMN_ROW(member, si, display, factor, header, meaning)                                   \
  {#member, si, display, factor, header, meaning},
const struct dea_column dea_point_columns[DEA_LOAD_POINT_COLUMNS] = {
    DEA_LOAD_POINT_LIST(COLUMN_ROW)};
const struct dea_column dea_profile_columns[DEA_PROFILE_COLUMNS] = {DEA_PROFILE_LIST(COLUMN_ROW)};
#undef COLUMN_ROW

static const size_t offsets[DEA_LOAD_POINT_COLUMNS] = {
#define COLUMN_OFFSET(member, si, display, factor, header, meaning)                                \
  offsetof(struct dea_load_point, member),
    DEA_LOAD_POINT_LIST(COLUMN_OFFSET)
#undef COLUMN_OFFSET
};

int dea_point_column_find(const char *key)
{
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    if (strcmp(dea_point_columns[c].key, key) == 0) {
      return c;
    }
  }
  return -1;
}

double dea_point_get(const struct dea_load_point *point, int column)
{
  double value;
  memcpy(&value, (const char *)point + offsets[column], sizeof value);
  return value;
}

void dea_point_set(struct dea_load_point *point, int column, double value_si)
{
  memcpy((char *)point + offsets[column], &value_si, sizeof value_si);
}

bool dea_points_have(const struct dea_load_point *points, size_t count, int column)
{
  for (size_t i = 0; i < count; i++) {
    if (!isnan(dea_point_get(&points[i], column))) {
      return true;
    }
  }
  return false;
}

int dea_point_error_column(int column)
{
  static const char unit[] = "_m", ending[] = "_error_m";
  char key[64];
  size_t length = strlen(dea_point_columns[column].key);
  if (strcmp(dea_point_columns[column].key, "force_N") == 0) { // the mesh's is not estimated
    return dea_point_column_find("force_interpolation_error_N");
  }
  if (length < sizeof unit || length + sizeof ending > sizeof key) {
    return -1;
  }
  length -= strlen(unit);
  memcpy(key, dea_point_columns[column].key, length);
  memcpy(key + length, ending, sizeof ending);
  return dea_point_column_find(key);
}

bool dea_point_is_bound(const struct dea_load_point *point, int column)
{
  static const char *const bounded[] = {"centre_z_m", "fibre_tip_z_m", "force_N"};
  bool found = false;
  for (size_t k = 0; k < sizeof bounded / sizeof bounded[0]; k++) {
    found = found || strcmp(dea_point_columns[column].key, bounded[k]) == 0;
  }
  return found && dea_load_point_bounds(point);
}

static int get_stable(const struct dea_load_point *point)
{
  return point->stable;
}

static int get_unstable_modes(const struct dea_load_point *point)
{
  return point->unstable_modes;
}

static int get_trusted(const struct dea_load_point *point)
{
  return dea_load_point_trusted(point);
}

static int get_flags(const struct dea_load_point *point)
{
  return (int)dea_load_point_flags(point);
}

const struct dea_point_state dea_point_states[DEA_POINT_STATES] = {
    {"stable", "1: stable under voltage control, 0: not", get_stable},
    {"unstable_modes", "number of negative modes of the tangent", get_unstable_modes},
    {"trusted", "0: the numbers are not to be trusted, flags say why", get_trusted},
    {"flags", "sum of 2^k, k the place from 0 in: " DEA_FLAG_WORDS, get_flags},
};

const struct dea_point_state *dea_point_state_find(const char *key)
{
  for (int k = 0; k < DEA_POINT_STATES; k++) {
    if (strcmp(dea_point_states[k].key, key) == 0) {
      return &dea_point_states[k];
    }
  }
  return NULL;
}

static const char *const event_names[] = {
    [DEA_EVENT_PULL_IN] = "pull_in",   [DEA_EVENT_SNAP_BACK] = "snap_back",
    [DEA_EVENT_SLACK] = "slack",       [DEA_EVENT_BREAKDOWN] = "breakdown",
    [DEA_EVENT_BUCKLING] = "buckling",
};
enum { EVENT_KINDS = sizeof event_names / sizeof event_names[0] };

const char *dea_event_name(enum dea_event_kind kind)
{
  return (size_t)kind < EVENT_KINDS ? event_names[kind] : "unknown";
}

bool dea_event_find(const char *name, enum dea_event_kind *kind)
{
  for (int k = 0; k < EVENT_KINDS; k++) {
    if (strcmp(event_names[k], name) == 0) {
      *kind = (enum dea_event_kind)k;
      return true;
    }
  }
  return false;
}
