/* What tests see of a fake library of a DAQ: the calls that it got, and how it is to behave. Its
 * inputs see its output: input k of sample i is (k + 1) times what was played in it. */
#pragma once

#include <stddef.h>

enum { FAKE_DAQ_SAMPLES = 20000, FAKE_DAQ_LOG = 16384 };

struct fake_daq {
  /* Behaviour, set by the test. */
  char fails[64]; // function that fails with `code`; "": none
  int code;
  int fails_after;    // calls of it that are good before
  double rate_factor; // actual rate over asked rate; 0: 1
  double offset;      // number of the lowest voltage, by its calibration
  int dry_after;      // samples after which the output runs dry; 0: never
  /* What happened. */
  char log[FAKE_DAQ_LOG];
  double played[FAKE_DAQ_SAMPLES]; // on the clock
  size_t written, read, queue;
  double level_V; // of the output now
  int tasks;      // or devices that are open
  int running;
};

/* The one of a loaded library, by the symbol "fake_daq". */
typedef struct fake_daq *(*fake_daq_get)(void);
