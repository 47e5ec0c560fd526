/* Small motions of the model "3d": points and shapes. */
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_fields.h"
#include "model/solid/model3d/solid_model.h"
#include "model/solid/motion/response.h"
#include "result/columns.h"
#include "result/field_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Share of the kinetic energy of a mode, v . Mv = 1, that is out of the plane; work: [2][dofs]. */
static dea_status out_of_plane(struct dea_context *ctx, const struct dea_model *m,
                               const double *vector, double *work, double *fraction)
{
  size_t dofs = 3 * m->mesh.grid->node_count;
  for (size_t i = 0; i < dofs; i++) {
    work[i] = i % 3 == 2 ? vector[i] : 0;
  }
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, m->solid, work, work + dofs));
  *fraction = 0;
  for (size_t i = 2; i < dofs; i += 3) {
    *fraction += work[i] * work[dofs + i];
  }
  return DEA_OK;
}

static double largest(const double *v, size_t dofs)
{
  double most = 0;
  for (size_t i = 0; i < dofs; i += 3) {
    most = fmax(most, hypot(hypot(v[i], v[i + 1]), v[i + 2]));
  }
  return most;
}

/* Frequencies and where the modes move. A negative frequency: unstable, of that rate. */
static dea_status fill_points(struct dea_context *ctx, const struct dea_model *m,
                              const struct dea_load_point *at, size_t count, const double *square,
                              const double *vector, double *work, struct dea_load_point *points)
{
  const int centre = dea_point_column_find("centre_z_m");
  size_t dofs = 3 * m->mesh.grid->node_count;
  for (size_t k = 0; k < count; k++) {
    const double *v = vector + k * dofs;
    struct dea_load_point *p = &points[k];
    *p = *at;
    p->mode = (double)(k + 1);
    p->frequency_Hz = copysign(sqrt(fabs(square[k])), square[k]) / (2 * DEA_PI);
    p->mode_centre = dea_observer_column(m->observer, centre, v) / largest(v, dofs);
    DEA_TRY(ctx, out_of_plane(ctx, m, v, work, &p->mode_out_of_plane));
  }
  return DEA_OK;
}

/* The surface is moved by v so little that it is as good as at rest. */
dea_status dea_solid_model_surface(struct dea_context *ctx, const struct dea_model *m,
                                   const double *v, struct dea_field_mesh **out)
{
  static const double little = 1e-9; // of the size of the mesh
  size_t dofs = 3 * m->mesh.grid->node_count;
  double *u = dea_solid_displacement(m->solid), *keep = dea_solid_alloc(ctx, dofs, sizeof *keep);
  double scale = little * largest(m->mesh.grid->X, dofs) / largest(v, dofs);
  DEA_TRY_MEMORY(keep != NULL);
  memcpy(keep, u, dofs * sizeof *u);
  for (size_t i = 0; i < dofs; i++) {
    u[i] = scale * v[i];
  }
  dea_status status = dea_solid_fields(ctx, m->solid, (int)m->plies.film, out);
  memcpy(u, keep, dofs * sizeof *u);
  dea_free(ctx, keep);
  for (size_t i = 0; status == DEA_OK && i < 3 * (*out)->point_count; i++) {
    dea_field_mesh_find(*out, "displacement_m")->values[i] /= scale;
  }
  return status;
}

/* Adds a mode to the surface as a field, its largest displacement there 1. */
static dea_status add_shape(struct dea_context *ctx, const struct dea_model *m,
                            const struct dea_load_point *point, const double *v,
                            struct dea_field_mesh *mesh)
{
  struct dea_mesh_field field = {.unit = "1", .kind = DEA_MESH_VECTOR, .components = 3};
  struct dea_field_mesh *moved;
  double *values;
  snprintf(field.name, sizeof field.name, DEA_SHAPE_FIELD, (int)point->mode);
  snprintf(field.meaning, sizeof field.meaning,
           "shape of the mode at %.6g Hz, its largest displacement 1", point->frequency_Hz);
  DEA_TRY(ctx, dea_solid_model_surface(ctx, m, v, &moved));
  dea_status status = dea_field_mesh_add(ctx, mesh, &field, &values);
  if (status == DEA_OK) {
    const double *u = dea_field_mesh_find(moved, "displacement_m")->values;
    double most = largest(u, 3 * mesh->point_count);
    for (size_t i = 0; i < 3 * mesh->point_count; i++) {
      values[i] = most > 0 ? u[i] / most : 0;
    }
  }
  dea_field_mesh_destroy(ctx, moved);
  return status;
}

