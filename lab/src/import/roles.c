/* What each column of a table is for: as the mapping says, or as names and units make believe. */
#include "base/text.h"
#include "base/units.h"
#include "import/mapping.h"
#include "table/titles.h"
#include "table/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MATRIX_CHANNELS = 8 }; // more columns of one matrix are hardly channels

static const char odd_unit[] = "its unit is not known: say it in a mapping";

struct work {
  struct dea_context *ctx;
  const struct dea_table *table;
  const struct dea_mapping *mapping;
  struct dea_column_role *roles;
  size_t errors;
};

const char *dea_role_name(const struct dea_column_role *role)
{
  switch (role->use) {
  case DEA_USE_TIME:
    return "time";
  case DEA_USE_CLOCK:
    return "clock";
  case DEA_USE_CHANNEL:
    return dea_channel_names[role->kind];
  case DEA_USE_PROFILE:
    return "profile";
  case DEA_USE_POSITION:
    return "place";
  default:
    return "left";
  }
}

// Scales -----------------------------------------------------------------------------------------

/* What a mapping says of a column's numbers; members may be NULL. */
struct scale_text {
  const struct dea_label *unit, *per_unit, *at_zero;
};

static bool is_given(const struct dea_label *label)
{
  return label != NULL && label->text[0] != '\0';
}

/* A whole text as a number without unit. */
static bool bare_number(const char *text, double *value)
{
  struct dea_slice slice = {text, strlen(text)};
  return dea_slice_number(slice, '.', value) && *value == *value;
}

/* A quantity of the mapping: "1 kV", or a number of the column's unit. */
static dea_status read_quantity(struct dea_context *ctx, const struct dea_label *label,
                                const char *key, const char *si, double unit, double *value,
                                bool *good)
{
  char why[DEA_WHY_SIZE], example[40];
  double number;
  if (bare_number(label->text, &number)) {
    *value = number * unit;
    return DEA_OK;
  }
  snprintf(example, sizeof example, "1 %s", si);
  const struct dea_measure due = {si[0] != '\0' ? si : "1", si[0] != '\0' ? example : "1"};
  if (dea_units_read(ctx, label->text, due, value, why)) {
    return DEA_OK;
  }
  *good = false;
  if (why[0] == '\0') {
    return dea_context_status(ctx);
  }
  return dea_finding_add(ctx, DEA_ERROR, label->location, "%s: %s", key, why);
}

/* Factor of the unit; 0: of another dimension than due, 1 without a unit. */
static dea_status read_unit(struct dea_context *ctx, const struct dea_table_column *column,
                            const char *si, const struct dea_label *given, double *factor)
{
  const char *unit = is_given(given) ? given->text : column->unit;
  *factor = 1;
  if (unit[0] == '\0' || si[0] == '\0') {
    return DEA_OK;
  }
  const char *found = dea_title_unit(ctx, unit, factor);
  if (found == NULL && dea_context_status(ctx) != DEA_OK) {
    return dea_context_status(ctx);
  }
  if (found == NULL || strcmp(found, si) != 0) {
    *factor = 0;
  }
  return DEA_OK;
}

/* SI value = value * factor + offset, from the column's unit and what the mapping says. si: the
 * unit due, "": none in particular. Errors are findings at the mapping's values, or at `location`
 * for the file's unit; *good false then. */
static dea_status find_scale(struct dea_context *ctx, const struct dea_table_column *column,
                             const char *si, const struct scale_text *text,
                             struct dea_location location, double *factor, double *offset,
                             bool *good)
{
  double unit, number;
  *good = true;
  *offset = 0;
  dea_context_clear(ctx);
  DEA_TRY(ctx, read_unit(ctx, column, si, text->unit, &unit));
  bool says = is_given(text->per_unit) && !bare_number(text->per_unit->text, &number);
  if (unit == 0 && is_given(text->unit)) {
    *good = false;
    return dea_finding_add(ctx, DEA_ERROR, text->unit->location,
                           "'%.40s' is no unit that becomes %s; what 1 in the column stands for is "
                           "said by per_unit, such as '1 %s'",
                           text->unit->text, si, si);
  }
  if (unit == 0 && !says) {
    *good = false;
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "the column '%.60s' is in '%.40s', not in %s: say what 1 of that stands "
                           "for in a mapping (per_unit: 1 %s)",
                           column->name, column->unit, si, si);
  }
  *factor = unit;
  if (is_given(text->per_unit)) {
    DEA_TRY(ctx, read_quantity(ctx, text->per_unit, "per_unit", si, unit, factor, good));
    if (*good && *factor == 0) {
      *good = false;
      return dea_finding_add(ctx, DEA_ERROR, text->per_unit->location, "per_unit must not be 0");
    }
  }
  if (is_given(text->at_zero)) {
    DEA_TRY(ctx, read_quantity(ctx, text->at_zero, "at_zero", si, unit, offset, good));
  }
  return DEA_OK;
}

