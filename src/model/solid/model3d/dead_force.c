#include "model/solid/model3d/dead_force.h"

#include "model/solid/mesh/surface.h"

#include <math.h>
#include <string.h>

/* Nodes as points of their own rule, in the plane and through the thickness. */
struct rule {
  struct dea_face_shape plane, column;
};

static void build_rule(const struct dea_grid *g, struct rule *out)
{
  const int orders[2] = {g->order, g->order_z};
  for (int i = 0; i < 2; i++) {
    const struct dea_surface face = {.order = {orders[i], orders[i]},
                                     .face_nodes = (orders[i] + 1) * (orders[i] + 1)};
    dea_face_shape_create(&face, DEA_FACE_AT_NODES, i == 0 ? &out->plane : &out->column);
  }
}

/* Area of an element by its nodes in the plane, all of them marked, and length of its sides whose
 * nodes are. X: [nodes in the plane][3]. */
static void measure(const struct dea_grid *g, const struct dea_face_shape *plane, bool edge,
                    const bool *marked, const int *nodes, double *part)
{
  const int last = g->order, per = last + 1, count = per * per;
  double X[3 * DEA_FACE_NODES_MAX], line[DEA_FACE_NODES_MAX] = {0};
  bool on[2][2] = {{true, true}, {true, true}}, all = true; // sides: axis across, low and high
  for (int n = 0; n < count; n++) {
    const int at[2] = {n % per, n / per};
    const bool marks = marked[g->column[nodes[n]]];
    memcpy(X + 3 * n, g->X + 3 * nodes[n], 3 * sizeof *X);
    line[at[0]] += plane->weight[n];
    all = all && marks;
    for (int a = 0; a < 2; a++) {
      on[a][0] = on[a][0] && (marks || at[a] != 0);
      on[a][1] = on[a][1] && (marks || at[a] != last);
    }
  }
  for (int n = 0; n < count; n++) {
    const int at[2] = {n % per, n / per};
    double normal[3];
    dea_face_normal(plane, n, X, normal);
    part[n] = !edge && all ? plane->weight[n] * normal[2] : 0;
    for (int a = 0; edge && a < 2; a++) {
      double t[2] = {0}; // along the side
      for (int m = 0; m < count; m++) {
        t[0] += plane->slope[n][1 - a][m] * X[3 * m];
        t[1] += plane->slope[n][1 - a][m] * X[3 * m + 1];
      }
      const bool here = (at[a] == 0 && on[a][0]) || (at[a] == last && on[a][1]);
      part[n] += here ? line[at[1 - a]] * hypot(t[0], t[1]) : 0;
    }
  }
}

/* Adds the shares of an element's nodes; returns their sum. */
static double add_element(const struct dea_layout_mesh *mesh, size_t e, bool edge,
                          const bool *marked, const struct rule *rule, double *share)
{
  const struct dea_grid *g = mesh->grid;
  const int *nodes = g->nodes + e * DEA_HEX_NODES_MAX;
  const int count = (g->order + 1) * (g->order + 1), levels = g->levels[e];
  double part[DEA_FACE_NODES_MAX], total = 0;
  measure(g, &rule->plane, edge, marked, nodes, part);
  for (int n = 0; n < count; n++) {
    const int top = nodes[n + count * (levels - 1)];
    const double height_m = levels == 1 ? mesh->layout->plies[g->ply[e]].thickness_m
                                        : g->X[3 * top + 2] - g->X[3 * nodes[n] + 2];
    for (int k = 0; k < levels; k++) {
      double weight = levels == 1 ? 1 : 0;
      for (int i = 0; i < levels && levels > 1; i++) {
        weight += rule->column.weight[k + i * levels];
      }
      share[nodes[n + k * count]] += part[n] * height_m * weight;
      total += part[n] * height_m * weight;
    }
  }
  return total;
}

dea_status dea_dead_force_add(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                              const struct dea_layout_support *support, bool *flagged,
                              double *force)
{
  const struct dea_grid *g = mesh->grid;
  double *share = dea_alloc(ctx, g->node_count, sizeof *share), total = 0;
  struct rule rule;
  DEA_TRY_MEMORY(share != NULL);
  build_rule(g, &rule);
  dea_layout_mesh_mark(mesh, support->region, support->edge, support->within, flagged);
  for (int inside = 1; inside >= 0 && total == 0; inside--) { // an edge has two sides
    for (size_t e = 0; e < g->element_count; e++) {
      if (dea_layout_mesh_within(mesh, e, support->region) == (inside != 0)) {
        total += add_element(mesh, e, support->edge, flagged, &rule, share);
      }
    }
  }
  total *= (double)dea_layout_sector_copies(&mesh->sector);
  for (size_t n = 0; n < g->node_count; n++) {
    double Q[9]; // a node on a side of the sector may have axes of its own
    if (share[n] > 0) {
      dea_layout_sector_holds(&mesh->sector, g->X + 3 * n, mesh->near_m, Q);
      for (size_t k = 0; k < 9; k++) {
        force[3 * n + k / 3] += share[n] / total * Q[k] * support->force_N[k % 3];
      }
    }
  }
  dea_free(ctx, share);
  return DEA_OK;
}
