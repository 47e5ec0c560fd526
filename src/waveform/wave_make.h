/* What the kinds of waveforms are made with. */
#pragma once

#include "waveform/waveform.h"

#define DEA_WAVE_COUNT(array) (sizeof(array) / sizeof(array)[0])

/* Rows of the kinds' tables; raw: struct that they are read into. */
#define DEA_WAVE_KIND(raw)                                                                         \
  {                                                                                                \
    .key = "kind", .kind = DEA_FIELD_LABEL, .offset = offsetof(raw, kind), .required = true,       \
    .doc = "kind of waveform", .example = "square"                                                 \
  }
/* A voltage of either sign. */
#define DEA_WAVE_VOLTAGE(raw, member, name, text, ...)                                             \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(raw, member), .unit = "V",           \
    .min = -1e6, .max = 1e6, .doc = text, .example = "6 kV", __VA_ARGS__                           \
  }
#define DEA_WAVE_FREQUENCY(raw, member, name, text)                                                \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(raw, member), .unit = "Hz",          \
    .above_min = true, .max = 1e6, .required = true, .doc = text, .example = "0.5 Hz"              \
  }
#define DEA_WAVE_TIME(raw, member, name, text, ...)                                                \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(raw, member), .unit = "s",           \
    .max = 1e9, .doc = text, .example = "10 s", __VA_ARGS__                                        \
  }
#define DEA_WAVE_CYCLES(raw, member, name, text, usual)                                            \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_INTEGER, .offset = offsetof(raw, member), .unit = "1",          \
    .min = 1, .max = 1e6, .default_text = usual, .doc = text, .example = "15"                      \
  }
#define DEA_WAVE_SHARE(raw, member, name, text)                                                    \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(raw, member), .unit = "1",           \
    .above_min = true, .max = 1, .below_max = true, .default_text = "50 %", .doc = text,           \
    .example = "50 %"                                                                              \
  }

/* Record and type of a kind, at the end of its file, which has `fields`, `struct raw` and `build`;
 * further members of the type, at least one. */
#define DEA_WAVE_TYPE(word, meaning, ...)                                                          \
  const struct dea_record dea_wave_##word##_record = {#word, meaning, fields,                      \
                                                      DEA_WAVE_COUNT(fields)};                     \
  const struct dea_wave_type dea_wave_##word = {.name = #word,                                     \
                                                .record = &dea_wave_##word##_record,               \
                                                .raw_size = sizeof(struct raw),                    \
                                                .make = build,                                     \
                                                __VA_ARGS__}

/* Room for knots and blocks in a waveform that has none. DEA_E_MEMORY. */
dea_status dea_wave_room(struct dea_context *ctx, struct dea_waveform *waveform, size_t knots,
                         size_t blocks);
/* Adds a knot to the last block, and a block to start at a time with no knots yet. */
void dea_wave_add(struct dea_waveform *waveform, double phase, double offset_s, double value_V);
void dea_wave_open(struct dea_waveform *waveform, double start_s, double frequency_Hz,
                   size_t cycles);
/* Adds a block of rectangular pulses from low to high: up at the start of each cycle, down after
 * the share `duty` of it, each within rise_s (0: a jump). */
struct dea_wave_pulses {
  double low_V, high_V, frequency_Hz, duty, rise_s;
  size_t cycles;
};
enum { DEA_WAVE_PULSE_KNOTS = 4 };
void dea_wave_add_pulses(struct dea_waveform *waveform, double start_s,
                         const struct dea_wave_pulses *pulses);
/* Adds an error at the rise time when both slopes do not fit into a cycle. */
dea_status dea_wave_check_rise(const struct dea_reader *reader, const struct dea_quantity *rise_s,
                               double frequency_Hz, double duty);
/* sin of 2 pi times a number of cycles, which may be large. */
double dea_wave_sine_of(double cycles);
/* Extent of a sine about a mean whose phase goes from one number of cycles up to another, at a
 * frequency of at most highest_Hz. */
void dea_wave_sine_extent(double mean_V, double amplitude_V, double from_cycles, double to_cycles,
                          double highest_Hz, struct dea_wave_extent *out);