// By the mapping ---------------------------------------------------------------------------------

/* Column of that name, or the table's count after an error with the nearest name. */
static dea_status find_column(struct work *work, const struct dea_label *wanted, size_t *out)
{
  const struct dea_table *table = work->table;
  const char *names[256];
  size_t count = table->column_count < 256 ? table->column_count : 256;
  for (*out = 0; *out < table->column_count; ++*out) {
    if (strcmp(table->columns[*out].name, wanted->text) == 0) {
      return DEA_OK;
    }
  }
  for (*out = 0; *out < table->column_count; ++*out) {
    if (dea_mapping_matches(table->columns[*out].name, wanted->text, false)) {
      return DEA_OK;
    }
  }
  for (size_t i = 0; i < table->left_count; i++) {
    const struct dea_table_left *left = &table->left[i];
    if (dea_mapping_matches(left->name, wanted->text, false)) {
      work->errors++;
      return dea_finding_add(
          work->ctx, DEA_ERROR, (struct dea_location){table->file, left->line, 0},
          "'%.60s' of the column '%.60s' is not a number", left->field, left->name);
    }
  }
  for (size_t i = 0; i < count; i++) {
    names[i] = table->columns[i].name;
  }
  const char *nearest = dea_nearest_name(wanted->text, names, count);
  work->errors++;
  return dea_finding_add(work->ctx, DEA_ERROR, wanted->location,
                         "'%s' has no column '%.80s'; %s%.80s%s", table->file, wanted->text,
                         nearest != NULL ? "did you mean '" : "dea import --list shows what it has",
                         nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

/* Gives a column a use; an error when it has another one. */
static dea_status read_column(struct work *work, size_t column, enum dea_column_use use,
                              struct dea_location location)
{
  struct dea_column_role *role = &work->roles[column];
  if (role->use != DEA_USE_LEFT && role->use != use) {
    work->errors++;
    return dea_finding_add(work->ctx, DEA_ERROR, location,
                           "the column '%.60s' is taken as %s already",
                           work->table->columns[column].name, dea_role_name(role));
  }
  role->use = use;
  role->why = "by the mapping";
  return DEA_OK;
}

/* Scale of a column; counts an error. */
static dea_status scale(struct work *work, size_t column, const char *si,
                        const struct scale_text *text, struct dea_location location)
{
  struct dea_column_role *role = &work->roles[column];
  bool good;
  DEA_TRY(work->ctx, find_scale(work->ctx, &work->table->columns[column], si, text, location,
                                &role->factor, &role->offset, &good));
  work->errors += !good;
  return DEA_OK;
}

/* The column of times that a key names. */
static dea_status read_time(struct work *work, const struct dea_label *name, size_t *clock)
{
  const struct scale_text text = {.unit = &work->mapping->time_unit};
  size_t column;
  DEA_TRY(work->ctx, find_column(work, name, &column));
  if (column == work->table->column_count) {
    return DEA_OK;
  }
  *clock = column + 1;
  DEA_TRY(work->ctx, read_column(work, column, DEA_USE_TIME, name->location));
  return scale(work, column, "s", &text, name->location);
}

static dea_status read_channel(struct work *work, const struct dea_mapped *mapped)
{
  const struct scale_text text = {&mapped->unit, &mapped->per_unit, &mapped->at_zero};
  size_t column;
  DEA_TRY(work->ctx, find_column(work, &mapped->column, &column));
  if (column == work->table->column_count) {
    return DEA_OK;
  }
  DEA_TRY(work->ctx, read_column(work, column, DEA_USE_CHANNEL, mapped->column.location));
  struct dea_column_role *role = &work->roles[column];
  role->kind = (enum dea_channel_kind)mapped->as.value;
  DEA_TRY(work->ctx, scale(work, column, dea_channel_meanings[role->kind].si_unit, &text,
                           mapped->column.location));
  return mapped->time.text[0] != '\0' ? read_time(work, &mapped->time, &role->clock) : DEA_OK;
}

static dea_status read_profile(struct work *work)
{
  const struct dea_mapping *mapping = work->mapping;
  const struct scale_text text = {&mapping->profile.unit, &mapping->profile.per_unit,
                                  &mapping->profile.at_zero};
  const struct dea_label *pattern = &mapping->profile.columns;
  size_t found = 0, clock = 0, errors = work->errors;
  if (mapping->profile.time.text[0] != '\0') {
    DEA_TRY(work->ctx, read_time(work, &mapping->profile.time, &clock));
  }
  if (mapping->profile.x.text[0] != '\0') {
    const struct scale_text x_text = {.unit = &mapping->profile.x_unit};
    size_t column;
    DEA_TRY(work->ctx, find_column(work, &mapping->profile.x, &column));
    if (column < work->table->column_count) {
      DEA_TRY(work->ctx, read_column(work, column, DEA_USE_POSITION, mapping->profile.x.location));
      DEA_TRY(work->ctx, scale(work, column, "m", &x_text, mapping->profile.x.location));
    }
  }
  for (size_t i = 0; i < work->table->column_count && work->errors == errors; i++) {
    // a column that another key names is none of its points
    if (work->roles[i].use == DEA_USE_LEFT &&
        dea_mapping_matches(work->table->columns[i].name, pattern->text, true)) {
      DEA_TRY(work->ctx, read_column(work, i, DEA_USE_PROFILE, pattern->location));
      DEA_TRY(work->ctx, scale(work, i, "m", &text, pattern->location));
      work->roles[i].clock = clock;
      found++;
    }
  }
  if (found < 2 && work->errors == errors) {
    work->errors++;
    return dea_finding_add(work->ctx, DEA_ERROR, pattern->location,
                           "'%.60s' names %zu column%s of '%s', and a profile has at least 2",
                           pattern->text, found, found == 1 ? "" : "s", work->table->file);
  }
  return DEA_OK;
}

static dea_status read_mapping(struct work *work, size_t *clock)
{
  const struct dea_mapping *mapping = work->mapping;
  if (mapping->time.text[0] != '\0') {
    DEA_TRY(work->ctx, read_time(work, &mapping->time, clock));
  }
  for (size_t i = 0; i < mapping->column_count; i++) {
    DEA_TRY(work->ctx, read_channel(work, &mapping->columns[i]));
  }
  return DEA_CHAIN(work->ctx, mapping->has_profile ? read_profile(work) : DEA_OK);
}

// Guessing ---------------------------------------------------------------------------------------

int dea_guess_by_name(const char *name)
{
  static const int kinds[] = {
      [DEA_WORD_NONE] = DEA_GUESS_NOTHING,      [DEA_WORD_TIME] = DEA_GUESS_TIME,
      [DEA_WORD_COMMAND] = DEA_CHANNEL_COMMAND, [DEA_WORD_VOLTAGE] = DEA_CHANNEL_VOLTAGE,
      [DEA_WORD_CURRENT] = DEA_CHANNEL_CURRENT, [DEA_WORD_DISPLACEMENT] = DEA_CHANNEL_DISPLACEMENT,
      [DEA_WORD_FORCE] = DEA_CHANNEL_FORCE,     [DEA_WORD_UNCERTAINTY] = DEA_GUESS_UNCERTAINTY,
  };
  return kinds[dea_word_of_quantity(name)];
}

/* si: SI unit of the column's unit. */
static int guess_by_unit(const char *name, const char *si)
{
  if (strcmp(si, "s") == 0) {
    return DEA_GUESS_TIME;
  }
  if (dea_word_find(name, DEA_WORD_POSITION, DEA_WORD_POSITION) != DEA_WORD_NONE) {
    return DEA_GUESS_NOTHING; // where something is, not how it moves
  }
  for (int k = DEA_CHANNEL_VOLTAGE; k < DEA_CHANNEL_OTHER; k++) {
    if (strcmp(si, dea_channel_meanings[k].si_unit) == 0) {
      return k;
    }
  }
  return DEA_GUESS_NOTHING;
}

/* Whether all numbers of a column are one: an exposure in ms is no clock. */
static bool is_constant(const struct dea_table_column *column)
{
  double low = NAN, high = NAN;
  for (size_t i = 0; i < column->count; i++) {
    low = fmin(low, column->values[i]); // not NAN
    high = fmax(high, column->values[i]);
  }
  return low == high;
}

/* A guessed column of times, in the mapping's unit of times where it has one; with a rate it is
 * said that these times are not used. */
static dea_status read_guessed_time(struct work *work, size_t i)
{
  const struct dea_mapping *mapping = work->mapping;
  if (mapping != NULL && !isnan(mapping->rate_Hz.si)) {
    work->roles[i].use = DEA_USE_LEFT;
    return dea_finding_add(work->ctx, DEA_WARNING, mapping->rate_Hz.location,
                           "the rate is taken in place of the times '%.60s' of '%s': samples "
                           "begin at 0",
                           work->table->columns[i].name, work->table->file);
  }
  if (mapping != NULL && mapping->time_unit.text[0] != '\0' &&
      work->table->columns[i].unit[0] == '\0') {
    const struct scale_text text = {.unit = &mapping->time_unit};
    return scale(work, i, "s", &text, mapping->time_unit.location);
  }
  return DEA_OK;
}

/* Times and clocks, which are guessed also beside a mapping that names none. */
static dea_status guess_times(struct work *work)
{
  for (size_t i = 0; i < work->table->column_count; i++) {
    const struct dea_table_column *column = &work->table->columns[i];
    struct dea_column_role *role = &work->roles[i];
    double factor = 1;
    if (role->use != DEA_USE_LEFT) {
      continue;
    }
    if (column->unit[0] == '\0' && dea_title_has_odd_unit(column->name)) {
      role->why = odd_unit;
      continue;
    }
    enum dea_word clock = dea_word_clock(column->name);
    const char *si = dea_title_unit(work->ctx, column->unit, &factor);
    if (column->count == 1 && clock != DEA_WORD_NONE) {
      bool rate = clock == DEA_WORD_RATE;
      bool good = column->unit[0] == '\0' || (si != NULL && strcmp(si, rate ? "Hz" : "s") == 0);
      if (good) {
        role->use = DEA_USE_CLOCK;
        role->factor = column->unit[0] != '\0' ? factor : 1;
        role->why = rate                         ? "samples a second"
                    : clock == DEA_WORD_INTERVAL ? "time between samples"
                                                 : "time of the first sample";
      }
      continue;
    }
    int kind = dea_guess_by_name(column->name);
    bool named = kind == DEA_GUESS_TIME;
    bool seconds = kind != DEA_GUESS_UNCERTAINTY && si != NULL && strcmp(si, "s") == 0;
    if (column->count > 1 && (seconds || (named && column->unit[0] == '\0')) &&
        !is_constant(column)) {
      role->use = DEA_USE_TIME;
      role->factor = seconds ? factor : 1;
      role->why = seconds ? "by its unit" : "by its name, in s";
      DEA_TRY(work->ctx, read_guessed_time(work, i));
    }
  }
  return DEA_OK;
}

/* Whether a column is one of many of a matrix, "z(17)". */
static bool is_of_matrix(const struct work *work, size_t i)
{
  const char *name = work->table->columns[i].name, *open = strrchr(name, '(');
  size_t family = 0;
  for (size_t k = 0; open != NULL && k < work->table->column_count; k++) {
    family += strncmp(work->table->columns[k].name, name, (size_t)(open - name) + 1) == 0;
  }
  return family > MATRIX_CHANNELS;
}

static void guess_channel(struct work *work, size_t i)
{
  const struct dea_table_column *column = &work->table->columns[i];
  struct dea_column_role *role = &work->roles[i];
  double factor = 1;
  const char *si = dea_title_unit(work->ctx, column->unit, &factor);
  int kind = dea_guess_by_name(column->name);
  if (role->use != DEA_USE_LEFT || column->count < 2 || role->why == odd_unit) {
    return;
  }
  if (kind == DEA_GUESS_UNCERTAINTY) {
    role->why = "by its name an uncertainty of something; if it is not, say so in a mapping";
    return;
  }
  if (is_of_matrix(work, i)) {
    role->why = "a profile? say so in a mapping";
    return;
  }
  bool named = kind >= 0;
  if (named && column->unit[0] != '\0' &&
      (si == NULL || strcmp(si, dea_channel_meanings[kind].si_unit) != 0)) {
    bool volts = si != NULL && strcmp(si, "V") == 0;
    role->why = volts ? "a sensor's voltage: say per_unit in a mapping"
                      : "its unit does not fit its name: say what it is in a mapping";
    return;
  }
  if (!named && si != NULL) {
    kind = guess_by_unit(column->name, si);
  }
  if (kind < 0) {
    return;
  }
  role->use = DEA_USE_CHANNEL;
  role->kind = (enum dea_channel_kind)kind;
  role->factor = factor;
  role->why = !named                    ? "by its unit"
              : column->unit[0] != '\0' ? "by its name and unit"
                                        : "by its name; no unit, taken as SI";
}

// Clocks -----------------------------------------------------------------------------------------

/* Bytes of a name that say which struct or group it is of: "run.time", "Bench/ai0". */
static size_t group_length(const char *name)
{
  size_t length = 0;
  for (size_t i = 0; name[i] != '\0'; i++) {
    length = name[i] == '.' || name[i] == '/' ? i + 1 : length;
  }
  return length;
}

static bool is_of_group(const char *name, const char *other)
{
  size_t length = group_length(name);
  return length == group_length(other) && strncmp(name, other, length) == 0;
}

/* The column of times that goes with column i, of its length: the last one before it of its own
 * group, else the last one before it, else any. */
static size_t find_clock(const struct work *work, size_t i)
{
  const struct dea_table *table = work->table;
  const struct dea_table_column *column = &table->columns[i];
  size_t clock = 0, own = 0;
  for (size_t k = 0; k < table->column_count; k++) {
    const struct dea_table_column *times = &table->columns[k];
    if (work->roles[k].use != DEA_USE_TIME || times->count != column->count) {
      continue;
    }
    clock = clock == 0 || k < i ? k + 1 : clock;
    if (is_of_group(times->name, column->name)) {
      own = own == 0 || k < i ? k + 1 : own;
    }
  }
  return own > 0 ? own : clock;
}

/* Interval of a rate or interval that stands alone, or a start that does; NAN without one. */
static double lone_clock(const struct work *work, bool start)
{
  for (size_t k = 0; k < work->table->column_count; k++) {
    const struct dea_table_column *column = &work->table->columns[k];
    if (work->roles[k].use == DEA_USE_CLOCK) {
      double value = column->values[0] * work->roles[k].factor;
      enum dea_word part = dea_word_clock(column->name);
      value = part == DEA_WORD_RATE ? 1 / value : value;
      if ((part == DEA_WORD_START) == start && isfinite(value) && (start || value > 0)) {
        return value;
      }
    }
  }
  return NAN;
}

static void set_clocks(struct work *work, size_t clock)
{
  double lone = lone_clock(work, false), start = lone_clock(work, true);
  for (size_t i = 0; i < work->table->column_count; i++) {
    const struct dea_table_column *column = &work->table->columns[i];
    struct dea_column_role *role = &work->roles[i];
    bool needs = role->use == DEA_USE_CHANNEL || role->use == DEA_USE_PROFILE;
    if (!needs || role->clock > 0) {
      continue;
    }
    role->start_s = isnan(start) || column->interval > 0 ? column->start : start;
    if (work->mapping != NULL && !isnan(work->mapping->rate_Hz.si)) {
      role->interval_s = 1 / work->mapping->rate_Hz.si;
    } else if (clock > 0) {
      role->clock = clock;
    } else if (column->clock > 0) {
      role->clock = column->clock;
    } else if (column->interval > 0) {
      role->interval_s = column->interval;
    } else {
      role->clock = find_clock(work, i);
      role->interval_s = role->clock == 0 ? lone : NAN;
    }
  }
}

dea_status dea_table_roles(struct dea_context *ctx, const struct dea_table *table,
                           const struct dea_mapping *mapping, struct dea_column_role *roles)
{
  struct work work = {ctx, table, mapping, roles, 0};
  size_t clock = 0;
  for (size_t i = 0; i < table->column_count; i++) {
    roles[i] = (struct dea_column_role){.factor = 1, .interval_s = NAN, .why = "not known"};
  }
  DEA_TRY(ctx, mapping != NULL ? read_mapping(&work, &clock) : DEA_OK);
  DEA_TRY(ctx, mapping == NULL || mapping->time.text[0] == '\0' ? guess_times(&work) : DEA_OK);
  for (size_t i = 0; mapping == NULL && i < table->column_count; i++) {
    guess_channel(&work, i);
  }
  set_clocks(&work, clock);
  if (work.errors > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "the mapping does not fit '%s'", table->file);
  }
  return DEA_OK;
}
