/* The engine with a mesh, materials, supports and loads of the caller's: api/own_mesh.h. */
#include "api/own_mesh.h"

#include "base/module.h"
#include "base/text.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/load/loads.h"
#include "model/solid/mesh/msh_read.h"
#include "model/solid/model3d/solid_fields.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { FACES = 6 };

/* A spring of a body, and which component it holds. */
struct held_spring {
  struct dea_spring *spring;
  struct dea_arena memory; // of it
  size_t body;
  int component; // 0 to 2: shift, 3 to 5: rotation vector
};

struct dea_solid_object {
  struct dea_plane_mesh *plane; // of a .msh file, otherwise NULL
  struct dea_grid *grid;
  struct dea_part_material *part_materials; // [part_count]
  int (*between)[2];                        // [part_count] channels above and below
  size_t part_count;
  double length_m;        // of the mesh: what is near enough
  size_t mesh_node_count; // without those of bodies
  struct dea_solid *solid;
  struct dea_solid_report report;
  struct dea_solid_continuation *path;
  struct dea_continuation_point point; // of the path
  size_t mode_count;
  double *mode_square, *mode_shape; // the second in the memory of the first
  size_t channel_count;             // ground not counted
  double *charges; // voltages, charges, both matrices of capacitances; NULL: not asked for
  size_t body_count;
  double *body_values; // [4][body_count][3] shift, turn, force, moment
  size_t spring_count;
  struct held_spring *springs; // [spring_count]
  double *spring_values;       // [2][spring_count] force, moment
};

// Mesh -------------------------------------------------------------------------------------------

static void box_map(const void *self, double s, double t, double x[2])
{
  const dea_solid_options *spec = self;
  x[0] = spec->box_m[0] * s;
  x[1] = spec->box_m[1] * t;
}

static dea_status build_box(struct dea_context *ctx, const dea_solid_options *spec,
                            struct dea_grid **out)
{
  size_t nx = spec->elements[0], ny = spec->elements[1];
  double *cuts = dea_alloc(ctx, nx + ny + 2, sizeof *cuts);
  DEA_TRY_MEMORY(cuts != NULL);
  for (size_t i = 0; i <= nx; i++) {
    cuts[i] = (double)i / (double)nx;
  }
  for (size_t i = 0; i <= ny; i++) {
    cuts[nx + 1 + i] = (double)i / (double)ny;
  }
  const struct dea_block block = {box_map, spec, cuts, cuts + nx + 1, nx, ny, 0};
  const struct dea_ply ply = {spec->box_m[2], spec->elements[2], spec->order_z};
  dea_status status = dea_grid_create(ctx, spec->order, &block, 1, &ply, 1, NULL, 0,
                                      fmax(spec->box_m[0], spec->box_m[1]), out);
  dea_free(ctx, cuts);
  return status;
}

static dea_status fill_grid(struct dea_context *ctx, const dea_solid_options *spec,
                            struct dea_grid *grid)
{
  size_t nodes = (size_t)((spec->order + 1) * (spec->order + 1) * (spec->order_z + 1));
  for (size_t e = 0; e < spec->cell_count; e++) {
    int part = spec->part_of != NULL ? spec->part_of[e] : 0;
    if (part < 0 || (size_t)part >= spec->part_count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "cell %zu is of part %d of %zu", e, part,
                      spec->part_count);
    }
    grid->region[e] = part;
    grid->levels[e] = spec->order_z + 1;
    for (size_t n = 0; n < nodes; n++) {
      int node = spec->cells[e * nodes + n];
      if (node < 0 || (size_t)node >= spec->point_count) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "cell %zu has node %d of %zu", e, node,
                        spec->point_count);
      }
      grid->nodes[e * DEA_HEX_NODES_MAX + n] = node;
    }
  }
  for (size_t i = 0; i < 3 * spec->point_count; i++) {
    if (!isfinite(spec->points_m[i])) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "point %zu has non-finite coordinates", i / 3);
    }
    grid->X[i] = spec->points_m[i];
  }
  return DEA_OK;
}

static dea_status build_grid(struct dea_context *ctx, const dea_solid_options *spec,
                             struct dea_grid **out)
{
  DEA_TRY(ctx, dea_grid_allocate(ctx, spec->order, spec->order_z, spec->point_count,
                                 spec->cell_count, out));
  return fill_grid(ctx, spec, *out);
}

