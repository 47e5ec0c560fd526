/* Reading protocols. */
#include "base/file.h"
#include "base/file_kind.h"
#include "base/schema_value.h"
#include "base/text.h"
#include "base/units.h"
#include "protocol/protocol.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

// The table of keys -------------------------------------------------------------------------------

/* But for those of the instruments, whose kinds know them: `dea schema --protocol` prints it with
 * theirs. */

/* A protocol as the table reads it, before what is derived from several values. */
struct raw {
  struct dea_protocol protocol;
  struct dea_quantity version;
  const struct dea_node *waveform; // instead of a sequence
  struct dea_protocol_step steps[DEA_PROTOCOL_STEPS_MAX];
  struct dea_protocol_input inputs[DEA_PROTOCOL_INPUTS_MAX];
};

#define AT(member) offsetof(struct raw, protocol.member)
#define RAW(member) offsetof(struct raw, member)
#define STEP(member) offsetof(struct dea_protocol_step, member)
#define INPUT(member) offsetof(struct dea_protocol_input, member)

enum { SEQUENCE_GROUP = 1, FIELD_GROUP };

static const struct dea_field step_fields[] = {
    DEA_LABEL_ROW("label", STEP(label), "cyclic", "name of the step, for messages and figures",
                  .absent_text = "none", .one_line = true),
    DEA_FIELD_ROW(SECTION, "waveform", STEP(section), .kinds = dea_wave_records, .required = true,
                  .doc = "voltage asked of the amplifier; its keys go with its kind",
                  .example = "{kind: square, high: 7 kV, frequency: 0.5 Hz}"),
    DEA_INTEGER_ROW("repeat", STEP(repeat), "3", "how often the waveform is played", .min = 1,
                    .max = 1e6, .default_text = "1"),
    DEA_NUMBER_ROW("pause", STEP(pause_s), "s", "2 s", "rest at 0 V after the last one", .max = 1e6,
                   .default_text = "0 s"),
};

static const struct dea_field amplifier_fields[] = {
    DEA_LABEL_ROW("name", AT(amplifier.name), "Trek 10/10B-HS", "make and type, for messages",
                  .absent_text = "none", .one_line = true),
    DEA_LABEL_ROW("output", AT(amplifier.terminal), "ao0", "output of the DAQ that controls it",
                  .default_text = "ao0"),
    DEA_NUMBER_ROW("gain", AT(amplifier.gain), "1", "1000 V/V",
                   "voltage of its output over its control voltage", .above_min = true, .max = 1e6,
                   .required = true),
    DEA_NUMBER_ROW("control", AT(amplifier.control_V), "V", "10 V",
                   "largest control voltage of either sign", .above_min = true, .max = 100,
                   .default_text = "10 V"),
    DEA_NUMBER_ROW("max_voltage", AT(amplifier.highest_V), "V", "10 kV",
                   "highest voltage of its output", .above_min = true, .max = 1e6,
                   .required = true),
    DEA_NUMBER_ROW("min_voltage", AT(amplifier.lowest_V), "V", "-10 kV",
                   "lowest voltage of its output; 0 kV: it gives one sign only", .min = -1e6,
                   .max = 0, .absent_text = "-max_voltage"),
    DEA_NUMBER_ROW("slew_limit", AT(amplifier.slew_V_per_s), "V/s", "700 V/us",
                   "fastest change of its output", .above_min = true, .max = 1e15,
                   .absent_text = "none"),
    DEA_NUMBER_ROW("current_limit", AT(amplifier.current_A), "A", "10 mA",
                   "largest current of its output", .above_min = true, .max = 1e3,
                   .absent_text = "none"),
};

