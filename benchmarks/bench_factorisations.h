/* Factorisations of the engine of solids, as PETSc counts them. */
#pragma once

#include "model/solid/assembly/ranks.h"
#include "timing.h"

#include <petscsys.h>

static inline void bench_count_factorisations(struct dea_context *ctx)
{
  bench_need(dea_solid_start(ctx), ctx);
  PetscLogDefaultBegin();
}

/* Since then; -1 where that is not known. */
static inline double bench_factorisations(void)
{
  PetscLogEvent event;
  PetscEventPerfInfo info = {0};
  return PetscLogEventGetId("MatCholFctrNum", &event) == 0 &&
                 PetscLogEventGetPerfInfo(0, event, &info) == 0
             ? info.count
             : -1;
}
