/* The kinds of waveforms: the keys of each, and how it is made of them. */
#include "base/file.h"
#include "base/schema_value.h"
#include "table/csv_columns.h"
#include "waveform/wave_make.h"

#include <math.h>

static const double two_pi = 6.28318530717958647692;

enum { LEVELS_MAX = 200, VOLTAGE_GROUP = 1 };

/* What the keys of all kinds are read into. */
struct raw {
  struct dea_context *ctx;
  const char *beside; // the file from whose folder paths count
  struct dea_label kind, file;
  struct dea_quantity voltage_V, from_V, to_V, low_V, high_V, mean_V, amplitude_V;
  struct dea_quantity step_V, values_V[LEVELS_MAX];
  size_t value_count;
  struct dea_quantity frequency_Hz, from_Hz, to_Hz, phase_rad, duty;
  struct dea_quantity at_s, rise_s, duration_s, hold_s, pause_s, period_s;
  struct dea_quantity cycles, bursts, repeat;
  struct dea_choice spacing;
};

#define AT(member) offsetof(struct raw, member)
#define KIND DEA_LABEL_ROW("kind", AT(kind), "square", "kind of waveform", .required = true)
/* A voltage of either sign. */
#define VOLTAGE(member, name, text, ...)                                                           \
  DEA_NUMBER_ROW(name, AT(member), "V", "6 kV", text, .min = -1e6, .max = 1e6, __VA_ARGS__)
#define MEAN_AND_AMPLITUDE(where)                                                                  \
  VOLTAGE(mean_V, "mean", "voltage in the middle" where, .default_text = "0 kV"),                  \
      VOLTAGE(amplitude_V, "amplitude", "half of peak to peak", .required = true)
#define FREQUENCY(member, name, text)                                                              \
  DEA_NUMBER_ROW(name, AT(member), "Hz", "0.5 Hz", text, .above_min = true, .max = 1e6,            \
                 .required = true)
#define TIME(member, name, text, ...)                                                              \
  DEA_NUMBER_ROW(name, AT(member), "s", "10 s", text, .max = 1e9, __VA_ARGS__)
#define RISE(text) TIME(rise_s, "rise_time", "how long " text, .default_text = "0 s")
#define CYCLES(member, name, text, usual)                                                          \
  DEA_INTEGER_ROW(name, AT(member), "15", text, .min = 1, .max = 1e6, .default_text = usual)
#define DUTY(text)                                                                                 \
  DEA_NUMBER_ROW("duty", AT(duty), "1", "50 %", text, .above_min = true, .max = 1,                 \
                 .below_max = true, .default_text = "50 %")

// Straight pieces --------------------------------------------------------------------------------

static const struct dea_field constant_fields[] = {
    KIND,
    VOLTAGE(voltage_V, "voltage", "the voltage", .required = true),
    TIME(duration_s, "duration", "how long it lasts", .above_min = true, .default_text = "10 s"),
};

static dea_status build_constant(const struct raw *raw, struct dea_waveform *out)
{
  out->end_s = raw->duration_s.si;
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->voltage_V.si);
  return DEA_OK;
}

static const struct dea_field step_fields[] = {
    KIND,
    VOLTAGE(from_V, "from", "voltage before", .default_text = "0 kV"),
    VOLTAGE(to_V, "to", "voltage after", .required = true),
    TIME(at_s, "at", "when it begins to change", .default_text = "0 s"),
    RISE("the change takes; 0: a jump"),
    TIME(duration_s, "duration", "how long the waveform lasts", .above_min = true,
         .default_text = "10 s"),
};

static dea_status build_step(const struct raw *raw, struct dea_waveform *out)
{
  out->end_s = raw->duration_s.si;
  if (raw->at_s.si + raw->rise_s.si > out->end_s) {
    return dea_finding_add(raw->ctx, DEA_ERROR, raw->duration_s.location,
                           "duration: the step is over after %g s, but the waveform lasts %g s",
                           raw->at_s.si + raw->rise_s.si, out->end_s);
  }
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->from_V.si);
  dea_wave_add(out, 0, raw->at_s.si, raw->from_V.si);
  dea_wave_add(out, 0, raw->at_s.si + raw->rise_s.si, raw->to_V.si);
  return DEA_OK;
}

static const struct dea_field ramp_fields[] = {
    KIND,
    VOLTAGE(from_V, "from", "voltage at the start", .default_text = "0 kV"),
    VOLTAGE(to_V, "to", "voltage at the end", .required = true),
    TIME(duration_s, "duration", "how long the ramp takes", .above_min = true, .required = true),
    TIME(hold_s, "hold", "how long the last voltage stays", .default_text = "0 s"),
};

