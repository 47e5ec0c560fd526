#include "model/solid/mesh/msh_write.h"

#include "base/write_file.h"

#include <string.h>

enum { LINE3 = 8, QUAD9 = 10, HEX27 = 12 }; // Gmsh's types
enum { NODES = 27, FACE_NODES = 9, EDGE_NODES = 3, FACES = 6, EDGES = 4, DIMENSIONS = 4 };

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
  const struct dea_msh_groups *groups;
  const struct dea_grid *grid;
  struct dea_text *text;
  size_t number, counts[DIMENSIONS][DEA_MSH_GROUPS_MAX];
};

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

static int side_group(const struct writer *w, const int *nodes, int count)
{
  const struct dea_msh_groups *g = w->groups;
  return g->side != NULL ? g->side(g->self, w->grid, nodes, count) : -1;
}

static int face_group(const struct writer *w, int part, bool top)
{
  const struct dea_msh_groups *g = w->groups;
  return g->face != NULL ? g->face(g->self, part, top) : -1;
}

static void add_solid(struct writer *w, int part, const int *nodes)
{
  add_element(w, 3, part, nodes, hex_order);
  for (int face = 0; face < FACES; face++) {
    int own[FACE_NODES];
    face_nodes(nodes, face, own);
    add_element(w, 2, face >= 2 ? side_group(w, own, FACE_NODES) : face_group(w, part, face == 1),
                own, NULL);
  }
}

static void add_flat(struct writer *w, int part, const int *nodes)
{
  static const int first[EDGES] = {0, 6, 0, 2}, step[EDGES] = {1, 1, 3, 3};
  add_element(w, 2, part, nodes, quad_order);
  for (int edge = 0; edge < EDGES && part != w->groups->without_sides; edge++) {
    const int own[EDGE_NODES] = {nodes[first[edge]], nodes[first[edge] + 2 * step[edge]],
                                 nodes[first[edge] + step[edge]]};
    add_element(w, 1, side_group(w, own, EDGE_NODES), own, NULL);
  }
}

static void add_elements(struct writer *w)
{
  const struct dea_grid *grid = w->grid;
  w->number = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    int part = w->groups->part(w->groups->self, grid->region[e], grid->ply[e]);
    (grid->levels[e] == 1 ? add_flat : add_solid)(w, part, grid->nodes + e * DEA_HEX_NODES_MAX);
  }
}

static void add_names(struct dea_text *text, const struct writer *w)
{
  size_t names = 0, groups = w->groups->count;
  for (size_t i = 0; i < DIMENSIONS * groups; i++) {
    names += w->counts[i / groups][i % groups] > 0;
  }
  dea_text_add(text, "$PhysicalNames\n%zu\n", names);
  for (size_t i = 0; i < DIMENSIONS * groups; i++) {
    if (w->counts[i / groups][i % groups] > 0) {
      dea_text_add(text, "%zu %zu \"%s\"\n", i / groups, i % groups + 1,
                   w->groups->name[i % groups]);
    }
  }
  dea_text_add(text, "$EndPhysicalNames\n");
}

static void add_mesh(struct dea_text *text, const struct dea_msh_groups *groups,
                     const struct dea_grid *grid)
{
  struct writer writer = {.groups = groups, .grid = grid};
  add_elements(&writer);
  dea_text_add(text, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n");
  add_names(text, &writer);
  dea_text_add(text, "$Nodes\n%zu\n", grid->node_count);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    dea_text_add(text, "%zu %.15g %.15g %.15g\n", n + 1, X[0], X[1], X[2]);
  }
  dea_text_add(text, "$EndNodes\n$Elements\n%zu\n", writer.number);
  writer.text = text;
  add_elements(&writer);
  dea_text_add(text, "$EndElements\n");
}

dea_status dea_msh_write(struct dea_context *ctx, const struct dea_msh_groups *groups,
                         const struct dea_grid *grid, const char *path)
{
  struct dea_text text = {.ctx = ctx};
  if (groups->count > DEA_MSH_GROUPS_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a mesh for Gmsh has up to %d groups, this one %zu",
                    DEA_MSH_GROUPS_MAX, groups->count);
  }
  if (grid->order != 2 || grid->order_z != 2) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "only meshes of order 2 can be written for Gmsh");
  }
  void *locale = dea_c_locale_enter();
  add_mesh(&text, groups, grid);
  dea_c_locale_leave(locale);
  dea_status status = dea_text_write_path(ctx, &text, path);
  dea_text_free(&text);
  return DEA_CHAIN(ctx, status);
}
