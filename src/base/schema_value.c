#include "base/schema_value.h"

#include "base/units.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MESSAGE_SIZE = 800 };

dea_status dea_schema_error(const struct dea_reader *reader, struct dea_location location,
                            const char *format, ...)
{
  char text[MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  return dea_finding_add(reader->ctx, DEA_ERROR, location, "%s", text);
}

dea_status dea_schema_list(const struct dea_reader *reader, const char *path, const char *text,
                           const char *unit, double si, enum dea_origin origin,
                           struct dea_location location)
{
  struct dea_listing *listing = reader->listing;
  if (listing == NULL) {
    return DEA_OK;
  }
  DEA_TRY_STATUS(dea_array_grow(reader->ctx, &listing->items, listing->count, &listing->capacity,
                                sizeof *listing->items));
  char *copy = dea_copy_text(reader->ctx, path, DEA_KEY_PATH_SIZE);
  DEA_TRY_MEMORY(copy != NULL);
  listing->items[listing->count++] =
      (struct dea_listed){copy, text, unit, unit != NULL ? si : NAN, origin, location};
  return DEA_OK;
}

void dea_listing_free(struct dea_context *ctx, struct dea_listing *listing)
{
  for (size_t i = 0; i < listing->count; i++) {
    dea_free(ctx, listing->items[i].path);
  }
  dea_free(ctx, listing->items);
  *listing = (struct dea_listing){0};
}

/* What is due, where the unit of suggestions is that of the example. */
static struct dea_measure measure_of(const struct dea_field *field)
{
  return (struct dea_measure){field->unit != NULL ? field->unit : "1",
                              field->example != NULL ? field->example : "1"};
}

void dea_schema_value_absent(const struct dea_field *field, char *target,
                             struct dea_location location)
{
  struct dea_quantity nothing = {NAN, DEA_ABSENT, location};
  switch (field->kind) {
  case DEA_FIELD_LABEL:
    *(struct dea_label *)target = (struct dea_label){.location = location};
    break;
  case DEA_FIELD_NUMBER:
  case DEA_FIELD_INTEGER:
  case DEA_FIELD_STRETCHED:
    *(struct dea_quantity *)target = nothing;
    break;
  case DEA_FIELD_INPLANE:
    *(struct dea_inplane_length *)target = (struct dea_inplane_length){nothing, DEA_STRETCHED};
    break;
  case DEA_FIELD_CHOICE:
    *(struct dea_choice *)target = (struct dea_choice){-1, DEA_ABSENT, location};
    break;
  default:
    break; // zeroed memory says it
  }
}

void dea_field_limits(const struct dea_field *field, bool *lower, bool *upper)
{
  *lower = field->min != 0 || field->max != 0 || field->above_min;
  *upper = *lower && (field->max > field->min || (field->max == field->min && field->max != 0));
}

/* A limit in the unit that the number was written in, "at most 10 mm" of '100 mm'. */
static void format_limit(const struct dea_field *field, double limit, const char *written,
                         double si, char text[48])
{
  const char *unit;
  double number = dea_text_to_double(written, &unit);
  unit += strspn(unit, " ");
  bool scales = strcmp(field->unit, "K") != 0; // degC has a zero of its own
  if (scales && number != 0 && si != 0 && unit[0] != '\0' && strlen(unit) < 30) {
    limit *= number / si;
  } else {
    unit = strcmp(field->unit, "1") == 0 ? "" : field->unit;
  }
  bool bare = limit == 0 || unit[0] == '\0';
  snprintf(text, 48, "%g%s%s", limit, bare ? "" : " ", bare ? "" : unit);
}

/* false after an error: si, which is the number `written`, is out of the field's range. */
static dea_status check_range(const struct dea_reader *reader, const struct dea_schema_value *value,
                              const char *written, double si, bool *good)
{
  const struct dea_field *field = value->field;
  char limit[48];
  *good = true;
  bool lower, upper;
  dea_field_limits(field, &lower, &upper);
  bool low = lower && (field->above_min ? si <= field->min : si < field->min);
  bool high = upper && (field->below_max ? si >= field->max : si > field->max);
  if (!low && !high) {
    return DEA_OK;
  }
  *good = false;
  format_limit(field, low ? field->min : field->max, written, si, limit);
  const char *word =
      low ? (field->above_min ? "above" : "at least") : (field->below_max ? "below" : "at most");
  return dea_schema_error(reader, value->location, "%s must be %s %s, not '%.60s'", field->key,
                          word, limit, value->text);
}

/* The number in text (that of the value, or what is left of it without its qualifier). */
static dea_status read_number(const struct dea_reader *reader, const struct dea_schema_value *value,
                              const char *text, struct dea_quantity *out)
{
  char why[DEA_WHY_SIZE];
  double si;
  *out = (struct dea_quantity){NAN, value->origin, value->location};
  if (!dea_units_read(reader->ctx, text, measure_of(value->field), &si, why)) {
    if (why[0] == '\0') {
      return dea_context_status(reader->ctx);
    }
    return dea_schema_error(reader, value->location, "%s: %s", value->field->key, why);
  }
  bool good;
  DEA_TRY(reader->ctx, check_range(reader, value, text, si, &good));
  if (good && value->field->kind == DEA_FIELD_INTEGER && floor(si) != si) {
    return dea_schema_error(reader, value->location, "%s must be a whole number, not '%.60s'",
                            value->field->key, value->text);
  }
  if (good) {
    out->si = value->field->scale != 0 ? si * value->field->scale : si;
  }
  return DEA_OK;
}

static const char *const film_states[] = {"stretched", "unstretched"};

const char *dea_film_state_name(enum dea_film_state state)
{
  return film_states[state];
}

/* Splits "5 mm stretched" into "5 mm" and its last word. */
static void split_qualifier(const char *text, char number[DEA_TITLE_SIZE], const char **word)
{
  size_t end = strlen(text);
  while (end > 0 && text[end - 1] != ' ' && text[end - 1] != '\t') {
    end--;
  }
  *word = text + end;
  while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == '\t')) {
    end--;
  }
  snprintf(number, DEA_TITLE_SIZE, "%.*s", (int)(end < DEA_TITLE_SIZE ? end : DEA_TITLE_SIZE - 1),
           text);
}