static dea_status build_ramp(const struct raw *raw, struct dea_waveform *out)
{
  out->end_s = raw->duration_s.si + raw->hold_s.si;
  dea_wave_open(out, 0, 1 / out->end_s, 1);
  dea_wave_add(out, 0, 0, raw->from_V.si);
  dea_wave_add(out, 0, raw->duration_s.si, raw->to_V.si);
  return DEA_OK;
}

static const struct dea_field triangle_fields[] = {
    KIND,
    VOLTAGE(low_V, "low", "voltage at the feet", .default_text = "0 kV"),
    VOLTAGE(high_V, "high", "voltage at the tops", .required = true),
    FREQUENCY(frequency_Hz, "frequency", "cycles a second"),
    DUTY("share of a cycle that the way up takes"),
    CYCLES(cycles, "cycles", "number of cycles", "10"),
};

static dea_status build_triangle(const struct raw *raw, struct dea_waveform *out)
{
  dea_wave_open(out, 0, raw->frequency_Hz.si, (size_t)raw->cycles.si);
  dea_wave_add(out, 0, 0, raw->low_V.si);
  dea_wave_add(out, raw->duty.si, 0, raw->high_V.si);
  dea_wave_add(out, 1, 0, raw->low_V.si);
  out->end_s = raw->cycles.si / raw->frequency_Hz.si;
  return DEA_OK;
}

// Pulses -----------------------------------------------------------------------------------------

/* Adds a block of rectangular pulses up to a voltage: up at the start of each cycle, down after the
 * share `duty` of it, each within the rise time (0: a jump). */
static void add_pulses(struct dea_waveform *out, double start_s, const struct raw *raw,
                       double high_V)
{
  dea_wave_open(out, start_s, raw->frequency_Hz.si, (size_t)raw->cycles.si);
  dea_wave_add(out, 0, 0, raw->low_V.si);
  dea_wave_add(out, 0, raw->rise_s.si, high_V);
  dea_wave_add(out, raw->duty.si, 0, high_V);
  dea_wave_add(out, raw->duty.si, raw->rise_s.si, raw->low_V.si);
}

/* Adds an error at the rise time when both slopes do not fit into a cycle. */
static dea_status check_rise(const struct raw *raw)
{
  double capacity = fmin(raw->duty.si, 1 - raw->duty.si) / raw->frequency_Hz.si;
  if (!(raw->rise_s.si > capacity)) {
    return DEA_OK;
  }
  return dea_finding_add(raw->ctx, DEA_ERROR, raw->rise_s.location,
                         "rise_time: %g s is longer than the %g s that the shorter part of a cycle "
                         "lasts",
                         raw->rise_s.si, capacity);
}

static const struct dea_field square_fields[] = {
    KIND,
    VOLTAGE(low_V, "low", "voltage between pulses", .default_text = "0 kV"),
    VOLTAGE(high_V, "high", "voltage of a pulse", .required = true),
    FREQUENCY(frequency_Hz, "frequency", "pulses a second"),
    DUTY("share of a cycle that the pulse lasts"),
    RISE("a rise or fall takes; 0: jumps"),
    CYCLES(cycles, "cycles", "number of pulses", "10"),
};

static dea_status build_square(const struct raw *raw, struct dea_waveform *out)
{
  DEA_TRY(raw->ctx, check_rise(raw));
  add_pulses(out, 0, raw, raw->high_V.si);
  out->end_s = raw->cycles.si / raw->frequency_Hz.si;
  return DEA_OK;
}

/* The measurements of the paper (section 3.2): 0 to 8 kV in steps of 1 kV, 15 pulses at each, 0.5
 * Hz, duty 50 %. */
