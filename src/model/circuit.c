#include "model/circuit.h"

#include <math.h>

/* Weight of the end of a step: 1/2 for short ones, 1 for those that are long against the decay. */
static double end_weight(double x)
{
  return x < 1e-3 ? 0.5 + x / 12 : -1 / expm1(-x) - 1 / x;
}

/* What a step needs of the state that it starts from. */
struct start {
  double h, theta;
  double conductance_S; // 1/R_s; 0 without resistance
  double rate_A;        // dQ/dt; without resistance only what leaks
};

static struct start start_of(const struct dea_circuit *circuit,
                             const struct dea_circuit_state *last, const struct dea_time_step *step)
{
  const double h = step->length_s;
  struct start start = {.h = h, .theta = 0.5, .rate_A = -last->conductance_S * last->voltage_V};
  if (circuit->series_resistance_ohm > 0 && !step->disconnected) {
    start.conductance_S = 1 / circuit->series_resistance_ohm;
    start.rate_A += last->current_A;
  }
  double rate = start.conductance_S + last->conductance_S;
  if (last->capacitance_F > 0 && rate > 0) {
    start.theta = end_weight(h * rate / last->capacitance_F);
  }
  return start;
}

/* The largest current in a step; none once the supply is disconnected. */
static double limit_of(const struct dea_circuit *circuit, const struct dea_time_step *step)
{
  return step->disconnected ? 0 : circuit->current_limit_A;
}

bool dea_circuit_is_ideal(const struct dea_circuit *circuit)
{
  return !(circuit->series_resistance_ohm > 0) && isinf(circuit->current_limit_A);
}

double dea_circuit_longest_step(const struct dea_circuit *circuit,
                                const struct dea_circuit_state *last,
                                const struct dea_time_step *step, double scale_V)
{
  static const double small = 1e-3; // of the voltage: what is left may be passed over
  double R = circuit->series_resistance_ohm, limit = circuit->current_limit_A;
  if (step->disconnected) {
    return INFINITY; // the decay of a charge is exact
  }
  double gap = last->source_voltage_V - last->voltage_V, decay_s = R * last->capacitance_F;
  double least = small * fmax(scale_V, fabs(last->source_voltage_V));
  double beyond = isinf(limit) ? 0 : fabs(gap) - R * limit; // what the limit holds back
  if (beyond > least) {
    return fmax(0.5 * last->capacitance_F * beyond / limit, 0.5 * decay_s);
  }
  // On a ramp the film lags by its rate times R C for good; only what is more than that decays.
  double rate = (step->source_voltage_V - last->source_voltage_V) / step->length_s;
  return R > 0 && fabs(gap - decay_s * rate) > least ? 0.5 * decay_s : INFINITY;
}

/* Charge that leaks during a step that ends at a voltage. */
static double leaked(const struct start *start, const struct dea_circuit_state *last,
                     const struct dea_circuit_film *film, double V)
{
  return start->h * ((1 - start->theta) * last->conductance_S * last->voltage_V +
                     start->theta * film->conductance_S * V);
}

double dea_circuit_voltage(const struct dea_circuit *circuit, const struct dea_circuit_state *last,
                           const struct dea_time_step *step, const struct dea_circuit_film *film,
                           double *slope)
{
  struct start start = start_of(circuit, last, step);
  double V_s = step->source_voltage_V, limit = limit_of(circuit, step);
  double end_h = start.h * start.theta; // what the end of the step counts, in seconds
  double known = last->charge_C + (start.h - end_h) * start.rate_A;
  double sum = film->capacitance_F + end_h * film->conductance_S;
  double sum_slope = film->capacitance_slope + end_h * film->conductance_slope;
  double V;
  if (start.conductance_S > 0) {
    double all = sum + end_h * start.conductance_S;
    V = (known + end_h * start.conductance_S * V_s) / all;
    *slope = -V * sum_slope / all;
    double current = (V_s - V) * start.conductance_S;
    if (fabs(current) > limit) {
      V = (known + end_h * copysign(limit, current)) / sum;
      *slope = -V * sum_slope / sum;
    }
    return V;
  }
  V = V_s;
  *slope = 0;
  double given = film->capacitance_F * V - last->charge_C + leaked(&start, last, film, V);
  if (fabs(given) > limit * start.h) { // false without a limit, also for a jump
    V = (known + copysign(limit, given) * start.h) / sum;
    *slope = -V * sum_slope / sum;
  }
  return V;
}

void dea_circuit_advance(const struct dea_circuit *circuit, const struct dea_circuit_state *last,
                         const struct dea_time_step *step, const struct dea_circuit_film *film,
                         struct dea_circuit_state *out)
{
  struct start start = start_of(circuit, last, step);
  double slope, R_s = circuit->series_resistance_ohm, limit = limit_of(circuit, step);
  double V = dea_circuit_voltage(circuit, last, step, film, &slope);
  struct dea_circuit_state end = *last;
  end.source_voltage_V = step->source_voltage_V;
  end.voltage_V = V;
  end.capacitance_F = film->capacitance_F;
  end.conductance_S = film->conductance_S;
  end.charge_C = film->capacitance_F * V;
  double given = end.charge_C - last->charge_C + leaked(&start, last, film, V);
  if (R_s > 0) {
    end.current_A = fmin(fmax((step->source_voltage_V - V) / R_s, -limit), limit);
  } else {
    end.current_A = start.h > 0 ? given / start.h : 0;
  }
  if (start.h > 0) { // over the charge, not the time: right also when the charge decays within h
    double film_work = 0.5 * (last->voltage_V + V) * given;
    double loss = 0.5 * R_s * (last->current_A + end.current_A) * given;
    end.supply_work_J += film_work + loss;
    end.resistance_loss_J += loss;
    end.leakage_loss_J +=
        0.5 * start.h *
        (last->conductance_S * last->voltage_V * last->voltage_V + film->conductance_S * V * V);
  }
  *out = end;
}
