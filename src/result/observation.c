#include "result/observation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LENGTH(key, title, meaning)                                                                \
  {                                                                                                \
    key, "m", "um", 1e6, title, meaning                                                            \
  }
#define TURN(axis)                                                                                 \
  {                                                                                                \
    "turn_" axis "_rad", "rad", "deg", 57.29577951308232, "turn " axis,                            \
        "turn of a body about " axis                                                               \
  }
#define RATIO(key, title, meaning)                                                                 \
  {                                                                                                \
    key, "1", "1", 1, title, meaning                                                               \
  }
#define FORCE(axis)                                                                                \
  {                                                                                                \
    "force_" axis "_N", "N", "mN", 1e3, "force " axis, "on a body, of what holds or moves it"      \
  }
#define MOMENT(axis)                                                                               \
  {                                                                                                \
    "moment_" axis "_N_m", "N m", "uN m", 1e6, "moment " axis, "on a body about its centre"        \
  }

const struct dea_column dea_observed_columns[DEA_OBSERVED_COUNT] = {
    LENGTH("x_m", "x", "displacement along x"),
    LENGTH("y_m", "y", "displacement along y"),
    LENGTH("z_m", "z", "displacement out of the plane"),
    TURN("x"),
    TURN("y"),
    TURN("z"),
    LENGTH("u_m", "u", "displacement outwards"),
    RATIO("stretch", "stretch", "length of a line over its flat one"),
    RATIO("stretch_x", "stretch x", "mean stretch of a region along x"),
    RATIO("stretch_y", "stretch y", "mean stretch of a region along y"),
    RATIO("area_stretch", "area stretch", "area of a region over its flat one"),
    FORCE("x"),
    FORCE("y"),
    FORCE("z"),
    MOMENT("x"),
    MOMENT("y"),
    MOMENT("z"),
    {"pressure_Pa", "Pa", "kPa", 1e-3, "pressure", "on a face, into its ply"},
    {"volume_m3", "m3", "ml", 1e6, "volume", "that a face with a pressure has swept"},
    {"contact_force_N", "N", "mN", 1e3, "force", "of a face on what it touches"},
    {"contact_area_m2", "m2", "mm2", 1e6, "area",
     "of a flat face where it touches, to the size of an element"},
};

/* In the order of DEA_OBSERVED_VOLTAGE, ... */
static const struct dea_column channel_columns[DEA_OBSERVED_OF_CHANNEL] = {
    {"voltage_V", "V", "kV", 1e-3, "voltage", "voltage of the channel"},
    {"charge_C", "C", "nC", 1e9, "charge", "charge on the channel"},
    {"capacitance_F", "F", "pF", 1e12, "capacitance",
     "change of the channel's charge with its voltage, the film held"},
    {"current_A", "A", "uA", 1e6, "current",
     "of the channel's source into the film, mean of the step to this time"},
};

enum dea_observed dea_observed_main(const double values[DEA_OBSERVED_COUNT])
{
  enum dea_observed main = DEA_OBSERVED_X;
  if (!isnan(values[DEA_OBSERVED_STRETCH])) {
    return DEA_OBSERVED_STRETCH;
  }
  if (!isnan(values[DEA_OBSERVED_VOLUME])) {
    return DEA_OBSERVED_VOLUME;
  }
  if (!isnan(values[DEA_OBSERVED_CONTACT_AREA])) {
    return DEA_OBSERVED_CONTACT_FORCE;
  }
  if (!isnan(values[DEA_OBSERVED_AREA_STRETCH])) {
    return DEA_OBSERVED_AREA_STRETCH;
  }
  for (int k = DEA_OBSERVED_Y; k <= DEA_OBSERVED_Z; k++) {
    main = fabs(values[k]) > fabs(values[main]) ? (enum dea_observed)k : main;
  }
  return main;
}