static const struct dea_field input_fields[] = {
    DEA_LABEL_ROW("name", INPUT(name), "centre laser", "name of the channel in the recording",
                  .required = true, .one_line = true),
    DEA_CHOICE_ROW("quantity", INPUT(kind), &dea_channel_names[DEA_CHANNEL_COMMAND + 1],
                   "displacement", "what it measures", .required = true),
    DEA_LABEL_ROW("input", INPUT(terminal), "ai0", "input of the DAQ that it is connected to",
                  .required = true),
    DEA_NUMBER_ROW("range", INPUT(range_V), "V", "5 V", "range of the input, of either sign",
                   .above_min = true, .max = 1000, .default_text = "10 V"),
    DEA_LABEL_ROW(
        "per_volt", INPUT(per_volt_text), "1 kV",
        "what one volt at the input means, in a unit of the quantity ('1 mm' or '1 mm/V'); "
        "negative: reversed",
        .required = true),
    DEA_LABEL_ROW("at_zero", INPUT(at_zero_text), "-2 mm", "what 0 V at the input means",
                  .absent_text = "0"),
    DEA_LABEL_ROW("unit", INPUT(unit), "degC",
                  "unit of a quantity `other`, as the recording shall name it",
                  .absent_text = "that of the quantity"),
    DEA_NUMBER_ROW("filter", INPUT(filter_Hz), "Hz", "100 Hz",
                   "cut-off of the low-pass that reductions apply; the recording is kept raw",
                   .above_min = true, .max = 1e9, .absent_text = "none"),
};

static const struct dea_field safety_fields[] = {
    DEA_NUMBER_ROW("field_margin", AT(safety.field_margin), "1", "1.2",
                   "breakdown field of the film's material over its largest true field, at least",
                   .min = 1, .max = 100, .default_text = "1.2", .group = FIELD_GROUP, .option = 1),
    DEA_NUMBER_ROW("largest_field", AT(safety.largest_field_V_per_m), "V/m", "100 V/um",
                   "largest true field that is allowed, in place of the material's",
                   .above_min = true, .max = 1e9, .group = FIELD_GROUP, .option = 2),
    DEA_LABEL_ROW(
        "field_reason", AT(safety.field_reason), "such films stood 8 kV in May",
        "why largest_field may be above the material's breakdown field, or beyond pull-in",
        .absent_text = "no field above breakdown"),
    DEA_NUMBER_ROW(
        "trip_current", AT(safety.trip_current_A), "A", "1 mA",
        "current that ends the measurement when it lasts; needs a channel of the current",
        .above_min = true, .max = 1, .default_text = "1 mA"),
    DEA_NUMBER_ROW("trip_time", AT(safety.trip_time_s), "s", "10 ms",
                   "how long it has to last: longer than charging the film takes, at most 0.1 s",
                   .max = 1e3, .default_text = "10 ms"),
    DEA_INTEGER_ROW(
        "trip_count", AT(safety.trip_count), "5",
        "how often within 10 s it may be exceeded for a shorter time, charging apart: arcs",
        .min = 1, .max = 100, .default_text = "5"),
    DEA_NUMBER_ROW(
        "voltage_error", AT(safety.voltage_error_V), "V", "200 V",
        "difference of measured and asked voltage that ends the measurement when it lasts; "
        "needs a channel of the voltage",
        .above_min = true, .max = 1e6, .default_text = "200 V"),
    DEA_NUMBER_ROW("readback_error", AT(safety.readback_error), "1", "5 %",
                   "share of the asked voltage by which the measured one may be off for 5 s",
                   .min = 0.01, .max = 0.2, .default_text = "5 %"),
    DEA_NUMBER_ROW(
        "leak_rise", AT(safety.leak_rise), "1", "100 %",
        "rise of the leakage current that ends the measurement when it lasts, as a share "
        "of its base line, that of earlier equal cycles",
        .min = 0.1, .max = 4, .default_text = "100 %"),
    DEA_NUMBER_ROW("leak_time", AT(safety.leak_time_s), "s", "5 s",
                   "how long it has to last, of the time under voltage", .min = 0.5, .max = 60,
                   .default_text = "5 s"),
    DEA_NUMBER_ROW("leak_least", AT(safety.leak_least_A), "A", "10 uA",
                   "rise of the leakage current that is none yet; at most a fifth of trip_current",
                   .above_min = true, .max = 1, .absent_text = "a hundredth of trip_current"),
    DEA_NUMBER_ROW("ramp", AT(safety.ramp_V_per_s), "V/s", "5 kV/s",
                   "how fast the voltage goes to 0 V when the measurement ends early",
                   .above_min = true, .max = 1e12, .default_text = "5 kV/s"),
    DEA_NUMBER_ROW("at_zero", AT(safety.at_zero_V), "V", "50 V",
                   "largest voltage read back that still is 0 V", .above_min = true, .max = 1e4,
                   .default_text = "50 V"),
    DEA_NUMBER_ROW("longest_ramp", AT(safety.longest_ramp_s), "s", "5 s",
                   "longest time that this takes; where the ramp would take longer it is faster",
                   .above_min = true, .max = 60, .default_text = "5 s"),
    DEA_NUMBER_ROW(
        "guard_time", AT(safety.guard_time_s), "s", "1 s",
        "longest time that the program may give no sign of life, before its guard brings the "
        "output to 0 V",
        .min = 0.2, .max = 60, .default_text = "1 s"),
    DEA_NUMBER_ROW("zero_time", AT(safety.zero_time_s), "s", "5 s",
                   "longest time after the end within which 0 V has to be read back",
                   .above_min = true, .max = 60, .default_text = "5 s"),
};

