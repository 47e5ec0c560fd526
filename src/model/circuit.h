/* The circuit between a supply and a film (docs/theory/time.md, section 2):
 *
 *   dQ/dt = I - G V,   Q = C V,   I = (V_s - V)/R_s within +-I_max
 *
 * Symbol   meaning                                                   unit
 * V_s, V   voltage of the supply, voltage on the film                V
 * C, G     capacitance and leakage conductance of the film as it is  F, S
 * Q, I     charge on an electrode, current of the supply             C, A
 * R_s      series resistance                                         ohm
 * h        length of the step                                        s
 *
 * A step weighs its two ends by theta, which makes it second order for short steps and exact for
 * the decay of a charge at any length:
 *
 *   Q_n+1 = Q_n + h ((1 - theta) dQ_n + theta dQ_n+1),   theta = 1/(1 - exp(-x)) - 1/x,
 *   x = h (1/R_s + G)/C
 *
 * For a film of given shape this is one linear equation for V, so a model asks for V(C) and its
 * derivative while it looks for its shape, and for the whole state once it has found it. */
#pragma once

#include <stdbool.h>

struct dea_circuit {
  double series_resistance_ohm; // >= 0
  double current_limit_A;       // > 0; INFINITY: none
};

struct dea_control;

struct dea_time_step {
  double length_s;         // >= 0; 0: the supply's voltage jumps
  double source_voltage_V; // of the supply at the end of the step
  bool disconnected;       // from the film during it
  const double *own_V;     // of sources beside it, see dea_time_options; NULL: there are none
  const struct dea_control *control; // of a model that has them (model/model.h); NULL: none moves
  double value;                      // of that at the end of the step
};

/* The film as a circuit element, and the derivatives by whatever the caller varies (0 if unused).
 */
struct dea_circuit_film {
  double capacitance_F, conductance_S;
  double capacitance_slope, conductance_slope;
};

/* Start from zeros, or from a charged film with its own numbers. Works count from the start. */
struct dea_circuit_state {
  double source_voltage_V, voltage_V, charge_C;
  double current_A; // of the supply; without resistance: the mean of the last step
  double capacitance_F, conductance_S;
  double supply_work_J;     // what the supply gave
  double resistance_loss_J; // what R_s took of it
  double leakage_loss_J;
};

/* Whether the voltage follows the supply at once. */
bool dea_circuit_is_ideal(const struct dea_circuit *circuit);
/* Longest step from a state within which works add up: while the film still charges after a jump, a
 * longer one would be over before anything of it was seen. INFINITY otherwise. scale_V: the largest
 * voltage so far. */
double dea_circuit_longest_step(const struct dea_circuit *circuit,
                                const struct dea_circuit_state *last,
                                const struct dea_time_step *step, double scale_V);
/* Voltage at the end of a step with a film of such a shape then; slope: dV by what the film's
 * slopes are taken. film: capacitance > 0. */
double dea_circuit_voltage(const struct dea_circuit *circuit, const struct dea_circuit_state *last,
                           const struct dea_time_step *step, const struct dea_circuit_film *film,
                           double *slope);
/* The state at the end of a step. A jump of an ideal circuit adds no work: only the film knows what
 * it took up, and the caller adds that. */
void dea_circuit_advance(const struct dea_circuit *circuit, const struct dea_circuit_state *last,
                         const struct dea_time_step *step, const struct dea_circuit_film *film,
                         struct dea_circuit_state *out);
