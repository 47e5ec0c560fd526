#include "result/columns.h"

#include <math.h>
#include <stdio.h>
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

// Columns of a context ----------------------------------------------------------------------------

/* Columns that are no members. */
struct registry {
  struct dea_context *ctx;
  struct dea_column **columns;
  size_t count, capacity;
};

static void release(void *object)
{
  struct registry *registry = object;
  for (size_t i = 0; i < registry->count; i++) {
    dea_free(registry->ctx, registry->columns[i]);
  }
  dea_free(registry->ctx, registry->columns);
  dea_free(registry->ctx, registry);
}

int dea_column_count(const struct dea_context *ctx)
{
  const struct registry *registry = ctx != NULL ? dea_context_kept(ctx, release) : NULL;
  return DEA_LOAD_POINT_COLUMNS + (registry != NULL ? (int)registry->count : 0);
}

const struct dea_column *dea_column_at(const struct dea_context *ctx, int column)
{
  if (column < DEA_LOAD_POINT_COLUMNS) {
    return &dea_point_columns[column];
  }
  const struct registry *registry = dea_context_kept(ctx, release);
  return registry->columns[column - DEA_LOAD_POINT_COLUMNS];
}

void dea_key_part(const char *name, char out[DEA_KEY_PART_SIZE])
{
  size_t n = 0;
  for (; *name != '\0' && n + 1 < DEA_KEY_PART_SIZE; name++) {
    const unsigned char c = (unsigned char)*name;
    const bool kept =
        c >= 0x80 || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (kept || n == 0 || out[n - 1] != '_') {
      out[n++] = kept ? (char)c : '_';
    }
  }
  while ((*name & 0xc0) == 0x80 && n > 0 && (out[n - 1] & 0x80) != 0) { // not a part of a letter
    n--;
  }
  out[n] = '\0';
}

enum { KEY_UNIT_SIZE = 32 };

/* Ending of a key by its unit: "_V_per_m", "" for a number without one. Returns its length. */
static size_t key_unit(const char *si_unit, char out[KEY_UNIT_SIZE])
{
  size_t n = 0;
  out[0] = '\0';
  for (const char *u = strcmp(si_unit, "1") != 0 ? si_unit : "";
       *u != '\0' && n + 8 < KEY_UNIT_SIZE; u++) {
    const char letter[] = {u == si_unit ? '_' : *u, u == si_unit ? *u : '\0', '\0'};
    const char *text = *u == ' ' ? "_" : *u == '/' ? "_per_" : letter;
    n += (size_t)snprintf(out + n, KEY_UNIT_SIZE - n, "%s", text);
  }
  return n;
}

/* Whether that is the key of a column without its unit. */
static bool is_key_without_unit(const struct dea_column *column, const char *text)
{
  char unit[KEY_UNIT_SIZE];
  const size_t length = strlen(column->key), outcome = key_unit(column->si_unit, unit);
  const size_t without = length > outcome ? length - outcome : 0;
  return strcmp(column->key + without, unit) == 0 && strlen(text) == without &&
         memcmp(column->key, text, without) == 0;
}

/* The column that has that very key, or -1. */
static int find_exactly(const struct dea_context *ctx, const char *key)
{
  for (int c = 0; c < dea_column_count(ctx); c++) {
    if (strcmp(dea_column_at(ctx, c)->key, key) == 0) {
      return c;
    }
  }
  return -1;
}

int dea_column_find(const struct dea_context *ctx, const char *key)
{
  char part[DEA_KEY_PART_SIZE + 32];
  const char *dot = strrchr(key, '.');
  int found = find_exactly(ctx, key);
  for (int c = DEA_LOAD_POINT_COLUMNS; found < 0 && c < dea_column_count(ctx); c++) {
    found = is_key_without_unit(dea_column_at(ctx, c), key) ? c : -1;
  }
  if (found >= 0 || dot == NULL || strlen(key) >= sizeof part) {
    return found;
  }
  snprintf(part, sizeof part, "%s", key); // "fibre tip.z_m", as older versions write it
  part[dot - key] = '\0';
  char name[DEA_KEY_PART_SIZE];
  dea_key_part(part, name);
  snprintf(part, sizeof part, "%s_%.31s", name, dot + 1);
  return dea_column_find(ctx, part);
}

const char **dea_column_keys(struct dea_context *ctx)
{
  const int count = dea_column_count(ctx);
  const char **keys = dea_alloc(ctx, (size_t)count, sizeof *keys);
  for (int c = 0; keys != NULL && c < count; c++) {
    keys[c] = dea_column_at(ctx, c)->key;
  }
  return keys;
}

dea_status dea_column_hint(struct dea_context *ctx, const char *text, const char *otherwise,
                           char out[DEA_HINT_SIZE])
{
  const char **keys = dea_column_keys(ctx);
  DEA_TRY_MEMORY(keys != NULL);
  dea_name_hint_list(text, keys, (size_t)dea_column_count(ctx), NULL, otherwise, out);
  dea_free(ctx, keys);
  return DEA_OK;
}

