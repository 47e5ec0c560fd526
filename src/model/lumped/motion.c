/* Steps in time of the lumped model: one unknown, l_a, and the voltage that the circuit then has.
 *
 *   M a + 2 l_pre vol [s(l_A, E~, B) - s(l_P, B)] = 0
 *
 * (paper eq 16 with branches and inertia). Each step is made once whole and once in two halves; the
 * halves count, a third of the difference is the estimate of their error. */
#include "model/lumped/motion.h"

#include "model/alpha.h"

#include <math.h>

// Below these errors are not relative: a stretch, and in the film's own measure (H0 sqrt(mu/eps),
// mu vol) a voltage and an energy. What starts from nothing has errors as large as itself.
static const double smallest_motion = 1e-6, smallest_voltage = 1e-4, smallest_energy = 1e-6;

double dea_lumped_mass(const struct dea_device *device)
{
  double a = device->electrode_radius_m, L = device->frame_radius_m, d = L - a;
  double film = device->film.density_kg_per_m3 * device->film_thickness_m;
  double electrodes = device->electrode.density_kg_per_m3 * 2 * device->electrode_thickness_m /
                      (device->pre_stretch * device->pre_stretch);
  double disc = (film + electrodes) * DEA_PI * a * a * a * a / 2;
  double annulus = film * 2 * DEA_PI * a * a * d * (L / 3 - d / 4);
  return disc + annulus;
}

/* Everything at l_a. */
struct evaluation {
  double imbalance_Pa, slope_Pa; // total, along the circuit's V(l_a)
  double voltage_V;
  struct dea_circuit_film film;
  double energy_Pa; // as in struct dea_lumped_balance, without the branches
};

static dea_status evaluate(const struct dea_lumped *lumped, const struct dea_lumped_motion *motion,
                           const struct dea_circuit_state *circuit,
                           const struct dea_time_step *step, double l, struct evaluation *out)
{
  const struct dea_film *film = &lumped->film;
  double l_pre = lumped->pre_stretch, H0 = film->thickness_m, l_A = l * l_pre;
  struct dea_plane unit; // at 1 V/m: -(1/2) eps l_A^4
  double scale = -2 * motion->volume_m3 / (H0 * H0), dV, resistivity;
  dea_plane_electric(film->material, 1, l_A, l_A, &unit);
  out->film = (struct dea_circuit_film){.capacitance_F = scale * unit.W,
                                        .capacitance_slope = scale * l_pre * (unit.s1 + unit.s2)};
  resistivity = film->material->resistivity_ohm_m;
  if (resistivity > 0) { // R_l = rho d^2/vol, d = H0/l_A^2
    out->film.conductance_S = motion->volume_m3 * pow(l_A, 4) / (resistivity * H0 * H0);
    out->film.conductance_slope = 4 * out->film.conductance_S / l;
  }
  out->voltage_V = dea_circuit_voltage(&motion->options.circuit, circuit, step, &out->film, &dV);
  struct dea_lumped_balance balance;
  DEA_TRY_STATUS(dea_lumped_balance_eval(lumped, l, out->voltage_V / H0, &balance));
  out->imbalance_Pa = balance.imbalance_Pa;
  out->slope_Pa = balance.slope_Pa + balance.slope_field_Pa_m_per_V * dV / H0;
  out->energy_Pa = balance.energy_Pa - balance.branch_energy_Pa;
  return DEA_OK;
}

/* Residual of a step: r = inertia (l - l*) + weight s(l) + known. */
struct equation {
  const struct dea_lumped_motion *motion;
  const struct dea_circuit_state *circuit;
  const struct dea_time_step *step;
  const struct dea_lumped *lumped; // with the branches of the step
  double inertia_Pa, start, weight, known_Pa;
};

static dea_status residual(const struct equation *e, double l, struct evaluation *at, double *r,
                           double *slope)
{
  DEA_TRY_STATUS(evaluate(e->lumped, e->motion, e->circuit, e->step, l, at));
  *r = e->inertia_Pa * (l - e->start) + e->weight * at->imbalance_Pa + e->known_Pa;
  *slope = e->inertia_Pa + e->weight * at->slope_Pa;
  return DEA_OK;
}

