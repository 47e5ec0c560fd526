#include "model/solid/assembly/film_state.h"

#include "material/plane.h"
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/potential.h"

#include <math.h>
#include <string.h>

// Tension -----------------------------------------------------------------------------------------

/* Height of an element [m]; of a surface what it is thick. */
static double height_of(const struct dea_solid *s, size_t e)
{
  const struct dea_grid *grid = s->problem.grid;
  const int *nodes;
  const int count = dea_solid_nodes(s, e, &nodes);
  return grid->levels[e] == 1 ? dea_solid_part_material(s, e)->thickness_m
                              : grid->X[3 * nodes[count - 1] + 2] - grid->X[3 * nodes[0] + 2];
}

static bool is_dielectric(const struct dea_solid *s, size_t e)
{
  return dea_solid_part_material(s, e)->permittivity_F_per_m > 0;
}

static bool is_electrode(const struct dea_solid *s, size_t e)
{
  return dea_solid_part_material(s, e)->part == DEA_PART_ELECTRODE;
}

/* Whose forces a membrane force is: that of a dielectric ply with electrodes of a thickness on it,
 * which wrinkle with it, or of all plies that are bonded to each other. */
enum extent { OF_FILM, OF_LAMINATE };

/* Whether an element of the same laminate counts in the membrane force of another one. */
static bool counts(const struct dea_solid *s, size_t e, size_t k, enum extent extent)
{
  return extent == OF_LAMINATE || s->problem.grid->ply[k] == s->problem.grid->ply[e] ||
         is_electrode(s, k);
}

/* An element as a surface, with its forces over its own height. */
static dea_status ply_of(const struct dea_solid *s, size_t e, double voltage_V,
                         struct dea_membrane_state *out)
{
  const struct dea_element *element = dea_solid_element(s, e);
  const double share = height_of(s, e) / dea_solid_part_material(s, e)->thickness_m;
  struct dea_solid_element_input at;
  dea_solid_element_input(s, e, s->state.u, voltage_V, &at);
  DEA_TRY_STATUS(element->type->membrane_state(element, &at.in, out));
  for (int p = 0; p < out->count; p++) {
    out->tension[p] *= share;
    for (int i = 0; i < 3; i++) {
      out->force[p][i] *= share;
    }
  }
  return DEA_OK;
}

/* The same with the forces of what counts, each on its own basis. */
static dea_status surface_of(const struct dea_solid *s, size_t e, enum extent extent,
                             double voltage_V, struct dea_membrane_state *out)
{
  DEA_TRY_STATUS(ply_of(s, e, voltage_V, out));
  for (size_t k = (size_t)s->problem.laminate[e]; k != e; k = (size_t)s->problem.laminate[k]) {
    struct dea_membrane_state other;
    if (!counts(s, e, k, extent)) {
      continue;
    }
    DEA_TRY_STATUS(ply_of(s, k, voltage_V, &other));
    for (int p = 0; p < out->count; p++) {
      for (int i = 0; i < 3; i++) {
        out->force[p][i] += other.force[p][i];
      }
      const double *T = out->force[p]; // 11 22 12
      out->tension[p] = 0.5 * (T[0] + T[1]) - hypot(0.5 * (T[0] - T[1]), T[2]);
    }
  }
  return DEA_OK;
}

/* D of docs/theory/trust.md, "Slack", of all plies that are bonded to an element. Surfaces of one
 * place lie about it, those of electrodes outermost. */
