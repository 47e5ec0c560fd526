/* A high-voltage supply on a serial line, imitated on a pseudo-terminal: a small buffer, an answer
 * to each command, and an output that follows at a finite rate. What its output really is can be
 * asked at any moment. */
#pragma once

#include "base/clock.h"
#include "fake_supply.h"
#include "testing.h"

#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum line_supply_fault {
  LINE_SUPPLY_GOOD,
  LINE_SUPPLY_SLOW,    // each answer takes `delay_s`
  LINE_SUPPLY_HANGS,   // nothing is read, done or answered any more; the output stays
  LINE_SUPPLY_LIES,    // the measured voltage stays what it was; the output follows
  LINE_SUPPLY_STUCK,   // all is answered, and the output stays
  LINE_SUPPLY_GARBLES, // answers are noise
  LINE_SUPPLY_ERRS,    // answers are errors, and nothing is done
  LINE_SUPPLY_RESETS,  // once: at 0 V with the settings of the start, without a word
  LINE_SUPPLY_PULLED   // the line is gone; the output stays
};

enum { LINE_SUPPLY_BUFFER = 19, LINE_SUPPLY_ANSWER = 256 };

struct line_supply {
  // set before the start
  void (*answer)(struct line_supply *s, const char *command, char out[LINE_SUPPLY_ANSWER]);
  const char *error;
  double slew_V_per_s, delay_s;
  size_t buffer, fragment; // characters of a command; bytes that are sent at a time, 0: all
  // of the test
  pthread_t thread;
  pthread_mutex_t lock;
  atomic_bool ended;
  atomic_int fault;
  int master, keep; // keep: the device's end, held open so that it stays a line without a user
  char device[64];
  // of the thread, under the lock
  int mode;
  double set_V, volts, turned_s, highest_V, lied_V, frequency_Hz, busy_until_s;
  size_t commands, overflows, hurried; // hurried: came before the one before was answered
  unsigned noise;
  struct supply_wrong wrong;
};

/* The output follows; called with the lock held. */
static inline void line_supply_follow(struct line_supply *s)
{
  int fault = atomic_load(&s->fault);
  double now_s = dea_clock_s(), most_V = s->slew_V_per_s * (now_s - s->turned_s);
  double target_V = supply_wrong_target(&s->wrong, s->set_V); // of its converter, in any mode
  double left_V = target_V - s->volts;
  bool stays = s->wrong.latched || fault == LINE_SUPPLY_HANGS || fault == LINE_SUPPLY_STUCK ||
               fault == LINE_SUPPLY_PULLED;
  if (!stays) {
    s->volts = fabs(left_V) <= most_V ? target_V : s->volts + copysign(most_V, left_V);
  }
  if (s->wrong.blind) {
    s->lied_V = 0;
  } else if (fault != LINE_SUPPLY_LIES && !s->wrong.frozen) {
    s->lied_V = s->volts;
  }
  s->highest_V = fmax(s->highest_V, fabs(s->volts));
  s->turned_s = now_s;
}

static inline void line_supply_reset(struct line_supply *s)
{
  s->mode = 0;
  s->set_V = s->volts = 0;
  s->frequency_Hz = 1;
}

static inline void line_supply_write(struct line_supply *s, const char *text)
{
  size_t length = strlen(text);
  while (length > 0) {
    size_t part = s->fragment > 0 && s->fragment < length ? s->fragment : length;
    if (write(s->master, text, part) != (ssize_t)part) {
      return;
    }
    text += part;
    length -= part;
    dea_clock_wait(length > 0 ? 5e-4 : 0);
  }
}

/* Does a command and answers it; called without the lock. */
static inline void line_supply_do(struct line_supply *s, const char *command)
{
  char out[LINE_SUPPLY_ANSWER], line[LINE_SUPPLY_ANSWER + 2];
  int fault = atomic_load(&s->fault);
  pthread_mutex_lock(&s->lock);
  s->commands++;
  snprintf(out, sizeof out, "%s", s->error);
  if (fault != LINE_SUPPLY_ERRS) {
    s->answer(s, command, out);
  }
  line_supply_follow(s);
  for (size_t i = 0; fault == LINE_SUPPLY_GARBLES && out[i] != '\0'; i++) {
    out[i] = (char)(' ' + (s->noise = s->noise * 1103515245u + 12345u) / 65536u % 94u);
  }
  double delay_s = fault == LINE_SUPPLY_SLOW ? s->delay_s : 1e-3;
  pthread_mutex_unlock(&s->lock);
  dea_clock_wait(delay_s);
  struct pollfd entry = {.fd = s->master, .events = POLLIN};
  if (fault == LINE_SUPPLY_GOOD && poll(&entry, 1, 0) > 0) {
    s->hurried++;
  }
  snprintf(line, sizeof line, "%s\r", out);
  line_supply_write(s, line);
}

