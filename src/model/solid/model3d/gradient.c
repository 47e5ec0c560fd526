/* Slopes of quantities of a solid's equilibrium by numbers of its design, by one linear answer a
 * quantity and differences of the residual at fixed unknowns a number (docs/theory/gradients.md).
 */
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/charge_control.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/curvature.h"
#include "model/solid/assembly/potential.h"
#include "model/solid/equilibrium/adjoint.h"
#include "model/solid/equilibrium/modes.h"
#include "model/solid/model3d/solid_model.h"
#include "result/columns.h"

#include <math.h>
#include <string.h>

// Gradients ---------------------------------------------------------------------------------------

/* A motion that residuals are taken along. */
struct line {
  const double *v, *pressure; // [dofs], [multipliers]; NULL: pressures stay
  double step;                // of v, in differences
};

/* A mode of small motions, whose frequency is asked for. */
struct mode {
  bool known;
  double *v, *pressure; // [dofs], [multipliers]: its motion, v . Mv = 1, and kappa M^-1 B^T v
  double square, rate;  // omega^2; slope of the frequency by it
  struct line line;     // both
};

/* The electrode's stretch is held, and the voltage follows it. */
struct border {
  double *rate, *slope;     // [dofs] dR/dV; slope of the stretch
  double *pull;             // [dea_gradient_width] how much of it each quantity takes
  double *by_voltage;       // [dea_gradient_width] their own slopes by the voltage
  double along, along_rate; // slope . v and rate . v, of v the answer to dR/dV
};

struct work {
  struct dea_model *model;
  struct dea_solid *solid; // its own
  double voltage_V;
  const struct dea_gradient_request *ask;
  struct dea_adjoint *adjoint;
  bool *known;          // [dea_gradient_width + 1] there is an answer; the last one: the border's
  double *side;         // [2][dea_gradient_width]
  double *motion;       // [monitor_count]
  double *here, *there; // [state] room while residuals are taken elsewhere
  double *force_direction; // [dofs]
  struct mode *modes;      // [mode_count] from the lowest on, to the last that is asked for
  size_t mode_count;
  double *moving; // [dofs] room
  struct border border;
  double *null_mode; // [2][dofs] of a limit point, as it is found, and dR/dV
};

// Modes -------------------------------------------------------------------------------------------

static bool is_frequency(int column)
{
  return strcmp(dea_point_columns[column].key, "frequency_Hz") == 0;
}

/* Which mode a column is of. */
static size_t mode_of(const struct dea_gradient_request *ask, size_t column)
{
  return ask->modes != NULL ? ask->modes[column] : 0;
}

static bool is_asked(const struct dea_gradient_request *ask, size_t mode)
{
  bool asked = false;
  for (size_t i = 0; i < ask->column_count; i++) {
    asked = asked || (is_frequency(ask->columns[i]) && mode_of(ask, i) == mode);
  }
  return asked;
}

/* One of them; without a slope where another one has the same frequency. squares: of all, with the
 * one above. */
static dea_status get_mode(struct dea_context *ctx, struct work *w, size_t i, const double *squares,
                           double *v)
{
  static const double apart = 1e-4;
  const double square = squares[i], least = apart * fabs(square);
  struct mode *m = &w->modes[i];
  const bool alone =
      fabs(squares[i + 1] - square) > least && (i == 0 || fabs(square - squares[i - 1]) > least);
  m->v = v;
  m->known = alone && square != 0 && is_asked(w->ask, i);
  m->square = square;
  m->rate = 1 / (4 * DEA_PI * sqrt(fabs(square)));
  if (!alone && is_asked(w->ask, i)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                 "model 3d: no gradient of the frequency of mode %zu: another one "
                                 "has the same (a sector of the device has only one of them)",
                                 i + 1));
  }
  return DEA_OK;
}

/* From the lowest to the last whose frequency is asked for; 0: none. */
static size_t mode_count(const struct dea_gradient_request *ask)
{
  size_t count = 0;
  for (size_t i = 0; i < ask->column_count; i++) {
    if (is_frequency(ask->columns[i]) && mode_of(ask, i) >= count) {
      count = mode_of(ask, i) + 1;
    }
  }
  return count;
}

