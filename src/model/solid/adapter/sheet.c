#include "model/solid/adapter/sheet.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/element/membrane.h"

#include <math.h>
#include <petscksp.h>

/* Number of an unknown at each end of an element's capacitance, negative: that of a channel, -1 -
 * k.
 */
enum { TOP, BOTTOM, SIDES };

/* A step, or a part of it, to a share of the way between the accepted state and the present one. */
struct part {
  double share, length_s;
  const double *charge_C; // [unknowns] that it starts from
};

struct dea_sheet {
  struct dea_arena memory;
  const struct dea_layout_mesh *mesh;
  struct dea_solid *solid;
  const double *per_s;
  struct dea_flat_shape shape;
  size_t columns, unknowns, channels;
  int *at;        // [electrodes][columns] number of an unknown from 1 on; 0: none
  int *node;      // [electrodes][columns] of the grid
  size_t *first;  // [electrodes] the first one on the same face and channel
  double *shares; // [elements][shape.nodes] of its plane nodes in an element's capacitance
  int *channel;   // [unknowns]
  int *lead;      // [unknowns] its channel, where it is at that; -1: elsewhere
  int (*end)[2];  // [elements] electrode at TOP and BOTTOM with a resistance; -1: without
  double *capacitance_F[2];          // [elements] accepted, present
  double *u;                         // [nodes][3] accepted
  double *channel_V[2];              // [channels] accepted, present
  double *potential_V;               // [unknowns] present
  double *charge_C, *charge_next_C;  // [unknowns] accepted, present
  double *half_V, *whole_V, *half_C; // [unknowns] work
  double *off_V, factor;             // [unknowns] what the film would change them by, and how far
  double error, largest_C;
  Mat A;
  KSP solver;
  Vec right, solution;
};

// Places -----------------------------------------------------------------------------------------

static const struct dea_layout_electrode *electrode(const struct dea_sheet *sheet, size_t i)
{
  return &sheet->mesh->layout->electrodes[i];
}

static bool resists(const struct dea_sheet *sheet, size_t i)
{
  return electrode(sheet, i)->sheet_resistance_ohm > 0;
}

/* The first of the electrodes on the same face and channel. */
static size_t first_of(const struct dea_sheet *sheet, size_t i)
{
  const struct dea_layout_electrode *a = electrode(sheet, i);
  const double(*face_m)[2] = (const double(*)[2])sheet->mesh->face_m;
  size_t j = 0;
  while (j < i) {
    const struct dea_layout_electrode *b = electrode(sheet, j);
    const double away_m = face_m[a->ply][a->top ? 1 : 0] - face_m[b->ply][b->top ? 1 : 0];
    if (a->channel == b->channel && fabs(away_m) <= 1e-3 * sheet->mesh->near_m) {
      break;
    }
    j++;
  }
  return j;
}

static int *unknown_at(const struct dea_sheet *sheet, size_t i, int column)
{
  return &sheet->at[sheet->first[i] * sheet->columns + (size_t)column];
}

/* Whether a quadrilateral of the plane mesh has an electrode. */
static bool covers(const struct dea_sheet *sheet, size_t i, size_t quad)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  const struct dea_layout_electrode *e = electrode(sheet, i);
  const size_t region = (size_t)mesh->plane->region[quad];
  return mesh->present[region * mesh->layout->ply_count + e->ply] &&
         dea_layout_mesh_is_within(mesh, region, e->region);
}

static const int *quad_nodes(const struct dea_sheet *sheet, size_t quad)
{
  return sheet->mesh->plane->quads + quad * (size_t)sheet->shape.nodes;
}

/* Column of the plane node of an element. */
static int column_of(const struct dea_sheet *sheet, size_t e, int n)
{
  const struct dea_grid *grid = sheet->mesh->grid;
  return grid->column[grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]];
}

