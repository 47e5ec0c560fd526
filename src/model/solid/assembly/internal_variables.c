#include "model/solid/assembly/internal_variables.h"

#include "model/solid/assembly/problem.h"

#include <stdint.h>
#include <string.h>

enum { TENSOR_BYTES = 6 * sizeof(double) }; // of a symmetric one

#define ELASTIC SIZE_MAX // in place of an element's first point

static dea_status find_strains(const struct dea_solid *s, size_t e, struct dea_element_strains *out)
{
  const struct dea_element *element = dea_solid_element(s, e);
  const struct dea_part_material part_material = dea_solid_part_material_at(s, e);
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
  const struct dea_element_input in = {.part_material = &part_material,
                                       .X = X,
                                       .u = u,
                                       .voltage_V =
                                           dea_solid_voltage_across(s, e, s->state.voltage_V)};
  dea_solid_gather(s, e, s->problem.grid->X, X);
  dea_solid_gather(s, e, s->state.u, u);
  return element->type->strains(element, &in, out);
}

/* ---- memory ---- */

/* Gives the elements of part materials with branches their points; returns how many. */
static size_t place_points(const struct dea_solid *s, struct dea_internal_variables *h)
{
  size_t count = 0;
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    bool viscous = h->branches[s->problem.part_material_of[e]].count > 0;
    h->first[e] = viscous ? count : ELASTIC;
    count += viscous ? (size_t)dea_solid_element(s, e)->points : 0;
  }
  return count;
}

static dea_status held_for_long(const struct dea_solid *s, struct dea_internal_variables *h)
{
  dea_status status = DEA_OK;
  for (size_t e = 0; e < s->problem.grid->element_count && status == DEA_OK; e++) {
    struct dea_element_strains strains;
    if (h->first[e] == ELASTIC) {
      continue;
    }
    status = find_strains(s, e, &strains);
    for (int q = 0; q < dea_solid_element(s, e)->points && status == DEA_OK; q++) {
      size_t at = h->first[e] + (size_t)q;
      memcpy(h->inverse[at], strains.inverse[q], TENSOR_BYTES);
      for (size_t i = 0; i < h->branches[s->problem.part_material_of[e]].count; i++) {
        memcpy(h->A[at][i], strains.inverse[q], TENSOR_BYTES);
      }
    }
  }
  return status;
}

static dea_status allocate_points(struct dea_context *ctx, const struct dea_solid *s,
                                  const struct dea_branches *branches,
                                  struct dea_internal_variables *h)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_arena *memory = &h->memory;
  memory->ctx = ctx;
  h->branches = dea_arena_alloc(memory, p->part_material_count, sizeof *h->branches);
  h->steps = dea_arena_alloc(memory, p->part_material_count, sizeof *h->steps);
  h->b_Pa = dea_arena_alloc(memory, p->part_material_count, sizeof *h->b_Pa);
  h->first = dea_arena_alloc(memory, p->grid->element_count, sizeof *h->first);
  DEA_TRY(ctx, dea_arena_status(memory));
  memcpy(h->branches, branches, p->part_material_count * sizeof *branches);
  size_t points = place_points(s, h);
  h->B = dea_arena_alloc(memory, points + 1, TENSOR_BYTES);
  h->inverse = dea_arena_alloc(memory, points + 1, TENSOR_BYTES);
  h->inverse_next = dea_arena_alloc(memory, points + 1, TENSOR_BYTES);
  h->A = dea_arena_alloc(memory, points + 1, sizeof *h->A);
  DEA_TRY(ctx, dea_arena_status(memory));
  return held_for_long(s, h);
}

dea_status dea_internal_variables_create(struct dea_context *ctx, const struct dea_solid *s,
                                         const struct dea_branches *branches,
                                         struct dea_internal_variables **out)
{
  struct dea_internal_variables *h = dea_alloc(ctx, 1, sizeof *h);
  *out = NULL;
  dea_status status = h != NULL ? allocate_points(ctx, s, branches, h) : DEA_E_MEMORY;
  status = dea_solid_allreduce(ctx, status);
  DEA_TRY_ELSE(ctx, status, dea_internal_variables_destroy(ctx, h));
  *out = h;
  return DEA_OK;
}

void dea_internal_variables_destroy(struct dea_context *ctx, struct dea_internal_variables *h)
{
  if (h != NULL) {
    dea_arena_free(&h->memory);
    dea_free(ctx, h);
  }
}

/* ---- steps ---- */

struct dea_part_material dea_solid_part_material_at(const struct dea_solid *s, size_t e)
{
  const struct dea_internal_variables *h = s->state.internal_variables;
  struct dea_part_material part_material = *dea_solid_part_material(s, e);
  part_material.kappa_Pa = dea_solid_bulk_modulus(s, e);
  if (h != NULL && h->first[e] != ELASTIC) {
    part_material.viscous = h->B + 6 * h->first[e];
    part_material.viscous_Pa = h->b_Pa[s->problem.part_material_of[e]];
  }
  return part_material;
}

