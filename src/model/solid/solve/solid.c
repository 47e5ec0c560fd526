#define _POSIX_C_SOURCE 200809L // setenv
#include "model/solid/solve/internal.h"

#include <stdlib.h>
#include <string.h>

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
  PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
  return DEA_OK;
}

void dea_solid_stop(void)
{
  PetscFinalize();
}

dea_status dea_solid_petsc(struct dea_context *ctx, PetscErrorCode code, const char *what)
{
  return code == 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_NOT_CONVERGED, "PETSc failed in %s (error %d)", what, (int)code);
}

/* ---- creation ---- */

/* Upper block row lengths: neighbours of a node that are not before it. */
static dea_status count_blocks(struct dea_context *ctx, const struct dea_solid *s, PetscInt *counts)
{
  const struct dea_grid *grid = s->grid;
  size_t per = (size_t)s->shape.nodes;
  size_t *first = dea_alloc(ctx, grid->node_count + 2, sizeof *first);
  int *elements = dea_alloc(ctx, grid->element_count * per, sizeof *elements);
  int *seen = dea_alloc(ctx, grid->node_count, sizeof *seen);
  if (first != NULL && elements != NULL && seen != NULL) {
    for (size_t e = 0; e < grid->element_count; e++) {
      for (size_t n = 0; n < per; n++) {
        first[grid->nodes[e * DEA_HEX_NODES_MAX + n] + 2]++;
      }
    }
    for (size_t i = 2; i < grid->node_count + 2; i++) {
      first[i] += first[i - 1];
    }
    for (size_t e = 0; e < grid->element_count; e++) {
      for (size_t n = 0; n < per; n++) {
        elements[first[grid->nodes[e * DEA_HEX_NODES_MAX + n] + 1]++] = (int)e;
      }
    }
    for (size_t i = 0; i < grid->node_count; i++) {
      counts[i] = 0;
      for (size_t k = first[i]; k < first[i + 1]; k++) {
        const int *nodes = grid->nodes + (size_t)elements[k] * DEA_HEX_NODES_MAX;
        for (size_t n = 0; n < per; n++) {
          if ((size_t)nodes[n] >= i && seen[nodes[n]] != (int)i + 1) {
            seen[nodes[n]] = (int)i + 1;
            counts[i]++;
          }
        }
      }
    }
  }
  bool done = first != NULL && elements != NULL && seen != NULL;
  dea_free(ctx, first);
  dea_free(ctx, elements);
  dea_free(ctx, seen);
  return done ? DEA_OK : DEA_E_MEMORY;
}

static dea_status create_matrix(struct dea_context *ctx, struct dea_solid *s)
{
  PetscInt *counts = dea_alloc(ctx, s->grid->node_count, sizeof *counts);
  if (counts == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = count_blocks(ctx, s, counts);
  if (status == DEA_OK) {
    status = dea_solid_petsc(ctx,
                             MatCreateSeqSBAIJ(PETSC_COMM_SELF, 3, (PetscInt)s->dofs,
                                               (PetscInt)s->dofs, 0, counts, &s->K),
                             "MatCreateSeqSBAIJ");
  }
  dea_free(ctx, counts);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSetOption(s->K, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE),
                               "MatSetOption"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatCreateVecs(s->K, &s->solution, &s->right), "MatCreateVecs"));
  return DEA_OK;
}