static const struct dea_field staircase_fields[] = {
    KIND,
    VOLTAGE(from_V, "from", "first voltage", .group = VOLTAGE_GROUP, .option = 1,
            .default_text = "0 kV"),
    VOLTAGE(to_V, "to", "last voltage; below `from` the stairs go down", .group = VOLTAGE_GROUP,
            .option = 1, .default_text = "8 kV"),
    DEA_NUMBER_ROW("step", AT(step_V), "V", "1 kV", "step between voltages", .above_min = true,
                   .max = 1e6, .group = VOLTAGE_GROUP, .option = 1, .default_text = "1 kV"),
    DEA_NUMBER_ROW("values", AT(values_V), "V", "[4 kV, 6 kV]", "the voltages themselves",
                   .min = -1e6, .max = 1e6, .group = VOLTAGE_GROUP, .option = 2,
                   DEA_LIST(1, LEVELS_MAX, struct dea_quantity, AT(value_count))),
    VOLTAGE(low_V, "low", "voltage between pulses", .default_text = "0 kV"),
    CYCLES(cycles, "cycles", "pulses at each voltage", "15"),
    FREQUENCY(frequency_Hz, "frequency", "pulses a second"),
    DUTY("share of a cycle that the pulse lasts"),
    RISE("a rise or fall takes; 0: jumps"),
    TIME(pause_s, "pause", "rest after the pulses of each voltage", .default_text = "0 s"),
};

/* Number of voltages; 0 after a finding. */
static dea_status count_levels(const struct raw *raw, size_t *count)
{
  *count = raw->value_count;
  if (*count > 0) {
    return DEA_OK;
  }
  double steps = floor(fabs(raw->to_V.si - raw->from_V.si) / raw->step_V.si + 1e-6);
  if (steps < LEVELS_MAX) {
    *count = (size_t)steps + 1;
    return DEA_OK;
  }
  return dea_finding_add(raw->ctx, DEA_ERROR, raw->step_V.location,
                         "step: from %g V to %g V in steps of %g V are more than %d voltages",
                         raw->from_V.si, raw->to_V.si, raw->step_V.si, LEVELS_MAX);
}

static dea_status build_staircase(const struct raw *raw, struct dea_waveform *out)
{
  size_t count;
  DEA_TRY(raw->ctx, check_rise(raw));
  DEA_TRY(raw->ctx, count_levels(raw, &count));
  double each_s = raw->cycles.si / raw->frequency_Hz.si + raw->pause_s.si;
  for (size_t i = 0; i < count; i++) {
    double level = raw->value_count > 0 ? raw->values_V[i].si
                                        : raw->from_V.si + copysign((double)i * raw->step_V.si,
                                                                    raw->to_V.si - raw->from_V.si);
    add_pulses(out, (double)i * each_s, raw, level);
  }
  out->end_s = (double)count * each_s;
  return DEA_OK;
}

// Sines ------------------------------------------------------------------------------------------

/* What sine, burst and chirp have in common. */
static void start_sine(const struct raw *raw, double from_Hz, double to_Hz, double sweep_s,
                       struct dea_waveform *out)
{
  out->sine = (struct dea_wave_sine){.mean_V = raw->mean_V.si,
                                     .amplitude_V = raw->amplitude_V.si,
                                     .cycles = raw->cycles.si,
                                     .from_Hz = from_Hz,
                                     .to_Hz = to_Hz,
                                     .sweep_s = sweep_s};
  out->end_s = sweep_s;
  out->longest_step_s = 0.05 / fmax(from_Hz, to_Hz);
}

/* Mean + amplitude sin(2 pi (f t + phase)). */
static const struct dea_field sine_fields[] = {
    KIND,
    MEAN_AND_AMPLITUDE(""),
    FREQUENCY(frequency_Hz, "frequency", "cycles a second"),
    DEA_NUMBER_ROW("phase", AT(phase_rad), "radian", "-90 degree",
                   "phase at the start; -90 degree: it starts at the lowest voltage", .min = -7,
                   .max = 7, .default_text = "0 degree"),
    CYCLES(cycles, "cycles", "number of cycles", "10"),
};

static dea_status build_sine(const struct raw *raw, struct dea_waveform *out)
{
  const double f = raw->frequency_Hz.si;
  start_sine(raw, f, f, raw->cycles.si / f, out);
  out->sine.phase = raw->phase_rad.si / two_pi;
  return DEA_OK;
}

static const char *const spacings[] = {"linear", "logarithmic", NULL};

static const struct dea_field chirp_fields[] = {
    KIND,
    MEAN_AND_AMPLITUDE(""),
    FREQUENCY(from_Hz, "from", "frequency at the start"),
    FREQUENCY(to_Hz, "to", "frequency at the end"),
    TIME(duration_s, "duration", "how long it takes", .above_min = true, .required = true),
    DEA_CHOICE_ROW("spacing", AT(spacing), spacings, "linear",
                   "how the frequency goes with time: evenly, or by equal factors",
                   .default_text = "logarithmic"),
};

