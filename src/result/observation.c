#include "result/observation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct dea_column dea_observed_columns[DEA_OBSERVED_COUNT] = {
    {"x_m", "m", "um", 1e6, "x", "displacement along x"},
    {"y_m", "m", "um", 1e6, "y", "displacement along y"},
    {"z_m", "m", "um", 1e6, "z", "displacement out of the plane"},
    {"turn_x_rad", "rad", "deg", 57.29577951308232, "turn x", "turn of a body about x"},
    {"turn_y_rad", "rad", "deg", 57.29577951308232, "turn y", "turn of a body about y"},
    {"turn_z_rad", "rad", "deg", 57.29577951308232, "turn z", "turn of a body about z"},
    {"u_m", "m", "um", 1e6, "u", "displacement outwards"},
    {"stretch", "1", "1", 1, "stretch", "length of a line over its flat one"},
    {"stretch_x", "1", "1", 1, "stretch x", "mean stretch of a region along x"},
    {"stretch_y", "1", "1", 1, "stretch y", "mean stretch of a region along y"},
    {"area_stretch", "1", "1", 1, "area stretch", "area of a region over its flat one"},
    {"force_x_N", "N", "mN", 1e3, "force x", "on a body, of what holds or moves it"},
    {"force_y_N", "N", "mN", 1e3, "force y", "on a body, of what holds or moves it"},
    {"force_z_N", "N", "mN", 1e3, "force z", "on a body, of what holds or moves it"},
    {"moment_x_N_m", "N m", "uN m", 1e6, "moment x", "on a body about its centre"},
    {"moment_y_N_m", "N m", "uN m", 1e6, "moment y", "on a body about its centre"},
    {"moment_z_N_m", "N m", "uN m", 1e6, "moment z", "on a body about its centre"},
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
  static const enum dea_observed mains[] = {DEA_OBSERVED_STRETCH, DEA_OBSERVED_VOLUME,
                                            DEA_OBSERVED_CONTACT_FORCE, DEA_OBSERVED_AREA_STRETCH};
  enum dea_observed main = DEA_OBSERVED_X;
  for (size_t k = 0; k < sizeof mains / sizeof mains[0]; k++) {
    if (!isnan(values[mains[k]])) {
      return mains[k];
    }
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
  static const struct {
    const char *word, *before, *meaning; // NULL: of the quantity itself
  } forms[] = {
      [DEA_OF_MONITOR_ERROR] = {"error", "error of ",
                                "estimated error of the mesh, where the monitor moves most along "
                                "that"},
      [DEA_OF_AMPLITUDE] = {"amplitude", "amplitude ", "of the motion that the excitation makes"},
      [DEA_OF_PHASE] = {"phase", "phase ", "of a motion against the excitation"},
  };
  const char *word = forms[column.source].word, *before = forms[column.source].before;
  char key[2 * DEA_NAME_SIZE], header[2 * DEA_NAME_SIZE], worded[DEA_ERROR_KEY_SIZE];
  struct dea_column shown = *of;
  snprintf(key, sizeof key, "%s_%s", part, of->key);
  snprintf(header, sizeof header, "%s%.63s %s", before != NULL ? before : "", name, of->header);
  shown.key = key;
  shown.header = header;
  if (word != NULL) {
    dea_column_word_key(&shown, word, column.source == DEA_OF_PHASE ? "rad" : of->si_unit, worded);
    shown.key = worded;
    shown.meaning = forms[column.source].meaning;
  }
  if (column.source == DEA_OF_PHASE) {
    shown.si_unit = "rad";
    shown.display_unit = "deg";
    shown.factor = 57.29577951308232;
  } else if (column.source == DEA_OF_AMPLITUDE && strcmp(of->si_unit, "m") == 0) {
    shown.display_unit = "nm";
    shown.factor = 1e9;
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

/* answers: to an excitation, of the motions; else the quantities with their errors. */
static dea_status add_monitor(struct listing *list, const struct dea_layout *layout,
                              const char *const *names, size_t index, bool answers)
{
  char part[DEA_KEY_PART_SIZE];
  part_of(names, index, part);
  for (size_t k = 0; k < (answers ? DEA_OBSERVED_MOTIONS : DEA_OBSERVED_COUNT); k++) {
    const struct dea_column *of = &dea_observed_columns[k];
    struct dea_monitor_column column = {.index = index, .number = k};
    if (!dea_observed_has(layout->monitors[index].kind, (enum dea_observed)k)) {
      continue;
    }
    column.source = answers ? DEA_OF_AMPLITUDE : DEA_OF_MONITOR;
    DEA_TRY(list->ctx, add(list, names[index], part, of, column));
    if (answers || has_error((enum dea_observed)k)) {
      column.source = answers ? DEA_OF_PHASE : DEA_OF_MONITOR_ERROR;
      DEA_TRY(list->ctx, add(list, names[index], part, of, column));
    }
  }
  return DEA_OK;
}

static dea_status list_columns(struct dea_arena *memory, const struct dea_layout *layout,
                               bool answers, struct dea_monitor_column **out, size_t *count)
{
  const size_t monitors = layout->monitor_count, channels = answers ? 0 : layout->channel_count;
  const size_t capacity = monitors * 2 * DEA_OBSERVED_COUNT + channels * DEA_OBSERVED_OF_CHANNEL;
  struct listing list = {memory->ctx, dea_arena_alloc(memory, capacity, sizeof *list.columns), 0};
  const char **names = dea_arena_alloc(memory, monitors + channels, sizeof *names);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t i = 0; i < monitors; i++) {
    names[i] = layout->monitors[i].name;
    DEA_TRY(memory->ctx, add_monitor(&list, layout, names, i, answers));
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

dea_status dea_layout_columns(struct dea_arena *memory, const struct dea_layout *layout,
                              struct dea_monitor_column **out, size_t *count)
{
  return list_columns(memory, layout, false, out, count);
}

dea_status dea_layout_answer_columns(struct dea_arena *memory, const struct dea_layout *layout,
                                     struct dea_monitor_column **out, size_t *count)
{
  return list_columns(memory, layout, true, out, count);
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