/* Numbers the unknowns of electrodes with a resistance, and finds nodes of the grid at them. */
static void number(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  const struct dea_grid *grid = mesh->grid;
  for (size_t i = 0; i < mesh->layout->electrode_count; i++) {
    const struct dea_layout_electrode *own = electrode(sheet, i);
    for (size_t q = 0; resists(sheet, i) && q < mesh->plane->quad_count; q++) {
      for (int n = 0; covers(sheet, i, q) && n < sheet->shape.nodes; n++) {
        int *at = unknown_at(sheet, i, quad_nodes(sheet, q)[n]);
        *at = *at > 0 ? *at : (int)++sheet->unknowns;
      }
    }
    for (size_t e = 0; e < grid->element_count; e++) {
      const int last = (grid->levels[e] - 1) * sheet->shape.nodes;
      for (int n = 0; (size_t)grid->ply[e] == own->ply && n < sheet->shape.nodes; n++) {
        sheet->node[i * sheet->columns + (size_t)column_of(sheet, e, n)] =
            grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)(n + (own->top ? last : 0))];
      }
    }
  }
}

/* Distance of a point from the outer edge of an electrode. */
static double edge_distance_m(const struct dea_region *region, const double x[2])
{
  double least = INFINITY;
  for (size_t k = 0; k < region->contour_count; k++) {
    const struct dea_contour contour = dea_region_contour(region, k);
    if (dea_contour_area_m2(&contour) > 0) {
      least = fmin(least, dea_contour_distance_m(&contour, x));
    }
  }
  return least;
}

/* Whether another electrode on the same face and channel meets one, and, where that is ideal, that
 * its lead is there. */
static bool meets(struct dea_sheet *sheet, size_t i, size_t other)
{
  bool any = false;
  for (size_t q = 0; q < sheet->mesh->plane->quad_count; q++) {
    for (int n = 0; covers(sheet, other, q) && n < sheet->shape.nodes; n++) {
      const int column = quad_nodes(sheet, q)[n];
      const int at = *unknown_at(sheet, i, column);
      if (at > 0 && !resists(sheet, other)) {
        sheet->lead[at - 1] = (int)electrode(sheet, i)->channel;
      }
      any = any || at > 0;
    }
  }
  return any;
}

/* The lead is where an ideal electrode meets one with a resistance, else all along its edge. */
static void find_leads(struct dea_sheet *sheet)
{
  const struct dea_layout *l = sheet->mesh->layout;
  for (size_t i = 0; i < l->electrode_count; i++) {
    bool led = false;
    for (size_t j = 0; j < l->electrode_count && resists(sheet, i); j++) {
      const bool same = j != i && sheet->first[j] == sheet->first[i];
      led = (same && meets(sheet, i, j)) || led;
    }
    for (size_t q = 0; q < sheet->mesh->plane->quad_count && resists(sheet, i) && !led; q++) {
      for (int n = 0; covers(sheet, i, q) && n < sheet->shape.nodes; n++) {
        const int column = quad_nodes(sheet, q)[n];
        if (edge_distance_m(&l->regions[electrode(sheet, i)->region].region,
                            sheet->mesh->plane->x + 2 * column) <= sheet->mesh->near_m) {
          sheet->lead[*unknown_at(sheet, i, column) - 1] = (int)electrode(sheet, i)->channel;
        }
      }
    }
  }
}

static void find_ends(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  for (size_t e = 0; e < mesh->grid->element_count; e++) {
    const struct dea_layout_field *field =
        &mesh->field[(size_t)mesh->grid->region[e] * mesh->layout->ply_count +
                     (size_t)mesh->grid->ply[e]];
    const int at[SIDES] = {field->top_electrode, field->bottom_electrode};
    for (int k = 0; k < SIDES; k++) {
      sheet->end[e][k] =
          sheet->solid->problem.active[e] && resists(sheet, (size_t)at[k]) ? at[k] : -1;
    }
  }
}

/* Whether an element charges through a resistance. */
static bool counts(const struct dea_sheet *sheet, size_t e)
{
  return sheet->end[e][TOP] >= 0 || sheet->end[e][BOTTOM] >= 0;
}

/* Unknown at an end of an element over a plane node of it, or -1 - its channel. */
static int end_of(const struct dea_sheet *sheet, size_t e, int side, int n)
{
  const int i = sheet->end[e][side];
  return i >= 0 ? *unknown_at(sheet, (size_t)i, column_of(sheet, e, n)) - 1
                : -1 - sheet->solid->problem.between[e][side];
}

/* Shares of the plane nodes of an element in its capacitance: of the integrals of their bases, all
 * of which are positive at Gauss-Lobatto points. */
