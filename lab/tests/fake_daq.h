/* What tests see of the library that looks like NI-DAQmx: the calls that it got, and how it is to
 * behave. Its inputs see its output: input k of sample i is (k + 1) times what was played in it. */
#pragma once

#include <stddef.h>

enum { FAKE_DAQ_SAMPLES = 20000, FAKE_DAQ_LOG = 16384 };

struct fake_daq {
  /* Behaviour, set by the test. */
  char fails[64]; // function that fails with `code`; "": none
  int code;
  int fails_after;    // calls of it that are good before
  double rate_factor; // actual rate over asked rate; 0: 1
  int dry_after;      // samples after which the output runs dry; 0: never
  /* What happened. */
  char log[FAKE_DAQ_LOG];
  double played[FAKE_DAQ_SAMPLES]; // on the clock
  size_t written, read, queue;
  double level_V; // of the output now
  int tasks;
  int running;
};

/* The one of a loaded library, by its name. */
typedef struct fake_daq *(*fake_daq_get)(void);
