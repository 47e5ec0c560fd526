/* Model "3d" behind the common interface: the actuator as a solid, on a sector or as a whole disc.
 * It is the whole of the loadable module that model/solid_module.c opens. */
#include "base/module.h"
#include "model/make.h"
#include "model/solid/actuator/actuator.h"
#include "model/solid/adapter/buckling_branch.h"
#include "model/solid/adapter/fields.h"
#include "model/solid/adapter/gradient.h"
#include "model/solid/adapter/indent.h"
#include "model/solid/adapter/motions.h"
#include "model/solid/adapter/solid_of_actuator.h"
#include "model/solid/adapter/standing.h"
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/film.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/recovery/line_profile.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double field_step_V_per_m = 10e6; // a longer way is gone in such steps of V/H0
enum { resolved = 6 }; // elements through the film from which a coupled field is (coupled.md)

struct dea_model {
  struct dea_standing at; // first (standing.h)
  const struct dea_device *device;
  struct dea_actuator actuator;
  struct dea_grid *grid;
  struct dea_solid *solid;
  size_t tip, centre, between; // nodes that are reported
  size_t centre_twin,
      between_twin;          // on the other side of the film's middle plane, or the same ones
  double *profile;           // what the last one lends from
  struct dea_indent *indent; // NULL: no probe
  struct dea_solid_film_data films[DEA_CONSTITUENT_COUNT];
  struct dea_branches branches[DEA_CONSTITUENT_COUNT];
  double leakage_per_s[DEA_CONSTITUENT_COUNT]; // of films, see circuit_step.h
  double *rest;                                // u and multipliers without voltage
  struct variant *variant;                     // a changed device is under the solid; NULL: its own
};

/* The node at the mirror image of another one by the middle plane. */
static size_t twin_of(const struct dea_grid *grid, size_t node)
{
  const double *X = grid->X + 3 * node;
  const double mirrored[3] = {X[0], X[1], -X[2]};
  return dea_grid_nearest(grid, mirrored);
}

/* Nodes that are reported. The tip is where film and fibre meet. Elements of odd order have no
 * nodes in the middle plane: there two of them stand for the one between. */
static void find_nodes(struct dea_model *model)
{
  const struct dea_fibre_disc *p = &model->actuator.plate;
  double a = p->electrode_radius, half = dea_fibre_disc_angle(p) / p->sectors;
  const double centre[3] = {0}, between[3] = {a * cos(half), a * sin(half), 0};
  const double tip[3] = {p->tip_radius, 0, 0.5 * p->film_thickness};
  model->centre = dea_grid_nearest(model->grid, centre);
  model->between = dea_grid_nearest(model->grid, between);
  model->centre_twin = twin_of(model->grid, model->centre);
  model->between_twin = twin_of(model->grid, model->between);
  model->tip = dea_grid_nearest(model->grid, tip);
}

/* What of a coupled field the mesh does not resolve. */
static dea_status say_coupled(struct dea_context *ctx, const struct dea_fibre_disc *p)
{
  if (p->through < resolved) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: %d element%s through the film do%s not resolve the coupled field at "
        "the electrode's edge: capacitance comes out too large (by 0.8 %% with one), "
        "and what a fibre tip there loses against V/h is not to be trusted, not even "
        "in its sign; compute.solid.elements_z: %d resolves it "
        "(docs/theory/coupled.md)",
        p->through, p->through > 1 ? "s" : "", p->through > 1 ? "" : "es", resolved);
  }
  if (p->fibres > 0 && fabs(p->electrode_radius - p->tip_radius) < p->film_thickness) {
    return dea_finding_add(
        ctx, DEA_WARNING, (struct dea_location){0},
        "model 3d: the fibres begin where the electrode ends: there the coupled field's part in "
        "their lift converges with the root of the element's size only, so that %d elements "
        "through the film show about half of it at small voltage, and at larger ones no limit is "
        "known; capacitance and what is not at that edge are resolved (docs/theory/coupled.md)",
        p->through);
  }
  return DEA_OK;
}