static void find_shares(struct dea_sheet *sheet, size_t e)
{
  const struct dea_flat_shape *s = &sheet->shape;
  double *out = sheet->shares + e * (size_t)s->nodes;
  double sum = 0;
  for (int q = 0; q < s->gauss; q++) {
    double map[4] = {0};
    for (int n = 0; n < s->nodes; n++) {
      const double *x = sheet->mesh->plane->x + 2 * column_of(sheet, e, n);
      for (int a = 0; a < 4; a++) {
        map[a] += x[a / 2] * s->slope[q][a % 2][n];
      }
    }
    const double area = s->weight[q] * (map[0] * map[3] - map[1] * map[2]);
    sum += area;
    for (int n = 0; n < s->nodes; n++) {
      out[n] += area * s->value[q][n];
    }
  }
  for (int n = 0; n < s->nodes; n++) {
    out[n] /= sum;
  }
}

// Matrices ---------------------------------------------------------------------------------------

static double mean_of(const double *const of[2], double share, size_t i)
{
  return (1 - share) * of[0][i] + share * of[1][i];
}

static double channel_V(const struct dea_sheet *sheet, double share, int k)
{
  return mean_of((const double *const *)sheet->channel_V, share, (size_t)k);
}

/* A[row][column] += value, where what is known goes to the right side. */
static PetscErrorCode add(const struct dea_sheet *sheet, double share, int row, int column,
                          double value, double *right)
{
  if (row < 0 || sheet->lead[row] >= 0) {
    return 0;
  }
  const int known = column < 0 ? -1 - column : sheet->lead[column];
  if (known >= 0) {
    right[row] -= value * channel_V(sheet, share, known);
    return 0;
  }
  return MatSetValue(sheet->A, row, column, value, ADD_VALUES);
}

static PetscErrorCode add_capacitances(const struct dea_sheet *sheet, const struct part *part,
                                       double *right)
{
  PetscErrorCode code = 0;
  for (size_t e = 0; e < sheet->mesh->grid->element_count && code == 0; e++) {
    if (!counts(sheet, e)) {
      continue;
    }
    const double C = mean_of((const double *const *)sheet->capacitance_F, part->share, e);
    const double per_s =
        1 / part->length_s + sheet->per_s[sheet->solid->problem.part_material_of[e]];
    const double *shares = sheet->shares + e * (size_t)sheet->shape.nodes;
    for (int n = 0; n < 4 * sheet->shape.nodes && code == 0; n++) {
      const int row = end_of(sheet, e, n % 2, n / 4), column = end_of(sheet, e, n / 2 % 2, n / 4);
      code = add(sheet, part->share, row, column,
                 (n % 2 == n / 2 % 2 ? 1 : -1) * per_s * C * shares[n / 4], right);
    }
  }
  return code;
}

/* Conductances [nodes][nodes] of a quadrilateral of an electrode of 1 ohm per square as it is
 * deformed: the integral of grad N_a . grad N_b over the surface. */
static void find_conductances(const struct dea_sheet *sheet, size_t i, size_t quad, double share,
                              double *out)
{
  const struct dea_flat_shape *s = &sheet->shape;
  const double *X = sheet->mesh->grid->X, *const u[2] = {sheet->u, sheet->solid->state.u};
  memset(out, 0, (size_t)(s->nodes * s->nodes) * sizeof *out);
  for (int q = 0; q < s->gauss; q++) {
    double g[2][3] = {{0}}, G[3] = {0}; // tangents and their products 11 22 12
    for (int n = 0; n < 3 * s->nodes; n++) {
      const int column = quad_nodes(sheet, quad)[n / 3];
      const size_t at =
          3 * (size_t)sheet->node[i * sheet->columns + (size_t)column] + (size_t)(n % 3);
      for (int a = 0; a < 2; a++) {
        g[a][n % 3] += (X[at] + mean_of(u, share, at)) * s->slope[q][a][n / 3];
      }
    }
    for (int k = 0; k < 3; k++) {
      G[0] += g[0][k] * g[0][k];
      G[1] += g[1][k] * g[1][k];
      G[2] += g[0][k] * g[1][k];
    }
    const double weight = s->weight[q] / sqrt(G[0] * G[1] - G[2] * G[2]);
    for (int a = 0; a < s->nodes; a++) {
      for (int b = 0; b < s->nodes; b++) {
        const double a1 = s->slope[q][0][a], a2 = s->slope[q][1][a];
        const double b1 = s->slope[q][0][b], b2 = s->slope[q][1][b];
        out[a * s->nodes + b] +=
            weight * (G[1] * a1 * b1 + G[0] * a2 * b2 - G[2] * (a1 * b2 + a2 * b1));
      }
    }
  }
}

