#include "model/solid/actuator/layout_mesh.h"

#include "geometry/boolean.h"
#include "model/solid/mesh/cuts.h"
#include "model/solid/mesh/gmsh.h"

#include <math.h>
#include <string.h>

/* Sizes of elements at refinement 1, which each refinement more halves: over the root of the area
 * of the largest ply; and how much finer they are along the edges of what changes the film's
 * stretch: electrodes, bodies, and plies that others carry. */
static const double size_share = 0.12, edge_share = 0.4, growth = 0.7;
/* A narrow region has an element across: its size over the region's area by its boundary, which is
 * half its width. */
static const double across_share = 2;
/* Rows of elements along the edges of electrodes, plies, bodies and supports: their width at
 * refinement 1 over the thickness of the film, how many they are, and the share of the size of
 * elements beside them. */
static const double layer_share = 4.5, layer_rows = 2, layered_edge_share = 0.7,
                    most_rows_finer = 8;
/* Of a coupled field: the fringe is as wide as the film is thick, and the rows across it grow to
 * four times the width of the first. */
static const double fringe_share = 2, fringe_rows = 8;
static const double near_share = 1e-6;  // of the size of all: a node on a boundary
static const double least_share = 1e-6; // of the area of all: what is smaller is as good as a point

// Plane ------------------------------------------------------------------------------------------

void dea_layout_mesh_roles(const struct dea_layout *l, unsigned *roles)
{
  memset(roles, 0, l->region_count * sizeof *roles);
  for (size_t i = 0; i < l->ply_count; i++) {
    roles[l->plies[i].region] |= DEA_REGION_STRETCHES;
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    roles[l->electrodes[i].region] |= DEA_REGION_STRETCHES;
  }
  for (size_t i = 0; i < l->body_count; i++) {
    roles[l->bodies[i].region] |= DEA_REGION_STRETCHES | DEA_REGION_RIGID;
  }
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *s = &l->supports[i];
    const bool all = !s->edge && s->components != 0 && s->within == DEA_LAYOUT_NONE;
    roles[s->region] |= DEA_REGION_SUPPORTS | (all ? DEA_REGION_RIGID : 0);
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    roles[l->pressures[i].region] |= DEA_REGION_OTHER;
  }
  for (size_t i = 0; i < l->contact_count; i++) {
    roles[l->contacts[i].region] |= DEA_REGION_OTHER;
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    if (l->monitors[i].kind == DEA_MONITOR_REGION) {
      roles[l->monitors[i].region] |= DEA_REGION_OTHER;
    }
  }
}

static double largest_ply_m2(const struct dea_layout *l)
{
  double largest = 0;
  for (size_t i = 0; i < l->ply_count; i++) {
    largest = fmax(largest, dea_region_area_m2(&l->regions[l->plies[i].region].region));
  }
  return largest;
}

/* Of elements along the boundary of a region. */
static double size_at_edge(const struct dea_region *region, unsigned roles, double largest_m2,
                           double size_m, double finer, bool layered)
{
  const double area_m2 = dea_region_area_m2(region);
  const double share = layered ? layered_edge_share : edge_share;
  const bool fine = (roles & DEA_REGION_STRETCHES) != 0 && area_m2 < (1 - 1e-9) * largest_m2;
  const double across = across_share * area_m2 / dea_region_boundary_m(region);
  return fmin(fine ? share * size_m : size_m, across * finer);
}

/* Thickness of what is between electrodes, or of all plies. */
static double film_thickness_m(const struct dea_layout *l)
{
  double film = 0, all = 0;
  for (size_t p = 0; p < l->ply_count; p++) {
    bool film_here = false;
    for (size_t i = 0; i < l->electrode_count; i++) {
      film_here = film_here || l->electrodes[i].ply == p;
    }
    all += l->plies[p].thickness_m;
    film += film_here ? l->plies[p].thickness_m : 0;
  }
  return film > 0 ? film : all;
}

/* Whether a ply is stretched: the boundary layer sqrt(D/T) of a film without tension is as long as
 * the film. */
static bool is_stretched(const struct dea_layout *l)
{
  bool any = false;
  for (size_t p = 0; p < l->ply_count; p++) {
    any = any || l->plies[p].pre_stretch[0] != 1 || l->plies[p].pre_stretch[1] != 1;
  }
  return any;
}

