#include "protocol/protocol_export.h"

#include "base/write_file.h"
#include "import/import.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* What the scripts end with, embedded by CMake: play_nidaqmx.py and play_matlab.m. */
extern const char dea_asset_play_python[], dea_asset_play_matlab[];

enum { TITLE_SIZE = 2 * DEA_CHANNEL_NAME_SIZE + 48, VARIABLE_SIZE = 63 };

// Names ------------------------------------------------------------------------------------------

/* What a channel is called in recording.csv, and in recording.mat. */
struct column {
  char title[TITLE_SIZE], variable[VARIABLE_SIZE];
};
/* What is in both beside the channels. */
static const struct column others[] = {{"time (s)", "time_s"}, {"command (kV)", "command_V"}};
enum { OTHERS = sizeof others / sizeof others[0] };

/* Signs that would end a column or a text are left out. */
static void build_title(const char *label, const char *number, const char *unit,
                        char out[TITLE_SIZE])
{
  snprintf(out, TITLE_SIZE, "%.90s%s%s%s%.63s%s", label, number[0] != '\0' ? " " : "", number,
           unit[0] != '\0' ? " (" : "", unit, unit[0] != '\0' ? ")" : "");
  for (char *c = out; *c != '\0'; c++) {
    if (strchr(",;\"'\\%", *c) != NULL || (unsigned char)*c < ' ') {
      *c = ' ';
    }
  }
}

/* Appends the letters and digits of a text to a name of `most` characters at most, with '_' before
 * it and for all that is neither. */
static void add_part(const char *text, size_t most, char out[VARIABLE_SIZE])
{
  size_t used = strlen(out);
  bool apart = used > 0;
  for (const char *c = text; *c != '\0'; c++) {
    bool good = isalnum((unsigned char)*c) && (unsigned char)*c < 0x80;
    if (good && used + apart >= most) {
      break;
    }
    if (good && apart) {
      out[used++] = '_';
    }
    if (good) {
      out[used++] = *c;
    }
    apart = used > 0 && !good;
  }
  out[used] = '\0';
}

/* The unit is at the end, whatever is cut off before it. */
static void build_variable(const char *label, const char *number, const char *unit,
                           char out[VARIABLE_SIZE])
{
  static const size_t unit_most = 20;
  size_t most = VARIABLE_SIZE - 1, length = strlen(unit);
  size_t before_unit = most - 1 - (length < unit_most ? length : unit_most);
  snprintf(out, VARIABLE_SIZE, "%s", isalpha((unsigned char)label[0]) ? "" : "x");
  add_part(label, before_unit - 1 - strlen(number), out);
  add_part(number, before_unit, out);
  add_part(unit, most, out);
}

/* Names of all channels: its own, what it is when that does not say so, a number where another one
 * would be called the same, its unit. */
static void name_columns(const struct dea_protocol *protocol,
                         struct column out[DEA_PROTOCOL_INPUTS_MAX])
{
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    const struct dea_channel_meaning *meaning = &dea_channel_meanings[input->kind.value];
    bool other = input->kind.value == DEA_CHANNEL_OTHER;
    bool says = other || dea_guess_by_name(input->name.text) == input->kind.value;
    char label[TITLE_SIZE], number[8] = "";
    snprintf(label, sizeof label, "%.63s%s%s", input->name.text, says ? "" : " ",
             says ? "" : meaning->name);
    for (int again = 2, unique = 0; !unique; again++) {
      build_title(label, number, other ? input->unit.text : meaning->display_unit, out[i].title);
      build_variable(label, number, other ? input->unit.text : meaning->si_unit, out[i].variable);
      unique = 1;
      for (size_t k = 0; k < i + OTHERS; k++) {
        const struct column *there = k < i ? &out[k] : &others[k - i];
        unique = unique && strcmp(there->title, out[i].title) != 0 &&
                 strcmp(there->variable, out[i].variable) != 0;
      }
      snprintf(number, sizeof number, "%d", again % 100);
    }
  }
}

