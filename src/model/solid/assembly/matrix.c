/* The matrix K of a solid: which rank has which rows and elements, and room for the entries. */
#include "model/solid/assembly/internal.h"

#include <string.h>

/* An element goes to the rank that has the row of a node in its middle, so that most of what it
 * adds to K stays there. */
static dea_status split_elements(struct dea_context *ctx, struct dea_solid *s)
{
  const struct dea_grid *grid = s->grid;
  s->own = dea_alloc(ctx, grid->element_count, sizeof *s->own);
  if (s->own == NULL) {
    return DEA_E_MEMORY;
  }
  s->own_count = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    size_t node =
        (size_t)grid
            ->nodes[e * DEA_HEX_NODES_MAX + (size_t)dea_grid_nodes_of(grid, e, s->shape.nodes) / 2];
    if (node >= s->first_node && node < s->end_node) {
      s->own[s->own_count++] = e;
    }
  }
  return DEA_OK;
}

/* Elements of each node: those of node i are elements[first[i]] to elements[first[i + 1] - 1].
 * first: [node_count + 2]. */
static void list_elements(const struct dea_solid *s, size_t *first, int *elements)
{
  const struct dea_grid *grid = s->grid;
  for (size_t e = 0; e < grid->element_count; e++) {
    for (size_t n = 0; n < (size_t)dea_grid_nodes_of(grid, e, s->shape.nodes); n++) {
      first[grid->nodes[e * DEA_HEX_NODES_MAX + n] + 2]++;
    }
  }
  for (size_t i = 2; i < grid->node_count + 2; i++) {
    first[i] += first[i - 1];
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    for (size_t n = 0; n < (size_t)dea_grid_nodes_of(grid, e, s->shape.nodes); n++) {
      elements[first[grid->nodes[e * DEA_HEX_NODES_MAX + n] + 1]++] = (int)e;
    }
  }
}

/* Upper block row lengths of own rows: neighbours of a node that are not before it, those whose
 * rows are own and those of later ranks. */
static dea_status count_blocks(struct dea_context *ctx, const struct dea_solid *s, PetscInt *own,
                               PetscInt *others)
{
  const struct dea_grid *grid = s->grid;
  size_t per = (size_t)s->shape.nodes;
  size_t *first = dea_alloc(ctx, grid->node_count + 2, sizeof *first);
  int *elements = dea_alloc(ctx, grid->element_count * per, sizeof *elements);
  int *seen = dea_alloc(ctx, grid->node_count, sizeof *seen);
  bool done = first != NULL && elements != NULL && seen != NULL;
  if (done) {
    list_elements(s, first, elements);
    for (size_t i = s->first_node; i < s->end_node; i++) {
      size_t row = i - s->first_node;
      own[row] = others[row] = 0;
      for (size_t k = first[i]; k < first[i + 1]; k++) {
        const int *nodes = grid->nodes + (size_t)elements[k] * DEA_HEX_NODES_MAX;
        int count = dea_grid_nodes_of(grid, (size_t)elements[k], s->shape.nodes);
        for (int n = 0; n < count; n++) {
          size_t column = (size_t)nodes[n];
          if (column >= i && seen[column] != (int)i + 1) {
            seen[column] = (int)i + 1;
            *(column < s->end_node ? &own[row] : &others[row]) += 1;
          }
        }
      }
    }
  }
  dea_free(ctx, first);
  dea_free(ctx, elements);
  dea_free(ctx, seen);
  return done ? DEA_OK : DEA_E_MEMORY;
}

static dea_status prepare(struct dea_context *ctx, struct dea_solid *s, PetscInt **own,
                          PetscInt **others)
{
  size_t rows = s->end_node - s->first_node;
  DEA_TRY(ctx, split_elements(ctx, s));
  s->predicted =
      dea_alloc(ctx, s->own_count * dea_hex_predicted_count(&s->shape), sizeof *s->predicted);
  *own = dea_alloc(ctx, rows, sizeof **own);
  *others = dea_alloc(ctx, rows, sizeof **others);
  return s->predicted != NULL && *own != NULL && *others != NULL
             ? count_blocks(ctx, s, *own, *others)
             : DEA_E_MEMORY;
}