static double bending_stiffness_Nm(const struct dea_solid *s, size_t e)
{
  const struct dea_grid *grid = s->problem.grid;
  double A = 0, B = 0, D = 0, inner = 0;
  for (int outer = 0; outer < 2; outer++) {
    size_t k = e;
    do {
      const double Q = dea_part_material_plate_modulus(dea_solid_part_material(s, k));
      const double h = height_of(s, k), z = grid->X[3 * grid->nodes[k * DEA_HEX_NODES_MAX] + 2];
      const bool flat = grid->levels[k] == 1;
      if (outer == (flat && is_electrode(s, k) ? 1 : 0)) {
        const double bottom = z, top = z + h, rest = inner + h;
        A += Q * h;
        B += flat ? Q * h * z : Q * (top * top - bottom * bottom) / 2;
        D += flat ? Q * (h * z * z + (pow(rest, 3) - pow(inner, 3)) / 12)
                  : Q * (pow(top, 3) - pow(bottom, 3)) / 3;
        inner = flat ? rest : inner;
      }
      k = (size_t)s->problem.laminate[k];
    } while (k != e);
  }
  return D - B * B / A;
}

/* What an element is in its laminate, and what that has. */
struct ring {
  bool lowest, lowest_of_ply; // the element
  bool film, dielectric;      // the laminate has one
  bool moves;                 // no film wrinkles in a clamp or under a rigid body
};

static bool can_move(const struct dea_solid *s, size_t e)
{
  const int *nodes;
  const int count = dea_solid_nodes(s, e, &nodes);
  bool free = false;
  for (int i = 0; i < 3 * count && !free; i++) {
    free = s->problem.held[3 * (size_t)nodes[i / 3] + (size_t)(i % 3)] == DEA_FREE;
  }
  return free;
}

static struct ring ring_of(const struct dea_solid *s, const struct dea_solid_film_data *films,
                           size_t e)
{
  const struct dea_solid_problem *p = &s->problem;
  struct ring out = {.lowest = true, .lowest_of_ply = true};
  size_t k = e;
  do {
    const bool film = films[p->part_material_of[k]].material != NULL;
    out.lowest = out.lowest && k >= e;
    out.lowest_of_ply = out.lowest_of_ply && (k >= e || p->grid->ply[k] != p->grid->ply[e]);
    out.film = out.film || film;
    out.dielectric = out.dielectric || (film && is_dielectric(s, k));
    out.moves = out.moves || can_move(s, k);
    k = (size_t)p->laminate[k];
  } while (k != e);
  return out;
}

/* The tension of a film is asked of the lowest element of a dielectric ply, and of that of a
 * laminate without one. */
static bool has_tension(const struct dea_solid *s, const struct ring *ring, size_t e)
{
  return ring->moves && (is_dielectric(s, e) ? ring->lowest_of_ply
                                             : ring->lowest && ring->film && !ring->dielectric);
}

static enum extent extent_of(const struct dea_solid *s, size_t e)
{
  return is_dielectric(s, e) ? OF_FILM : OF_LAMINATE;
}

// Extremes ----------------------------------------------------------------------------------------

/* Use of the film's law at the points of one element. */
static dea_status reach_of(const struct dea_solid *s, size_t e, const struct dea_material *material,
                           struct dea_solid_extremes *out)
{
  struct dea_element_strains strains;
  dea_status status = dea_solid_element_strains(s, e, &strains);
  for (int q = 0; status == DEA_OK && q < dea_solid_element(s, e)->points; q++) {
    const double *C = strains.C[q];
    double plane[3] = {C[0], C[1], C[5]};
    dea_part_material_pull_back(dea_solid_part_material(s, e), plane, plane);
    double root = hypot(0.5 * (plane[0] - plane[1]), plane[2]);
    double middle = 0.5 * (plane[0] + plane[1]);
    dea_reach_merge(&out->reach, dea_material_reach(material, sqrt(middle + root),
                                                    sqrt(fmax(middle - root, 1e-30))));
  }
  return status;
}