/* What is about to be solved, and what it cannot show. */
static dea_status say_mesh(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_fibre_disc *p = &model->actuator.plate;
  bool whole = p->sectors == dea_fibre_disc_sectors(p);
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                               "model 3d: %zu elements, %zu unknowns, %s",
                               model->grid->element_count, 3 * model->grid->node_count,
                               whole ? "the whole disc"
                                     : "one sector of the actuator; it is blind to motions that "
                                       "break its symmetry (compute.solid.domain: disc)"));
  if (model->actuator.settings.field == DEA_FIELD_COUPLED) {
    DEA_TRY(ctx, say_coupled(ctx, p));
  }
  if (p->membrane) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d with a membrane film is a preview: %s"
                                 "it has no bending of the film and no shape of its wrinkles "
                                 "(compute.solid.film: solid)",
                                 p->fibres > 0 ? "10 to 20 % off the solid film at the fibre tip; "
                                               : ""));
  }
  if (p->membrane && model->device->pre_stretch <= 1) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                 "a membrane film without pre-stretch is slack under any voltage: "
                                 "nothing will move, where a solid film buckles "
                                 "(compute.solid.film: solid)"));
  }
  return DEA_OK;
}

/* The weight of all parts on the nodes. */
static dea_status find_weight(struct dea_context *ctx, const struct dea_model *model, double *out)
{
  enum dea_gravity gravity = model->device->gravity;
  double *fall = dea_solid_alloc(ctx, 3 * model->grid->node_count, sizeof *fall);
  if (fall == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t n = 0; n < model->grid->node_count; n++) {
    fall[3 * n + 2] = (gravity == DEA_GRAVITY_FIBRES_UP ? -1 : 1) * DEA_STANDARD_GRAVITY_M_PER_S2;
  }
  dea_status status = dea_solid_mass_apply(ctx, model->solid, fall, out);
  dea_free(ctx, fall);
  return status;
}

/* Puts it among the loads of every solve: also that at 0 V. */
static dea_status add_weight(struct dea_context *ctx, const struct dea_model *model)
{
  if (model->device->gravity == DEA_GRAVITY_OFF) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_actuator_check_mass(ctx, &model->actuator));
  DEA_TRY(ctx, find_weight(ctx, model, dea_solid_force(model->solid)));
  return DEA_OK;
}

/* Where the weight alone brings the film. */
static dea_status say_sag(struct dea_context *ctx, const struct dea_model *model)
{
  if (model->device->gravity != DEA_GRAVITY_OFF) {
    const double *u = dea_solid_displacement(model->solid);
    DEA_TRY(ctx, dea_finding_add(
                     ctx, DEA_NOTE, (struct dea_location){0},
                     "model 3d: with its weight the centre is at z = %.4g um without voltage, "
                     "where the sweep starts (gravity: fibres_%s)",
                     1e6 * 0.5 * (u[3 * model->centre + 2] + u[3 * model->centre_twin + 2]),
                     model->device->gravity == DEA_GRAVITY_FIBRES_UP ? "up" : "down"));
  }
  return DEA_OK;
}

/* A mesh of its own, or another one's moved to it. */
static dea_status make_grid(struct dea_context *ctx, const struct dea_actuator *actuator,
                            struct dea_grid **out)
{
  struct dea_fibre_disc like = actuator->plate;
  if (actuator->settings.mesh_of != NULL) {
    DEA_TRY(ctx,
            dea_fibre_disc_of_device(ctx, actuator->settings.mesh_of, &actuator->settings, &like));
  }
  DEA_TRY(ctx, dea_fibre_disc_create_like(ctx, &actuator->plate, &like, out));
  return DEA_OK;
}

static dea_status keep_rest(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_solid *s = model->solid;
  size_t dofs = s->problem.dofs, pressures = dea_solid_pressure_count(s);
  model->rest = dea_solid_alloc(ctx, dofs + pressures, sizeof *model->rest);
  if (model->rest == NULL) {
    return DEA_E_MEMORY;
  }
  memcpy(model->rest, s->state.u, dofs * sizeof *model->rest);
  memcpy(model->rest + dofs, s->state.multiplier, pressures * sizeof *model->rest);
  model->at.rest_energy_J = model->at.report.energy_J;
  model->at.as_made = !model->at.report.snapped;
  return DEA_OK;
}

static void set_films(struct dea_model *model)
{
  model->films[DEA_CONSTITUENT_FILM] =
      (struct dea_solid_film_data){&model->device->film, model->device->pre_stretch};
}

/* The rest in steps of the electrodes' pre-stretch: from where they have no stress and the flat
 * film is it, halved where one fails (docs/theory/stops.md). The solid is at the last one found,
 * *found of them. */
