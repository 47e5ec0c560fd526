/* Weight, bodies, supports and loads of the model "3d", and its way from the flat state to rest. */
#include "model/solid/equilibrium/load_steps.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double no_motion[3] = {0};

// Weight ------------------------------------------------------------------------------------------

bool dea_solid_has_weight(const struct dea_layout *l)
{
  const double *g = l->gravity_m_per_s2;
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

/* Before anything that takes densities: a disc says where the film's is taken for another one. */
dea_status dea_solid_check_densities(struct dea_context *ctx, const struct dea_model *model)
{
  const struct dea_device *d = model->device;
  const bool electrodes = d->electrode_thickness_m > 0 && !(d->electrode.density_kg_per_m3 > 0);
  const bool glue = d->fibre_count > 0 && d->bond_thickness_m > 0;
  const char *const unknown[2] = {electrodes ? "electrodes" : NULL, glue ? "glue" : NULL};
  DEA_TRY(ctx, dea_device_check_densities(ctx, d));
  for (int i = 0; i < 2; i++) {
    if (unknown[i] != NULL) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                   "model 3d: the density of the %s is unknown; that of the film, "
                                   "%.4g kg/m^3, is taken",
                                   unknown[i], d->film.density_kg_per_m3));
    }
  }
  return DEA_OK;
}

// Bodies -----------------------------------------------------------------------------------------

enum { ALL_COMPONENTS = 63 };

/* Numbers of the nodes that move with a body into follows [all nodes], counted from 1. */
static dea_status mark_body(struct dea_context *ctx, struct dea_model *model, size_t i,
                            size_t *found)
{
  const struct dea_layout_body *body = &model->layout->bodies[i];
  dea_layout_mesh_mark(&model->mesh, body->region, false, DEA_LAYOUT_NONE, model->on);
  *found = 0;
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->on[model->mesh.grid->column[n]]) {
      model->follows[n] = (int)i + 1;
      ++*found;
    }
  }
  if (*found == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, body->location,
                                 "body '%s': no ply is in its shape '%s'", body->name,
                                 model->layout->regions[body->region].name));
    return dea_fail(ctx, DEA_E_DESIGN, "nothing moves with the body '%s'", body->name);
  }
  return DEA_OK;
}

/* The body's nodes at the centroid of its region, in the middle of what moves with it. */
static dea_status add_body(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_body *body = &model->layout->bodies[i];
  struct dea_grid *grid = model->mesh.grid;
  double X[6], low = INFINITY, high = -INFINITY, length = 0;
  int keeps = dea_layout_sector_keeps(&model->mesh.sector);
  dea_region_centroid_m(&model->layout->regions[body->region].region, X);
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == (int)i + 1) {
      low = fmin(low, grid->X[3 * n + 2]);
      high = fmax(high, grid->X[3 * n + 2]);
      length = fmax(length, hypot(grid->X[3 * n] - X[0], grid->X[3 * n + 1] - X[1]));
    }
  }
  X[2] = 0.5 * (low + high);
  memcpy(X + 3, X, 3 * sizeof *X);
  DEA_TRY(ctx, dea_grid_add_nodes(ctx, grid, 2, X, &model->bodies[i].node));
  model->bodies[i].held = ALL_COMPONENTS & ~((body->free | body->moved) & keeps);
  // unknowns of a turn stay in the same unit when slopes are taken
  model->bodies[i].length_m =
      model->variant != NULL ? model->variant->own.bodies[i].length_m : length;
  return DEA_OK;
}