static PetscErrorCode add_electrode(const struct dea_sheet *sheet, size_t i, double share,
                                    double *right)
{
  double K[DEA_FLAT_NODES_MAX * DEA_FLAT_NODES_MAX];
  const int nodes = sheet->shape.nodes;
  const struct dea_layout_electrode *own = electrode(sheet, i);
  const size_t layers = dea_ply_layers(&sheet->mesh->layout->plies[own->ply]);
  const double per_ohm = 0.5 * (double)(layers + 1) / own->sheet_resistance_ohm; // by turns
  PetscErrorCode code = 0;
  for (size_t q = 0; q < sheet->mesh->plane->quad_count && code == 0; q++) {
    if (!covers(sheet, i, q)) {
      continue;
    }
    find_conductances(sheet, i, q, share, K);
    for (int n = 0; n < nodes * nodes && code == 0; n++) {
      const int row = *unknown_at(sheet, i, quad_nodes(sheet, q)[n / nodes]) - 1;
      const int column = *unknown_at(sheet, i, quad_nodes(sheet, q)[n % nodes]) - 1;
      code = add(sheet, share, row, column, per_ohm * K[n], right);
    }
  }
  return code;
}

/* One implicit Euler step, (M/h + G + K) phi = Q/h, where leads are at their channels. */
static dea_status euler_step(struct dea_context *ctx, struct dea_sheet *sheet,
                             const struct part *part, double *phi)
{
  PetscScalar *right;
  PetscErrorCode code = 0;
  DEA_PETSC(ctx, MatZeroEntries(sheet->A));
  DEA_PETSC(ctx, VecGetArray(sheet->right, &right));
  for (size_t a = 0; a < sheet->unknowns && code == 0; a++) {
    const int at = (int)a, lead = sheet->lead[a];
    right[a] = lead >= 0 ? channel_V(sheet, part->share, lead) : part->charge_C[a] / part->length_s;
    code = MatSetValue(sheet->A, at, at, lead >= 0 ? 1 : 0, ADD_VALUES);
  }
  code = code == 0 ? add_capacitances(sheet, part, right) : code;
  for (size_t i = 0; i < sheet->mesh->layout->electrode_count && code == 0; i++) {
    code = resists(sheet, i) ? add_electrode(sheet, i, part->share, right) : 0;
  }
  DEA_PETSC(ctx, VecRestoreArray(sheet->right, &right));
  DEA_PETSC(ctx, code);
  DEA_PETSC(ctx, MatAssemblyBegin(sheet->A, MAT_FINAL_ASSEMBLY));
  DEA_PETSC(ctx, MatAssemblyEnd(sheet->A, MAT_FINAL_ASSEMBLY));
  DEA_PETSC(ctx, KSPSetOperators(sheet->solver, sheet->A, sheet->A));
  DEA_PETSC(ctx, KSPSolve(sheet->solver, sheet->right, sheet->solution));
  DEA_PETSC(ctx, VecGetArray(sheet->solution, &right));
  memcpy(phi, right, sheet->unknowns * sizeof *phi);
  DEA_PETSC(ctx, VecRestoreArray(sheet->solution, &right));
  return DEA_OK;
}

// Charges and voltages ---------------------------------------------------------------------------

/* Voltage across an element over a plane node of it, at potentials of the present. */
static double across_V(const struct dea_sheet *sheet, double share, const double *phi, size_t e,
                       int n)
{
  double V[SIDES];
  for (int k = 0; k < SIDES; k++) {
    const int at = end_of(sheet, e, k, n);
    V[k] = at >= 0 ? phi[at] : channel_V(sheet, share, -1 - at);
  }
  return V[TOP] - V[BOTTOM];
}

static void find_charges(const struct dea_sheet *sheet, double share, const double *phi,
                         double *charge_C)
{
  memset(charge_C, 0, sheet->unknowns * sizeof *charge_C);
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    if (!counts(sheet, e)) {
      continue;
    }
    const double *shares = sheet->shares + e * (size_t)sheet->shape.nodes;
    for (int n = 0; n < sheet->shape.nodes; n++) {
      const double C = mean_of((const double *const *)sheet->capacitance_F, share, e) * shares[n];
      for (int k = 0; k < SIDES; k++) {
        const int at = end_of(sheet, e, k, n);
        if (at >= 0) {
          charge_C[at] += (k == TOP ? C : -C) * across_V(sheet, share, phi, e, n);
        }
      }
    }
  }
}