static dea_status ease_rest(struct dea_context *ctx, struct dea_model *model, double *found)
{
  static const double least = 1.0 / 256;
  struct dea_solid *s = model->solid;
  const struct dea_constituent *own = s->problem.constituents;
  double share = 0, part = 0.125;
  dea_status status = DEA_OK;
  s->problem.constituents = model->actuator.constituents;
  while (share < 1) {
    double next = fmin(share + part, 1);
    status = dea_actuator_lay_electrodes(&model->actuator, next);
    dea_solid_forget(s);
    if (status == DEA_OK) {
      status = dea_load_steps_solve(ctx, s, 0, &model->at.report);
    }
    if (status == DEA_OK) {
      share = next;
      part *= 2;
    } else {
      part /= 2;
      if (!dea_solid_may_shorten(status) || part < least) {
        break;
      }
      dea_context_clear(ctx);
    }
  }
  s->problem.constituents = own;
  *found = share;
  return status;
}

/* Equilibrium without voltage. Electrodes that were laid on the unstretched film draw it together,
 * to a third where they are stiff, which is farther than Newton's method goes at once. */
static dea_status find_rest(struct dea_context *ctx, struct dea_model *model)
{
  double share = 0;
  char why[160], far[80] = "";
  dea_status status = dea_load_steps_solve(ctx, model->solid, 0, &model->at.report);
  if (dea_solid_may_shorten(status) && model->actuator.plate.electrode_thickness > 0) {
    dea_context_clear(ctx);
    status = ease_rest(ctx, model, &share);
    snprintf(far, sizeof far, "; with %.3g %% of its electrodes' pre-stretch it is", 100 * share);
  }
  if (status == DEA_E_NOT_CONVERGED) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the solver did not converge: the film at rest is not found (%s)%s; please "
                    "report the design",
                    why, far);
  }
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

static dea_status prepare(struct dea_context *ctx, const struct dea_device *device,
                          const struct dea_model_settings *settings, struct dea_model *model)
{
  model->device = device;
  DEA_TRY(ctx, dea_actuator_create(ctx, device, settings, &model->actuator));
  DEA_TRY(ctx, make_grid(ctx, &model->actuator, &model->grid));
  DEA_TRY(ctx, say_mesh(ctx, model));
  DEA_TRY(ctx, dea_solid_start(ctx));
  DEA_TRY(ctx, dea_solid_of_actuator(ctx, &model->actuator, model->grid, &model->solid));
  find_nodes(model);
  DEA_TRY(ctx, add_weight(ctx, model));
  DEA_TRY(ctx, find_rest(ctx, model));
  DEA_TRY(ctx, keep_rest(ctx, model));
  set_films(model);
  dea_branches_of_device(device, model->branches);
  model->leakage_per_s[DEA_CONSTITUENT_FILM] =
      dea_leakage_per_s(&device->film, &model->actuator.constituents[DEA_CONSTITUENT_FILM]);
  DEA_TRY(ctx, say_sag(ctx, model));
  return DEA_OK;
}

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_standing_free(ctx, &model->at);
    dea_solid_destroy(ctx, model->solid);
    dea_indent_destroy(ctx, model->indent);
    dea_grid_destroy(ctx, model->grid);
    dea_free(ctx, model->profile);
    dea_free(ctx, model->rest);
    dea_free(ctx, model);
  }
}

/* Largest and smallest displacement out of the plane among the film's nodes. */
static void find_heights(const struct dea_model *model, const double *u, struct dea_load_point *out)
{
  double face = 0.5 * model->actuator.plate.film_thickness * (1 + 1e-9);
  out->highest_z_m = -INFINITY;
  out->lowest_z_m = INFINITY;
  for (size_t n = 0; n < model->grid->node_count; n++) {
    if (fabs(model->grid->X[3 * n + 2]) <= face) {
      out->highest_z_m = fmax(out->highest_z_m, u[3 * n + 2]);
      out->lowest_z_m = fmin(out->lowest_z_m, u[3 * n + 2]);
    }
  }
}

/* Reported displacements as sums of weights times u; weights [dofs] are 0 before. */
static void weigh_tip(const struct dea_model *model, double *weight)
{
  weight[3 * model->tip + 2] = 1;
}

static void weigh_centre(const struct dea_model *model, double *weight)
{
  weight[3 * model->centre + 2] += 0.5;
  weight[3 * model->centre_twin + 2] += 0.5;
}

static void weigh_edge(const struct dea_model *model, double *weight)
{
  const double *X = model->grid->X + 3 * model->between;
  const size_t two[2] = {model->between, model->between_twin};
  for (int i = 0; i < 2; i++) {
    weight[3 * two[i]] += 0.5 * X[0] / hypot(X[0], X[1]);
    weight[3 * two[i] + 1] += 0.5 * X[1] / hypot(X[0], X[1]);
  }
}

/* Estimated errors of the reported displacements, where the state is one of which they say
 * something. */
