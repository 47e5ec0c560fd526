/* The module of the 3D engine: whose turn it is, and what else it offers beside the model "3d". */
#pragma once

#include "base/context.h"

struct dea_model_type;

/* What a model of the module begins with; filled where the module is called. */
struct dea_solid_head {
  const struct dea_model_type *module; // its own functions; static storage of the module
};

/* PETSc, MPI and MUMPS keep what they do in global variables: a call into the module is made
 * between these two, by one thread at a time, in the order in which the threads came. Calls in a
 * call are fine. The second returns its argument. */
void dea_solid_enter(void);
dea_status dea_solid_leave(dea_status status);
#define DEA_SOLID_IN_TURN(call) (dea_solid_enter(), dea_solid_leave(call))

/* Loads the module. *out: what it has under a name, static storage of it. */
dea_status dea_solid_module_symbol(struct dea_context *ctx, const char *name, const void **out);