static const struct dea_record step_record = {"step", "one step of the sequence", step_fields,
                                              DEA_COUNT(step_fields)};
static const struct dea_record amplifier_record = {"amplifier", "the high-voltage amplifier",
                                                   amplifier_fields, DEA_COUNT(amplifier_fields)};
static const struct dea_record input_record = {"channel", "an analogue input", input_fields,
                                               DEA_COUNT(input_fields)};
static const struct dea_record safety_record = {"safety", "what must not be exceeded",
                                                safety_fields, DEA_COUNT(safety_fields)};

static const struct dea_field protocol_fields[] = {
    DEA_INTEGER_ROW("dea-protocol", RAW(version), "1", "version of the format of protocols",
                    .min = DEA_PROTOCOL_VERSION, .max = DEA_PROTOCOL_VERSION, .required = true),
    DEA_LABEL_ROW("title", AT(title), "Cyclic measurement, four fibres",
                  "what is measured, for recordings and figures", .absent_text = "none",
                  .one_line = true),
    DEA_LABEL_ROW("design", AT(design_file), "frdea-4.yaml",
                  "design file of the film on the bench; its path counts from this file's folder",
                  .absent_text = "none: field and pull-in are not checked"),
    DEA_LABEL_ROW(
        "specimen", AT(specimen_file), "F12.yaml",
        "file of the one film on the bench: dea-specimen: 1, name, max_voltage, note; its "
        "largest voltage is changed by no option",
        .absent_text = "none"),
    DEA_FIELD_ROW(RECORD, "sequence", RAW(steps), .record = &step_record, .group = SEQUENCE_GROUP,
                  .option = 1, .doc = "what is played, one after the other; between them 0 V",
                  DEA_LIST(1, DEA_PROTOCOL_STEPS_MAX, struct dea_protocol_step, AT(step_count))),
    DEA_FIELD_ROW(SECTION, "waveform", RAW(waveform), .kinds = dea_wave_records,
                  .group = SEQUENCE_GROUP, .option = 2,
                  .doc = "one waveform that is played once, in place of a sequence",
                  .example = "{kind: square, high: 7 kV, frequency: 0.5 Hz}"),
    DEA_FIELD_ROW(RECORD, "amplifier", 0, .record = &amplifier_record, .required = true,
                  .doc = "the high-voltage amplifier"),
    DEA_NUMBER_ROW("rate", AT(rate_Hz), "Hz", "1 kHz",
                   "samples a second, of the output and of every channel", .above_min = true,
                   .max = 1e7, .default_text = "1 kHz"),
    DEA_FIELD_ROW(RECORD, "channels", RAW(inputs), .record = &input_record, .absent_text = "none",
                  .doc = "analogue inputs: value = volts x per_volt + at_zero",
                  DEA_LIST(1, DEA_PROTOCOL_INPUTS_MAX, struct dea_protocol_input, AT(input_count))),
    DEA_FIELD_ROW(RECORD, "safety", 0, .record = &safety_record,
                  .doc = "what must not be exceeded"),
    DEA_FIELD_ROW(SECTION, "instruments", AT(instruments),
                  .absent_text = "none: only --sim and --export",
                  .doc = "what plays and measures; each with its kind and the keys of that",
                  .example = "[{kind: nidaqmx}, {kind: gocator, address: 192.168.1.10}]",
                  DEA_LIST(1, DEA_PROTOCOL_INSTRUMENTS_MAX, struct dea_protocol_instrument,
                           AT(instrument_count))),
    DEA_FIELD_ROW(SECTION, "sim", AT(sim), .absent_text = "its defaults",
                  .doc = "the simulated bench of --sim", .example = "{seed: 2}"),
};

