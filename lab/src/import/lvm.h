/* Inside of the reader of .lvm: channels, their clocks, and the table that they become. */
#pragma once

#include "import/import.h"
#include "table/slices.h"

enum { DEA_LVM_CHANNELS_MAX = 1024 };

enum dea_lvm_x { DEA_LVM_X_NONE, DEA_LVM_X_ONE, DEA_LVM_X_MULTI }; // columns of times

struct dea_lvm_channel {
  struct dea_slice name, unit;
  // of the segment
  double x0, delta, clock_s; // start and step [s], time of day; NAN: not given
  double day;                // its date, since 1970; NAN: not given
  size_t samples;            // 0: not given
  double shift_s;            // what is added to its times
  double end_s;              // half a step behind its last sample
  // of a row
  double x_now, y_now;
  bool present;
  // of all
  double start_s, interval_s; // of the first segment
  double last_s;              // latest time
  double first_clock_s, first_day;
  size_t total;
  size_t missing;          // rows without it since the last one with it
  bool gap;                // a segment does not go on where the one before ended
  size_t column, x_column; // of the table; SIZE_MAX: none
};

struct dea_lvm {
  struct dea_context *ctx;
  const char *file;
  struct dea_table *table;
  struct dea_lines lines;
  char separator, decimal;
  enum dea_lvm_x x;
  bool headings;         // each segment has a header
  bool first_empty;      // rows begin with the field of times, also when it is empty
  bool not_time;         // X is something else
  bool filling;          // second time: values are kept
  bool shared, own;      // one column of times for all channels, or one for each
  bool differ;           // the clocks of the channels
  size_t stride;         // fields a channel in the header of a segment
  size_t rows, x_column; // of that
  size_t segments, row, count;
  struct dea_lvm_channel channels[DEA_LVM_CHANNELS_MAX]; // [count]
};

/* "13:05:07,25" in seconds; NAN for anything else. */
double dea_lvm_time_of_day(struct dea_slice text, char decimal);
/* "2026/03/02" in days since 1970; NAN for anything else. */
double dea_lvm_day(struct dea_slice text);
/* Before the rows of a segment, whose header was read. */
void dea_lvm_begin_segment(struct dea_lvm *lvm);
/* Counts, or keeps, the row whose numbers are in the channels; row: within the segment. */
void dea_lvm_keep_row(struct dea_lvm *lvm, size_t row);
/* Between counting and keeping. */
dea_status dea_lvm_add_columns(struct dea_lvm *lvm);
