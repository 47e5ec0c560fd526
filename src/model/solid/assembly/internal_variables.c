#include "model/solid/assembly/internal_variables.h"

#include "model/solid/assembly/elements.h"

#include <stdint.h>
#include <string.h>

enum { TENSOR_BYTES = 6 * sizeof(double) }; // of a symmetric one

#define ELASTIC SIZE_MAX // in place of an element's first point

/* C, its inverse and the volume of all points, at the solid's displacements. */
static dea_status measure(const struct dea_solid *s, struct dea_internal_variables *h)
{
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    const size_t first = h->first[e], points = (size_t)dea_solid_element(s, e)->points;
    struct dea_element_strains strains;
    if (first == ELASTIC) {
      continue;
    }
    DEA_TRY_STATUS(dea_solid_element_strains(s, e, &strains));
    memcpy(h->C[first], strains.C, points * TENSOR_BYTES);
    memcpy(h->inverse_next[first], strains.inverse, points * TENSOR_BYTES);
    memcpy(h->volume_m3 + first, strains.volume_m3, points * sizeof *h->volume_m3);
  }
  return DEA_OK;
}

/* ---- memory ---- */

/* Gives the elements of part materials with branches their points. */
static dea_status place_points(struct dea_context *ctx, const struct dea_solid *s,
                               struct dea_arena *memory, struct dea_internal_variables *h)
{
  const struct dea_solid_problem *p = &s->problem;
  const size_t elements = p->grid->element_count;
  for (size_t e = 0; e < elements; e++) {
    const bool viscous = h->branches[p->part_material_of[e]].count > 0;
    h->first[e] = viscous ? h->count : ELASTIC;
    h->count += viscous ? (size_t)dea_solid_element(s, e)->points : 0;
  }
  h->part_material = dea_arena_alloc(memory, h->count + 1, sizeof *h->part_material);
  DEA_TRY(ctx, dea_arena_status(memory));
  for (size_t e = 0; e < elements; e++) {
    for (int q = 0; h->first[e] != ELASTIC && q < dea_solid_element(s, e)->points; q++) {
      h->part_material[h->first[e] + (size_t)q] = p->part_material_of[e];
    }
  }
  return DEA_OK;
}

static dea_status allocate_points(struct dea_context *ctx, const struct dea_solid *s,
                                  const struct dea_branches *branches, struct dea_arena *memory,
                                  struct dea_internal_variables *h)
{
  const struct dea_solid_problem *p = &s->problem;
  double(**const tensors[])[6] = {&h->B, &h->C, &h->inverse, &h->inverse_next};
  h->branches = dea_arena_alloc(memory, p->part_material_count, sizeof *h->branches);
  h->steps = dea_arena_alloc(memory, p->part_material_count, sizeof *h->steps);
  h->b_Pa = dea_arena_alloc(memory, p->part_material_count, sizeof *h->b_Pa);
  h->first = dea_arena_alloc(memory, p->grid->element_count, sizeof *h->first);
  DEA_TRY(ctx, dea_arena_status(memory));
  memcpy(h->branches, branches, p->part_material_count * sizeof *branches);
  DEA_TRY(ctx, place_points(ctx, s, memory, h));
  for (size_t i = 0; i < sizeof tensors / sizeof *tensors; i++) {
    *tensors[i] = dea_arena_alloc(memory, h->count + 1, TENSOR_BYTES);
  }
  h->volume_m3 = dea_arena_alloc(memory, h->count + 1, sizeof *h->volume_m3);
  h->A = dea_arena_alloc(memory, h->count + 1, sizeof *h->A);
  return DEA_CHAIN(ctx, dea_arena_status(memory));
}

/* Held as it is for long. */
static dea_status begin_at_rest(struct dea_context *ctx, const struct dea_solid *s,
                                const struct dea_branches *branches, struct dea_arena *memory,
                                struct dea_internal_variables *h)
{
  DEA_TRY(ctx, allocate_points(ctx, s, branches, memory, h));
  DEA_TRY_STATUS(measure(s, h));
  for (size_t at = 0; at < h->count; at++) {
    memcpy(h->inverse[at], h->inverse_next[at], TENSOR_BYTES);
    for (size_t i = 0; i < h->branches[h->part_material[at]].count; i++) {
      memcpy(h->A[at][i], h->inverse_next[at], TENSOR_BYTES);
    }
  }
  return DEA_OK;
}

