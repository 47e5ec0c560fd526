/* Blocks of neo-Hookean film between electrodes, in time; for programs of verification. */
#pragma once

#include "verify.h"

#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/motion/time.h"

static struct dea_context *ctx;

static const double pi = 3.14159265358979323846;
static const double mu[DEA_LAW_PARAM_MAX] = {1e5}, eps = 4.7 * DEA_EPSILON_0;

/* ---- bodies: a block of neo-Hookean film between electrodes ---- */

struct body {
  double size[3]; // stretched flat
  size_t count;   // elements along x; as many along y when it is square
  double pre_stretch;
  double density_kg_per_m3, radius; // density 0: without inertia
  int (*held)(const void *self, const double X[3]);
  struct dea_branches branches;
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct dea_solid_time *time;
};

static inline void map_body(const void *self, double s, double t, double x[2])
{
  const struct body *body = self;
  x[0] = body->size[0] * s;
  x[1] = body->size[1] * t;
}

static inline bool all_active(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  (void)ply;
  return true;
}

/* Dead loads on the sides of one element that hold its stretch: shares of a parabola's nodes. */
static inline void hang_weights(const struct body *body)
{
  double p = body->pre_stretch, traction = mu[0] * (p * p - pow(p, -4)); // true stress
  for (size_t n = 0; n < body->grid->node_count; n++) {
    const double *X = body->grid->X + 3 * n;
    for (int i = 0; i < 2; i++) {
      double along = X[1 - i] / body->size[1 - i], up = X[2] / body->size[2];
      double share = (fabs(along - 0.5) < 0.1 ? 4 : 1) * (fabs(up - 0.5) < 0.1 ? 4 : 1) / 36.;
      if (X[i] > body->size[i] * (1 - 1e-9)) {
        dea_solid_force(body->solid)[3 * n + (size_t)i] =
            share * traction * body->size[1 - i] * body->size[2];
      }
    }
  }
}

/* One element of film, free but for its planes of symmetry. */
static inline int on_planes(const void *self, const double X[3])
{
  double zero = 1e-9 * ((const struct body *)self)->size[0];
  return (X[0] < zero ? 1 : 0) | (X[1] < zero ? 2 : 0) | (X[2] < zero ? 4 : 0);
}

/* A strip in plane strain whose ends glide across the film. */
static inline int gliding_ends(const void *self, const double X[3])
{
  const struct body *body = self;
  double x = X[0] / body->size[0], z = X[2] / body->size[2];
  bool middle = fabs(x - 0.5) < 1e-9 && fabs(z - 0.5) < 1e-9;
  return (x < 1e-9 || x > 1 - 1e-9 ? 1 : 0) | 2 | (middle ? 4 : 0);
}

static inline int clamped(const void *self, const double X[3])
{
  const double *size = ((const struct body *)self)->size;
  bool inside = X[0] > 1e-9 && X[0] < size[0] - 1e-9 && X[1] > 1e-9 && X[1] < size[1] - 1e-9;
  return inside ? 0 : 7;
}

static inline void body_create(struct body *body)
{
  double cuts[33], one[2] = {0, 1}, p = body->pre_stretch;
  struct dea_part_material layer = {.law = dea_law_find("neo-hookean"),
                                    .param = {mu[0]},
                                    .pre_stretch = {p, p, 1 / (p * p)},
                                    .kappa_Pa = 100 * mu[0],
                                    .permittivity_F_per_m = eps,
                                    .thickness_m = body->size[2],
                                    .density_kg_per_m3 = body->density_kg_per_m3};
  struct dea_solid_report report;
  bool square = body->held == clamped;
  for (size_t i = 0; i <= body->count; i++) {
    cuts[i] = (double)i / (double)body->count;
  }
  verify_ok(ctx, dea_part_material_relax(&layer));
  const struct dea_block block = {
      map_body, body, cuts, square ? cuts : one, body->count, square ? body->count : 1, 0};
  const struct dea_ply ply = {body->size[2], 1, 2};
  verify_ok(ctx, dea_grid_create(ctx, 2, &block, 1, &ply, 1, NULL, 0, body->size[0], &body->grid));
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = all_active,
                                            .held = body->held,
                                            .self = body};
  const struct dea_solid_time_options steps = {&body->branches, body->density_kg_per_m3 > 0,
                                               body->radius, false};
  verify_ok(ctx, dea_solid_create(ctx, body->grid, &options, &body->solid));
  if (body->held == on_planes) {
    hang_weights(body);
  }
  verify_ok(ctx, dea_load_steps_solve(ctx, body->solid, 0, &report));
  verify_ok(ctx, dea_solid_time_create(ctx, body->solid, &steps, &body->time));
}

static inline void body_destroy(struct body *body)
{
  dea_solid_time_destroy(ctx, body->time);
  dea_solid_destroy(ctx, body->solid);
  dea_grid_destroy(ctx, body->grid);
}

static inline size_t farthest(const struct body *body)
{
  size_t best = 0;
  double most = -1;
  for (size_t n = 0; n < body->grid->node_count; n++) {
    double sum = body->grid->X[3 * n] + body->grid->X[3 * n + 1] + body->grid->X[3 * n + 2];
    best = sum > most ? n : best;
    most = fmax(most, sum);
  }
  return best;
}

static inline double strain_of(const struct body *body)
{
  return dea_solid_displacement(body->solid)[3 * farthest(body)] / body->size[0];
}

static inline dea_status step_to(struct body *body, double voltage_V, double step_s)
{
  struct dea_solid_report report;
  dea_status status = dea_solid_time_step(ctx, body->time, voltage_V, step_s, &report);
  if (status == DEA_OK) {
    status = dea_solid_time_close(ctx, body->time, NULL);
  }
  if (status == DEA_OK) {
    dea_solid_time_accept(body->time);
  }
  return status;
}

static inline void jump_to(struct body *body, double voltage_V)
{
  struct dea_solid_report report;
  verify_ok(ctx, dea_solid_time_jump(ctx, body->time, voltage_V, &report));
  verify_ok(ctx, dea_solid_time_close(ctx, body->time, NULL));
  dea_solid_time_accept(body->time);
}