bool dea_observed_has(enum dea_layout_monitor_kind kind, enum dea_observed observed)
{
  switch (kind) {
  case DEA_MONITOR_POINT:
    return observed <= DEA_OBSERVED_Z;
  case DEA_MONITOR_LINE:
    return observed == DEA_OBSERVED_STRETCH;
  case DEA_MONITOR_RADIUS:
    return observed == DEA_OBSERVED_OUTWARDS || observed == DEA_OBSERVED_STRETCH;
  case DEA_MONITOR_REGION:
    return observed <= DEA_OBSERVED_Z ||
           (observed >= DEA_OBSERVED_STRETCH_X && observed <= DEA_OBSERVED_AREA_STRETCH);
  case DEA_MONITOR_VOLUME:
    return observed == DEA_OBSERVED_PRESSURE || observed == DEA_OBSERVED_VOLUME;
  case DEA_MONITOR_CONTACT:
    return observed >= DEA_OBSERVED_CONTACT_FORCE;
  default:
    return observed <= DEA_OBSERVED_TURN_Z ||
           (observed >= DEA_OBSERVED_FORCE_X && observed <= DEA_OBSERVED_MOMENT_Z);
  }
}

static bool ends_with(const char *text, const char *end)
{
  const size_t length = strlen(text), size = strlen(end);
  return length > size + 1 && text[length - size - 1] == '_' &&
         strcmp(text + length - size, end) == 0;
}

enum { QUANTITIES = DEA_OBSERVED_COUNT + DEA_OBSERVED_OF_CHANNEL };

/* Quantities of monitors, then those of channels. */
static const struct dea_column *quantity(size_t k)
{
  return k < DEA_OBSERVED_COUNT ? &dea_observed_columns[k]
                                : &channel_columns[k - DEA_OBSERVED_COUNT];
}

/* The quantity that a column is of, with the longest key; QUANTITIES for none. */
static size_t quantity_of(const struct dea_column *column)
{
  size_t found = QUANTITIES;
  for (size_t k = 0; k < QUANTITIES; k++) {
    if (ends_with(column->key, quantity(k)->key) &&
        (found == QUANTITIES || strlen(quantity(k)->key) > strlen(quantity(found)->key))) {
      found = k;
    }
  }
  return found;
}

bool dea_observed_is(const struct dea_column *column, const char *key)
{
  const size_t found = quantity_of(column);
  return found < QUANTITIES && (key == NULL || strcmp(quantity(found)->key, key) == 0);
}

size_t dea_observed_name_length(const struct dea_column *column)
{
  const size_t k = quantity_of(column);
  const struct dea_column *found = k < QUANTITIES ? quantity(k) : NULL;
  const size_t length = strlen(column->header);
  const size_t title = found != NULL ? strlen(found->header) + 1 : 0;
  return length > title ? length - title : length;
}

/* Whether its error is estimated where it is the main motion of its monitor. */
static bool has_error(enum dea_observed observed)
{
  return observed <= DEA_OBSERVED_Z || observed == DEA_OBSERVED_STRETCH ||
         observed == DEA_OBSERVED_AREA_STRETCH;
}

int dea_observed_of_disc(const struct dea_layout_monitor *monitor, enum dea_observed *observed)
{
  char part[DEA_KEY_PART_SIZE], key[2 * DEA_NAME_SIZE];
  dea_key_part(monitor->name, part);
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    snprintf(key, sizeof key, "%s_%s", part, dea_observed_columns[k].key);
    const int column = dea_point_column_find(key);
    if (column >= 0 && dea_observed_has(monitor->kind, (enum dea_observed)k)) {
      *observed = (enum dea_observed)k;
      return column;
    }
  }
  return -1;
}

struct listing {
  struct dea_context *ctx;
  struct dea_monitor_column *columns;
  size_t count;
};

/* Adds a column of a quantity of `name`, whose part of the key that is. */
static dea_status add(struct listing *list, const char *name, const char *part,
                      const struct dea_column *of, struct dea_monitor_column column)
{
  char key[2 * DEA_NAME_SIZE], header[2 * DEA_NAME_SIZE];
  struct dea_column shown = *of;
  const bool error = column.source == DEA_OF_MONITOR_ERROR;
  snprintf(key, sizeof key, "%s_%s", part, of->key);
  snprintf(header, sizeof header, "%s%.63s %s", error ? "error of " : "", name, of->header);
  shown.key = key;
  shown.header = header;
  if (error) {
    char of_error[DEA_ERROR_KEY_SIZE];
    dea_column_error_key(&shown, of_error);
    snprintf(key, sizeof key, "%s", of_error);
    shown.meaning = "estimated error of the mesh, where the monitor moves most along that";
  }
  DEA_TRY(list->ctx, dea_column_add(list->ctx, &shown, &column.column));
  list->columns[list->count++] = column;
  return DEA_OK;
}