static int film_state_of(const char *word)
{
  return strcmp(word, film_states[DEA_STRETCHED]) == 0     ? DEA_STRETCHED
         : strcmp(word, film_states[DEA_UNSTRETCHED]) == 0 ? DEA_UNSTRETCHED
                                                           : -1;
}

static dea_status read_inplane(const struct dea_reader *reader,
                               const struct dea_schema_value *value, struct dea_inplane_length *out)
{
  char number[DEA_TITLE_SIZE], why[DEA_WHY_SIZE];
  const char *word;
  double si;
  *out = (struct dea_inplane_length){{NAN, value->origin, value->location}, DEA_STRETCHED};
  split_qualifier(value->text, number, &word);
  int state = film_state_of(word);
  if (state >= 0) {
    out->state = (enum dea_film_state)state;
    return read_number(reader, value, number, &out->length);
  }
  char hint[DEA_HINT_SIZE];
  if (strlen(word) > 4 && dea_name_hint(word, film_states, 2, hint)[0] != '\0') {
    return dea_schema_error(reader, value->location, "%s: '%.60s' is not a film state%s",
                            value->field->key, word, hint);
  }
  if (!dea_units_read(reader->ctx, value->text, measure_of(value->field), &si, why)) {
    return why[0] == '\0'
               ? dea_context_status(reader->ctx)
               : dea_schema_error(reader, value->location, "%s: %s", value->field->key, why);
  }
  return dea_schema_error(
      reader, value->location,
      "%s: '%.40s' does not say in which film it is measured; write '%.40s stretched' "
      "(as built) or '%.40s unstretched' (before the pre-stretch)",
      value->field->key, value->text, value->text, value->text);
}