/* All of them, by themselves. */
static dea_status find_modes(struct dea_context *ctx, struct work *w, struct dea_arena *memory)
{
  struct dea_solid *s = w->solid;
  const size_t dofs = s->problem.dofs;
  w->mode_count = mode_count(w->ask);
  if (w->mode_count == 0) {
    return DEA_OK;
  }
  const size_t count = w->mode_count + 1; // the last one is only compared
  double *v = dea_arena_alloc(memory, count * dofs, sizeof(double));
  double *squares = dea_arena_alloc(memory, count, sizeof(double));
  w->modes = dea_arena_alloc(memory, count, sizeof *w->modes);
  w->moving = dea_arena_alloc(memory, dofs, sizeof(double));
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  DEA_TRY(ctx, dea_solid_modes_whole(ctx, s, DEA_MODES_BY_MASS, count, squares, v));
  for (size_t i = 0; i < w->mode_count; i++) {
    DEA_TRY(ctx, get_mode(ctx, w, i, squares, v + i * dofs));
  }
  return DEA_OK;
}

/* How far differences along a motion go: a share of the thickness of the thinnest film. */
static double step_along(const struct work *w, const double *v)
{
  static const double share = 0.02;
  const struct dea_solid *s = w->solid;
  double thinnest_m = INFINITY;
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    const struct dea_part_material *film = dea_solid_part_material(s, e);
    thinnest_m = film->permittivity_F_per_m > 0 ? fmin(thinnest_m, film->thickness_m) : thinnest_m;
  }
  return share * thinnest_m / dea_largest(s->problem.dofs, v);
}

/* Their pressures. */
static dea_status prepare_modes(struct dea_context *ctx, struct work *w, struct dea_arena *memory)
{
  const size_t multipliers = dea_solid_multiplier_count(w->solid);
  double *pressure = dea_arena_alloc(memory, w->mode_count * multipliers, sizeof(double));
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  for (size_t i = 0; i < w->mode_count; i++, pressure += multipliers) {
    struct mode *m = &w->modes[i];
    m->pressure = pressure;
    dea_adjoint_mode_pressures(w->adjoint, m->v, m->pressure);
    m->line = (struct line){m->v, m->pressure, step_along(w, m->v)};
  }
  return DEA_OK;
}

/* Residuals at the unknowns as they are, moved by `steps` along a motion. */
static dea_status assemble_along(struct dea_context *ctx, struct work *w, const struct line *line,
                                 double voltage_V, double steps)
{
  struct dea_solid *s = w->solid;
  const size_t dofs = s->problem.dofs, multipliers = dea_solid_multiplier_count(w->solid);
  double energy_J;
  dea_solid_state_get(s, w->here); // what is held may have been moved
  for (size_t i = 0; i < dofs; i++) {
    w->there[i] = w->here[i] + steps * line->step * line->v[i];
  }
  for (size_t i = 0; i < multipliers; i++) {
    w->there[dofs + i] =
        w->here[dofs + i] + (line->pressure != NULL ? steps * line->step * line->pressure[i] : 0);
  }
  dea_solid_state_set(s, w->there);
  dea_status status = dea_adjoint_assemble(ctx, w->adjoint, voltage_V, &energy_J);
  dea_solid_state_set(s, w->here);
  return status;
}

/* Differences over five places of equal distance: their first and second derivative in the middle,
 * but for the fourth power of the distance. Its square would count: the stiffness of a film against
 * its mode rises with the square of how far it has moved, by 4e-4 of what a film without tension
 * has. */
enum { PLACES = 5 };
static const double by_places[2][PLACES] = {
    {1. / 12, -8. / 12, 0, 8. / 12, -1. / 12},
    {-1. / 12, 16. / 12, -30. / 12, 16. / 12, -1. / 12},
};

/* The first (order 1) or second derivative of residuals and constraints along a motion, added
 * `factor` times to the slopes of a quantity by the unknowns. */
