#include "model/solid/model3d/indent.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/solve_incremental.h"

#include <math.h>
#include <string.h>

/* Penalty of the contact: the answer does not depend on it; some modulus over a tenth of the film's
 * thickness settles in few rounds. */
static const double stiffness_Pa_per_m = 1e10;
static const double first_step_m = 20e-6, largest_step_m = 200e-6, growth = 1.6;

/* Faces that the probe may touch: those that are uppermost or, from below, lowest in their
 * regions, surfaces too. Of several elements through a ply the outermost one's. */
struct choice {
  const struct dea_layout_mesh *mesh;
  bool from_above;
};

static bool select_face(const void *self, int region, int ply, const double middle[3])
{
  const struct choice *choice = self;
  const struct dea_layout_mesh *mesh = choice->mesh;
  const size_t count = mesh->layout->ply_count;
  const bool *present = mesh->present + (size_t)region * count;
  const double face_m = mesh->face_m[ply][choice->from_above ? 1 : 0];
  bool outermost = fabs(middle[2] - face_m) <= 1e-6 * mesh->layout->plies[ply].thickness_m;
  for (size_t p = 0; p < count; p++) {
    // surfaces of one place: the film alone is touched
    bool beyond = choice->from_above ? p > (size_t)ply : p < (size_t)ply;
    bool shadow = mesh->surface[p] && !mesh->dielectric[p];
    outermost = outermost && !(present[p] && beyond && !shadow);
  }
  return outermost && !(mesh->surface[ply] && !mesh->dielectric[ply]);
}

/* The middle of the layout, and the face of what is there. */
static void find_middle(const struct dea_layout_mesh *mesh, bool above, double out[3])
{
  const struct dea_grid *grid = mesh->grid;
  double box[4];
  dea_layout_box_m(mesh->layout, box);
  for (int i = 0; i < 2; i++) {
    double size_m = box[2 + i] - box[i], middle_m = 0.5 * (box[i] + box[2 + i]);
    out[i] = fabs(middle_m) <= 1e-12 * size_m ? 0 : middle_m;
  }
  out[2] = 0;
  int column = grid->column[dea_grid_nearest(grid, out)];
  double face_m = above ? -INFINITY : INFINITY;
  for (size_t n = 0; n < grid->node_count; n++) {
    if (grid->column[n] == column) {
      face_m = above ? fmax(face_m, grid->X[3 * n + 2]) : fmin(face_m, grid->X[3 * n + 2]);
    }
  }
  out[2] = face_m;
}

/* The contact with a probe at a depth. */
static dea_status prepare(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                          const struct dea_pressed *pressed, struct dea_indent *indent)
{
  static const enum dea_indenter_shape shapes[] = {[DEA_PROBE_SPHERE] = DEA_INDENTER_SPHERE,
                                                   [DEA_PROBE_FLAT] = DEA_INDENTER_FLAT,
                                                   [DEA_PROBE_CYLINDER] = DEA_INDENTER_CYLINDER};
  const struct dea_probe *probe = &pressed->tip;
  const struct choice choice = {mesh, probe->from_fibre_side};
  double sign = probe->from_fibre_side ? 1 : -1;
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
  find_middle(mesh, probe->from_fibre_side, indent->touch_m);
  indent->touch_m[2] += round ? sign * probe->radius_m : 0;
  indent->depth_m = pressed->depth_m;
  indent->copies = (double)dea_layout_sector_copies(&mesh->sector);
  memcpy(options.place_m, indent->touch_m, sizeof indent->touch_m);
  options.place_m[2] -= sign * indent->depth_m;
  struct dea_surface *surface;
  DEA_TRY(ctx, dea_surface_create(ctx, mesh->grid,
                                  probe->from_fibre_side ? DEA_FACE_TOP : DEA_FACE_BOTTOM,
                                  select_face, &choice, &indent->memory, &surface));
  return DEA_CHAIN(ctx,
                   dea_contact_create(ctx, surface, &options, &indent->memory, &indent->contact));
}

void dea_indent_destroy(struct dea_context *ctx, struct dea_indent *indent)
{
  if (indent != NULL) {
    dea_arena_free(&indent->memory);
    dea_free(ctx, indent);
  }
}