dea_status dea_solid_bodies_add(struct dea_context *ctx, struct dea_model *model,
                                double **point_mass)
{
  const struct dea_layout *l = model->layout;
  size_t capacity = model->mesh_node_count + 2 * l->body_count;
  model->on = dea_arena_alloc(&model->memory, model->mesh.plane->node_count, sizeof *model->on);
  model->follows = dea_arena_alloc(&model->memory, capacity, sizeof *model->follows);
  *point_mass = dea_arena_alloc(&model->memory, capacity, sizeof **point_mass);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t i = 0; i < l->body_count; i++) {
    size_t found;
    DEA_TRY(ctx, mark_body(ctx, model, i, &found));
    for (size_t n = 0; n < model->mesh_node_count; n++) {
      if (model->follows[n] == (int)i + 1) {
        (*point_mass)[n] = l->bodies[i].mass_kg / model->copies / (double)found;
      }
    }
  }
  for (size_t i = 0; i < l->body_count; i++) {
    DEA_TRY(ctx, add_body(ctx, model, i));
  }
  return DEA_OK;
}

// Supports and loads -----------------------------------------------------------------------------

/* Holds the nodes of a support that no body moves, where they are or at its shift. */
static dea_status hold(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_layout_support *support, bool moved)
{
  bool *on = model->on;
  const int *follows = model->follows;
  const struct dea_grid *grid = model->mesh.grid;
  size_t held = 0;
  const size_t plies = support->plies;
  const double near_m = 1e-6 * model->layout->plies[model->plies.film].thickness_m;
  const double up_to_m = plies > 0 ? model->mesh.face_m[plies - 1][1] + near_m : INFINITY;
  dea_layout_mesh_mark(&model->mesh, support->region, support->edge, support->within, on);
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    bool lowest = n == 0 || grid->column[n] != grid->column[n - 1];
    bool here = on[grid->column[n]] && follows[n] == 0 && (!support->hinged || lowest);
    if (here && grid->X[3 * n + 2] <= up_to_m) {
      double Q[9], move_m[3] = {0};
      dea_layout_sector_holds(&model->mesh.sector, grid->X + 3 * n, model->mesh.near_m, Q);
      for (int k = 0; k < 9 && moved; k++) {
        move_m[k / 3] += Q[k] * support->move_m[k % 3];
      }
      DEA_TRY(ctx, dea_solid_prescribe(ctx, model->solid, n, support->components, move_m));
      held++;
    }
  }
  if (held == 0 &&
      !dea_layout_mesh_marks_copy(&model->mesh, support->region, support->edge, support->within)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, support->location,
                                 "this support holds nothing: no ply is there"));
    return dea_fail(ctx, DEA_E_DESIGN, "a support holds nothing");
  }
  return DEA_OK;
}

static dea_status add_spring(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_spring *spring = &model->layout->springs[i];
  const struct dea_solid_body *body = &model->bodies[spring->body];
  bool turns = spring->component >= 3;
  double *force = dea_arena_alloc(&model->memory, spring->count, sizeof *force);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t k = 0; k < spring->count; k++) {
    force[k] = spring->force[k] / model->copies;
  }
  const struct dea_spring_options options = {
      .node = body->node + (turns ? 1 : 0),
      .component = spring->component % 3,
      .unit_m = turns ? body->length_m : 0,
      .place = spring->free_at,
      .stiffness = spring->stiffness / model->copies,
      .count = spring->count,
      .at = spring->at,
      .force = force,
  };
  struct dea_spring *made;
  DEA_TRY(ctx, dea_spring_create(ctx, &options, &model->memory, &made));
  const struct dea_solid_load load = dea_spring_load(made);
  return DEA_CHAIN(ctx, dea_solid_add_load(ctx, model->solid, &load));
}

/* What a liquid's volume is exact to, over the root of the third power of its face's area. */
static const double least_volume = 1e-3;

/* Who a surface is asked for. */
struct face_of {
  const struct dea_model *model;
  size_t region, ply;
  double height_m; // of the face, z
};

static bool is_loaded(const void *self, int region, int ply, const double middle[3])
{
  const struct face_of *of = self;
  const struct dea_layout_mesh *mesh = &of->model->mesh;
  // between the elements through a ply there are faces too
  bool outermost =
      fabs(middle[2] - of->height_m) < 1e-6 * of->model->layout->plies[of->ply].thickness_m;
  return (size_t)ply == of->ply && outermost &&
         dea_layout_mesh_is_within(mesh, (size_t)region, of->region);
}