/* Parts of a plane mesh through plies: [region_count][ply_count], -1 where there is none. */
struct filling {
  int *part;
  size_t ply_count;
};

static dea_status fill_plies(struct dea_context *ctx, const dea_solid_options *spec,
                             const struct dea_plane_mesh *mesh, struct filling *out)
{
  out->ply_count = spec->ply_count;
  out->part = dea_alloc(ctx, mesh->region_count * spec->ply_count, sizeof *out->part);
  DEA_TRY_MEMORY(out->part != NULL);
  memset(out->part, -1, mesh->region_count * spec->ply_count * sizeof *out->part);
  for (size_t i = 0; i < spec->fill_count; i++) {
    const dea_fill *fill = &spec->fills[i];
    size_t group = fill->group != NULL ? dea_plane_mesh_group(mesh, fill->group) : 0;
    if (group >= mesh->group_count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "'%s' has no physical surface '%.60s'", spec->msh_file,
                      fill->group);
    }
    if (fill->ply >= spec->ply_count || fill->part >= spec->part_count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "part %zu of %zu in ply %zu of %zu", fill->part,
                      spec->part_count, fill->ply, spec->ply_count);
    }
    for (size_t r = 0; r < mesh->region_count; r++) {
      if (fill->group == NULL || mesh->within[r * mesh->group_count + group] != 0) {
        out->part[r * spec->ply_count + fill->ply] = (int)fill->part;
      }
    }
  }
  return DEA_OK;
}

static bool is_filled(const void *self, int region, int ply)
{
  const struct filling *filling = self;
  return filling->part[(size_t)region * filling->ply_count + (size_t)ply] >= 0;
}

static dea_status extrude(struct dea_context *ctx, const dea_solid_options *spec,
                          const struct dea_plane_mesh *mesh, const struct filling *filling,
                          struct dea_grid **out)
{
  struct dea_ply *plies = dea_alloc(ctx, spec->ply_count, sizeof *plies);
  DEA_TRY_MEMORY(plies != NULL);
  for (size_t i = 0; i < spec->ply_count; i++) {
    const size_t through = spec->ply_elements != NULL ? spec->ply_elements[i] : 1;
    plies[i] = (struct dea_ply){spec->ply_thickness_m[i], through, spec->order_z};
  }
  const struct dea_stack stack = {
      .plies = plies, .count = spec->ply_count, .present = is_filled, .self = filling};
  dea_status status = dea_grid_extrude(ctx, mesh, &stack, out);
  dea_free(ctx, plies);
  DEA_TRY(ctx, status);
  struct dea_grid *grid = *out;
  if (grid->element_count == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no ply of '%s' has a part", spec->msh_file);
  }
  for (size_t e = 0; e < grid->element_count; e++) { // as with cells, a region is a part
    grid->region[e] =
        filling->part[(size_t)grid->region[e] * filling->ply_count + (size_t)grid->ply[e]];
  }
  return DEA_OK;
}

static dea_status build_plies(struct dea_context *ctx, const dea_solid_options *spec,
                              struct dea_plane_mesh **plane, struct dea_grid **out)
{
  struct filling filling = {0};
  DEA_TRY(ctx, dea_msh_read(ctx, spec->msh_file, spec->msh_unit_m, plane));
  dea_status status = fill_plies(ctx, spec, *plane, &filling);
  status = status == DEA_OK ? extrude(ctx, spec, *plane, &filling, out) : status;
  dea_free(ctx, filling.part);
  return status;
}

static double size_of(const struct dea_grid *grid)
{
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t n = 0; n < grid->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      low[i] = fmin(low[i], grid->X[3 * n + (size_t)i]);
      high[i] = fmax(high[i], grid->X[3 * n + (size_t)i]);
    }
  }
  return fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
}

// Places, bodies ---------------------------------------------------------------------------------

static bool is_there(const struct dea_solid_object *object, struct dea_solid_place place,
                     const double X[3])
{
  double near = 1e-6 * object->length_m;
  bool inside = true;
  for (int i = 0; i < 3 && place.low_m != NULL; i++) {
    inside = inside && X[i] >= place.low_m[i] - near && X[i] <= place.high_m[i] + near;
  }
  return inside;
}