static dea_status report_errors(struct dea_context *ctx, struct dea_model *model,
                                struct dea_load_point *out)
{
  enum { CENTRE, TIP, EDGE, COUNT };
  size_t dofs = model->solid->problem.dofs;
  double error_m[COUNT], *weights;
  const double *each[COUNT];
  if (!dea_load_point_trusted(out) || out->voltage_V == 0) {
    return DEA_OK;
  }
  weights = dea_solid_alloc(ctx, COUNT * dofs, sizeof *weights);
  if (weights == NULL) {
    return DEA_E_MEMORY;
  }
  for (int k = 0; k < COUNT; k++) {
    each[k] = weights + (size_t)k * dofs;
  }
  weigh_tip(model, weights + TIP * dofs);
  weigh_centre(model, weights + CENTRE * dofs);
  weigh_edge(model, weights + EDGE * dofs);
  dea_status status = dea_solid_errors(ctx, model->solid, each, COUNT, error_m, NULL);
  dea_free(ctx, weights);
  if (status == DEA_OK) {
    out->centre_z_error_m = error_m[CENTRE];
    out->fibre_tip_z_error_m = model->device->fibre_count > 0 ? error_m[TIP] : NAN;
    out->electrode_edge_u_error_m = error_m[EDGE];
  }
  return status;
}

/* What of a point the displacements say by themselves. */
static void describe(const struct dea_model *model, double voltage_V, struct dea_load_point *out)
{
  const struct dea_device *d = model->device;
  const double *u = dea_solid_displacement(model->solid);
  const double *X = model->grid->X + 3 * model->between;
  const double *v = u + 3 * model->between, *w = u + 3 * model->between_twin;
  double outwards = 0.5 * ((v[0] + w[0]) * X[0] + (v[1] + w[1]) * X[1]) / hypot(X[0], X[1]);
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->electrode_stretch = 1 + outwards / d->electrode_radius_m;
  out->electrode_edge_u_m = outwards;
  out->centre_z_m = 0.5 * (u[3 * model->centre + 2] + u[3 * model->centre_twin + 2]);
  out->fibre_tip_z_m = d->fibre_count > 0 ? u[3 * model->tip + 2] : NAN;
  find_heights(model, u, out);
  out->nominal_field_V_per_m = voltage_V / d->film_thickness_unstretched_m;
  out->energy_J =
      dea_actuator_copies(&model->actuator) * (model->at.report.energy_J - model->at.rest_energy_J);
}

static void describe_tip(const struct dea_model *model, struct dea_load_point *out)
{
  if (model->indent != NULL) {
    out->tip_depth_m = model->indent->depth_m;
    out->force_N = dea_indent_force(model->indent, dea_solid_displacement(model->solid));
  }
}

static dea_status report(struct dea_context *ctx, void *self, double voltage_V,
                         struct dea_load_point *out)
{
  struct dea_model *model = self;
  struct dea_solid_extremes extremes;
  double capacitance_F, copies = dea_actuator_copies(&model->actuator);
  dea_status status = dea_solid_extremes(model->solid, model->films, &extremes);
  if (status == DEA_OK) {
    status = dea_solid_capacitance(ctx, model->solid, &capacitance_F);
  }
  if (status != DEA_OK) {
    return dea_fail(ctx, status, "the film cannot be evaluated at %g V", voltage_V);
  }
  describe(model, voltage_V, out);
  out->true_field_V_per_m = extremes.true_field_V_per_m;
  out->breakdown_margin = extremes.breakdown_margin;
  out->breakdown_probability = extremes.breakdown_probability;
  out->min_tension_N_per_m =
      isinf(extremes.min_tension_N_per_m) ? NAN : extremes.min_tension_N_per_m;
  out->locking_share = extremes.reach.locking_share;
  out->range_share = extremes.reach.range_share;
  out->compression_ratio = copies * extremes.compression_ratio;
  out->told |= (unsigned)model->at.left_a_state << DEA_FLAG_STATES;
  out->told |= (unsigned)model->actuator.plate.membrane << DEA_FLAG_PREVIEW;
  out->capacitance_F = copies * capacitance_F;
  describe_tip(model, out);
  out->unstable_modes = model->at.report.unstable_modes;
  out->stable = out->unstable_modes == 0;
  DEA_TRY(ctx, report_errors(ctx, model, out));
  return DEA_OK;
}

/* ---- on the way to a voltage ---- */

