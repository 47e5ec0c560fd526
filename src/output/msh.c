#include "output/msh.h"

#include "output/file.h"

#include <string.h>

enum { HEX27 = 12, QUAD9 = 10, NODES = 27, FACE_NODES = 9, FACES = 6 }; // Gmsh's types

/* Physical groups, counted from 1 in the file. */
enum group {
  FILM,
  FILM_ACTIVE,
  ELECTRODE_BELOW,
  ELECTRODE_ABOVE,
  FILLER,
  GLUE,
  FIBRE,
  FRAME,
  AXIS_PLANE,
  MIDDLE_PLANE,
  FACE_BELOW,
  FACE_ABOVE,
  GROUPS
};
static const struct {
  const char *name;
  int dimension;
} groups[GROUPS] = {
    [FILM] = {"film", 3},
    [FILM_ACTIVE] = {"film_active", 3}, // between the electrodes
    [ELECTRODE_BELOW] = {"electrode_below", 3},
    [ELECTRODE_ABOVE] = {"electrode_above", 3},
    [FILLER] = {"filler", 3},
    [GLUE] = {"glue", 3},
    [FIBRE] = {"fibre", 3},
    [FRAME] = {"frame", 2},
    [AXIS_PLANE] = {"mirror_first", 2},
    [MIDDLE_PLANE] = {"mirror_last", 2},
    [FACE_BELOW] = {"face_below", 2}, // of the film, under an electrode
    [FACE_ABOVE] = {"face_above", 2},
};

/* Place in our element, first axis fastest, of each node of Gmsh's: corners, edges, faces, middle.
 */
static const int hex_order[NODES] = {0,  2,  8,  6,  18, 20, 26, 24, 1,  3,  9,  5,  11, 7,
                                     17, 15, 19, 21, 23, 25, 4,  10, 12, 14, 16, 22, 13};
static const int quad_order[FACE_NODES] = {0, 2, 8, 6, 1, 5, 7, 3, 4};

/* Our element's faces: first node and the steps of their two axes, so that they look outwards. */
static const int face_first[FACES] = {0, 18, 0, 6, 0, 2};
static const int face_step[FACES][2] = {{3, 1}, {1, 3}, {1, 9}, {9, 1}, {9, 3}, {3, 9}};

static enum group group_of(int region, int sheet)
{
  bool electrode = (region & DEA_PLATE_ELECTRODE) != 0;
  switch (sheet) {
  case DEA_PLATE_BOTTOM:
    return ELECTRODE_BELOW;
  case DEA_PLATE_FILM:
    return electrode ? FILM_ACTIVE : FILM;
  case DEA_PLATE_TOP:
    return electrode ? ELECTRODE_ABOVE : FILLER;
  default:
    return sheet == DEA_PLATE_GLUE ? GLUE : FIBRE;
  }
}

static void face_nodes(const int *nodes, int face, int out[FACE_NODES])
{
  for (int n = 0; n < FACE_NODES; n++) {
    int at = quad_order[n];
    out[n] = nodes[face_first[face] + at % 3 * face_step[face][0] + at / 3 * face_step[face][1]];
  }
}

/* Group of a face of an element, GROUPS for none. */
static enum group face_group(const struct dea_plate *plate, const struct dea_grid *grid, size_t e,
                             int face, const int nodes[FACE_NODES])
{
  int held = 7, edges = 3;
  for (int n = 0; n < FACE_NODES; n++) {
    const double *X = grid->X + 3 * nodes[n];
    held &= dea_plate_held(plate, X);
    edges &= dea_plate_edges(plate, X);
  }
  if (group_of(grid->region[e], grid->sheet[e]) == FILM_ACTIVE && face < 2) {
    return face == 0 ? FACE_BELOW : FACE_ABOVE;
  }
  return face < 2     ? GROUPS
         : held == 7  ? FRAME
         : edges == 1 ? AXIS_PLANE
         : edges == 2 ? MIDDLE_PLANE
                      : GROUPS;
}

static void add_element(struct dea_text *text, size_t number, int type, enum group group,
                        const int *nodes, const int *order, int count)
{
  dea_text_add(text, "%zu %d 2 %d %d", number, type, (int)group + 1, (int)group + 1);
  for (int n = 0; n < count; n++) {
    dea_text_add(text, " %d", nodes[order != NULL ? order[n] : n] + 1);
  }
  dea_text_add(text, "\n");
}

/* All elements and faces; with text NULL they are counted only, and by group into counts. */
static size_t add_elements(const struct dea_plate *plate, const struct dea_grid *grid,
                           struct dea_text *text, size_t counts[GROUPS])
{
  size_t number = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    enum group part = group_of(grid->region[e], grid->sheet[e]);
    number++;
    counts[part]++;
    if (text != NULL) {
      add_element(text, number, HEX27, part, nodes, hex_order, NODES);
    }
    for (int face = 0; face < FACES; face++) {
      int own[FACE_NODES];
      face_nodes(nodes, face, own);
      enum group group = face_group(plate, grid, e, face, own);
      if (group != GROUPS) {
        number++;
        counts[group]++;
        if (text != NULL) {
          add_element(text, number, QUAD9, group, own, NULL, FACE_NODES);
        }
      }
    }
  }
  return number;
}

static void add_mesh(struct dea_text *text, const struct dea_plate *plate,
                     const struct dea_grid *grid)
{
  size_t counts[GROUPS] = {0}, count = add_elements(plate, grid, NULL, counts), names = 0;
  for (int g = 0; g < GROUPS; g++) {
    names += counts[g] > 0;
  }
  dea_text_add(text, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%zu\n", names);
  for (int g = 0; g < GROUPS; g++) {
    if (counts[g] > 0) {
      dea_text_add(text, "%d %d \"%s\"\n", groups[g].dimension, g + 1, groups[g].name);
    }
  }
  dea_text_add(text, "$EndPhysicalNames\n$Nodes\n%zu\n", grid->node_count);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    dea_text_add(text, "%zu %.15g %.15g %.15g\n", n + 1, X[0], X[1], X[2]);
  }
  dea_text_add(text, "$EndNodes\n$Elements\n%zu\n", count);
  add_elements(plate, grid, text, counts);
  dea_text_add(text, "$EndElements\n");
}

dea_status dea_msh_write(struct dea_context *ctx, const struct dea_plate *plate,
                         const struct dea_grid *grid, const char *path)
{
  struct dea_text text = {.ctx = ctx};
  if (plate->order != 2 || plate->order_z != 2) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "only meshes of order 2 can be written for Gmsh");
  }
  void *locale = dea_c_locale_enter();
  add_mesh(&text, plate, grid);
  dea_c_locale_leave(locale);
  dea_status status =
      text.failed ? DEA_E_MEMORY : dea_file_write(ctx, path, dea_text_get(&text), text.length);
  dea_text_free(&text);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