/* Whether each node of the plane mesh is on a curve [node_count]; owned by the caller. */
static dea_status mark_curve(struct dea_context *ctx, const struct dea_plane_mesh *plane,
                             const char *name, bool **out)
{
  size_t curve = plane != NULL ? dea_plane_mesh_curve(plane, name) : SIZE_MAX;
  *out = NULL;
  if (plane == NULL || curve >= plane->curve_count) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh has no physical curve '%.60s'", name);
  }
  *out = dea_alloc(ctx, plane->node_count, sizeof **out);
  size_t per = (size_t)plane->order + 1;
  for (size_t i = 0; i < plane->edge_count * per && *out != NULL; i++) {
    (*out)[plane->edges[i]] |= (size_t)plane->edge_curve[i / per] == curve;
  }
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* Whether each node of the mesh is there [mesh_node_count]; owned by the caller. */
static dea_status find_nodes(struct dea_context *ctx, const struct dea_solid_object *object,
                             struct dea_solid_place place, bool **out)
{
  const struct dea_grid *grid = object->grid;
  bool *curve = NULL, *on = dea_alloc(ctx, object->mesh_node_count, sizeof *on);
  *out = NULL;
  dea_status status = on != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK && place.curve != NULL) {
    status = mark_curve(ctx, object->plane, place.curve, &curve);
  }
  for (size_t i = 0; i < place.node_count && status == DEA_OK; i++) {
    if (place.nodes[i] < 0 || (size_t)place.nodes[i] >= object->mesh_node_count) {
      status = dea_fail(ctx, DEA_E_ARGUMENT, "there is no node %d: %zu of them", place.nodes[i],
                        object->mesh_node_count);
    } else {
      on[place.nodes[i]] = true;
    }
  }
  for (size_t n = 0; n < object->mesh_node_count && status == DEA_OK; n++) {
    on[n] = (on[n] || place.nodes == NULL) && (curve == NULL || curve[grid->column[n]]) &&
            is_there(object, place, grid->X + 3 * n);
  }
  dea_free(ctx, curve);
  DEA_TRY_ELSE(ctx, status, dea_free(ctx, on));
  *out = on;
  return DEA_OK;
}

/* Two nodes for each body behind those of the mesh. follows: [nodes of the mesh], of the caller. */
static dea_status mark_body(struct dea_context *ctx, const dea_body *body, int number,
                            const struct dea_solid_object *object, int *follows)
{
  struct dea_solid_place place = {NULL, NULL, body->curve, body->nodes, body->node_count};
  bool *on;
  size_t found = 0;
  for (int i = 0; i < 3; i++) { // both 0: everywhere
    if (body->low_m[i] != 0 || body->high_m[i] != 0) {
      place.low_m = body->low_m;
      place.high_m = body->high_m;
    }
  }
  DEA_TRY(ctx, find_nodes(ctx, object, place, &on));
  for (size_t n = 0; n < object->mesh_node_count; n++) {
    if (on[n]) {
      follows[n] = number;
      found++;
    }
  }
  dea_free(ctx, on);
  return found > 0 ? DEA_OK
                   : dea_fail(ctx, DEA_E_ARGUMENT, "there is no node for body %d", number - 1);
}

/* bodies: [body_count], follows: [all nodes], of the caller. */
static dea_status add_bodies(struct dea_context *ctx, const dea_body *given,
                             struct dea_solid_object *object, struct dea_solid_body *bodies,
                             int *follows)
{
  for (size_t k = 0; k < object->body_count; k++) {
    const double *X = given[k].centre_m;
    const double twice[6] = {X[0], X[1], X[2], X[0], X[1], X[2]};
    DEA_TRY(ctx, mark_body(ctx, &given[k], (int)k + 1, object, follows));
    DEA_TRY(ctx, dea_grid_add_nodes(ctx, object->grid, 2, twice, &bodies[k].node));
  }
  return DEA_OK;
}

// Parts ------------------------------------------------------------------------------------------

/* Of the compressible law where the part has none. */
static dea_status build_part_material(struct dea_context *ctx, const dea_part *part,
                                      struct dea_part_material *out)
{
  double l = part->pre_stretch;
  if (part->law == NULL) {
    *out = dea_part_material_bonded((const double[]){part->young_modulus_Pa, part->poisson_ratio});
  } else {
    *out = (struct dea_part_material){.pre_stretch = {l, l, 1 / (l * l)},
                                      .kappa_Pa = part->bulk_modulus_Pa};
    dea_part_material_set_law(out, dea_law_find(part->law), part->parameters);
  }
  out->permittivity_F_per_m = part->permittivity * DEA_EPSILON_0;
  out->thickness_m = part->electrode_gap_m;
  out->density_kg_per_m3 = part->density_kg_per_m3;
  if (dea_part_material_relax(out) != DEA_OK) {
    return dea_fail(ctx, DEA_E_DOMAIN, "the law '%s' has no stress at a pre-stretch of %g",
                    out->law->name, l);
  }
  return DEA_OK;
}