/* Text within single quotes of both languages. */
static void add_quoted(struct dea_text *out, const char *text)
{
  dea_text_add(out, "'");
  for (const char *c = text; *c != '\0'; c++) {
    bool good = strchr("'\\", *c) == NULL && (unsigned char)*c >= ' ';
    dea_text_add(out, "%c", good ? *c : ' ');
  }
  dea_text_add(out, "'");
}

/* A comment's line ends where the text does. */
static void add_comment(struct dea_text *out, const char *sign, const char *text)
{
  dea_text_add(out, "%s ", sign);
  for (const char *c = text; *c != '\0'; c++) {
    dea_text_add(out, "%c", (unsigned char)*c >= ' ' ? *c : ' ');
  }
  dea_text_add(out, "\n");
}

/* The factor of a channel's display unit. */
static double display_factor(const struct dea_protocol_input *input)
{
  return dea_channel_meanings[input->kind.value].factor;
}

static double trip_samples(const struct dea_protocol *protocol)
{
  return fmax(ceil(protocol->safety.trip_time_s.si * protocol->rate_Hz.si * (1 - 1e-12)), 1);
}

// Scripts ----------------------------------------------------------------------------------------

/* The control voltages that were checked: of the sequence, and not of the amplifier, because the
 * film may stand less. What was rounded in the file is within. */
static void find_control(const struct dea_protocol *protocol, double *low_V, double *high_V)
{
  *low_V = *high_V = 0;
  for (size_t i = 0; i < protocol->step_count; i++) {
    *low_V = fmin(*low_V, protocol->steps[i].lowest_V / protocol->amplifier.gain.si);
    *high_V = fmax(*high_V, protocol->steps[i].highest_V / protocol->amplifier.gain.si);
  }
}

/* Against what they were checked. */
static const char *checked_against(const struct dea_protocol *protocol)
{
  return protocol->film != NULL ? "the amplifier and the film"
                                : "the amplifier, and not against a film (no design is named)";
}

static void write_python(const struct dea_protocol *protocol, struct dea_text *out)
{
  struct column columns[DEA_PROTOCOL_INPUTS_MAX];
  double low_V, high_V;
  name_columns(protocol, columns);
  find_control(protocol, &low_V, &high_V);
  dea_text_add(
      out, "#!/usr/bin/env python3\n"
           "# Plays waveform.csv to the amplifier through NI-DAQmx and records all channels as\n"
           "# recording.csv. HIGH VOLTAGE. Needs the package nidaqmx. Made by dea for\n");
  add_comment(out, "#", protocol->title.text[0] != '\0' ? protocol->title.text : protocol->file);
  dea_text_add(out, "#   python play_nidaqmx.py [DEVICE]     by default Dev1\n\n");
  dea_text_add(out, "RATE_HZ = %.17g\nGAIN = %.17g  # of the amplifier\n", protocol->rate_Hz.si,
               protocol->amplifier.gain.si);
  dea_text_add(out,
               "CONTROL_V = %.17g  # largest control voltage of the amplifier\n"
               "LOWEST_V = %.17g  # control voltages that were checked against %s\n"
               "HIGHEST_V = %.17g\nOUTPUT = ",
               protocol->amplifier.control_V.si, low_V, checked_against(protocol), high_V);
  add_quoted(out, protocol->amplifier.terminal.text);
  dea_text_add(out,
               "\nRAMP_V_PER_S = %.17g  # of the amplifier's output, when it ends early\n"
               "LONGEST_RAMP_S = %.17g  # faster where that would take longer\n",
               protocol->safety.ramp_V_per_s.si, protocol->safety.longest_ramp_s.si);
  dea_text_add(out, "TRIP_SAMPLES = %.0f  # in a row above the limit `trip` of a current\n",
               trip_samples(protocol));
  dea_text_add(out, "# value in the unit of the title = volts * scale + offset\nCHANNELS = [\n");
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    double factor = display_factor(input);
    dea_text_add(out, "    {\n        \"title\": ");
    add_quoted(out, columns[i].title);
    dea_text_add(out, ",\n        \"terminal\": ");
    add_quoted(out, input->terminal.text);
    dea_text_add(out,
                 ",\n        \"range\": %.17g,\n        \"scale\": %.17g,\n        \"offset\": "
                 "%.17g,\n        \"trip\": ",
                 input->range_V.si, factor * input->per_volt, factor * input->at_zero);
    if (input->kind.value == DEA_CHANNEL_CURRENT) {
      dea_text_add(out, "%.17g,\n    },\n", factor * protocol->safety.trip_current_A.si);
    } else {
      dea_text_add(out, "None,\n    },\n");
    }
  }
  dea_text_add(out, "]\n\n%s", dea_asset_play_python);
}

