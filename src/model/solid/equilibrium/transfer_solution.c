#include "model/solid/equilibrium/transfer_solution.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/follow.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>
#include <string.h>

/* ---- elements that are inverted ---- */

enum { RINGS = 8, SWEEPS = 200 };
static const double soft = 10; // times the softest modulus: what is moved
static const double part = 0.5;

struct untangling {
  struct dea_solid *s;
  double *u, *mean, *weight; // [nodes][3], [nodes][3], [nodes]
  unsigned char *stiff;      // [nodes] of an element that stays as it is
  unsigned char *moves, *next;
  struct dea_element_strains *strains;
};

static bool is_soft(const struct dea_solid *s, size_t e)
{
  return dea_part_material_modulus(dea_solid_part_material(s, e)) <= soft * s->problem.modulus_Pa;
}

static bool is_inverted(const struct untangling *t, size_t e)
{
  const struct dea_element *element = dea_solid_element(t->s, e);
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX];
  const struct dea_element_input in = {
      .part_material = dea_solid_part_material(t->s, e), .X = X, .u = u};
  dea_solid_gather(t->s, e, t->s->problem.grid->X, X);
  dea_solid_gather(t->s, e, t->u, u);
  return element->type->strains(element, &in, t->strains) == DEA_E_DOMAIN;
}

static void mark(const struct dea_solid *s, size_t e, unsigned char *nodes)
{
  const int *of;
  int count = dea_solid_nodes(s, e, &of);
  for (int n = 0; n < count; n++) {
    nodes[of[n]] = 1;
  }
}

/* Marks nodes of inverted elements; returns how many elements those are. */
static size_t mark_inverted(const struct untangling *t)
{
  size_t count = 0;
  for (size_t e = 0; e < t->s->problem.grid->element_count; e++) {
    if (is_soft(t->s, e) && is_inverted(t, e)) {
      mark(t->s, e, t->moves);
      count++;
    }
  }
  return count;
}

/* Marks nodes of the elements around those that are marked. */
static void mark_around(struct untangling *t)
{
  const struct dea_grid *grid = t->s->problem.grid;
  memcpy(t->next, t->moves, grid->node_count);
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes;
    int count = dea_solid_nodes(t->s, e, &nodes), n = 0;
    while (n < count && !t->moves[nodes[n]]) {
      n++;
    }
    if (n < count && is_soft(t->s, e)) {
      mark(t->s, e, t->next);
    }
  }
  memcpy(t->moves, t->next, grid->node_count);
}

/* Adds two neighbours to each other's mean, by the inverse of their distance. */
static void add_pair(struct untangling *t, size_t a, size_t b)
{
  const double *X = t->s->problem.grid->X;
  double weight = 1 / hypot(X[3 * a] - X[3 * b], X[3 * a + 1] - X[3 * b + 1]);
  for (size_t i = 0; i < 3; i++) {
    t->mean[3 * a + i] += weight * t->u[3 * b + i];
    t->mean[3 * b + i] += weight * t->u[3 * a + i];
  }
  t->weight[a] += weight;
  t->weight[b] += weight;
}

/* Means of the neighbours along the lines of the soft elements' levels. */
static void find_means(struct untangling *t)
{
  const struct dea_grid *grid = t->s->problem.grid;
  int line = grid->order + 1;
  memset(t->mean, 0, 3 * grid->node_count * sizeof *t->mean);
  memset(t->weight, 0, grid->node_count * sizeof *t->weight);
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    for (int k = 0; k < line * line * grid->levels[e] && is_soft(t->s, e); k++) {
      if (k % line + 1 < line) {
        add_pair(t, (size_t)nodes[k], (size_t)nodes[k + 1]);
      }
      if (k / line % line + 1 < line) {
        add_pair(t, (size_t)nodes[k], (size_t)nodes[k + line]);
      }
    }
  }
}

/* One sweep over the nodes that are marked. */
static void move_nodes(struct untangling *t)
{
  const struct dea_grid *grid = t->s->problem.grid;
  find_means(t);
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    size_t n = i / 3;
    bool goes = t->moves[n] && !t->stiff[n] && t->weight[n] > 0;
    t->mean[i] = goes ? part * (t->mean[i] / t->weight[n] - t->u[i]) : 0;
  }
  dea_solid_release_held(t->s, t->mean);
  for (size_t i = 0; i < 3 * grid->node_count; i++) {
    t->u[i] += t->mean[i];
  }
}