static int part_material_of(const void *self, int region, int ply)
{
  (void)self;
  (void)ply;
  return region;
}

static bool is_active(const void *self, int region, int ply)
{
  const struct dea_solid_object *object = self;
  (void)ply;
  return object->part_materials[region].thickness_m > 0;
}

static void channels(const void *self, int region, int ply, int *top, int *bottom)
{
  const struct dea_solid_object *object = self;
  (void)ply;
  *top = object->between[region][0];
  *bottom = object->between[region][1];
}

/* Of all parts, and the highest one. */
static dea_status get_channels(struct dea_context *ctx, const dea_part *parts,
                               struct dea_solid_object *object)
{
  enum { CHANNELS_MAX = 1000 };
  object->channel_count = 1;
  for (size_t i = 0; i < object->part_count; i++) {
    int *of = object->between[i];
    of[0] = parts[i].channel_above;
    of[1] = parts[i].channel_below;
    for (int k = 0; k < 2; k++) {
      if (of[k] < 0 || of[k] > CHANNELS_MAX) {
        return dea_fail(ctx, DEA_E_ARGUMENT, "part %zu has the channel %d; 0 to %d are possible", i,
                        of[k], CHANNELS_MAX);
      }
      object->channel_count =
          (size_t)of[k] > object->channel_count ? (size_t)of[k] : object->channel_count;
    }
    of[0] = of[0] == 0 && of[1] == 0 ? 1 : of[0];
  }
  return DEA_OK;
}

static int nothing_held(const void *self, const double X[3])
{
  (void)self;
  (void)X;
  return 0;
}

static void destroy(struct dea_context *ctx, struct dea_solid_object *object)
{
  if (object != NULL) {
    dea_solid_continuation_destroy(ctx, object->path);
    dea_solid_destroy(ctx, object->solid);
    for (size_t i = 0; i < object->spring_count; i++) { // loads of the solid
      dea_arena_free(&object->springs[i].memory);
    }
    dea_free(ctx, object->springs);
    dea_free(ctx, object->spring_values);
    dea_grid_destroy(ctx, object->grid);
    dea_free(ctx, object->part_materials);
    dea_free(ctx, object->between);
    dea_plane_mesh_destroy(ctx, object->plane);
    dea_free(ctx, object->mode_square);
    dea_free(ctx, object->charges);
    dea_free(ctx, object->body_values);
    dea_free(ctx, object);
  }
}

/* With these bodies, in memory of the caller. */
static dea_status build_solid(struct dea_context *ctx, const dea_solid_options *spec,
                              const dea_body *given, struct dea_solid_object *object,
                              struct dea_solid_body *bodies, int *follows)
{
  DEA_TRY(ctx, add_bodies(ctx, given, object, bodies, follows));
  const struct dea_solid_options options = {.order_z = spec->order_z,
                                            .part_material_count = object->part_count,
                                            .part_materials = object->part_materials,
                                            .part_material_of = part_material_of,
                                            .active = is_active,
                                            .channels = channels,
                                            .channel_count = object->channel_count,
                                            .held = nothing_held,
                                            .body_count = spec->body_count,
                                            .bodies = bodies,
                                            .body_of = spec->body_count > 0 ? follows : NULL,
                                            .self = object};
  DEA_TRY(ctx, dea_solid_start(ctx));
  return DEA_CHAIN(ctx, dea_solid_create(ctx, object->grid, &options, &object->solid));
}