/* Room for one more column; NULL on failure. */
static struct registry *get_registry(struct dea_context *ctx)
{
  struct registry *registry = dea_context_kept(ctx, release);
  if (registry == NULL) {
    registry = dea_alloc(ctx, 1, sizeof *registry);
    if (registry == NULL) {
      return NULL;
    }
    registry->ctx = ctx;
    if (dea_context_keep(ctx, registry, release) != DEA_OK) {
      return NULL; // it was released
    }
  }
  return dea_array_grow(ctx, &registry->columns, registry->count, &registry->capacity,
                        sizeof *registry->columns) == DEA_OK
             ? registry
             : NULL;
}

dea_status dea_column_add(struct dea_context *ctx, const struct dea_column *column, int *out)
{
  *out = find_exactly(ctx, column->key);
  if (*out >= 0) {
    return DEA_OK;
  }
  *out = dea_column_count(ctx);
  struct registry *registry = get_registry(ctx);
  struct dea_column *kept = registry != NULL ? dea_alloc(ctx, 1, sizeof *kept) : NULL;
  DEA_TRY_MEMORY(kept != NULL);
  *kept = (struct dea_column){
      .key = dea_intern(ctx, column->key),
      .si_unit = dea_intern(ctx, column->si_unit),
      .display_unit = dea_intern(ctx, column->display_unit),
      .factor = column->factor,
      .header = dea_intern(ctx, column->header),
      .meaning = dea_intern(ctx, column->meaning),
  };
  if (kept->key == NULL || kept->si_unit == NULL || kept->display_unit == NULL ||
      kept->header == NULL || kept->meaning == NULL) {
    dea_free(ctx, kept);
    return DEA_E_MEMORY;
  }
  registry->columns[registry->count++] = kept;
  return DEA_OK;
}

// Values -----------------------------------------------------------------------------------------

struct dea_monitor_values *dea_monitor_values_create(struct dea_arena *memory, const int *columns,
                                                     size_t count)
{
  struct dea_monitor_values *values =
      dea_arena_alloc(memory, 1, sizeof *values + count * sizeof values->at[0]);
  for (size_t i = 0; values != NULL && i < count; i++) {
    values->at[i] = (struct dea_monitor_value){columns[i], NAN};
  }
  if (values != NULL) {
    values->count = count;
  }
  return values;
}

struct dea_monitor_values *dea_monitor_values_copy(struct dea_arena *memory,
                                                   const struct dea_monitor_values *values)
{
  const size_t size = values != NULL ? sizeof *values + values->count * sizeof values->at[0] : 0;
  struct dea_monitor_values *copy = values != NULL ? dea_arena_alloc(memory, 1, size) : NULL;
  if (copy != NULL) {
    memcpy(copy, values, size);
  }
  return copy;
}

/* Place of a column that is no member; NULL: the point has none. */
static struct dea_monitor_value *find_value(const struct dea_load_point *point, int column)
{
  for (size_t i = 0; point->monitors != NULL && i < point->monitors->count; i++) {
    if (point->monitors->at[i].column == column) {
      return &point->monitors->at[i];
    }
  }
  return NULL;
}

double dea_point_get(const struct dea_load_point *point, int column)
{
  if (column >= DEA_LOAD_POINT_COLUMNS) {
    const struct dea_monitor_value *at = find_value(point, column);
    return at != NULL ? at->value : NAN;
  }
  double value;
  memcpy(&value, (const char *)point + offsets[column], sizeof value);
  return value;
}

void dea_point_set(struct dea_load_point *point, int column, double value_si)
{
  if (column >= DEA_LOAD_POINT_COLUMNS) {
    struct dea_monitor_value *at = find_value(point, column);
    if (at != NULL) {
      at->value = value_si;
    }
    return;
  }
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

void dea_column_word_key(const struct dea_column *column, const char *word, const char *si_unit,
                         char out[DEA_ERROR_KEY_SIZE])
{
  char own[KEY_UNIT_SIZE], unit[KEY_UNIT_SIZE];
  const size_t length = strlen(column->key), end = key_unit(column->si_unit, own);
  key_unit(si_unit, unit);
  snprintf(out, DEA_ERROR_KEY_SIZE, "%.*s_%s%s", (int)(length > end ? length - end : 0),
           column->key, word, unit);
}

int dea_point_error_column(const struct dea_context *ctx, int column)
{
  const struct dea_column *of = dea_column_at(ctx, column);
  char key[DEA_ERROR_KEY_SIZE];
  dea_column_word_key(of, "error", of->si_unit, key);
  return find_exactly(ctx, key);
}

bool dea_point_is_bound(const struct dea_load_point *point, int column)
{
  static const char *const bounded[] = {"centre_z_m", "fibre_tip_z_m", "force_N"};
  bool found = false;
  for (size_t k = 0; k < sizeof bounded / sizeof bounded[0]; k++) {
    found = found || (column < DEA_LOAD_POINT_COLUMNS &&
                      strcmp(dea_point_columns[column].key, bounded[k]) == 0);
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
