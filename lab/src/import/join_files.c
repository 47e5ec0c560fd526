/* Several files of one measurement as one table. */
#include "import/sample_times.h"

#include <math.h>
#include <string.h>

/* What a table's samples are counted by. */
struct table_clock {
  struct dea_clock clock;
  size_t column;   // of the times; the table's count: none
  double origin_s; // that they count from; NAN: not known
  bool known;
};

static dea_status find_clock(struct dea_context *ctx, const struct dea_table *table,
                             struct table_clock *out)
{
  *out = (struct table_clock){.column = table->column_count, .origin_s = NAN};
  struct dea_column_role *roles = dea_alloc(ctx, table->column_count, sizeof *roles);
  dea_status status = roles != NULL ? dea_table_roles(ctx, table, NULL, roles) : DEA_E_MEMORY;
  for (size_t i = 0; status == DEA_OK && i < table->column_count && !out->known; i++) {
    const struct dea_table_column *column = &table->columns[i];
    if (roles[i].use == DEA_USE_TIME) {
      out->column = i;
      out->origin_s = column->origin_s;
      out->known = true;
      status = dea_clock_read(ctx, table, i, roles[i].factor, &out->clock);
    } else if (column->interval > 0) {
      out->known = true;
      out->clock = (struct dea_clock){.start_s = column->start, .interval_s = column->interval};
      out->clock.count = column->count;
    } else if (column->count > out->clock.count) {
      out->clock.count = column->count; // no clock: at least as many samples
    }
  }
  dea_free(ctx, roles);
  return status;
}

static dea_status move(struct dea_context *ctx, struct dea_table *table, struct dea_table *other,
                       size_t times)
{
  size_t count = table->column_count + other->column_count;
  if (count > DEA_TABLE_COLUMNS_MAX) {
    return dea_fail(ctx, DEA_E_IO, "'%s' and '%s' have more than %d columns together", table->file,
                    other->file, (int)DEA_TABLE_COLUMNS_MAX);
  }
  void *moved = dea_resize(ctx, table->columns, count, sizeof *table->columns);
  DEA_TRY_MEMORY(moved != NULL);
  table->columns = moved;
  table->column_room = count;
  size_t before = table->column_count;
  for (size_t i = 0; i < other->column_count; i++) {
    struct dea_table_column *column = &other->columns[i];
    if (i == times) { // they are those of the first file
      dea_free(ctx, column->name);
      dea_free(ctx, column->unit);
      dea_free(ctx, column->values);
      continue;
    }
    if (column->clock > 0 && column->clock != times + 1) {
      column->clock += before - (column->clock > times + 1);
    } else {
      column->clock = 0;
    }
    table->columns[table->column_count++] = *column;
  }
  other->column_count = 0;
  return DEA_OK;
}

/* Whether times that count from two moments begin together, as far as that is known: what one file
 * has without a date is compared with the other's time of day. */
static bool begin_together(const struct table_clock *a, const struct table_clock *b)
{
  static const double day_s = 86400;
  double off_s = a->origin_s - b->origin_s, step_s = a->clock.interval_s;
  if (fmin(a->origin_s, b->origin_s) < day_s) {
    off_s = remainder(off_s, day_s);
  }
  if (a->clock.time_s != NULL) {
    step_s = a->clock.count > 1 ? a->clock.time_s[1] - a->clock.time_s[0] : 0;
  }
  return !(fabs(off_s) > 1e-3 * step_s); // true of NAN
}

static bool is_same(const struct dea_table_column *a, const struct dea_table_column *b)
{
  return a->count == b->count && a->count > 1 && strcmp(a->name, b->name) == 0 &&
         dea_samples_same(a->values, b->values, a->count);
}

/* Whether all columns of the other but its times are there already: a file that is named twice, or
 * its copy. Some may be: two tables count their rows. */
static bool has_all(const struct dea_table *table, const struct dea_table *other, size_t times)
{
  bool all = true;
  for (size_t k = 0; k < other->column_count && all; k++) {
    bool found = k == times || other->columns[k].count < 2; // a rate tells nothing
    for (size_t i = 0; i < table->column_count && !found; i++) {
      found = is_same(&table->columns[i], &other->columns[k]);
    }
    all = found;
  }
  return all;
}

static dea_status join_same(struct dea_context *ctx, struct dea_table *table,
                            struct dea_table *other, size_t times)
{
  const struct dea_location location = {.file = other->file};
  if (has_all(table, other, times)) {
    return dea_fail(ctx, DEA_E_IO, "what '%s' has is in '%s' already, value by value", other->file,
                    table->file);
  }
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, location,
                               "its samples are taken at the times of '%s', which has as many",
                               table->file));
  return move(ctx, table, other, times);
}

dea_status dea_table_join(struct dea_context *ctx, struct dea_table *table, struct dea_table *other)
{
  struct table_clock a = {0}, b = {0};
  dea_status status = find_clock(ctx, table, &a);
  status = status == DEA_OK ? find_clock(ctx, other, &b) : status;
  if (status == DEA_OK) {
    bool both = !isnan(a.origin_s) && !isnan(b.origin_s) && table->format == other->format;
    bool same = a.known && b.known
                    ? dea_clock_same(&a.clock, &b.clock) && (!both || begin_together(&a, &b))
                : a.known == b.known ? a.clock.count == b.clock.count
                                     : false;
    status = same
                 ? join_same(ctx, table, other, b.column)
                 : dea_fail(ctx, DEA_E_IO,
                            "'%s' and '%s' have different clocks (%zu samples from %.12g s and %zu "
                            "from %.12g s): import each into a recording of its own, and join "
                            "them (dea recording A.h5 --with B.h5 --after TIME -o C.h5, where "
                            "TIME is what A's clock shows at the 0 of B's)",
                            table->file, other->file, a.clock.count,
                            a.clock.start_s + (both ? a.origin_s : 0), b.clock.count,
                            b.clock.start_s + (both ? b.origin_s : 0));
  }
  dea_free(ctx, a.clock.time_s);
  dea_free(ctx, b.clock.time_s);
  return status;
}