/* One contact in place of another among the loads. */
static void replace(struct dea_solid *s, const struct dea_contact *old, struct dea_contact *with)
{
  for (size_t k = 0; k < s->problem.load_count; k++) {
    if (s->problem.loads[k].self == old) {
      s->problem.loads[k] = dea_contact_load(with);
    }
  }
}

dea_status dea_indent_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                             struct dea_solid *solid, const struct dea_pressed *pressed,
                             const struct dea_indent *other, struct dea_indent **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  (*out)->memory.ctx = ctx;
  dea_status status = prepare(ctx, mesh, pressed, *out);
  if (status == DEA_OK && other == NULL) {
    const struct dea_solid_load load = dea_contact_load((*out)->contact);
    status = dea_solid_add_load(ctx, solid, &load);
  } else if (status == DEA_OK) {
    dea_contact_hold((*out)->contact, other->contact);
    replace(solid, other->contact, (*out)->contact);
  }
  if (status != DEA_OK) { // a load that was added is the last thing that can fail
    dea_indent_destroy(ctx, *out);
    *out = NULL;
  }
  return status;
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
struct recent {
  struct dea_solid_saved_state last, before; // before.state NULL: none
  double last_m, before_m;
};

/* Where the solid is becomes the last one. */
static dea_status keep_last(struct dea_context *ctx, struct dea_solid *s, double depth_m,
                            struct recent *recent)
{
  dea_solid_saved_state_free(&recent->before);
  recent->before = recent->last;
  recent->before_m = recent->last_m;
  recent->last_m = depth_m;
  return DEA_CHAIN(ctx, dea_solid_save_state(ctx, s, &recent->last));
}

/* From the last state as far straight on from the one before as the tip goes: there the surface is
 * about where the tip will be. From the last state itself the tip would lie in the film, and the
 * factor that is there has other normals. */
static void extrapolate(struct dea_solid *s, const struct recent *recent, double depth_m)
{
  const struct dea_load_steps *steps = &s->work.load_steps;
  const double *last = recent->last.state, *before = recent->before.state;
  double fraction =
      before != NULL ? (depth_m - recent->last_m) / (recent->last_m - recent->before_m) : 0;
  for (size_t i = 0; i < steps->state_count && fraction > 0; i++) {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): else the share is 0
    steps->keep[i] = last[i] + fraction * (last[i] - before[i]);
  }
  dea_solid_state_set(s, fraction > 0 ? steps->keep : last);
  dea_solid_forget(s);
}

/* One step of the tip, from the last state where it fails from the one ahead. */
static dea_status step_tip(struct dea_context *ctx, struct dea_indent *indent, struct dea_solid *s,
                           double voltage_V, double depth_m, struct recent *recent,
                           struct dea_solid_report *report)
{
  const double *touch_m = indent->touch_m;
  double z_m = touch_m[2] - (indent->probe.from_fibre_side ? depth_m : -depth_m);
  DEA_TRY(ctx, keep_last(ctx, s, indent->depth_m, recent));
  dea_contact_move(indent->contact, (const double[3]){touch_m[0], touch_m[1], z_m});
  extrapolate(s, recent, depth_m);
  dea_status status = dea_load_steps_solve(ctx, s, voltage_V, report);
  if (dea_solid_may_shorten(status) && recent->before.state != NULL) {
    dea_context_clear(ctx);
    dea_solid_restore_state(s, &recent->last);
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
  struct recent recent = {0};
  double step = first_step_m;
  dea_status status = DEA_OK;
  do { // also where it is there already: the film may not be
    double left = depth_m - indent->depth_m;
    double next = fabs(left) <= 1.2 * step ? depth_m : indent->depth_m + copysign(step, left);
    status = dea_interrupted_anywhere(ctx)
                 ? dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while pressing")
                 : step_tip(ctx, indent, solid, voltage_V, next, &recent, report);
    step = fmin(growth * step, largest_step_m);
  } while (status == DEA_OK && indent->depth_m != depth_m);
  dea_solid_saved_state_free(&recent.last);
  dea_solid_saved_state_free(&recent.before);
  return DEA_CHAIN(ctx, status);
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