/* Sweeps over inverted elements and so many rings of elements around them. */
static size_t sweep(struct untangling *t, int rings)
{
  const struct dea_grid *grid = t->s->problem.grid;
  size_t left = 0;
  memset(t->moves, 0, grid->node_count);
  for (int k = 0; k < SWEEPS; k++) {
    left = mark_inverted(t);
    if (left == 0) {
      return 0;
    }
    for (int ring = 0; ring < rings && k == 0; ring++) {
      mark_around(t);
    }
    move_nodes(t);
  }
  return left;
}

static dea_status untangling_create(struct dea_arena *memory, struct dea_solid *s,
                                    struct untangling *out)
{
  const struct dea_grid *grid = s->problem.grid;
  *out = (struct untangling){
      .s = s,
      .u = dea_arena_alloc(memory, s->problem.dofs, sizeof *out->u),
      .mean = dea_arena_alloc(memory, s->problem.dofs, sizeof *out->mean),
      .weight = dea_arena_alloc(memory, grid->node_count, sizeof *out->weight),
      .stiff = dea_arena_alloc(memory, grid->node_count, sizeof *out->stiff),
      .moves = dea_arena_alloc(memory, grid->node_count, sizeof *out->moves),
      .next = dea_arena_alloc(memory, grid->node_count, sizeof *out->next),
      .strains = dea_arena_alloc(memory, 1, sizeof *out->strains),
  };
  for (size_t e = 0; e < grid->element_count && !memory->failed; e++) {
    if (!is_soft(s, e)) {
      mark(s, e, out->stiff);
    }
  }
  return dea_arena_status(memory);
}

dea_status dea_solid_untangle(struct dea_context *ctx, struct dea_solid *s, double *u, size_t *left)
{
  size_t size = 3 * s->problem.grid->node_count * sizeof *u;
  struct dea_arena memory = {.ctx = ctx};
  struct untangling t;
  dea_status status = dea_solid_allreduce(ctx, untangling_create(&memory, s, &t));
  *left = 0;
  for (int rings = 0; status == DEA_OK && rings < RINGS && (rings == 0 || *left > 0); rings++) {
    memcpy(t.u, u, size);
    *left = sweep(&t, rings);
  }
  if (status == DEA_OK && *left == 0) {
    memcpy(u, t.u, size);
  }
  dea_arena_free(&memory);
  return status;
}

/* ---- springs that hold near to displacements ---- */

/* k/2 |u - u0|^2 of each node. In units of the softest modulus over the solid's length squared: a
 * plate of bending stiffness mu h^3/3 under a compression mu h s buckles on a foundation up to
 * 3 mu s^2/(4 h). */
static const double hold_first = 10, hold_less = 30, hold_least = 1e-3;

struct hold {
  const double *u0, *volume; // [nodes][3], [nodes][3]
  double k;                  // per volume [N/m^4]
};

static dea_status evaluate_hold(const void *self, size_t piece, const double *u,
                                enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct hold *hold = self;
  out->node_count = 1;
  out->nodes[0] = (int)piece;
  out->energy_J = 0;
  memset(out->K, 0, level >= DEA_TANGENT ? 9 * sizeof *out->K : 0);
  for (size_t i = 0; i < 3; i++) {
    double k = hold->k * hold->volume[3 * piece + i],
           away = u[3 * piece + i] - hold->u0[3 * piece + i];
    out->energy_J += 0.5 * k * away * away;
    out->g[i] = k * away;
    if (level >= DEA_TANGENT) {
      out->K[4 * i] = k;
    }
  }
  return DEA_OK;
}

/* Equilibria with softer and softer springs, from the displacements of the solid. */
static dea_status fade(struct dea_context *ctx, struct dea_solid *s, struct hold *hold)
{
  const struct dea_solid_load load = {
      .self = hold, .piece_count = s->problem.grid->node_count, .evaluate = evaluate_hold};
  const double unit = s->problem.modulus_Pa / (s->problem.length_m * s->problem.length_m);
  dea_status status = dea_solid_allreduce(ctx, dea_solid_add_load(ctx, s, &load));
  DEA_TRY_STATUS(status);
  for (double k = hold_first; k > hold_least && status == DEA_OK; k /= hold_less) {
    struct dea_solid_report report = {.load_factor = 1};
    hold->k = k * unit;
    dea_solid_forget(s);
    status = dea_solid_equilibrate(ctx, s, &report);
  }
  s->problem.load_count--;
  dea_solid_forget(s);
  return status;
}