static dea_status fill(struct dea_context *ctx, struct dea_solid *s,
                       const struct dea_solid_options *options)
{
  const struct dea_grid *grid = s->grid;
  size_t elements = grid->element_count, pressures = (size_t)s->shape.pressures;
  s->layers = dea_alloc(ctx, options->layer_count, sizeof *s->layers);
  s->layer = dea_alloc(ctx, elements, sizeof *s->layer);
  s->active = dea_alloc(ctx, elements, sizeof *s->active);
  s->held = dea_alloc(ctx, s->dofs, 1);
  s->u = dea_alloc(ctx, s->dofs, sizeof(double));
  s->trial = dea_alloc(ctx, s->dofs, sizeof(double));
  s->g = dea_alloc(ctx, s->dofs, sizeof(double));
  s->step = dea_alloc(ctx, s->dofs, sizeof(double));
  s->metric = dea_alloc(ctx, s->dofs, sizeof(double));
  s->force = dea_alloc(ctx, s->dofs, sizeof(double));
  s->multiplier = dea_alloc(ctx, elements * pressures, sizeof(double));
  s->theta = dea_alloc(ctx, elements * pressures, sizeof(double));
  s->before = dea_alloc(ctx, s->dofs + elements * pressures, sizeof(double));
  s->element = dea_alloc(ctx, 1, sizeof *s->element);
  s->piece = dea_alloc(ctx, 1, sizeof *s->piece);
  if (s->layers == NULL || s->layer == NULL || s->active == NULL || s->held == NULL ||
      s->u == NULL || s->trial == NULL || s->g == NULL || s->step == NULL || s->metric == NULL ||
      s->force == NULL || s->multiplier == NULL || s->theta == NULL || s->before == NULL ||
      s->element == NULL || s->piece == NULL) {
    return DEA_E_MEMORY;
  }
  memcpy(s->layers, options->layers, options->layer_count * sizeof *s->layers);
  for (size_t e = 0; e < elements; e++) {
    s->layer[e] = options->layer_of(options->self, grid->region[e], grid->sheet[e]);
    s->active[e] = options->active(options->self, grid->region[e], grid->sheet[e]);
  }
  for (size_t n = 0; n < grid->node_count; n++) {
    int bits = options->held(options->self, grid->X + 3 * n);
    for (int i = 0; i < 3; i++) {
      s->held[3 * n + (size_t)i] = (bits >> i) & 1;
    }
  }
  DEA_TRY(ctx, dea_solid_frames_create(ctx, s, options));
  return create_matrix(ctx, s);
}

dea_status dea_solid_create(struct dea_context *ctx, const struct dea_grid *grid,
                            const struct dea_solid_options *options, struct dea_solid **out)
{
  *out = NULL;
  struct dea_solid *s = dea_alloc(ctx, 1, sizeof *s);
  if (s == NULL) {
    return DEA_E_MEMORY;
  }
  s->grid = grid;
  s->dofs = 3 * grid->node_count;
  dea_status status = dea_hex_shape_create(grid->order, options->order_z, &s->shape);
  if (status == DEA_OK) {
    status = fill(ctx, s, options);
  }
  if (status != DEA_OK) {
    dea_solid_destroy(ctx, s);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = s;
  return DEA_OK;
}

void dea_solid_destroy(struct dea_context *ctx, struct dea_solid *s)
{
  if (s == NULL) {
    return;
  }
  MatDestroy(&s->factor);
  MatDestroy(&s->K);
  VecDestroy(&s->right);
  VecDestroy(&s->solution);
  void *const memory[] = {s->layers, s->layer,   s->active,     s->held,  s->u,      s->trial,
                          s->g,      s->step,    s->multiplier, s->theta, s->metric, s->before,
                          s->force,  s->element, s->piece,      s->loads, s->frame,  s->frames};
  for (size_t i = 0; i < sizeof memory / sizeof memory[0]; i++) {
    dea_free(ctx, memory[i]);
  }
  dea_free(ctx, s);
}

double *dea_solid_displacement(struct dea_solid *solid)
{
  return solid->u;
}

double *dea_solid_force(struct dea_solid *solid)
{
  return solid->force;
}

dea_status dea_solid_add_load(struct dea_context *ctx, struct dea_solid *solid,
                              const struct dea_solid_load *load)
{
  struct dea_solid_load *loads =
      dea_resize(ctx, solid->loads, solid->load_count + 1, sizeof *loads);
  if (loads == NULL) {
    return DEA_E_MEMORY;
  }
  solid->loads = loads;
  loads[solid->load_count++] = *load;
  return DEA_OK;
}
