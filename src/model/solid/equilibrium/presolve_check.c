/* What can be said of a solid before anything is solved: elements, laws, supports. */
#include "model/solid/equilibrium/presolve_check.h"

#include "base/rounded.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/problem.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

enum { RIGID = 6 }; // motions of a rigid body

static dea_status check_element(struct dea_context *ctx, const struct dea_solid *s, size_t e)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0};
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_element_strains strains;
  double X[DEA_HEX_DOFS_MAX], x[3];
  const struct dea_element_input in = {
      .part_material = dea_solid_part_material(s, e), .X = X, .u = rest};
  dea_solid_gather(s, e, s->problem.grid->X, X);
  if (element->type->strains(element, &in, &strains) == DEA_OK) {
    return DEA_OK;
  }
  dea_solid_element_middle(s, e, x);
  return dea_fail(ctx, DEA_E_ARGUMENT,
                  "element %zu around (%.4g, %.4g, %.4g) mm is inverted in the mesh: its nodes are "
                  "in the wrong order or folded over each other",
                  e, x[0], x[1], x[2]);
}

static dea_status check_part_materials(struct dea_context *ctx, const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  struct dea_point point;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    const struct dea_part_material *part_material = dea_solid_part_material(s, e);
    if ((e == 0 || p->part_material_of[e] != p->part_material_of[e - 1]) &&
        dea_part_material_point(part_material, one, one, 1, 0, 0, true, &point) != DEA_OK) {
      return dea_fail(
          ctx, DEA_E_DOMAIN,
          "the law '%s' ends before the pre-stretch %.4g: take a smaller pre-stretch or "
          "parameters that reach further",
          part_material->law->name, part_material->pre_stretch[0]);
    }
  }
  return DEA_OK;
}

/* ---- supports ---- */

static int root_of(int *parent, int node)
{
  while (parent[node] != node) {
    parent[node] = parent[parent[node]];
    node = parent[node];
  }
  return node;
}

/* Displacement of a held component (axis q, a unit vector) at X under each rigid motion, with
 * rotations about `centre` and lengths over `length`. */
static void rigid_row(const double X[3], const double centre[3], double length, const double q[3],
                      double row[RIGID])
{
  double r[3];
  for (int i = 0; i < 3; i++) {
    row[i] = q[i];
    r[i] = (X[i] - centre[i]) / length;
  }
  dea_cross(r, q, row + 3); // q . (e_i x r) = e_i . (r x q)
}

/* Sum of the squares of rigid_row over the held components of one body. */
static void collect(const struct dea_solid *s, const int *parent, int body, const double centre[3],
                    double length, double gram[RIGID * RIGID])
{
  const struct dea_solid_problem *p = &s->problem;
  static const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  memset(gram, 0, RIGID * RIGID * sizeof *gram);
  for (size_t n = 0; n < p->grid->node_count; n++) {
    const double *Q = p->frame != NULL && p->frame[n] != 0 ? p->frames[p->frame[n] - 1] : axes;
    for (int i = 0; i < 3 && parent[n] == body; i++) {
      double row[RIGID];
      unsigned char held = p->held[3 * n + (size_t)i];
      if (held && held != DEA_FOLLOWS) {
        rigid_row(p->grid->X + 3 * n, centre, length, Q + 3 * i, row);
        if (dea_solid_turns_body(s, n)) { // a turn as such, wherever
          memset(row, 0, sizeof row);
          row[3 + i] = 1;
        }
        for (int a = 0; a < RIGID * RIGID; a++) {
          gram[a] += row[a / RIGID] * row[a % RIGID];
        }
      }
    }
  }
}

/* Whether supports leave a body no rigid motion. */
static bool is_held(const struct dea_solid *s, const int *parent, int body)
{
  const struct dea_solid_problem *p = &s->problem;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  double centre[3], length = 0, gram[RIGID * RIGID], values[RIGID];
  for (size_t n = 0; n < p->grid->node_count; n++) {
    for (int i = 0; i < 3 && parent[n] == body; i++) {
      low[i] = fmin(low[i], p->grid->X[3 * n + (size_t)i]);
      high[i] = fmax(high[i], p->grid->X[3 * n + (size_t)i]);
    }
  }
  for (int i = 0; i < 3; i++) {
    centre[i] = 0.5 * (low[i] + high[i]);
    length = fmax(length, high[i] - low[i]);
  }
  collect(s, parent, body, centre, length, gram);
  int info = LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', RIGID, gram, RIGID, values);
  return info == 0 && values[0] > 1e-12 * values[RIGID - 1];
}