static const struct dea_record protocol_record = {"protocol",
                                                  "protocol of a measurement on the bench",
                                                  protocol_fields, DEA_COUNT(protocol_fields)};

void dea_protocol_schema_fill(const struct dea_record *const *instruments,
                              const struct dea_record *const *sim, struct dea_protocol_schema *out)
{
  *out = (struct dea_protocol_schema){.record = protocol_record};
  memcpy(out->fields, protocol_fields, sizeof protocol_fields);
  out->record.fields = out->fields;
  for (size_t i = 0; i < DEA_COUNT(protocol_fields); i++) {
    struct dea_field *field = &out->fields[i];
    field->kinds = field->offset == AT(instruments) ? instruments
                   : field->offset == AT(sim)       ? sim
                                                    : field->kinds;
  }
}

// Channels ---------------------------------------------------------------------------------------

/* What is due in `per_volt` and `at_zero` of each kind. */
static const char *const examples[DEA_CHANNEL_KINDS] = {
    [DEA_CHANNEL_COMMAND] = "1 kV", [DEA_CHANNEL_VOLTAGE] = "1 kV",
    [DEA_CHANNEL_CURRENT] = "1 mA", [DEA_CHANNEL_DISPLACEMENT] = "0.2 mm",
    [DEA_CHANNEL_FORCE] = "0.05 N", [DEA_CHANNEL_OTHER] = "1",
};

/* A number in the unit of an input's quantity; of others in the unit that it names. */
static dea_status read_scale(const struct dea_reader *reader,
                             const struct dea_protocol_input *input, const char *key,
                             const struct dea_label *text, double *out)
{
  char number[DEA_TITLE_SIZE], why[DEA_WHY_SIZE];
  bool other = input->kind.value == DEA_CHANNEL_OTHER;
  size_t length = strlen(text->text), unit = strlen(input->unit.text);
  if (strcmp(key, "per_volt") == 0 && dea_text_ends_with(text->text, "/V") &&
      !dea_text_ends_with(input->unit.text, "/V")) {
    length -= 2; // 'per volt' said twice: '2.5 mm/V'
  }
  if (other && unit > 0 && length > unit &&
      strncmp(text->text + length - unit, input->unit.text, unit) == 0) {
    length -= unit;
    while (length > 0 && text->text[length - 1] == ' ') {
      length--;
    }
  }
  snprintf(number, sizeof number, "%.*s", (int)length, text->text);
  const struct dea_measure due = {other ? "1" : dea_channel_meanings[input->kind.value].si_unit,
                                  examples[input->kind.value]};
  if (dea_units_read(reader->ctx, number, due, out, why)) {
    return DEA_OK;
  }
  return why[0] == '\0' ? dea_context_status(reader->ctx)
                        : dea_schema_error(reader, text->location, "%s: %s", key, why);
}

static dea_status read_input(const struct dea_reader *reader, struct dea_protocol_input *input)
{
  if (input->kind.value < 0) {
    return DEA_OK; // already an error
  }
  input->kind.value += DEA_CHANNEL_COMMAND + 1; // the choices begin after it
  if (strlen(input->name.text) >= DEA_CHANNEL_NAME_SIZE ||
      strlen(input->unit.text) >= DEA_CHANNEL_NAME_SIZE) {
    DEA_TRY(reader->ctx, dea_schema_error(reader, input->name.location,
                                          "a channel's name and unit have at most %d bytes",
                                          DEA_CHANNEL_NAME_SIZE - 1));
  }
  if (input->unit.text[0] != '\0' && input->kind.value != DEA_CHANNEL_OTHER) {
    DEA_TRY(reader->ctx,
            dea_schema_error(reader, input->unit.location,
                             "unit: only of a quantity `other`; the recording keeps %s in %s",
                             dea_channel_names[input->kind.value],
                             dea_channel_meanings[input->kind.value].si_unit));
  }
  input->per_volt = 1;
  if (input->per_volt_text.origin != DEA_ABSENT) {
    DEA_TRY(reader->ctx,
            read_scale(reader, input, "per_volt", &input->per_volt_text, &input->per_volt));
    if (input->per_volt == 0) {
      DEA_TRY(reader->ctx,
              dea_schema_error(reader, input->per_volt_text.location,
                               "per_volt must not be 0, not '%.60s'", input->per_volt_text.text));
    }
  }
  if (input->at_zero_text.origin != DEA_ABSENT) {
    DEA_TRY(reader->ctx,
            read_scale(reader, input, "at_zero", &input->at_zero_text, &input->at_zero));
  }
  return DEA_OK;
}

