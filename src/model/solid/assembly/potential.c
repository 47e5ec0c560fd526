#include "model/solid/assembly/potential.h"

#include <math.h>
#include <string.h>

struct dea_solid_field {
  double scale_V_per_m; // c: a potential is c psi
  double permittivity;  // of the first dielectric part material
  double *share;        // [nodes] of the voltage, of held potentials
  double *right;        // [nodes]
  Mat L, factor;        // electric stiffness, held potentials taken out
  Vec charge, solution;
};

double dea_solid_field_scale(const struct dea_solid *s)
{
  return s->problem.field != NULL ? s->problem.field->scale_V_per_m : 0;
}

static bool has_potential(const struct dea_solid *s, size_t e)
{
  return dea_solid_element(s, e)->type->capacity != NULL;
}

/* c and permittivity of the first dielectric part material. */
static void set_scale(const struct dea_solid *s, size_t count, struct dea_solid_field *field)
{
  for (size_t i = 0; i < count && field->permittivity == 0; i++) {
    const struct dea_part_material *l = &s->problem.part_materials[i];
    if (l->permittivity_F_per_m > 0) {
      field->permittivity = l->permittivity_F_per_m;
      field->scale_V_per_m = sqrt(dea_part_material_modulus(l) / l->permittivity_F_per_m);
    }
  }
}

/* Held potentials: electrodes, and nodes without dielectric. */
static dea_status hold_potentials(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  size_t nodes = p->grid->node_count, electrodes = 0;
  unsigned char *held = p->held + 3 * nodes;
  memset(held, 1, nodes);
  for (size_t e = 0; e < p->grid->element_count; e++) {
    for (int n = 0; n < dea_solid_element(s, e)->nodes && has_potential(s, e); n++) {
      held[p->grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]] = 0;
    }
  }
  for (size_t n = 0; n < nodes; n++) {
    double share = 0;
    if (options->electrode != NULL && !held[n] &&
        options->electrode(options->self, p->grid->X + 3 * n, &share)) {
      held[n] = 1;
      p->field->share[n] = share;
      electrodes++;
    }
    p->free_potentials += !held[n];
  }
  return electrodes > 0 && p->field->scale_V_per_m > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT,
                        "a coupled field needs a part with permittivity and electrodes on it");
}

dea_status dea_solid_field_create(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  size_t nodes = p->grid->node_count;
  if (options->field == DEA_SOLID_FIELD_THIN) {
    return DEA_OK;
  }
  p->field = dea_arena_alloc(&s->memory, 1, sizeof *p->field);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  p->field->share = dea_arena_alloc(&s->memory, nodes, sizeof(double));
  p->field->right = dea_arena_alloc(&s->memory, nodes, sizeof(double));
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  set_scale(s, options->part_material_count, p->field);
  for (size_t i = 0; i < options->part_material_count; i++) {
    if (p->part_materials[i].permittivity_slope_F_per_m != 0) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "a coupled field needs a constant permittivity");
    }
  }
  return DEA_CHAIN(ctx, hold_potentials(ctx, s, options));
}

dea_status dea_solid_field_matrix(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_row_lengths *lengths)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_solid_field *field = p->field;
  PetscInt rows = (PetscInt)(p->end_node - p->first_node), all = (PetscInt)p->grid->node_count;
  if (field == NULL) {
    return DEA_OK;
  }
  DEA_PETSC(ctx, MatCreateSBAIJ(PETSC_COMM_WORLD, 1, rows, rows, all, all, 0, lengths->own, 0,
                                lengths->others, &field->L));
  DEA_PETSC(ctx, MatSetOption(field->L, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  DEA_PETSC(ctx, MatCreateVecs(field->L, &field->solution, &field->charge));
  return DEA_OK;
}

void dea_solid_field_destroy(struct dea_solid *s)
{
  struct dea_solid_field *field = s->problem.field;
  if (field != NULL) {
    MatDestroy(&field->factor);
    MatDestroy(&field->L);
    VecDestroy(&field->charge);
    VecDestroy(&field->solution);
  }
}

/* Adds an element to L and what its held potentials ask of the others to the right-hand side. */
static dea_status add_capacity(struct dea_context *ctx, struct dea_solid *s, size_t e,
                               const double *u, const double *psi)
{
  const struct dea_solid_problem *p = &s->problem;
  double X[DEA_HEX_DOFS_MAX] = {0}, at[DEA_HEX_DOFS_MAX] = {0}, *L = s->work.element->K;
  const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
  const unsigned char *held = p->held + 3 * p->grid->node_count;
  PetscInt rows[DEA_HEX_NODES_MAX];
  const struct dea_element *element = dea_solid_element(s, e);
  const struct dea_element_input in = {
      .part_material = dea_solid_part_material(s, e), .X = X, .u = at};
  int count = element->nodes;
  dea_solid_gather(s, e, p->grid->X, X);
  dea_solid_gather(s, e, u, at);
  for (int n = 0; n < count; n++) {
    rows[n] = nodes[n];
  }
  DEA_TRY_STATUS(element->type->capacity(element, &in, L));
  for (int a = 0; a < count; a++) {
    for (int b = 0; b < count && held[nodes[a]]; b++) {
      if (!held[nodes[b]]) {
        p->field->right[nodes[b]] -= L[a * count + b] * psi[nodes[a]];
      }
      L[a * count + b] = L[b * count + a] = a == b ? L[a * count + a] : 0;
    }
  }
  return dea_solid_petsc(ctx,
                         MatSetValuesBlocked(p->field->L, count, rows, count, rows, L, ADD_VALUES),
                         "MatSetValuesBlocked");
}

/* Keeps the rows of nodes without dielectric from being empty. */
static dea_status add_pins(struct dea_context *ctx, struct dea_solid *s, size_t e)
{
  const struct dea_solid_problem *p = &s->problem;
  const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
  const unsigned char *held = p->held + 3 * p->grid->node_count;
  const double *a = p->grid->X + 3 * nodes[0], *b = p->grid->X + 3 * nodes[1];
  double size = fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]);
  for (int n = 0; n < dea_solid_element(s, e)->nodes; n++) {
    if (held[nodes[n]]) {
      DEA_PETSC(ctx, MatSetValue(p->field->L, nodes[n], nodes[n], p->field->permittivity * size,
                                 ADD_VALUES));
    }
  }
  return DEA_OK;
}

