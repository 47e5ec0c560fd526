/* The exact states of the patch tests and of the orders of convergence, and one solve of them. */
#pragma once

#include "manufactured.h"

#include "model/solid/assembly/potential.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/element/hex.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/model3d/solid_state.h"

static struct dea_context *states_ctx;
static const double yeoh[DEA_LAW_PARAM_MAX] = {0.5, -0.02, 0.01};

/* ---- exact states ---- */

/* Bent, pulled and twisted; changes its volume. */
static inline void place_smooth(const number X[3], number x[3])
{
  x[0] = X[0] + 0.10 * csin(1.3 * X[0] + 0.4) * ccos(0.9 * X[1] + 0.5 * X[2]);
  x[1] = X[1] + 0.08 * ccos(1.1 * X[0] - 0.7 * X[1]) * X[2];
  x[2] = X[2] + 0.09 * csin(0.8 * X[0] + 1.2 * X[1] + 0.6 * X[2]);
}

/* Three shears one after the other, each without change of volume. */
static inline void place_isochoric(const number X[3], number x[3])
{
  x[0] = X[0] + 0.12 * csin(1.2 * X[1] + 0.7 * X[2]);
  x[1] = X[1] + 0.10 * ccos(1.1 * x[0] + 0.8 * X[2]);
  x[2] = X[2] + 0.11 * csin(0.9 * x[0] - 1.3 * x[1]);
}

/* Not larger: what it does to volume changes that the projection does not see falls with a higher
 * order and hides the one of the displacements on coarse meshes. */
static inline double pressure_smooth(const double X[3])
{
  return 0.1 * sin(1.5 * X[0] + 0.5) * cos(1.1 * X[1] - 0.6 * X[2]);
}

static inline number potential_smooth(const number X[3])
{
  return 0.4 * X[2] + 0.08 * csin(1.7 * X[0] + 0.3) * ccos(1.2 * X[1]) * csin(0.5 + 1.4 * X[2]);
}

/* For the patch tests. */
static inline void place_linear(const number X[3], number x[3])
{
  x[0] = 1.10 * X[0] + 0.05 * X[1];
  x[1] = -0.02 * X[0] + 0.95 * X[1] + 0.03 * X[2];
  x[2] = 0.04 * X[0] + 0.96 * X[2];
}

static inline void place_linear_isochoric(const number X[3], number x[3])
{
  x[0] = 1.25 * (X[0] + 0.1 * X[1]);
  x[1] = 0.8 * (X[1] + 0.2 * X[2]);
  x[2] = X[2] + 0.1 * X[0];
  x[2] += -0.1 * X[0] + 0.08 * x[1];
}

static inline double pressure_constant(const double X[3])
{
  (void)X;
  return 0.2;
}

static inline number potential_linear(const number X[3])
{
  return 0.4 * X[2] + 0.1 * X[0] - 0.05 * X[1];
}

/* Layers with a shear modulus of 1 and, with a field, a permittivity of 1. */
static inline struct dea_part_material layer_of(bool compressible, bool field)
{
  static const double mu_1[] = {2.6, 0.3}; // Lame constants 1 and 1.5
  struct dea_part_material layer = dea_part_material_bonded(mu_1);
  layer.thickness_m = 1;
  if (!compressible) {
    layer = (struct dea_part_material){.law = dea_law_find("yeoh"),
                                       .param = {yeoh[0], yeoh[1], yeoh[2]},
                                       .pre_stretch = {1, 1, 1},
                                       .kappa_Pa = 100,
                                       .thickness_m = 1};
  }
  layer.permittivity_F_per_m = field ? 1 : 0;
  verify_ok(states_ctx, dea_part_material_relax(&layer));
  return layer;
}

enum { STATES = 4 };

/* Linear ones for patch tests, smooth ones for orders. */
static inline void make_states(struct exact patches[STATES], struct exact states[STATES])
{
  const struct exact linear[STATES] = {
      {"compressible solid", place_linear, NULL, NULL, false, layer_of(true, false)},
      {"incompressible solid", place_linear_isochoric, pressure_constant, NULL, false,
       layer_of(false, false)},
      {"electrostatics in a deformed solid", place_linear, NULL, potential_linear, true,
       layer_of(true, true)},
      {"coupled, incompressible", place_linear_isochoric, pressure_constant, potential_linear,
       false, layer_of(false, true)}};
  const struct exact smooth[STATES] = {
      {"Compressible solid", place_smooth, NULL, NULL, false, layer_of(true, false)},
      {"Incompressible solid", place_isochoric, pressure_smooth, NULL, false,
       layer_of(false, false)},
      {"Electrostatics in a deformed solid", place_isochoric, NULL, potential_smooth, true,
       layer_of(true, true)},
      {"Coupled, incompressible", place_isochoric, pressure_smooth, potential_smooth, false,
       layer_of(false, true)}};
  memcpy(patches, linear, sizeof linear);
  memcpy(states, smooth, sizeof smooth);
}

/* ---- one solve ---- */

static inline int states_held(const void *self, const double X[3])
{
  const struct exact *exact = self;
  return exact->held_all || X[0] < 1e-9 || X[2] < 1e-9 ? 1 | 2 | 4 : 0;
}