/* The stable root that one comes to from l downhill. Newton, kept between where the residual still
 * has the sign of the start and where it has not, or is no longer stable. */
static dea_status find_root(const struct equation *e, double *l, struct evaluation *at)
{
  enum { TRIALS = 200 };
  static const double longest = 0.03, close = 1e-14;
  double r, slope, x = *l, near = *l, far = NAN;
  bool wall = false; // far is where stability ends, not beyond a root
  if (residual(e, x, at, &r, &slope) != DEA_OK) {
    return DEA_E_DOMAIN;
  }
  double sign = copysign(1, r);
  for (int i = 0; i < TRIALS; i++) {
    if (r == 0 || (slope > 0 && fabs(r) <= close * slope * x)) {
      *l = x;
      return DEA_OK;
    }
    double next = x - r / slope;
    double within = isnan(far) ? near - sign * longest : far;
    bool good = slope > 0 && (near - next) * sign > 0 && (next - within) * sign >= 0;
    next = good ? next : isnan(far) ? within : 0.5 * (near + far);
    if (!isnan(far) && fabs(far - near) <= 4e-16 * fabs(near)) {
      *l = x;
      return wall || !(slope > 0) ? DEA_E_NO_EQUILIBRIUM : DEA_OK;
    }
    x = next;
    dea_status status = residual(e, x, at, &r, &slope);
    if (status != DEA_OK || (sign * r > 0 && !(slope > 0))) {
      far = x;
      wall = true;
      slope = -1; // the next trial is half way
    } else if (sign * r > 0) {
      near = x;
    } else {
      far = x;
      wall = false;
    }
  }
  return DEA_E_NOT_CONVERGED;
}

static double passive_stretch(const struct dea_lumped *lumped, double l) // paper eq 17, total
{
  return (1 - lumped->coverage * l) / (1 - lumped->coverage) * lumped->pre_stretch;
}

/* What follows once the stretch is known: branches, charge, energies. */
static void fill_moment(const struct dea_lumped_motion *motion, const struct dea_lumped_state *from,
                        const struct dea_time_step *step, const struct evaluation *at,
                        struct dea_lumped_state *to)
{
  const struct dea_lumped *lumped = &motion->lumped;
  const struct dea_material *material = lumped->film.material;
  double R = lumped->coverage, l_pre = lumped->pre_stretch, h = step->length_s;
  double passive = (1 - R) / R; // volume of the passive film over that of the active
  double l_A[2], l_P[2], W[2], D[2];
  const struct dea_lumped_state *ends[2] = {from, to};
  for (int i = 0; i < 2; i++) {
    l_A[i] = ends[i]->electrode_stretch * l_pre;
    l_P[i] = passive_stretch(lumped, ends[i]->electrode_stretch);
  }
  dea_equal_update(material, from->active, h, l_A[0], l_A[1], to->active);
  dea_equal_update(material, from->passive, h, l_P[0], l_P[1], to->passive);
  W[0] = dea_equal_energy(material, to->active, l_A[1]);
  W[1] = dea_equal_energy(material, to->passive, l_P[1]);
  D[0] = dea_equal_loss(material, from->active, h, l_A[0], l_A[1]);
  D[1] = dea_equal_loss(material, from->passive, h, l_P[0], l_P[1]);
  dea_circuit_advance(&motion->options.circuit, &from->circuit, step, &at->film, &to->circuit);
  to->time_s = from->time_s + h;
  to->branch_loss_J = from->branch_loss_J + motion->volume_m3 * (D[0] + passive * D[1]);
  // The electric part of the energy is -Q V/2; what the field holds is +Q V/2.
  to->stored_energy_J = motion->volume_m3 * (at->energy_Pa + W[0] + passive * W[1]) +
                        to->circuit.charge_C * to->circuit.voltage_V;
  if (h == 0 && dea_circuit_is_ideal(&motion->options.circuit) && !step->disconnected) {
    to->circuit.supply_work_J += to->stored_energy_J - from->stored_energy_J;
  }
  to->imbalance_Pa = at->imbalance_Pa; // that of A: it differs from B by a pressure
}