/* To the side that the design asks for, where there is a state. */
static dea_status take_side(struct dea_context *ctx, struct dea_model *model)
{
  bool moved;
  double before_m = dea_solid_displacement(model->solid)[3 * model->centre + 2];
  if (model->indent != NULL || model->at.voltage_V == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_buckling_branch_take(ctx, model->solid, model->grid, &model->actuator.plate,
                                        model->actuator.settings.buckling_branch, &model->at.report,
                                        &moved));
  if (moved) {
    model->at.left_a_state = true;
    double after_m = dea_solid_displacement(model->solid)[3 * model->centre + 2];
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: at %.4g kV the centre goes over from %.4g to %.4g um "
                                 "(compute.solid.buckling_branch)",
                                 1e-3 * model->at.voltage_V, 1e6 * before_m, 1e6 * after_m));
  }
  return DEA_OK;
}

static dea_status arrived(struct dea_context *ctx, void *self, double voltage_V)
{
  struct dea_model *model = self;
  model->at.voltage_V = voltage_V;
  model->at.left_a_state = voltage_V > 0 && (model->at.left_a_state || model->at.report.snapped ||
                                             model->at.ending.leapt);
  DEA_TRY(ctx, take_side(ctx, model));
  return DEA_OK;
}

/* ---- slopes (docs/theory/gradients.md) ---- */

/* What a changed device takes the place of. */
struct variant {
  struct dea_model own; // as it was
  struct dea_grid *grid;
  double *force; // [2][dofs] dead loads as they were, and those of the changed device
  const struct dea_constituent *constituents; // as they were
  struct dea_gradient_places places;
  const struct dea_gradient_ask *ask;
  struct dea_indent *indent; // of the changed device; NULL: none
};

/* The film's node that is highest, sign 1, or lowest, -1. */
static void weigh_height(const struct dea_model *model, double sign, double *weight)
{
  double face = 0.5 * model->actuator.plate.film_thickness * (1 + 1e-9), best = -INFINITY;
  const double *u = dea_solid_displacement(model->solid);
  size_t at = 0;
  for (size_t n = 0; n < model->grid->node_count; n++) {
    if (fabs(model->grid->X[3 * n + 2]) <= face && sign * u[3 * n + 2] > best) {
      best = sign * u[3 * n + 2];
      at = n;
    }
  }
  weight[3 * at + 2] = 1;
}

static struct dea_gradient_film film_of(const struct dea_model *model)
{
  return (struct dea_gradient_film){.solid = model->solid,
                                    .films = model->films,
                                    .copies = dea_actuator_copies(&model->actuator)};
}

static dea_status slope(struct dea_context *ctx, void *self, int column, double *out,
                        double *pressures, bool *known)
{
  struct dea_model *model = self;
  const char *key = dea_point_columns[column].key;
  const struct dea_gradient_film film = film_of(model);
  *known = true;
  if (strcmp(key, "centre_z_m") == 0) {
    weigh_centre(model, out);
  } else if (strcmp(key, "fibre_tip_z_m") == 0) {
    weigh_tip(model, out);
  } else if (strcmp(key, "electrode_edge_u_m") == 0) {
    weigh_edge(model, out);
  } else if (strcmp(key, "electrode_stretch") == 0) {
    weigh_edge(model, out);
    for (size_t i = 0; i < model->solid->problem.dofs; i++) {
      out[i] /= model->device->electrode_radius_m;
    }
  } else if (strcmp(key, "highest_z_m") == 0 || strcmp(key, "lowest_z_m") == 0) {
    weigh_height(model, strcmp(key, "highest_z_m") == 0 ? 1 : -1, out);
  } else if (strcmp(key, "force_N") == 0 && model->indent != NULL) { // the only load
    dea_indent_force_slope(model->indent, dea_solid_displacement(model->solid), out,
                           pressures + dea_solid_pressure_count(model->solid));
  } else if (strcmp(key, "tip_depth_m") == 0) { // of no unknown
    *known = model->indent != NULL;
  } else {
    DEA_TRY(ctx, dea_gradient_film_slope(ctx, &film, &model->variant->places, column, out,
                                         pressures, known));
  }
  return DEA_OK;
}

