#include "model/solid/actuator/mesh_file.h"

#include "base/text.h"
#include "base/write_file.h"

#include <math.h>
#include <string.h>

enum { LINE3 = 8, QUAD9 = 10, HEX27 = 12 }; // Gmsh's types
enum { NODES = 27, FACE_NODES = 9, EDGE_NODES = 3, FACES = 6, EDGES = 4, DIMENSIONS = 4 };
enum { GROUPS_MAX = 256 };

/* Place in our element, first axis fastest, of each node of Gmsh's: corners, edges, faces, middle.
 */
static const int hex_order[NODES] = {0,  2,  8,  6,  18, 20, 26, 24, 1,  3,  9,  5,  11, 7,
                                     17, 15, 19, 21, 23, 25, 4,  10, 12, 14, 16, 22, 13};
static const int quad_order[FACE_NODES] = {0, 2, 8, 6, 1, 5, 7, 3, 4};

/* Our element's faces: first node and the steps of their two axes, so that they look outwards. */
static const int face_first[FACES] = {0, 18, 0, 6, 0, 2};
static const int face_step[FACES][2] = {{3, 1}, {1, 3}, {1, 9}, {9, 1}, {9, 3}, {3, 9}};

static void face_nodes(const int *nodes, int face, int out[FACE_NODES])
{
  for (int n = 0; n < FACE_NODES; n++) {
    int at = quad_order[n];
    out[n] = nodes[face_first[face] + at % 3 * face_step[face][0] + at / 3 * face_step[face][1]];
  }
}

/* A mesh on its way into a text; without one its elements are counted only. */
struct writer {
  const struct dea_layout_mesh *mesh;
  const char **names; // [group_count]; an element is of none with -1
  size_t group_count;
  int without_sides; // a part whose flat elements have no sides of a group; -1: none
  struct dea_text *text;
  size_t number, counts[DIMENSIONS][GROUPS_MAX];
};

/* Numbers of groups: plies, plies between electrodes, and of a disc these. */
enum { FACE_BELOW, FACE_ABOVE, FRAME, MIRROR_FIRST, MIRROR_LAST, OF_DISC };
static const char *const names_of_disc[OF_DISC] = {
    [FACE_BELOW] = "face_below", // of the film, under an electrode
    [FACE_ABOVE] = "face_above",     [FRAME] = "frame",
    [MIRROR_FIRST] = "mirror_first", [MIRROR_LAST] = "mirror_last",
};

/* Plies of a disc in such files. */
static const char *const plies_of_disc[][2] = {{"lower electrode", "electrode_below"},
                                               {"upper electrode", "electrode_above"},
                                               {"bond of electrodes", "electrode_above"},
                                               {"bond of the film", "bond"},
                                               {"bond", "glue"},
                                               {"fibres", "fibre"}};

static const char *name_of(const struct dea_layout_mesh *mesh, size_t p)
{
  const char *name = mesh->layout->plies[p].name;
  for (size_t i = 0; i < sizeof plies_of_disc / sizeof plies_of_disc[0]; i++) {
    if (mesh->plate.order > 0 && strcmp(name, plies_of_disc[i][0]) == 0) {
      return plies_of_disc[i][1];
    }
  }
  return name;
}

static bool is_disc(const struct dea_layout_mesh *mesh)
{
  return mesh->plate.order > 0;
}

/* Group of an element. */
static int part_of(const struct dea_layout_mesh *mesh, int region, int ply)
{
  size_t plies = mesh->layout->ply_count;
  bool active = mesh->field[(size_t)region * plies + (size_t)ply].top >= 0;
  return active ? (int)plies + ply : ply;
}

/* Of the lower or upper face of a solid element of that group. */
static int face_of(const struct dea_layout_mesh *mesh, int part, bool top)
{
  const int plies = (int)mesh->layout->ply_count;
  return part < plies || !is_disc(mesh) ? -1 : 2 * plies + (top ? FACE_ABOVE : FACE_BELOW);
}

/* Of a side that looks along the plane: a face of a solid element, an edge of a flat one. */
static int side_of(const struct dea_layout_mesh *mesh, const int *nodes, int count)
{
  int first = 2 * (int)mesh->layout->ply_count, edges = 3;
  bool frame = true;
  if (!is_disc(mesh)) {
    return -1;
  }
  for (int n = 0; n < count; n++) {
    const double *X = mesh->grid->X + 3 * nodes[n];
    frame = frame && hypot(X[0], X[1]) > mesh->plate.frame_radius - mesh->near_m;
    edges &= dea_fibre_disc_edges(&mesh->plate, X);
  }
  return frame        ? first + FRAME
         : edges == 1 ? first + MIRROR_FIRST
         : edges == 2 ? first + MIRROR_LAST
                      : -1;
}

/* Of a surface that lies where another one does: it has no sides of its own. */
static int without_sides(const struct dea_layout_mesh *mesh)
{
  for (size_t p = 0; p < mesh->layout->ply_count; p++) {
    if (mesh->surface[p] && !mesh->dielectric[p]) {
      return (int)p;
    }
  }
  return -1;
}