dea_status dea_solid_create_matrix(struct dea_context *ctx, struct dea_solid *s, dea_status before)
{
  PetscInt *own = NULL, *others = NULL;
  PetscMPIInt rank, size;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  s->rank = rank;
  s->size = size;
  dea_solid_share(s, s->grid->node_count, &s->first_node, &s->end_node);
  dea_status status = before == DEA_OK ? prepare(ctx, s, &own, &others) : before;
  status = dea_solid_agree(ctx, s, status); // from here on all ranks have to take part
  if (status == DEA_OK) {
    PetscInt per = s->per_node, all = (PetscInt)s->dofs;
    PetscInt rows = per * (PetscInt)(s->end_node - s->first_node);
    status = dea_solid_petsc(
        ctx, MatCreateSBAIJ(PETSC_COMM_WORLD, per, rows, rows, all, all, 0, own, 0, others, &s->K),
        "MatCreateSBAIJ");
  }
  if (status == DEA_OK) {
    status = dea_solid_field_matrix(ctx, s, own, others);
  }
  dea_free(ctx, own);
  dea_free(ctx, others);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatSetOption(s->K, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE),
                               "MatSetOption"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatCreateVecs(s->K, &s->solution, &s->right), "MatCreateVecs"));
  return DEA_OK;
}

int dea_solid_places(const struct dea_solid *s, size_t e, double *X)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  int count = dea_grid_nodes_of(s->grid, e, s->shape.nodes);
  for (int n = 0; n < count; n++) {
    memcpy(X + 3 * n, s->grid->X + 3 * nodes[n], 3 * sizeof *X);
  }
  return count;
}

/* amount times a matrix of numbers between the nodes of an element, as a block of K without the
 * rows and columns of held components. */
static void block_of(const struct dea_solid *s, int count, const int *nodes, double amount,
                     const double *scalar, double *block)
{
  int per = s->per_node, dofs = per * count;
  memset(block, 0, (size_t)(dofs * dofs) * sizeof *block);
  for (int a = 0; a < count; a++) {
    for (int b = 0; b < count; b++) {
      for (int i = 0; i < 3; i++) {
        block[(per * a + i) * dofs + per * b + i] = amount * scalar[a * count + b];
      }
    }
  }
  dea_solid_frame_matrix(s, count, nodes, block);
  for (int i = 0; i < dofs; i++) {
    for (int j = 0; j < dofs && s->held[dea_solid_at(s, nodes[i / per], i % per)]; j++) {
      block[i * dofs + j] = block[j * dofs + i] = 0;
    }
  }
}

dea_status dea_solid_add_scalar(struct dea_context *ctx, struct dea_solid *s, Mat A, double amount,
                                dea_status (*of)(const struct dea_solid *s, size_t e,
                                                 double *scalar))
{
  dea_status status = DEA_OK;
  for (size_t k = 0; k < s->own_count && status == DEA_OK; k++) {
    double scalar[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
    PetscInt block[DEA_HEX_NODES_MAX];
    size_t e = s->own[k];
    const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
    int count = dea_grid_nodes_of(s->grid, e, s->shape.nodes);
    status = of(s, e, scalar);
    if (status == DEA_OK) {
      block_of(s, count, nodes, amount, scalar, s->element->K);
      for (int n = 0; n < count; n++) {
        block[n] = nodes[n];
      }
      status = dea_solid_petsc(
          ctx, MatSetValuesBlocked(A, count, block, count, block, s->element->K, ADD_VALUES),
          "MatSetValuesBlocked");
    }
  }
  status = dea_solid_agree(ctx, s, status);
  DEA_TRY(ctx, dea_solid_end_matrix(ctx, A));
  DEA_TRY(ctx, status);
  return DEA_OK;
}