static dea_status fill(struct dea_context *ctx, const dea_solid_options *spec,
                       const dea_part *parts, const dea_body *given,
                       struct dea_solid_object *object)
{
  DEA_TRY(ctx, spec->msh_file != NULL  ? build_plies(ctx, spec, &object->plane, &object->grid)
               : spec->elements[0] > 0 ? build_box(ctx, spec, &object->grid)
                                       : build_grid(ctx, spec, &object->grid));
  object->length_m = size_of(object->grid);
  object->mesh_node_count = object->grid->node_count;
  object->part_count = spec->part_count;
  object->part_materials = dea_alloc(ctx, spec->part_count, sizeof *object->part_materials);
  object->between = dea_alloc(ctx, spec->part_count, sizeof *object->between);
  DEA_TRY_MEMORY(object->part_materials != NULL && object->between != NULL);
  DEA_TRY(ctx, get_channels(ctx, parts, object));
  for (size_t i = 0; i < spec->part_count; i++) {
    DEA_TRY(ctx, build_part_material(ctx, &parts[i], &object->part_materials[i]));
  }
  object->body_count = spec->body_count;
  object->body_values = dea_alloc(ctx, 12 * spec->body_count, sizeof(double));
  struct dea_solid_body *bodies = dea_alloc(ctx, spec->body_count, sizeof *bodies);
  int *follows = dea_alloc(ctx, object->mesh_node_count + 2 * spec->body_count, sizeof *follows);
  dea_status status = object->body_values != NULL && bodies != NULL && follows != NULL
                          ? build_solid(ctx, spec, given, object, bodies, follows)
                          : DEA_E_MEMORY;
  dea_free(ctx, bodies);
  dea_free(ctx, follows);
  return status;
}

static dea_status create(struct dea_context *ctx, const dea_solid_options *spec,
                         const dea_part *parts, const dea_body *bodies,
                         struct dea_solid_object **out)
{
  *out = NULL;
  struct dea_solid_object *object = dea_alloc(ctx, 1, sizeof *object);
  DEA_TRY_MEMORY(object != NULL);
  DEA_TRY_ELSE(ctx, fill(ctx, spec, parts, bodies, object), destroy(ctx, object));
  *out = object;
  return DEA_OK;
}

// Supports and loads -----------------------------------------------------------------------------

/* A path moves the solid alone; whatever else is done with it ends the path. */
static void end_path(struct dea_context *ctx, struct dea_solid_object *object)
{
  dea_solid_continuation_destroy(ctx, object->path);
  object->path = NULL;
}

static dea_status hold(struct dea_context *ctx, struct dea_solid_object *object,
                       struct dea_solid_place place, int components, const double *displacement_m)
{
  bool *on;
  size_t found = 0;
  end_path(ctx, object);
  DEA_TRY(ctx, find_nodes(ctx, object, place, &on));
  dea_status status = DEA_OK;
  for (size_t n = 0; n < object->mesh_node_count && status == DEA_OK; n++) {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): find_nodes sets it or fails
    if (on[n]) {
      status = displacement_m != NULL
                   ? dea_solid_prescribe(ctx, object->solid, n, components, displacement_m)
                   : dea_solid_release(ctx, object->solid, n, components);
      found++;
    }
  }
  dea_free(ctx, on);
  DEA_TRY(ctx, status);
  return found > 0 ? DEA_OK : dea_fail(ctx, DEA_E_ARGUMENT, "there is no node in that box");
}

static dea_status check_body(struct dea_context *ctx, const struct dea_solid_object *object,
                             size_t body)
{
  return body < object->body_count
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "there is no body %zu: %zu of them", body,
                        object->body_count);
}

static dea_status hold_body(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                            int components, const double *shift_m, const double *turn_rad)
{
  static const double nothing[3] = {0, 0, 0};
  end_path(ctx, object);
  DEA_TRY(ctx, check_body(ctx, object, body));
  if (shift_m == NULL && turn_rad == NULL) {
    DEA_TRY(ctx, dea_solid_body_release(ctx, object->solid, body, components));
  } else {
    DEA_TRY(ctx, dea_solid_body_prescribe(ctx, object->solid, body, components,
                                          shift_m != NULL ? shift_m : nothing,
                                          turn_rad != NULL ? turn_rad : nothing));
  }
  return DEA_OK;
}

static dea_status push_body(struct dea_context *ctx, struct dea_solid_object *object, size_t body,
                            const double force_N[3], const double moment_N_m[3])
{
  end_path(ctx, object);
  DEA_TRY(ctx, check_body(ctx, object, body));
  dea_solid_body_push(object->solid, body, force_N, moment_N_m);
  return DEA_OK;
}

/* The component of a body that a spring is at [m or rad]. */
static double spring_end(const struct dea_solid_object *object, size_t body, int component)
{
  double place[6];
  dea_solid_body_place(object->solid, body, place, place + 3);
  return place[component];
}

