#define _DEFAULT_SOURCE // setenv, MAP_ANONYMOUS
#include "model/solid/assembly/ranks.h"

#include <lapacke.h>
#include <petscpkg_version.h>
#include <slepcsys.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Outside of mpirun Open MPI need not look for networks, a fifth of the start-up, nor make the
 * folder in /tmp that all such processes share: one that ends may remove it under another that
 * starts. */
static void start_mpi_alone(void)
{
  if (getenv("OMPI_COMM_WORLD_SIZE") == NULL) {
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
    setenv("OMPI_MCA_btl", "self", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
  }
}

/* PETSc 3.18 mixes up what it says of memory that runs out: the code where the line should be. */
static PetscErrorCode return_code(MPI_Comm comm, int line, const char *function, const char *file,
                                  PetscErrorCode code, PetscErrorType type, const char *message,
                                  void *self)
{
  (void)comm;
  (void)file;
  (void)message;
  (void)self;
  bool malloc_failed =
      function != NULL && strncmp(function, "PetscMalloc", strlen("PetscMalloc")) == 0;
  // of a function that asks for several arrays at once it is that function's own line
  bool is_line = code < PETSC_ERR_MIN_VALUE || code > PETSC_ERR_MAX_VALUE;
  bool swapped = type == PETSC_ERROR_INITIAL && line == PETSC_ERR_MEM && (malloc_failed || is_line);
  return swapped ? PETSC_ERR_MEM : code;
}

/* At its first call OpenBLAS maps a work space of 128 MiB (BUFFER_SIZE of x86-64, 32 << 22), which
 * it keeps, and where there is no room for it it asks again without end. So it is asked for here,
 * once it is known that there is room. */
static dea_status start_blas(struct dea_context *ctx)
{
  static const size_t work_space = (size_t)128 << 20;
  double matrix[] = {2, 1, 1, 1, 2, 1, 1, 1, 2}, values[3];
  // not malloc, which under Open MPI keeps what it is given back
  void *capacity =
      mmap(NULL, work_space, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (capacity == MAP_FAILED) {
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory: the work space of BLAS has no room");
  }
  munmap(capacity, work_space);
  return LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 3, matrix, 3, values) == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_MEMORY, "out of memory: LAPACK cannot be started");
}

