/* Which of some readings is asked for next, one question at a time and each once an interval. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { DEA_POLL_MAX = 8 };

struct dea_poll_schedule {
  size_t count;                 // of readings
  double interval_s, timeout_s; // between two questions for one; longest wait for an answer
  double due_s[DEA_POLL_MAX];   // on the computer's clock
  size_t reading;               // that was asked for last
  double asked_s;               // when that was
};

/* All are due now. */
void dea_poll_schedule_start(struct dea_poll_schedule *schedule, double now_s);
/* Whether a reading is to be asked for now: `reading` and `asked_s` are it then. *next_s: when its
 * answer is late, or when the next one is due; INFINITY without readings. */
bool dea_poll_schedule_next(struct dea_poll_schedule *schedule, double now_s, double *next_s);