/* All plies, and the sector, of which no more than these is left; an empty one: the whole. */
static dea_status join_plies(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                             struct dea_region *plies, struct dea_region *sector)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_region both = {.ctx = ctx};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < l->ply_count && status == DEA_OK; i++) {
    const struct dea_region *region = &l->regions[l->plies[i].region].region;
    status = dea_region_combine(ctx, DEA_UNION, region, i > 0 ? plies : NULL, &both);
    dea_region_free(plies);
    *plies = both;
    both = (struct dea_region){.ctx = ctx};
  }
  if (mesh->sector.fold > 0 && status == DEA_OK) {
    dea_layout_sector_region(&mesh->sector, 2 * dea_region_size_m(plies), sector);
    status = dea_region_combine(ctx, DEA_INTERSECTION, plies, sector, &both);
    dea_region_free(plies);
    *plies = both;
  }
  return status;
}

/* What of region i lies on the plies; where none of it does, what lies in the sector. */
static dea_status clip_region(struct dea_context *ctx, const struct dea_layout_mesh *mesh, size_t i,
                              const struct dea_region *plies, const struct dea_region *sector,
                              struct dea_region *clipped)
{
  const struct dea_region *region = &mesh->layout->regions[i].region;
  DEA_TRY(ctx, dea_region_combine(ctx, DEA_INTERSECTION, region, plies, clipped));
  if (clipped->contour_count == 0 && mesh->sector.fold > 0) {
    DEA_TRY(ctx, dea_region_combine(ctx, DEA_INTERSECTION, region, sector, clipped));
    mesh->group[i] = clipped->contour_count > 0 ? mesh->group[i] : DEA_LAYOUT_NONE;
  }
  if (clipped->contour_count > 0 &&
      dea_region_area_m2(clipped) > (1 - 1e-6) * dea_region_area_m2(region)) {
    dea_region_free(clipped);
  }
  return DEA_OK;
}

/* Meshes those regions too that only say where a support ends, as far as they lie on the plies:
 * else its last node would lie up to an element before that end, whatever the order of the
 * elements. */
static dea_status add_ends(struct dea_context *ctx, struct dea_layout_mesh *mesh,
                           const struct dea_region *plies, struct dea_region *clipped)
{
  const struct dea_layout *l = mesh->layout;
  for (size_t i = 0; i < l->support_count; i++) {
    size_t end = l->supports[i].within;
    if (end == DEA_LAYOUT_NONE || mesh->group[end] != DEA_LAYOUT_NONE) {
      continue;
    }
    struct dea_region both = {.ctx = ctx};
    DEA_TRY(ctx, dea_region_combine(ctx, DEA_INTERSECTION, &l->regions[end].region, plies, &both));
    if (both.contour_count > 0 &&
        dea_region_area_m2(&both) > least_share * dea_region_area_m2(plies)) {
      mesh->group[end] = 0;
      clipped[end] = both;
    } else {
      dea_region_free(&both);
    }
  }
  return DEA_OK;
}

/* What of each region lies on the plies, into clipped[region_count]; empty where all of it does,
 * and where none: what a support or a body has beyond them would be meshed for nothing, and badly
 * where it runs out in a cusp. What lies in other copies of the sector only is not meshed. Without
 * GEOS nothing is clipped. */
static dea_status clip(struct dea_context *ctx, struct dea_layout_mesh *mesh,
                       struct dea_region *clipped)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_region plies = {.ctx = ctx}, sector = {.ctx = ctx};
  char module[1024];
  if (!dea_boolean_find(module, sizeof module)) {
    return DEA_OK;
  }
  dea_status status = join_plies(ctx, mesh, &plies, &sector);
  for (size_t i = 0; i < l->region_count && status == DEA_OK; i++) {
    clipped[i].ctx = ctx;
    if (mesh->group[i] != DEA_LAYOUT_NONE) {
      status = clip_region(ctx, mesh, i, &plies, &sector, &clipped[i]);
    }
  }
  status = status == DEA_OK ? add_ends(ctx, mesh, &plies, clipped) : status;
  dea_region_free(&plies);
  dea_region_free(&sector);
  return status;
}