/* A face of a ply in a region. */
static dea_status create_face(struct dea_context *ctx, struct dea_model *model, size_t region,
                              size_t ply, bool top, struct dea_surface **out)
{
  const struct face_of of = {model, region, ply, model->mesh.face_m[ply][top ? 1 : 0]};
  return DEA_CHAIN(ctx,
                   dea_surface_create(ctx, model->mesh.grid, top ? DEA_FACE_TOP : DEA_FACE_BOTTOM,
                                      is_loaded, &of, &model->memory, out));
}

/* What the sector has of an enclosed volume, below a face of that area. In the iterations a liquid
 * gives way some hundred times less than the film: 8 T/(pi R^4) of a tension T about mu h. */
static void enclose(struct dea_model *model, size_t i, double area_m2)
{
  static const double stiff = 300;
  const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
  const double copies = model->copies, whole_m2 = copies * area_m2;
  double modulus_N_per_m = 0;
  for (size_t k = 0; k < model->layout->ply_count; k++) {
    modulus_N_per_m += dea_part_material_modulus(&model->plies.part_materials[k]) *
                       model->layout->plies[k].thickness_m;
  }
  const struct dea_enclosed enclosed = {
      .liquid = pressure->encloses == DEA_LIQUID,
      .volume_m3 = (pressure->encloses == DEA_GAS ? pressure->volume_m3
                                                  : least_volume * pow(whole_m2, 1.5)) /
                   copies,
      .ambient_Pa = pressure->ambient_Pa,
      .stiffness_Pa_per_m3 = copies * stiff * 8 * DEA_PI * modulus_N_per_m / (whole_m2 * whole_m2)};
  if (pressure->encloses != DEA_OPEN) {
    dea_pressure_enclose(model->pressures[i], &enclosed);
  }
}

/* Of a sector without a face in it: none. */
static dea_status add_pressure(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
  struct dea_surface *surface;
  if (model->mesh.group[pressure->region] == DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  DEA_TRY(ctx, create_face(ctx, model, pressure->region, pressure->ply, pressure->top, &surface));
  const double on_it_m[3] = {0, 0, model->mesh.grid->X[3 * surface->nodes[0] + 2]};
  DEA_TRY(ctx,
          dea_pressure_create(ctx, surface, on_it_m, true, &model->memory, &model->pressures[i]));
  enclose(model, i, dea_surface_area(surface));
  const struct dea_solid_load load = dea_pressure_load(model->pressures[i]);
  return DEA_CHAIN(ctx, dea_solid_add_load(ctx, model->solid, &load));
}

/* All pressures at once, times a factor. */
void dea_solid_pressures_set(const struct dea_model *model, double factor)
{
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL) {
      const struct dea_layout_pressure *pressure = &model->layout->pressures[i];
      dea_pressure_set(model->pressures[i], factor * (pressure->encloses == DEA_LIQUID
                                                          ? pressure->volume_m3 / model->copies
                                                          : pressure->pressure_Pa));
    }
  }
}

/* The force and moment on a body, or the sector's part of them. */
void dea_solid_body_load(const struct dea_model *model, size_t body, const double push[6])
{
  double part[6];
  for (int k = 0; k < 6; k++) {
    part[k] = push[k] / model->copies;
  }
  dea_solid_body_push(model->solid, body, part, part + 3);
}

dea_status dea_solid_bodies_load(struct dea_context *ctx, struct dea_model *model)
{
  for (size_t i = 0; i < model->layout->body_count; i++) {
    const struct dea_layout_body *body = &model->layout->bodies[i];
    memcpy(model->push[i], body->force_N, sizeof body->force_N);
    memcpy(model->push[i] + 3, body->moment_N_m, sizeof body->moment_N_m);
    dea_solid_body_load(model, i, model->push[i]);
    if (body->moved != 0) {
      DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, i, body->moved, body->shift_m,
                                            body->turn_rad));
    }
  }
  return DEA_OK;
}