static dea_status build_chirp(const struct raw *raw, struct dea_waveform *out)
{
  const double from_Hz = raw->from_Hz.si, to_Hz = raw->to_Hz.si;
  start_sine(raw, from_Hz, to_Hz, raw->duration_s.si, out);
  out->sine.sweeps = true;
  out->sine.logarithmic = raw->spacing.value == 1 && from_Hz != to_Hz;
  out->sine.cycles = dea_wave_cycles(&out->sine, raw->duration_s.si);
  return DEA_OK;
}

static const struct dea_field burst_fields[] = {
    KIND,
    MEAN_AND_AMPLITUDE(" and between bursts"),
    FREQUENCY(frequency_Hz, "frequency", "cycles a second within a burst"),
    CYCLES(cycles, "cycles", "cycles of a burst", "10"),
    TIME(period_s, "period", "from the start of a burst to that of the next", .above_min = true,
         .required = true),
    CYCLES(bursts, "bursts", "number of bursts", "1"),
};

static dea_status build_burst(const struct raw *raw, struct dea_waveform *out)
{
  const double f = raw->frequency_Hz.si, burst_s = raw->cycles.si / f, mean_V = raw->mean_V.si;
  start_sine(raw, f, f, burst_s, out);
  out->sine.bursts = raw->bursts.si;
  out->sine.period_s = raw->period_s.si;
  if (burst_s > raw->period_s.si) {
    return dea_finding_add(raw->ctx, DEA_ERROR, raw->period_s.location,
                           "period: %g s is shorter than a burst, %g s", raw->period_s.si, burst_s);
  }
  // Blocks of two knots each burst mark its ends, where the curve bends.
  dea_wave_open(out, 0, 1 / raw->period_s.si, (size_t)raw->bursts.si);
  dea_wave_add(out, 0, 0, mean_V + copysign(raw->amplitude_V.si, mean_V));
  dea_wave_add(out, 0, burst_s, mean_V);
  out->end_s = raw->bursts.si * raw->period_s.si;
  return DEA_OK;
}

// A file -----------------------------------------------------------------------------------------

enum { TIMES, VOLTAGES };
static const double voltage_max_V = 1e6; // as of the other kinds

static const struct dea_field table_fields[] = {
    KIND,
    DEA_LABEL_ROW(
        "file", AT(file), "drive.csv",
        "CSV file with a header such as 'time (s),voltage (kV)', times rising from 0; two rows of "
        "one time are a jump; its path counts from the folder of the design file",
        .required = true),
    CYCLES(repeat, "repeat", "how often the table is played", "1"),
};

static const struct dea_csv_wanted columns[2] = {
    [TIMES] = {.name = "time",
               .title = "time (s)",
               .measure = {"s", "1 s"},
               .needed = true,
               .filled = true,
               .other = {"t"}},
    [VOLTAGES] = {.name = "voltage",
                  .title = "voltage (kV)",
                  .measure = {"V", "1 kV"},
                  .needed = true,
                  .filled = true,
                  .other = {"v", "u"}},
};

/* Knots of the rows. Errors are findings. */
static dea_status get_rows(struct dea_context *ctx, const struct dea_csv_columns *table,
                           struct dea_waveform *w)
{
  const double *time_s = table->values[TIMES], *voltage_V = table->values[VOLTAGES];
  for (size_t i = 0; i < table->rows; i++) {
    const struct dea_location here = {table->file, table->line[i], 1};
    if (i == 0 ? time_s[i] != 0 : time_s[i] < time_s[i - 1]) {
      return dea_finding_add(
          ctx, DEA_ERROR, here,
          i == 0 ? "times start at 0, not at %g s" : "times rise; %g s comes too late", time_s[i]);
    }
    if (!(fabs(voltage_V[i]) <= voltage_max_V)) {
      return dea_finding_add(ctx, DEA_ERROR, here, "a voltage is at most 1 MV");
    }
    dea_wave_add(w, 0, time_s[i], voltage_V[i]);
  }
  const size_t last = table->rows > 0 ? table->rows - 1 : 0;
  return table->rows > 0 && time_s[last] > 0
             ? DEA_OK
             : dea_finding_add(ctx, DEA_ERROR,
                               (struct dea_location){table->file, table->line[last], 1},
                               "a table needs two times at least");
}

