/* Words that columns and numbers of files are known by; of those that fit a name the first counts.
 */
#pragma once

// X(language, word in lower case, where it stands in a name, what that then is)
// where: PART anywhere; WORD as a word of its own; WHOLE it is the whole name
// what: TIME; RATE [Hz] or INTERVAL [s] between samples, of a single number; POSITION where
// something is, not how it moves; AMPERE a bare 'A' behind it is a unit; UNCERTAINTY how far the
// rest of the name may be off, whatever that is; else a kind of channel
#define DEA_WORD_LIST(X)                                                                           \
  X(ENGLISH, "std", WORD, UNCERTAINTY)                                                             \
  X(ENGLISH, "stdev", WORD, UNCERTAINTY)                                                           \
  X(ENGLISH, "stddev", WORD, UNCERTAINTY)                                                          \
  X(ENGLISH, "sd", WORD, UNCERTAINTY)                                                              \
  X(ENGLISH, "sem", WORD, UNCERTAINTY)                                                             \
  X(ENGLISH, "deviation", WORD, UNCERTAINTY)                                                       \
  X(ENGLISH, "error", WORD, UNCERTAINTY)                                                           \
  X(ENGLISH, "err", WORD, UNCERTAINTY)                                                             \
  X(ENGLISH, "uncertainty", WORD, UNCERTAINTY)                                                     \
  X(GERMAN, "standardabweichung", WORD, UNCERTAINTY)                                               \
  X(GERMAN, "fehler", WORD, UNCERTAINTY)                                                           \
  X(GERMAN, "unsicherheit", WORD, UNCERTAINTY)                                                     \
  X(SYMBOL, "sigma", WORD, UNCERTAINTY)                                                            \
  X(SYMBOL, "\xcf\x83", WORD, UNCERTAINTY) /* the letter */                                        \
  X(ENGLISH, "timestamp", PART, TIME)                                                              \
  X(ENGLISH, "time", PART, TIME)                                                                   \
  X(GERMAN, "zeit", PART, TIME)                                                                    \
  X(ENGLISH, "elapsed", PART, TIME)                                                                \
  X(ENGLISH, "x value", PART, TIME) /* of LabVIEW */                                               \
  X(SYMBOL, "t", WORD, TIME)                                                                       \
  X(ENGLISH, "command", PART, COMMAND)                                                             \
  X(ENGLISH, "setpoint", PART, COMMAND)                                                            \
  X(ENGLISH, "set point", PART, COMMAND)                                                           \
  X(GERMAN, "soll", PART, COMMAND)                                                                 \
  X(ENGLISH, "reference", PART, COMMAND)                                                           \
  X(SYMBOL, "ao0", WORD, COMMAND)                                                                  \
  X(ENGLISH, "current", PART, CURRENT)                                                             \
  X(GERMAN, "strom", PART, CURRENT)                                                                \
  X(SYMBOL, "imon", PART, CURRENT)                                                                 \
  X(ENGLISH, "leakage", PART, CURRENT)                                                             \
  X(SYMBOL, "i", WORD, CURRENT)                                                                    \
  X(ENGLISH, "force", PART, FORCE)                                                                 \
  X(GERMAN, "kraft", PART, FORCE)                                                                  \
  X(ENGLISH, "load", PART, FORCE)                                                                  \
  X(SYMBOL, "f", WORD, FORCE)                                                                      \
  X(ENGLISH, "displacement", PART, DISPLACEMENT)                                                   \
  X(ENGLISH, "deflection", PART, DISPLACEMENT)                                                     \
  X(GERMAN, "auslenkung", PART, DISPLACEMENT)                                                      \
  X(ENGLISH, "laser", PART, DISPLACEMENT)                                                          \
  X(GERMAN, "weg", PART, DISPLACEMENT)                                                             \
  X(ENGLISH, "position", PART, DISPLACEMENT)                                                       \
  X(ENGLISH, "distance", PART, DISPLACEMENT)                                                       \
  X(GERMAN, "abstand", PART, DISPLACEMENT)                                                         \
  X(ENGLISH, "stroke", PART, DISPLACEMENT)                                                         \
  X(GERMAN, "hub", WORD, DISPLACEMENT)                                                             \
  X(SYMBOL, "z", WORD, DISPLACEMENT)                                                               \
  X(SYMBOL, "w", WORD, DISPLACEMENT)                                                               \
  X(ENGLISH, "voltage", PART, VOLTAGE)                                                             \
  X(GERMAN, "spannung", PART, VOLTAGE)                                                             \
  X(SYMBOL, "vmon", PART, VOLTAGE)                                                                 \
  X(SYMBOL, "hv", WORD, VOLTAGE)                                                                   \
  X(SYMBOL, "v", WORD, VOLTAGE)                                                                    \
  X(SYMBOL, "u", WORD, VOLTAGE)                                                                    \
  X(SYMBOL, "v0", WORD, VOLTAGE)                                                                   \
  X(SYMBOL, "x", WORD, POSITION)                                                                   \
  X(SYMBOL, "y", WORD, POSITION)                                                                   \
  X(SYMBOL, "r", WORD, POSITION)                                                                   \
  X(SYMBOL, "fs", WHOLE, RATE)                                                                     \
  X(SYMBOL, "sr", WHOLE, RATE)                                                                     \
  X(ENGLISH, "rate", WHOLE, RATE)                                                                  \
  X(ENGLISH, "sample rate", WHOLE, RATE)                                                           \
  X(ENGLISH, "samplerate", WHOLE, RATE)                                                            \
  X(ENGLISH, "sampling rate", WHOLE, RATE)                                                         \
  X(ENGLISH, "samplingrate", WHOLE, RATE)                                                          \
  X(ENGLISH, "sampling frequency", WHOLE, RATE)                                                    \
  X(ENGLISH, "sample frequency", WHOLE, RATE)                                                      \
  X(ENGLISH, "samples per second", WHOLE, RATE)                                                    \
  X(GERMAN, "abtastrate", WHOLE, RATE)                                                             \
  X(SYMBOL, "dt", WHOLE, INTERVAL)                                                                 \
  X(SYMBOL, "ts", WHOLE, INTERVAL)                                                                 \
  X(SYMBOL, "tstart", WHOLE, START)                                                                \
  X(SYMBOL, "tinterval", WHOLE, INTERVAL)                                                          \
  X(ENGLISH, "delta t", WHOLE, INTERVAL)                                                           \
  X(ENGLISH, "interval", WHOLE, INTERVAL)                                                          \
  X(ENGLISH, "sample interval", WHOLE, INTERVAL)                                                   \
  X(ENGLISH, "sampling interval", WHOLE, INTERVAL)                                                 \
  X(ENGLISH, "sample period", WHOLE, INTERVAL)                                                     \
  X(ENGLISH, "sampling period", WHOLE, INTERVAL)                                                   \
  X(GERMAN, "abtastintervall", WHOLE, INTERVAL)                                                    \
  X(SYMBOL, "i", WHOLE, AMPERE)                                                                    \
  X(ENGLISH, "current", WHOLE, AMPERE)                                                             \
  X(GERMAN, "strom", WHOLE, AMPERE)