/* Names and terminals are unique. */
static dea_status read_inputs(const struct dea_reader *reader, struct raw *raw)
{
  struct dea_protocol *protocol = &raw->protocol;
  for (size_t i = 0; i < protocol->input_count; i++) {
    struct dea_protocol_input *input = &raw->inputs[i];
    DEA_TRY(reader->ctx, read_input(reader, input));
    for (size_t k = 0; k < i; k++) {
      const struct dea_protocol_input *other = &raw->inputs[k];
      if (input->name.text[0] != '\0' && strcmp(input->name.text, other->name.text) == 0) {
        DEA_TRY(reader->ctx, dea_schema_error(reader, input->name.location,
                                              "the channel in line %zu has the name '%.60s' too",
                                              other->name.location.line, input->name.text));
      }
      if (input->terminal.text[0] != '\0' &&
          strcmp(input->terminal.text, other->terminal.text) == 0) {
        DEA_TRY(reader->ctx,
                dea_schema_error(reader, input->terminal.location,
                                 "the channel '%.60s' is connected to the input '%.60s' too",
                                 other->name.text, input->terminal.text));
      }
    }
  }
  return DEA_OK;
}

// Sequence ---------------------------------------------------------------------------------------

static dea_status count_cycles(struct dea_context *ctx, struct dea_protocol_step *step)
{
  struct dea_wave_cycle cycle;
  size_t low = 0, high = 1;
  while (dea_waveform_cycle(step->waveform, high - 1, &cycle)) {
    low = high;
    high *= 2;
  }
  while (high - low > 1) { // the cycle number low - 1 is there, number high - 1 is not
    size_t middle = low + (high - low) / 2;
    *(dea_waveform_cycle(step->waveform, middle - 1, &cycle) ? &low : &high) = middle;
  }
  step->cycles = low > 0 ? low : 1;
  if (step->waveform->end_s > 0) {
    return DEA_OK;
  }
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): each step has its section
  return dea_finding_add(ctx, DEA_ERROR, step->section->location,
                         "this waveform takes no time; give it a duration");
}

/* What every step begins at; longer than numbers can count is an error. */
static dea_status read_clock(struct dea_context *ctx, struct raw *raw)
{
  static const double cycles_max = 1e9;
  double start_s = 0, cycles = 0;
  for (size_t i = 0; i < raw->protocol.step_count; i++) {
    struct dea_protocol_step *step = &raw->steps[i];
    step->start_s = start_s;
    step->first_cycle = (size_t)cycles;
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): called without errors only
    start_s += step->repeat.si * step->waveform->end_s + step->pause_s.si;
    cycles += step->repeat.si * (double)step->cycles;
    if (cycles > cycles_max) {
      return dea_finding_add(ctx, DEA_ERROR, step->repeat.location,
                             "the sequence has more than %g cycles", cycles_max);
    }
  }
  return DEA_OK;
}

/* errors: their number before the file was read. */
static dea_status read_sequence(const struct dea_reader *reader, struct raw *raw, size_t errors)
{
  struct dea_context *ctx = reader->ctx;
  struct dea_protocol *protocol = &raw->protocol;
  const struct dea_node *root = dea_yaml_root(protocol->document);
  if (raw->waveform != NULL) {
    protocol->step_count = 1;
    raw->steps[0] = (struct dea_protocol_step){
        .section = raw->waveform,
        .repeat = {1, DEA_DEFAULT, raw->waveform->key_place},
        .pause_s = {0, DEA_DEFAULT, raw->waveform->key_place},
    };
  } else if (protocol->step_count == 0 && dea_node_find(root, "sequence") == NULL &&
             dea_node_find(root, "waveform") == NULL) {
    return dea_schema_error(reader, root->location,
                            "the file lacks what is to be played; write for example 'waveform: "
                            "{kind: square, high: 7 kV, frequency: 0.5 Hz}', or a 'sequence' of "
                            "such steps");
  }
  for (size_t i = 0; i < protocol->step_count; i++) {
    char path[DEA_KEY_PATH_SIZE] = "waveform";
    if (raw->waveform == NULL) {
      snprintf(path, sizeof path, "sequence[%zu].waveform", i);
    }
    if (raw->steps[i].section != NULL) {
      DEA_TRY(ctx, dea_waveform_read(reader, raw->steps[i].section, path, protocol->file,
                                     &raw->steps[i].waveform));
    }
    if (raw->steps[i].waveform != NULL) {
      struct dea_wave_extent extent;
      dea_waveform_extent(raw->steps[i].waveform, &extent);
      raw->steps[i].lowest_V = extent.lowest_V;
      raw->steps[i].highest_V = extent.highest_V;
      DEA_TRY(ctx, count_cycles(ctx, &raw->steps[i]));
    }
  }
  // A step may lack its waveform, or a number of it.
  return dea_finding_count(ctx, DEA_ERROR) == errors ? read_clock(ctx, raw) : DEA_OK;
}