/* The weight of plies and bodies as the dead loads, none without it. */
static dea_status set_weight(struct dea_context *ctx, const struct dea_model *model)
{
  size_t count = 3 * model->mesh.grid->node_count;
  double *force = dea_solid_force(model->solid);
  if (!dea_solid_has_weight(model->layout)) {
    memset(force, 0, count * sizeof *force);
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_check_densities(ctx, model));
  double *fall = dea_solid_alloc(ctx, count, sizeof *fall);
  DEA_TRY_MEMORY(fall != NULL);
  for (size_t i = 0; i < 3 * model->mesh_node_count; i++) {
    fall[i] = model->layout->gravity_m_per_s2[i % 3];
  }
  dea_status status = dea_solid_mass_apply(ctx, model->solid, fall, force);
  dea_free(ctx, fall);
  return status;
}

// Dead forces of supports -------------------------------------------------------------------------

/* Nodes as points of their own rule, in the plane and through the thickness. */
struct rule {
  struct dea_face_shape plane, column;
};

static void build_rule(const struct dea_grid *g, struct rule *out)
{
  const int orders[2] = {g->order, g->order_z};
  for (int i = 0; i < 2; i++) {
    dea_face_shape_create((const int[2]){orders[i], orders[i]}, DEA_FACE_AT_NODES,
                          i == 0 ? &out->plane : &out->column);
  }
}

/* Area of an element by its nodes in the plane, all of them marked, and length of its sides whose
 * nodes are. X: [nodes in the plane][3]. */
static void measure(const struct dea_grid *g, const struct dea_face_shape *plane, bool edge,
                    const bool *marked, const int *nodes, double *part)
{
  const int last = g->order, per = last + 1, count = per * per;
  double X[3 * DEA_FACE_NODES_MAX], line[DEA_FACE_NODES_MAX] = {0};
  bool on[2][2] = {{true, true}, {true, true}}, all = true; // sides: axis across, low and high
  for (int n = 0; n < count; n++) {
    const int at[2] = {n % per, n / per};
    const bool marks = marked[g->column[nodes[n]]];
    memcpy(X + 3 * n, g->X + 3 * nodes[n], 3 * sizeof *X);
    line[at[0]] += plane->weight[n];
    all = all && marks;
    for (int a = 0; a < 2; a++) {
      on[a][0] = on[a][0] && (marks || at[a] != 0);
      on[a][1] = on[a][1] && (marks || at[a] != last);
    }
  }
  for (int n = 0; n < count; n++) {
    const int at[2] = {n % per, n / per};
    double normal[3];
    dea_face_normal(plane, n, X, normal);
    part[n] = !edge && all ? plane->weight[n] * normal[2] : 0;
    for (int a = 0; edge && a < 2; a++) {
      double t[2] = {0}; // along the side
      for (int m = 0; m < count; m++) {
        t[0] += plane->slope[n][1 - a][m] * X[3 * m];
        t[1] += plane->slope[n][1 - a][m] * X[3 * m + 1];
      }
      const bool here = (at[a] == 0 && on[a][0]) || (at[a] == last && on[a][1]);
      part[n] += here ? line[at[1 - a]] * hypot(t[0], t[1]) : 0;
    }
  }
}