/* A signal may reach one of the ranks alone. */
static void agree_on_interruptions(struct dea_context *ctx)
{
  dea_context_set_agreement(ctx, dea_solid_ranks() > 1 ? dea_solid_allreduce_any : NULL);
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
    agree_on_interruptions(ctx);
    return DEA_OK;
  }
  start_mpi_alone();
  PETSC_MPI_THREAD_REQUIRED = MPI_THREAD_SERIALIZED; // threads come in turn (solid_module.h)
  if (PetscInitialize(&argc, &argv, NULL, NULL) != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "PETSc could not be started");
  }
  if (SlepcInitializeNoArguments() != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "SLEPc could not be started");
  }
  PetscPushErrorHandler(return_code, NULL);
  agree_on_interruptions(ctx);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, start_blas(ctx)));
  if (dea_solid_ranks() > 1 &&
      atexit(dea_solid_stop) != 0) { // mpirun takes a process that leaves for crashed
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

dea_status dea_solid_libraries(struct dea_context *ctx, char *out, size_t size)
{
  PetscInt petsc[3] = {0}, slepc[3] = {0}, release;
  (void)ctx;
  PetscGetVersionNumber(&petsc[0], &petsc[1], &petsc[2], &release);
  SlepcGetVersionNumber(&slepc[0], &slepc[1], &slepc[2], &release);
  snprintf(out, size, "PETSc %d.%d.%d, SLEPc %d.%d.%d, MUMPS %d.%d.%d", (int)petsc[0],
           (int)petsc[1], (int)petsc[2], (int)slepc[0], (int)slepc[1], (int)slepc[2],
           PETSC_PKG_MUMPS_VERSION_MAJOR, PETSC_PKG_MUMPS_VERSION_MINOR,
           PETSC_PKG_MUMPS_VERSION_SUBMINOR);
  return DEA_OK;
}

int dea_solid_rank(void)
{
  PetscMPIInt rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

int dea_solid_ranks(void)
{
  PetscMPIInt size = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

bool dea_solid_allreduce_any(bool here)
{
  int flag = here;
  MPI_Allreduce(MPI_IN_PLACE, &flag, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  return flag != 0;
}

void *dea_solid_alloc(struct dea_context *ctx, size_t count, size_t size)
{
  void *here = dea_alloc(ctx, count, size);
  if (dea_solid_allreduce_any(here == NULL)) {
    dea_free(ctx, here);
    return NULL;
  }
  return here;
}

void dea_solid_alloc_doubles(struct dea_arena *memory, size_t count, double **const *arrays)
{
  for (; *arrays != NULL; arrays++) {
    **arrays = dea_arena_alloc(memory, count, sizeof(double));
  }
}

dea_status dea_solid_check_interruption(struct dea_context *ctx)
{
  return dea_interrupted_anywhere(ctx)
             ? dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted on the way to an equilibrium")
             : DEA_OK;
}

dea_status dea_solid_allreduce(struct dea_context *ctx, dea_status status)
{
  enum { TEXT = 256 };
  if (dea_solid_ranks() == 1) {
    return status;
  }
  struct {
    int status;
    char text[TEXT];
  } failure = {.status = (int)status};
  const int rank = dea_solid_rank(), size = dea_solid_ranks();
  int first = status != DEA_OK ? rank : size;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  if (first == size) {
    return DEA_OK;
  }
  if (ctx != NULL && rank == first) {
    snprintf(failure.text, sizeof failure.text, "%s", dea_context_message(ctx));
  }
  MPI_Bcast(&failure, sizeof failure, MPI_BYTE, first, PETSC_COMM_WORLD);
  if (ctx != NULL && rank != first) {
    return dea_fail(ctx, (dea_status)failure.status, "%s", failure.text);
  }
  return (dea_status)failure.status;
}

void dea_solid_sum(double *values, size_t count)
{
  if (dea_solid_ranks() > 1) { // not MPI_Allreduce, which may give each rank other bits
    MPI_Reduce(dea_solid_rank() == 0 ? MPI_IN_PLACE : values, values, (int)count, MPI_DOUBLE,
               MPI_SUM, 0, PETSC_COMM_WORLD);
    MPI_Bcast(values, (int)count, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  }
}

double dea_solid_largest(double value)
{
  if (dea_solid_ranks() > 1) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  }
  return value;
}

void dea_solid_share(size_t count, size_t *from, size_t *to)
{
  size_t rank = (size_t)dea_solid_rank(), size = (size_t)dea_solid_ranks();
  *from = count * rank / size;
  *to = count * (rank + 1) / size;
}

dea_status dea_solid_petsc(struct dea_context *ctx, int code, const char *call)
{
  int length = (int)strcspn(call, "("); // the function's name
  switch (code) {
  case 0:
    return DEA_OK;
  case PETSC_ERR_MEM:
    return dea_fail(ctx, DEA_E_MEMORY, "memory ran out in PETSc's %.*s: take a coarser mesh",
                    length, call);
  case PETSC_ERR_SUP:
  case PETSC_ERR_SUP_SYS:
  case PETSC_ERR_MISSING_FACTOR:
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "this PETSc cannot do %.*s (error %d)", length, call,
                    code);
  case PETSC_ERR_INT_OVERFLOW:
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "the mesh is too large for this PETSc (%.*s)", length,
                    call);
  case PETSC_ERR_MAT_LU_ZRPVT:
  case PETSC_ERR_MAT_CH_ZRPVT:
  case PETSC_ERR_FP:
  case PETSC_ERR_CONV_FAILED:
  case PETSC_ERR_NOT_CONVERGED:
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "PETSc's %.*s did not converge (error %d)", length,
                    call, code);
  default:
    return dea_fail(ctx, DEA_E_TOOL, "PETSc failed in %.*s (error %d)", length, call, code);
  }
}