/* Contours of a region, NULL for want of memory. */
static struct dea_contour *contours_of(struct dea_arena *memory, const struct dea_region *region)
{
  struct dea_contour *contours = dea_arena_alloc(memory, region->contour_count, sizeof *contours);
  for (size_t k = 0; contours != NULL && k < region->contour_count; k++) {
    contours[k] = dea_region_contour(region, k);
  }
  return contours;
}

/* The layout's regions as shapes, clipped ones in their place; their contours come from `memory`.
 * Where a sector cuts a region nothing changes, so sizes there are not those at its boundary. */
static dea_status fill_plan(struct dea_arena *memory, const struct dea_layout_mesh *mesh,
                            const struct dea_model_settings *settings, const unsigned *roles,
                            const struct dea_region *clipped, struct dea_gmsh_plan *plan)
{
  const struct dea_layout *l = mesh->layout;
  double largest_m2 = largest_ply_m2(l), finer = exp2(1 - fmax(1, settings->refinement));
  const bool fringe = settings->field == DEA_FIELD_COUPLED;
  const bool rows = !mesh->membrane && (fringe || is_stretched(l));
  const double layer_m = rows ? (fringe ? fringe_share : layer_share) * film_thickness_m(l) : 0;
  struct dea_gmsh_shape *shapes = dea_arena_alloc(memory, l->region_count, sizeof *shapes);
  struct dea_gmsh_shape *curves = dea_arena_alloc(memory, l->region_count, sizeof *curves);
  DEA_TRY_MEMORY(shapes != NULL && curves != NULL);
  *plan = (struct dea_gmsh_plan){.shapes = shapes,
                                 .curves = curves,
                                 .order = settings->order == 1 ? 1 : 2,
                                 .size_m = size_share * sqrt(largest_m2) * finer,
                                 .growth = growth,
                                 .layer_rows =
                                     (size_t)lround((fringe ? fringe_rows : layer_rows) / finer)};
  for (size_t i = 0; i < l->region_count; i++) {
    const struct dea_region *region =
        clipped[i].contour_count > 0 ? &clipped[i] : &l->regions[i].region;
    if (mesh->group[i] == DEA_LAYOUT_NONE) {
      continue;
    }
    struct dea_gmsh_shape *shape = &shapes[plan->shape_count++];
    *shape = (struct dea_gmsh_shape){
        .name = l->regions[i].name,
        .contours = contours_of(memory, region),
        .count = region->contour_count,
        .edge_size_m = size_at_edge(&l->regions[i].region, roles[i], largest_m2, plan->size_m,
                                    finer, layer_m > 0),
        .layer_m = (roles[i] & (DEA_REGION_STRETCHES | DEA_REGION_SUPPORTS)) != 0 ? layer_m : 0,
        .rigid = (roles[i] & DEA_REGION_RIGID) != 0};
    if (mesh->sector.fold > 0) {
      curves[plan->curve_count] = *shape;
      curves[plan->curve_count].contours = contours_of(memory, &l->regions[i].region);
      curves[plan->curve_count++].count = l->regions[i].region.contour_count;
      shape->edge_size_m = shape->layer_m = 0;
    }
  }
  return dea_arena_status(memory);
}

/* Sizes of elements that were asked for, in the place of those of the plan; rows along edges are as
 * many times more as the smallest of them is finer. */
static void get_sizes(const struct dea_model_settings *settings, struct dea_gmsh_plan *plan)
{
  const double usual_m = layered_edge_share * plan->size_m;
  double least_m = usual_m;
  plan->sizes = settings->sizes;
  plan->size_count = settings->size_count;
  plan->growth = 0; // the usual one
  plan->size_m = 0;
  for (size_t i = 0; i < plan->size_count; i++) {
    plan->size_m = fmax(plan->size_m, plan->sizes[i][2]);
    least_m = fmin(least_m, plan->sizes[i][2]);
  }
  plan->layer_rows = (size_t)lround(layer_rows * fmin(most_rows_finer, usual_m / least_m));
}