/* ---- from one mesh to another ---- */

/* Memory of one, [dofs] or [state_count] each. */
struct transfer {
  struct dea_arena memory;
  double *increment; // to where it is transferred
  double *goal;      // displacements there
  double *start;     // the same, with no element inverted
  double *volume;    // of nodes
  double *state, *controls;
};

static dea_status transfer_create(struct dea_context *ctx, struct dea_solid *s,
                                  struct transfer *out)
{
  size_t dofs = s->problem.dofs;
  *out = (struct transfer){.memory = {.ctx = ctx}};
  struct dea_arena *memory = &out->memory;
  out->increment = dea_arena_alloc(memory, dofs, sizeof(double));
  out->goal = dea_arena_alloc(memory, dofs, sizeof(double));
  out->start = dea_arena_alloc(memory, dofs, sizeof(double));
  out->volume = dea_arena_alloc(memory, dofs, sizeof(double));
  out->state = dea_arena_alloc(memory, s->work.load_steps.state_count, sizeof(double));
  out->controls = dea_arena_alloc(memory, s->work.load_steps.control_count, sizeof(double));
  return dea_solid_allreduce(ctx, dea_arena_status(memory));
}

/* way: from where the solid is to u, where it is free to go. */
static void set_increment(const struct dea_solid *s, const double *u, double *increment)
{
  memset(increment, 0, s->problem.dofs * sizeof *increment);
  for (size_t i = 0; i < 3 * s->problem.grid->node_count; i++) {
    increment[i] = u[i] - s->state.u[i];
  }
  dea_solid_release_held(s, increment);
}

/* From c->start, held near to c->goal at first. */
static dea_status transfer_held(struct dea_context *ctx, struct dea_solid *s, struct transfer *c,
                                struct dea_solid_report *report, bool *found)
{
  struct hold hold = {.u0 = c->goal, .volume = c->volume};
  dea_solid_lump_volume(s, c->volume);
  set_increment(s, c->start, c->increment);
  for (size_t i = 0; i < s->problem.dofs; i++) {
    s->state.u[i] += c->increment[i];
  }
  dea_status status = fade(ctx, s, &hold);
  memset(c->increment, 0, s->problem.dofs * sizeof *c->increment);
  status = status == DEA_OK ? dea_solid_perturb(ctx, s, c->increment, NULL, NULL, report, found)
                            : status;
  return dea_solid_excuse(ctx, status);
}

/* At the controls of the goal. */
static dea_status transfer(struct dea_context *ctx, struct dea_solid *s, struct transfer *c,
                           const double *u, struct dea_solid_report *report, bool *found)
{
  size_t left;
  set_increment(s, u, c->increment);
  for (size_t i = 0; i < s->problem.dofs; i++) {
    c->goal[i] = c->start[i] = s->state.u[i] + c->increment[i];
  }
  DEA_TRY(ctx, dea_solid_untangle(ctx, s, c->start, &left));
  if (left > 0) {
    return DEA_OK;
  }
  set_increment(s, c->start, c->increment);
  DEA_TRY(ctx, dea_solid_perturb(ctx, s, c->increment, NULL, NULL, report, found));
  return *found ? DEA_OK : transfer_held(ctx, s, c, report, found);
}

dea_status dea_solid_transfer_solution(struct dea_context *ctx, struct dea_solid *s,
                                       double voltage_V, const double *displacement_m,
                                       struct dea_solid_report *report, bool *found)
{
  const struct dea_solid_report before = *report;
  const double own = s->settings.descent_bulk_factor;
  struct transfer c;
  *found = false;
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_load_steps_prepare(ctx, s)));
  struct dea_load_steps *path = &s->work.load_steps;
  dea_status status = transfer_create(ctx, s, &c);
  if (status == DEA_OK) {
    dea_solid_state_get(s, c.state);
    dea_solid_controls_get(s, c.controls);
    dea_solid_controls_goal(s, voltage_V, path->controls_goal);
    dea_solid_controls_set(s, path->controls_goal);
    s->settings.descent_bulk_factor = 1; // it is near
    status = transfer(ctx, s, &c, displacement_m, report, found);
    s->settings.descent_bulk_factor = own;
    if (!*found) {
      dea_solid_controls_set(s, c.controls);
      dea_solid_state_set(s, c.state);
      *report = before;
      dea_solid_forget(s);
    }
  }
  dea_arena_free(&c.memory);
  return DEA_CHAIN(ctx, status);
}
