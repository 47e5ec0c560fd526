/* What elements tell of themselves after a solve (docs/theory/recovery.md).
 *
 * Inside an element stress and stretch are best at a few inner points; values at its nodes come
 * from a polynomial of one degree less than the displacements, fitted to its Gauss points. Values
 * of a node are means over the elements of the same ply and region around it, so that film and
 * fibre, electrode and bare film do not mix where they meet. Means are taken of tensors; principal
 * values come last.
 *
 * Stress is the true (Cauchy) total stress P F^T / J: elastic part, pressure and Maxwell stress
 * together, so that a free face has none normal to it. */
#pragma once

#include "model/solid/mesh/grid.h"
#include "result/field_mesh.h"

/* A solid at an equilibrium. bulk_factor: kappa is so many times that of the part materials; u:
 * [nodes][3]; multiplier: [elements][elements->pressures]; kind, part material, active: [elements];
 * across_V: [elements] voltage from bottom to top, 0 without electrodes; potential_V: [nodes], used
 * by kinds with a potential. */
struct dea_recover_input {
  const struct dea_grid *grid;
  const struct dea_element_set *elements;
  const enum dea_element_kind *kind;
  const struct dea_part_material *part_materials;
  double bulk_factor;
  const int *part_material;
  const bool *active;
  const double *u, *multiplier, *across_V, *potential_V;
  bool uneven; // voltages of one pair of electrodes differ from place to place
};

/* All elements with displacement, stretches, stresses, tension, field and energy at points (one a
 * node, ply and region), error of volume, ply and region of cells. The symmetry is left to the
 * caller. out: owned by the caller, NULL on failure; DEA_E_DOMAIN as above. */
dea_status dea_recover_volume(struct dea_context *ctx, const struct dea_recover_input *in,
                              struct dea_field_mesh **out);

/* The middle surface of a ply, between electrodes or not, under another ply or not: these four
 * parts do not share points. Fields: those of DEA_SURFACE_* below, of uneven voltages
 * DEA_VOLTAGE_FIELD; cells: whether between electrodes and whether under a fibre. */
dea_status dea_recover_surface(struct dea_context *ctx, const struct dea_recover_input *in, int ply,
                               struct dea_field_mesh **out);
