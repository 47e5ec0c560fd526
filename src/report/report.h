/* The report: runs as one self-contained HTML file (docs/report.md). */
#pragma once

#include "io/results_h5.h"

enum { DEA_REPORT_RUNS_MAX = 8 };

struct dea_report_options {
  const char *command;     // command line of the report, for its last line; NULL: none
  double finger_N_per_m;   // stiffness of a fingertip against which a load line is set; 0: none
  const char *measurement; // set beside the runs: CSV or folder (compare/measured.h); NULL: none
  const char *fit;         // folder of dea fit, a section of its own; NULL: none
  const char *explorer;    // folder of a dea sweep of the plan sparse-grid; NULL: none
};

/* One of the runs; all lent to the report. design, device: NULL when the file cannot be read any
 * more. */
struct dea_report_run {
  const char *path;           // as given
  char title[DEA_TITLE_SIZE]; // of the design, or the file's name
  int number;                 // from 1
  struct dea_run *run;
  struct dea_design *design;
  struct dea_device *device;
  char *missing;               // why there is no device; NULL
  const char *emulator;        // emulator.json of the sweep of its design; NULL: none
  char *reduced;               // file of its model reduced, with `quantities`; NULL: none
  double blocked_N, blocked_V; // largest force of that which holds it where it is at 0 V; NAN
  char **notes;                // [note_count] what the run has said of itself
  size_t note_count;
};

/* Writes one page of the runs [count], 1 to DEA_REPORT_RUNS_MAX, as a whole or not at all. What a
 * run does not have is left out. path: of the file. DEA_E_IO as dea_measured_read, or where
 * there is no fit. */
dea_status dea_report_write(struct dea_context *ctx, const struct dea_report_run *runs,
                            size_t count, const struct dea_report_options *options,
                            const char *path);