static void write_matlab(const struct dea_protocol *protocol, struct dea_text *out)
{
  struct column columns[DEA_PROTOCOL_INPUTS_MAX];
  double low_V, high_V;
  name_columns(protocol, columns);
  find_control(protocol, &low_V, &high_V);
  dea_text_add(
      out, "function play_matlab(device)\n"
           "%% Plays waveform.csv to the amplifier through the Data Acquisition Toolbox (R2020a\n"
           "%% or later) and records all channels as recording.csv and recording.mat. HIGH\n"
           "%% VOLTAGE. Made by dea for\n");
  add_comment(out, "%", protocol->title.text[0] != '\0' ? protocol->title.text : protocol->file);
  dea_text_add(out, "%%   play_matlab            on device Dev1\n"
                    "%%   play_matlab('Dev2')    on another one\n\n");
  dea_text_add(out, "%s", dea_asset_play_matlab);
  dea_text_add(out, "function p = numbers()\np.rate_Hz = %.17g;\n", protocol->rate_Hz.si);
  dea_text_add(out, "p.gain = %.17g; %% of the amplifier\n", protocol->amplifier.gain.si);
  dea_text_add(out,
               "p.lowest_V = %.17g; %% control voltages that were checked against %s\n"
               "p.highest_V = %.17g;\np.output = ",
               low_V, checked_against(protocol), high_V);
  add_quoted(out, protocol->amplifier.terminal.text);
  dea_text_add(out,
               ";\np.ramp_V_per_s = %.17g; %% of the amplifier's output, when it ends early\n"
               "p.longest_ramp_s = %.17g; %% faster where that would take longer\n",
               protocol->safety.ramp_V_per_s.si, protocol->safety.longest_ramp_s.si);
  dea_text_add(out, "p.trip_samples = %.0f; %% in a row above the limit `trip` of a current\n",
               trip_samples(protocol));
  dea_text_add(
      out,
      "%% value in the unit of the title = volts * scale + offset; `unit`: SI value of that unit\n"
      "p.channels = struct('title', {}, 'variable', {}, 'terminal', {}, 'range', {}, "
      "'scale', {}, ...\n    'offset', {}, 'trip', {}, 'unit', {});\n");
  for (size_t i = 0; i < protocol->input_count; i++) {
    const struct dea_protocol_input *input = &protocol->inputs[i];
    double factor = display_factor(input);
    dea_text_add(out, "p.channels(end + 1) = struct('title', ");
    add_quoted(out, columns[i].title);
    dea_text_add(out, ", 'variable', '%s', 'terminal', ", columns[i].variable);
    add_quoted(out, input->terminal.text);
    dea_text_add(out, ", ...\n    'range', %.17g, 'scale', %.17g, 'offset', %.17g, 'trip', ",
                 input->range_V.si, factor * input->per_volt, factor * input->at_zero);
    if (input->kind.value == DEA_CHANNEL_CURRENT) {
      dea_text_add(out, "%.17g", factor * protocol->safety.trip_current_A.si);
    } else {
      dea_text_add(out, "inf");
    }
    dea_text_add(out, ", 'unit', %.17g);\n", 1 / factor);
  }
  dea_text_add(out, "end\n");
}