/* To elements the root mean square of the voltages over their nodes, which has their energy. */
static void set_goals(struct dea_sheet *sheet)
{
  struct dea_solid_state *state = &sheet->solid->state;
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    double mean = 0, square = 0;
    if (!counts(sheet, e)) {
      continue;
    }
    const double *shares = sheet->shares + e * (size_t)sheet->shape.nodes;
    for (int n = 0; n < sheet->shape.nodes; n++) {
      const double V = across_V(sheet, 1, sheet->potential_V, e, n);
      mean += shares[n] * V;
      square += shares[n] * V * V;
    }
    const double root = copysign(sqrt(square), mean);
    const int *between = sheet->solid->problem.between[e];
    state->drop_goal_V[e] =
        root - (sheet->channel_V[1][between[TOP]] - sheet->channel_V[1][between[BOTTOM]]);
    state->evenness[e] = root != 0 ? mean / root : 1;
  }
}

static dea_status find_capacitances(struct dea_context *ctx, struct dea_sheet *sheet, double *out)
{
  const struct dea_solid_problem *p = &sheet->solid->problem;
  dea_status status = DEA_OK;
  memset(out, 0, p->grid->element_count * sizeof *out);
  for (size_t i = 0; i < p->own_count && status == DEA_OK; i++) {
    const size_t e = p->own[i];
    status = counts(sheet, e)
                 ? dea_solid_element_capacitance(sheet->solid, e, sheet->solid->state.u, &out[e])
                 : DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_agree(ctx, status));
  dea_solid_sum(out, p->grid->element_count);
  return DEA_OK;
}

// Steps ------------------------------------------------------------------------------------------

/* A time that is short for the whole: all charge through the lowest resistance. */
static double short_s(const struct dea_sheet *sheet)
{
  static const double share = 1e-9;
  double ohm = INFINITY, farad = 0;
  for (size_t i = 0; i < sheet->mesh->layout->electrode_count; i++) {
    ohm = resists(sheet, i) ? fmin(ohm, electrode(sheet, i)->sheet_resistance_ohm) : ohm;
  }
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    farad += sheet->capacitance_F[0][e];
  }
  return share * ohm * farad;
}

/* From one step and two halves what both miss in proportion to h taken away, to half_V. What is
 * then missed is an eighth of what they differ by just after a jump (1.1283 - 1.1213 of 1.0607 -
 * 1), and less later. */
static dea_status extrapolate(struct dea_context *ctx, struct dea_sheet *sheet, double h)
{
  const struct part whole = {1, h, sheet->charge_C}, half = {0.5, 0.5 * h, sheet->charge_C},
                    rest = {1, 0.5 * h, sheet->half_C};
  double off = 0, sum = 0;
  DEA_TRY(ctx, euler_step(ctx, sheet, &whole, sheet->whole_V));
  DEA_TRY(ctx, euler_step(ctx, sheet, &half, sheet->half_V));
  find_charges(sheet, 0.5, sheet->half_V, sheet->half_C);
  DEA_TRY(ctx, euler_step(ctx, sheet, &rest, sheet->half_V));
  find_charges(sheet, 1, sheet->whole_V, sheet->charge_next_C);
  find_charges(sheet, 1, sheet->half_V, sheet->half_C);
  for (size_t a = 0; a < sheet->unknowns; a++) {
    sheet->half_V[a] = 2 * sheet->half_V[a] - sheet->whole_V[a];
    off += 0.125 * fabs(sheet->half_C[a] - sheet->charge_next_C[a]);
    sheet->charge_next_C[a] = 2 * sheet->half_C[a] - sheet->charge_next_C[a];
    sum += fabs(sheet->charge_next_C[a]);
  }
  sheet->largest_C = fmax(sheet->largest_C, sum);
  sheet->error = sheet->largest_C > 0 ? off / sheet->largest_C : 0;
  return DEA_OK;
}

/* From the potentials that the film has towards those that it would give, half_V, by Aitken's
 * factor for both. The first of a step: to them. Returns the largest difference. */