/* A name as a part of keys that none before it has. */
static void part_of(const char *const *names, size_t index, char out[DEA_KEY_PART_SIZE])
{
  size_t same = 1;
  char other[DEA_KEY_PART_SIZE];
  dea_key_part(names[index], out);
  for (size_t i = 0; i < index; i++) {
    dea_key_part(names[i], other);
    same += strcmp(out, other) == 0 ? 1 : 0;
  }
  if (same > 1) {
    const size_t length = strlen(out);
    snprintf(out + length, DEA_KEY_PART_SIZE - length, "_%zu", same);
  }
}

static dea_status add_monitor(struct listing *list, const struct dea_layout *layout,
                              const char *const *names, size_t index)
{
  const enum dea_layout_monitor_kind kind = layout->monitors[index].kind;
  char part[DEA_KEY_PART_SIZE];
  part_of(names, index, part);
  for (size_t k = 0; k < DEA_OBSERVED_COUNT; k++) {
    struct dea_monitor_column column = {.source = DEA_OF_MONITOR, .index = index, .number = k};
    if (!dea_observed_has(kind, (enum dea_observed)k)) {
      continue;
    }
    DEA_TRY(list->ctx, add(list, names[index], part, &dea_observed_columns[k], column));
    if (has_error((enum dea_observed)k)) {
      column.source = DEA_OF_MONITOR_ERROR;
      DEA_TRY(list->ctx, add(list, names[index], part, &dea_observed_columns[k], column));
    }
  }
  return DEA_OK;
}

dea_status dea_layout_columns(struct dea_arena *memory, const struct dea_layout *layout,
                              struct dea_monitor_column **out, size_t *count)
{
  const size_t monitors = layout->monitor_count, channels = layout->channel_count;
  const size_t capacity = monitors * 2 * DEA_OBSERVED_COUNT + channels * DEA_OBSERVED_OF_CHANNEL;
  struct listing list = {memory->ctx, dea_arena_alloc(memory, capacity, sizeof *list.columns), 0};
  const char **names = dea_arena_alloc(memory, monitors + channels, sizeof *names);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t i = 0; i < monitors; i++) {
    names[i] = layout->monitors[i].name;
    DEA_TRY(memory->ctx, add_monitor(&list, layout, names, i));
  }
  for (size_t i = 1; i < channels; i++) {
    char part[DEA_KEY_PART_SIZE];
    names[i - 1] = layout->channels[i].name;
    part_of(names, i - 1, part);
    for (size_t k = 0; k < DEA_OBSERVED_OF_CHANNEL; k++) {
      const struct dea_monitor_column column = {.source = DEA_OF_CHANNEL, .index = i, .number = k};
      DEA_TRY(memory->ctx, add(&list, names[i - 1], part, &channel_columns[k], column));
    }
  }
  *out = list.columns;
  *count = list.count;
  return DEA_OK;
}

/* Amplitude and phase of a quantity of a monitor. */
static dea_status add_answer(struct listing *list, const char *name, const char *part,
                             struct dea_monitor_column column)
{
  const struct dea_column *of = &dea_observed_columns[column.number];
  const char *unit = strcmp(of->si_unit, "1") == 0 ? "" : of->si_unit; // "m", "rad"
  const size_t end = unit[0] != '\0' ? strlen(unit) + 1 : 0;
  char key[2 * DEA_NAME_SIZE], header[2 * DEA_NAME_SIZE];
  for (int phase = 0; phase < 2; phase++) {
    const bool length = strcmp(of->si_unit, "m") == 0;
    const struct dea_column shown =
        phase ? (struct dea_column){key,    "rad",
                                    "deg",  57.29577951308232,
                                    header, "of a motion against the excitation"}
              : (struct dea_column){key,
                                    of->si_unit,
                                    length ? "nm" : of->display_unit,
                                    length ? 1e9 : of->factor,
                                    header,
                                    "of the motion that the excitation makes"};
    snprintf(key, sizeof key, "%s_%.*s_%s%s%s", part, (int)(strlen(of->key) - end), of->key,
             phase ? "phase_rad" : "amplitude", phase || end == 0 ? "" : "_", phase ? "" : unit);
    snprintf(header, sizeof header, "%s %.63s %s", phase ? "phase" : "amplitude", name, of->header);
    column.source = phase ? DEA_OF_PHASE : DEA_OF_AMPLITUDE;
    DEA_TRY(list->ctx, dea_column_add(list->ctx, &shown, &column.column));
    list->columns[list->count++] = column;
  }
  return DEA_OK;
}