static dea_status get_modes(struct dea_context *ctx, const struct dea_model *m,
                            const struct dea_load_point *at, size_t count, double *memory,
                            struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  size_t dofs = 3 * m->mesh.grid->node_count;
  double *square = memory, *work = memory + count, *vector = work + 2 * dofs;
  DEA_TRY(ctx, dea_solid_modes_lowest(ctx, m->solid, DEA_MODES_BY_MASS, count, square, vector));
  DEA_TRY(ctx, fill_points(ctx, m, at, count, square, vector, work, points));
  DEA_TRY(ctx, dea_solid_fields(ctx, m->solid, (int)m->plies.film, shapes));
  dea_status status = DEA_OK;
  for (size_t k = 0; k < count && status == DEA_OK; k++) {
    status = add_shape(ctx, m, &points[k], vector + k * dofs, *shapes);
  }
  return dea_field_mesh_finish(ctx, status, shapes);
}

/* What is said of frequencies before they are found. */
static dea_status begin_motions(struct dea_context *ctx, const struct dea_model *model)
{
  DEA_TRY(ctx, dea_solid_check_densities(ctx, model));
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                         "model 3d: frequencies are those in vacuo; the air that moves with a film "
                         "makes it slower, a thin one by about a fifth (model reduced has it: "
                         "compute.reduced.air)%s%s",
                         model->mesh.sector.fold == 0
                             ? ""
                             : ". A sector has only those modes that have its symmetry "
                               "(compute.solid.domain: ",
                         model->mesh.sector.fold == 0 ? ""
                         : model->disc                ? "disc has all)"
                                                      : "whole has all)");
}

dea_status dea_solid_model_whole(struct dea_context *ctx, const struct dea_model *model,
                                 struct dea_field_mesh **mesh)
{
  const struct dea_layout_sector *sector = &model->mesh.sector;
  struct dea_field_mesh *part = *mesh, *whole = NULL;
  if (model->disc) {
    part->fold = sector->fold;
    part->symmetry_angle = sector->angle_rad;
    part->fibres = model->device->fibre_count;
  }
  if (sector->fold == 0 || model->disc) {
    return DEA_OK;
  }
  part->fold = sector->fold; // about the z axis, where the centre is for a moment
  part->symmetry_angle = sector->angle_rad;
  for (size_t i = 0; i < 2 * part->point_count; i++) {
    part->X[3 * (i / 2) + i % 2] -= sector->centre_m[i % 2];
  }
  dea_status status = dea_field_mesh_whole(ctx, part, &whole);
  dea_field_mesh_destroy(ctx, part);
  *mesh = whole;
  DEA_TRY(ctx, status);
  for (size_t i = 0; i < 2 * whole->point_count; i++) {
    whole->X[3 * (i / 2) + i % 2] += sector->centre_m[i % 2];
  }
  return DEA_OK;
}

dea_status dea_solid_model_modes(struct dea_context *ctx, struct dea_model *model,
                                 const struct dea_load_point *at, size_t count,
                                 struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  *shapes = NULL;
  DEA_TRY(ctx, begin_motions(ctx, model));
  double *memory =
      dea_solid_alloc(ctx, count + (2 + count) * 3 * model->mesh.grid->node_count, sizeof *memory);
  DEA_TRY_MEMORY(memory != NULL);
  dea_solid_liquids_stiffen(model, true);
  const dea_status status = get_modes(ctx, model, at, count, memory, points, shapes);
  dea_solid_liquids_stiffen(model, false);
  dea_free(ctx, memory);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, dea_solid_model_whole(ctx, model, shapes));
}

/* ---- answers ---- */

static bool is_viscous(const struct dea_model *m)
{
  bool any = false;
  for (size_t i = 0; i < m->layout->ply_count; i++) {
    any = any || m->plies.branches[i].count > 0;
  }
  return any;
}

/* What takes the whole answers of a response. */
struct answers {
  struct dea_model *model;
  struct dea_load_point *points;
};

static void find_amplitude(const struct dea_model *m, const char *key, const double *real,
                           const double *imaginary, double ripple_V, double *amplitude_m,
                           double *phase_rad)
{
  const int column = dea_point_column_find(key);
  const double re = dea_observer_column(m->observer, column, real);
  const double im = dea_observer_column(m->observer, column, imaginary);
  *amplitude_m = ripple_V * hypot(re, im);
  *phase_rad = atan2(im, re);
}

/* Of one frequency, per volt. */
static dea_status add_frequency(struct dea_context *ctx, void *user, size_t i, const double *real,
                                const double *imaginary)
{
  const struct answers *to = user;
  struct dea_model *m = to->model;
  struct dea_load_point *p = &to->points[i];
  find_amplitude(m, "centre_z_m", real, imaginary, p->ripple_V, &p->centre_amplitude_m,
                 &p->centre_phase_rad);
  find_amplitude(m, "fibre_tip_z_m", real, imaginary, p->ripple_V, &p->fibre_tip_amplitude_m,
                 &p->fibre_tip_phase_rad);
  find_amplitude(m, "electrode_edge_u_m", real, imaginary, p->ripple_V,
                 &p->electrode_edge_amplitude_m, &p->electrode_edge_phase_rad);
  return DEA_CHAIN(ctx, dea_observer_differentiate(
                            ctx, m->observer, m->solid, (const double *[2]){real, imaginary},
                            m->answers + i * m->layout->monitor_count * DEA_OBSERVED_MOTIONS));
}

