/* A headless Chromium that a test drives over the pipe of its DevTools protocol. */
#pragma once

#include "testing.h"

#include <fcntl.h>
#include <jansson.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BROWSER_WAIT_MS = 60000, BROWSER_TROUBLE_SIZE = 4000 };

struct browser {
  pid_t pid;
  int to, from;
  char *buffer; // what has come and is not read yet
  size_t length, capacity;
  int last_id;
  char session[128];
  char trouble[BROWSER_TROUBLE_SIZE]; // errors, messages and requests of pages so far
  int requests;                       // for documents
  const char *site;                   // of a server that may be asked; NULL: none
};

static inline void browser_trouble(struct browser *b, const char *what, const json_t *detail)
{
  char *text = json_dumps(detail, JSON_COMPACT | JSON_ENCODE_ANY);
  size_t used = strlen(b->trouble);
  snprintf(b->trouble + used, sizeof b->trouble - used, "%s: %.600s\n", what,
           text != NULL ? text : "");
  free(text);
}

/* What a page does unasked: errors and requests are kept. */
static inline void browser_event(struct browser *b, const char *method, const json_t *params)
{
  if (strcmp(method, "Runtime.exceptionThrown") == 0 ||
      strcmp(method, "Runtime.consoleAPICalled") == 0 || strcmp(method, "Log.entryAdded") == 0) {
    browser_trouble(b, method, params);
  } else if (strcmp(method, "Network.requestWillBeSent") == 0) {
    const char *url = json_string_value(json_object_get(json_object_get(params, "request"), "url"));
    b->requests += url != NULL && strncmp(url, "file:", 5) == 0;
    const bool site = b->site != NULL && url != NULL && strncmp(url, b->site, strlen(b->site)) == 0;
    if (!site &&
        (url == NULL || (strncmp(url, "file:", 5) != 0 && strncmp(url, "data:", 5) != 0))) {
      browser_trouble(b, "request", params);
    }
  } else if (strcmp(method, "Page.javascriptDialogOpening") == 0) {
    browser_trouble(b, method, params);
  }
}

/* The next message; owned by the caller. */
static inline json_t *browser_read(struct browser *b)
{
  for (;;) {
    char *end = b->length > 0 ? memchr(b->buffer, '\0', b->length) : NULL;
    if (end != NULL) {
      size_t size = (size_t)(end - b->buffer) + 1;
      json_t *message = json_loads(b->buffer, 0, NULL);
      memmove(b->buffer, end + 1, b->length - size);
      b->length -= size;
      assert_non_null(message);
      return message;
    }
    struct pollfd ready = {.fd = b->from, .events = POLLIN};
    if (poll(&ready, 1, BROWSER_WAIT_MS) <= 0) {
      fail_msg("the browser says nothing");
    }
    if (b->capacity - b->length < 65536) {
      b->capacity = 2 * b->capacity + 131072;
      b->buffer = realloc(b->buffer, b->capacity);
      assert_non_null(b->buffer);
    }
    ssize_t got = read(b->from, b->buffer + b->length, b->capacity - b->length);
    if (got <= 0) {
      fail_msg("the browser has ended");
    }
    b->length += (size_t)got;
  }
}

/* Calls a method; takes params. The result is owned by the caller. */
static inline json_t *browser_call(struct browser *b, const char *method, json_t *params)
{
  json_t *message = json_pack("{s:i, s:s, s:o}", "id", ++b->last_id, "method", method, "params",
                              params != NULL ? params : json_object());
  if (b->session[0] != '\0') {
    json_object_set_new(message, "sessionId", json_string(b->session));
  }
  char *text = json_dumps(message, JSON_COMPACT);
  json_decref(message);
  size_t size = strlen(text) + 1;
  for (size_t done = 0; done < size;) {
    ssize_t wrote = write(b->to, text + done, size - done);
    assert_true(wrote > 0);
    done += (size_t)wrote;
  }
  free(text);
  for (;;) {
    json_t *answer = browser_read(b);
    const char *event = json_string_value(json_object_get(answer, "method"));
    if (event != NULL) {
      browser_event(b, event, json_object_get(answer, "params"));
    } else if (json_integer_value(json_object_get(answer, "id")) == b->last_id) {
      json_t *result = json_object_get(answer, "result");
      if (result == NULL) {
        browser_trouble(b, method, json_object_get(answer, "error"));
        fail_msg("%s", b->trouble);
      }
      json_incref(result);
      json_decref(answer);
      return result;
    }
    json_decref(answer);
  }
}