/* order: places of Gmsh's nodes in ours, NULL: the same. */
static void add_element(struct writer *w, int dimension, int group, const int *nodes,
                        const int *order)
{
  static const int types[DIMENSIONS] = {0, LINE3, QUAD9, HEX27};
  static const int node_counts[DIMENSIONS] = {0, EDGE_NODES, FACE_NODES, NODES};
  if (group < 0) {
    return;
  }
  w->number++;
  w->counts[dimension][group]++;
  if (w->text == NULL) {
    return;
  }
  dea_text_add(w->text, "%zu %d 2 %d %d", w->number, types[dimension], group + 1, group + 1);
  for (int n = 0; n < node_counts[dimension]; n++) {
    dea_text_add(w->text, " %d", nodes[order != NULL ? order[n] : n] + 1);
  }
  dea_text_add(w->text, "\n");
}

static void add_solid(struct writer *w, int part, const int *nodes)
{
  add_element(w, 3, part, nodes, hex_order);
  for (int face = 0; face < FACES; face++) {
    int own[FACE_NODES];
    face_nodes(nodes, face, own);
    add_element(w, 2,
                face >= 2 ? side_of(w->mesh, own, FACE_NODES) : face_of(w->mesh, part, face == 1),
                own, NULL);
  }
}

static void add_flat(struct writer *w, int part, const int *nodes)
{
  static const int first[EDGES] = {0, 6, 0, 2}, step[EDGES] = {1, 1, 3, 3};
  add_element(w, 2, part, nodes, quad_order);
  for (int edge = 0; edge < EDGES && part != w->without_sides; edge++) {
    const int own[EDGE_NODES] = {nodes[first[edge]], nodes[first[edge] + 2 * step[edge]],
                                 nodes[first[edge] + step[edge]]};
    add_element(w, 1, side_of(w->mesh, own, EDGE_NODES), own, NULL);
  }
}

static void add_elements(struct writer *w)
{
  const struct dea_grid *grid = w->mesh->grid;
  w->number = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    int part = part_of(w->mesh, grid->region[e], grid->ply[e]);
    (grid->levels[e] == 1 ? add_flat : add_solid)(w, part, grid->nodes + e * DEA_HEX_NODES_MAX);
  }
}

static void add_names(struct dea_text *text, const struct writer *w)
{
  size_t names = 0, groups = w->group_count;
  for (size_t i = 0; i < DIMENSIONS * groups; i++) {
    names += w->counts[i / groups][i % groups] > 0;
  }
  dea_text_add(text, "$PhysicalNames\n%zu\n", names);
  for (size_t i = 0; i < DIMENSIONS * groups; i++) {
    if (w->counts[i / groups][i % groups] > 0) {
      dea_text_add(text, "%zu %zu \"%s\"\n", i / groups, i % groups + 1, w->names[i % groups]);
    }
  }
  dea_text_add(text, "$EndPhysicalNames\n");
}

static void add_mesh(struct dea_text *text, struct writer *w)
{
  const struct dea_grid *grid = w->mesh->grid;
  add_elements(w);
  dea_text_add(text, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  add_names(text, w);
  dea_text_add(text, "$Nodes\n%zu\n", grid->node_count);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    dea_text_add(text, "%zu %.15g %.15g %.15g\n", n + 1, X[0], X[1], X[2]);
  }
  dea_text_add(text, "$EndNodes\n$Elements\n%zu\n", w->number);
  w->text = text;
  add_elements(w);
  dea_text_add(text, "$EndElements\n");
}

static dea_status write_mesh(struct dea_context *ctx, struct writer *w, const char *path)
{
  struct dea_text text = {.ctx = ctx};
  if (w->group_count > GROUPS_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a mesh for Gmsh has up to %d groups, this one %zu",
                    GROUPS_MAX, w->group_count);
  }
  if (w->mesh->grid->order != 2 || w->mesh->grid->order_z != 2) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "only meshes of order 2 can be written for Gmsh");
  }
  void *locale = dea_c_locale_enter();
  add_mesh(&text, w);
  dea_c_locale_leave(locale);
  dea_status status = dea_text_write_path(ctx, &text, path);
  dea_text_free(&text);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_arena arena = {.ctx = ctx};
  const char **names = dea_arena_alloc(&arena, 2 * l->ply_count + OF_DISC, sizeof *names);
  struct dea_text *active = dea_arena_alloc(&arena, l->ply_count, sizeof *active);
  dea_status status = dea_arena_status(&arena);
  for (size_t p = 0; p < l->ply_count && status == DEA_OK; p++) {
    active[p].ctx = ctx;
    dea_text_add(&active[p], "%s_active", name_of(mesh, p));
    names[p] = name_of(mesh, p);
    names[l->ply_count + p] = dea_text_get(&active[p]);
    status = active[p].failed ? DEA_E_MEMORY : DEA_OK;
  }
  if (status == DEA_OK) {
    memcpy(names + 2 * l->ply_count, names_of_disc, sizeof names_of_disc);
    struct writer w = {.mesh = mesh,
                       .names = names,
                       .group_count = 2 * l->ply_count + (is_disc(mesh) ? OF_DISC : 0),
                       .without_sides = without_sides(mesh)};
    status = write_mesh(ctx, &w, path);
  }
  for (size_t p = 0; active != NULL && p < l->ply_count; p++) {
    dea_text_free(&active[p]);
  }
  dea_arena_free(&arena);
  return DEA_CHAIN(ctx, status);
}