/* Adds the shares of an element's nodes; returns their sum. */
static double add_element(const struct dea_layout_mesh *mesh, size_t e, bool edge,
                          const bool *marked, const struct rule *rule, double *share)
{
  const struct dea_grid *g = mesh->grid;
  const int *nodes = g->nodes + e * DEA_HEX_NODES_MAX;
  const int count = (g->order + 1) * (g->order + 1), levels = g->levels[e];
  double part[DEA_FACE_NODES_MAX], total = 0;
  measure(g, &rule->plane, edge, marked, nodes, part);
  for (int n = 0; n < count; n++) {
    const int top = nodes[n + count * (levels - 1)];
    const double height_m = levels == 1 ? mesh->layout->plies[g->ply[e]].thickness_m
                                        : g->X[3 * top + 2] - g->X[3 * nodes[n] + 2];
    for (int k = 0; k < levels; k++) {
      double weight = levels == 1 ? 1 : 0;
      for (int i = 0; i < levels && levels > 1; i++) {
        weight += rule->column.weight[k + i * levels];
      }
      share[nodes[n + k * count]] += part[n] * height_m * weight;
      total += part[n] * height_m * weight;
    }
  }
  return total;
}

/* Adds the consistent nodal forces of a support, or the sector's part of them
 * (docs/theory/loads.md): spread evenly over the plies' sides along an edge, of the elements within
 * it where there are any, or over their volume. flagged: room, [node_count of the plane mesh];
 * force: [nodes][3] [N]. */
static dea_status add_dead_force(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const struct dea_layout_support *support, bool *flagged,
                                 double *force)
{
  const struct dea_grid *g = mesh->grid;
  double *share = dea_alloc(ctx, g->node_count, sizeof *share), total = 0;
  struct rule rule;
  DEA_TRY_MEMORY(share != NULL);
  build_rule(g, &rule);
  dea_layout_mesh_mark(mesh, support->region, support->edge, support->within, flagged);
  for (int inside = 1; inside >= 0 && total == 0; inside--) { // an edge has two sides
    for (size_t e = 0; e < g->element_count; e++) {
      if (dea_layout_mesh_within(mesh, e, support->region) == (inside != 0)) {
        total += add_element(mesh, e, support->edge, flagged, &rule, share);
      }
    }
  }
  total *= (double)dea_layout_sector_copies(&mesh->sector);
  for (size_t n = 0; n < g->node_count; n++) {
    double Q[9]; // a node on a side of the sector may have axes of its own
    if (share[n] > 0) {
      dea_layout_sector_holds(&mesh->sector, g->X + 3 * n, mesh->near_m, Q);
      for (size_t k = 0; k < 9; k++) {
        force[3 * n + k / 3] += share[n] / total * Q[k] * support->force_N[k % 3];
      }
    }
  }
  dea_free(ctx, share);
  return DEA_OK;
}

dea_status dea_solid_dead_loads_set(struct dea_context *ctx, const struct dea_model *model)
{
  DEA_TRY(ctx, set_weight(ctx, model));
  for (size_t i = 0; i < model->layout->support_count; i++) {
    const struct dea_layout_support *support = &model->layout->supports[i];
    if (dea_support_pulls(support)) {
      DEA_TRY(ctx,
              add_dead_force(ctx, &model->mesh, support, model->on, dea_solid_force(model->solid)));
    }
  }
  return DEA_OK;
}

void dea_solid_liquids_stiffen(const struct dea_model *model, bool stiff)
{
  static const double times = 1e3;
  for (size_t i = 0; i < model->layout->pressure_count; i++) {
    if (model->pressures[i] != NULL && model->layout->pressures[i].encloses == DEA_LIQUID) {
      dea_pressure_stiffen(model->pressures[i], dea_solid_displacement(model->solid),
                           stiff ? times : 1 / times);
      dea_solid_forget(model->solid);
    }
  }
}

