#include "model/solid/actuator/mesh_file.h"

#include "base/text.h"
#include "model/solid/mesh/msh_write.h"

// Discs ------------------------------------------------------------------------------------------

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
  ELECTRODES, // of a membrane, both
  BOND,
  GROUPS
};
static const char *const group_names[GROUPS] = {
    [FILM] = "film",
    [FILM_ACTIVE] = "film_active", // between the electrodes
    [ELECTRODE_BELOW] = "electrode_below",
    [ELECTRODE_ABOVE] = "electrode_above",
    [FILLER] = "filler",
    [GLUE] = "glue",
    [FIBRE] = "fibre",
    [FRAME] = "frame",
    [AXIS_PLANE] = "mirror_first",
    [MIDDLE_PLANE] = "mirror_last",
    [FACE_BELOW] = "face_below", // of the film, under an electrode
    [FACE_ABOVE] = "face_above",
    [ELECTRODES] = "electrodes",
    [BOND] = "bond",
};

static int disc_part(const void *self, int region, int ply)
{
  const struct dea_fibre_disc *plate = self;
  bool electrode = (region & DEA_FIBRE_DISC_ELECTRODE) != 0;
  switch (ply) {
  case DEA_FIBRE_DISC_BOTTOM:
    return plate->membrane ? ELECTRODES : ELECTRODE_BELOW;
  case DEA_FIBRE_DISC_FILM:
    return electrode ? FILM_ACTIVE : FILM;
  case DEA_FIBRE_DISC_BOND:
    return BOND;
  case DEA_FIBRE_DISC_TOP:
    return electrode ? ELECTRODE_ABOVE : FILLER;
  default:
    return ply == DEA_FIBRE_DISC_GLUE ? GLUE : FIBRE;
  }
}

static int disc_face(const void *self, int part, bool top)
{
  (void)self;
  return part != FILM_ACTIVE ? -1 : top ? FACE_ABOVE : FACE_BELOW;
}

static int disc_side(const void *self, const struct dea_grid *grid, const int *nodes, int count)
{
  const struct dea_fibre_disc *plate = self;
  int held = 7, edges = 3;
  for (int n = 0; n < count; n++) {
    const double *X = grid->X + 3 * nodes[n];
    held &= dea_fibre_disc_held(plate, X);
    edges &= dea_fibre_disc_edges(plate, X);
  }
  return held == 7 ? FRAME : edges == 1 ? AXIS_PLANE : edges == 2 ? MIDDLE_PLANE : -1;
}

dea_status dea_fibre_disc_write(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                                const struct dea_grid *grid, const char *path)
{
  const struct dea_msh_groups groups = {.name = group_names,
                                        .count = GROUPS,
                                        .part = disc_part,
                                        .face = disc_face,
                                        .side = disc_side,
                                        .without_sides = ELECTRODES,
                                        .self = plate};
  DEA_TRY(ctx, dea_msh_write(ctx, &groups, grid, path));
  return DEA_OK;
}

// Layouts ----------------------------------------------------------------------------------------

static int layout_part(const void *self, int region, int ply)
{
  const struct dea_layout_mesh *mesh = self;
  size_t plies = mesh->layout->ply_count;
  bool active = mesh->field[(size_t)region * plies + (size_t)ply].top >= 0;
  return active ? (int)plies + ply : ply;
}

dea_status dea_layout_mesh_write(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                                 const char *path)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_arena arena = {.ctx = ctx};
  const char **names = dea_arena_alloc(&arena, 2 * l->ply_count, sizeof *names);
  struct dea_text *active = dea_arena_alloc(&arena, l->ply_count, sizeof *active);
  dea_status status = dea_arena_status(&arena);
  for (size_t p = 0; p < l->ply_count && status == DEA_OK; p++) {
    active[p].ctx = ctx;
    dea_text_add(&active[p], "%s_active", l->plies[p].name);
    names[p] = l->plies[p].name;
    names[l->ply_count + p] = dea_text_get(&active[p]);
    status = active[p].failed ? DEA_E_MEMORY : DEA_OK;
  }
  if (status == DEA_OK) {
    const struct dea_msh_groups groups = {.name = names,
                                          .count = 2 * l->ply_count,
                                          .part = layout_part,
                                          .without_sides = -1,
                                          .self = mesh};
    status = dea_msh_write(ctx, &groups, mesh->grid, path);
  }
  for (size_t p = 0; active != NULL && p < l->ply_count; p++) {
    dea_text_free(&active[p]);
  }
  dea_arena_free(&arena);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
