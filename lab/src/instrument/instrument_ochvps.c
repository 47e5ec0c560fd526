/* Instrument "ochvps": the open high-voltage supply with eight channels on its USB serial line. One
 * voltage for all, which half bridges switch to the channels. Answers begin with what was asked, in
 * brackets: "SHV <V>" by "[HV] x.x", "QMes" by "[QMes] HV = .. V // LV = .. V", "EStop" by
 * "[EStop]". What its other commands answer says their user. Source: the public description of its
 * commands (EPFL, LMTS).
 */
#include "base/schema_value.h"
#include "base/text.h"
#include "instrument/line_supply.h"

#include <math.h>
#include <string.h>

enum { COMMANDS_MAX = 16 };

struct raw {
  struct dea_line_supply_raw line;
  struct dea_label connect[COMMANDS_MAX];
  size_t connect_count;
};

static const struct dea_field fields[] = {
    DEA_LINE_SUPPLY_ROWS(struct raw, "ochvps", "115200"),
    {.key = "connect",
     .kind = DEA_FIELD_LABEL,
     DEA_INSTRUMENT_LIST_OF(struct raw, connect, connect_count, COMMANDS_MAX),
     .list_min = 1,
     .required = true,
     .doc =
         "commands SM... that put its channels under the voltage, sent at 0 V; each is answered by "
         "one line in brackets",
     .example = "[\"SM1 1 255 1 100 0 0 0\"]"},
};
const struct dea_record dea_instrument_ochvps_record = {
    "ochvps", "the open high-voltage supply with eight channels on its USB serial line", fields,
    DEA_INSTRUMENT_COUNT(fields)};

/* The number behind a text, and where it ends. */
static bool number_behind(const char *answer, const char *text, double *value, const char **end)
{
  size_t length = strlen(text);
  if (strncmp(answer, text, length) != 0) {
    return false;
  }
  const char *at = answer + length + strspn(answer + length, " ");
  *value = dea_text_to_double(at, end);
  return *end != at && isfinite(*value);
}

static bool is_error(const char *answer)
{
  return answer[0] != '[';
}

static bool is_set(const char *answer, long volts)
{
  double value;
  const char *end;
  return number_behind(answer, "[HV]", &value, &end) && fabs(value - (double)volts) <= 1;
}

static bool is_synced(const char *answer)
{
  return is_set(answer, 0);
}

static bool voltage(const char *answer, double *volts)
{
  const char *end;
  return number_behind(answer, "[QMes] HV =", volts, &end) && strncmp(end, " V", 2) == 0;
}

/* Its range is the protocol's: how it tells its own is not known. */
static dea_status prepare(struct dea_context *ctx, struct dea_line_supply *s)
{
  const struct raw *raw = s->raw_all;
  s->range_V = s->protocol->amplifier.highest_V.si;
  for (size_t i = 0; i < raw->connect_count; i++) {
    DEA_TRY(ctx, dea_line_supply_query(ctx, s, raw->connect[i].text, NULL));
  }
  return DEA_OK;
}

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  for (size_t i = 0; i < raw->connect_count; i++) {
    const struct dea_label *command = &raw->connect[i];
    if (strncmp(command->text, "SM", 2) != 0 || strpbrk(command->text, "\r\n;") != NULL ||
        strlen(command->text) >= DEA_LINE_SUPPLY_COMMAND_SIZE) {
      DEA_TRY(reader->ctx,
              dea_schema_error(reader, command->location,
                               "refused: '%.40s' is none of the commands SM... that connect "
                               "channels; the voltage is set by the sequence only",
                               command->text));
    }
  }
  return dea_line_supply_check(reader, data, protocol);
}

static const char *const off[] = {"EStop", NULL};
static const struct dea_line_supply_language language = {
    .what = "the OCHVPS",
    .set = "SHV ",
    .is_set = is_set,
    .sync = "SHV 0",
    .is_synced = is_synced,
    .measure = "QMes",
    .voltage = voltage,
    .off = off,
    .is_error = is_error,
    .prepare = prepare,
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

const struct dea_instrument_type dea_instrument_ochvps = {
    .name = "ochvps",
    .record = &dea_instrument_ochvps_record,
    .raw_size = sizeof(struct raw),
    .check = check,
    .open = open_it,
    .zero = zero,
    DEA_LINE_SUPPLY_MEMBERS,
};
