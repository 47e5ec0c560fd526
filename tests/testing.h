/* What every test program needs beside cmocka. */
#pragma once

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

// Fakes take what their interface gives them, and tests a state.
#pragma GCC diagnostic ignored "-Wunused-parameter"

/* Built with gcc's or clang's sanitizer of addresses, which takes the address space and much time.
 */
#if defined __SANITIZE_ADDRESS__
#define SANITIZED 1
#elif defined __has_feature
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

enum { TESTS_MAX = 64 };
static struct CMUnitTest tests_[TESTS_MAX]; // of this program, in the order of its file
static size_t test_count_;

static inline void add_test(const char *name, CMUnitTestFunction test)
{
  if (test_count_ == TESTS_MAX) {
    abort();
  }
  tests_[test_count_++] = (struct CMUnitTest){.name = name, .test_func = test};
}

/* Group fixtures, and those of each test; NULL: none. */
static inline int run_all_each(CMFixtureFunction first, CMFixtureFunction last,
                               CMFixtureFunction before, CMFixtureFunction after)
{
  for (size_t i = 0; i < test_count_; i++) {
    tests_[i].setup_func = before;
    tests_[i].teardown_func = after;
  }
  return cmocka_run_group_tests(tests_, first, last);
}

static inline int run_all(CMFixtureFunction first, CMFixtureFunction last)
{
  return run_all_each(first, last, NULL, NULL);
}

/* TEST(name) { ... } is a test of the program; TESTS, or TESTS_EACH, at the end of the file is the
 * main function that runs them. */
#define TEST(name)                                                                                 \
  static void name(void **state);                                                                  \
  __attribute__((constructor)) static void add_##name(void)                                        \
  {                                                                                                \
    add_test(#name, name);                                                                         \
  }                                                                                                \
  static void name(void **state)
#define TESTS_EACH(set_up, tear_down, before, after)                                               \
  int main(void)                                                                                   \
  {                                                                                                \
    return run_all_each(set_up, tear_down, before, after);                                         \
  }
#define TESTS(set_up, tear_down) TESTS_EACH(set_up, tear_down, NULL, NULL)

/* For a case that is about a number, found by code that other cases of the program run too. */
static inline void skip_sanitized(void)
{
  if (SANITIZED) {
    skip();
  }
}

/* Whether `scripts/test --nightly` runs. */
static inline bool nightly(void)
{
  return getenv("DEA_NIGHTLY") != NULL;
}

/* For a long case that others stand beside: `scripts/test --nightly` runs it. */
static inline void only_nightly(void)
{
  if (!nightly()) {
    skip();
  }
}

/* |value - wanted| <= absolute + relative * |wanted|; prints both numbers when it is not. */
#define assert_close(value, wanted, relative, absolute)                                            \
  do {                                                                                             \
    double close_value_ = (value), close_wanted_ = (wanted);                                       \
    if (!(fabs(close_value_ - close_wanted_) <= (absolute) + (relative)*fabs(close_wanted_))) {    \
      fail_msg("%s = %.15g, wanted %.15g (off by %.3g)", #value, close_value_, close_wanted_,      \
               close_value_ - close_wanted_);                                                      \
    }                                                                                              \
  } while (0)