static double relax(struct dea_sheet *sheet, bool first)
{
  double most = 0, along = 0, square = 0;
  for (size_t a = 0; a < sheet->unknowns; a++) {
    const double off = sheet->half_V[a] - sheet->potential_V[a], bend = off - sheet->off_V[a];
    most = fmax(most, fabs(off));
    along -= sheet->off_V[a] * bend;
    square += bend * bend;
    sheet->off_V[a] = first ? 0 : off;
  }
  if (!first && along > 0) { // else that of the step before
    sheet->factor = fmin(fmax(sheet->factor * along / square, 0.1), 2);
  }
  for (size_t a = 0; a < sheet->unknowns; a++) {
    sheet->potential_V[a] =
        first ? sheet->half_V[a] : sheet->potential_V[a] + sheet->factor * sheet->off_V[a];
  }
  return most;
}

dea_status dea_sheet_solve(struct dea_context *ctx, struct dea_sheet *sheet, bool first,
                           double length_s, double voltage_V, const double *own_V, double *change_V)
{
  const double h = length_s > 0 ? length_s : short_s(sheet);
  DEA_TRY(ctx, find_capacitances(ctx, sheet, sheet->capacitance_F[1]));
  for (size_t k = 1; k < sheet->channels; k++) {
    sheet->channel_V[1][k] = sheet->solid->problem.share[k] * voltage_V + own_V[k];
  }
  DEA_TRY(ctx, extrapolate(ctx, sheet, h));
  *change_V = relax(sheet, first);
  set_goals(sheet);
  return DEA_OK;
}

static void swap(double **a, double **b)
{
  double *first = *a;
  *a = *b;
  *b = first;
}

void dea_sheet_accept(struct dea_sheet *sheet)
{
  swap(&sheet->charge_C, &sheet->charge_next_C);
  swap(&sheet->capacitance_F[0], &sheet->capacitance_F[1]);
  memcpy(sheet->channel_V[0], sheet->channel_V[1], sheet->channels * sizeof(double));
  memcpy(sheet->u, sheet->solid->state.u, 3 * sheet->mesh->grid->node_count * sizeof *sheet->u);
}

double dea_sheet_error(const struct dea_sheet *sheet)
{
  return sheet->error;
}

double dea_sheet_lowest_V(const struct dea_sheet *sheet)
{
  double least = INFINITY;
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    for (int n = 0; counts(sheet, e) && n < sheet->shape.nodes; n++) {
      least = fmin(least, fabs(across_V(sheet, 1, sheet->potential_V, e, n)));
    }
  }
  return least;
}

// How long it takes ------------------------------------------------------------------------------

static double dot(const struct dea_sheet *sheet, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = 0; i < sheet->unknowns; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* Largest voltage across an element at potentials over channels at 0 V. */
static double largest_across_V(const struct dea_sheet *sheet, const double *phi)
{
  double most = 0;
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    for (int n = 0; counts(sheet, e) && n < sheet->shape.nodes; n++) {
      most = fmax(most, fabs(across_V(sheet, 1, phi, e, n)));
    }
  }
  return most;
}

/* The slowest mode of M dphi/dt + K phi = 0, by inverse iteration, and what a step of the voltage
 * leaves of it where it is largest. */
static dea_status find_settling(struct dea_context *ctx, struct dea_sheet *sheet,
                                double settling_s[2])
{
  enum { ITERATIONS = 30 };
  static const double long_share = 1e18; // of short_s: nothing of M is left
  const struct part part = {1, long_share * short_s(sheet), sheet->half_C};
  double *phi = sheet->half_V, *start = sheet->off_V, time_s = 0, last_s = INFINITY;
  memset(sheet->channel_V[1], 0, sheet->channels * sizeof(double));
  for (size_t a = 0; a < sheet->unknowns; a++) {
    start[a] = sheet->lead[a] < 0 ? sheet->solid->problem.share[sheet->channel[a]] : 0;
    phi[a] = start[a];
  }
  for (int i = 0; i < ITERATIONS && fabs(time_s - last_s) > 1e-4 * time_s; i++) {
    find_charges(sheet, 1, phi, sheet->half_C);
    DEA_TRY(ctx, euler_step(ctx, sheet, &part, sheet->whole_V));
    last_s = time_s;
    time_s =
        part.length_s * dot(sheet, sheet->whole_V, sheet->half_C) / dot(sheet, phi, sheet->half_C);
    const double largest = largest_across_V(sheet, sheet->whole_V);
    for (size_t a = 0; a < sheet->unknowns; a++) {
      phi[a] = sheet->whole_V[a] / largest;
    }
  }
  find_charges(sheet, 1, phi, sheet->half_C);
  const double left = dot(sheet, start, sheet->half_C) / dot(sheet, phi, sheet->half_C) /
                      largest_across_V(sheet, start);
  settling_s[0] = time_s;
  settling_s[1] = time_s * log(10 * fabs(left));
  memcpy(sheet->channel_V[1], sheet->channel_V[0], sheet->channels * sizeof(double));
  memset(sheet->off_V, 0, sheet->unknowns * sizeof *sheet->off_V);
  return DEA_OK;
}