static dea_status add_spring(struct dea_context *ctx, struct dea_solid_object *object,
                             const dea_body_spring *spec)
{
  int component = 0;
  while (component < 6 && spec->component != 1 << component) {
    component++;
  }
  end_path(ctx, object);
  DEA_TRY(ctx, check_body(ctx, object, spec->body));
  if (component > 5 || !isfinite(spec->place)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a spring holds one component of a body at a place");
  }
  size_t count = object->spring_count + 1;
  struct held_spring *springs = dea_resize(ctx, object->springs, count, sizeof *springs);
  object->springs = springs != NULL ? springs : object->springs;
  double *values = dea_resize(ctx, object->spring_values, 2 * count, sizeof *values);
  object->spring_values = values != NULL ? values : object->spring_values;
  DEA_TRY_MEMORY(springs != NULL && values != NULL);
  const struct dea_solid_body *body = &object->solid->problem.bodies[spec->body];
  const struct dea_spring_options options = {.node = body->node + (size_t)component / 3,
                                             .component = component % 3,
                                             .unit_m = component < 3 ? 1 : body->length_m,
                                             .place = spring_end(object, spec->body, component),
                                             .stiffness = spec->stiffness,
                                             .count = spec->count,
                                             .at = spec->at,
                                             .force = spec->force};
  struct held_spring one = {.memory = {.ctx = ctx}, .body = spec->body, .component = component};
  dea_status status = dea_spring_create(ctx, &options, &one.memory, &one.spring);
  if (status == DEA_OK) {
    const struct dea_solid_load load = dea_spring_load(one.spring);
    status = dea_solid_add_load(ctx, object->solid, &load);
  }
  DEA_TRY_ELSE(ctx, status, dea_arena_free(&one.memory));
  dea_spring_move(one.spring, spec->place);
  springs[object->spring_count++] = one;
  return DEA_OK;
}

static dea_status move_spring(struct dea_context *ctx, struct dea_solid_object *object,
                              size_t spring, double place)
{
  end_path(ctx, object);
  if (spring >= object->spring_count || !isfinite(place)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "spring %zu to %g: there are %zu springs", spring, place,
                    object->spring_count);
  }
  dea_spring_move(object->springs[spring].spring, place);
  return DEA_OK;
}

/* What springs pull back by. */
static const double *find_springs(struct dea_solid_object *object)
{
  size_t count = object->spring_count;
  for (size_t i = 0; i < count; i++) {
    const struct held_spring *held = &object->springs[i];
    double x = spring_end(object, held->body, held->component);
    double pull = dea_spring_force(held->spring, x);
    object->spring_values[i] = held->component < 3 ? pull : NAN;
    object->spring_values[count + i] = held->component < 3 ? NAN : pull;
  }
  return count > 0 ? object->spring_values : NULL;
}

/* Where the bodies are and what holds them. */
static const double *find_bodies(struct dea_solid_object *object)
{
  size_t count = object->body_count;
  double *values = object->body_values;
  for (size_t k = 0; k < count; k++) {
    dea_solid_body_place(object->solid, k, values + 3 * k, values + 3 * (count + k));
    dea_solid_body_reaction(object->solid, k, values + 3 * (2 * count + k),
                            values + 3 * (3 * count + k));
  }
  return count > 0 ? values : NULL;
}

static dea_status set(struct dea_context *ctx, struct dea_solid_object *object, const char *name,
                      double value)
{
  return DEA_CHAIN(ctx,
                   dea_solid_settings_set(ctx, dea_solid_settings_of(object->solid), name, value));
}

static bool setting(const struct dea_solid_object *object, size_t number, dea_solid_setting *out)
{
  double value;
  const struct dea_solid_setting *found =
      dea_solid_settings_at(dea_solid_settings_of(object->solid), number, &value);
  if (found != NULL) {
    *out = (dea_solid_setting){found->name, found->unit, found->meaning, value};
  }
  return found != NULL;
}

struct selection {
  const struct dea_solid_object *object;
  struct dea_solid_place place;
};

static bool is_selected(const void *self, int region, int ply, const double middle[3])
{
  const struct selection *selection = self;
  (void)region;
  (void)ply;
  return is_there(selection->object, selection->place, middle);
}

