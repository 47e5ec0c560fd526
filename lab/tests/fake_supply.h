/* A high-voltage supply, imitated: one that speaks SCPI on the loopback interface, or one on a
 * serial line, which is a pseudo-terminal. On the network it has one queue of commands, which it
 * works off one after the other, whoever sent them; on a line a small buffer, and an answer to each
 * command. Its output follows what was set at a finite rate. What that really is can be asked at
 * any moment, and that is what the tests compare with what dea says. */
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

enum {
  SUPPLY_LINES = 1024,
  SUPPLY_LINE = 96,
  SUPPLY_CLIENTS = 4,
  SUPPLY_ANSWER = 256,
  SUPPLY_SHVPS_BUFFER = 19
};

enum supply_fault {
  SUPPLY_GOOD,
  SUPPLY_SLOW,     // each command takes `delay_s`; on a line its answer
  SUPPLY_HANGS,    // nothing is read, done or answered any more; the output stays
  SUPPLY_GARBLES,  // answers are noise
  SUPPLY_HANGS_UP, // the connection is closed, and new ones too; a line is gone for good
  // of one on the network
  SUPPLY_LIES, // as slow, but *OPC? is answered at once
  // of one on a line
  SUPPLY_ERRS,  // answers are errors, and nothing is done
  SUPPLY_RESETS // once: at 0 V with the settings of the start, without a word
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
  struct supply_wrong wrong;
  bool one_client;    // others wait until it has gone
  int serial;         // of what it says of itself
  int port;           // 0: any
  const char *behind; // its measured voltage, which is in kV then: "E3", " kV"; NULL: in V
  bool comma;         // a decimal one
  // of one on a line
  void (*answer)(struct supply *s, const char *command, char out[SUPPLY_ANSWER]);
  const char *error;
  size_t buffer, fragment; // characters of a command; bytes that are sent at a time, 0: all
  // of the test
  pthread_t thread;
  pthread_mutex_t lock;
  bool started;
  atomic_bool ended;
  atomic_int fault;
  // of the thread, under the lock
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
  // of one on a line
  int line, keep; // keep: the device's end, held open so that it stays a line without a user
  char device[64];
  int mode;
  double frequency_Hz;
  size_t overflows, hurried; // hurried: came before the one before was answered
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

static inline void supply_garble(struct supply *s, char *text)
{
  for (; atomic_load(&s->fault) == SUPPLY_GARBLES && *text != '\0'; text++) {
    *text = (char)(' ' + (s->noise = s->noise * 1103515245u + 12345u) / 65536u % 94u);
  }
}

// On the network ---------------------------------------------------------------------------------

static inline void supply_answer(struct supply *s, int client, char *text)
{
  char line[SUPPLY_ANSWER];
  supply_garble(s, text);
  int length = snprintf(line, sizeof line, "%s\n", text);
  if (client >= 0 && s->clients[client] >= 0) {
    (void)!send(s->clients[client], line, (size_t)length, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
}

static inline void supply_do(struct supply *s, const struct supply_line *line)
{
  char text[SUPPLY_ANSWER] = "";
  s->commands++;
  const char *word = strncmp(line->text, "C1:", 3) == 0 ? line->text + 3 : line->text;
  if (s->wrong.deaf && strchr(word, '?') == NULL) {
    return;
  }
  if (sscanf(word, "VOLT %lf", &s->set_V) == 1 || sscanf(word, "BSWV OFST,%lf", &s->set_V) == 1) {
    return;
  }
  if (strcmp(word, "OUTP ON") == 0 || strcmp(word, "OUTP OFF") == 0) {
    s->on = word[6] == 'N';
  } else if (strcmp(word, "*IDN?") == 0) {
    snprintf(text, sizeof text, "ACME,Supply,%d,1", s->serial);
  } else if (strcmp(word, "*OPC?") == 0) {
    snprintf(text, sizeof text, "1");
  } else if (strcmp(word, "OUTP?") == 0) {
    snprintf(text, sizeof text, "%d", s->on);
  } else if (strcmp(word, "SYST:ERR?") == 0) {
    snprintf(text, sizeof text, "0,\"No error\"");
  } else if (strcmp(word, "MEAS:VOLT?") == 0) {
    supply_follow(s);
    snprintf(text, sizeof text, "%.3f%s", s->shown_V * (s->behind != NULL ? 1e-3 : 1),
             s->behind != NULL ? s->behind : "");
    if (s->comma) {
      *strchr(text, '.') = ',';
    }
  } else if (strcmp(word, "WDOG ON") == 0 || strcmp(word, "WDOG FEED") == 0) {
    s->fed_s = dea_clock_s();
  } else if (strcmp(word, "WDOG OFF") == 0) {
    s->fed_s = (double)NAN;
  }
  if (text[0] != '\0') {
    supply_answer(s, line->client, text);
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

static inline void *supply_serve(void *user)
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

static inline void supply_listen(struct supply *s)
{
  int on = 1;
  struct sockaddr_in address = {.sin_family = AF_INET,
                                .sin_port = htons((uint16_t)s->port),
                                .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
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
}

// On a line --------------------------------------------------------------------------------------

static inline void supply_reset(struct supply *s)
{
  s->mode = 0;
  s->set_V = s->volts = 0;
  s->frequency_Hz = 1;
}

static inline void supply_write(struct supply *s, const char *text)
{
  size_t length = strlen(text);
  while (length > 0) {
    size_t part = s->fragment > 0 && s->fragment < length ? s->fragment : length;
    if (write(s->line, text, part) != (ssize_t)part) {
      return;
    }
    text += part;
    length -= part;
    dea_clock_wait(length > 0 ? 5e-4 : 0);
  }
}

/* Does a command and answers it; called without the lock. */
static inline void supply_reply(struct supply *s, const char *command)
{
  char out[SUPPLY_ANSWER], line[SUPPLY_ANSWER + 2];
  int fault = atomic_load(&s->fault);
  pthread_mutex_lock(&s->lock);
  s->commands++;
  snprintf(out, sizeof out, "%s", s->error);
  if (fault != SUPPLY_ERRS) {
    s->answer(s, command, out);
  }
  supply_follow(s);
  supply_garble(s, out);
  double delay_s = fault == SUPPLY_SLOW ? s->delay_s : 1e-3;
  pthread_mutex_unlock(&s->lock);
  dea_clock_wait(delay_s);
  struct pollfd entry = {.fd = s->line, .events = POLLIN};
  if (fault == SUPPLY_GOOD && poll(&entry, 1, 0) > 0) {
    s->hurried++;
  }
  snprintf(line, sizeof line, "%s\r", out);
  supply_write(s, line);
}

static inline void supply_close_line(struct supply *s)
{
  if (s->line >= 0) {
    close(s->keep);
    close(s->line);
    s->line = s->keep = -1;
  }
}

static inline void *supply_serve_line(void *user)
{
  struct supply *s = user;
  char command[64], c;
  size_t length = 0;
  bool reset = false;
  while (!atomic_load(&s->ended)) {
    int fault = atomic_load(&s->fault);
    struct pollfd entry = {.fd = s->line, .events = POLLIN};
    pthread_mutex_lock(&s->lock);
    if (fault == SUPPLY_RESETS && !reset) {
      supply_reset(s);
      reset = true;
    }
    supply_follow(s);
    pthread_mutex_unlock(&s->lock);
    if (fault == SUPPLY_HANGS_UP) {
      supply_close_line(s);
    }
    if (fault == SUPPLY_HANGS || s->line < 0) {
      dea_clock_wait(5e-3);
    } else if (poll(&entry, 1, 5) > 0 && read(s->line, &c, 1) == 1) {
      if (c == '\r') {
        command[length] = '\0';
        if (length > 0) {
          supply_reply(s, command);
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

/* Skips the test where there is no pseudo-terminal. */
static inline void supply_open_line(struct supply *s)
{
  supply_reset(s);
  s->on = true;
  s->line = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (s->line < 0 || grantpt(s->line) != 0 || unlockpt(s->line) != 0 ||
      ptsname_r(s->line, s->device, sizeof s->device) != 0) {
    skip();
  }
  s->keep = open(s->device, O_RDWR | O_NOCTTY | O_CLOEXEC);
  assert_true(s->keep >= 0);
}

// Either -----------------------------------------------------------------------------------------

/* s: zero but for what is set before the start, or one that was stopped, which has its voltage
 * still. */
static inline void supply_start(struct supply *s)
{
  s->slew_V_per_s = s->slew_V_per_s > 0 ? s->slew_V_per_s : 100e3;
  s->turned_s = dea_clock_s();
  s->fed_s = (double)NAN;
  s->noise = 1;
  s->count = 0;
  s->started = true;
  atomic_store(&s->ended, false);
  if (s->answer != NULL) {
    supply_open_line(s);
  } else {
    supply_listen(s);
  }
  pthread_mutex_init(&s->lock, NULL);
  assert_int_equal(
      pthread_create(&s->thread, NULL, s->answer != NULL ? supply_serve_line : supply_serve, s), 0);
}

static inline void supply_stop(struct supply *s)
{
  s->started = false;
  atomic_store(&s->ended, true);
  pthread_join(s->thread, NULL);
  if (s->answer != NULL) {
    supply_close_line(s);
    return;
  }
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

/* Waits until it is at 0 V and stays there; how long that took, INFINITY: it did not. */
static inline double supply_comes_down(struct supply *s, double zero_V, double within_s)
{
  double began_s = dea_clock_s(), took_s = (double)INFINITY;
  while (dea_clock_s() < began_s + within_s) {
    if (supply_volts(s) > zero_V) {
      took_s = (double)INFINITY;
    } else if (isinf(took_s)) {
      took_s = dea_clock_s() - began_s;
    } else if (dea_clock_s() > began_s + took_s + 0.3) {
      return took_s;
    }
    dea_clock_wait(0.005);
  }
  return (double)INFINITY;
}