static dea_status variant_point(struct dea_context *ctx, void *self, double voltage_V,
                                double energy_J, struct dea_load_point *out)
{
  struct dea_model *model = self;
  const struct variant *v = model->variant;
  const struct dea_gradient_film film = film_of(model);
  struct dea_solid *s = model->solid;
  const size_t loads = s->problem.load_count;
  model->at.report.energy_J = energy_J;
  s->problem.load_count = 0; // the tip: it is not there at rest
  dea_status status = dea_gradient_rest_energy(
      s, v->ask, model->rest, model->rest + s->problem.dofs, &model->at.rest_energy_J);
  s->problem.load_count = loads;
  describe(model, voltage_V, out);
  describe_tip(model, out);
  if (status == DEA_OK) {
    status = dea_gradient_film_at(ctx, &film, &v->places, v->ask, voltage_V, out);
  }
  return status == DEA_OK
             ? DEA_OK
             : dea_fail(ctx, status, "a changed device cannot be evaluated at %g V", voltage_V);
}

static bool same_mesh(const struct dea_grid *a, const struct dea_grid *b)
{
  return a->node_count == b->node_count && a->element_count == b->element_count &&
         memcmp(a->nodes, b->nodes, a->element_count * DEA_HEX_NODES_MAX * sizeof *a->nodes) == 0;
}

/* The weight of the changed device in place of the other. */
static dea_status change_weight(struct dea_context *ctx, struct dea_model *model)
{
  struct dea_solid *s = model->solid;
  size_t dofs = s->problem.dofs;
  if (model->device->gravity == DEA_GRAVITY_OFF) {
    return DEA_OK;
  }
  DEA_TRY(ctx, find_weight(ctx, model, model->variant->force + dofs));
  memcpy(s->state.force, model->variant->force + dofs, dofs * sizeof *s->state.force);
  return DEA_OK;
}

/* A tip that is pressed in holds what it touches, on the device that is there now. */
static dea_status enter_tip(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_pressed *pressed)
{
  struct variant *v = model->variant;
  const struct dea_pressed own = {model->indent->probe, model->indent->depth_m};
  DEA_TRY(ctx,
          dea_indent_create_variant(ctx, &model->actuator, model->grid, model->solid,
                                    pressed != NULL ? pressed : &own, v->own.indent, &v->indent));
  model->indent = v->indent;
  return DEA_OK;
}

/* Mesh and constituents of a changed device. */
static dea_status enter_device(struct dea_context *ctx, struct dea_model *model,
                               const struct dea_device *device)
{
  struct variant *v = model->variant;
  struct dea_model_settings settings = v->own.actuator.settings;
  settings.mesh_of = settings.mesh_of != NULL ? settings.mesh_of : v->own.device;
  model->device = device;
  DEA_TRY(ctx, dea_actuator_create(ctx, device, &settings, &model->actuator));
  DEA_TRY(ctx, make_grid(ctx, &model->actuator, &v->grid));
  if (!same_mesh(v->grid, v->own.grid)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow the change");
  }
  model->grid = v->grid;
  model->solid->problem.grid = v->grid;
  model->solid->problem.constituents = model->actuator.constituents;
  set_films(model);
  DEA_TRY(ctx, change_weight(ctx, model));
  return DEA_OK;
}

static dea_status enter(struct dea_context *ctx, void *self, const struct dea_design_change *change,
                        int side)
{
  struct dea_model *model = self;
  struct variant *v = model->variant;
  if (change->device[side] != v->own.device) {
    DEA_TRY(ctx, enter_device(ctx, model, change->device[side]));
  }
  if (model->indent != NULL) {
    DEA_TRY(ctx, enter_tip(ctx, model, change->pressed[side]));
  }
  return DEA_OK;
}

static void leave(struct dea_context *ctx, void *self)
{
  struct dea_model *model = self;
  struct variant *v = model->variant;
  struct dea_solid *s = model->solid;
  dea_indent_end_variant(ctx, s, v->own.indent, v->indent);
  v->indent = NULL;
  dea_grid_destroy(ctx, v->grid);
  v->grid = NULL;
  *model = v->own;
  s->problem.grid = model->grid;
  s->problem.constituents = v->constituents;
  memcpy(s->state.force, v->force, s->problem.dofs * sizeof *s->state.force);
}

static dea_status hold(struct dea_context *ctx, void *self)
{
  return enter_tip(ctx, self, NULL);
}

static dea_status find_gradient(struct dea_context *ctx, struct dea_model *model,
                                const struct dea_gradient_ask *ask, double *out)
{
  struct variant *v = model->variant;
  struct dea_solid *s = model->solid;
  const struct dea_gradient_owner owner = {.solid = s,
                                           .ending = &model->at.ending,
                                           .model = model,
                                           .voltage_V = model->at.voltage_V,
                                           .slope = slope,
                                           .enter = enter,
                                           .hold = model->indent != NULL ? hold : NULL,
                                           .leave = leave,
                                           .point = variant_point};
  const struct dea_gradient_film film = film_of(model);
  dea_gradient_places_find(&film, &v->places);
  memcpy(v->force, s->state.force, s->problem.dofs * sizeof *v->force);
  v->constituents = s->problem.constituents;
  v->ask = ask;
  v->own = *model;
  DEA_TRY(ctx, dea_gradient_find(ctx, &owner, ask, out));
  return DEA_OK;
}

