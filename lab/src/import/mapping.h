/* A mapping as it was read. */
#pragma once

#include "import/import.h"

enum { DEA_MAPPED_MAX = 32, DEA_IGNORED_MAX = 64, DEA_MAPPING_VERSION = 1 };

/* A column that becomes a channel. */
struct dea_mapped {
  struct dea_label column, name, unit, per_unit, at_zero, time;
  struct dea_choice as; // enum dea_channel_kind
  struct dea_quantity filter_Hz;
};

struct dea_mapping {
  const char *file; // interned
  struct dea_quantity version, rate_Hz;
  struct dea_label title, time, time_unit;
  struct dea_mapped columns[DEA_MAPPED_MAX];
  size_t column_count;
  bool has_profile;
  struct {
    struct dea_label columns, unit, per_unit, at_zero, x, x_unit, time;
    struct dea_quantity x_from_m, x_to_m;
  } profile;
  struct dea_label ignore[DEA_IGNORED_MAX];
  size_t ignore_count;
  struct dea_yaml *document; // owned
};

/* Whether a column's name is meant: letters of either case; '*' is any text when `pattern`. */
bool dea_mapping_matches(const char *name, const char *wanted, bool pattern);