/* An extreme's quantity at a point in the plane; direction: of the tension. */
static double quantity_of(const struct dea_solid *s, size_t e, double voltage_V,
                          const struct dea_membrane_state *film,
                          const struct dea_solid_film_data *data, enum dea_film_extreme which,
                          int p, const double direction[2])
{
  const double across_V = dea_solid_voltage_across(s, e, voltage_V);
  const double field =
      fabs(dea_part_material_field(dea_solid_part_material(s, e), across_V)) * film->area[p];
  const double stretch = data->pre_stretch * sqrt(film->area[p]), *T = film->force[p];
  return which == DEA_FILM_FIELD ? field
         : which == DEA_FILM_MARGIN
             ? 1 - field / dea_breakdown_field(data->material, stretch)
             : T[0] * direction[0] * direction[0] + T[1] * direction[1] * direction[1] +
                   2 * T[2] * direction[0] * direction[1];
}

/* The field of one element between electrodes. */
static dea_status field_of(const struct dea_solid *s, size_t e,
                           const struct dea_solid_film_data *data, struct dea_solid_extremes *out)
{
  const double V = s->state.voltage_V;
  struct dea_membrane_state film;
  DEA_TRY_STATUS(ply_of(s, e, V, &film));
  for (int p = 0; p < film.count; p++) {
    const double margin = quantity_of(s, e, V, &film, data, DEA_FILM_MARGIN, p, NULL);
    out->true_field_V_per_m =
        fmax(out->true_field_V_per_m, quantity_of(s, e, V, &film, data, DEA_FILM_FIELD, p, NULL));
    out->area = fmax(out->area, film.area[p]);
    out->breakdown_margin = fmin(out->breakdown_margin, margin);
    out->breakdown_probability = fmax(
        out->breakdown_probability, dea_breakdown_probability(&data->material->breakdown, margin));
  }
  return DEA_OK;
}

/* At which points in the plane a film of a laminate is in compression. */
static dea_status find_compressed(const struct dea_solid *s,
                                  const struct dea_solid_film_data *films, size_t e,
                                  bool compressed[DEA_HEX_GAUSS_MAX])
{
  size_t k = e;
  memset(compressed, 0, DEA_HEX_GAUSS_MAX * sizeof *compressed);
  do {
    struct dea_membrane_state film = {.count = 0};
    if (films[s->problem.part_material_of[k]].material != NULL) {
      DEA_TRY_STATUS(surface_of(s, k, OF_FILM, s->state.voltage_V, &film));
    }
    for (int p = 0; p < film.count; p++) {
      compressed[p] = compressed[p] || film.tension[p] < 0;
    }
    k = (size_t)s->problem.laminate[k];
  } while (k != e);
  return DEA_OK;
}

/* Compression of the laminate whose lowest element this is, where a film of it is in compression,
 * over what a clamped plate of it bears: 14.7 D / R^2 of a circular one, by its area 46 D / A;
 * 4 pi^2 D / A is about that of any plate as wide as long (docs/theory/trust.md). */
static dea_status compression_of(const struct dea_solid *s, const struct dea_solid_film_data *films,
                                 size_t e, const struct dea_membrane_state *laminate, double *ratio)
{
  const double borne_Nm = 4 * DEA_PI * DEA_PI * bending_stiffness_Nm(s, e),
               height = height_of(s, e);
  struct dea_element_strains strains;
  bool compressed[DEA_HEX_GAUSS_MAX];
  DEA_TRY_STATUS(find_compressed(s, films, e, compressed));
  DEA_TRY_STATUS(dea_solid_element_strains(s, e, &strains));
  for (int q = 0; q < dea_solid_element(s, e)->points; q++) {
    const int p = q % laminate->count;
    *ratio += compressed[p] ? fmax(-laminate->tension[p], 0) * laminate->area[p] *
                                  strains.volume_m3[q] / (height * borne_Nm)
                            : 0;
  }
  return DEA_OK;
}

static bool is_compressed(const struct dea_membrane_state *film)
{
  bool any = false;
  for (int p = 0; p < film->count; p++) {
    any = any || film->tension[p] < 0;
  }
  return any;
}