static dea_status add_along(struct dea_context *ctx, struct work *w, const struct line *line,
                            int order, double factor, double *out, double *pressures)
{
  const struct dea_solid *s = w->solid;
  const int middle = PLACES / 2;
  for (int k = 0; k < PLACES; k++) {
    const double times = by_places[order - 1][k] * factor / pow(line->step, order);
    if (times == 0) {
      continue;
    }
    DEA_TRY(ctx, assemble_along(ctx, w, line, w->voltage_V, k - middle));
    dea_add(s->problem.dofs, times, s->work.g, out);
    dea_adjoint_add_constraints(w->adjoint, times, pressures);
  }
  return DEA_OK;
}

/* The second derivative along a mode, times the frequency's slope by omega^2. What is held is so
 * without the penalties of its own. */
static dea_status add_along_mode(struct dea_context *ctx, struct work *w, const struct mode *m,
                                 double *out, double *pressures)
{
  const bool pressed = w->model->indent != NULL;
  dea_status status = pressed ? dea_variant_hold_tip(ctx, w->model) : DEA_OK;
  status = status == DEA_OK ? add_along(ctx, w, &m->line, 2, m->rate, out, pressures) : status;
  if (pressed) {
    dea_variant_leave(ctx, w->model);
  }
  return status;
}

/* Slopes of a monitor's motion by the unknowns; of a force direction . R they are those of R along
 * that direction, as the tangent is symmetric. */
static dea_status monitor_slope(struct dea_context *ctx, struct work *w, size_t i, size_t at)
{
  const size_t dofs = w->solid->problem.dofs;
  double *out = dea_adjoint_slope(w->adjoint, at);
  bool is_force = false;
  memset(w->force_direction, 0, dofs * sizeof *w->force_direction);
  w->known[at] = dea_variant_monitor_slope(w->model, i, out, w->force_direction);
  for (size_t k = 0; k < dofs && w->known[at]; k++) {
    is_force = is_force || w->force_direction[k] != 0;
  }
  if (is_force) {
    const struct line line = {w->force_direction, NULL, step_along(w, w->force_direction)};
    DEA_TRY(ctx, add_along(ctx, w, &line, 1, 1, out, dea_adjoint_pressure_slope(w->adjoint, at)));
  }
  return DEA_OK;
}

/* omega^2 of a changed device with a mode as it is, less omega^2 of its mass: what the frequency
 * changes by there, but for a constant. */
static dea_status mode_at(struct dea_context *ctx, struct work *w, const struct mode *m,
                          double voltage_V, double *out)
{
  struct dea_solid *s = w->solid;
  double square, mass;
  dea_solid_hold_potential(s, voltage_V, s->state.u);
  memcpy(w->moving, m->v, s->problem.dofs * sizeof *w->moving);
  DEA_TRY(ctx, dea_solid_motion(ctx, s, w->moving, m->pressure, &square, &mass));
  *out = m->rate * (square - m->square * mass);
  return DEA_OK;
}

// All of it ---------------------------------------------------------------------------------------

static const double share_of_voltage = 1e-5; // that differences by the voltage go to either side

/* Of a limit point: the answer to dR/dV, and the one to that, which is the tangent's null vector.
 */
enum { RATE, NULL_MODE, OF_LIMIT };

/* Slopes of all quantities by the unknowns. */
static dea_status find_slopes(struct dea_context *ctx, struct work *w)
{
  for (size_t i = 0; i < w->ask->column_count; i++) {
    double *out = dea_adjoint_slope(w->adjoint, i);
    double *pressures = dea_adjoint_pressure_slope(w->adjoint, i);
    if (is_frequency(w->ask->columns[i])) {
      const struct mode *m = &w->modes[mode_of(w->ask, i)];
      w->known[i] = m->known;
      DEA_TRY(ctx, m->known ? add_along_mode(ctx, w, m, out, pressures) : DEA_OK);
    } else {
      DEA_TRY(ctx,
              dea_variant_slope(ctx, w->model, w->ask->columns[i], out, pressures, &w->known[i]));
    }
  }
  for (size_t i = 0; i < w->ask->monitor_count; i++) {
    DEA_TRY(ctx, monitor_slope(ctx, w, i, w->ask->column_count + i));
  }
  return DEA_OK;
}

