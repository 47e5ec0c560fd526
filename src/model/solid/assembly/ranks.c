/* Several processes at one solid (docs/performance.md): start of MPI and PETSc, sums and agreement.
 *
 * Mesh, displacements and forces are on every rank; elements, pieces of loads and rows of K are
 * split. What a decision hangs on is summed on one rank and sent to the others, so that all see the
 * same bits and go the same way. */
#define _POSIX_C_SOURCE 200809L // setenv
#include "model/solid/assembly/internal.h"

#include <slepcsys.h>

#include <stdio.h>
#include <stdlib.h>

/* Outside of mpirun Open MPI need not look for networks: a fifth of the start-up. */
static void start_mpi_alone(void)
{
  if (getenv("OMPI_COMM_WORLD_SIZE") == NULL) {
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_btl", "self", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
  }
}

dea_status dea_solid_start(struct dea_context *ctx)
{
  // the signals are the caller's: an interrupt has to keep the points that are there
  char name[] = "dea", option[] = "-no_signal_handler", *words[] = {name, option, NULL};
  char **argv = words;
  int argc = 2;
  PetscBool running = PETSC_FALSE;
  PetscInitialized(&running);
  if (running) {
    return DEA_OK;
  }
  start_mpi_alone();
  if (PetscInitialize(&argc, &argv, NULL, NULL) != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "PETSc could not be started");
  }
  if (SlepcInitializeNoArguments() != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "SLEPc could not be started");
  }
  PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
  PetscMPIInt size;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  if (size > 1 && atexit(dea_solid_stop) != 0) { // mpirun takes a process that leaves for crashed
    return dea_fail(ctx, DEA_E_TOOL, "PETSc's end could not be arranged");
  }
  return DEA_OK;
}

void dea_solid_stop(void)
{
  PetscBool running = PETSC_FALSE;
  PetscInitialized(&running);
  if (running) {
    SlepcFinalize(); // PETSc was started first and goes last
    PetscFinalize();
  }
}

int dea_solid_rank(void)
{
  PetscMPIInt rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

bool dea_solid_any(bool here)
{
  int flag = here;
  MPI_Allreduce(MPI_IN_PLACE, &flag, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  return flag != 0;
}

dea_status dea_solid_agree(struct dea_context *ctx, const struct dea_solid *s, dea_status status)
{
  enum { TEXT = 256 };
  if (s->size == 1) {
    return status;
  }
  struct {
    int status;
    char text[TEXT];
  } failure = {.status = (int)status};
  int first = status != DEA_OK ? s->rank : s->size;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  if (first == s->size) {
    return DEA_OK;
  }
  if (ctx != NULL && s->rank == first) {
    snprintf(failure.text, sizeof failure.text, "%s", dea_context_message(ctx));
  }
  MPI_Bcast(&failure, sizeof failure, MPI_BYTE, first, PETSC_COMM_WORLD);
  if (ctx != NULL && s->rank != first) {
    return dea_fail(ctx, (dea_status)failure.status, "%s", failure.text);
  }
  return (dea_status)failure.status;
}

void dea_solid_sum(const struct dea_solid *s, double *values, size_t count)
{
  if (s->size > 1) { // not MPI_Allreduce, which may give each rank other bits
    MPI_Reduce(s->rank == 0 ? MPI_IN_PLACE : values, values, (int)count, MPI_DOUBLE, MPI_SUM, 0,
               PETSC_COMM_WORLD);
    MPI_Bcast(values, (int)count, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  }
}

double dea_solid_largest(const struct dea_solid *s, double value)
{
  if (s->size > 1) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  }
  return value;
}

void dea_solid_share(const struct dea_solid *s, size_t count, size_t *from, size_t *to)
{
  *from = count * (size_t)s->rank / (size_t)s->size;
  *to = count * ((size_t)s->rank + 1) / (size_t)s->size;
}