static dea_status build_plane(struct dea_context *ctx, const struct dea_model_settings *settings,
                              struct dea_layout_mesh *mesh)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_arena memory = {.ctx = ctx};
  struct dea_gmsh_plan plan;
  unsigned *roles = dea_arena_alloc(&mesh->memory, l->region_count, sizeof *roles);
  mesh->group = dea_arena_alloc(&mesh->memory, l->region_count, sizeof *mesh->group);
  DEA_TRY(ctx, dea_arena_status(&mesh->memory));
  dea_layout_mesh_roles(l, roles);
  for (size_t i = 0; i < l->region_count; i++) {
    mesh->group[i] = roles[i] != 0 ? 0 : DEA_LAYOUT_NONE;
  }
  struct dea_region *clipped = dea_arena_alloc(&memory, l->region_count, sizeof *clipped);
  dea_status status = clipped != NULL ? clip(ctx, mesh, clipped) : DEA_E_MEMORY;
  for (size_t i = 0, groups = 0; i < l->region_count; i++) {
    mesh->group[i] = mesh->group[i] != DEA_LAYOUT_NONE ? groups++ : DEA_LAYOUT_NONE;
  }
  status = status == DEA_OK ? fill_plan(&memory, mesh, settings, roles, clipped, &plan) : status;
  if (status == DEA_OK && settings->size_count > 0) {
    get_sizes(settings, &plan);
  }
  status = status == DEA_OK ? dea_gmsh_mesh(ctx, &plan, &mesh->plane) : status;
  for (size_t i = 0; clipped != NULL && i < l->region_count; i++) {
    dea_region_free(&clipped[i]);
  }
  dea_arena_free(&memory);
  return status;
}

bool dea_layout_mesh_is_within(const struct dea_layout_mesh *mesh, size_t plane_region,
                               size_t region)
{
  size_t group = mesh->group[region];
  return group != DEA_LAYOUT_NONE &&
         mesh->plane->within[plane_region * mesh->plane->group_count + group] != 0;
}

// Plies ------------------------------------------------------------------------------------------

/* Whether there is a gap between two plies in a region of the plane, which a contact may close. */
static bool is_open(const struct dea_layout_mesh *mesh, size_t plane_region, size_t a, size_t b)
{
  const struct dea_layout *l = mesh->layout;
  bool open = false;
  for (size_t i = 0; i < l->contact_count; i++) {
    const struct dea_layout_contact *c = &l->contacts[i];
    const bool both = (c->ply == a && c->with == b) || (c->ply == b && c->with == a);
    open = open || (both && dea_layout_mesh_is_within(mesh, plane_region, c->region));
  }
  return open;
}

/* The ply that one lies on in a region of the plane, or DEA_LAYOUT_NONE. */
static size_t ply_below(const struct dea_layout_mesh *mesh, size_t plane_region, size_t ply)
{
  const bool *present = mesh->present + plane_region * mesh->layout->ply_count;
  for (size_t below = ply; below-- > 0;) {
    if (present[below]) {
      return is_open(mesh, plane_region, ply, below) ? DEA_LAYOUT_NONE : below;
    }
  }
  return DEA_LAYOUT_NONE;
}

/* Whether a ply has been laid beside another one below it in the list: as thick, on what that lies
 * on, and nowhere on it. */
static bool is_beside(const struct dea_layout_mesh *mesh, const size_t *skips, size_t p, size_t q)
{
  const struct dea_layout *l = mesh->layout;
  const struct dea_layout_ply *a = &l->plies[p], *b = &l->plies[q];
  bool beside = a->thickness_m == b->thickness_m && a->elements == b->elements &&
                p - skips[p] == q - skips[q];
  for (size_t r = 0; r < mesh->plane->region_count; r++) {
    const bool *present = mesh->present + r * l->ply_count;
    beside = beside && !(present[p] && present[q]);
  }
  return beside;
}

/* How many plies of the list each one passes over. It may span what is open below it, as a film
 * does in its frame, and lie on two only where one fills the place beside the other. */
