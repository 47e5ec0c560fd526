/* How a recording lies in its file; recorder.c writes it, recording_read.c reads it.
 *
 *   attributes format, version
 *   title, protocol, design, design_name, provenance   whole texts, where there are any; of other
 *                       programs attributes too, as `state`
 *   state               text of STATE_SIZE bytes, overwritten in place at the end
 *   output              the same size: what is known of the output at the end; "" while it runs
 *   channels/KEY        attributes name, quantity, unit, index, start_s, interval_s, filter_Hz, and
 *                       lowest, highest where the range is known
 *     values [n]        and, where interval_s is 0, time [n]
 *   profiles            x_m [points], time_s [n], z_m [n][points]
 *   cycles [n][5]       step, number, start_s, end_s, level_V; other programs may have none
 *   events [n][5]       time_s, kind, channel, value, limit; older files have none */
#pragma once

#define DEA_RECORDING_FORMAT "dea recording"
enum {
  DEA_RECORDING_VERSION = 1,
  DEA_STATE_SIZE = 512,
  DEA_CYCLE_WIDTH = 5,
  DEA_NOTICED_WIDTH = 5
};

/* What `state` says. */
#define DEA_STATE_RUNNING "running"
#define DEA_STATE_COMPLETE "complete"
#define DEA_STATE_ENDED "ended: "