static dea_status gradient(struct dea_context *ctx, struct dea_model *model,
                           const struct dea_gradient_ask *ask, double *out)
{
  struct dea_arena memory = {.ctx = ctx};
  dea_standing_end_history(ctx, &model->at);
  if (dea_gradient_asks_mode(ask)) {
    DEA_TRY(ctx, dea_actuator_check_mass(ctx, &model->actuator));
  }
  model->variant = dea_arena_alloc(&memory, 1, sizeof *model->variant);
  double *force = dea_arena_alloc(&memory, 2 * model->solid->problem.dofs, sizeof *force);
  dea_status status = dea_solid_agree(ctx, dea_arena_status(&memory));
  if (status == DEA_OK) {
    model->variant->force = force;
    status = find_gradient(ctx, model, ask, out);
  }
  model->variant = NULL;
  dea_arena_free(&memory);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

/* ---- in time ---- */

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *time, struct dea_load_point *out)
{
  const struct dea_driven_solid driven = {.solid = model->solid,
                                          .branches = model->branches,
                                          .leakage_per_s = model->leakage_per_s,
                                          .copies = dea_actuator_copies(&model->actuator),
                                          .thickness_m = model->device->film_thickness_m};
  if (time->inertia) {
    DEA_TRY(ctx, dea_actuator_check_mass(ctx, &model->actuator));
  }
  DEA_TRY(ctx, dea_standing_begin(ctx, &model->at, &driven, time, out));
  return DEA_OK;
}

/* ---- equilibria ---- */

static dea_status indent(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_probe *probe, double depth_m, struct dea_load_point *out)
{
  dea_standing_end_history(ctx, &model->at);
  if (model->indent == NULL) {
    DEA_TRY(ctx, dea_indent_create(ctx, &model->actuator, model->grid, model->solid, probe,
                                   &model->indent));
  }
  dea_status status = dea_indent_move(ctx, model->indent, model->solid, model->at.voltage_V,
                                      depth_m, &model->at.report);
  if (status != DEA_OK) {
    char why[200];
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the probe stopped at a depth of %.4g mm on its way to %.4g mm (%s)",
                    1e3 * model->indent->depth_m, 1e3 * depth_m, why);
  }
  DEA_TRY(ctx, report(ctx, model, model->at.voltage_V, out));
  return DEA_OK;
}

/* What small motions are of; notes say what they leave out. */
static dea_status find_motions(struct dea_context *ctx, const struct dea_model *model,
                               struct dea_motions *out)
{
  const struct dea_fibre_disc *p = &model->actuator.plate;
  DEA_TRY(ctx, dea_actuator_check_mass(ctx, &model->actuator));
  DEA_TRY(ctx,
          dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                          "model 3d: frequencies are those in vacuo; the air that moves with a "
                          "film makes it slower, by up to a fifth%s",
                          p->sectors == dea_fibre_disc_sectors(p)
                              ? ""
                              : ". A sector has only those modes that have its symmetry "
                                "(compute.solid.domain: disc has all)"));
  *out = (struct dea_motions){.solid = model->solid,
                              .grid = model->grid,
                              .centre = model->centre,
                              .centre_twin = model->centre_twin,
                              .tip = model->tip,
                              .has_centre = true,
                              .has_tip = model->device->fibre_count > 0,
                              .branches = model->branches,
                              .constituent_count = DEA_CONSTITUENT_COUNT};
  return DEA_OK;
}

static void set_symmetry(const struct dea_model *model, struct dea_field_mesh *mesh)
{
  const struct dea_fibre_disc *p = &model->actuator.plate;
  mesh->fold = p->sectors == 1 ? dea_fibre_disc_sectors(p) / 2 : 0;
  mesh->fibres = model->device->fibre_count;
}

static dea_status modes(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_load_point *at, size_t count,
                        struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  struct dea_motions motions;
  *shapes = NULL;
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  DEA_TRY(ctx, dea_motions_modes(ctx, &motions, DEA_FIBRE_DISC_FILM, at, count, points, shapes));
  set_symmetry(model, *shapes);
  return DEA_OK;
}