/* Of a sector without a face in it: none. */
static dea_status create_contact(struct dea_context *ctx, struct dea_model *model, size_t i)
{
  static const double stiffness_Pa_per_m = 1e10; // the answer does not depend on it (indent.c)
  const struct dea_layout_contact *c = &model->layout->contacts[i];
  struct dea_surface *surface, *other = NULL;
  const double side = c->top ? 1 : -1;
  if (model->mesh.group[c->region] == DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  DEA_TRY(ctx, create_face(ctx, model, c->region, c->ply, c->top, &surface));
  if (c->with != DEA_LAYOUT_NONE) {
    DEA_TRY(ctx, create_face(ctx, model, c->region, c->with, !c->top, &other));
  }
  const struct dea_contact_options options = {
      .tip = {.shape = DEA_INDENTER_PLANE,
              .radius_m = model->layout->plies[c->ply].thickness_m,
              .axis = {0, 0, side}},
      .place_m = {0, 0, model->mesh.face_m[c->ply][c->top ? 1 : 0] + side * c->gap_m},
      .other = other,
      .stiffness_Pa_per_m = stiffness_Pa_per_m};
  return DEA_CHAIN(ctx,
                   dea_contact_create(ctx, surface, &options, &model->memory, &model->contacts[i]));
}

dea_status dea_solid_contacts_create(struct dea_context *ctx, struct dea_model *model,
                                     struct dea_solid_load **loads, size_t *count)
{
  const size_t all = model->layout->contact_count;
  model->contacts = dea_arena_alloc(&model->memory, all, sizeof(struct dea_contact *));
  *loads = dea_arena_alloc(&model->memory, all, sizeof **loads);
  *count = 0;
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t i = 0; i < all; i++) {
    DEA_TRY(ctx, create_contact(ctx, model, i));
    if (model->contacts[i] != NULL) {
      (*loads)[(*count)++] = dea_contact_load(model->contacts[i]);
    }
  }
  return DEA_OK;
}

dea_status dea_solid_contacts_check(struct dea_context *ctx, struct dea_model *model)
{
  static const double most = 0.1; // of a face: forces are within some per cent (theory/loads.md)
  const double *u = dea_solid_displacement(model->solid);
  for (size_t i = 0; i < model->layout->contact_count && !model->slid; i++) {
    const struct dea_layout_contact *c = &model->layout->contacts[i];
    const double slide = model->contacts[i] != NULL ? dea_contact_slide(model->contacts[i], u) : 0;
    if (slide > most) {
      model->slid = true;
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, c->location,
                                   "model 3d: ply '%s' slides over ply '%s' by %.2g of an element, "
                                   "and each point stays with the element that it is opposite to "
                                   "when flat: forces of the contact are rough",
                                   model->layout->plies[c->ply].name,
                                   model->layout->plies[c->with].name, slide));
    }
  }
  return DEA_OK;
}

dea_status dea_solid_loads_add(struct dea_context *ctx, struct dea_model *model)
{
  const struct dea_layout *l = model->layout;
  model->pressures = dea_arena_alloc(&model->memory, l->pressure_count, sizeof *model->pressures);
  DEA_TRY(ctx, dea_arena_status(&model->memory));
  for (size_t i = 0; i < l->spring_count; i++) {
    DEA_TRY(ctx, add_spring(ctx, model, i));
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    DEA_TRY(ctx, add_pressure(ctx, model, i));
  }
  return DEA_OK;
}

// Release ----------------------------------------------------------------------------------------

enum { ALL = 7 }; // components of a node

static int free_components(const struct dea_model *model, size_t body)
{
  return ALL_COMPONENTS & ~model->bodies[body].held;
}

/* The flat state, everything held in it. */
static dea_status hold_all(struct dea_context *ctx, struct dea_model *model)
{
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == 0) {
      DEA_TRY(ctx, dea_solid_prescribe(ctx, model->solid, n, ALL & ~model->on_side[n], no_motion));
    }
  }
  for (size_t i = 0; i < model->layout->body_count; i++) {
    DEA_TRY(ctx, dea_solid_body_prescribe(ctx, model->solid, i, free_components(model, i),
                                          no_motion, no_motion));
  }
  return DEA_OK;
}