dea_status dea_internal_variables_create(struct dea_context *ctx, const struct dea_solid *s,
                                         const struct dea_branches *branches,
                                         struct dea_arena *memory,
                                         struct dea_internal_variables **out)
{
  *out = dea_arena_alloc(memory, 1, sizeof **out);
  const dea_status status =
      *out != NULL ? begin_at_rest(ctx, s, branches, memory, *out) : DEA_E_MEMORY;
  return DEA_CHAIN(ctx, dea_solid_allreduce(ctx, status));
}

/* ---- steps ---- */

/* B of a point. */
static void begin_point(struct dea_internal_variables *h, size_t at,
                        const struct dea_branches *branches, const struct dea_branch_step *steps)
{
  memset(h->B[at], 0, TENSOR_BYTES);
  for (size_t i = 0; i < branches->count; i++) {
    double G = branches->branch[i].modulus_Pa;
    for (size_t a = 0; a < 6; a++) {
      h->B[at][a] += G * (steps[i].end.e * h->A[at][i][a] + steps[i].end.w0 * h->inverse[at][a]);
    }
  }
}

void dea_internal_variables_begin(struct dea_internal_variables *h, const struct dea_solid *s,
                                  double step_s)
{
  for (size_t l = 0; l < s->problem.part_material_count; l++) {
    const struct dea_branches *branches = &h->branches[l];
    struct dea_branch_step *steps = h->steps[l];
    h->b_Pa[l] = 0;
    for (size_t i = 0; i < branches->count; i++) {
      dea_branch_step_set(&branches->branch[i], step_s, &steps[i]);
      h->b_Pa[l] += branches->branch[i].modulus_Pa * (steps[i].end.e + steps[i].end.w0);
    }
  }
  for (size_t at = 0; at < h->count; at++) {
    begin_point(h, at, &h->branches[h->part_material[at]], h->steps[h->part_material[at]]);
  }
}

double dea_internal_variables_energy(const struct dea_internal_variables *h)
{
  double energy_J = 0;
  for (size_t at = 0; at < h->count; at++) {
    energy_J +=
        h->volume_m3[at] * dea_viscous_energy(h->B[at], h->b_Pa[h->part_material[at]], h->C[at]);
  }
  return energy_J;
}

/* What the branches of a point store at the end of the step and dissipate in it. */
static void add_energies(const struct dea_internal_variables *h, size_t at,
                         struct dea_solid_branch_energies *sum)
{
  const struct dea_branches *branches = &h->branches[h->part_material[at]];
  const struct dea_branch_step *steps = h->steps[h->part_material[at]];
  const double volume_m3 = h->volume_m3[at];
  for (size_t i = 0; i < branches->count; i++) {
    const struct dea_branch *branch = &branches->branch[i];
    double A[6];
    dea_branch_update(&steps[i].end, h->A[at][i], h->inverse[at], h->inverse_next[at], A);
    sum->stored += volume_m3 * dea_branch_energy(branch->modulus_Pa, A, h->C[at]);
    sum->dissipated += volume_m3 * dea_branch_dissipation(branch, &steps[i], h->A[at][i],
                                                          h->inverse[at], h->inverse_next[at]);
  }
}

dea_status dea_internal_variables_close(struct dea_context *ctx, struct dea_internal_variables *h,
                                        const struct dea_solid *s,
                                        struct dea_solid_branch_energies *out)
{
  const dea_status status = measure(s, h);
  *out = (struct dea_solid_branch_energies){0};
  for (size_t at = 0; at < h->count && status == DEA_OK; at++) {
    add_energies(h, at, out);
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status, "an element is inverted at the end of a step");
}

void dea_internal_variables_accept(struct dea_internal_variables *h)
{
  for (size_t at = 0; at < h->count; at++) {
    for (size_t i = 0; i < h->branches[h->part_material[at]].count; i++) {
      dea_branch_update(&h->steps[h->part_material[at]][i].end, h->A[at][i], h->inverse[at],
                        h->inverse_next[at], h->A[at][i]);
    }
    memcpy(h->inverse[at], h->inverse_next[at], TENSOR_BYTES);
  }
}