static dea_status pull(struct dea_context *ctx, struct dea_solid_object *object,
                       struct dea_solid_place place, const double traction_Pa[3])
{
  const struct selection selection = {object, place};
  struct dea_arena memory = {.ctx = ctx};
  size_t found = 0;
  dea_status status = DEA_OK;
  end_path(ctx, object);
  for (int side = 0; side < FACES && status == DEA_OK; side++) {
    struct dea_surface *surface;
    status = dea_surface_create(ctx, object->grid, (enum dea_face)side, is_selected, &selection,
                                &memory, &surface);
    if (status == DEA_OK) {
      dea_load_traction(surface, traction_Pa, dea_solid_force(object->solid));
      found += surface->face_count;
    }
    status = status == DEA_E_ARGUMENT ? DEA_OK : status; // none of this side
  }
  dea_arena_free(&memory);
  DEA_TRY(ctx, status);
  if (found == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "there is no face of an element in that box");
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

// Solutions --------------------------------------------------------------------------------------

static dea_status set_channel(struct dea_context *ctx, struct dea_solid_object *object, int channel,
                              double voltage_V)
{
  end_path(ctx, object);
  if (channel < 1 || (size_t)channel > object->channel_count || !isfinite(voltage_V)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "channel %d at %g V: there are channels 1 to %zu", channel,
                    voltage_V, object->channel_count);
  }
  dea_solid_own_voltages(object->solid)[channel] = voltage_V;
  return DEA_OK;
}

static void forget_charges(struct dea_context *ctx, struct dea_solid_object *object)
{
  dea_free(ctx, object->charges);
  object->charges = NULL;
}

static dea_status find_charges(struct dea_context *ctx, struct dea_solid_object *object)
{
  size_t n = object->channel_count + 1;
  forget_charges(ctx, object);
  double *all = dea_alloc(ctx, 2 * n + 2 * n * n, sizeof *all);
  DEA_TRY_MEMORY(all != NULL);
  dea_solid_channel_voltages(object->solid, all);
  DEA_TRY_ELSE(ctx, dea_solid_flows(ctx, object->solid, NULL, all + n, NULL), dea_free(ctx, all));
  for (size_t free = 0; free < 2; free++) {
    DEA_TRY_ELSE(ctx,
                 dea_solid_capacitances(ctx, object->solid, free == 0, all + 2 * n + free * n * n),
                 dea_free(ctx, all));
  }
  object->charges = all;
  return DEA_OK;
}

static dea_status solve(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V)
{
  end_path(ctx, object);
  forget_charges(ctx, object);
  return DEA_CHAIN(ctx, dea_load_steps_solve(ctx, object->solid, voltage_V, &object->report));
}

static dea_status modes(struct dea_context *ctx, struct dea_solid_object *object, size_t count)
{
  size_t dofs = 3 * object->grid->node_count;
  if (count == 0 || count > DEA_MODES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "1 to %d modes, not %zu", DEA_MODES_MAX, count);
  }
  double *square = dea_alloc(ctx, count * (1 + dofs), sizeof *square);
  DEA_TRY_MEMORY(square != NULL);
  double *shape = square + count;
  DEA_TRY_ELSE(ctx,
               dea_solid_modes_lowest(ctx, object->solid, DEA_MODES_BY_MASS, count, square, shape),
               dea_free(ctx, square));
  dea_free(ctx, object->mode_square);
  for (size_t i = 0; i < count; i++) { // omega^2 -> f, negative where it is unstable
    square[i] = copysign(sqrt(fabs(square[i])), square[i]) / (2 * DEA_PI);
  }
  object->mode_square = square;
  object->mode_shape = shape;
  object->mode_count = count;
  return DEA_OK;
}

static dea_status path(struct dea_context *ctx, struct dea_solid_object *object, double voltage_V,
                       double step, double unit_m)
{
  end_path(ctx, object);
  const struct dea_continuation_options options = {.step = step, .unit_m = unit_m};
  object->point = (struct dea_continuation_point){.voltage_V = dea_solid_voltage(object->solid)};
  return DEA_CHAIN(
      ctx, dea_solid_continuation_create(ctx, object->solid, voltage_V, &options, &object->path));
}

static dea_status step(struct dea_context *ctx, struct dea_solid_object *object)
{
  if (object->path == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no path was begun, or something else ended it");
  }
  forget_charges(ctx, object);
  DEA_TRY(ctx, dea_solid_continuation_step(ctx, object->path, &object->point));
  object->report.energy_J = object->point.energy_J;
  object->report.unstable_modes = object->point.unstable_modes;
  object->report.iterations = object->point.iterations;
  return DEA_OK;
}