static dea_status find_skips(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                             size_t *skips, size_t *beside)
{
  const struct dea_layout *l = mesh->layout;
  for (size_t p = 0; p < l->ply_count; p++) {
    size_t on = DEA_LAYOUT_NONE;
    beside[p] = DEA_LAYOUT_NONE;
    for (size_t r = 0; r < mesh->plane->region_count; r++) {
      size_t here = ply_below(mesh, r, p);
      if (!mesh->present[r * l->ply_count + p] || here == DEA_LAYOUT_NONE || here == on) {
        continue;
      }
      size_t upper = on != DEA_LAYOUT_NONE && on > here ? on : here;
      size_t lower = on != DEA_LAYOUT_NONE && on > here ? here : on;
      if (on != DEA_LAYOUT_NONE && is_beside(mesh, skips, upper, lower)) {
        beside[upper] = beside[lower] != DEA_LAYOUT_NONE ? beside[lower] : lower;
      } else if (on != DEA_LAYOUT_NONE) {
        DEA_TRY(ctx, dea_finding_add(
                         ctx, DEA_ERROR, l->plies[p].location,
                         "the ply '%s' lies partly on '%s' and partly on '%s': it has to be flat; "
                         "fill the step with a ply of that thickness, or make two plies of it",
                         l->plies[p].name, l->plies[on].name, l->plies[here].name));
        return dea_fail(ctx, DEA_E_DESIGN, "the ply '%s' is not flat", l->plies[p].name);
      }
      on = here;
    }
    skips[p] = on != DEA_LAYOUT_NONE ? p - 1 - on : p;
  }
  return DEA_OK;
}

static bool is_present(const void *self, int region, int ply)
{
  const struct dea_layout_mesh *mesh = self;
  return mesh->present[(size_t)region * mesh->layout->ply_count + (size_t)ply];
}

/* A ply whose number of elements is left to the settings; of blocks they are finer at its faces. */
static size_t elements_through(const struct dea_model_settings *settings,
                               const struct dea_layout_mesh *mesh, size_t p)
{
  const size_t own = mesh->layout->plies[p].elements;
  return mesh->surface[p]           ? 1
         : own > 0                  ? own
         : settings->elements_z > 0 ? (size_t)settings->elements_z
                                    : 1;
}

static void find_faces(struct dea_layout_mesh *mesh)
{
  const struct dea_grid *grid = mesh->grid;
  for (size_t p = 0; p < mesh->layout->ply_count; p++) {
    mesh->face_m[p][0] = mesh->face_m[p][1] = NAN;
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    double *face_m = mesh->face_m[grid->ply[e]]; // of NAN and a number: the number
    face_m[0] = fmin(face_m[0], grid->X[3 * nodes[0] + 2]);
    face_m[1] = fmax(face_m[1], grid->X[3 * nodes[dea_grid_nodes_of(grid, e) - 1] + 2]);
  }
}

static dea_status extrude(struct dea_context *ctx, const struct dea_model_settings *settings,
                          struct dea_layout_mesh *mesh)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_ply *plies = dea_arena_alloc(&mesh->memory, l->ply_count, sizeof *plies);
  size_t *skips = dea_arena_alloc(&mesh->memory, l->ply_count, sizeof *skips);
  size_t *beside = dea_arena_alloc(&mesh->memory, l->ply_count, sizeof *beside);
  const double **cuts = dea_arena_alloc(&mesh->memory, l->ply_count, sizeof *cuts);
  double through[DEA_FIBRE_DISC_THROUGH_MAX + 1];
  mesh->face_m = dea_arena_alloc(&mesh->memory, l->ply_count, sizeof *mesh->face_m);
  DEA_TRY(ctx, dea_arena_status(&mesh->memory));
  DEA_TRY(ctx, find_skips(ctx, mesh, skips, beside));
  for (size_t p = 0; p < l->ply_count; p++) {
    plies[p] = (struct dea_ply){
        .thickness_m = mesh->surface[p] ? 0 : l->plies[p].thickness_m,
        .count = elements_through(settings, mesh, p),
        .order_z = dea_mesh_order(settings->order_z),
    };
    if (mesh->plate.order > 0 && l->plies[p].elements == 0) {
      dea_cuts_through(plies[p].count, through);
      cuts[p] = through;
    }
  }
  const struct dea_stack stack = {.plies = plies,
                                  .count = l->ply_count,
                                  .skips = skips,
                                  .beside = beside,
                                  .cuts = cuts,
                                  .present = is_present,
                                  .self = mesh,
                                  .bottom_m = mesh->bottom_m};
  DEA_TRY(ctx, dea_grid_extrude(ctx, mesh->plane, &stack, &mesh->grid));
  find_faces(mesh);
  return mesh->grid->element_count > 0
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "no ply of the device has an element");
}

