/* One context and the solver of solids for all tests of a program:
 * TESTS(solid_set_up, solid_tear_down). */
#pragma once

#include "model/solid/assembly/solid.h"

#include "context_fixture.h" // after: its context shadows no name of the header above

static inline int solid_set_up(void **state)
{
  return context_set_up(state) == 0 && dea_solid_start(ctx) == DEA_OK ? 0 : -1;
}

static inline int solid_tear_down(void **state)
{
  dea_solid_stop();
  return context_tear_down(state);
}
