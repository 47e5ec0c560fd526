/* Energy, forces and tangent of the whole solid. */
#include "model/solid/solve/internal.h"

#include <math.h>
#include <string.h>

size_t dea_solid_pressure_count(const struct dea_solid *s)
{
  return s->grid->element_count * (size_t)s->shape.pressures;
}

double dea_solid_dot(const struct dea_solid *s, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < s->dofs; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

static dea_status evaluate_element(struct dea_solid *s, size_t e, const double *u, double voltage_V,
                                   bool want_tangent)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  double X[DEA_HEX_DOFS_MAX], local[DEA_HEX_DOFS_MAX];
  for (int n = 0; n < s->shape.nodes; n++) {
    memcpy(X + 3 * n, s->grid->X + 3 * nodes[n], 3 * sizeof(double));
    memcpy(local + 3 * n, u + 3 * nodes[n], 3 * sizeof(double));
  }
  const struct dea_hex_layer *layer = &s->layers[s->layer[e]];
  const double *multiplier = s->multiplier + e * (size_t)s->shape.pressures;
  return dea_hex_evaluate(&s->shape, layer, X, local, multiplier, s->active[e] ? voltage_V : 0,
                          want_tangent, s->element);
}

dea_status dea_solid_energy(struct dea_solid *s, const double *u, double voltage_V, double *energy)
{
  *energy = 0;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    dea_status status = evaluate_element(s, e, u, voltage_V, false);
    if (status != DEA_OK) {
      return status;
    }
    *energy += s->element->energy_J;
  }
  *energy -= dea_solid_dot(s, s->force, u);
  return DEA_OK;
}

/* Takes held components out of the element: their rows and columns are those of a spring. */
static void hold(const struct dea_solid *s, const int *nodes, struct dea_hex_result *element)
{
  int dofs = 3 * s->shape.nodes;
  for (int i = 0; i < dofs; i++) {
    if (s->held[3 * nodes[i / 3] + i % 3]) {
      double spring = fabs(element->K[i * dofs + i]);
      for (int j = 0; j < dofs; j++) {
        element->K[i * dofs + j] = element->K[j * dofs + i] = 0;
      }
      element->K[i * dofs + i] = spring;
      element->g[i] = 0;
    }
  }
}

/* Energy, g and K at u; also theta, the metric (diagonal of K in absolute value) and the force
 * scale. */
dea_status dea_solid_assemble(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                              double *energy)
{
  double squares = 0;
  int dofs = 3 * s->shape.nodes;
  PetscInt block[DEA_HEX_NODES_MAX];
  *energy = s->energy_scale = 0;
  memset(s->g, 0, s->dofs * sizeof(double));
  memset(s->metric, 0, s->dofs * sizeof(double));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatZeroEntries(s->K), "MatZeroEntries"));
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
    dea_status status = evaluate_element(s, e, s->u, voltage_V, true);
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "element %zu is inverted or beyond its law's domain", e);
    }
    *energy += s->element->energy_J;
    s->energy_scale += fabs(s->element->energy_J);
    memcpy(s->theta + e * (size_t)s->shape.pressures, s->element->theta,
           (size_t)s->shape.pressures * sizeof(double));
    for (int i = 0; i < dofs; i++) { // before it is held: the reaction is a force too
      squares += s->element->g[i] * s->element->g[i];
    }
    hold(s, nodes, s->element);
    for (int i = 0; i < dofs; i++) {
      s->g[3 * nodes[i / 3] + i % 3] += s->element->g[i];
      s->metric[3 * nodes[i / 3] + i % 3] += fabs(s->element->K[i * dofs + i]);
    }
    for (int n = 0; n < s->shape.nodes; n++) {
      block[n] = nodes[n];
    }
    PetscErrorCode code = MatSetValuesBlocked(s->K, s->shape.nodes, block, s->shape.nodes, block,
                                              s->element->K, ADD_VALUES);
    DEA_TRY(ctx, dea_solid_petsc(ctx, code, "MatSetValuesBlocked"));
  }
  *energy -= dea_solid_dot(s, s->force, s->u);
  for (size_t i = 0; i < s->dofs; i++) {
    s->g[i] -= s->held[i] ? 0 : s->force[i];
    squares += s->force[i] * s->force[i];
  }
  s->force_scale = sqrt(squares);
  DEA_TRY(ctx,
          dea_solid_petsc(ctx, MatAssemblyBegin(s->K, MAT_FINAL_ASSEMBLY), "MatAssemblyBegin"));
  DEA_TRY(ctx, dea_solid_petsc(ctx, MatAssemblyEnd(s->K, MAT_FINAL_ASSEMBLY), "MatAssemblyEnd"));
  return DEA_OK;
}
