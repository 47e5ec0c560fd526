/* A high-voltage supply that speaks SCPI, imitated on the loopback interface. It has one queue of
 * commands, which it works off one after the other, whoever sent them, and an output that follows
 * what was set at a finite rate. What its output really is can be asked at any moment, and that is
 * what the tests compare with what dea says. */
#pragma once

#include "base/clock.h"
#include "testing.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SUPPLY_LINES = 8192, SUPPLY_LINE = 96, SUPPLY_CLIENTS = 4 };

enum supply_fault {
  SUPPLY_GOOD,
  SUPPLY_SLOW,     // each command takes `delay_s`
  SUPPLY_HANGS,    // nothing is read, done or answered any more; the output stays
  SUPPLY_LIES,     // as slow, but *OPC? is answered at once
  SUPPLY_GARBLES,  // answers are noise
  SUPPLY_HANGS_UP, // the connection is closed, and new ones too
  SUPPLY_FAULTS
};

/* What is wrong with its output and its meter, of a supply that answers all the same; 0: nothing.
 */
struct supply_wrong {
  bool latched;         // the output stays
  bool scaled;          // the output is `scale` times what is set
  double scale, most_V; // the output is cut off there; 0: it is not
  bool blind, frozen;   // the meter shows 0, or what it showed last
  bool deaf;            // to what would set it
};

static inline double supply_wrong_target(const struct supply_wrong *w, double set_V)
{
  double target_V = w->scaled ? w->scale * set_V : set_V;
  return w->most_V > 0 ? fmin(target_V, w->most_V) : target_V;
}

struct supply_line {
  char text[SUPPLY_LINE];
  int client;
};

struct supply {
  // set before the start
  double slew_V_per_s, delay_s;
  bool one_client;    // others wait until it has gone
  int serial;         // of what it says of itself
  int port;           // 0: any
  bool deaf;          // to what would set it: it is operated at its front
  const char *behind; // its measured voltage, which is in kV then: "E3", " kV"; NULL: in V
  bool comma;         // a decimal one
  // of the test
  pthread_t thread;
  pthread_mutex_t lock;
  atomic_bool ended;
  atomic_int fault;
  // of the thread, under the lock
  struct supply_wrong wrong;
  double shown_V; // by the meter
  int listener, clients[SUPPLY_CLIENTS];
  char partial[SUPPLY_CLIENTS][SUPPLY_LINE];
  size_t lengths[SUPPLY_CLIENTS];
  struct supply_line queue[SUPPLY_LINES];
  size_t first, count;
  double busy_until_s;
  bool on;
  double set_V, volts, turned_s; // volts: at the output
  double highest_V;              // that it has been at
  double fed_s;                  // of its watchdog; NAN: not armed
  double watchdog_s;
  size_t commands;
  unsigned noise;
};

/* The output follows; called with the lock held. */
static inline void supply_follow(struct supply *s)
{
  double now_s = dea_clock_s(), most_V = s->slew_V_per_s * (now_s - s->turned_s);
  if (!isnan(s->fed_s) && now_s - s->fed_s > s->watchdog_s) {
    s->on = false; // its watchdog: in hardware, whatever else it does
  }
  double target_V = supply_wrong_target(&s->wrong, s->on ? s->set_V : 0);
  double left_V = s->wrong.latched ? 0 : target_V - s->volts;
  target_V = s->wrong.latched ? s->volts : target_V;
  s->volts = fabs(left_V) <= most_V ? target_V : s->volts + copysign(most_V, left_V);
  s->shown_V = s->wrong.blind ? 0 : s->wrong.frozen ? s->shown_V : s->volts;
  s->highest_V = fmax(s->highest_V, fabs(s->volts));
  s->turned_s = now_s;
}