/* The lumped model in a step from a moment. */
static struct dea_lumped with_branches(const struct dea_lumped_motion *motion,
                                       const struct dea_lumped_state *from, double length_s)
{
  struct dea_lumped lumped = motion->lumped;
  const struct dea_material *material = lumped.film.material;
  double l = from->electrode_stretch;
  lumped.active_known = dea_equal_known(material, from->active, length_s, l * lumped.pre_stretch);
  lumped.passive_known =
      dea_equal_known(material, from->passive, length_s, passive_stretch(&lumped, l));
  return lumped;
}

struct dea_lumped dea_lumped_frozen(const struct dea_lumped_motion *motion,
                                    const struct dea_lumped_state *moment)
{
  return with_branches(motion, moment, 0);
}

/* One step, whole; generalised-alpha where there is inertia. */
static dea_status step_once(const struct dea_lumped_motion *motion,
                            const struct dea_lumped_state *from, const struct dea_time_step *step,
                            struct dea_lumped_state *to)
{
  const struct dea_lumped lumped = with_branches(motion, from, step->length_s);
  double h = step->length_s, l = from->electrode_stretch;
  const struct dea_alpha alpha = dea_alpha_of(motion->options.rho_inf);
  bool inertia = motion->options.inertia;
  double mass_Pa_s2 = motion->mass_kg_m2 / (2 * lumped.pre_stretch * motion->volume_m3);
  struct equation e = {motion, &from->circuit, step, &lumped, 0, 0, 1, 0};
  if (inertia && h > 0) {
    double acceleration = from->acceleration_per_s2;
    e.start = l + h * from->rate_per_s + h * h * (0.5 - alpha.beta) * acceleration;
    e.inertia_Pa = (1 - alpha.m) * mass_Pa_s2 / (alpha.beta * h * h);
    e.weight = 1 - alpha.f;
    e.known_Pa = alpha.m * mass_Pa_s2 * acceleration + alpha.f * from->imbalance_Pa;
  }
  struct evaluation at;
  const bool stays = inertia && !(h > 0); // the film; its charge may jump
  *to = *from;
  DEA_TRY_STATUS(stays ? evaluate(&lumped, motion, &from->circuit, step, l, &at)
                       : find_root(&e, &l, &at));
  to->electrode_stretch = l;
  fill_moment(motion, from, step, &at, to);
  if (inertia && h > 0) {
    // from the forces: (l - l*)/(beta h^2) would be the same, but for the rounding of l
    to->acceleration_per_s2 =
        -(e.weight * to->imbalance_Pa + e.known_Pa) / ((1 - alpha.m) * mass_Pa_s2);
    to->rate_per_s = from->rate_per_s + h * ((1 - alpha.gamma) * from->acceleration_per_s2 +
                                             alpha.gamma * to->acceleration_per_s2);
  } else if (inertia) {
    to->acceleration_per_s2 = -to->imbalance_Pa / mass_Pa_s2;
  }
  return DEA_OK;
}

static double loss(const struct dea_lumped_state *moment)
{
  return moment->branch_loss_J + moment->circuit.leakage_loss_J;
}