/* J of every quantity at the unknowns as they are, of what is under the solid now, added to out;
 * where the stretch is held, less what each takes of it. */
static dea_status add_quantities(struct dea_context *ctx, struct work *w, double voltage_V,
                                 double energy_J, double *out)
{
  struct dea_load_point point;
  DEA_TRY(ctx, dea_variant_point(ctx, w->model, voltage_V, energy_J, &point));
  for (size_t i = 0; i < w->ask->column_count; i++) {
    if (is_frequency(w->ask->columns[i]) && w->known[i]) {
      const struct mode *m = &w->modes[mode_of(w->ask, i)];
      DEA_TRY(ctx, mode_at(ctx, w, m, voltage_V, &point.frequency_Hz));
    }
    out[i] += dea_point_get(&point, w->ask->columns[i]);
  }
  if (w->ask->monitor_count > 0) {
    DEA_TRY(ctx, dea_variant_monitors(ctx, w->model, w->motion));
    for (size_t i = 0; i < w->ask->monitor_count; i++) {
      out[w->ask->column_count + i] += w->motion[i];
    }
  }
  for (size_t i = 0; i < dea_gradient_width(w->ask) && w->ask->holds_stretch; i++) {
    out[i] -= w->border.pull[i] * point.electrode_stretch;
  }
  return DEA_OK;
}

/* J - lambda . R - mu . C of every quantity on one side of a change. */
static dea_status evaluate(struct dea_context *ctx, struct work *w, double voltage_V, double *out)
{
  struct dea_solid *s = w->solid;
  double energy_J;
  s->state.voltage_V = voltage_V;
  DEA_TRY(ctx, dea_adjoint_assemble(ctx, w->adjoint, voltage_V, &energy_J));
  if (w->ask->of_limit) {
    *out = dea_adjoint_product(w->adjoint, NULL_MODE);
    return DEA_OK;
  }
  for (size_t i = 0; i < dea_gradient_width(w->ask); i++) {
    out[i] = w->known[i] ? -dea_adjoint_product(w->adjoint, i) : NAN;
  }
  return DEA_CHAIN(ctx, add_quantities(ctx, w, voltage_V, energy_J, out));
}

// A held stretch ----------------------------------------------------------------------------------

/* The border of the system: dR/dV, its answer v, and the slope of the stretch. Only then do other
 * slopes go where those of answers begin. */
static dea_status begin_border(struct dea_context *ctx, struct work *w, struct dea_arena *memory)
{
  const size_t dofs = w->solid->problem.dofs, width = dea_gradient_width(w->ask);
  struct border *b = &w->border;
  double *first = dea_adjoint_slope(w->adjoint, 0), *of_v = dea_adjoint_slope(w->adjoint, width);
  bool known;
  b->rate = dea_arena_alloc(memory, dofs, sizeof(double));
  b->slope = dea_arena_alloc(memory, dofs, sizeof(double));
  b->pull = dea_arena_alloc(memory, width, sizeof(double));
  b->by_voltage = dea_arena_alloc(memory, 2 * width, sizeof(double));
  bool *wanted = dea_arena_alloc(memory, width + 1, sizeof *wanted);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(memory)));
  DEA_TRY(ctx, dea_solid_model_rate(ctx, w->solid, w->adjoint, w->voltage_V,
                                    share_of_voltage * w->voltage_V, b->rate, NULL));
  memcpy(of_v, b->rate, dofs * sizeof *of_v);
  wanted[width] = true;
  DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, wanted));
  memset(first, 0, dofs * sizeof *first);
  DEA_TRY(ctx, dea_variant_slope(ctx, w->model, dea_point_column_find("electrode_stretch"),
                                 b->slope, dea_adjoint_pressure_slope(w->adjoint, width), &known));
  b->along = dea_solid_dot(w->solid, dea_adjoint_answer(w->adjoint, width), b->slope);
  b->along_rate = dea_solid_dot(w->solid, dea_adjoint_answer(w->adjoint, width), b->rate);
  return known ? DEA_OK
               : dea_fail(ctx, DEA_E_UNSUPPORTED,
                          "model 3d does not support the electrode's stretch here");
}