// The specimen ------------------------------------------------------------------------------------

/* Its own file: what it stands, which no option of a command changes. */
struct specimen_raw {
  struct dea_quantity version, highest_V;
  struct dea_label name, note;
};

static const struct dea_field specimen_fields[] = {
    DEA_INTEGER_ROW("dea-specimen", offsetof(struct specimen_raw, version), "1",
                    "version of the format of specimens", .min = 1, .max = 1, .required = true),
    DEA_LABEL_ROW("name", offsetof(struct specimen_raw, name), "F12", "what is written on it",
                  .required = true, .one_line = true),
    DEA_NUMBER_ROW("max_voltage", offsetof(struct specimen_raw, highest_V), "V", "6 kV",
                   "largest voltage that it may see, of either sign", .above_min = true, .max = 1e6,
                   .required = true),
    DEA_LABEL_ROW("note", offsetof(struct specimen_raw, note), "cleared once at 6.2 kV",
                  "why that voltage; what has happened to it", .absent_text = "none"),
};
static const struct dea_record specimen_record = {
    "specimen", "what one film stands", specimen_fields,
    sizeof specimen_fields / sizeof specimen_fields[0]};

static dea_status read_specimen_text(struct dea_context *ctx, const char *path, const char *text,
                                     size_t length, struct dea_specimen *out)
{
  struct dea_yaml *yaml;
  struct specimen_raw raw = {.version.si = 0};
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status = dea_yaml_parse(ctx, path, text, length, &yaml);
  if (status != DEA_OK) {
    return status == DEA_E_DESIGN ? DEA_OK : status;
  }
  const struct dea_reader reader = {ctx, yaml, NULL};
  status = dea_schema_read(&reader, &specimen_record, dea_yaml_root(yaml), "", &raw);
  dea_yaml_destroy(ctx, yaml);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    *out = (struct dea_specimen){raw.name, raw.highest_V};
  }
  return status;
}

static dea_status read_specimen(struct dea_context *ctx, const char *beside,
                                const struct dea_label *file, struct dea_specimen *out)
{
  char *text = NULL;
  size_t length;
  *out = (struct dea_specimen){.highest_V = {NAN, DEA_ABSENT, file->location}};
  if (file->origin == DEA_OVERRIDE) {
    return dea_finding_add(ctx, DEA_ERROR, file->location,
                           "specimen: only the protocol itself says which specimen it is for; no "
                           "option changes that");
  }
  if (file->origin == DEA_ABSENT) {
    return DEA_OK;
  }
  char *path = dea_path_beside(ctx, beside, file->text);
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, &text, &length);
  if (status == DEA_OK) {
    status = read_specimen_text(ctx, path, text, length, out);
  } else if (status == DEA_E_IO) {
    status = dea_finding_add(ctx, DEA_ERROR, file->location,
                             "specimen: %s; a path counts from the protocol's folder",
                             dea_context_message(ctx));
  }
  dea_free(ctx, text);
  dea_free(ctx, path);
  return status == DEA_E_DESIGN ? DEA_OK : status; // counted with the others
}

// Design, instruments ----------------------------------------------------------------------------