/* B of the points of an element. */
static void begin_element(struct dea_internal_variables *h, size_t from, size_t count,
                          const struct dea_branches *branches, const struct dea_branch_step *steps)
{
  for (size_t at = from; at < from + count; at++) {
    double *B = h->B + 6 * at;
    memset(B, 0, TENSOR_BYTES);
    for (size_t i = 0; i < branches->count; i++) {
      double G = branches->branch[i].modulus_Pa;
      for (size_t a = 0; a < 6; a++) {
        B[a] += G * (steps[i].end.e * h->A[at][i][a] + steps[i].end.w0 * h->inverse[at][a]);
      }
    }
  }
}

void dea_internal_variables_begin(struct dea_internal_variables *h, const struct dea_solid *s,
                                  double step_s)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t l = 0; l < p->part_material_count; l++) {
    const struct dea_branches *branches = &h->branches[l];
    struct dea_branch_step *steps = h->steps[l];
    h->b_Pa[l] = 0;
    for (size_t i = 0; i < branches->count; i++) {
      dea_branch_step_set(&branches->branch[i], step_s, &steps[i]);
      h->b_Pa[l] += branches->branch[i].modulus_Pa * (steps[i].end.e + steps[i].end.w0);
    }
    for (size_t e = 0; e < p->grid->element_count; e++) {
      if ((size_t)p->part_material_of[e] == l && branches->count > 0) {
        begin_element(h, h->first[e], (size_t)dea_solid_element(s, e)->points, branches, steps);
      }
    }
  }
}

dea_status dea_internal_variables_energy(const struct dea_internal_variables *h,
                                         const struct dea_solid *s, double *energy_J)
{
  const struct dea_solid_problem *p = &s->problem;
  *energy_J = 0;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    struct dea_element_strains strains;
    if (h->first[e] == ELASTIC) {
      continue;
    }
    DEA_TRY_STATUS(find_strains(s, e, &strains));
    for (int q = 0; q < dea_solid_element(s, e)->points; q++) {
      const double *B = h->B + 6 * (h->first[e] + (size_t)q);
      *energy_J += strains.volume_m3[q] *
                   dea_viscous_energy(B, h->b_Pa[p->part_material_of[e]], strains.C[q]);
    }
  }
  return DEA_OK;
}

/* What the branches of a point store at the end of the step and dissipate in it. */
static void add_energies(const struct dea_internal_variables *h, size_t at,
                         const struct dea_branches *branches, const struct dea_branch_step *steps,
                         const double C[6], double volume, struct dea_solid_branch_energies *sum)
{
  for (size_t i = 0; i < branches->count; i++) {
    const struct dea_branch *branch = &branches->branch[i];
    double A[6];
    dea_branch_update(&steps[i].end, h->A[at][i], h->inverse[at], h->inverse_next[at], A);
    sum->stored += volume * dea_branch_energy(branch->modulus_Pa, A, C);
    sum->dissipated += volume * dea_branch_dissipation(branch, &steps[i], h->A[at][i],
                                                       h->inverse[at], h->inverse_next[at]);
  }
}

dea_status dea_internal_variables_close(struct dea_context *ctx, struct dea_internal_variables *h,
                                        const struct dea_solid *s,
                                        struct dea_solid_branch_energies *out)
{
  const struct dea_solid_problem *p = &s->problem;
  dea_status status = DEA_OK;
  *out = (struct dea_solid_branch_energies){0};
  for (size_t e = 0; e < p->grid->element_count && status == DEA_OK; e++) {
    const struct dea_branches *branches = &h->branches[p->part_material_of[e]];
    struct dea_element_strains strains;
    if (h->first[e] == ELASTIC) {
      continue;
    }
    status = find_strains(s, e, &strains);
    for (int q = 0; q < dea_solid_element(s, e)->points && status == DEA_OK; q++) {
      size_t at = h->first[e] + (size_t)q;
      memcpy(h->inverse_next[at], strains.inverse[q], TENSOR_BYTES);
      add_energies(h, at, branches, h->steps[p->part_material_of[e]], strains.C[q],
                   strains.volume_m3[q], out);
    }
  }
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status, "an element is inverted at the end of a step");
}

void dea_internal_variables_accept(struct dea_internal_variables *h, const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    const struct dea_branches *branches = &h->branches[p->part_material_of[e]];
    const struct dea_branch_step *steps = h->steps[p->part_material_of[e]];
    size_t from = h->first[e],
           to = from != ELASTIC ? from + (size_t)dea_solid_element(s, e)->points : from;
    for (size_t at = from; at < to; at++) {
      for (size_t i = 0; i < branches->count; i++) {
        dea_branch_update(&steps[i].end, h->A[at][i], h->inverse[at], h->inverse_next[at],
                          h->A[at][i]);
      }
      memcpy(h->inverse[at], h->inverse_next[at], TENSOR_BYTES);
    }
  }
}
