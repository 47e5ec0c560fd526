/* The table of all keys of a protocol but those of the instruments, whose kinds know them: `dea
 * schema --protocol` prints it with theirs, the reader reads with it. */
#include "protocol/protocol_schema.h"

#include <stddef.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define AT(member) offsetof(struct dea_protocol_raw, protocol.member)
#define RAW(member) offsetof(struct dea_protocol_raw, member)
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
                                              COUNT(step_fields)};
static const struct dea_record amplifier_record = {"amplifier", "the high-voltage amplifier",
                                                   amplifier_fields, COUNT(amplifier_fields)};
static const struct dea_record input_record = {"channel", "an analogue input", input_fields,
                                               COUNT(input_fields)};
static const struct dea_record safety_record = {"safety", "what must not be exceeded",
                                                safety_fields, COUNT(safety_fields)};

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

const struct dea_record dea_protocol_record = {"protocol", "protocol of a measurement on the bench",
                                               protocol_fields, COUNT(protocol_fields)};

void dea_protocol_schema_fill(const struct dea_record *const *instruments,
                              const struct dea_record *const *sim, struct dea_protocol_schema *out)
{
  *out = (struct dea_protocol_schema){.record = dea_protocol_record};
  memcpy(out->fields, protocol_fields, sizeof protocol_fields);
  out->record.fields = out->fields;
  for (size_t i = 0; i < COUNT(protocol_fields); i++) {
    struct dea_field *field = &out->fields[i];
    field->kinds = field->offset == AT(instruments) ? instruments
                   : field->offset == AT(sim)       ? sim
                                                    : field->kinds;
  }
}
