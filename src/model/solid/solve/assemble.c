/* Energy, forces and tangent of the whole solid. */
#include "model/solid/solve/internal.h"

#include "material/plane.h"

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

/* What an element needs from the whole. */
struct element_place {
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
  const double *multiplier;
};

static void gather(const struct dea_solid *s, size_t e, const double *u, struct element_place *out)
{
  const int *nodes = s->grid->nodes + e * DEA_HEX_NODES_MAX;
  for (int n = 0; n < s->shape.nodes; n++) {
    memcpy(out->X + 3 * n, s->grid->X + 3 * nodes[n], 3 * sizeof(double));
    memcpy(out->u + 3 * n, u + 3 * nodes[n], 3 * sizeof(double));
  }
  out->multiplier = s->multiplier + e * (size_t)s->shape.pressures;
}

static dea_status evaluate_element(struct dea_solid *s, size_t e, const double *u, double voltage_V,
                                   bool want_tangent)
{
  struct element_place at;
  gather(s, e, u, &at);
  return dea_hex_evaluate(&s->shape, &s->layers[s->layer[e]], at.X, at.u, at.multiplier,
                          s->active[e] ? voltage_V : 0, want_tangent, s->element);
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

dea_status dea_solid_extremes(struct dea_solid *s, const struct dea_material *material,
                              double pre_stretch, struct dea_solid_extremes *out)
{
  *out = (struct dea_solid_extremes){0, INFINITY, INFINITY};
  for (size_t e = 0; e < s->grid->element_count; e++) {
    const struct dea_hex_layer *layer = &s->layers[s->layer[e]];
    struct element_place at;
    struct dea_hex_membrane membrane;
    if (layer->law == NULL) {
      continue;
    }
    double voltage_V = s->active[e] ? s->voltage_V : 0;
    gather(s, e, s->u, &at);
    dea_status status =
        dea_hex_membrane_eval(&s->shape, layer, at.X, at.u, at.multiplier, voltage_V, &membrane);
    if (status != DEA_OK) {
      return status;
    }
    for (int p = 0; p < membrane.count; p++) {
      double field = fabs(voltage_V) / layer->thickness_m * membrane.area[p];
      double stretch = pre_stretch * sqrt(membrane.area[p]);
      out->min_tension_N_per_m = fmin(out->min_tension_N_per_m, membrane.tension[p]);
      if (s->active[e]) {
        out->true_field_V_per_m = fmax(out->true_field_V_per_m, field);
        out->breakdown_margin =
            fmin(out->breakdown_margin, 1 - field / dea_breakdown_field(material, stretch));
      }
    }
  }
  if (isinf(out->breakdown_margin)) { // fmin passes over what is unknown
    out->breakdown_margin = NAN;
  }
  return DEA_OK;
}
