#include "import/lvm.h"

#include "table/clock_text.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static const double day_s = 86400;

double dea_lvm_time_of_day(struct dea_slice text, char decimal)
{
  double sum = 0, value;
  for (int part = 0; part < 3; part++) {
    size_t n = dea_slice_find(text, ":");
    struct dea_slice number = {text.text, n};
    if ((n == text.length) != (part == 2) || number.length == 0 ||
        !dea_slice_number(number, decimal, &value) || !(value >= 0 && value < 61)) {
      return NAN;
    }
    sum = 60 * sum + value;
    text = (struct dea_slice){text.text + n + 1, part < 2 ? text.length - n - 1 : 0};
  }
  return sum;
}

double dea_lvm_day(struct dea_slice text)
{
  char moment[40];
  double days, seconds;
  bool dated;
  snprintf(moment, sizeof moment, "%.*s 00:00:00", (int)(text.length < 20 ? text.length : 20),
           text.text);
  const struct dea_slice whole = {moment, strlen(moment)};
  return dea_clock_text(whole, &days, &seconds, &dated) && dated ? days : NAN;
}

/* Seconds of the segment's clock after that of the first segment; 0 when it is not known. Without
 * dates it is taken to be less than half a day before that, or after midnight. */
static double later(const struct dea_lvm_channel *channel)
{
  double days = channel->day - channel->first_day;
  double s = channel->clock_s - channel->first_clock_s + (isnan(days) ? 0 : days * day_s);
  return isnan(s) ? 0 : s < -day_s / 2 ? s + day_s : s;
}

void dea_lvm_begin_segment(struct dea_lvm *lvm)
{
  for (size_t i = 0; i < lvm->count; i++) {
    struct dea_lvm_channel *channel = &lvm->channels[i];
    if (lvm->segments == 0) {
      channel->first_clock_s = channel->clock_s;
      channel->first_day = channel->day;
      channel->start_s = channel->x0;
      channel->interval_s = channel->delta;
      channel->last_s = -INFINITY;
      channel->missing = 0;
      channel->total = lvm->filling ? channel->total : 0;
    }
    channel->shift_s = later(channel);
    lvm->differ = lvm->differ || channel->x0 != lvm->channels[0].x0 ||
                  channel->delta != lvm->channels[0].delta ||
                  channel->shift_s != lvm->channels[0].shift_s;
    if (lvm->x == DEA_LVM_X_NONE && lvm->segments > 0) {
      // behind the end of the one before: its start goes on by itself
      channel->shift_s = channel->x0 > channel->end_s ? 0 : channel->shift_s;
      double due = channel->start_s + (double)channel->total * channel->interval_s;
      double start = channel->x0 + channel->shift_s;
      channel->gap = channel->gap || !(fabs(start - due) <= channel->interval_s / 2) ||
                     fabs(channel->delta - channel->interval_s) > 1e-9 * channel->interval_s;
    }
    channel->end_s = channel->x0 + channel->shift_s - 0.5 * channel->delta;
  }
}

/* Time of a row of a channel; rows of a segment that begins at 0 again come after its clock. */
static double row_time(const struct dea_lvm *lvm, struct dea_lvm_channel *channel, size_t row)
{
  if (lvm->x == DEA_LVM_X_NONE) {
    return channel->x0 + (double)row * channel->delta + channel->shift_s;
  }
  if (row == 0 && channel->x_now > channel->last_s) {
    channel->shift_s = 0; // its times go on by themselves
  }
  return channel->x_now + channel->shift_s;
}

static void add(struct dea_lvm *lvm, size_t column, double value, size_t capacity)
{
  if (column != SIZE_MAX && lvm->table->columns[column].count < capacity) {
    lvm->table->columns[column].values[lvm->table->columns[column].count++] = value;
  }
}

/* The times that all channels share. */
static void keep_shared_time(struct dea_lvm *lvm, size_t row)
{
  struct dea_lvm_channel *first = &lvm->channels[0];
  double time = row_time(lvm, first, row);
  first->last_s = fmax(first->last_s, time);
  if (lvm->filling) {
    add(lvm, lvm->x_column, time, lvm->rows);
  } else {
    lvm->rows++;
  }
}