/* Takes the tension that is asked of an element, and the compression of its laminate. */
static dea_status tension_of(const struct dea_solid *s, const struct dea_solid_film_data *films,
                             size_t e, struct dea_solid_extremes *out)
{
  const struct ring ring = ring_of(s, films, e);
  const bool tension = has_tension(s, &ring, e), laminate = ring.lowest && ring.film && ring.moves;
  const bool same = extent_of(s, e) == OF_LAMINATE || s->problem.laminate[e] == (int)e;
  struct dea_membrane_state film = {.count = 0};
  DEA_TRY_STATUS(tension ? surface_of(s, e, extent_of(s, e), s->state.voltage_V, &film) : DEA_OK);
  for (int p = 0; p < film.count; p++) {
    out->min_tension_N_per_m = fmin(out->min_tension_N_per_m, film.tension[p]);
  }
  if (laminate && !(tension && same)) {
    DEA_TRY_STATUS(surface_of(s, e, OF_LAMINATE, s->state.voltage_V, &film));
  }
  return laminate && is_compressed(&film)
             ? compression_of(s, films, e, &film, &out->compression_ratio)
             : DEA_OK;
}

/* The step is small since a film that wrinkles gives way to V (docs/theory/membrane.md); for slopes
 * and of a coupled field, which films that wrinkle do not have, it is wider, so that rounding does
 * not show in differences: of slopes a share of V^2, for a soft film loses its tension at little
 * more than V. */
static const double step_V_per_m = 1e6, wide_step_V_per_m = 1e7, wide_share = 0.03;

/* Squares of two voltages about that of the state. Charge: minus the derivative of the energy by V
 * at fixed displacements; by V^2 it is C/2. Returns the step, 0 without electrodes. */
static double squares_about(const struct dea_solid *s, bool of_slopes, double squares[2])
{
  const struct dea_solid_problem *p = &s->problem;
  double thickness = 0, square = s->state.voltage_V * s->state.voltage_V;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    const struct dea_part_material *part_material = dea_solid_part_material(s, e);
    bool counts = p->active[e] || dea_solid_element(s, e)->type->per_node > 3;
    thickness = fmax(thickness, counts ? part_material->thickness_m : 0);
  }
  const double narrow = pow(step_V_per_m * thickness, 2),
               wide = pow(wide_step_V_per_m * thickness, 2);
  const double of_film = of_slopes ? fmin(wide, fmax(narrow, wide_share * square)) : narrow;
  const double step = p->field != NULL ? wide : of_film;
  squares[0] = fmax(square - step, 0);
  squares[1] = square + step;
  return step;
}

dea_status dea_solid_capacitance(struct dea_context *ctx, struct dea_solid *s, bool smooth,
                                 double *capacitance_F)
{
  const struct dea_solid_problem *p = &s->problem;
  double energy[2] = {0, 0}, squares[2], step = squares_about(s, smooth, squares);
  dea_status status = DEA_OK;
  if (dea_solid_has_own_voltages(s)) {
    *capacitance_F = NAN;
    return DEA_OK;
  }
  memcpy(s->work.trial, s->state.u, p->dofs * sizeof(double));
  for (int i = 0; i < 2 && status == DEA_OK; i++) {
    status = smooth ? dea_solid_scale_potential(ctx, s, sqrt(squares[i]), s->work.trial)
                    : dea_solid_solve_potential(ctx, s, sqrt(squares[i]), s->work.trial);
    status = status == DEA_OK ? dea_solid_energy(s, s->work.trial, sqrt(squares[i]), &energy[i])
                              : status;
  }
  *capacitance_F =
      status == DEA_OK && step > 0 ? 2 * (energy[0] - energy[1]) / (squares[1] - squares[0]) : NAN;
  return status;
}

/* Largest of all ranks; NAN where none knows it. */
static double largest_known(double value)
{
  double largest = dea_solid_largest(isnan(value) ? -INFINITY : value);
  return isinf(largest) ? NAN : largest;
}

