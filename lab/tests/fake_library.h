/* What the fake libraries of DAQs share: their state, and the log of the calls that they get. */
#pragma once

#include "fake_daq.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static struct fake_daq fake;
static int good_calls;

__attribute__((visibility("default"))) struct fake_daq *fake_daq(void);
struct fake_daq *fake_daq(void)
{
  return &fake;
}

/* Logs a call; whether it is to fail. */
static inline bool fake_fails(const char *name, const char *format, va_list arguments)
{
  size_t length = strlen(fake.log);
  char text[400];
  vsnprintf(text, sizeof text, format, arguments);
  snprintf(fake.log + length, sizeof fake.log - length, "%s(%s)\n", name, text);
  if (strcmp(fake.fails, name) != 0 || good_calls++ < fake.fails_after) {
    return false;
  }
  good_calls = 0;
  return true;
}