dea_status dea_lumped_begin(struct dea_lumped_motion *motion, double electrode_stretch,
                            double voltage_V)
{
  const struct dea_time_step none = {.length_s = 0, .source_voltage_V = voltage_V};
  const struct dea_circuit ideal = {0, INFINITY}, given = motion->options.circuit;
  struct dea_lumped_state rest = {.electrode_stretch = electrode_stretch};
  struct dea_lumped lumped = motion->lumped;
  struct evaluation at;
  for (size_t i = 0; i < lumped.film.material->branch_count; i++) {
    rest.active[i] = dea_equal_inverse(electrode_stretch * lumped.pre_stretch);
    rest.passive[i] = dea_equal_inverse(passive_stretch(&lumped, electrode_stretch));
  }
  lumped = with_branches(motion, &rest, 0);
  motion->options.circuit = ideal; // however it was charged: that was long ago
  dea_status status = evaluate(&lumped, motion, &rest.circuit, &none, electrode_stretch, &at);
  if (status == DEA_OK) {
    motion->now = rest;
    fill_moment(motion, &rest, &none, &at, &motion->now);
    motion->now.circuit.supply_work_J = 0;
  }
  motion->options.circuit = given;
  motion->largest_motion = smallest_motion;
  motion->largest_voltage_V = smallest_voltage * dea_film_voltage_scale(&motion->lumped.film);
  motion->largest_work_J =
      smallest_energy * dea_film_modulus(&motion->lumped.film) * motion->volume_m3;
  return status;
}

/* A sum along the step, from that of the whole and that of the halves: Simpson's rule out of two
 * trapezoidal ones. */
static void extrapolate(const double *whole, double *halves)
{
  *halves += (*halves - *whole) / 3;
}

dea_status dea_lumped_advance(struct dea_lumped_motion *motion, const struct dea_time_step *step,
                              double *error)
{
  const struct dea_lumped_state *now = &motion->now;
  struct dea_lumped_state whole, half, *end = &motion->trial;
  double h = step->length_s;
  *error = 0;
  if (!(h > 0)) {
    return step_once(motion, now, step, end);
  }
  double longest = dea_circuit_longest_step(&motion->options.circuit, &now->circuit, step,
                                            motion->largest_voltage_V);
  if (h > longest) { // whatever the answer, it is not to be relied on
    *error = h / longest;
    return step_once(motion, now, step, end);
  }
  double V_s = now->circuit.source_voltage_V;
  const struct dea_time_step first = {.length_s = 0.5 * h,
                                      .source_voltage_V =
                                          V_s + 0.5 * (step->source_voltage_V - V_s),
                                      .disconnected = step->disconnected};
  const struct dea_time_step second = {.length_s = 0.5 * h,
                                       .source_voltage_V = step->source_voltage_V,
                                       .disconnected = step->disconnected};
  DEA_TRY_STATUS(step_once(motion, now, step, &whole));
  DEA_TRY_STATUS(step_once(motion, now, &first, &half));
  DEA_TRY_STATUS(step_once(motion, &half, &second, end));
  end->time_s = now->time_s + h;
  double change = fmax(motion->largest_motion, fabs(end->electrode_stretch - 1));
  double voltage = fmax(motion->largest_voltage_V, fabs(end->circuit.voltage_V));
  double work = fmax(motion->largest_work_J, fabs(end->circuit.supply_work_J));
  *error = fabs(whole.electrode_stretch - end->electrode_stretch) / change;
  *error = fmax(*error, fabs(whole.circuit.voltage_V - end->circuit.voltage_V) / voltage);
  *error = fmax(*error, fabs(loss(&whole) - loss(end)) / work);
  *error = fmax(*error, fabs(whole.circuit.supply_work_J - end->circuit.supply_work_J) / work) / 3;
  extrapolate(&whole.branch_loss_J, &end->branch_loss_J);
  extrapolate(&whole.circuit.supply_work_J, &end->circuit.supply_work_J);
  extrapolate(&whole.circuit.resistance_loss_J, &end->circuit.resistance_loss_J);
  extrapolate(&whole.circuit.leakage_loss_J, &end->circuit.leakage_loss_J);
  return DEA_OK;
}

void dea_lumped_accept(struct dea_lumped_motion *motion)
{
  const struct dea_lumped_state *now = &motion->now;
  motion->now = motion->trial;
  motion->largest_motion = fmax(motion->largest_motion, fabs(now->electrode_stretch - 1));
  motion->largest_voltage_V = fmax(motion->largest_voltage_V, fabs(now->circuit.voltage_V));
  motion->largest_work_J = fmax(motion->largest_work_J, fabs(now->circuit.supply_work_J));
}