/* Supports only; moved: with their own shifts. */
dea_status dea_solid_supports_hold(struct dea_context *ctx, struct dea_model *model, bool moved)
{
  for (size_t n = 0; n < model->mesh_node_count; n++) {
    if (model->follows[n] == 0) {
      DEA_TRY(ctx, dea_solid_release(ctx, model->solid, n, ALL & ~model->on_side[n]));
    }
  }
  for (size_t i = 0; i < model->layout->body_count; i++) {
    DEA_TRY(ctx, dea_solid_body_release(ctx, model->solid, i, free_components(model, i)));
  }
  for (size_t i = 0; i < model->layout->support_count; i++) {
    DEA_TRY(ctx, hold(ctx, model, &model->layout->supports[i], moved));
  }
  return DEA_OK;
}

/* Lowest stiffness at the equilibrium where the solid is, per volume; NAN: it cannot be had. */
static double lowest_stiffness(struct dea_context *ctx, struct dea_model *model)
{
  double value;
  if (dea_solid_modes_lowest(ctx, model->solid, DEA_MODES_BY_VOLUME, 1, &value, NULL) != DEA_OK) {
    dea_context_clear(ctx);
    return NAN;
  }
  return value;
}

/* The pressures have a limit where the stiffness goes to 0 with them: near it as the root of what
 * is missing, so that at the last equilibrium that was found it is far below that at half of the
 * pressure, where the solid is left. */
static dea_status explain_pressure(struct dea_context *ctx, struct dea_model *model,
                                   dea_status status)
{
  static const double falls = 0.25, least = 1e-3; // of the stiffness; step, of the pressure found
  const struct dea_layout_pressure *pressure = &model->layout->pressures[0];
  char why[160];
  double reached = model->at.report.load_factor;
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  dea_solid_pressures_set(model, fmin(1, 1.1 * reached)); // closer to where it ends
  if (dea_load_steps_solve_within(ctx, model->solid, 0, 10 * least, &model->at.report) == DEA_OK) {
    return dea_fail(ctx, status, "%s", why);
  }
  reached += model->at.report.load_factor * (fmin(1, 1.1 * reached) - reached);
  const double low = lowest_stiffness(ctx, model);
  dea_solid_pressures_set(model, 0.5 * reached);
  const double half = dea_load_steps_solve(ctx, model->solid, 0, &model->at.report) == DEA_OK
                          ? lowest_stiffness(ctx, model)
                          : NAN;
  if (!(low < falls * half)) {
    return dea_fail(ctx, status, "%s", why);
  }
  return dea_fail(ctx, status,
                  "a limit of the pressure: the film bears no more than about %.4g Pa of %.4g Pa, "
                  "where its lowest stiffness falls towards 0 (%.2g of that at half of it)",
                  reached * pressure->pressure_Pa, pressure->pressure_Pa, low / half);
}

/* Whether a part is moved in its plane, and a film has no tension to begin with. */
static bool is_twisted_slack(const struct dea_layout *l)
{
  bool moved = false, slack = false;
  for (size_t i = 0; i < l->body_count; i++) {
    const struct dea_layout_body *body = &l->bodies[i];
    moved = moved || body->shift_m[0] != 0 || body->shift_m[1] != 0 || body->turn_rad[2] != 0;
  }
  for (size_t i = 0; i < l->support_count; i++) {
    moved = moved || l->supports[i].move_m[0] != 0 || l->supports[i].move_m[1] != 0;
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const double *stretch = l->plies[i].pre_stretch;
    slack = slack || (l->plies[i].material.law != NULL && fmin(stretch[0], stretch[1]) <= 1);
  }
  return moved && slack;
}

/* Why there is no state of the loads, where that is known. */
static dea_status explain_loads(struct dea_context *ctx, struct dea_model *model, dea_status status)
{
  const struct dea_layout *l = model->layout;
  char why[200];
  if (dea_solid_may_shorten(status) && is_twisted_slack(l)) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(
        ctx, status,
        "a film without tension wrinkles when it is twisted or shifted in its plane, and "
        "no state is found beyond %.3g %% of that: give its ply a pre_stretch above 1 "
        "(%s)",
        100 * model->at.report.load_factor, why);
  }
  const bool alone =
      l->pressure_count == 1 && l->body_count == 0 && l->pressures[0].encloses == DEA_OPEN;
  return dea_solid_may_shorten(status) && alone ? explain_pressure(ctx, model, status) : status;
}