static inline void *line_supply_run(void *user)
{
  struct line_supply *s = user;
  char command[64];
  size_t length = 0;
  bool reset = false;
  while (!atomic_load(&s->ended)) {
    int fault = atomic_load(&s->fault);
    struct pollfd entry = {.fd = s->master, .events = POLLIN};
    char c;
    pthread_mutex_lock(&s->lock);
    if (fault == LINE_SUPPLY_RESETS && !reset) {
      line_supply_reset(s);
      reset = true;
    }
    line_supply_follow(s);
    pthread_mutex_unlock(&s->lock);
    if (fault == LINE_SUPPLY_PULLED && s->master >= 0) {
      close(s->keep);
      close(s->master);
      s->master = s->keep = -1;
    }
    if (fault == LINE_SUPPLY_HANGS || s->master < 0) {
      dea_clock_wait(5e-3);
    } else if (poll(&entry, 1, 5) > 0 && read(s->master, &c, 1) == 1) {
      if (c == '\r') {
        command[length] = '\0';
        if (length > 0) {
          line_supply_do(s, command);
        }
        length = 0;
      } else if (length < s->buffer) {
        command[length++] = c;
      } else {
        s->overflows++;
      }
    }
  }
  return NULL;
}

/* s: zero but for what is set before the start. Skips the test where there is no pseudo-terminal.
 */
static inline void line_supply_start(struct line_supply *s)
{
  s->slew_V_per_s = s->slew_V_per_s > 0 ? s->slew_V_per_s : 100e3;
  s->turned_s = dea_clock_s();
  s->noise = 1;
  line_supply_reset(s);
  s->master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (s->master < 0 || grantpt(s->master) != 0 || unlockpt(s->master) != 0 ||
      ptsname_r(s->master, s->device, sizeof s->device) != 0) {
    skip();
  }
  s->keep = open(s->device, O_RDWR | O_NOCTTY | O_CLOEXEC);
  assert_true(s->keep >= 0);
  pthread_mutex_init(&s->lock, NULL);
  assert_int_equal(pthread_create(&s->thread, NULL, line_supply_run, s), 0);
}

static inline void line_supply_stop(struct line_supply *s)
{
  atomic_store(&s->ended, true);
  pthread_join(s->thread, NULL);
  if (s->master >= 0) {
    close(s->keep);
    close(s->master);
  }
}

static inline void line_supply_go_wrong(struct line_supply *s, const struct supply_wrong *wrong)
{
  pthread_mutex_lock(&s->lock);
  line_supply_follow(s);
  s->wrong = *wrong;
  pthread_mutex_unlock(&s->lock);
}

/* The output, by amount: now, and the highest since this was asked last. */
static inline double line_supply_volts(struct line_supply *s)
{
  pthread_mutex_lock(&s->lock);
  line_supply_follow(s);
  double volts = fabs(s->volts);
  pthread_mutex_unlock(&s->lock);
  return volts;
}

static inline double line_supply_highest(struct line_supply *s)
{
  pthread_mutex_lock(&s->lock);
  line_supply_follow(s);
  double highest_V = s->highest_V;
  s->highest_V = fabs(s->volts);
  pthread_mutex_unlock(&s->lock);
  return highest_V;
}

/* Waits until it is above a voltage; false: not within the time. */
static inline bool line_supply_reaches(struct line_supply *s, double volts, double within_s)
{
  for (double until_s = dea_clock_s() + within_s; dea_clock_s() < until_s;) {
    if (line_supply_volts(s) >= volts) {
      return true;
    }
    dea_clock_wait(0.002);
  }
  return false;
}