/* Quantities at the unknowns as they are and another voltage, out [dea_gradient_width], 0 before.
 */
static dea_status quantities_at(struct dea_context *ctx, struct work *w, double voltage_V,
                                double *out)
{
  struct dea_solid *s = w->solid;
  double energy_J;
  s->state.voltage_V = voltage_V;
  dea_status status = dea_adjoint_assemble(ctx, w->adjoint, voltage_V, &energy_J);
  status = status == DEA_OK ? add_quantities(ctx, w, voltage_V, energy_J, out) : status;
  s->state.voltage_V = w->voltage_V;
  return status;
}

/* What each quantity takes of the stretch's slope. */
static dea_status share_border(struct dea_context *ctx, struct work *w)
{
  const struct dea_solid *s = w->solid;
  const size_t width = dea_gradient_width(w->ask);
  const double V = w->voltage_V, by_V = share_of_voltage * V;
  struct border *b = &w->border;
  DEA_TRY(ctx, quantities_at(ctx, w, V - by_V, b->by_voltage));
  DEA_TRY(ctx, quantities_at(ctx, w, V + by_V, b->by_voltage + width));
  for (size_t i = 0; i < width; i++) {
    double *slope = dea_adjoint_slope(w->adjoint, i);
    b->by_voltage[i] = (b->by_voltage[width + i] - b->by_voltage[i]) / (2 * by_V);
    b->pull[i] = (dea_adjoint_pair(w->adjoint, width, i) - b->by_voltage[i]) / b->along;
    dea_add(s->problem.dofs, -b->pull[i], b->slope, slope);
  }
  return DEA_OK;
}

/* What an answer leaves of the border's equation, rate . lambda = dQ/dV, is along v, which close to
 * a limit point is all that the tangent does not resolve. */
static void end_border(struct work *w)
{
  const size_t width = dea_gradient_width(w->ask);
  const struct border *b = &w->border;
  for (size_t i = 0; i < width; i++) {
    const double *lambda = dea_adjoint_answer(w->adjoint, i);
    const double left = b->by_voltage[i] - dea_solid_dot(w->solid, lambda, b->rate);
    if (w->known[i]) {
      dea_adjoint_add(w->adjoint, i, left / b->along_rate, width);
    }
  }
}

/* The answers of all quantities. */
static dea_status answer(struct dea_context *ctx, struct work *w, struct dea_arena *memory)
{
  const bool holds = w->ask->holds_stretch;
  DEA_TRY(ctx, holds ? begin_border(ctx, w, memory) : DEA_OK);
  DEA_TRY(ctx, find_slopes(ctx, w));
  DEA_TRY(ctx, holds ? share_border(ctx, w) : DEA_OK);
  DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, w->known));
  if (holds) {
    end_border(w);
  }
  return DEA_OK;
}

// Changes -----------------------------------------------------------------------------------------

/* Both sides of a change. */
static dea_status difference(struct dea_context *ctx, struct work *w,
                             const struct dea_design_change *change)
{
  for (int k = 0; k < 2; k++) {
    dea_status status = dea_variant_enter(ctx, w->model, change, k);
    if (status == DEA_OK) {
      const double voltage_V = w->ask->holds_stretch ? w->voltage_V : change->voltage_V[k];
      status = evaluate(ctx, w, voltage_V, w->side + (size_t)k * dea_gradient_width(w->ask));
    }
    w->solid->state.voltage_V = w->voltage_V;
    dea_variant_leave(ctx, w->model);
    DEA_TRY(ctx, status);
  }
  return DEA_OK;
}