static dea_status build_table(const struct raw *raw, struct dea_waveform *out)
{
  struct dea_context *ctx = raw->ctx;
  struct dea_csv_columns table;
  char *path = dea_path_beside(ctx, raw->beside, raw->file.text);
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status =
      path != NULL ? dea_csv_columns_read(ctx, path, columns, 2, NULL, &table) : DEA_E_MEMORY;
  dea_free(ctx, path);
  if (status == DEA_E_IO) { // what is wrong in the file is a finding already
    return dea_finding_count(ctx, DEA_ERROR) > errors
               ? DEA_OK
               : dea_finding_add(ctx, DEA_ERROR, raw->file.location, "file: %s",
                                 dea_context_message(ctx));
  }
  DEA_TRY(ctx, status);
  dea_wave_open(out, 0, 1, 1);
  status = get_rows(ctx, &table, out);
  dea_csv_columns_free(ctx, &table);
  if (status == DEA_OK && !out->failed && dea_finding_count(ctx, DEA_ERROR) == errors) {
    double length_s = out->knots[out->knot_count - 1].offset_s;
    out->blocks[0].frequency_Hz = 1 / length_s;
    out->blocks[0].cycles = (size_t)raw->repeat.si;
    out->end_s = raw->repeat.si * length_s;
  }
  return status;
}

// All --------------------------------------------------------------------------------------------

/* In the order in which they are offered: name, meaning. */
#define KINDS(X)                                                                                   \
  X(constant, "one voltage")                                                                       \
  X(step, "from one voltage to another")                                                           \
  X(ramp, "evenly from one voltage to another")                                                    \
  X(square, "pulses of equal height")                                                              \
  X(sine, "a sine about a mean")                                                                   \
  X(triangle, "up and down evenly")                                                                \
  X(chirp, "a sine of changing frequency")                                                         \
  X(burst, "some cycles of a sine, a pause, again")                                                \
  X(staircase, "pulses at one voltage after the other")                                            \
  X(table, "times and voltages from a CSV file")

#define WAVE_RECORD(name, meaning)                                                                 \
  static const struct dea_record name##_record = {#name, meaning, name##_fields,                   \
                                                  DEA_COUNT(name##_fields)};
KINDS(WAVE_RECORD)
#undef WAVE_RECORD

static const struct kind {
  const struct dea_record *record; // its keys, "kind" among them; with its name
  /* Makes the waveform of what was read (zeroed but for `kind`). What is wrong becomes findings. */
  dea_status (*build)(const struct raw *raw, struct dea_waveform *out);
} kinds[] = {
#define WAVE_KIND(name, meaning) {&name##_record, build_##name},
    KINDS(WAVE_KIND)
#undef WAVE_KIND
};

const struct dea_record *const dea_wave_records[] = {
#define WAVE_ADDRESS(name, meaning) &name##_record,
    KINDS(WAVE_ADDRESS)
#undef WAVE_ADDRESS
        NULL};

dea_status dea_waveform_read(const struct dea_reader *reader, const struct dea_node *node,
                             const char *path, const char *beside, struct dea_waveform **out)
{
  struct dea_context *ctx = reader->ctx;
  const char *names[DEA_COUNT(kinds)];
  size_t index, errors = dea_finding_count(ctx, DEA_ERROR);
  *out = NULL;
  for (size_t i = 0; i < DEA_COUNT(kinds); i++) {
    names[i] = kinds[i].record->name;
  }
  DEA_TRY(ctx, dea_schema_kind(reader, node, "a waveform", names, DEA_COUNT(kinds), &index));
  if (index == DEA_COUNT(kinds)) {
    return DEA_OK;
  }
  struct raw *raw = dea_alloc(ctx, 1, sizeof *raw);
  struct dea_waveform *waveform = dea_alloc(ctx, 1, sizeof *waveform);
  dea_status status = raw != NULL && waveform != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    *waveform = (struct dea_waveform){.kind = names[index], .ctx = ctx, .longest_step_s = INFINITY};
    raw->ctx = ctx;
    raw->beside = beside;
    status = dea_schema_read(reader, kinds[index].record, node, path, raw);
  }
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    status = kinds[index].build(raw, waveform);
    status = waveform->failed ? DEA_E_MEMORY : status;
  }
  dea_free(ctx, raw);
  if (status != DEA_OK || dea_finding_count(ctx, DEA_ERROR) > errors) {
    dea_waveform_destroy(waveform);
    waveform = NULL;
  }
  *out = waveform;
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

void dea_waveform_destroy(struct dea_waveform *waveform)
{
  if (waveform != NULL) {
    struct dea_context *ctx = waveform->ctx;
    dea_free(ctx, waveform->knots);
    dea_free(ctx, waveform->blocks);
    dea_free(ctx, waveform);
  }
}