/* The design that the file names: what is wrong in it stands at its own places. */
static dea_status read_design(struct dea_context *ctx, const struct dea_bench_film_type *films,
                              struct dea_protocol *protocol)
{
  size_t length;
  if (protocol->design_file.text[0] == '\0') {
    return DEA_OK;
  }
  char *path = dea_path_beside(ctx, protocol->file, protocol->design_file.text);
  DEA_TRY_MEMORY(path != NULL);
  dea_status status = dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, &protocol->design_text, &length);
  if (status == DEA_E_IO) {
    status = dea_finding_add(ctx, DEA_ERROR, protocol->design_file.location,
                             "design: %s; a path counts from the protocol's folder",
                             dea_context_message(ctx));
  } else if (status == DEA_OK) {
    status = films->read(ctx, path, protocol->design_text, length, &protocol->film);
  }
  dea_free(ctx, path);
  return status == DEA_E_DESIGN ? DEA_OK : status; // counted with the others
}

static dea_status read_instruments(struct dea_context *ctx, struct dea_protocol *protocol)
{
  for (size_t i = 0; i < protocol->instrument_count; i++) {
    char path[48];
    snprintf(path, sizeof path, "instruments[%zu]", i);
    protocol->instruments[i].path = dea_intern(ctx, path);
    DEA_TRY_MEMORY(protocol->instruments[i].path != NULL);
  }
  protocol->sim.path = "sim";
  return DEA_OK;
}

/* What has no default of its own. */
static dea_status read_amplifier(struct dea_context *ctx, struct dea_protocol *protocol)
{
  const struct dea_quantity *highest = &protocol->amplifier.highest_V;
  if (protocol->amplifier.lowest_V.origin == DEA_ABSENT && highest->origin != DEA_ABSENT) {
    protocol->amplifier.lowest_V =
        (struct dea_quantity){-highest->si, DEA_DEFAULT, highest->location};
  }
  if (protocol->input_count + 1 > DEA_CHANNELS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "more channels than a recording can have");
  }
  return DEA_OK;
}

// The whole file ---------------------------------------------------------------------------------