static dea_status superpose(struct dea_context *ctx, const struct dea_model *m,
                            const struct dea_damping *damping, const double *rad_per_s,
                            size_t count, struct answers *out)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_solid_response *response;
  size_t nodes = m->mesh.grid->node_count;
  double highest = 0;
  for (size_t i = 0; i < count; i++) {
    highest = fmax(highest, rad_per_s[i]);
  }
  double *real = dea_arena_alloc(&memory, 3 * nodes, sizeof *real),
         *imaginary = dea_arena_alloc(&memory, 3 * nodes, sizeof *imaginary);
  dea_status status = dea_solid_response_create(ctx, m->solid, highest, &memory, &response);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    for (size_t n = 0; n < nodes; n++) {
      dea_solid_response_at(response, n, rad_per_s[i], damping, real + 3 * n, imaginary + 3 * n);
    }
    status = add_frequency(ctx, out, i, real, imaginary);
  }
  dea_arena_free(&memory);
  return DEA_CHAIN(ctx, status);
}

/* At one frequency there are no modes: the ratio becomes shares of mass and stiffness that make it
 * at the first resonance and at three times that, 0.87 of it between them and more beyond. */
static dea_status spread_ratio(struct dea_context *ctx, const struct dea_model *m,
                               struct dea_damping *damping)
{
  static const double spread = 3;
  double square;
  if (damping->ratio == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_modes_lowest(ctx, m->solid, DEA_MODES_BY_MASS, 1, &square, NULL));
  if (!(square > 0)) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED,
                    "the equilibrium that the voltage oscillates about is unstable");
  }
  double first = sqrt(square), sum = (1 + spread) * first;
  damping->mass_per_s += 2 * damping->ratio * spread * square / sum;
  damping->stiffness_s += 2 * damping->ratio / sum;
  return DEA_OK;
}

static dea_status solve_each(struct dea_context *ctx, const struct dea_model *m,
                             const struct dea_damping *damping, const double *rad_per_s,
                             size_t count, struct answers *out)
{
  struct dea_damping spread = *damping;
  DEA_TRY(ctx, spread_ratio(ctx, m, &spread));
  return DEA_CHAIN(ctx, dea_solid_respond_viscous(ctx, m->solid, m->plies.branches, &spread,
                                                  rad_per_s, count, add_frequency, out));
}

static dea_status find_answers(struct dea_context *ctx, struct dea_model *model,
                               const struct dea_ac_excitation *excitation,
                               const double *frequency_Hz, size_t count, struct answers *out)
{
  const struct dea_damping damping = {excitation->damping_ratio, excitation->damping_mass_per_s,
                                      excitation->damping_stiffness_s};
  double *rad_per_s = dea_solid_alloc(ctx, count, sizeof *rad_per_s);
  DEA_TRY_MEMORY(rad_per_s != NULL);
  for (size_t i = 0; i < count; i++) {
    rad_per_s[i] = 2 * DEA_PI * frequency_Hz[i];
  }
  dea_solid_liquids_stiffen(model, true);
  const dea_status status =
      (is_viscous(model) ? solve_each : superpose)(ctx, model, &damping, rad_per_s, count, out);
  dea_solid_liquids_stiffen(model, false);
  dea_free(ctx, rad_per_s);
  return status;
}

dea_status dea_solid_model_respond(struct dea_context *ctx, struct dea_model *model,
                                   const struct dea_load_point *at,
                                   const struct dea_ac_excitation *excitation,
                                   const double *frequency_Hz, size_t count,
                                   struct dea_load_point *points)
{
  const size_t width = model->layout->monitor_count * DEA_OBSERVED_MOTIONS;
  struct answers out = {model, points};
  double(*answers)[2] = dea_resize(ctx, model->answers, count * width + 1, sizeof *answers);
  model->answers = answers != NULL ? answers : model->answers;
  DEA_TRY_MEMORY(!dea_solid_allreduce_any(answers == NULL));
  if (dea_layout_has_sheet_resistance(model->layout)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "an excitation by electrodes with a sheet resistance is known in "
                    "time only (compute.transient with a sine); without sheet_resistance: that of "
                    "ideal electrodes");
  }
  DEA_TRY(ctx, begin_motions(ctx, model));
  for (size_t i = 0; i < count; i++) {
    points[i] = *at;
    points[i].frequency_Hz = frequency_Hz[i];
    points[i].ripple_V = excitation->amplitude_V;
  }
  DEA_TRY(ctx, find_answers(ctx, model, excitation, frequency_Hz, count, &out));
  for (size_t i = 0; i < 2 * count * width; i++) {
    model->answers[i / 2][i % 2] *= excitation->amplitude_V;
  }
  return DEA_OK;
}
