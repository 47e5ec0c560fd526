/* Several processes at one solid (docs/performance.md): start of MPI and PETSc, sums and agreement;
 * what PETSc's failures mean.
 *
 * Mesh, displacements and forces are on every rank; elements, pieces of loads and rows of K are
 * split. What a decision hangs on is summed on one rank and sent to the others, so that all see the
 * same bits and go the same way. All functions but dea_solid_rank, dea_solid_ranks,
 * dea_solid_share, dea_solid_alloc_doubles and dea_solid_petsc are calls that all ranks make. */
#pragma once

#include "base/arena.h"
#include "base/context.h"

/* PETSc for this process; harmless when it runs already. */
dea_status dea_solid_start(struct dea_context *ctx);
void dea_solid_stop(void);
/* "PETSc 3.18.5, SLEPc 3.18.2, MUMPS 5.5.1": those that are loaded, of MUMPS what PETSc's headers
 * say. */
dea_status dea_solid_libraries(struct dea_context *ctx, char *out, size_t size);
/* Number of this process among those that mpirun started, from 0; and how many these are. */
int dea_solid_rank(void);
int dea_solid_ranks(void);
/* Whether it is so on any rank. */
bool dea_solid_allreduce_any(bool here);
/* Zeroed memory as of dea_alloc on all ranks, or NULL on all of them. */
void *dea_solid_alloc(struct dea_context *ctx, size_t count, size_t size);
/* Several arrays of `count` numbers each, as dea_arena_alloc; arrays: NULL is its end. */
void dea_solid_alloc_doubles(struct dea_arena *memory, size_t count, double **const *arrays);
/* The status and message of the first rank with a failure, on all ranks. ctx: NULL where no message
 * is wanted. */
dea_status dea_solid_allreduce(struct dea_context *ctx, dea_status status);
/* values[count] become their sums over the ranks, the same bits on each. */
void dea_solid_sum(double *values, size_t count);
/* Largest value of all ranks. */
double dea_solid_largest(double value);
/* This rank's part of `count` things, from *from to before *to. */
void dea_solid_share(size_t count, size_t *from, size_t *to);

/* Whether a shorter step may help after this failure; not so where memory runs out or PETSc fails.
 */
static inline bool dea_solid_may_shorten(dea_status status)
{
  return status == DEA_E_NOT_CONVERGED || status == DEA_E_DOMAIN || status == DEA_E_INVERTED;
}

/* DEA_OK in place of such a failure, which is forgotten; any other status as it is. */
static inline dea_status dea_solid_excuse(struct dea_context *ctx, dea_status status)
{
  if (!dea_solid_may_shorten(status)) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

/* DEA_E_INTERRUPTED on all ranks when one of them was interrupted: for each iteration. */
dea_status dea_solid_check_interruption(struct dea_context *ctx);

/* PETSc's error code as a status: DEA_E_MEMORY, DEA_E_UNSUPPORTED, DEA_E_NOT_CONVERGED of numerical
 * failures, DEA_E_TOOL of all others. call: its text, for the message. */
dea_status dea_solid_petsc(struct dea_context *ctx, int code, const char *call);

/* Returns from a function where a call of PETSc fails. */
#define DEA_PETSC(ctx, call) DEA_TRY(ctx, dea_solid_petsc(ctx, call, #call))