static void write_readme(const struct dea_protocol *protocol, struct dea_text *out)
{
  dea_text_add(out, "%s\n\n",
               protocol->title.text[0] != '\0' ? protocol->title.text : protocol->file);
  double low_V, high_V;
  find_control(protocol, &low_V, &high_V);
  double gain = protocol->amplifier.gain.si;
  dea_text_add(out,
               "HIGH VOLTAGE: %g kV to %g kV were checked against %s when\n"
               "these files were made; the scripts refuse a waveform.csv that goes beyond. Nobody "
               "has tried the\nscripts on your instruments.\n\n",
               1e-3 * gain * low_V, 1e-3 * gain * high_V, checked_against(protocol));
  dea_text_add(
      out,
      "waveform.csv      time (s), asked voltage (kV), control voltage of the amplifier (V)\n"
      "waveform.mat      the same for MATLAB\n"
      "play_matlab.m     plays and records: Data Acquisition Toolbox, R2020a or later\n"
      "play_nidaqmx.py   plays and records: Python 3 with `pip install nidaqmx`, NI-DAQmx driver\n"
      "\n"
      "1. Copy this folder to the computer of the DAQ. Compare inputs, ranges and factors in the\n"
      "   script (CHANNELS, or numbers() at its end) with your wiring.\n"
      "2. First with the amplifier's high voltage off, and its control input on an oscilloscope:\n"
      "       play_matlab('Dev1')        or      python play_nidaqmx.py Dev1\n"
      "   Press Ctrl-C on the way: the control voltage has to go to 0 V along a ramp.\n"
      "3. Rename recording.csv. Set the amplifier's own voltage and current limits, then play "
      "with\n"
      "   high voltage.\n"
      "4. Back on the computer with dea:\n"
      "       dea import recording.csv --design DESIGN && dea reduce recording.h5\n"
      "\n"
      "Both scripts end with the output at 0 V, also after Ctrl-C and after an error, and end "
      "early\n"
      "when a current stays above trip_current; they do not look for arcs that come and go, as dea "
      "does.\n"
      "They do not compare the measured voltage with the\n"
      "asked one. A process that is killed, or a computer that fails, leaves the output where it\n"
      "was: use the amplifier's own limits and the watchdog of the DAQ.\n"
      "Output and inputs have one clock; what an input reads is what is there just before the\n"
      "output changes.\n");
}

// Waveform ---------------------------------------------------------------------------------------

struct waveform {
  double *time_s, *voltage_V, *control_V; // [count]
  size_t count;
};

/* All samples, and one of 0 V at the end. */
static dea_status sample(struct dea_context *ctx, const struct dea_protocol *protocol,
                         struct waveform *out)
{
  struct dea_protocol_samples next;
  double samples = dea_protocol_sample_count(protocol);
  if (samples >= DEA_EXPORT_SAMPLES_MAX) {
    return dea_fail(
        ctx, DEA_E_ARGUMENT,
        "%.3g samples are too many for the scripts, which take %d; choose a lower `rate`", samples,
        DEA_EXPORT_SAMPLES_MAX);
  }
  dea_protocol_samples_start(&next, protocol);
  out->count = next.total;
  out->time_s = dea_alloc(ctx, out->count, sizeof *out->time_s);
  out->voltage_V = dea_alloc(ctx, out->count, sizeof *out->voltage_V);
  out->control_V = dea_alloc(ctx, out->count, sizeof *out->control_V);
  DEA_TRY_MEMORY(out->time_s != NULL && out->voltage_V != NULL && out->control_V != NULL);
  for (size_t i = 0; i < out->count; i++) {
    out->time_s[i] = (double)i / protocol->rate_Hz.si;
    out->voltage_V[i] = dea_protocol_samples_next(&next);
    out->control_V[i] = out->voltage_V[i] / protocol->amplifier.gain.si;
  }
  return DEA_OK;
}

static dea_status write_csv(struct dea_context *ctx, const struct waveform *wave,
                            const char *directory)
{
  struct dea_text out = {.ctx = ctx};
  dea_text_add(&out, "time (s),V (kV),control (V)\n");
  for (size_t i = 0; i < wave->count && !out.failed; i++) {
    dea_text_add(&out, "%.12g,%.12g,%.12g\n", wave->time_s[i], 1e-3 * wave->voltage_V[i],
                 wave->control_V[i]);
  }
  return dea_text_write(ctx, &out, directory, "waveform.csv");
}