/* Whether the nodes of elements that follow a body stay where they are under none of the turns that
 * it may take. */
static bool is_turned_by_film(const struct dea_solid *s, size_t body)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_solid_body *b = &p->bodies[body];
  double gram[9] = {0}, values[3], row[RIGID];
  static const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (size_t e = 0; e < p->grid->element_count; e++) {
    for (int i = 0; i < dea_grid_nodes_of(p->grid, e); i++) {
      int n = p->grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)i];
      for (int q = 0; q < 3 && p->body_of[n] == (int)body + 1; q++) {
        rigid_row(p->grid->X + 3 * n, p->grid->X + 3 * b->node, b->length_m, axes + 3 * q, row);
        for (int a = 0; a < 9; a++) {
          bool held =
              p->held[3 * b->node + 3 + (size_t)a / 3] || p->held[3 * b->node + 3 + (size_t)a % 3];
          gram[a] += held ? a % 4 == 0 : row[3 + a / 3] * row[3 + a % 3];
        }
      }
    }
  }
  int info = LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 3, gram, 3, values);
  return info == 0 && values[0] > 1e-12 * values[2];
}

static dea_status check_bodies(struct dea_context *ctx, const struct dea_solid *s)
{
  for (size_t k = 0; k < s->problem.body_count; k++) {
    if (!is_turned_by_film(s, k)) {
      return dea_fail(ctx, DEA_E_ARGUMENT,
                      "rigid body %zu can turn without moving any of its nodes: hold its turns, or "
                      "give it springs",
                      k);
    }
  }
  return DEA_OK;
}

static dea_status check_supports(struct dea_context *ctx, const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  int *parent = dea_alloc(ctx, p->grid->node_count, sizeof *parent);
  dea_status status = DEA_OK;
  DEA_TRY_MEMORY(parent != NULL);
  for (size_t n = 0; n < p->grid->node_count; n++) {
    parent[n] = (int)n;
  }
  for (size_t e = 0; e < p->grid->element_count; e++) {
    const int *nodes = p->grid->nodes + e * DEA_HEX_NODES_MAX;
    for (int n = 1; n < dea_grid_nodes_of(p->grid, e); n++) {
      parent[root_of(parent, nodes[n])] = root_of(parent, nodes[0]);
    }
  }
  for (size_t n = 0; n < p->grid->node_count && p->body_count > 0; n++) {
    if (p->body_of[n] > 0) {
      int own = (int)p->bodies[p->body_of[n] - 1].node;
      parent[root_of(parent, (int)n)] = root_of(parent, own);
      parent[root_of(parent, own + 1)] = root_of(parent, own);
    }
  }
  for (size_t n = 0; n < p->grid->node_count; n++) {
    parent[n] = root_of(parent, (int)n);
  }
  for (size_t n = 0; n < p->grid->node_count && status == DEA_OK; n++) {
    if (parent[n] == (int)n && !is_held(s, parent, (int)n)) {
      const double *X = p->grid->X + 3 * n;
      status = dea_fail(ctx, DEA_E_ARGUMENT,
                        "what lies at (%.4g, %.4g, %.4g) mm is not held: it can move or turn as a "
                        "whole, so there is no one equilibrium; hold more of its nodes, or give it "
                        "springs",
                        dea_rounded(1e3 * X[0]), dea_rounded(1e3 * X[1]), dea_rounded(1e3 * X[2]));
    }
  }
  dea_free(ctx, parent);
  return status;
}

dea_status dea_solid_check(struct dea_context *ctx, struct dea_solid *s)
{
  if (s->found.checked) {
    return DEA_OK;
  }
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    DEA_TRY(ctx, check_element(ctx, s, e));
  }
  DEA_TRY(ctx, check_part_materials(ctx, s));
  if (s->problem.load_count == 0) { // springs and tips may hold what nothing else does
    DEA_TRY(ctx, check_bodies(ctx, s));
    DEA_TRY(ctx, check_supports(ctx, s));
  }
  s->found.checked = true;
  return DEA_OK;
}