dea_status dea_solid_extremes(struct dea_solid *s, const struct dea_solid_film_data *films,
                              struct dea_solid_extremes *out)
{
  dea_status status = DEA_OK;
  *out = (struct dea_solid_extremes){.breakdown_margin = INFINITY,
                                     .breakdown_probability = NAN,
                                     .min_tension_N_per_m = INFINITY,
                                     .reach = {NAN, NAN}};
  for (size_t k = 0; k < s->problem.own_count && status == DEA_OK; k++) {
    size_t e = s->problem.own[k];
    const struct dea_solid_film_data *film = &films[s->problem.part_material_of[e]];
    status = film->material != NULL ? reach_of(s, e, film->material, out) : DEA_OK;
    if (status == DEA_OK && film->material != NULL && s->problem.active[e]) {
      status = field_of(s, e, film, out);
    }
    status = status == DEA_OK ? tension_of(s, films, e, out) : status;
  }
  status = dea_solid_allreduce(NULL, status);
  DEA_TRY_STATUS(status);
  out->true_field_V_per_m = dea_solid_largest(out->true_field_V_per_m);
  out->area = dea_solid_largest(out->area);
  out->breakdown_margin = -dea_solid_largest(-out->breakdown_margin);
  out->breakdown_probability = largest_known(out->breakdown_probability);
  out->min_tension_N_per_m = -dea_solid_largest(-out->min_tension_N_per_m);
  dea_solid_sum(&out->compression_ratio, 1);
  out->reach.locking_share = largest_known(out->reach.locking_share);
  out->reach.range_share = largest_known(out->reach.range_share);
  if (isinf(out->breakdown_margin)) { // fmin passes over what is unknown
    out->breakdown_margin = NAN;
  }
  return DEA_OK;
}

// Slopes -----------------------------------------------------------------------------------------

/* Direction of the smaller principal force. */
static void find_direction(const double T[3], double out[2])
{
  const double angle = 0.5 * atan2(-T[2], 0.5 * (T[1] - T[0]));
  out[0] = cos(angle);
  out[1] = sin(angle);
}

double dea_solid_extreme_at(const struct dea_solid *s, const struct dea_solid_film_data *films,
                            enum dea_film_extreme which, const struct dea_film_place *place,
                            double voltage_V)
{
  const size_t e = place->element;
  struct dea_membrane_state film;
  return surface_of(s, e, extent_of(s, e), voltage_V, &film) == DEA_OK
             ? quantity_of(s, e, voltage_V, &film, &films[s->problem.part_material_of[e]], which,
                           place->point, place->direction)
             : NAN;
}

bool dea_solid_extreme_find(struct dea_solid *s, const struct dea_solid_film_data *films,
                            enum dea_film_extreme which, struct dea_film_place *out)
{
  const double sign = which == DEA_FILM_FIELD ? 1 : -1;
  double best = -INFINITY;
  const double V = s->state.voltage_V;
  struct dea_membrane_state film;
  *out = (struct dea_film_place){.element = 0};
  for (size_t e = 0; e < s->problem.grid->element_count; e++) { // all ranks all of them
    const struct dea_solid_film_data *data = &films[s->problem.part_material_of[e]];
    const struct ring ring = ring_of(s, films, e);
    bool asked = which == DEA_FILM_TENSION ? has_tension(s, &ring, e)
                                           : data->material != NULL && s->problem.active[e];
    asked = asked && surface_of(s, e, extent_of(s, e), V, &film) == DEA_OK;
    for (int p = 0; asked && p < film.count; p++) {
      struct dea_film_place place = {.element = e, .point = p};
      find_direction(film.force[p], place.direction);
      double value = sign * quantity_of(s, e, V, &film, data, which, p, place.direction);
      if (value > best) { // not where it is unknown
        best = value;
        *out = place;
      }
    }
  }
  return best > -INFINITY;
}