// Creation ---------------------------------------------------------------------------------------

static dea_status allocate_places(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  struct dea_solid *s = sheet->solid;
  const size_t electrodes = mesh->layout->electrode_count, elements = mesh->grid->element_count;
  sheet->columns = mesh->plane->node_count;
  sheet->channels = s->problem.channel_count + 1;
  sheet->at = dea_arena_alloc(&sheet->memory, electrodes * sheet->columns, sizeof *sheet->at);
  sheet->node = dea_arena_alloc(&sheet->memory, electrodes * sheet->columns, sizeof *sheet->node);
  sheet->first = dea_arena_alloc(&sheet->memory, electrodes, sizeof *sheet->first);
  sheet->shares = dea_arena_alloc(&sheet->memory, elements * DEA_FLAT_NODES_MAX, sizeof(double));
  sheet->end = dea_arena_alloc(&sheet->memory, elements, sizeof *sheet->end);
  sheet->u = dea_arena_alloc(&sheet->memory, 3 * mesh->grid->node_count, sizeof *sheet->u);
  for (int k = 0; k < 2; k++) {
    sheet->capacitance_F[k] = dea_arena_alloc(&sheet->memory, elements, sizeof(double));
    sheet->channel_V[k] = dea_arena_alloc(&sheet->memory, sheet->channels, sizeof(double));
  }
  if (s->state.drop_V == NULL) {
    s->state.drop_V = dea_arena_alloc(&s->memory, elements, sizeof(double));
    s->state.drop_goal_V = dea_arena_alloc(&s->memory, elements, sizeof(double));
    s->state.evenness = dea_arena_alloc(&s->memory, elements, sizeof(double));
  }
  return sheet->memory.failed || s->memory.failed ? DEA_E_MEMORY : DEA_OK;
}

static dea_status allocate_unknowns(struct dea_sheet *sheet)
{
  double **const values[] = {&sheet->potential_V, &sheet->charge_C, &sheet->charge_next_C,
                             &sheet->half_V,      &sheet->whole_V,  &sheet->half_C,
                             &sheet->off_V};
  sheet->channel = dea_arena_alloc(&sheet->memory, sheet->unknowns, sizeof *sheet->channel);
  sheet->lead = dea_arena_alloc(&sheet->memory, sheet->unknowns, sizeof *sheet->lead);
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    *values[i] = dea_arena_alloc(&sheet->memory, sheet->unknowns, sizeof(double));
  }
  return dea_arena_status(&sheet->memory);
}