/* Slopes of all quantities by the changes, whose answers are there. */
static dea_status find_by_changes(struct dea_context *ctx, struct work *w, double *out)
{
  size_t count = dea_gradient_width(w->ask);
  for (size_t c = 0; c < w->ask->change_count; c++) {
    size_t errors = dea_finding_trial_begin(ctx);
    dea_status status = difference(ctx, w, &w->ask->changes[c]);
    dea_finding_trial_end(ctx, errors);
    bool follows =
        status != DEA_E_ARGUMENT && status != DEA_E_UNSUPPORTED && status != DEA_E_DESIGN;
    if (!follows) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                   "model 3d: no gradient by one of the numbers: %s",
                                   dea_context_message(ctx)));
      dea_context_clear(ctx);
    } else {
      DEA_TRY(ctx, status);
    }
    for (size_t i = 0; i < count; i++) {
      out[c * count + i] =
          follows ? (w->side[count + i] - w->side[i]) / w->ask->changes[c].width : NAN;
    }
  }
  return DEA_OK;
}

/* For what residuals are taken along. */
static dea_status reserve(struct dea_context *ctx, struct work *w, struct dea_arena *memory)
{
  const size_t states = w->solid->problem.dofs + dea_solid_multiplier_count(w->solid);
  w->here = dea_arena_alloc(memory, states, sizeof(double));
  w->there = dea_arena_alloc(memory, states, sizeof(double));
  return dea_solid_allreduce(ctx, dea_arena_status(memory));
}

/* small_pivots: at a limit point there is one. */
static dea_status create_adjoint(struct dea_context *ctx, struct work *w, size_t count,
                                 bool small_pivots, struct dea_arena *memory)
{
  w->solid->work.takes_small_pivots = small_pivots;
  const dea_status status = dea_adjoint_create(ctx, w->solid, count, memory, &w->adjoint);
  w->solid->work.takes_small_pivots = false;
  return status;
}

/* At the equilibrium. */
static dea_status find_here(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_gradient_request *ask, struct dea_arena *memory,
                            double *out)
{
  struct dea_solid *s = model->solid;
  struct work w = {.model = model, .solid = s, .voltage_V = model->at.voltage_V, .ask = ask};
  double energy_J;
  w.known = dea_arena_alloc(memory, dea_gradient_width(ask) + 1, sizeof *w.known);
  w.side = dea_arena_alloc(memory, 2 * dea_gradient_width(ask), sizeof *w.side);
  w.motion = dea_arena_alloc(memory, ask->monitor_count + 1, sizeof *w.motion);
  w.force_direction = dea_arena_alloc(memory, s->problem.dofs, sizeof(double));
  dea_status status = dea_solid_allreduce(ctx, dea_arena_status(memory));
  status = status == DEA_OK ? find_modes(ctx, &w, memory) : status; // first: by another factor
  status = status == DEA_OK
               ? create_adjoint(ctx, &w, dea_gradient_width(ask) + 1, ask->holds_stretch, memory)
               : status;
  status = status == DEA_OK ? reserve(ctx, &w, memory) : status;
  status = status == DEA_OK ? prepare_modes(ctx, &w, memory) : status;
  status = status == DEA_OK ? answer(ctx, &w, memory) : status;
  status = status == DEA_OK ? find_by_changes(ctx, &w, out) : status;
  dea_solid_hold_potential(s, w.voltage_V, s->state.u);
  if (status == DEA_OK) { // scales and reactions are those of the equilibrium again
    status = dea_solid_assemble(ctx, s, w.voltage_V, DEA_FORCE, &energy_J);
  }
  return DEA_CHAIN(ctx, status);
}

// A limit point -----------------------------------------------------------------------------------

/* The answer of a step of inverse iteration, of unit size, as what the next one answers to. *turn:
 * square of the angle to what this one has answered to. */
static void begin_step(struct work *w, size_t from, double *turn)
{
  const size_t dofs = w->solid->problem.dofs;
  const double *answer = dea_adjoint_answer(w->adjoint, from);
  double *next = dea_adjoint_slope(w->adjoint, NULL_MODE), *last = w->null_mode;
  double size = 0, product = 0, before = 0;
  for (size_t i = 0; i < dofs; i++) {
    size += answer[i] * answer[i];
    product += answer[i] * last[i];
    before += last[i] * last[i];
  }
  for (size_t i = 0; i < dofs; i++) {
    next[i] = last[i] = answer[i] / sqrt(size);
  }
  *turn = before > 0 ? 1 - product * product / (size * before) : 1;
}