static inline void browser_do(struct browser *b, const char *method, json_t *params)
{
  json_decref(browser_call(b, method, params));
}

/* Starts it with a profile of its own in a folder that the caller removes. */
static inline void browser_start(struct browser *b, const char *program, const char *folder)
{
  int there[2], back[2];
  char profile[700];
  *b = (struct browser){.pid = -1};
  snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", folder);
  assert_int_equal(pipe(there), 0);
  assert_int_equal(pipe(back), 0);
  b->pid = fork();
  assert_true(b->pid >= 0);
  if (b->pid == 0) { // it reads commands from 3 and answers on 4
    int nothing = open("/dev/null", O_RDWR);
    int in = fcntl(there[0], F_DUPFD, 10), out = fcntl(back[1], F_DUPFD, 10);
    dup2(nothing, 0);
    dup2(nothing, 1);
    dup2(nothing, 2);
    dup2(in, 3);
    dup2(out, 4);
    for (int fd = 5; fd < 64; fd++) {
      close(fd);
    }
    setpgid(0, 0);
    setenv("HOME", folder, 1);
    execl(program, program, "--headless", "--no-sandbox", "--disable-quic", "--no-first-run",
          "--disable-background-networking", "--disable-component-update", "--disable-sync",
          "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
          "--remote-debugging-pipe", "--window-size=1200,900", profile, "about:blank",
          (char *)NULL);
    _exit(127);
  }
  close(there[0]);
  close(back[1]);
  b->to = there[1];
  b->from = back[0];
}

/* A new page that reports what it does, then the file or address; returns when it is loaded and its
 * scripts are ready. */
static inline void browser_open(struct browser *b, const char *path)
{
  b->session[0] = b->trouble[0] = '\0';
  b->requests = 0;
  json_t *made = browser_call(b, "Target.createTarget", json_pack("{s:s}", "url", "about:blank"));
  json_t *attached = browser_call(
      b, "Target.attachToTarget",
      json_pack("{s:O, s:b}", "targetId", json_object_get(made, "targetId"), "flatten", 1));
  snprintf(b->session, sizeof b->session, "%s",
           json_string_value(json_object_get(attached, "sessionId")));
  json_decref(made);
  json_decref(attached);
  static const char *const listen[] = {"Runtime.enable", "Log.enable", "Network.enable",
                                       "Page.enable"};
  for (size_t i = 0; i < sizeof listen / sizeof listen[0]; i++) {
    browser_do(b, listen[i], NULL);
  }
  char url[800];
  snprintf(url, sizeof url, "%s%s", path[0] == '/' ? "file://" : "", path);
  browser_do(b, "Page.navigate", json_pack("{s:s}", "url", url));
}

/* Value of an expression, awaited; owned by the caller. */
static inline json_t *browser_value(struct browser *b, const char *expression)
{
  json_t *answer = browser_call(b, "Runtime.evaluate",
                                json_pack("{s:s, s:b, s:b}", "expression", expression,
                                          "awaitPromise", 1, "returnByValue", 1));
  if (json_object_get(answer, "exceptionDetails") != NULL) {
    browser_trouble(b, expression, json_object_get(answer, "exceptionDetails"));
    fail_msg("%s", b->trouble);
  }
  json_t *value = json_object_get(json_object_get(answer, "result"), "value");
  json_incref(value);
  json_decref(answer);
  return value;
}

static inline double browser_number(struct browser *b, const char *expression)
{
  json_t *value = browser_value(b, expression);
  double number = json_is_number(value) ? json_number_value(value)
                                        : (json_is_true(value)    ? 1.0
                                           : json_is_false(value) ? 0.0
                                                                  : NAN);
  json_decref(value);
  return number;
}

/* Waits until the page and its scripts are there. */
static inline void browser_ready(struct browser *b)
{
  for (int i = 0; i < 600; i++) {
    if (browser_number(b, "location.protocol !== 'about:' && document.readyState === 'complete' && "
                          "typeof dea === 'object'") == 1) {
      json_decref(browser_value(b, "Promise.resolve(dea.ready).then(() => 1)"));
      return;
    }
    usleep(50000);
  }
  fail_msg("the page does not load");
}

static inline void browser_stop(struct browser *b)
{
  if (b->pid > 0) {
    kill(-b->pid, SIGKILL); // its group: the processes that it has started too
    waitpid(b->pid, NULL, 0);
    close(b->to);
    close(b->from);
  }
  free(b->buffer);
  b->pid = -1;
  b->buffer = NULL;
}
