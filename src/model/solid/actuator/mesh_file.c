#include "model/solid/actuator/mesh_file.h"

#include "base/text.h"
#include "model/solid/mesh/msh_write.h"

#include <math.h>
#include <string.h>

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

static int first_of_disc(const struct dea_layout_mesh *mesh)
{
  return 2 * (int)mesh->layout->ply_count;
}

static int part_of(const void *self, int region, int ply)
{
  const struct dea_layout_mesh *mesh = self;
  size_t plies = mesh->layout->ply_count;
  bool active = mesh->field[(size_t)region * plies + (size_t)ply].top >= 0;
  return active ? (int)plies + ply : ply;
}

static int face_of(const void *self, int part, bool top)
{
  const struct dea_layout_mesh *mesh = self;
  return part < (int)mesh->layout->ply_count
             ? -1
             : first_of_disc(mesh) + (top ? FACE_ABOVE : FACE_BELOW);
}

static int side_of(const void *self, const struct dea_grid *grid, const int *nodes, int count)
{
  const struct dea_layout_mesh *mesh = self;
  int first = first_of_disc(mesh), edges = 3;
  bool frame = true;
  for (int n = 0; n < count; n++) {
    const double *X = grid->X + 3 * nodes[n];
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

dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path)
{
  const struct dea_layout *l = mesh->layout;
  const bool disc = mesh->plate.order > 0;
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
    const struct dea_msh_groups groups = {.name = names,
                                          .count = 2 * l->ply_count + (disc ? OF_DISC : 0),
                                          .part = part_of,
                                          .face = disc ? face_of : NULL,
                                          .side = disc ? side_of : NULL,
                                          .without_sides = without_sides(mesh),
                                          .self = mesh};
    status = dea_msh_write(ctx, &groups, mesh->grid, path);
  }
  for (size_t p = 0; active != NULL && p < l->ply_count; p++) {
    dea_text_free(&active[p]);
  }
  dea_arena_free(&arena);
  return DEA_CHAIN(ctx, status);
}