static dea_status create_matrix(struct dea_context *ctx, struct dea_sheet *sheet)
{
  const PetscInt count = (PetscInt)sheet->unknowns, row = 8 * sheet->shape.nodes;
  PC pc;
  DEA_PETSC(ctx, MatCreateSeqAIJ(PETSC_COMM_SELF, count, count, row, NULL, &sheet->A));
  DEA_PETSC(ctx, MatSetOption(sheet->A, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  DEA_PETSC(ctx, MatCreateVecs(sheet->A, &sheet->solution, &sheet->right));
  DEA_PETSC(ctx, KSPCreate(PETSC_COMM_SELF, &sheet->solver));
  DEA_PETSC(ctx, KSPSetType(sheet->solver, KSPPREONLY));
  DEA_PETSC(ctx, KSPGetPC(sheet->solver, &pc));
  DEA_PETSC(ctx, PCSetType(pc, PCLU));
  return DEA_OK;
}

/* All electrodes at the voltage of their channel. */
static void set_start(struct dea_sheet *sheet)
{
  struct dea_solid_state *state = &sheet->solid->state;
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    state->drop_V[e] = state->drop_goal_V[e] = 0;
    state->evenness[e] = 1;
  }
  dea_solid_channel_voltages(sheet->solid, sheet->channel_V[0]);
  memcpy(sheet->channel_V[1], sheet->channel_V[0], sheet->channels * sizeof(double));
  for (size_t a = 0; a < sheet->unknowns; a++) {
    sheet->potential_V[a] = sheet->channel_V[0][sheet->channel[a]];
  }
}

static dea_status prepare(struct dea_context *ctx, struct dea_sheet *sheet)
{
  DEA_TRY(ctx, dea_solid_agree(ctx, allocate_places(sheet)));
  DEA_TRY(ctx, dea_flat_shape_create(sheet->mesh->grid->order, &sheet->shape));
  for (size_t i = 0; i < sheet->mesh->layout->electrode_count; i++) {
    sheet->first[i] = first_of(sheet, i);
  }
  number(sheet);
  DEA_TRY(ctx, dea_solid_agree(ctx, allocate_unknowns(sheet)));
  for (size_t i = 0; i < sheet->mesh->layout->electrode_count * sheet->columns; i++) {
    if (sheet->at[i] > 0) {
      sheet->channel[sheet->at[i] - 1] = (int)electrode(sheet, i / sheet->columns)->channel;
      sheet->lead[sheet->at[i] - 1] = -1;
    }
  }
  find_leads(sheet);
  find_ends(sheet);
  for (size_t e = 0; e < sheet->mesh->grid->element_count; e++) {
    find_shares(sheet, e);
  }
  DEA_TRY(ctx, create_matrix(ctx, sheet));
  set_start(sheet);
  DEA_TRY(ctx, find_capacitances(ctx, sheet, sheet->capacitance_F[0]));
  memcpy(sheet->u, sheet->solid->state.u, 3 * sheet->mesh->grid->node_count * sizeof *sheet->u);
  find_charges(sheet, 0, sheet->potential_V, sheet->charge_C);
  memcpy(sheet->capacitance_F[1], sheet->capacitance_F[0],
         sheet->mesh->grid->element_count * sizeof(double));
  double settling_s[2] = {0};
  DEA_TRY(ctx, find_settling(ctx, sheet, settling_s));
  if (settling_s[1] > 0) { // false where no channel has a part of the supply's voltage
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: by their sheet resistance electrodes charge with a "
                                 "time constant of %.3g s; where that takes longest 90 %% of a "
                                 "step of the supply is there after %.3g s (film as it lies)",
                                 settling_s[0], settling_s[1]));
  }
  return DEA_OK;
}

dea_status dea_sheet_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                            struct dea_solid *solid, const double *per_s, struct dea_sheet **out)
{
  *out = NULL;
  if (mesh == NULL || !dea_layout_has_sheet_resistance(mesh->layout)) {
    return DEA_OK;
  }
  if (solid->problem.field != NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "a coupled field has ideal electrodes in time: no sheet_resistance");
  }
  struct dea_sheet *sheet = dea_solid_alloc(ctx, 1, sizeof *sheet);
  if (sheet == NULL) {
    return DEA_E_MEMORY;
  }
  sheet->memory.ctx = ctx;
  sheet->mesh = mesh;
  sheet->solid = solid;
  sheet->per_s = per_s;
  sheet->factor = 1;
  const dea_status status = prepare(ctx, sheet);
  if (status != DEA_OK) {
    dea_sheet_destroy(ctx, sheet);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = sheet;
  return DEA_OK;
}

void dea_sheet_destroy(struct dea_context *ctx, struct dea_sheet *sheet)
{
  if (sheet != NULL) {
    const struct dea_solid_state *state = &sheet->solid->state;
    for (size_t e = 0; state->drop_goal_V != NULL && e < sheet->mesh->grid->element_count; e++) {
      state->drop_goal_V[e] = 0;
    }
    KSPDestroy(&sheet->solver);
    MatDestroy(&sheet->A);
    VecDestroy(&sheet->right);
    VecDestroy(&sheet->solution);
    dea_arena_free(&sheet->memory);
    dea_free(ctx, sheet);
  }
}