/* Numbers that are no lengths of either film: the word 'stretched' may only be where it is true. */
static dea_status read_plain_number(const struct dea_reader *reader,
                                    const struct dea_schema_value *value, struct dea_quantity *out)
{
  char number[DEA_TITLE_SIZE];
  const char *word;
  split_qualifier(value->text, number, &word);
  int state = film_state_of(word);
  *out = (struct dea_quantity){NAN, value->origin, value->location};
  if (state < 0) {
    return read_number(reader, value, value->text, out);
  }
  if (value->field->kind != DEA_FIELD_STRETCHED) {
    return dea_schema_error(reader, value->location, "%s: the word '%s' does not belong here (%s)",
                            value->field->key, word, value->field->doc);
  }
  if (state == DEA_UNSTRETCHED) {
    return dea_schema_error(
        reader, value->location,
        "%s: this part is rigid and holds the stretched film, so its lengths are "
        "lengths of the stretched film; write '%.60s'",
        value->field->key, number);
  }
  return read_number(reader, value, number, out);
}

static dea_status read_choice(const struct dea_reader *reader, const struct dea_schema_value *value,
                              struct dea_choice *out)
{
  const char *const *choices = value->field->choices;
  char list[DEA_HINT_SIZE], hint[DEA_HINT_SIZE];
  size_t count = 0;
  *out = (struct dea_choice){-1, value->origin, value->location};
  for (; choices[count] != NULL; count++) {
    if (strcmp(choices[count], value->text) == 0) {
      out->value = (int)count;
      return DEA_OK;
    }
  }
  return dea_schema_error(reader, value->location, "%s: '%.60s' is none of: %s%s",
                          value->field->key, value->text, dea_names_list(choices, count, list),
                          dea_name_hint(value->text, choices, count, hint));
}

static dea_status read_label(const struct dea_reader *reader, const struct dea_schema_value *value,
                             struct dea_label *out)
{
  *out = (struct dea_label){.origin = value->origin, .location = value->location};
  if (strlen(value->text) >= sizeof out->text) {
    return dea_schema_error(reader, value->location, "%s is longer than %zu bytes",
                            value->field->key, sizeof out->text - 1);
  }
  snprintf(out->text, sizeof out->text, "%s", value->text);
  if (value->field->one_line) {
    dea_text_flatten(out->text);
  }
  return DEA_OK;
}

dea_status dea_schema_value_read(const struct dea_reader *reader,
                                 const struct dea_schema_value *value, char *target)
{
  const struct dea_field *field = value->field;
  double si = NAN;
  dea_schema_value_absent(field, target, value->location);
  switch (field->kind) {
  case DEA_FIELD_LABEL:
    DEA_TRY(reader->ctx, read_label(reader, value, (struct dea_label *)target));
    break;
  case DEA_FIELD_TEXT:
    *(const char **)target = value->text;
    break;
  case DEA_FIELD_NUMBER:
  case DEA_FIELD_INTEGER:
  case DEA_FIELD_STRETCHED:
    DEA_TRY(reader->ctx, read_plain_number(reader, value, (struct dea_quantity *)target));
    si = ((struct dea_quantity *)target)->si;
    break;
  case DEA_FIELD_INPLANE:
    DEA_TRY(reader->ctx, read_inplane(reader, value, (struct dea_inplane_length *)target));
    si = ((struct dea_inplane_length *)target)->length.si;
    break;
  case DEA_FIELD_CHOICE:
    DEA_TRY(reader->ctx, read_choice(reader, value, (struct dea_choice *)target));
    break;
  default:
    return DEA_OK; // read_field has done these
  }
  // The list holds what was written, so a diameter stays one although the struct keeps the radius.
  return dea_schema_list(reader, value->path, value->text, field->unit,
                         field->scale != 0 ? si / field->scale : si, value->origin,
                         value->location);
}