void dea_lvm_keep_row(struct dea_lvm *lvm, size_t row)
{
  bool own = lvm->x == DEA_LVM_X_MULTI || lvm->own;
  if (!own) {
    keep_shared_time(lvm, row);
  }
  for (size_t i = 0; i < lvm->count; i++) {
    struct dea_lvm_channel *channel = &lvm->channels[i];
    bool beyond = lvm->headings && channel->samples > 0 && row >= channel->samples;
    bool present = channel->present && !beyond;
    if (beyond && !(lvm->filling && lvm->shared)) {
      continue;
    }
    if (present) {
      channel->end_s = channel->x0 + channel->shift_s + ((double)row + 0.5) * channel->delta;
    }
    if (!lvm->filling) { // what is missing at the end does not count
      channel->total += present ? channel->missing + 1 : 0;
      channel->missing = present ? 0 : channel->missing + 1;
    } else {
      add(lvm, channel->column, present ? channel->y_now : NAN, channel->total);
    }
    if (own) {
      double time = row_time(lvm, channel, row);
      channel->last_s = fmax(channel->last_s, time);
      add(lvm, lvm->filling ? channel->x_column : SIZE_MAX, time, channel->total);
    }
  }
}

/* A column for times; *column its index. */
static dea_status add_times(struct dea_lvm *lvm, const char *name, size_t capacity, size_t *column)
{
  const char *unit = lvm->not_time ? "" : "s";
  *column = lvm->table->column_count;
  return dea_table_add(lvm->ctx, lvm->table, name, strlen(name), unit, strlen(unit), capacity) !=
                 NULL
             ? DEA_OK
             : dea_context_status(lvm->ctx);
}

static dea_status add_column(struct dea_lvm *lvm, size_t i)
{
  struct dea_lvm_channel *channel = &lvm->channels[i];
  char number[32], times[32] = "X_Value";
  struct dea_slice name = channel->name;
  channel->total = lvm->shared ? lvm->rows : channel->total;
  if (lvm->own) {
    if (i > 0) {
      snprintf(times, sizeof times, "X_Value %zu", i + 1);
    }
    DEA_TRY(lvm->ctx, add_times(lvm, times, channel->total, &channel->x_column));
  }
  if (name.length == 0) {
    snprintf(number, sizeof number, "channel %zu", i + 1);
    name = (struct dea_slice){number, strlen(number)};
  }
  channel->column = lvm->table->column_count;
  struct dea_table_column *column =
      dea_table_add(lvm->ctx, lvm->table, name.text, name.length, channel->unit.text,
                    channel->unit.length, channel->total);
  if (column == NULL) {
    return dea_context_status(lvm->ctx);
  }
  size_t clock = lvm->shared ? lvm->x_column : channel->x_column;
  if (clock != SIZE_MAX && !lvm->not_time) {
    column->clock = clock + 1;
  } else if (clock == SIZE_MAX) {
    column->start = channel->start_s;
    column->interval = channel->interval_s > 0 ? channel->interval_s : NAN;
  }
  return DEA_OK;
}

dea_status dea_lvm_add_columns(struct dea_lvm *lvm)
{
  bool gap = false;
  for (size_t i = 0; i < lvm->count; i++) {
    gap = gap || (lvm->channels[i].gap && lvm->channels[i].interval_s > 0);
    lvm->channels[i].x_column = SIZE_MAX;
    lvm->channels[i].column = SIZE_MAX;
  }
  lvm->filling = true;
  bool timed = lvm->x == DEA_LVM_X_NONE && gap;
  lvm->own = lvm->x == DEA_LVM_X_MULTI || (timed && lvm->differ);
  lvm->shared = lvm->x == DEA_LVM_X_ONE || (timed && !lvm->differ);
  lvm->x_column = SIZE_MAX;
  DEA_TRY(lvm->ctx, lvm->shared ? add_times(lvm, "X_Value", lvm->rows, &lvm->x_column) : DEA_OK);
  for (size_t i = 0; i < lvm->count; i++) {
    DEA_TRY(lvm->ctx, lvm->channels[i].total > 0 ? add_column(lvm, i) : DEA_OK);
  }
  if (timed) {
    const struct dea_location location = {.file = lvm->file};
    return dea_finding_add(lvm->ctx, DEA_NOTE, location,
                           "its %zu segments do not follow one another without a gap: every sample "
                           "gets its time",
                           lvm->segments);
  }
  return DEA_OK;
}