static dea_status array(struct dea_context *ctx, struct dea_solid_object *object, const char *name,
                        dea_array *out)
{
  size_t n = object->grid->node_count, c = object->channel_count + 1;
  size_t b = object->body_count;
  const double *charges = object->charges;
  const double *values = strncmp(name, "body_", strlen("body_")) == 0 ? find_bodies(object) : NULL;
  size_t k = object->spring_count;
  const double *pull =
      strncmp(name, "spring_", strlen("spring_")) == 0 ? find_springs(object) : NULL;
  const struct {
    const char *name, *unit;
    const double *data;
    size_t shape[3];
  } all[] = {
      {"points_m", "m", object->grid->X, {n, 3}},
      {"displacement_m", "m", dea_solid_displacement(object->solid), {n, 3}},
      {"reaction_N", "N", dea_solid_reaction(object->solid), {n, 3}},
      {"force_N", "N", dea_solid_force(object->solid), {n, 3}},
      {"mode_Hz", "Hz", object->mode_square, {object->mode_count, 0}},
      {"mode_shape", "kg^-1/2", object->mode_shape, {object->mode_count, n, 3}},
      {"body_shift_m", "m", values, {b, 3}},
      {"body_turn_rad", "rad", values != NULL ? values + 3 * b : NULL, {b, 3}},
      {"body_force_N", "N", values != NULL ? values + 6 * b : NULL, {b, 3}},
      {"body_moment_N_m", "N m", values != NULL ? values + 9 * b : NULL, {b, 3}},
      {"spring_force_N", "N", pull, {k, 0}},
      {"spring_moment_N_m", "N m", pull != NULL ? pull + k : NULL, {k, 0}},
      {"channel_V", "V", charges, {c, 0}},
      {"charge_C", "C", charges != NULL ? charges + c : NULL, {c, 0}},
      {"capacitance_held_F", "F", charges != NULL ? charges + 2 * c : NULL, {c, c}},
      {"capacitance_F", "F", charges != NULL ? charges + 2 * c + c * c : NULL, {c, c}},
  };
  const char *known[sizeof all / sizeof all[0]];
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    known[i] = all[i].name;
    if (strcmp(all[i].name, name) == 0 && all[i].data != NULL) {
      *out =
          (dea_array){.name = all[i].name, .unit = all[i].unit, .meaning = "", .data = all[i].data};
      for (int d = 0; d < 3; d++) {
        out->rank += all[i].shape[d] > 0;
        out->shape[d] = all[i].shape[d] > 0 ? all[i].shape[d] : 1;
      }
      return DEA_OK;
    }
  }
  return dea_unknown_name(ctx, "array", name, known, sizeof all / sizeof all[0]);
}

static dea_status mesh(struct dea_context *ctx, const struct dea_solid_object *object,
                       struct dea_field_mesh **out)
{
  return DEA_CHAIN(ctx, dea_solid_fields(ctx, object->solid, DEA_ALL_PLIES, out));
}

static dea_status number(struct dea_context *ctx, const struct dea_solid_object *object,
                         const char *name, double *out)
{
  const struct {
    const char *name;
    double value;
  } all[] = {
      {"voltage_V", dea_solid_voltage(object->solid)},
      {"energy_J", object->report.energy_J},
      {"unstable_modes", object->report.unstable_modes},
      {"iterations", object->report.iterations},
      {"load", object->point.load},
      {"arc", object->point.arc},
  };
  const char *known[sizeof all / sizeof all[0]];
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    known[i] = all[i].name;
    if (strcmp(all[i].name, name) == 0) {
      *out = all[i].value;
      return DEA_OK;
    }
  }
  return dea_unknown_name(ctx, "number", name, known, sizeof all / sizeof all[0]);
}

extern DEA_MODULE_SYMBOL const struct dea_own_mesh dea_own_mesh;

const struct dea_own_mesh dea_own_mesh = {.create = create,
                                          .destroy = destroy,
                                          .set = set,
                                          .setting = setting,
                                          .hold = hold,
                                          .hold_body = hold_body,
                                          .push_body = push_body,
                                          .add_spring = add_spring,
                                          .move_spring = move_spring,
                                          .pull = pull,
                                          .set_channel = set_channel,
                                          .solve = solve,
                                          .find_charges = find_charges,
                                          .modes = modes,
                                          .path = path,
                                          .step = step,
                                          .array = array,
                                          .mesh = mesh,
                                          .number = number};
