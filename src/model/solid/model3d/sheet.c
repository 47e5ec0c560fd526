#include "model/solid/model3d/sheet.h"

#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/element/membrane.h"

#include <math.h>
#include <petscksp.h>

enum { TOP, BOTTOM, SIDES };

/* What an electrode is of a face of an element: its nodes in the grid. */
struct face {
  size_t electrode;
  const int *nodes; // [nodes of the shape], lent
};

/* Of the capacitance of an element what is at one of its plane nodes. */
struct cell {
  size_t element;
  int end[SIDES]; // potentials
  double share;
};

/* A step, or a part of it, to a share of the way between the accepted state and the present one. */
struct part {
  double share, length_s;
  const double *charge_C; // [potentials] that it starts from
};

/* Potentials are those of the channels, which are known, and then of the free nodes. */
struct dea_sheet {
  struct dea_arena memory;
  const struct dea_layout_mesh *mesh;
  struct dea_solid *solid;
  const double *per_s;
  struct dea_face_shape shape;
  size_t columns, channels, potentials, face_count, cell_count;
  struct face *faces;                // [face_count] by electrodes
  int *at;                           // [electrodes][columns] number of a potential; -1: none
  size_t *first;                     // [electrodes] the first one on the same face and channel
  struct cell *cells;                // [cell_count] those of an element one after the other
  int *channel;                      // [potentials] of its electrode
  double *capacitance_F[2];          // [elements] accepted, present
  double *u;                         // [nodes][3] accepted
  double *channel_V[2];              // [channels] accepted, present
  double *potential_V;               // [potentials] present
  double *charge_C, *charge_next_C;  // [potentials] accepted, present
  double *half_V, *whole_V, *half_C; // [potentials] work
  double *off_V, factor;             // [potentials] what the film would change them by, how far
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

static int *potential_at(const struct dea_sheet *sheet, size_t i, int column)
{
  return &sheet->at[sheet->first[i] * sheet->columns + (size_t)column];
}

/* Column of node n of a face or an element. */
static int column_of(const struct dea_sheet *sheet, const int *nodes, int n)
{
  return sheet->mesh->grid->column[nodes[n]];
}

static const int *nodes_of(const struct dea_sheet *sheet, size_t e)
{
  return sheet->mesh->grid->nodes + e * DEA_HEX_NODES_MAX;
}

/* Of all electrodes, on the outermost elements of their plies. */
static void find_faces(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  const struct dea_grid *grid = mesh->grid;
  for (size_t i = 0; i < mesh->layout->electrode_count; i++) {
    const struct dea_layout_electrode *own = electrode(sheet, i);
    for (size_t e = 0; e < grid->element_count; e++) {
      const int last = (grid->levels[e] - 1) * sheet->shape.nodes;
      const int *nodes = nodes_of(sheet, e) + (own->top ? last : 0);
      if ((size_t)grid->ply[e] == own->ply && dea_layout_mesh_within(mesh, e, own->region) &&
          grid->X[3 * nodes[0] + 2] == mesh->face_m[own->ply][own->top ? 1 : 0]) {
        sheet->faces[sheet->face_count++] = (struct face){i, nodes};
      }
    }
  }
}

/* Whether two electrodes on the same face and channel have a node in common; where the second is
 * ideal that is the lead of the first. has: room, [columns]. */
static bool meets(struct dea_sheet *sheet, size_t i, size_t other, bool *has)
{
  bool any = false;
  memset(has, 0, sheet->columns * sizeof *has);
  for (size_t k = 0; k < sheet->face_count; k++) {
    for (int n = 0; sheet->faces[k].electrode == other && n < sheet->shape.nodes; n++) {
      has[column_of(sheet, sheet->faces[k].nodes, n)] = true;
    }
  }
  for (size_t k = 0; k < sheet->face_count; k++) {
    for (int n = 0; sheet->faces[k].electrode == i && n < sheet->shape.nodes; n++) {
      const int column = column_of(sheet, sheet->faces[k].nodes, n);
      any = any || has[column];
      if (has[column] && !resists(sheet, other)) {
        *potential_at(sheet, i, column) = (int)electrode(sheet, i)->channel;
      }
    }
  }
  return any;
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

/* All of the outer edge of an electrode is its lead. */
static void lead_edge(struct dea_sheet *sheet, size_t i)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  const struct dea_region *region = &mesh->layout->regions[electrode(sheet, i)->region].region;
  for (size_t k = 0; k < sheet->face_count; k++) {
    for (int n = 0; sheet->faces[k].electrode == i && n < sheet->shape.nodes; n++) {
      const int column = column_of(sheet, sheet->faces[k].nodes, n);
      if (edge_distance_m(region, mesh->plane->x + 2 * column) <= mesh->near_m) {
        *potential_at(sheet, i, column) = (int)electrode(sheet, i)->channel;
      }
    }
  }
}

/* An electrode with a resistance is led where it meets an ideal one, or by another one that is led
 * and that it meets; else along its edge. led: [electrodes]. */
static void find_leads(struct dea_sheet *sheet, bool *led, bool *has)
{
  const size_t count = sheet->mesh->layout->electrode_count;
  bool more = true;
  for (size_t i = 0; i < count; i++) {
    led[i] = !resists(sheet, i);
  }
  while (more) {
    more = false;
    for (size_t i = 0; i < count; i++) {
      for (size_t j = 0; j < count && resists(sheet, i); j++) {
        const bool ask = led[j] && (!led[i] || !resists(sheet, j));
        if (ask && sheet->first[i] == sheet->first[j] && meets(sheet, i, j, has)) {
          more = more || !led[i];
          led[i] = true;
        }
      }
    }
  }
  for (size_t i = 0; i < count; i++) {
    if (!led[i]) {
      lead_edge(sheet, i);
    }
  }
}

/* Numbers the potentials. */
static void number(struct dea_sheet *sheet, bool *led, bool *has)
{
  const size_t electrodes = sheet->mesh->layout->electrode_count;
  for (size_t k = 0; k < electrodes * sheet->columns; k++) {
    sheet->at[k] = -1;
  }
  find_leads(sheet, led, has);
  sheet->potentials = sheet->channels;
  for (size_t k = 0; k < sheet->face_count; k++) {
    const struct face *face = &sheet->faces[k];
    for (int n = 0; resists(sheet, face->electrode) && n < sheet->shape.nodes; n++) {
      int *at = potential_at(sheet, face->electrode, column_of(sheet, face->nodes, n));
      *at = *at < 0 ? (int)sheet->potentials++ : *at;
    }
  }
}

/* Shares of the plane nodes of an element in its capacitance: of the integrals of their bases, all
 * of which are positive at Gauss-Lobatto points. */
static void set_shares(struct dea_sheet *sheet, struct cell *cells)
{
  const struct dea_face_shape *s = &sheet->shape;
  double sum = 0;
  for (int q = 0; q < s->points; q++) {
    double map[4] = {0};
    for (int n = 0; n < s->nodes; n++) {
      const double *x =
          sheet->mesh->plane->x + 2 * column_of(sheet, nodes_of(sheet, cells->element), n);
      for (int a = 0; a < 4; a++) {
        map[a] += x[a / 2] * s->slope[q][a % 2][n];
      }
    }
    const double area = s->weight[q] * (map[0] * map[3] - map[1] * map[2]);
    sum += area;
    for (int n = 0; n < s->nodes; n++) {
      cells[n].share += area * s->value[q][n];
    }
  }
  for (int n = 0; n < s->nodes; n++) {
    cells[n].share /= sum;
  }
}

/* Cells of elements that charge through a resistance. */
static void find_cells(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  const struct dea_solid_problem *p = &sheet->solid->problem;
  for (size_t e = 0; e < mesh->grid->element_count; e++) {
    const struct dea_layout_field *field =
        &mesh->field[(size_t)mesh->grid->region[e] * mesh->layout->ply_count +
                     (size_t)mesh->grid->ply[e]];
    const int on[SIDES] = {field->top_electrode, field->bottom_electrode};
    struct cell *cells = sheet->cells + sheet->cell_count;
    if (!p->active[e] ||
        (!resists(sheet, (size_t)on[TOP]) && !resists(sheet, (size_t)on[BOTTOM]))) {
      continue;
    }
    for (int n = 0; n < sheet->shape.nodes; n++) {
      cells[n].element = e;
      for (int k = 0; k < SIDES; k++) {
        cells[n].end[k] =
            resists(sheet, (size_t)on[k])
                ? *potential_at(sheet, (size_t)on[k], column_of(sheet, nodes_of(sheet, e), n))
                : p->between[e][k];
      }
    }
    set_shares(sheet, cells);
    sheet->cell_count += (size_t)sheet->shape.nodes;
  }
}

// Matrices ---------------------------------------------------------------------------------------

static double mean_of(const double *const of[2], double share, size_t i)
{
  return (1 - share) * of[0][i] + share * of[1][i];
}

static double cell_F(const struct dea_sheet *sheet, double share, const struct cell *cell)
{
  return cell->share * mean_of((const double *const *)sheet->capacitance_F, share, cell->element);
}

static double cell_V(const struct cell *cell, const double *phi)
{
  return phi[cell->end[TOP]] - phi[cell->end[BOTTOM]];
}

/* A[row][column] += value, where what is known goes to the right side. */
static PetscErrorCode add(const struct dea_sheet *sheet, const double *phi, int row, int column,
                          double value, double *right)
{
  const int known = (int)sheet->channels;
  if (row >= known && column < known) {
    right[row - known] -= value * phi[column];
  }
  return row < known || column < known
             ? 0
             : MatSetValue(sheet->A, row - known, column - known, value, ADD_VALUES);
}

static PetscErrorCode add_cells(const struct dea_sheet *sheet, const struct part *part,
                                const double *phi, double *right)
{
  PetscErrorCode code = 0;
  for (size_t k = 0; k < 4 * sheet->cell_count && code == 0; k++) {
    const struct cell *cell = &sheet->cells[k / 4];
    const double per_s =
        1 / part->length_s + sheet->per_s[sheet->solid->problem.part_material_of[cell->element]];
    code = add(sheet, phi, cell->end[k % 2], cell->end[k / 2 % 2],
               (k % 2 == k / 2 % 2 ? per_s : -per_s) * cell_F(sheet, part->share, cell), right);
  }
  return code;
}

/* Conductances [nodes][nodes] of a face of an electrode of 1 ohm per square as it is deformed: the
 * integral of grad N_a . grad N_b over the surface. */
static void find_conductances(const struct dea_sheet *sheet, const int *nodes, double share,
                              double *out)
{
  const struct dea_face_shape *s = &sheet->shape;
  const double *X = sheet->mesh->grid->X, *const u[2] = {sheet->u, sheet->solid->state.u};
  memset(out, 0, (size_t)(s->nodes * s->nodes) * sizeof *out);
  for (int q = 0; q < s->points; q++) {
    double g[2][3] = {{0}}, G[3] = {0}; // tangents and their products 11 22 12
    for (int n = 0; n < 3 * s->nodes; n++) {
      const size_t at = 3 * (size_t)nodes[n / 3] + (size_t)(n % 3);
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

static PetscErrorCode add_face(const struct dea_sheet *sheet, const struct face *face, double share,
                               const double *phi, double *right)
{
  double K[DEA_FACE_NODES_MAX * DEA_FACE_NODES_MAX];
  const int nodes = sheet->shape.nodes;
  const struct dea_layout_electrode *own = electrode(sheet, face->electrode);
  const size_t layers = dea_ply_layers(&sheet->mesh->layout->plies[own->ply]);
  const double per_ohm = 0.5 * (double)(layers + 1) / own->sheet_resistance_ohm; // by turns
  PetscErrorCode code = 0;
  find_conductances(sheet, face->nodes, share, K);
  for (int n = 0; n < nodes * nodes && code == 0; n++) {
    const int row = column_of(sheet, face->nodes, n / nodes),
              column = column_of(sheet, face->nodes, n % nodes);
    code = add(sheet, phi, *potential_at(sheet, face->electrode, row),
               *potential_at(sheet, face->electrode, column), per_ohm * K[n], right);
  }
  return code;
}

/* One implicit Euler step, (M/h + G + K) phi = Q/h, from the potentials of the channels to all. */
static dea_status euler_step(struct dea_context *ctx, struct dea_sheet *sheet,
                             const struct part *part, double *phi)
{
  const size_t known = sheet->channels;
  PetscScalar *right;
  PetscErrorCode code = 0;
  DEA_PETSC(ctx, MatZeroEntries(sheet->A));
  DEA_PETSC(ctx, VecGetArray(sheet->right, &right));
  for (size_t a = 0; a < sheet->potentials && code == 0; a++) {
    if (a < known) {
      phi[a] = mean_of((const double *const *)sheet->channel_V, part->share, a);
    } else {
      right[a - known] = part->charge_C[a] / part->length_s;
      code = MatSetValue(sheet->A, (PetscInt)(a - known), (PetscInt)(a - known), 0, ADD_VALUES);
    }
  }
  code = code == 0 ? add_cells(sheet, part, phi, right) : code;
  for (size_t k = 0; k < sheet->face_count && code == 0; k++) {
    code = resists(sheet, sheet->faces[k].electrode)
               ? add_face(sheet, &sheet->faces[k], part->share, phi, right)
               : 0;
  }
  DEA_PETSC(ctx, VecRestoreArray(sheet->right, &right));
  DEA_PETSC(ctx, code);
  DEA_PETSC(ctx, MatAssemblyBegin(sheet->A, MAT_FINAL_ASSEMBLY));
  DEA_PETSC(ctx, MatAssemblyEnd(sheet->A, MAT_FINAL_ASSEMBLY));
  DEA_PETSC(ctx, KSPSetOperators(sheet->solver, sheet->A, sheet->A));
  DEA_PETSC(ctx, KSPSolve(sheet->solver, sheet->right, sheet->solution));
  DEA_PETSC(ctx, VecGetArray(sheet->solution, &right));
  memcpy(phi + known, right, (sheet->potentials - known) * sizeof *phi);
  DEA_PETSC(ctx, VecRestoreArray(sheet->solution, &right));
  return DEA_OK;
}

// Charges and voltages ---------------------------------------------------------------------------

static void find_charges(const struct dea_sheet *sheet, double share, const double *phi,
                         double *charge_C)
{
  memset(charge_C, 0, sheet->potentials * sizeof *charge_C);
  for (size_t k = 0; k < sheet->cell_count; k++) {
    const struct cell *cell = &sheet->cells[k];
    const double charge = cell_F(sheet, share, cell) * cell_V(cell, phi);
    charge_C[cell->end[TOP]] += charge;
    charge_C[cell->end[BOTTOM]] -= charge;
  }
}

/* To elements the root mean square of the voltages over their nodes, which has their energy. */
static void set_goals(struct dea_sheet *sheet)
{
  struct dea_solid_state *state = &sheet->solid->state;
  const size_t nodes = (size_t)sheet->shape.nodes;
  for (size_t k = 0; k < sheet->cell_count; k += nodes) {
    const struct cell *cells = &sheet->cells[k];
    const int *between = sheet->solid->problem.between[cells->element];
    double mean = 0, square = 0;
    for (size_t n = 0; n < nodes; n++) {
      const double V = cell_V(&cells[n], sheet->potential_V);
      mean += cells[n].share * V;
      square += cells[n].share * V * V;
    }
    const double root = copysign(sqrt(square), mean);
    state->drop_goal_V[cells->element] =
        root - (sheet->channel_V[1][between[TOP]] - sheet->channel_V[1][between[BOTTOM]]);
    state->evenness[cells->element] = root != 0 ? mean / root : 1;
  }
}

static dea_status find_capacitances(struct dea_context *ctx, struct dea_sheet *sheet, double *out)
{
  const struct dea_solid_problem *p = &sheet->solid->problem;
  dea_status status = DEA_OK;
  memset(out, 0, p->grid->element_count * sizeof *out);
  for (size_t i = 0; i < p->own_count && status == DEA_OK; i++) {
    const size_t e = p->own[i];
    status = p->active[e]
                 ? dea_solid_element_capacitance(sheet->solid, e, sheet->solid->state.u, &out[e])
                 : DEA_OK;
  }
  DEA_TRY(ctx, dea_solid_allreduce(ctx, status));
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
  for (size_t a = sheet->channels; a < sheet->potentials; a++) {
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
  for (size_t a = sheet->channels; a < sheet->potentials; a++) {
    const double off = sheet->half_V[a] - sheet->potential_V[a], bend = off - sheet->off_V[a];
    most = fmax(most, fabs(off));
    along -= sheet->off_V[a] * bend;
    square += bend * bend;
    sheet->off_V[a] = first ? 0 : off;
  }
  if (!first && along > 0) { // else that of the step before
    sheet->factor = fmin(fmax(sheet->factor * along / square, 0.1), 2);
  }
  for (size_t a = sheet->channels; a < sheet->potentials; a++) {
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
  memcpy(sheet->potential_V, sheet->channel_V[1], sheet->channels * sizeof(double));
  set_goals(sheet);
  return DEA_OK;
}

void dea_sheet_accept(struct dea_sheet *sheet)
{
  dea_swap(&sheet->charge_C, &sheet->charge_next_C);
  dea_swap(&sheet->capacitance_F[0], &sheet->capacitance_F[1]);
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
  for (size_t k = 0; k < sheet->cell_count; k++) {
    least = fmin(least, fabs(cell_V(&sheet->cells[k], sheet->potential_V)));
  }
  return least;
}

// How long it takes ------------------------------------------------------------------------------

static double dot(const struct dea_sheet *sheet, const double *a, const double *b)
{
  double sum = 0;
  for (size_t i = sheet->channels; i < sheet->potentials; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

static double largest_V(const struct dea_sheet *sheet, const double *phi)
{
  double most = 0;
  for (size_t k = 0; k < sheet->cell_count; k++) {
    most = fmax(most, fabs(cell_V(&sheet->cells[k], phi)));
  }
  return most;
}

/* The slowest mode of M dphi/dt + K phi = 0, by inverse iteration, and what a step of the voltage
 * leaves of it where it is largest: its time constant, and the time to 90 %. */
static dea_status find_settling(struct dea_context *ctx, struct dea_sheet *sheet, double out_s[2])
{
  enum { ITERATIONS = 30 };
  static const double long_share = 1e18; // of short_s: nothing of M is left
  const struct part part = {1, long_share * short_s(sheet), sheet->half_C};
  double *phi = sheet->half_V, *start = sheet->off_V, last_s = INFINITY;
  memset(sheet->channel_V[1], 0, sheet->channels * sizeof(double));
  for (size_t a = sheet->channels; a < sheet->potentials; a++) {
    phi[a] = start[a] = sheet->solid->problem.share[sheet->channel[a]];
  }
  out_s[0] = 0;
  for (int i = 0; i < ITERATIONS && fabs(out_s[0] - last_s) > 1e-4 * out_s[0]; i++) {
    find_charges(sheet, 1, phi, sheet->half_C);
    DEA_TRY(ctx, euler_step(ctx, sheet, &part, sheet->whole_V));
    last_s = out_s[0];
    out_s[0] =
        part.length_s * dot(sheet, sheet->whole_V, sheet->half_C) / dot(sheet, phi, sheet->half_C);
    const double largest = largest_V(sheet, sheet->whole_V);
    for (size_t a = sheet->channels; a < sheet->potentials; a++) {
      phi[a] = sheet->whole_V[a] / largest;
    }
  }
  find_charges(sheet, 1, phi, sheet->half_C);
  out_s[1] =
      out_s[0] * log(10 * fabs(dot(sheet, start, sheet->half_C) / dot(sheet, phi, sheet->half_C)) /
                     largest_V(sheet, start));
  memcpy(sheet->channel_V[1], sheet->channel_V[0], sheet->channels * sizeof(double));
  memset(start, 0, sheet->potentials * sizeof *start);
  return DEA_OK;
}

// Creation ---------------------------------------------------------------------------------------

static dea_status allocate_places(struct dea_sheet *sheet)
{
  const struct dea_layout_mesh *mesh = sheet->mesh;
  struct dea_solid *s = sheet->solid;
  struct dea_arena *memory = &sheet->memory;
  const size_t electrodes = mesh->layout->electrode_count, elements = mesh->grid->element_count;
  sheet->columns = mesh->plane->node_count;
  sheet->channels = s->problem.channel_count + 1;
  sheet->at = dea_arena_alloc(memory, electrodes * sheet->columns, sizeof *sheet->at);
  sheet->faces = dea_arena_alloc(memory, electrodes * elements, sizeof *sheet->faces);
  sheet->first = dea_arena_alloc(memory, electrodes, sizeof *sheet->first);
  sheet->cells =
      dea_arena_alloc(memory, elements * (size_t)sheet->shape.nodes, sizeof *sheet->cells);
  sheet->u = dea_arena_alloc(memory, 3 * mesh->grid->node_count, sizeof *sheet->u);
  for (int k = 0; k < 2; k++) {
    sheet->capacitance_F[k] = dea_arena_alloc(memory, elements, sizeof(double));
    sheet->channel_V[k] = dea_arena_alloc(memory, sheet->channels, sizeof(double));
  }
  if (s->state.drop_V == NULL) {
    s->state.drop_V = dea_arena_alloc(&s->memory, elements, sizeof(double));
    s->state.drop_goal_V = dea_arena_alloc(&s->memory, elements, sizeof(double));
    s->state.evenness = dea_arena_alloc(&s->memory, elements, sizeof(double));
  }
  return memory->failed || s->memory.failed ? DEA_E_MEMORY : DEA_OK;
}

static dea_status allocate_potentials(struct dea_sheet *sheet)
{
  sheet->channel = dea_arena_alloc(&sheet->memory, sheet->potentials, sizeof *sheet->channel);
  dea_solid_alloc_doubles(&sheet->memory, sheet->potentials,
                          (double **[]){&sheet->potential_V, &sheet->charge_C,
                                        &sheet->charge_next_C, &sheet->half_V, &sheet->whole_V,
                                        &sheet->half_C, &sheet->off_V, NULL});
  return dea_arena_status(&sheet->memory);
}

static dea_status create_matrix(struct dea_context *ctx, struct dea_sheet *sheet)
{
  const PetscInt count = (PetscInt)(sheet->potentials - sheet->channels);
  PC pc;
  DEA_PETSC(
      ctx, MatCreateSeqAIJ(PETSC_COMM_SELF, count, count, 8 * sheet->shape.nodes, NULL, &sheet->A));
  DEA_PETSC(ctx, MatSetOption(sheet->A, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  DEA_PETSC(ctx, MatCreateVecs(sheet->A, &sheet->solution, &sheet->right));
  DEA_PETSC(ctx, KSPCreate(PETSC_COMM_SELF, &sheet->solver));
  DEA_PETSC(ctx, KSPSetType(sheet->solver, KSPPREONLY));
  DEA_PETSC(ctx, KSPGetPC(sheet->solver, &pc));
  DEA_PETSC(ctx, PCSetType(pc, PCLU));
  return DEA_OK;
}

/* All electrodes at the voltage of their channel, with their charges. */
static dea_status set_start(struct dea_context *ctx, struct dea_sheet *sheet)
{
  struct dea_solid_state *state = &sheet->solid->state;
  const struct dea_grid *grid = sheet->mesh->grid;
  for (size_t e = 0; e < grid->element_count; e++) {
    state->drop_V[e] = state->drop_goal_V[e] = 0;
    state->evenness[e] = 1;
  }
  for (size_t k = 0; k < sheet->channels; k++) {
    sheet->channel[k] = (int)k;
  }
  for (size_t i = 0; i < sheet->mesh->layout->electrode_count * sheet->columns; i++) {
    if (sheet->at[i] >= 0) {
      sheet->channel[sheet->at[i]] = (int)electrode(sheet, i / sheet->columns)->channel;
    }
  }
  dea_solid_channel_voltages(sheet->solid, sheet->channel_V[0]);
  memcpy(sheet->channel_V[1], sheet->channel_V[0], sheet->channels * sizeof(double));
  for (size_t a = 0; a < sheet->potentials; a++) {
    sheet->potential_V[a] = sheet->channel_V[0][sheet->channel[a]];
  }
  memcpy(sheet->u, state->u, 3 * grid->node_count * sizeof *sheet->u);
  DEA_TRY(ctx, find_capacitances(ctx, sheet, sheet->capacitance_F[0]));
  memcpy(sheet->capacitance_F[1], sheet->capacitance_F[0], grid->element_count * sizeof(double));
  find_charges(sheet, 0, sheet->potential_V, sheet->charge_C);
  return DEA_OK;
}

static dea_status prepare(struct dea_context *ctx, struct dea_sheet *sheet)
{
  const size_t electrodes = sheet->mesh->layout->electrode_count;
  double settling_s[2] = {0};
  dea_face_shape_create((const int[2]){sheet->mesh->grid->order, sheet->mesh->grid->order},
                        DEA_FACE_ELEMENT, &sheet->shape);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, allocate_places(sheet)));
  for (size_t i = 0; i < electrodes; i++) {
    sheet->first[i] = first_of(sheet, i);
  }
  find_faces(sheet);
  bool *marks = dea_solid_alloc(ctx, electrodes + sheet->columns, sizeof *marks);
  DEA_TRY_MEMORY(marks != NULL);
  number(sheet, marks, marks + electrodes);
  dea_free(ctx, marks);
  find_cells(sheet);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, allocate_potentials(sheet)));
  DEA_TRY(ctx, create_matrix(ctx, sheet));
  DEA_TRY(ctx, set_start(ctx, sheet));
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
  DEA_TRY_MEMORY(sheet != NULL);
  sheet->memory.ctx = ctx;
  sheet->mesh = mesh;
  sheet->solid = solid;
  sheet->per_s = per_s;
  sheet->factor = 1;
  DEA_TRY_ELSE(ctx, prepare(ctx, sheet), dea_sheet_destroy(ctx, sheet));
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