/* A variable of a .mat file of version 5, a column of numbers; what comes behind it. */
static char *add_variable(char *at, const char *name, const double *values, size_t count)
{
  enum { INT8 = 1, INT32 = 5, UINT32 = 6, DOUBLE = 9, MATRIX = 14, CLASS_DOUBLE = 6 };
  const uint32_t length = (uint32_t)strlen(name), padded = (length + 7) / 8 * 8;
  const uint32_t bytes = (uint32_t)(count * sizeof *values);
  const uint32_t head[] = {MATRIX, 48 + padded + bytes, UINT32, 8,    CLASS_DOUBLE, 0, INT32,
                           8,      (uint32_t)count,     1,      INT8, length};
  const uint32_t data[] = {DOUBLE, bytes};
  memcpy(at, head, sizeof head);
  memcpy(at + sizeof head, name, length);
  at += sizeof head + padded;
  memcpy(at, data, sizeof data);
  memcpy(at + sizeof data, values, bytes);
  return at + sizeof data + bytes;
}

static dea_status write_mat(struct dea_context *ctx, const struct dea_protocol *protocol,
                            const struct waveform *wave, const char *directory)
{
  enum { HEAD = 128, VARIABLE_MOST = 80 };
  static const uint16_t version[] = {0x0100, 0x4d49}; // "MI" in the order of the numbers' bytes
  char *bytes = dea_alloc(ctx, HEAD + 5 * VARIABLE_MOST + 3 * wave->count * sizeof(double), 1);
  DEA_TRY_MEMORY(bytes != NULL);
  memset(bytes, ' ', HEAD - 12);
  memcpy(bytes, "MATLAB 5.0 MAT-file", 19);
  memcpy(bytes + HEAD - sizeof version, version, sizeof version);
  char *end = add_variable(bytes + HEAD, "rate_Hz", &protocol->rate_Hz.si, 1);
  end = add_variable(end, "gain", &protocol->amplifier.gain.si, 1);
  end = add_variable(end, "time_s", wave->time_s, wave->count);
  end = add_variable(end, "voltage_V", wave->voltage_V, wave->count);
  end = add_variable(end, "control_V", wave->control_V, wave->count);
  dea_status status =
      dea_file_write_into(ctx, directory, "waveform.mat", bytes, (size_t)(end - bytes));
  dea_free(ctx, bytes);
  return status;
}

// All of it --------------------------------------------------------------------------------------

static dea_status write_texts(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const char *directory)
{
  static const struct {
    const char *name;
    void (*write)(const struct dea_protocol *protocol, struct dea_text *out);
  } texts[] = {{"play_nidaqmx.py", write_python},
               {"play_matlab.m", write_matlab},
               {"README.txt", write_readme}};
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
    struct dea_text out = {.ctx = ctx};
    texts[i].write(protocol, &out);
    DEA_TRY(ctx, dea_text_write(ctx, &out, directory, texts[i].name));
  }
  return DEA_OK;
}

dea_status dea_protocol_export(struct dea_context *ctx, const struct dea_protocol *protocol,
                               const char *directory)
{
  struct waveform wave = {0};
  if (protocol->input_count == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "%s has no `channels`: there is nothing to be recorded",
                    protocol->file);
  }
  DEA_TRY(ctx, dea_folder_create(ctx, directory));
  dea_status status = sample(ctx, protocol, &wave);
  status = status == DEA_OK ? write_csv(ctx, &wave, directory) : status;
  status = status == DEA_OK ? write_mat(ctx, protocol, &wave, directory) : status;
  status = status == DEA_OK ? write_texts(ctx, protocol, directory) : status;
  dea_free(ctx, wave.time_s);
  dea_free(ctx, wave.voltage_V);
  dea_free(ctx, wave.control_V);
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
