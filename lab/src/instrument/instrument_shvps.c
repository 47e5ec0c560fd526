/* Instrument "shvps": the open high-voltage supply SHVPS (Peta-pico-Voltron) on its USB serial
 * line. Commands have at most 19 characters and end with CR; each is answered by one line, an
 * unknown one by "Err". It plays as a voltage of its converter, connected through (mode 1, DC).
 * Source: the public description of its commands (EPFL, LMTS).
 */
#include "base/clock.h"
#include "base/schema_value.h"
#include "base/text.h"
#include "instrument/line_supply.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct raw {
  struct dea_line_supply_raw line;
  struct dea_label name;
};

static const struct dea_field fields[] = {
    DEA_LINE_SUPPLY_ROWS(struct raw, "shvps", "115200"),
    DEA_INSTRUMENT_LABEL(struct raw, name, "name",
                         "what its name (QName) must contain, against mix-ups", "5 kV no. 2",
                         .absent_text = "not compared"),
};
const struct dea_record dea_instrument_shvps_record = {
    "shvps", "the open high-voltage supply SHVPS on its USB serial line", fields,
    DEA_INSTRUMENT_COUNT(fields)};

static bool is_number(const char *text, double *value)
{
  const char *end;
  *value = dea_text_to_double(text, &end);
  return end != text && end[strspn(end, " ")] == '\0' && isfinite(*value);
}

static bool is_error(const char *answer)
{
  return strncmp(answer, "Err", 3) == 0;
}

/* Where it repeats the voltage that must be the one. */
static bool is_set(const char *answer, long volts)
{
  double value;
  return !is_error(answer) && (!is_number(answer, &value) || value == (double)volts);
}

/* A name, which is neither a voltage nor an error. */
static bool is_synced(const char *answer)
{
  double value;
  return !is_error(answer) && !is_number(answer, &value);
}

/* Whether its name is what the section says. */
static bool is_named(const void *data, const char *answer)
{
  const struct raw *raw = data;
  return raw->name.origin == DEA_ABSENT || strstr(answer, raw->name.text) != NULL;
}

static const double marks = 397, marks_from_Hz = 2.25; // how many marks there are

static dea_status prepare(struct dea_context *ctx, struct dea_line_supply *s)
{
  const struct raw *raw = s->raw_all;
  const char *name = s->link.socket.name, *answer;
  char command[DEA_LINE_SUPPLY_COMMAND_SIZE];
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, "QName", &answer));
  if (!is_named(raw, answer)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s is a '%.60s', not a '%.60s'; look at its device",
                    name, answer, raw->name.text);
  }
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, "QVmax", &answer));
  if (!is_number(answer, &s->range_V) || !(s->range_V > 0)) {
    return dea_fail(ctx, DEA_E_INSTRUMENT, "%s answered '%.40s' to 'QVmax', which is no voltage",
                    name, answer);
  }
  // A frequency that nothing plays with: one that begins anew has another, and so has another's.
  snprintf(command, sizeof command, "SF%.2f",
           marks_from_Hz + 0.25 * floor(fmod(1e3 * dea_clock_s(), marks)));
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, command, NULL));
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, "QF", &answer));
  snprintf(s->base.mark, sizeof s->base.mark, "%.*s", (int)sizeof s->base.mark - 1, answer);
  DEA_TRY(ctx, dea_line_supply_query(ctx, s, "SSwSrc0", NULL));
  return dea_line_supply_query(ctx, s, "SSwMode1", NULL);
}

static const char *const off[] = {"SSwMode0", NULL};
static const struct dea_line_supply_language language = {
    .what = "the SHVPS",
    .set = "SVset",
    .is_set = is_set,
    .sync = "QName",
    .is_synced = is_synced,
    .is_named = is_named,
    .measure = "QVnow",
    .voltage = is_number,
    .off = off,
    .is_error = is_error,
    .prepare = prepare,
    .mark = "QF",
};

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *raw, const struct dea_protocol *protocol)
{
  return dea_line_supply_open(ctx, instrument, &language, raw, protocol);
}

static struct dea_zero zero(struct dea_context *ctx, const void *raw,
                            const struct dea_protocol *protocol,
                            const struct dea_instrument_past *past)
{
  return dea_line_supply_zero(ctx, &language, raw, protocol, past);
}

const struct dea_instrument_type dea_instrument_shvps = {
    .name = "shvps",
    .record = &dea_instrument_shvps_record,
    .raw_size = sizeof(struct raw),
    .check = dea_line_supply_check,
    .open = open_it,
    .zero = zero,
    DEA_LINE_SUPPLY_MEMBERS,
};