/* Slope of an extreme by one number of the state, by a central difference. */
static double slope_by(const struct dea_solid *s, const struct dea_solid_film_data *films,
                       enum dea_film_extreme which, const struct dea_film_place *place,
                       double *number, double step)
{
  double keep = *number, sides[2];
  for (int k = 0; k < 2; k++) {
    *number = keep + (k == 0 ? -step : step);
    sides[k] = dea_solid_extreme_at(s, films, which, place, s->state.voltage_V);
  }
  *number = keep;
  return (sides[1] - sides[0]) / (2 * step);
}

/* Whether one of the elements of a laminate from `first` to before `e` counts and has a node. */
static bool taken_before(const struct dea_solid *s, size_t first, size_t e, int node)
{
  bool found = false;
  for (size_t k = first; k != e && !found; k = (size_t)s->problem.laminate[k]) {
    const int *nodes;
    int count = counts(s, first, k, extent_of(s, first)) ? dea_solid_nodes(s, k, &nodes) : 0;
    for (int n = 0; n < count && !found; n++) {
      found = nodes[n] == node;
    }
  }
  return found;
}

void dea_solid_extreme_slope(const struct dea_solid *s, const struct dea_solid_film_data *films,
                             enum dea_film_extreme which, const struct dea_film_place *place,
                             double *out, double *pressures)
{
  static const double share = 1e-5; // of a part's thickness and of its modulus
  const size_t most = (size_t)s->problem.elements.pressures;
  const size_t first = place->element;
  size_t e = first;
  do {
    const struct dea_part_material *part = dea_solid_part_material(s, e);
    const bool has =
        e == first || (which == DEA_FILM_TENSION && counts(s, first, e, extent_of(s, first)));
    const int *nodes;
    int count = has ? dea_solid_nodes(s, e, &nodes) : 0;
    for (int i = 0; i < 3 * count; i++) {
      size_t at = 3 * (size_t)nodes[i / 3] + (size_t)(i % 3);
      if (!taken_before(s, first, e, nodes[i / 3])) {
        out[at] += slope_by(s, films, which, place, &s->state.u[at], share * part->thickness_m);
      }
    }
    for (size_t j = e * most; has && j < (e + 1) * most; j++) {
      pressures[j] += slope_by(s, films, which, place, &s->state.multiplier[j],
                               share * dea_part_material_modulus(part));
    }
    e = (size_t)s->problem.laminate[e];
  } while (e != first);
}

/* out += times the forces at the solid's displacements and the potentials that a voltage has there.
 */
static dea_status add_forces(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                             double times, double *out)
{
  double energy;
  DEA_TRY(ctx, dea_solid_scale_potential(ctx, s, voltage_V, s->state.u));
  DEA_TRY(ctx, dea_solid_assemble(ctx, s, voltage_V, DEA_FORCE, &energy));
  dea_add(3 * s->problem.grid->node_count, times, s->work.g, out);
  return DEA_OK;
}

dea_status dea_solid_capacitance_slope(struct dea_context *ctx, struct dea_solid *s, double *out,
                                       bool *known)
{
  const struct dea_solid_problem *p = &s->problem;
  double squares[2];
  memset(out, 0, p->dofs * sizeof *out);
  *known = squares_about(s, true, squares) > 0 && !dea_solid_has_own_voltages(s);
  if (!*known) {
    return DEA_OK;
  }
  double *keep = dea_solid_alloc(ctx, p->dofs, sizeof *keep);
  dea_status status = keep != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    memcpy(keep, s->state.u, p->dofs * sizeof *keep);
  }
  for (int i = 0; i < 2 && status == DEA_OK; i++) { // C = 2 (E(V0) - E(V1)) / (V1^2 - V0^2)
    const double times = (i == 0 ? 2 : -2) / (squares[1] - squares[0]);
    status = add_forces(ctx, s, sqrt(squares[i]), times, out);
    memcpy(s->state.u, keep, p->dofs * sizeof *keep);
  }
  dea_free(ctx, keep);
  return DEA_CHAIN(ctx, status);
}
