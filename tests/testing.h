/* What every test program needs beside cmocka. */
#ifndef DEA_TESTS_TESTING_H
#define DEA_TESTS_TESTING_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

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

/* For a case that is about a number, found by code that other cases of the program run too. */
static inline void skip_sanitized(void)
{
  if (SANITIZED) {
    skip();
  }
}

/* For a long case that others stand beside: `scripts/test --nightly` runs it. */
static inline void only_nightly(void)
{
  if (getenv("DEA_NIGHTLY") == NULL) {
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

#endif