/* With supports and loads as they are, at 0 V. */
static dea_status go_to_loads(struct dea_context *ctx, struct dea_model *model)
{
  DEA_TRY(ctx, dea_solid_supports_hold(ctx, model, true));
  for (size_t k = 1; k < model->layout->channel_count; k++) {
    dea_solid_own_voltages(model->solid)[k] = model->layout->channels[k].own_V;
  }
  dea_solid_pressures_set(model, 1);
  DEA_TRY(ctx, dea_solid_dead_loads_set(ctx, model));
  DEA_TRY(ctx, dea_solid_bodies_load(ctx, model));
  const bool twisted = is_twisted_slack(model->layout);
  model->solid->settings.accept_unstable = twisted; // of its many wrinkles none is followed
  const dea_status status = dea_load_steps_solve(ctx, model->solid, 0, &model->at.report);
  DEA_TRY(ctx, explain_loads(ctx, model, status));
  const int modes = model->at.report.unstable_modes;
  model->solid->settings.accept_unstable = twisted && modes > 0;
  return !twisted || modes == 0
             ? DEA_OK
             : dea_finding_add(
                   ctx, DEA_WARNING, (struct dea_location){0},
                   "model 3d: a film without tension that is twisted or shifted in its plane "
                   "wrinkles, here in %d mode%s of the mesh, and has no state of its own: the "
                   "numbers are those of one that is kept from it. A pre_stretch above 1 keeps it "
                   "taut, a smaller motion or a thicker ply flat",
                   modes, modes == 1 ? "" : "s");
}

/* From the flat state, in which everything is held, to that of the loads at 0 V
 * (docs/theory/devices.md). What held the film and is no support goes away on the way as dead
 * forces, under which the flat state is an equilibrium, fall to nothing. */
static dea_status release(struct dea_context *ctx, struct dea_model *model)
{
  size_t values = 3 * model->mesh.grid->node_count;
  double *force = dea_solid_force(model->solid);
  memset(force, 0, values * sizeof *force);
  DEA_TRY(ctx, hold_all(ctx, model));
  DEA_TRY(ctx, dea_load_steps_solve(ctx, model->solid, 0, &model->at.report));
  memcpy(force, dea_solid_reaction(model->solid), values * sizeof *force);
  DEA_TRY(ctx, dea_solid_supports_hold(ctx, model, false));
  DEA_TRY(ctx, dea_load_steps_solve(ctx, model->solid, 0, &model->at.report));
  return DEA_CHAIN(ctx, go_to_loads(ctx, model));
}

/* From the flat state straight to that of a disc, whose film is at rest there but for what its
 * weight and stiff electrodes do: these were laid on the unstretched film and draw it together, to
 * a third, which is farther than Newton's method goes at once; then by the release. */
dea_status dea_solid_loads_release(struct dea_context *ctx, struct dea_model *model)
{
  char why[200];
  dea_status status = model->disc ? go_to_loads(ctx, model) : release(ctx, model);
  if (model->disc && dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    dea_solid_forget(model->solid);
    status = release(ctx, model);
  }
  if (model->disc && status == DEA_E_NOT_CONVERGED) {
    snprintf(why, sizeof why, "%s", dea_context_message(ctx));
    return dea_fail(ctx, status,
                    "the solver did not converge: the film at rest is not found (%s); let go by "
                    "%.3g %% from the flat state it is; please report the design",
                    why, 100 * model->at.report.load_factor);
  }
  DEA_TRY(ctx, status);
  model->at.left_a_state = model->at.report.snapped;
  return DEA_OK;
}