/* phi is held at its exact value, with a voltage of 1. */
static inline bool states_electrode(const void *self, const double X[3], double *share)
{
  double gradient[3];
  *share = exact_potential(self, X, gradient);
  return X[2] < 1e-9 || X[2] > 1 - 1e-9;
}

/* Sources, and a start a little off the exact displacements where they are not held. */
static inline void load_exactly(const struct exact *exact, const struct dea_grid *grid,
                                struct dea_solid *solid)
{
  double *u = dea_solid_displacement(solid);
  const struct sources to = {dea_solid_force(solid), calloc(grid->node_count, sizeof(double))};
  if (to.q == NULL) {
    exit(1);
  }
  add_sources(exact, grid, &to);
  for (size_t n = 0; n < grid->node_count && solid->problem.field != NULL; n++) {
    solid->state.force_goal[3 * grid->node_count + n] = -dea_solid_field_scale(solid) * to.q[n];
  }
  free(to.q);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    double x[3], F[9];
    exact_place(exact, X, x, F);
    for (size_t i = 0; i < 3; i++) {
      double off =
          states_held(exact, X) != 0 ? 0 : 1e-3 * sin(5 * X[0] + 7 * X[1] + 3 * X[2] + (double)i);
      u[3 * n + i] = x[i] - X[i] + off;
    }
  }
}

/* Relative errors of the solution on a mesh, which is destroyed. */
static inline void solve(const struct exact *exact, struct dea_grid *grid, double error[NORMS])
{
  int order = grid->order;
  struct dea_solid *solid;
  struct dea_solid_report report;
  const struct dea_solid_options options = {
      .order_z = order,
      .field = exact->potential != NULL ? DEA_SOLID_FIELD_COUPLED : DEA_SOLID_FIELD_THIN,
      .part_material_count = 1,
      .part_materials = &exact->layer,
      .held = states_held,
      .electrode = states_electrode,
      .self = exact};
  verify_ok(states_ctx, dea_solid_create(states_ctx, grid, &options, &solid));
  load_exactly(exact, grid, solid);
  for (int i = 0; i < (exact->pressure != NULL ? 3 : 1); i++) { // multipliers beyond the tolerance
    verify_ok(states_ctx, dea_load_steps_solve(states_ctx, solid, 1, &report));
  }
  verify_absolute("unstable modes", report.unstable_modes, 0, 0);
  double *phi = calloc(grid->node_count, sizeof *phi);
  struct dea_state state = {0};
  struct dea_hex_shape shape;
  verify_ok(states_ctx, dea_solid_save(states_ctx, solid, &state));
  verify_ok(states_ctx, dea_hex_shape_create(order, order, &shape));
  if (phi == NULL) {
    exit(1);
  }
  for (size_t n = 0; n < grid->node_count && exact->potential != NULL; n++) {
    phi[n] = dea_solid_field_scale(solid) * solid->state.u[3 * grid->node_count + n];
  }
  size_t pressures = (size_t)shape.pressures, all = grid->element_count * pressures;
  size_t dofs = (exact->potential != NULL ? 4 : 3) * grid->node_count;
  const double *values = dea_state_find(&state, "state", dofs + all);
  const struct found found = {dea_solid_displacement(solid), exact->potential != NULL ? phi : NULL,
                              values + dofs, pressures};
  errors_of(exact, grid, &found, error);
  free(phi);
  dea_solid_destroy(states_ctx, solid);
  dea_grid_destroy(states_ctx, grid);
}

static const char *const norm_name[NORMS] = {"u, L2", "Grad u, L2", "phi, L2", "Grad phi, L2",
                                             "pressure, L2"};

static inline bool has(const struct exact *exact, enum norm norm)
{
  switch (norm) {
  case NORM_U:
  case NORM_GRAD_U:
    return !exact->held_all;
  case NORM_PHI:
  case NORM_GRAD_PHI:
    return exact->potential != NULL;
  default:
    return exact->pressure != NULL;
  }
}

static inline int theory_of(enum norm norm, int order)
{
  return norm == NORM_U || norm == NORM_PHI ? order + 1 : order;
}

/* The error on the finest mesh, and the order between the last two. */
struct converged {
  double error, order;
};

/* A table of all states up to an order, those that were not solved left out. */
static inline void print_orders(const struct exact states[STATES], size_t count, int orders,
                                struct converged found[STATES][3][NORMS])
{
  printf("| order | error |");
  for (size_t k = 0; k < count; k++) {
    printf(" %s |", states[k].name);
  }
  printf(" theory |\n|---|---|");
  for (size_t k = 0; k < count; k++) {
    printf("---|");
  }
  puts("---|");
  for (int order = 1; order <= orders; order++) {
    for (enum norm norm = 0; norm < NORMS; norm++) {
      bool any = false;
      for (size_t k = 0; k < count; k++) {
        any = any || has(&states[k], norm);
      }
      if (!any) {
        continue;
      }
      printf("| %d | %s |", order, norm_name[norm]);
      for (size_t k = 0; k < count; k++) {
        const struct converged *c = &found[k][order - 1][norm];
        has(&states[k], norm) ? printf(" %.2e (%.2f) |", c->error, c->order) : printf(" |");
      }
      printf(" %d |\n", theory_of(norm, order));
    }
  }
}