dea_status dea_layout_answer_columns(struct dea_arena *memory, const struct dea_layout *layout,
                                     struct dea_monitor_column **out, size_t *count)
{
  const size_t monitors = layout->monitor_count, capacity = monitors * 2 * DEA_OBSERVED_MOTIONS;
  struct listing list = {memory->ctx, dea_arena_alloc(memory, capacity, sizeof *list.columns), 0};
  const char **names = dea_arena_alloc(memory, monitors, sizeof *names);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t i = 0; i < monitors; i++) {
    char part[DEA_KEY_PART_SIZE];
    names[i] = layout->monitors[i].name;
    part_of(names, i, part);
    for (size_t k = 0; k < DEA_OBSERVED_MOTIONS; k++) {
      const struct dea_monitor_column column = {.index = i, .number = k};
      if (dea_observed_has(layout->monitors[i].kind, (enum dea_observed)k)) {
        DEA_TRY(memory->ctx, add_answer(&list, names[i], part, column));
      }
    }
  }
  *out = list.columns;
  *count = list.count;
  return DEA_OK;
}

dea_status dea_device_columns_add(struct dea_context *ctx, const struct dea_device *device)
{
  struct dea_monitor_column none;
  bool found;
  return dea_device_is_observed(device)
             ? dea_layout_column_find(ctx, device->layout, -1, &none, &found)
             : DEA_OK;
}

dea_status dea_layout_column_find(struct dea_context *ctx, const struct dea_layout *layout,
                                  int column, struct dea_monitor_column *out, bool *found)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_monitor_column *columns;
  size_t count = 0;
  dea_status status = dea_layout_columns(&memory, layout, &columns, &count);
  *found = false;
  for (size_t i = 0; status == DEA_OK && i < count && !*found; i++) {
    *found = columns[i].column == column;
    *out = columns[i];
  }
  dea_arena_free(&memory);
  return status;
}

double dea_curve_change(const struct dea_curve *curve, int column)
{
  double low = INFINITY, high = -INFINITY, size = 0;
  for (size_t i = 0; i < curve->count; i++) {
    const double value = dea_point_get(&curve->points[i], column);
    low = fmin(low, value); // not of NAN
    high = fmax(high, value);
    size = fmax(size, fabs(value));
  }
  return high > low ? high - low : size;
}

/* What a monitor shows of one kind is one headline. */
enum headline { NO_HEADLINE, BY_DISPLACEMENT, BY_TURN, BY_STRETCH, BY_FORCE };

static enum headline headline_of(const struct dea_column *column, double *least)
{
  const size_t k = quantity_of(column);
  *least = 1e-9; // [m]
  if (k <= DEA_OBSERVED_Z) {
    return BY_DISPLACEMENT;
  }
  *least = 1e-5; // [rad]
  if (k >= DEA_OBSERVED_TURN_X && k <= DEA_OBSERVED_TURN_Z) {
    return BY_TURN;
  }
  *least = 1e-9; // [N], stretch
  if (k == DEA_OBSERVED_CONTACT_FORCE) {
    return BY_FORCE;
  }
  return k == DEA_OBSERVED_STRETCH || k == DEA_OBSERVED_AREA_STRETCH ? BY_STRETCH : NO_HEADLINE;
}

/* Whether two columns are of one name. */
static bool same_name(const struct dea_column *a, const struct dea_column *b)
{
  const size_t length = dea_observed_name_length(a);
  return length == dea_observed_name_length(b) && memcmp(a->header, b->header, length) == 0;
}

size_t dea_curve_headlines(const struct dea_context *ctx, const struct dea_curve *curve, int *out,
                           size_t max)
{
  size_t count = 0;
  for (int c = DEA_LOAD_POINT_COLUMNS; c < dea_column_count(ctx); c++) {
    double least, change = dea_curve_change(curve, c);
    const struct dea_column *column = dea_column_at(ctx, c);
    const enum headline kind = headline_of(column, &least);
    size_t at = 0;
    if (kind == NO_HEADLINE || !(change > least)) {
      continue;
    }
    while (at < count && (headline_of(dea_column_at(ctx, out[at]), &least) != kind ||
                          !same_name(dea_column_at(ctx, out[at]), column))) {
      at++;
    }
    if (at < count && change > dea_curve_change(curve, out[at])) {
      out[at] = c;
    } else if (at == count && count < max) {
      out[count++] = c;
    }
  }
  return count;
}