// Electrodes -------------------------------------------------------------------------------------

/* The electrode on a face of a ply, that of the ply at the other side included; -1: there is none.
 */
static int electrode_at(const struct dea_layout_mesh *mesh, size_t plane_region, size_t ply,
                        bool top)
{
  const struct dea_layout *l = mesh->layout;
  size_t other = DEA_LAYOUT_NONE;
  if (!top) {
    other = ply_below(mesh, plane_region, ply);
  }
  for (size_t q = ply + 1; top && q < l->ply_count && other == DEA_LAYOUT_NONE; q++) {
    bool there = mesh->present[plane_region * l->ply_count + q];
    other = there && ply_below(mesh, plane_region, q) == ply ? q : other;
  }
  if (!top && other != DEA_LAYOUT_NONE && dea_ply_layers(&l->plies[other]) % 2 == 0) {
    return electrode_at(mesh, plane_region, other,
                        false); // by turns: the uppermost is the lowest's
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    const struct dea_layout_electrode *e = &l->electrodes[i];
    bool here = (e->ply == ply && e->top == top) || (e->ply == other && e->top != top);
    if (here && dea_layout_mesh_is_within(mesh, plane_region, e->region)) {
      return (int)i;
    }
  }
  return -1;
}

/* Also which plies are dielectric. */
static void find_fields(struct dea_layout_mesh *mesh)
{
  size_t plies = mesh->layout->ply_count;
  for (size_t i = 0; i < mesh->plane->region_count * plies; i++) {
    struct dea_layout_field *field = &mesh->field[i];
    *field = (struct dea_layout_field){-1, -1, -1, -1};
    if (mesh->present[i]) {
      const struct dea_layout_electrode *e = mesh->layout->electrodes;
      int top = electrode_at(mesh, i / plies, i % plies, true);
      // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a mesh has plies
      int bottom = electrode_at(mesh, i / plies, i % plies, false);
      if (top >= 0 && bottom >= 0 && e[top].channel != e[bottom].channel) {
        *field =
            (struct dea_layout_field){(int)e[top].channel, (int)e[bottom].channel, top, bottom};
        mesh->dielectric[i % plies] = true;
      }
    }
  }
}

static dea_status fill(struct dea_context *ctx, const struct dea_model_settings *settings,
                       struct dea_layout_mesh *mesh)
{
  const struct dea_layout *l = mesh->layout;
  size_t plies = l->ply_count, count = mesh->plane->region_count * plies;
  double box[4];
  mesh->present = dea_arena_alloc(&mesh->memory, count, sizeof *mesh->present);
  mesh->field = dea_arena_alloc(&mesh->memory, count, sizeof *mesh->field);
  mesh->dielectric = dea_arena_alloc(&mesh->memory, plies, sizeof *mesh->dielectric);
  mesh->surface = dea_arena_alloc(&mesh->memory, plies, sizeof *mesh->surface);
  DEA_TRY(ctx, dea_arena_status(&mesh->memory));
  dea_layout_box_m(l, box);
  mesh->near_m = near_share * hypot(box[2] - box[0], box[3] - box[1]);
  for (size_t i = 0; i < count; i++) {
    mesh->present[i] = dea_layout_mesh_is_within(mesh, i / plies, l->plies[i % plies].region);
  }
  find_fields(mesh);
  for (size_t i = 0; i < plies; i++) {
    mesh->surface[i] =
        mesh->membrane && (mesh->dielectric[i] || l->plies[i].kind == DEA_PLY_ELECTRODE);
  }
  return DEA_CHAIN(ctx, extrude(ctx, settings, mesh));
}

dea_status dea_layout_mesh_fill(struct dea_context *ctx, const struct dea_model_settings *settings,
                                const struct dea_layout_mesh *like, struct dea_layout_mesh *mesh)
{
  DEA_TRY_ELSE(ctx, fill(ctx, settings, mesh), dea_layout_mesh_free(ctx, mesh));
  const struct dea_grid *a = mesh->grid, *b = like != NULL ? like->grid : a;
  if (a->element_count != b->element_count ||
      memcmp(a->nodes, b->nodes, a->element_count * DEA_HEX_NODES_MAX * sizeof *a->nodes) != 0) {
    dea_layout_mesh_free(ctx, mesh);
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh cannot follow the change");
  }
  return DEA_OK;
}