/* w of A w + B mu = 0, B^T w = 0, by inverse iteration from dR/dV on. */
static dea_status find_null_mode(struct dea_context *ctx, struct work *w)
{
  enum { STEPS = 20 };
  static const double settled = 1e-12;
  double turn = 1;
  DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, (const bool[OF_LIMIT]){[RATE] = true}));
  begin_step(w, RATE, &turn);
  for (int i = 0; i < STEPS && turn > settled; i++) {
    DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, (const bool[OF_LIMIT]){[NULL_MODE] = true}));
    begin_step(w, NULL_MODE, &turn);
  }
  return turn > settled ? dea_fail(ctx, DEA_E_UNSUPPORTED,
                                   "two modes turn unstable at once: no slope is known there")
                        : DEA_OK;
}

/* -(w . dR/dP) / (w . dR/dV), where the solid is at the limit point. */
static dea_status find_limit(struct dea_context *ctx, struct work *w, double *out)
{
  const size_t dofs = w->solid->problem.dofs;
  double *rate = w->null_mode + dofs;
  DEA_TRY(ctx, dea_solid_model_rate(ctx, w->solid, w->adjoint, w->voltage_V,
                                    share_of_voltage * w->voltage_V, rate, NULL));
  memcpy(dea_adjoint_slope(w->adjoint, RATE), rate, dofs * sizeof *rate);
  DEA_TRY(ctx, find_null_mode(ctx, w));
  DEA_TRY(ctx, find_by_changes(ctx, w, out));
  const double along = dea_solid_dot(w->solid, dea_adjoint_answer(w->adjoint, NULL_MODE), rate);
  for (size_t c = 0; c < w->ask->change_count; c++) {
    out[c] /= -along;
  }
  return DEA_OK;
}

/* At the state that the ending has kept. */
static dea_status find_there(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_gradient_request *ask, struct dea_arena *memory,
                             double *out)
{
  struct dea_solid *s = model->solid;
  struct dea_solid_saved_state here;
  double side[2], energy_J;
  if (model->at.outcome.at_limit.state == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "no limit point was located on the way of the last solve");
  }
  DEA_TRY(ctx, dea_solid_save_state(ctx, s, &here));
  dea_solid_restore_state(s, &model->at.outcome.at_limit);
  struct work w = {
      .model = model, .solid = s, .voltage_V = dea_solid_voltage(s), .ask = ask, .side = side};
  w.null_mode = dea_arena_alloc(memory, 2 * s->problem.dofs, sizeof *w.null_mode);
  dea_status status = create_adjoint(ctx, &w, OF_LIMIT, true, memory);
  status = status == DEA_OK ? find_limit(ctx, &w, out) : status;
  dea_solid_restore_state(s, &here);
  status = status == DEA_OK ? dea_solid_assemble(ctx, s, model->at.voltage_V, DEA_FORCE, &energy_J)
                            : status;
  dea_solid_saved_state_free(&here);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_solid_model_gradient(struct dea_context *ctx, struct dea_model *model,
                                    const struct dea_gradient_request *ask, double *out)
{
  struct dea_arena memory = {.ctx = ctx};
  dea_solid_model_end_history(ctx, model);
  if (dea_charge_is_held(model->solid)) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "gradients at a given charge are not supported");
  }
  DEA_TRY(ctx, mode_count(ask) > 0 ? dea_solid_check_densities(ctx, model) : DEA_OK);
  dea_solid_liquids_stiffen(model, true);
  dea_status status = dea_variant_begin(ctx, model, ask, &memory);
  if (status == DEA_OK) {
    status = ask->of_limit ? find_there(ctx, model, ask, &memory, out)
                           : find_here(ctx, model, ask, &memory, out);
  }
  dea_solid_liquids_stiffen(model, false);
  model->variant = NULL;
  dea_arena_free(&memory);
  return DEA_CHAIN(ctx, status);
}
