#include "model/solid/adapter/indent.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>

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

static dea_status prepare(struct dea_context *ctx, const struct dea_actuator *actuator,
                          const struct dea_grid *grid, struct dea_solid *solid,
                          const struct dea_probe *probe, struct dea_indent *indent)
{
  static const enum dea_indenter_shape shapes[] = {[DEA_PROBE_SPHERE] = DEA_INDENTER_SPHERE,
                                                   [DEA_PROBE_FLAT] = DEA_INDENTER_FLAT,
                                                   [DEA_PROBE_CYLINDER] = DEA_INDENTER_CYLINDER};
  const struct dea_fibre_disc *p = &actuator->plate;
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
  indent->from_fibre_side = probe->from_fibre_side;
  indent->touch_z_m = sign * (face + (round ? probe->radius_m : 0));
  indent->depth_m = -1e-3 * probe->radius_m;
  indent->copies = dea_actuator_copies(actuator);
  options.place_m[2] = indent->touch_z_m - sign * indent->depth_m;
  DEA_TRY(ctx,
          dea_surface_create(ctx, grid, probe->from_fibre_side ? DEA_FACE_TOP : DEA_FACE_BOTTOM,
                             select_face, &choice, &indent->surface));
  DEA_TRY(ctx, dea_contact_create(ctx, indent->surface, &options, &indent->contact));
  const struct dea_solid_load load = dea_contact_load(indent->contact);
  DEA_TRY(ctx, dea_solid_add_load(ctx, solid, &load));
  return DEA_OK;
}

dea_status dea_indent_create(struct dea_context *ctx, const struct dea_actuator *actuator,
                             const struct dea_grid *grid, struct dea_solid *solid,
                             const struct dea_probe *probe, struct dea_indent **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = prepare(ctx, actuator, grid, solid, probe, *out);
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

dea_status dea_indent_move(struct dea_context *ctx, struct dea_indent *indent,
                           struct dea_solid *solid, double voltage_V, double depth_m,
                           struct dea_solid_report *report)
{
  double sign = indent->from_fibre_side ? 1 : -1, step = first_step_m;
  do { // also where it is there already: the film may not be
    double way = depth_m - indent->depth_m;
    double next = fabs(way) <= 1.2 * step ? depth_m : indent->depth_m + copysign(step, way);
    const double place_m[3] = {0, 0, indent->touch_z_m - sign * next};
    if (dea_solid_any(dea_interrupted(ctx))) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while pressing");
    }
    dea_contact_move(indent->contact, place_m);
    DEA_TRY(ctx, dea_load_steps_solve(ctx, solid, voltage_V, report));
    indent->depth_m = next;
    step = fmin(growth * step, largest_step_m);
  } while (indent->depth_m != depth_m);
  return DEA_OK;
}

double dea_indent_force(const struct dea_indent *indent, const double *u)
{
  double force_N[3];
  dea_contact_force(indent->contact, u, force_N);
  return indent->copies * (indent->from_fibre_side ? force_N[2] : -force_N[2]);
}