/* L and, from the held potentials in psi, its right-hand side. */
static dea_status assemble_capacity(struct dea_context *ctx, struct dea_solid *s, const double *u,
                                    const double *psi)
{
  const struct dea_solid_problem *p = &s->problem;
  Mat L = p->field->L;
  dea_status status = DEA_OK;
  memset(p->field->right, 0, p->grid->node_count * sizeof(double));
  DEA_PETSC(ctx, MatZeroEntries(L));
  for (size_t k = 0; k < p->own_count && status == DEA_OK; k++) {
    size_t e = p->own[k];
    status = has_potential(s, e) ? add_capacity(ctx, s, e, u, psi) : add_pins(ctx, s, e);
  }
  status = dea_solid_allreduce(NULL, status);
  DEA_TRY(ctx, dea_solid_end_matrix(ctx, L));
  if (status != DEA_OK) {
    return status; // an inverted element: not worth a message in a line search
  }
  dea_solid_sum(p->field->right, p->grid->node_count);
  return DEA_OK;
}

/* field->right becomes L^-1 times itself. */
static dea_status solve_capacity(struct dea_context *ctx, struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_solid_field *field = p->field;
  size_t first = p->first_node, here = p->end_node - first;
  PetscScalar *values;
  DEA_PETSC(ctx, VecGetArray(field->charge, &values));
  memcpy(values, field->right + first, here * sizeof(double));
  DEA_PETSC(ctx, VecRestoreArray(field->charge, &values));
  DEA_TRY(ctx, dea_solid_factor(ctx, field->L, &field->factor));
  DEA_PETSC(ctx, MatSolve(field->factor, field->charge, field->solution));
  memset(field->right, 0, p->grid->node_count * sizeof(double));
  DEA_PETSC(ctx, VecGetArray(field->solution, &values));
  memcpy(field->right + first, values, here * sizeof(double));
  DEA_PETSC(ctx, VecRestoreArray(field->solution, &values));
  dea_solid_sum(field->right, p->grid->node_count);
  return DEA_OK;
}

void dea_solid_hold_potential(const struct dea_solid *s, double voltage_V, double *u)
{
  const struct dea_solid_problem *p = &s->problem;
  const size_t nodes = p->grid->node_count;
  for (size_t n = 0; n < nodes && p->field != NULL; n++) {
    if (p->held[3 * nodes + n]) {
      u[3 * nodes + n] = p->field->share[n] * voltage_V / p->field->scale_V_per_m;
    }
  }
}

dea_status dea_solid_solve_potential(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *u)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_solid_field *field = p->field;
  size_t nodes = p->grid->node_count;
  if (field == NULL) {
    return DEA_OK;
  }
  double *psi = u + 3 * nodes, c = field->scale_V_per_m;
  const double *force = s->state.force + 3 * nodes;
  const unsigned char *held = p->held + 3 * nodes;
  dea_solid_hold_potential(s, voltage_V, u);
  DEA_TRY_STATUS(assemble_capacity(ctx, s, u, psi));
  for (size_t n = 0; n < nodes; n++) {
    field->right[n] -= held[n] ? 0 : force[n] / (c * c);
  }
  DEA_TRY(ctx, solve_capacity(ctx, s));
  for (size_t n = 0; n < nodes; n++) {
    psi[n] = held[n] ? psi[n] : field->right[n];
  }
  return DEA_OK;
}

/* Whether free potentials go with the voltage. */
static bool is_without_charge(const struct dea_solid *s)
{
  const size_t nodes = s->problem.grid->node_count;
  const double *force = s->state.force + 3 * nodes;
  for (size_t n = 0; n < nodes; n++) {
    if (force[n] != 0) {
      return false;
    }
  }
  return true;
}

dea_status dea_solid_scale_potential(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *u)
{
  const struct dea_solid_problem *p = &s->problem;
  const size_t nodes = p->grid->node_count;
  if (p->field != NULL && (s->state.voltage_V == 0 || !is_without_charge(s))) {
    return DEA_CHAIN(ctx, dea_solid_solve_potential(ctx, s, voltage_V, u));
  }
  for (size_t i = 3 * nodes; i < p->dofs; i++) {
    u[i] = s->state.u[i] * voltage_V / s->state.voltage_V;
  }
  dea_solid_hold_potential(s, voltage_V, u);
  return DEA_OK;
}