static inline void supply_answer(struct supply *s, int client, const char *text)
{
  char line[64];
  int length = snprintf(line, sizeof line, "%s\n", text);
  if (atomic_load(&s->fault) == SUPPLY_GARBLES) {
    for (int i = 0; i < length - 1; i++) {
      line[i] = (char)(' ' + (s->noise = s->noise * 1103515245u + 12345u) / 65536u % 94u);
    }
  }
  if (client >= 0 && s->clients[client] >= 0) {
    (void)!send(s->clients[client], line, (size_t)length, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
}

static inline void supply_do(struct supply *s, const struct supply_line *line)
{
  char text[64];
  s->commands++;
  const char *word = strncmp(line->text, "C1:", 3) == 0 ? line->text + 3 : line->text;
  if ((s->deaf || s->wrong.deaf) && strchr(word, '?') == NULL) {
    return;
  }
  if (sscanf(word, "VOLT %lf", &s->set_V) == 1 || sscanf(word, "BSWV OFST,%lf", &s->set_V) == 1) {
    return;
  }
  if (strcmp(word, "OUTP ON") == 0 || strcmp(word, "OUTP OFF") == 0) {
    s->on = word[6] == 'N';
  } else if (strcmp(line->text, "*IDN?") == 0) {
    snprintf(text, sizeof text, "ACME,Supply,%d,1", s->serial);
    supply_answer(s, line->client, text);
  } else if (strcmp(line->text, "*OPC?") == 0) {
    supply_answer(s, line->client, "1");
  } else if (strcmp(line->text, "OUTP?") == 0) {
    supply_answer(s, line->client, s->on ? "1" : "0");
  } else if (strcmp(line->text, "SYST:ERR?") == 0) {
    supply_answer(s, line->client, "0,\"No error\"");
  } else if (strcmp(line->text, "MEAS:VOLT?") == 0) {
    supply_follow(s);
    snprintf(text, sizeof text, "%.3f%s", s->shown_V * (s->behind != NULL ? 1e-3 : 1),
             s->behind != NULL ? s->behind : "");
    if (s->comma) {
      *strchr(text, '.') = ',';
    }
    supply_answer(s, line->client, text);
  } else if (strcmp(line->text, "WDOG ON") == 0 || strcmp(line->text, "WDOG FEED") == 0) {
    s->fed_s = dea_clock_s();
  } else if (strcmp(line->text, "WDOG OFF") == 0) {
    s->fed_s = (double)NAN;
  }
}

/* A line that came: into the queue, or answered at once by one that lies. */
static inline void supply_take(struct supply *s, int client, const char *text)
{
  struct supply_line line = {.client = client};
  snprintf(line.text, sizeof line.text, "%s", text);
  bool lies = atomic_load(&s->fault) == SUPPLY_LIES;
  if (lies && strchr(text, '?') != NULL) {
    supply_do(s, &line);
  } else if (s->count < SUPPLY_LINES) {
    s->queue[(s->first + s->count++) % SUPPLY_LINES] = line;
  }
}

static inline void supply_drop(struct supply *s, int client)
{
  close(s->clients[client]);
  s->clients[client] = -1;
  s->lengths[client] = 0;
}

static inline void supply_read(struct supply *s, int client)
{
  char bytes[512];
  ssize_t got = recv(s->clients[client], bytes, sizeof bytes, MSG_DONTWAIT);
  if (got == 0) {
    supply_drop(s, client);
  }
  for (ssize_t i = 0; i < got; i++) {
    if (bytes[i] == '\n') {
      s->partial[client][s->lengths[client]] = '\0';
      supply_take(s, client, s->partial[client]);
      s->lengths[client] = 0;
    } else if (s->lengths[client] + 1 < SUPPLY_LINE) {
      s->partial[client][s->lengths[client]++] = bytes[i];
    }
  }
}

static inline void supply_accept(struct supply *s)
{
  int free = -1, used = 0;
  for (int i = 0; i < SUPPLY_CLIENTS; i++) {
    used += s->clients[i] >= 0;
    free = s->clients[i] < 0 ? i : free;
  }
  if (free < 0 || (s->one_client && used > 0)) {
    return;
  }
  s->clients[free] = accept(s->listener, NULL, NULL);
  int on = 1;
  if (s->clients[free] >= 0) {
    fcntl(s->clients[free], F_SETFD, FD_CLOEXEC);
    setsockopt(s->clients[free], IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
}

static inline void supply_work(struct supply *s)
{
  int fault = atomic_load(&s->fault);
  double delay_s = fault == SUPPLY_SLOW || fault == SUPPLY_LIES ? s->delay_s : 0;
  while (s->count > 0 && dea_clock_s() >= s->busy_until_s) {
    struct supply_line line = s->queue[s->first];
    s->first = (s->first + 1) % SUPPLY_LINES;
    s->count--;
    supply_do(s, &line);
    supply_follow(s);
    s->busy_until_s = dea_clock_s() + delay_s;
  }
}

static inline void *supply_run(void *user)
{
  struct supply *s = user;
  while (!atomic_load(&s->ended)) {
    struct pollfd entries[SUPPLY_CLIENTS + 1];
    int fault = atomic_load(&s->fault);
    pthread_mutex_lock(&s->lock);
    supply_follow(s);
    if (fault == SUPPLY_HANGS_UP) {
      for (int i = 0; i < SUPPLY_CLIENTS; i++) {
        if (s->clients[i] >= 0) {
          supply_drop(s, i);
        }
      }
    } else if (fault != SUPPLY_HANGS) {
      supply_accept(s);
      for (int i = 0; i < SUPPLY_CLIENTS; i++) {
        if (s->clients[i] >= 0) {
          supply_read(s, i);
        }
      }
      supply_work(s);
    }
    nfds_t n = 0;
    for (int i = 0; i < SUPPLY_CLIENTS; i++) {
      entries[n++] = (struct pollfd){.fd = s->clients[i], .events = POLLIN};
    }
    entries[n++] = (struct pollfd){.fd = s->listener, .events = POLLIN};
    bool idle = fault == SUPPLY_HANGS || fault == SUPPLY_HANGS_UP;
    pthread_mutex_unlock(&s->lock);
    if (idle) {
      dea_clock_wait(0.001);
    } else {
      (void)poll(entries, n, 1);
    }
  }
  return NULL;
}

/* s: zero but for what is set before the start, or one that was stopped, which has its voltage
 * still. */
static inline void supply_start(struct supply *s)
{
  int on = 1;
  struct sockaddr_in address = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)s->port),
                                .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
  s->slew_V_per_s = s->slew_V_per_s > 0 ? s->slew_V_per_s : 100e3;
  s->turned_s = dea_clock_s();
  s->fed_s = (double)NAN;
  s->noise = 1;
  s->count = 0;
  atomic_store(&s->ended, false);
  for (int i = 0; i < SUPPLY_CLIENTS; i++) {
    s->clients[i] = -1;
  }
  s->listener = socket(AF_INET, SOCK_STREAM, 0);
  assert_true(s->listener >= 0);
  setsockopt(s->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  fcntl(s->listener, F_SETFL, O_NONBLOCK);
  fcntl(s->listener, F_SETFD, FD_CLOEXEC);
  assert_int_equal(bind(s->listener, (struct sockaddr *)&address, sizeof address), 0);
  assert_int_equal(listen(s->listener, 8), 0);
  assert_int_equal(getsockname(s->listener, (struct sockaddr *)&address, &size), 0);
  s->port = ntohs(address.sin_port);
  pthread_mutex_init(&s->lock, NULL);
  assert_int_equal(pthread_create(&s->thread, NULL, supply_run, s), 0);
}

static inline void supply_stop(struct supply *s)
{
  atomic_store(&s->ended, true);
  pthread_join(s->thread, NULL);
  for (int i = 0; i < SUPPLY_CLIENTS; i++) {
    if (s->clients[i] >= 0) {
      close(s->clients[i]);
    }
  }
  close(s->listener);
}

static inline void supply_go_wrong(struct supply *s, const struct supply_wrong *wrong)
{
  pthread_mutex_lock(&s->lock);
  supply_follow(s);
  s->wrong = *wrong;
  pthread_mutex_unlock(&s->lock);
}

static inline bool supply_is_on(struct supply *s)
{
  pthread_mutex_lock(&s->lock);
  bool on = s->on;
  pthread_mutex_unlock(&s->lock);
  return on;
}

/* The output, by amount: now, and the highest since this was asked last. */
static inline double supply_volts(struct supply *s)
{
  pthread_mutex_lock(&s->lock);
  supply_follow(s);
  double volts = fabs(s->volts);
  pthread_mutex_unlock(&s->lock);
  return volts;
}

static inline double supply_highest(struct supply *s)
{
  pthread_mutex_lock(&s->lock);
  supply_follow(s);
  double highest_V = s->highest_V;
  s->highest_V = fabs(s->volts);
  pthread_mutex_unlock(&s->lock);
  return highest_V;
}

/* Waits until it is above a voltage; false: not within the time. */
static inline bool supply_reaches(struct supply *s, double volts, double within_s)
{
  for (double until_s = dea_clock_s() + within_s; dea_clock_s() < until_s;) {
    if (supply_volts(s) >= volts) {
      return true;
    }
    dea_clock_wait(0.002);
  }
  return false;
}