dea_status dea_layout_mesh_create(struct dea_context *ctx, const struct dea_layout *layout,
                                  const struct dea_model_settings *settings,
                                  struct dea_layout_mesh *out)
{
  char module[1024]; // that cuts a sector out
  *out = (struct dea_layout_mesh){
      .memory = {.ctx = ctx}, .layout = layout, .membrane = settings->film == DEA_FILM_MEMBRANE};
  if (settings->domain == DEA_DOMAIN_SECTOR && dea_boolean_find(module, sizeof module)) {
    out->sector = dea_layout_sector_of(layout);
  }
  DEA_TRY_ELSE(ctx, build_plane(ctx, settings, out), dea_layout_mesh_free(ctx, out));
  return DEA_CHAIN(ctx, dea_layout_mesh_fill(ctx, settings, NULL, out));
}

void dea_layout_mesh_free(struct dea_context *ctx, struct dea_layout_mesh *mesh)
{
  dea_grid_destroy(ctx, mesh->grid);
  if (!mesh->like) {
    dea_plane_mesh_destroy(ctx, mesh->plane);
  }
  dea_layout_destroy(ctx, mesh->own);
  dea_arena_free(&mesh->memory);
  *mesh = (struct dea_layout_mesh){0};
}

// Places -----------------------------------------------------------------------------------------

bool dea_layout_mesh_within(const struct dea_layout_mesh *mesh, size_t element, size_t region)
{
  return dea_layout_mesh_is_within(mesh, (size_t)mesh->grid->region[element], region);
}

bool dea_layout_mesh_marks_copy(const struct dea_layout_mesh *mesh, size_t region, bool edge,
                                size_t within)
{
  const struct dea_layout_region *regions = mesh->layout->regions;
  double near_m = mesh->near_m;
  bool any = false;
  for (size_t i = 0; i < mesh->plane->node_count * dea_layout_sector_copies(&mesh->sector); i++) {
    struct dea_motion copy = dea_layout_sector_copy(&mesh->sector, i / mesh->plane->node_count);
    const size_t where[2] = {region, within};
    double x[2];
    bool on = true;
    dea_motion_apply(&copy, mesh->plane->x + 2 * (i % mesh->plane->node_count), x);
    for (int k = 0; k < 2 && where[k] != DEA_LAYOUT_NONE; k++) {
      const struct dea_region *r = &regions[where[k]].region;
      on = on && (dea_region_distance_m(r, x) <= near_m ||
                  ((k == 1 || !edge) && dea_region_inside(r, x[0], x[1])));
    }
    any = any || on;
  }
  return any;
}

size_t dea_layout_mesh_mark(const struct dea_layout_mesh *mesh, size_t region, bool edge,
                            size_t within, bool *marked)
{
  const struct dea_plane_mesh *plane = mesh->plane;
  const struct dea_layout_region *regions = mesh->layout->regions;
  size_t per = (size_t)((plane->order + 1) * (plane->order + 1)), count = 0;
  double near_m = mesh->near_m;
  memset(marked, 0, plane->node_count * sizeof *marked);
  for (size_t q = 0; q < plane->quad_count; q++) {
    for (size_t n = 0;
         n < per && (edge || dea_layout_mesh_is_within(mesh, (size_t)plane->region[q], region));
         n++) {
      marked[plane->quads[q * per + n]] = true;
    }
  }
  for (size_t n = 0; n < plane->node_count; n++) {
    const double *x = plane->x + 2 * n;
    if (marked[n] && edge) {
      marked[n] = dea_region_distance_m(&regions[region].region, x) <= near_m;
    }
    if (marked[n] && within != DEA_LAYOUT_NONE) {
      marked[n] = dea_region_inside(&regions[within].region, x[0], x[1]) ||
                  dea_region_distance_m(&regions[within].region, x) <= near_m;
    }
    count += marked[n] ? 1 : 0;
  }
  return count;
}
