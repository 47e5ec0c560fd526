#include "model/solid/adapter/indent.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/equilibrium/approach.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>
#include <string.h>

/* Penalty of the contact: the answer does not depend on it; some modulus over a tenth of the film's
 * thickness settles in few rounds. */
static const double stiffness_Pa_per_m = 1e10;
static const double first_step_m = 20e-6, largest_step_m = 200e-6, growth = 1.6;

/* Faces that the probe may touch: the film's and, from above, those of electrodes and fibres. Of
 * several elements through the film the outermost one's. */
struct choice {
  const struct dea_actuator *actuator;
  bool from_above;
};

static bool select_face(const void *self, int region, int ply, const double middle[3])
{
  const struct choice *choice = self;
  const struct dea_fibre_disc *p = &choice->actuator->plate;
  bool inside = region & DEA_FIBRE_DISC_ELECTRODE, fibre = region & DEA_FIBRE_DISC_FIBRE;
  bool layers = p->electrode_thickness > 0 && !p->membrane;
  int covered = inside && layers ? DEA_FIBRE_DISC_TOP : DEA_FIBRE_DISC_FILM;
  bool outermost = p->membrane || fabs(middle[2]) > 0.5 * p->film_thickness * (1 - 1e-6);
  if (!outermost) {
    return false;
  }
  if (choice->from_above) {
    return ply == (fibre ? DEA_FIBRE_DISC_FIBRE_PLY : covered);
  }
  return ply == (covered == DEA_FIBRE_DISC_TOP ? DEA_FIBRE_DISC_BOTTOM : DEA_FIBRE_DISC_FILM);
}

/* The contact with a probe at a depth. */
static dea_status prepare(struct dea_context *ctx, const struct dea_actuator *actuator,
                          const struct dea_grid *grid, const struct dea_pressed *pressed,
                          struct dea_indent *indent)
{
  static const enum dea_indenter_shape shapes[] = {[DEA_PROBE_SPHERE] = DEA_INDENTER_SPHERE,
                                                   [DEA_PROBE_FLAT] = DEA_INDENTER_FLAT,
                                                   [DEA_PROBE_CYLINDER] = DEA_INDENTER_CYLINDER};
  const struct dea_fibre_disc *p = &actuator->plate;
  const struct dea_probe *probe = &pressed->tip;
  const struct choice choice = {actuator, probe->from_fibre_side};
  double sign = probe->from_fibre_side ? 1 : -1;
  double face = p->membrane ? 0 : 0.5 * p->film_thickness + p->electrode_thickness;
  bool round = probe->shape != DEA_PROBE_FLAT;
  struct dea_contact_options options = {
      .tip = {.shape = shapes[probe->shape],
              .radius_m = probe->radius_m,
              .axis = {0, 0, sign},
              .edge_radius_m = fmin(probe->edge_radius_m, probe->radius_m),
              .half_length_m = INFINITY},
      .stiffness_Pa_per_m = stiffness_Pa_per_m,
  };
  if (probe->shape == DEA_PROBE_CYLINDER) {
    options.tip.axis[0] = 1;
    options.tip.axis[2] = 0;
  }
  indent->probe = *probe;
  indent->touch_z_m = sign * (face + (round ? probe->radius_m : 0));
  indent->depth_m = pressed->depth_m;
  indent->copies = dea_actuator_copies(actuator);
  options.place_m[2] = indent->touch_z_m - sign * indent->depth_m;
  DEA_TRY(ctx,
          dea_surface_create(ctx, grid, probe->from_fibre_side ? DEA_FACE_TOP : DEA_FACE_BOTTOM,
                             select_face, &choice, &indent->surface));
  DEA_TRY(ctx, dea_contact_create(ctx, indent->surface, &options, &indent->contact));
  return DEA_OK;
}

dea_status dea_indent_create(struct dea_context *ctx, const struct dea_actuator *actuator,
                             const struct dea_grid *grid, struct dea_solid *solid,
                             const struct dea_probe *probe, struct dea_indent **out)
{
  const struct dea_pressed pressed = {*probe, -1e-3 * probe->radius_m};
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = prepare(ctx, actuator, grid, &pressed, *out);
  if (status == DEA_OK) {
    const struct dea_solid_load load = dea_contact_load((*out)->contact);
    status = dea_solid_add_load(ctx, solid, &load);
  }
  if (status != DEA_OK) { // a load that was added is the last thing that can fail
    dea_indent_destroy(ctx, *out);
    *out = NULL;
  }
  return status;
}

void dea_indent_destroy(struct dea_context *ctx, struct dea_indent *indent)
{
  if (indent != NULL) {
    dea_contact_destroy(ctx, indent->contact);
    dea_surface_destroy(ctx, indent->surface);
    dea_free(ctx, indent);
  }
}

// Gradients ---------------------------------------------------------------------------------------

