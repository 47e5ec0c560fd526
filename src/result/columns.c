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

static const char *const event_names[] = {
    [DEA_EVENT_PULL_IN] = "pull_in",
    [DEA_EVENT_SNAP_BACK] = "snap_back",
    [DEA_EVENT_SLACK] = "slack",
    [DEA_EVENT_BREAKDOWN] = "breakdown",
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
