/* A reduced-order model as a joint and an actuator of MuJoCo, linear about a bias:
 *
 *   force = gain u - K (q - q_0) - c v - gain u_0,   gain = K dq/du,   u = V^2 or, of a device that
 * is not even in V, V, in kV */
#include "base/html.h"
#include "base/version.h"
#include "model/reduced/reduced.h"

#include <math.h>

enum { ROWS = 9, TRIALS = 400, STEPS = 200 }; // STEPS: of time in a period
static const double most_off = 0.05;          // of the stroke

static double control(const struct dea_reduced *core, double voltage_V)
{
  const double kV = 1e-3 * voltage_V;
  return core->even ? kV * kV : kV;
}

/* Force by the control, of a point. */
static double gain(const struct dea_reduced *core, const struct dea_reduced_point *at)
{
  struct dea_reduced_point beside = *at;
  if (!core->even) {
    return 1e3 * at->by_voltage / at->by_force;
  }
  if (at->voltage_V == 0) { // dq/du = (d2q/dV2)/2
    dea_reduced_at(core, at->force, 1, &beside);
  }
  return 1e6 * beside.by_voltage / (2 * beside.voltage_V) / at->by_force;
}

/* The control to one side of the bias up to which the coordinate at rest is near the line. */
static double reach(const struct dea_reduced_order *o, const struct dea_reduced_point *bias,
                    double end_V)
{
  const double slope = gain(&o->core, bias) * bias->by_force;
  double u = control(&o->core, bias->voltage_V);
  for (int i = 1; i <= TRIALS; i++) {
    struct dea_reduced_point at;
    const double V = bias->voltage_V + (end_V - bias->voltage_V) * i / TRIALS;
    const double next = control(&o->core, V);
    if (dea_reduced_at(&o->core, 0, V, &at) != DEA_REDUCED_OK ||
        !(fabs(bias->q + slope * (next - control(&o->core, bias->voltage_V)) - at.q) <=
          most_off * fabs(o->stroke))) {
      break;
    }
    u = next;
  }
  return u;
}

/* Numbers of the device at rest at voltages of its range: column 0 V, 1 q, 2 K, 3 gain. */
static void add_numbers(struct dea_text *out, const struct dea_reduced_order *o, const char *name,
                        int column)
{
  const double from_V = o->core.even ? 0 : o->voltage_V[0];
  dea_text_add(out, "    <numeric name=\"%s\" data=\"", name);
  for (int i = 0; i < ROWS; i++) {
    struct dea_reduced_point at;
    dea_reduced_at(&o->core, 0, from_V + (o->voltage_V[1] - from_V) * i / (ROWS - 1), &at);
    const double row[] = {1e-3 * at.voltage_V, at.q, 1 / at.by_force, gain(&o->core, &at)};
    dea_text_add(out, "%s%.9g", i > 0 ? " " : "", row[column]);
  }
  dea_text_add(out, "\"/>\n");
}

dea_status dea_reduced_add_mujoco(const struct dea_reduced_export *e, struct dea_text *out)
{
  const struct dea_reduced_order *o = e->order;
  const struct dea_reduced_point *bias = &e->at;
  const struct dea_reduced *core = &o->core;
  if (core->mode_count == 0) {
    return dea_fail(out->ctx, DEA_E_DESIGN, "a joint of MuJoCo needs the densities of all parts");
  }
  const bool turns = dea_reduced_order_turns(o);
  const double K = 1 / bias->by_force, g = gain(core, bias), u = control(core, bias->voltage_V);
  const double x = bias->q - core->middle, end_V = core->even ? 0 : o->voltage_V[0];
  static const char *const axes[] = {"1 0 0", "0 1 0", "0 0 1"};
  const int component = o->coordinate.column == 0 ? o->coordinate.component % 3 : 2;
  int mode = 0; // that moves most
  for (int i = 1; i < core->mode_count; i++) {
    mode = core->modes[i].voltage_share > core->modes[mode].voltage_share ? i : mode;
  }
  const double *m = core->modes[mode].mass, mass = dea_reduced_polynomial(m, x);
  dea_text_add(out,
               "<!-- by dea %s, about %.6g kV; control: %s; valid where q at rest is off by at "
               "most %g %% of the stroke: ctrlrange -->\n<mujoco model=\"",
               DEA_VERSION, 1e-3 * bias->voltage_V, core->even ? "V^2 in kV^2" : "V in kV",
               100 * most_off);
  dea_html_text(out, e->name);
  dea_text_add(out,
               "\">\n  <option gravity=\"0 0 0\" timestep=\"%.9g\"/>\n  <worldbody>\n    <body>\n"
               "      <inertial pos=\"0 0 0\" mass=\"%.9g\" diaginertia=\"%.9g %.9g %.9g\"/>\n"
               "      <joint name=\"q\" type=\"%s\" axis=\"%s\"/>\n    </body>\n  </worldbody>\n",
               2 * DEA_PI * sqrt(mass / K) / STEPS, mass, mass, mass, mass,
               turns ? "hinge" : "slide", axes[component]);
  dea_text_add(out,
               "  <actuator>\n    <general name=\"film\" joint=\"q\" gaintype=\"fixed\" "
               "biastype=\"affine\" gainprm=\"%.9g\" biasprm=\"%.9g %.9g %.9g\" "
               "ctrllimited=\"true\" ctrlrange=\"%.9g %.9g\"/>\n  </actuator>\n"
               "  <keyframe>\n    <key name=\"bias\" qpos=\"%.9g\" ctrl=\"%.9g\"/>\n  </keyframe>\n"
               "  <custom>\n",
               g, K * bias->q - g * u, -K, -(core->damping + 2 * e->damping_ratio * sqrt(K * mass)),
               reach(o, bias, end_V), reach(o, bias, o->voltage_V[1]), bias->q, u);
  add_numbers(out, o, "voltage_kV", 0);
  add_numbers(out, o, "rest", 1);
  add_numbers(out, o, "stiffness", 2);
  add_numbers(out, o, "gain", 3);
  dea_text_add(out, "  </custom>\n</mujoco>\n");
  return DEA_OK;
}
