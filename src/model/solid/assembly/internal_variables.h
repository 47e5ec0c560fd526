/* What the branches of a solid's part materials remember, at every Gauss point
 * (docs/theory/time.md).
 *
 * Every rank keeps all points: a step costs next to nothing beside its tangents. */
#pragma once

#include "base/arena.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/point/viscous.h"

/* Branches of a part material; none: elastic. */
struct dea_branches {
  size_t count;
  struct dea_branch branch[DEA_BRANCHES_MAX];
};

struct dea_internal_variables {
  struct dea_branches *branches;                     // [part_material_count]
  struct dea_branch_step (*steps)[DEA_BRANCHES_MAX]; // [part_material_count] of the step
  double *b_Pa;                                      // [part_material_count] of the step
  size_t *first;                    // [elements] its first point; SIZE_MAX: elastic
  size_t count;                     // points
  int *part_material;               // [count]
  double (*B)[6];                   // [count] of the step
  double (*A)[DEA_BRANCHES_MAX][6]; // [count] at the accepted state
  double (*inverse)[6];             // [count] C^-1 at the accepted state
  double (*inverse_next)[6];        // [count] at the end of the step that is tried
  double (*C)[6], *volume_m3;       // [count] there
};

/* branches: [part_material_count of the solid]. The film was held as it is for long: A = C^-1. */
dea_status dea_internal_variables_create(struct dea_context *ctx, const struct dea_solid *solid,
                                         const struct dea_branches *branches,
                                         struct dea_arena *memory,
                                         struct dea_internal_variables **out);

/* Sets B and b for a step from the last accepted state; step_s 0: the step that takes no time. */
void dea_internal_variables_begin(struct dea_internal_variables *variables,
                                  const struct dea_solid *solid, double step_s);

/* What the step adds to the solid's energy at the displacements of the last creation or close [J].
 */
double dea_internal_variables_energy(const struct dea_internal_variables *variables);

/* Energies of the branches, of the grid [J]. */
struct dea_solid_branch_energies {
  double stored, dissipated; // at the state; in the step to it
};

/* At the solid's displacements as the end of the step that has begun. */
dea_status dea_internal_variables_close(struct dea_context *ctx,
                                        struct dea_internal_variables *variables,
                                        const struct dea_solid *solid,
                                        struct dea_solid_branch_energies *out);
/* The state that was closed is the accepted one. */
void dea_internal_variables_accept(struct dea_internal_variables *variables);