static dea_status respond(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  struct dea_motions motions;
  DEA_TRY(ctx, find_motions(ctx, model, &motions));
  DEA_TRY(ctx, dea_motions_respond(ctx, &motions, at, excitation, frequency_Hz, count, points));
  return DEA_OK;
}

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  DEA_TRY(ctx, part == DEA_FIELDS_VOLUME
                   ? dea_solid_volume(ctx, model->solid, out)
                   : dea_solid_surface(ctx, model->solid, DEA_FIBRE_DISC_FILM, out));
  set_symmetry(model, *out);
  return DEA_OK;
}

/* Along the first fibre's axis and halfway between it and the next. */
static dea_status profile(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out)
{
  const struct dea_fibre_disc *p = &model->actuator.plate;
  struct dea_field_mesh *surface;
  dea_free(ctx, model->profile);
  model->profile = NULL;
  DEA_TRY(ctx, dea_solid_surface(ctx, model->solid, DEA_FIBRE_DISC_FILM, &surface));
  dea_status status = dea_line_profile(ctx, surface, 0, dea_fibre_disc_angle(p) / p->sectors,
                                       model->device->pre_stretch, &model->profile, out);
  dea_field_mesh_destroy(ctx, surface);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

static dea_status long_path(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_path_options *options, dea_point_sink points,
                            dea_event_sink events, void *user)
{
  const struct dea_device *d = model->device;
  double *weight = dea_solid_alloc(ctx, model->solid->problem.dofs, sizeof *weight);
  if (weight == NULL) {
    return DEA_E_MEMORY;
  }
  weigh_edge(model, weight);
  const struct dea_standing_end end = {weight, (options->max_stretch / d->pre_stretch - 1) *
                                                   d->electrode_radius_m};
  dea_status status = dea_standing_path(ctx, &model->at, options, &end, points, events, user);
  dea_free(ctx, weight);
  DEA_TRY(ctx, status);
  return DEA_OK;
}

static dea_status push(struct dea_context *ctx, struct dea_model *model, const struct dea_push *way,
                       struct dea_load_point *out, bool *found)
{
  double *fold = dea_solid_alloc(ctx, 3 * model->grid->node_count, sizeof *fold);
  if (fold == NULL) {
    return DEA_E_MEMORY;
  }
  dea_buckling_branch_fold(model->solid, model->grid, &model->actuator.plate, way->side, fold);
  dea_status status = dea_standing_push(ctx, &model->at, way, fold, out, found);
  dea_free(ctx, fold);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

static dea_status carry(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_model *from, struct dea_load_point *out, bool *found)
{
  DEA_TRY(ctx, dea_standing_carry(ctx, &model->at, &from->at, out, found));
  return DEA_OK;
}

static dea_status save(struct dea_context *ctx, struct dea_model *model, struct dea_state *out)
{
  DEA_TRY(ctx, dea_standing_save(ctx, &model->at, out));
  return DEA_OK;
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  *out = (struct dea_model_size){.elements = model->grid->element_count,
                                 .nodes = model->grid->node_count,
                                 .unknowns = 3 * model->grid->node_count};
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  DEA_TRY(ctx, dea_model_make(ctx, sizeof **out, device, settings, prepare, destroy, out));
  struct dea_model *model = *out;
  model->at.ending.owner = (struct dea_ending_owner){
      .solid = model->solid,
      .films = model->films,
      .model = model,
      .point = report,
      .arrived = arrived,
      .step_V = field_step_V_per_m * device->film_thickness_unstretched_m,
      .tension_scale_N_per_m =
          device->film.law->shear_modulus(device->film.param) * device->film_thickness_m,
      .flat_thickness_m = device->film_thickness_m,
      .refinement = model->actuator.settings.refinement,
      .membrane = model->actuator.plate.membrane};
  return DEA_OK;
}

extern DEA_MODULE_SYMBOL const struct dea_model_type dea_solid_module;

const struct dea_model_type dea_solid_module = {
    .name = "3d",
    .long_name = "3D solid",
    .tell = dea_solid_tell,
    .libraries = dea_solid_libraries,
    .create = create,
    .destroy = destroy,
    .solve = dea_standing_solve,
    .gradient = gradient,
    .limit = dea_standing_limit,
    .passed = dea_standing_passed,
    .indent = indent,
    .long_path = long_path,
    .soften = dea_standing_soften,
    .push = push,
    .carry = carry,
    .modes = modes,
    .respond = respond,
    .profile = profile,
    .fields = fields,
    .save = save,
    .load = dea_standing_load,
    .begin = begin,
    .advance = dea_standing_advance,
    .accept = dea_standing_accept,
    .size = size,
};
