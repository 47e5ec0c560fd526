/* A device in one coordinate (docs/theory/reduced-model.md), in plain C99 that needs nothing but
 * <math.h>: `dea reduce-order --c` writes these two files with a device's numbers.
 *
 *   Phi(F, V)   complementary energy: q = -dPhi/dF, Q = -dPhi/dV
 *
 * Symbol   meaning                                                        unit
 * q, F     coordinate, force conjugate to it on the device                m (rad), N (N m)
 * V, Q     voltage on the film, its charge                                V, C
 * e, p     measure of strain of the branches, their internal variables    as q
 *
 * Functions return 0, or why they cannot: enum dea_reduced_end. Nothing allocates. */
#pragma once

enum { DEA_REDUCED_TERMS = 6, DEA_REDUCED_BRANCHES = 12, DEA_REDUCED_MODES = 6 };

enum dea_reduced_end {
  DEA_REDUCED_OK,
  DEA_REDUCED_BEYOND_FORCE,   // F is outside its range
  DEA_REDUCED_BEYOND_VOLTAGE, // V is
  DEA_REDUCED_NOT_CONVERGED
};

/* A mode of the device: a part of it that moves as a device with that mass would. */
struct dea_reduced_mode {
  double mass[3];       // by x = q - middle [kg]: mass[0] + mass[1] x + mass[2] x^2
  double share;         // of dq/dF
  double voltage_share; // of dq/dV
  double by_q[3];       // the same by x, of small motions
};

/* A function of two variables, of degree 5 in each cell: sum c[i][j] s^i t^j, with s and t from 0
 * to 1 across the cell. */
struct dea_reduced_spline {
  int cells[2];
  const double *breaks[2]; // [cells + 1]
  const double *c;         // [cells[0]][cells[1]][TERMS][TERMS]
};

struct dea_reduced {
  struct dea_reduced_spline energy; // Phi [J] by F and V, of an even device by F and V^2
  int even;
  double middle, strain[3]; // de/dq = strain[0] + ... by x
  struct dea_reduced_mode modes[DEA_REDUCED_MODES];
  int mode_count, small_count; // in time and, with others, of small motions; 0: without mass
  double damping;              // dashpot at the coordinate [N s/m]
  int branch_count;
  double branch_N_per_m[DEA_REDUCED_BRANCHES], branch_s[DEA_REDUCED_BRANCHES];
};

struct dea_reduced_point {
  double force, voltage_V;
  double q, charge_C, energy_J;                   // energy: Phi + F q, at V
  double by_force, by_voltage, charge_by_voltage; // dq/dF, dq/dV (which is dQ/dF), dQ/dV at F
};

/* A device of one mass or of none. */
struct dea_reduced_copy {
  struct dea_reduced_point at;
  double rate, acceleration;
  double p[DEA_REDUCED_BRANCHES], loss_J;
};

struct dea_reduced_state {
  double time_s, external;     // force from outside
  struct dea_reduced_point at; // of the sum of the copies
  double rate;
  double branch_J, kinetic_J; // stored beside the film's energy
  double loss_J, external_J;  // in branches and damping; work of the force from outside
  /* Without mass; then for each mode one with it, which is added, and one without, which is taken
   * off. */
  struct dea_reduced_copy copy[1 + 2 * DEA_REDUCED_MODES];
};

/* c[0] + c[1] x + c[2] x^2. */
double dea_reduced_polynomial(const double c[3], double x);
/* Value and slopes at x, y: out f, f_x, f_y, f_xx, f_xy, f_yy. Outside: of the nearest cell. */
void dea_reduced_spline_at(const struct dea_reduced_spline *spline, double x, double y,
                           double out[6]);
/* At a force and a voltage. */
int dea_reduced_at(const struct dea_reduced *model, double force, double voltage_V,
                   struct dea_reduced_point *out);
/* At a coordinate and a voltage; *out: a point near it before. */
int dea_reduced_held(const struct dea_reduced *model, double q, double voltage_V,
                     struct dea_reduced_point *out);
/* At rest for long at a voltage and a force from outside. */
int dea_reduced_begin(const struct dea_reduced *model, double voltage_V, double external,
                      struct dea_reduced_state *out);
/* A step of generalised alpha with the spectral radius rho, or without inertia; voltage and force
 * are those at its end. length_s 0: these jump. to may be from. */
int dea_reduced_step(const struct dea_reduced *model, const struct dea_reduced_state *from,
                     double length_s, double voltage_V, double external, int inertia, double rho,
                     struct dea_reduced_state *to);
/* What the copy k of a state counts in the coordinate, and in charge and energies. */
double dea_reduced_weight(const struct dea_reduced *model, int k, double *energy);
