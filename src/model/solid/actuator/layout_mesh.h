/* The mesh of a device (docs/theory/devices.md): a plane mesh, of gmsh or of the blocks of a disc,
 * extruded through the plies of its layout. */
#pragma once

#include "device/layout_sector.h"
#include "model/model.h"
#include "model/solid/mesh/fibre_disc.h"
#include "model/solid/mesh/grid.h"

/* Channels of an element at its top and bottom, top -1: it is not between electrodes; and these
 * electrodes. */
struct dea_layout_field {
  int top, bottom, top_electrode, bottom_electrode;
};

struct dea_layout_mesh {
  struct dea_arena memory;
  const struct dea_layout *layout; // lent, or `own`
  struct dea_layout *own;          // NULL: the device's own
  struct dea_fibre_disc plate;     // of a mesh of blocks; its order is 0: a free mesh
  struct dea_fibre_disc cuts;      // whose elements those are
  const struct dea_device *disc;   // lent, of that mesh
  double bottom_m;                 // z of the lowest ply
  bool membrane;                   // dielectric plies are surfaces
  struct dea_layout_sector sector; // what is meshed of the layout; its fold is 0: the whole
  struct dea_plane_mesh *plane;    // its groups are regions of the layout; owned
  bool like;                       // yes: plane and group are those of another one, or made of it
  size_t *group; // [region_count of the layout] group of a region; DEA_LAYOUT_NONE: not meshed,
                 // also what lies in other copies of the sector only
  bool *present; // [region_count of the plane][ply_count]
  struct dea_layout_field *field; // [region_count of the plane][ply_count]
  bool *surface;                  // [ply_count] plies that are surfaces
  double (*face_m)[2];   // [ply_count] z of the lower and the upper face; NAN: it is nowhere
  double near_m;         // what is near enough to a line to lie on it
  bool *dielectric;      // [ply_count] plies that are between electrodes of two channels somewhere
  struct dea_grid *grid; // its regions are those of the plane mesh; owned
};

/* Of the sector that the settings' domain and the layout leave, or of the whole. DEA_E_DESIGN with
 * a finding for plies that do not lie flat on each other; DEA_E_TOOL as dea_gmsh_mesh. layout:
 * lent, outlives the mesh. On failure out is empty. */
dea_status dea_layout_mesh_create(struct dea_context *ctx, const struct dea_layout *layout,
                                  const struct dea_model_settings *settings,
                                  struct dea_layout_mesh *out);
/* All but layout, plane, groups and sector, which are there. like: with the elements of that mesh,
 * else DEA_E_ARGUMENT; NULL: any. On failure the mesh is freed. */
dea_status dea_layout_mesh_fill(struct dea_context *ctx, const struct dea_model_settings *settings,
                                const struct dea_layout_mesh *like, struct dea_layout_mesh *mesh);
/* What regions of a layout, all of it taken, are of, as bits into roles [region_count]: of what
 * changes the stretch at their boundary, of supports, of what is held or moves as one, of other
 * things; 0: it is not meshed. */
enum {
  DEA_REGION_STRETCHES = 1,
  DEA_REGION_SUPPORTS = 2,
  DEA_REGION_RIGID = 4,
  DEA_REGION_OTHER = 8
};
void dea_layout_mesh_roles(const struct dea_layout *layout, unsigned *roles);
void dea_layout_mesh_free(struct dea_context *ctx, struct dea_layout_mesh *mesh);

/* Whether a region of the plane mesh, or an element, lies in a region of the layout. */
bool dea_layout_mesh_is_within(const struct dea_layout_mesh *mesh, size_t plane_region,
                               size_t region);
bool dea_layout_mesh_within(const struct dea_layout_mesh *mesh, size_t element, size_t region);
/* Marks the nodes of the plane mesh that lie in a region, its boundary included, or on its boundary
 * only; `within`: and in this region too (DEA_LAYOUT_NONE: anywhere). Returns their number.
 * marked: [node_count of the plane mesh]. */
size_t dea_layout_mesh_mark(const struct dea_layout_mesh *mesh, size_t region, bool edge,
                            size_t within, bool *marked);
/* Whether that marks a node of any copy of the sector. */
bool dea_layout_mesh_marks_copy(const struct dea_layout_mesh *mesh, size_t region, bool edge,
                                size_t within);