/* One contact in place of another among the loads. */
static void replace(struct dea_solid *s, const struct dea_contact *old, struct dea_contact *with)
{
  for (size_t k = 0; k < s->problem.load_count; k++) {
    if (s->problem.loads[k].self == old) {
      s->problem.loads[k] = dea_contact_load(with);
    }
  }
}

dea_status dea_indent_create_variant(struct dea_context *ctx, const struct dea_actuator *actuator,
                                     const struct dea_grid *grid, struct dea_solid *solid,
                                     const struct dea_pressed *pressed,
                                     const struct dea_indent *other, struct dea_indent **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = prepare(ctx, actuator, grid, pressed, *out);
  if (status != DEA_OK) {
    dea_indent_destroy(ctx, *out);
    *out = NULL;
    return status;
  }
  dea_contact_hold((*out)->contact, other->contact);
  replace(solid, other->contact, (*out)->contact);
  return DEA_OK;
}

void dea_indent_end_variant(struct dea_context *ctx, struct dea_solid *solid,
                            const struct dea_indent *other, struct dea_indent *variant)
{
  if (variant != NULL) {
    replace(solid, variant->contact, other->contact);
    dea_indent_destroy(ctx, variant);
  }
}

// Moving ------------------------------------------------------------------------------------------

/* Two equilibria on the way, and their depths: where the solid is, and the one before. */
struct way {
  struct dea_solid_stand last, before; // before.state NULL: none
  double last_m, before_m;
};

/* Where the solid is becomes the last one. */
static dea_status keep_last(struct dea_context *ctx, struct dea_solid *s, double depth_m,
                            struct way *way)
{
  dea_solid_stand_free(&way->before);
  way->before = way->last;
  way->before_m = way->last_m;
  way->last_m = depth_m;
  DEA_TRY(ctx, dea_solid_stand_keep(ctx, s, &way->last));
  return DEA_OK;
}

/* From the last state as far straight on from the one before as the tip goes: there the surface is
 * about where the tip will be. From the last state itself the tip would lie in the film, and the
 * factor that is there has other normals. */
static void go_straight_on(struct dea_solid *s, const struct way *way, double depth_m)
{
  const struct dea_load_steps *steps = &s->work.load_steps;
  const double *last = way->last.state, *before = way->before.state;
  double share = before != NULL ? (depth_m - way->last_m) / (way->last_m - way->before_m) : 0;
  for (size_t i = 0; i < steps->state_count && share > 0; i++) {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): else the share is 0
    steps->keep[i] = last[i] + share * (last[i] - before[i]);
  }
  dea_solid_state_set(s, share > 0 ? steps->keep : last);
  dea_solid_forget(s);
}

/* One step of the tip, from the last state where it fails from the one ahead. */
static dea_status move_on(struct dea_context *ctx, struct dea_indent *indent, struct dea_solid *s,
                          double voltage_V, double depth_m, struct way *way,
                          struct dea_solid_report *report)
{
  double z_m = indent->touch_z_m - (indent->probe.from_fibre_side ? depth_m : -depth_m);
  DEA_TRY(ctx, keep_last(ctx, s, indent->depth_m, way));
  dea_contact_move(indent->contact, (const double[3]){0, 0, z_m});
  go_straight_on(s, way, depth_m);
  dea_status status = dea_load_steps_solve(ctx, s, voltage_V, report);
  if (dea_solid_may_shorten(status) && way->before.state != NULL) {
    dea_context_clear(ctx);
    dea_solid_stand_again(s, &way->last);
    status = dea_load_steps_solve(ctx, s, voltage_V, report);
  }
  if (status == DEA_OK) {
    indent->depth_m = depth_m;
  }
  return status;
}

dea_status dea_indent_move(struct dea_context *ctx, struct dea_indent *indent,
                           struct dea_solid *solid, double voltage_V, double depth_m,
                           struct dea_solid_report *report)
{
  struct way way = {0};
  double step = first_step_m;
  dea_status status = DEA_OK;
  do { // also where it is there already: the film may not be
    double left = depth_m - indent->depth_m;
    double next = fabs(left) <= 1.2 * step ? depth_m : indent->depth_m + copysign(step, left);
    status = dea_interrupted_anywhere(ctx)
                 ? dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while pressing")
                 : move_on(ctx, indent, solid, voltage_V, next, &way, report);
    step = fmin(growth * step, largest_step_m);
  } while (status == DEA_OK && indent->depth_m != depth_m);
  dea_solid_stand_free(&way.last);
  dea_solid_stand_free(&way.before);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

double dea_indent_force(const struct dea_indent *indent, const double *u)
{
  double force_N[3];
  dea_contact_force(indent->contact, u, force_N);
  return indent->copies * (indent->probe.from_fibre_side ? force_N[2] : -force_N[2]);
}

void dea_indent_force_slope(const struct dea_indent *indent, const double *u, double *by_u,
                            double *by_pressure)
{
  const double sign = indent->probe.from_fibre_side ? 1 : -1;
  dea_contact_force_slope(indent->contact, u, 2, sign * indent->copies, by_u, by_pressure);
}