static dea_status parse(struct dea_context *ctx, struct dea_protocol *protocol, size_t length,
                        const struct dea_override *overrides, size_t override_count)
{
  struct dea_text said = {.ctx = ctx};
  DEA_TRY(ctx, dea_yaml_parse(ctx, protocol->file, protocol->text, length, &protocol->document));
  for (size_t i = 0; i < override_count; i++) {
    dea_status status =
        dea_yaml_override(ctx, protocol->document, overrides[i].key, overrides[i].value);
    if (status != DEA_OK && status != DEA_E_DESIGN) {
      dea_text_free(&said);
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
    dea_text_add(&said, "%s%s=%s", i > 0 ? "; " : "", overrides[i].key, overrides[i].value);
  }
  protocol->overrides = said.data;
  return said.failed ? DEA_E_MEMORY : DEA_OK;
}

/* The simulated bench is always there: what is not said of it has defaults. */
static dea_status complete_sim(struct dea_context *ctx, struct dea_yaml *document)
{
  const struct dea_node *root = dea_yaml_root(document), *sim;
  if (root->kind != DEA_NODE_SECTION) {
    return DEA_OK;
  }
  sim = dea_node_find(root, "sim");
  if (sim != NULL && (sim->kind != DEA_NODE_SECTION || dea_node_find(sim, "kind") != NULL)) {
    return DEA_OK;
  }
  return dea_yaml_override(ctx, document, "sim.kind", "sim");
}

static dea_status copy_lists(struct dea_context *ctx, struct raw *raw)
{
  struct dea_protocol *protocol = &raw->protocol;
  protocol->inputs = dea_alloc(ctx, protocol->input_count, sizeof *protocol->inputs);
  protocol->steps = dea_alloc(ctx, protocol->step_count, sizeof *protocol->steps);
  DEA_TRY_MEMORY(protocol->inputs != NULL && protocol->steps != NULL);
  memcpy(protocol->inputs, raw->inputs, protocol->input_count * sizeof *protocol->inputs);
  memcpy(protocol->steps, raw->steps, protocol->step_count * sizeof *protocol->steps);
  return DEA_OK;
}

/* Fills *raw; what it owns is in raw->protocol and in its steps, also after a failure. */
static dea_status read_raw(struct dea_context *ctx, const struct dea_bench_film_type *films,
                           const char *file, const char *text, size_t length,
                           const struct dea_override *overrides, size_t override_count,
                           struct raw *raw)
{
  struct dea_protocol *protocol = &raw->protocol;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  protocol->file = dea_intern(ctx, file);
  protocol->text = dea_alloc(ctx, length + 1, 1);
  DEA_TRY_MEMORY(protocol->file != NULL && protocol->text != NULL);
  memcpy(protocol->text, text, length);
  DEA_TRY(ctx, parse(ctx, protocol, length, overrides, override_count));
  DEA_TRY(ctx, complete_sim(ctx, protocol->document));
  const struct dea_node *root = dea_yaml_root(protocol->document);
  const struct dea_reader reader = {ctx, protocol->document, &protocol->values};
  DEA_TRY(ctx, dea_file_kind_check(ctx, protocol->document, "dea-protocol"));
  DEA_TRY(ctx, dea_schema_read(&reader, &protocol_record, root, "", raw));
  if (films == NULL) { // 0 V waits for no other file
    protocol->step_count = 0;
    protocol->specimen.highest_V = (struct dea_quantity){.si = NAN, .origin = DEA_ABSENT};
  } else if (root->kind == DEA_NODE_SECTION) {
    DEA_TRY(ctx, read_sequence(&reader, raw, errors));
  }
  if (root->kind == DEA_NODE_SECTION) {
    DEA_TRY(ctx, read_inputs(&reader, raw));
    DEA_TRY(ctx, read_amplifier(ctx, protocol));
    DEA_TRY(ctx, read_instruments(ctx, protocol));
  }
  if (root->kind == DEA_NODE_SECTION && films != NULL) {
    DEA_TRY(ctx, read_design(ctx, films, protocol));
    DEA_TRY(ctx, read_specimen(ctx, protocol->file, &protocol->specimen_file, &protocol->specimen));
  }
  size_t found = dea_finding_count(ctx, DEA_ERROR) - errors;
  if (found > 0) {
    return dea_fail(ctx, DEA_E_DESIGN, "'%s' has %zu error%s", file, found, found > 1 ? "s" : "");
  }
  return copy_lists(ctx, raw);
}

/* Frees what a protocol owns but its steps' waveforms. */
static void clear(struct dea_context *ctx, struct dea_protocol *protocol)
{
  if (protocol->film != NULL) {
    protocol->film->type->destroy(ctx, protocol->film);
  }
  dea_free(ctx, protocol->text);
  dea_free(ctx, protocol->design_text);
  dea_free(ctx, protocol->overrides);
  dea_free(ctx, protocol->steps);
  dea_free(ctx, protocol->inputs);
  dea_listing_free(ctx, &protocol->values);
  dea_yaml_destroy(ctx, protocol->document);
}

static void clear_steps(struct dea_protocol_step *steps, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    dea_waveform_destroy(steps[i].waveform);
  }
}

dea_status dea_protocol_read_memory(struct dea_context *ctx,
                                    const struct dea_bench_film_type *films, const char *file,
                                    const char *text, size_t length,
                                    const struct dea_override *overrides, size_t override_count,
                                    struct dea_protocol **out)
{
  *out = NULL;
  struct raw *raw = dea_alloc(ctx, 1, sizeof *raw);
  DEA_TRY_MEMORY(raw != NULL);
  dea_status status = read_raw(ctx, films, file, text, length, overrides, override_count, raw);
  if (status == DEA_OK) {
    *out = dea_alloc(ctx, 1, sizeof **out);
    status = *out != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    **out = raw->protocol;
  } else {
    clear_steps(raw->steps, DEA_PROTOCOL_STEPS_MAX);
    clear(ctx, &raw->protocol);
  }
  dea_free(ctx, raw);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

dea_status dea_protocol_read(struct dea_context *ctx, const struct dea_bench_film_type *films,
                             const char *file, const struct dea_override *overrides,
                             size_t override_count, struct dea_protocol **out)
{
  char *text;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_YAML_SIZE_MAX, &text, &length));
  dea_status status =
      dea_protocol_read_memory(ctx, films, file, text, length, overrides, override_count, out);
  dea_free(ctx, text);
  return status;
}

void dea_protocol_destroy(struct dea_context *ctx, struct dea_protocol *protocol)
{
  if (protocol != NULL) {
    clear_steps(protocol->steps, protocol->step_count);
    clear(ctx, protocol);
    dea_free(ctx, protocol);
  }
}
