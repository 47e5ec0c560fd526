/* Parts of every verification program: a page on stdout, and a count of numbers out of tolerance.
 */
#pragma once

#include "base/context.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int verify_failures;

/* Whether the program was called with --small: few and coarse meshes, for the tests. */
static inline bool verify_is_small(int argc, char **argv)
{
  return argc > 1 && strcmp(argv[1], "--small") == 0;
}

/* Ends the program with the context's message when a call fails: there is no page then. */
static inline void verify_ok(struct dea_context *ctx, dea_status status)
{
  if (status != DEA_OK) {
    fprintf(stderr, "failed: %s\n%s\n", dea_context_message(ctx), dea_context_chain(ctx));
    exit(1);
  }
}

/* Counts a failure, and says so on stderr, unless |got - wanted| <= tolerance |wanted|. */
static inline double verify_relative(const char *what, double got, double wanted, double tolerance)
{
  if (!(fabs(got - wanted) <= tolerance * fabs(wanted))) {
    fprintf(stderr, "%s: %.9g, but %.9g was wanted within %g\n", what, got, wanted, tolerance);
    verify_failures++;
  }
  return got / wanted - 1;
}

/* The same for |got - wanted| <= tolerance. */
static inline double verify_absolute(const char *what, double got, double wanted, double tolerance)
{
  if (!(fabs(got - wanted) <= tolerance)) {
    fprintf(stderr, "%s: %.9g, but %.9g was wanted within %g\n", what, got, wanted, tolerance);
    verify_failures++;
  }
  return got - wanted;
}

/* Exit code of the program. */
static inline int verify_end(void)
{
  return verify_failures == 0 ? 0 : 1;
}
