/* The limits of a protocol, looked at in every sample that comes in. */
#pragma once

#include "drive/arc_watch.h"
#include "drive/leak_watch.h"
#include "instrument/voltage_evidence.h"
#include "protocol/protocol.h"
#include "recording/recording.h"

enum { DEA_WHY_ENDED_SIZE = 256, DEA_WATCH_EVENTS_MAX = 2 * DEA_PROTOCOL_INPUTS_MAX };

struct dea_drive_watch {
  const struct dea_protocol *protocol; // lent
  size_t lasting;                      // samples that a limit has to be exceeded in a row
  size_t blind;                        // samples in a row that may be missing
  size_t exceeded[DEA_PROTOCOL_INPUTS_MAX], missing[DEA_PROTOCOL_INPUTS_MAX];
  /* Lowest and highest asked voltage of this window and the one before: what an amplifier that
   * settles within a window may be at. */
  double lowest_V[2], highest_V[2];
  size_t window, in_window;
  double largest_current_A;                           // by amount; NAN: none came
  struct dea_arc_watch arcs[DEA_PROTOCOL_INPUTS_MAX]; // of the currents
  double asked_V;                                     // of the last sample
  double cap_V[2]; // lowest and highest voltage that may be measured at all
  struct dea_leak_watch leaks[DEA_PROTOCOL_INPUTS_MAX];   // of the currents
  double sample;                                          // number of the next one
  struct dea_evidence evidence[DEA_PROTOCOL_INPUTS_MAX];  // of the voltages
  struct dea_recorded_event events[DEA_WATCH_EVENTS_MAX]; // of the last sample; channel: of inputs
  size_t event_count;
  bool over;        // a current of this sample is above trip_current
  bool pulled_down; // a voltage channel showed less than was asked, which a current explained
};

/* settle_s: time that the voltage has to follow what is asked. capacitance_F: of the film; 0 or
 * NAN: not known. */
void dea_drive_watch_start(struct dea_drive_watch *watch, const struct dea_protocol *protocol,
                           double settle_s, double capacitance_F);
/* Why 0 V is not believed should the voltage channels show it, static; NULL: it is. */
const char *dea_drive_watch_doubt(const struct dea_drive_watch *watch);
/* Whether the channel of a current shows more than trip_current. */
bool dea_drive_watch_is_over(const struct dea_protocol *protocol, size_t input, double current_A);
/* Looks at one sample: asked voltage, and the values of all inputs in SI (NAN: lost). False when
 * the measurement must end; `why` then says it. A limit has to be exceeded for the protocol's
 * trip_time, or the current
 * comes and goes as arcs do (arc_watch.h); a channel that is watched and gives nothing for half a
 * second ends it too. */
bool dea_drive_watch_sample(struct dea_drive_watch *watch, double asked_V, const double *values,
                            char why[DEA_WHY_ENDED_SIZE]);
