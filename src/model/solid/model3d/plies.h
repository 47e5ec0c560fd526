/* What the plies of a layout are made of, and where its mesh has them. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/internal_variables.h"

struct dea_plies {
  struct dea_part_material *part_materials; // [ply_count], as all
  struct dea_solid_film_data *films;
  struct dea_branches *branches;
  double *leakage_per_s; // of films, conductance over capacitance
  size_t film;           // the first dielectric ply, or the first of all
  double thinnest_m;     // least unstretched thickness of dielectric layers over their voltage
};

/* memory: of the arrays. DEA_E_DESIGN for a material that a ply cannot be of, DEA_E_DOMAIN where
 * its law ends before its pre-stretch. */
dea_status dea_plies_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                            struct dea_arena *memory, struct dea_plies *out);

/* Callbacks for a solid (assembly/solid.h); self: a struct dea_layout_mesh. */
int dea_plies_part_material(const void *self, int region, int ply);
bool dea_plies_active(const void *self, int region, int ply);
void dea_plies_channels(const void *self, int region, int ply, int *top, int *bottom);
int dea_plies_held(const void *self, const double X[3]);
/* Axes of a node on a side of a sector that is along neither x nor y. */
bool dea_plies_frame(const void *self, const double X[3], double Q[9]);
/* Of a coupled field: faces of plies with electrodes, at the ratios of their channels. */
bool dea_plies_electrode(const void *self, const double X[3], double *share);
