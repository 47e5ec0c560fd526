/* What every kind of element must do, by registration (element_list.h): derivatives, rigid motions,
 * patch test, integrals, and the refusal of an inverted one. */
// ctest: slow
#include "base/quadrature.h"
#include "model/solid/element/element.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <string.h>

static const double pressures[DEA_HEX_PRESSURES_MAX] = {1e4, -2e3, 3e3,  5e2, -1e3,
                                                        2e3, 1e3,  -4e2, 7e2, 1e2};
static const double scale_V_per_m = 2e8, h = 44e-6, rho = 970;

static const double turned_stretch[3] = {1.6, 1.25, 1 / (1.6 * 1.25 - 0.04)}, turned_shear = -0.2;

struct sample {
  const struct dea_element *element;
  struct dea_part_material film;
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], psi[DEA_HEX_NODES_MAX];
  struct dea_element_input in;
};

static struct dea_element_result at, up, down;

static int unknowns(const struct sample *s)
{
  return s->element->type->per_node * s->element->nodes;
}

static double *unknown(struct sample *s, int i)
{
  int per = s->element->type->per_node;
  return i % per < 3 ? &s->u[3 * (i / per) + i % per] : &s->psi[i / per];
}

/* The film is stretched alike along all axes, or along two that are turned; in place of it what is
 * bonded and compressible, or one whose permittivity depends on the stretch. */
enum variant { PLAIN, TURNED, BONDED, SLOPED, VARIANTS };

/* A parallelogram in the plane, upright: the places are linear in the local axes. levels: those of
 * its nodes. A surface lies at z = 0. */
static void fill(int order, const struct dea_element *element, enum variant variant,
                 struct sample *s)
{
  double line[DEA_HEX_LINE_MAX], line_z[DEA_HEX_LINE_MAX] = {0};
  int n = order + 1, levels = element->nodes / (n * n);
  *s = (struct sample){.element = element,
                       .film = {.law = dea_law_find("yeoh"),
                                .param = {178.4e3, -6e3, 4.2e3},
                                .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                .kappa_Pa = 4e7,
                                .permittivity_F_per_m = 2.5e-11,
                                .thickness_m = h,
                                .density_kg_per_m3 = rho}};
  if (variant == TURNED) {
    memcpy(s->film.pre_stretch, turned_stretch, sizeof turned_stretch);
    s->film.pre_shear = turned_shear;
  }
  s->film.permittivity_slope_F_per_m = variant == SLOPED ? -1e-11 : 0;
  assert_int_equal(dea_part_material_relax(&s->film), DEA_OK);
  if (variant == BONDED) {
    s->film = dea_part_material_bonded((const double[]){5.2e5, 0.3});
    s->film.permittivity_F_per_m = element->type->per_node > 3 ? 4e-11 : 0;
  }
  dea_lobatto_nodes((size_t)order, line);
  if (levels > 1) {
    dea_lobatto_nodes((size_t)levels - 1, line_z);
  }
  for (int a = 0; a < element->nodes; a++) {
    double x = line[a % n], y = line[a / n % n], z = line_z[a / (n * n)];
    s->X[3 * a] = 100e-6 * x + 20e-6 * y;
    s->X[3 * a + 1] = 90e-6 * y - 10e-6 * x;
    s->X[3 * a + 2] = 0.5 * h * z;
  }
  s->in = (struct dea_element_input){.part_material = &s->film,
                                     .X = s->X,
                                     .u = s->u,
                                     .multiplier = pressures,
                                     .potential = s->psi,
                                     .potential_V_per_m = scale_V_per_m,
                                     .voltage_V = element->type->per_node == 3 ? 4e3 : 0};
}

static void deform(struct sample *s, const double F[9])
{
  for (int a = 0; a < s->element->nodes; a++) {
    for (int i = 0; i < 3; i++) {
      s->u[3 * a + i] = -s->X[3 * a + i];
      for (int J = 0; J < 3; J++) {
        s->u[3 * a + i] += F[3 * i + J] * s->X[3 * a + J];
      }
    }
  }
}

static void shake(struct sample *s)
{
  for (int a = 0; a < s->element->nodes; a++) {
    for (int i = 0; i < 3; i++) {
      s->u[3 * a + i] = (i == 2 ? 1e-6 : 6e-6) * sin(1.3 * a + i);
    }
    s->psi[a] = 1e3 / scale_V_per_m * sin(1.7 * a);
  }
}

/* No parallelogram any more, and moved. */
static void distort(struct sample *s)
{
  for (int a = 0; a < s->element->nodes; a++) {
    double *X = s->X + 3 * a, x = X[0] / 100e-6, y = X[1] / 90e-6;
    X[0] += 1e-5 * x * y;
    X[1] -= 5e-6 * y * y;
    X[2] += 0.05 * X[2] * x;
  }
  shake(s);
}

static void evaluate(const struct sample *s, struct dea_element_result *out)
{
  assert_int_equal(s->element->type->evaluate(s->element, &s->in, DEA_TANGENT, out), DEA_OK);
}

static double largest(const double *v, int count)
{
  double most = 0;
  for (int i = 0; i < count; i++) {
    most = fmax(most, fabs(v[i]));
  }
  return most;
}

/* g and K by central differences of energy and g; K is symmetric. */
static void check_derivatives(struct sample *s)
{
  int dofs = unknowns(s);
  distort(s);
  evaluate(s, &at);
  double most = largest(at.g, dofs), stiffest = largest(at.K, dofs * dofs);
  for (int j = 0; j<dofs; j += dofs> 60 ? 7 : 1) {
    double *x = unknown(s, j), before = *x, step = 1e-9;
    *x = before + step;
    evaluate(s, &up);
    *x = before - step;
    evaluate(s, &down);
    *x = before;
    assert_close(at.g[j], (up.energy_J - down.energy_J) / (2 * step), 1e-5, 1e-5 * most);
    for (int i = 0; i < dofs; i++) {
      assert_close(at.K[i * dofs + j], (up.g[i] - down.g[i]) / (2 * step), 1e-5, 1e-6 * stiffest);
      assert_close(at.K[i * dofs + j], at.K[j * dofs + i], 0, 1e-12 * stiffest);
    }
  }
}

/* Turned by Q and moved, and with a potential added everywhere: the energy stays, the forces turn,
 * the charges stay. */
static void check_rigid_motion(struct sample *s)
{
  static const double Q[9] = {0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6};
  struct sample turned;
  int per = s->element->type->per_node;
  distort(s);
  turned = *s;
  evaluate(s, &at);
  turned.in.u = turned.u;
  turned.in.X = turned.X;
  turned.in.potential = turned.psi;
  turned.in.part_material = &turned.film;
  for (int a = 0; a < s->element->nodes; a++) {
    turned.psi[a] = s->psi[a] + 5e3 / scale_V_per_m;
    for (int i = 0; i < 3; i++) {
      double x = 3e-4 * (i + 1);
      for (int J = 0; J < 3; J++) {
        x += Q[3 * i + J] * (s->X[3 * a + J] + s->u[3 * a + J]);
      }
      turned.u[3 * a + i] = x - s->X[3 * a + i];
    }
  }
  evaluate(&turned, &up);
  assert_close(up.energy_J, at.energy_J, 1e-9, 0);
  for (int a = 0; a < s->element->nodes; a++) {
    for (int i = 0; i < 3; i++) {
      double g = 0;
      for (int J = 0; J < 3; J++) {
        g += Q[3 * i + J] * at.g[per * a + J];
      }
      assert_close(up.g[per * a + i], g, 0, 1e-9 * largest(at.g, unknowns(s)));
    }
    for (int i = 3; i < per; i++) {
      assert_close(up.g[per * a + i], at.g[per * a + i], 0, 1e-9 * largest(at.g, unknowns(s)));
    }
  }
}

/* A uniform F is what strains, membrane state and recovery say, at every point and node; forces
 * are in balance. */
static void check_patch(struct sample *s)
{
  static struct dea_element_strains strains;
  static struct dea_membrane_state state;
  static struct dea_recovered recovered;
  const double F[9] = {1.1, 0.05, 0, -0.02, 0.95, 0, 0, 0, 1 / (1.1 * 0.95 + 0.001)};
  const struct dea_element_type *type = s->element->type;
  int per = type->per_node;
  double balance[3] = {0}, volume = 0;
  deform(s, F);
  evaluate(s, &at);
  assert_int_equal(type->strains(s->element, &s->in, &strains), DEA_OK);
  assert_int_equal(type->membrane_state(s->element, &s->in, &state), DEA_OK);
  assert_int_equal(type->recover(s->element, &s->in, &recovered), DEA_OK);
  for (int q = 0; q < s->element->points; q++) {
    volume += strains.volume_m3[q];
    assert_close(strains.C[q][0], F[0] * F[0] + F[3] * F[3], 1e-9, 0);
    assert_close(strains.C[q][5], F[0] * F[1] + F[3] * F[4], 1e-9, 0);
  }
  assert_close(volume, at.volume_m3, 1e-12, 0);
  for (int p = 0; p < state.count; p++) {
    assert_close(state.area[p], 1 / F[8], 1e-9, 0);
    const double *T = state.force[p];
    assert_close(state.tension[p], 0.5 * (T[0] + T[1]) - hypot(0.5 * (T[0] - T[1]), T[2]), 1e-9, 0);
  }
  assert_int_equal(recovered.nodes, s->element->nodes);
  for (int a = 0; a < recovered.nodes; a++) {
    for (int i = 0; i < 9; i++) {
      assert_close(recovered.F[a][i], F[i], 0, 1e-9);
    }
    for (int i = 0; i < 3; i++) {
      balance[i] += at.g[per * a + i];
    }
  }
  for (int i = 0; i < 3; i++) {
    assert_close(balance[i], 0, 0, 1e-9 * largest(at.g, unknowns(s)));
  }
}

/* The mass times motions, made and not made. */
static void check_mass_times(const struct sample *s, const double *mass)
{
  double v[DEA_HEX_DOFS_MAX] = {0}, out[DEA_HEX_DOFS_MAX];
  const int n = s->element->nodes;
  for (int i = 0; i < 3 * n; i++) {
    v[i] = sin(1.7 * i + 0.3);
  }
  assert_int_equal(dea_element_mass_times(s->element, &s->film, s->X, v, out), DEA_OK);
  for (int i = 0; i < 3 * n; i++) {
    double force = 0;
    for (int b = 0; b < n; b++) {
      force += mass[i / 3 * n + b] * v[3 * b + i % 3];
    }
    assert_close(out[i], force, 0, 1e-12 * largest(mass, n * n));
  }
}

/* Mass, metric and volume of the parallelogram of 4 (100 x 90 + 20 x 10) um^2. */
static void check_integrals(struct sample *s)
{
  static double mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
  static double laplace[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX], share[DEA_HEX_NODES_MAX];
  const struct dea_element_type *type = s->element->type;
  int n = s->element->nodes;
  double exact = 4 * (100e-6 * 90e-6 + 20e-6 * 10e-6) * h, total = 0, whole = 0, slope = 0;
  evaluate(s, &at);
  assert_int_equal(dea_element_mass(s->element, &s->film, s->X, mass), DEA_OK);
  assert_int_equal(type->metric(s->element, &s->film, s->X, laplace, share), DEA_OK);
  for (int a = 0; a < n; a++) {
    double constant = 0;
    whole += share[a];
    assert_true(share[a] > 0);
    for (int b = 0; b < n; b++) {
      total += mass[a * n + b];
      constant += laplace[a * n + b];
      slope += s->X[3 * a] * laplace[a * n + b] * s->X[3 * b];
    }
    assert_close(constant, 0, 0, 1e-12 * laplace[0]);
  }
  assert_close(at.volume_m3, exact, 1e-12, 0);
  assert_close(total, rho * exact, 1e-12, 0);
  assert_close(whole, exact, 1e-12, 0);
  assert_close(slope, exact, 1e-10, 0); // of x: |grad x| = 1
  check_mass_times(s, mass);
}

/* A step of no length predicts the stresses that are there. */
static void check_prediction(struct sample *s)
{
  static double predicted[DEA_HEX_PRESSURES_MAX + 6 * DEA_HEX_GAUSS_MAX];
  const struct dea_element_type *type = s->element->type;
  if (type->predict == NULL || type->per_node > 3) { // a potential follows the displacements
    return;
  }
  int dofs = unknowns(s);
  shake(s);
  evaluate(s, &at);
  assert_int_equal(type->predict(s->element, &s->in, s->u, 0, true, predicted), DEA_OK);
  s->in.predicted = predicted;
  evaluate(s, &up);
  s->in.predicted = NULL;
  for (int i = 0; i < dofs * dofs; i++) {
    assert_close(up.K[i], at.K[i], 0, 1e-10 * largest(at.K, dofs * dofs));
  }
}

/* b and L say how pressures push and how theta grows, against differences of both; and L L^T is the
 * volume between two constant pressures. */
static void check_constraint(struct sample *s)
{
  enum { PRESSURES = DEA_HEX_PRESSURES_MAX };
  static double b[PRESSURES * DEA_HEX_DOFS_MAX], L[PRESSURES * PRESSURES];
  static double start[DEA_HEX_DOFS_MAX], way[DEA_HEX_DOFS_MAX], multiplier[PRESSURES];
  const struct dea_element_type *type = s->element->type;
  int count = s->element->pressures, dofs = 3 * s->element->nodes, per = type->per_node;
  double step = 1e-6;
  if (type->constraint == NULL) {
    return;
  }
  shake(s);
  assert_int_equal(type->constraint(s->element, &s->in, b, L), DEA_OK);
  memcpy(start, s->u, sizeof start);
  memcpy(multiplier, s->in.multiplier, (size_t)count * sizeof *multiplier);
  const double *lent = s->in.multiplier;
  for (int m = 0; m < count; m++) { // forces are linear in pressures
    evaluate(s, &at);
    s->in.multiplier = multiplier;
    multiplier[m] += 1e3;
    evaluate(s, &up);
    multiplier[m] -= 1e3;
    s->in.multiplier = lent;
    for (int i = 0; i < dofs; i++) {
      double push = 0;
      for (int c = 0; c <= m; c++) {
        push += L[m * count + c] * b[c * dofs + i];
      }
      int place = i / 3 * per + i % 3;
      assert_close((up.g[place] - at.g[place]) / 1e3, push, 0,
                   1e-7 * largest(b, count * dofs) * largest(L, count * count));
    }
  }
  for (int i = 0; i < dofs; i++) {
    way[i] = 1e-4 * sin(1.7 * i + 0.3);
  }
  for (int side = -1; side <= 1; side += 2) {
    for (int i = 0; i < dofs; i++) {
      s->u[i] = start[i] + side * step * way[i];
    }
    evaluate(s, side < 0 ? &at : &up);
  }
  memcpy(s->u, start, sizeof start);
  for (int m = 0; m < count; m++) { // L^T times the change of theta is b times that of u
    double moment = 0, squeeze = 0, size = 0;
    for (int c = m; c < count; c++) {
      moment += L[c * count + m] * (up.theta[c] - at.theta[c]) / (2 * step);
    }
    for (int i = 0; i < dofs; i++) {
      squeeze += b[m * dofs + i] * way[i];
      size += fabs(b[m * dofs + i] * way[i]);
    }
    assert_close(moment, squeeze, 0, 1e-5 * size);
  }
}

/* The work of P at the Gauss points on a small motion is that of the forces; F, J and pressure do
 * not need P. */
static void check_state(struct sample *s)
{
  static struct dea_element_state here, moved, alone;
  const struct dea_element_type *type = s->element->type;
  const double step = 1e-10;
  int per = type->per_node, nodes = s->element->nodes;
  double forces = 0, work = 0, size = 0;
  shake(s);
  evaluate(s, &at);
  assert_int_equal(type->state(s->element, &s->in, true, &here), DEA_OK);
  assert_int_equal(type->state(s->element, &s->in, false, &alone), DEA_OK);
  for (int i = 0; i < 3 * nodes; i++) {
    double way = sin(1.1 * i + 0.2);
    forces += at.g[per * (i / 3) + i % 3] * way;
    s->u[i] += step * way;
  }
  assert_int_equal(type->state(s->element, &s->in, false, &moved), DEA_OK);
  for (int q = 0; q < s->element->points; q++) {
    for (int i = 0; i < 9; i++) {
      double one = here.volume_m3[q] * here.P[q][i] * (moved.F[q][i] - here.F[q][i]) / step;
      work += one;
      size += fabs(one);
      assert_true(alone.F[q][i] == here.F[q][i]);
    }
    double cof[9];
    assert_close(here.J[q], dea_cofactors(here.F[q], cof), 1e-12, 0);
    assert_true(alone.J[q] == here.J[q] && alone.pressure[q] == here.pressure[q]);
  }
  assert_close(work, forces, 0, 1e-4 * size);
}

/* 2 q . B^T v - q . M q / kappa by b and L, and the sum of the size of its terms. */
static double stiffness_of_pressures(const struct sample *s, const double *v, const double *q,
                                     double *size)
{
  enum { PRESSURES = DEA_HEX_PRESSURES_MAX };
  static double b[PRESSURES * DEA_HEX_DOFS_MAX], L[PRESSURES * PRESSURES];
  const int count = s->element->pressures, dofs = 3 * s->element->nodes;
  double sum = 0;
  *size = 0;
  if (s->element->type->constraint == NULL) {
    return 0;
  }
  assert_int_equal(s->element->type->constraint(s->element, &s->in, b, L), DEA_OK);
  for (int c = 0; c < count; c++) {
    double held = 0, gain = 0; // c of L^T q and of b v
    for (int m = c; m < count; m++) {
      held += L[m * count + c] * q[m];
    }
    for (int i = 0; i < dofs; i++) {
      gain += b[c * dofs + i] * v[i];
    }
    sum += 2 * held * gain - held * held / s->film.kappa_Pa;
    *size += fabs(2 * held * gain) + held * held / s->film.kappa_Pa;
  }
  return sum;
}

/* A small motion with pressures, against K without kappa, b and L, and the mass. */
static void check_motion(struct sample *s)
{
  double v[DEA_HEX_DOFS_MAX] = {0}, psi[DEA_HEX_NODES_MAX], q[DEA_HEX_PRESSURES_MAX];
  double all[DEA_ELEMENT_DOFS_MAX], force[DEA_HEX_DOFS_MAX], stiffness, kilograms, mass = 0, size;
  const struct dea_element_type *type = s->element->type;
  const struct dea_element_motion motion = {v, psi, q};
  const int nodes = s->element->nodes, per = type->per_node, dofs = unknowns(s);
  shake(s);
  for (int i = 0; i < 3 * nodes; i++) {
    all[per * (i / 3) + i % 3] = v[i] = 1e3 * sin(1.7 * i + 0.3);
  }
  for (int n = 0; n < nodes; n++) {
    psi[n] = 3e2 * cos(0.9 * n);
    all[per * n + per - 1] = per > 3 ? psi[n] : all[per * n + per - 1];
  }
  for (int m = 0; m < DEA_HEX_PRESSURES_MAX; m++) {
    q[m] = 3e10 * cos(1.3 * m + 0.2);
  }
  assert_int_equal(type->motion(s->element, &s->in, &motion, &stiffness, &kilograms), DEA_OK);
  double sum = stiffness_of_pressures(s, v, q, &size);
  s->film.kappa_Pa = 0;
  evaluate(s, &at);
  for (int i = 0; i < dofs * dofs; i++) {
    double bent = all[i / dofs] * at.K[i] * all[i % dofs];
    sum += bent;
    size += fabs(bent);
  }
  assert_close(stiffness, sum, 0, 1e-12 * size);
  assert_int_equal(dea_element_mass_times(s->element, &s->film, s->X, v, force), DEA_OK);
  for (int i = 0; i < 3 * nodes; i++) {
    mass += v[i] * force[i];
  }
  assert_close(kilograms, mass, 1e-12, 0);
}

static void check_inverted(struct sample *s)
{
  static struct dea_element_state state;
  static struct dea_element_strains strains;
  static double mass[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX], share[DEA_HEX_NODES_MAX];
  double moved[DEA_HEX_DOFS_MAX], stiffness, kilograms;
  const struct dea_element_motion motion = {s->u, s->psi, pressures};
  const struct dea_element_type *type = s->element->type;
  for (int a = 0; a < s->element->nodes; a++) {
    s->X[3 * a] *= -1;
    s->X[3 * a + 1] *= 1;
  }
  memset(s->u, 0, sizeof s->u);
  assert_int_equal(type->evaluate(s->element, &s->in, DEA_TANGENT, &at), DEA_E_DOMAIN);
  assert_int_equal(type->strains(s->element, &s->in, &strains), DEA_E_DOMAIN);
  assert_int_equal(type->state(s->element, &s->in, true, &state), DEA_E_DOMAIN);
  assert_int_equal(dea_element_mass(s->element, &s->film, s->X, mass), DEA_E_DOMAIN);
  assert_int_equal(dea_element_mass_times(s->element, &s->film, s->X, s->u, moved), DEA_E_DOMAIN);
  assert_int_equal(type->motion(s->element, &s->in, &motion, &stiffness, &kilograms), DEA_E_DOMAIN);
  assert_int_equal(type->metric(s->element, &s->film, s->X, mass, share), DEA_E_DOMAIN);
  if (type->capacity != NULL) {
    assert_int_equal(type->capacity(s->element, &s->in, mass), DEA_E_DOMAIN);
  }
  s->u[0] = NAN;
  assert_int_equal(type->evaluate(s->element, &s->in, DEA_ENERGY, &at), DEA_E_DOMAIN);
}

TEST(test_every_kind)
{
  for (int order = 1; order <= DEA_HEX_ORDER_MAX; order++) {
    struct dea_arena memory = {.ctx = ctx};
    struct dea_element_set set;
    assert_int_equal(dea_element_set_create(ctx, order, order > 2 ? 2 : order, &memory, &set),
                     DEA_OK);
    for (int kind = 0; kind < DEA_ELEMENT_COUNT; kind++) {
      static void (*const checks[])(struct sample * s) = {
          check_derivatives, check_rigid_motion, check_patch,  check_integrals, check_prediction,
          check_state,       check_constraint,   check_motion, check_inverted};
      for (size_t i = 0; i < VARIANTS * sizeof checks / sizeof checks[0]; i++) {
        static struct sample s;
        const enum variant variant = i % VARIANTS;
        fill(order, &set.of[kind], variant, &s);
        const struct dea_element_type *type = s.element->type;
        const bool takes = type->check == NULL || type->check(&s.film) == DEA_OK;
        assert_true(takes || variant > TURNED);
        if (variant <= TURNED || (takes && i / VARIANTS < 2)) {
          checks[i / VARIANTS](&s);
        }
      }
    }
    dea_arena_free(&memory);
  }
}

/* A film whose pre-stretch lies at an angle, and the same with its axes along x and y in a body
 * that is turned: Psi(F; R D R^T) = Psi(F R; D), with P = P(F R) R^T and so twice for A. */
TEST(test_pre_stretch_at_an_angle)
{
  static const double D[3] = {1.5, 1.2, 1 / 1.8},
                      F[9] = {1.05, 0.1, 0.02, -0.03, 0.9, 0.1, 0, 0.04, 1.1};
  const double angle = 0.65, c = cos(angle), s = sin(angle);
  const double R[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  struct dea_point turned, straight;
  double cof[9], FR[9] = {0}, P[9] = {0};
  for (int a = 0; a < 9; a++) {
    for (int k = 0; k < 3; k++) {
      FR[a] += F[a / 3 * 3 + k] * R[3 * k + a % 3];
    }
  }
  struct dea_part_material film = {.law = dea_law_find("yeoh"),
                                   .param = {178.4e3, -6e3, 4.2e3},
                                   .pre_stretch = {D[0], D[1], D[2]},
                                   .permittivity_F_per_m = 2.5e-11};
  assert_int_equal(dea_part_material_relax(&film), DEA_OK);
  double J = dea_cofactors(FR, cof), p0 = film.p0_Pa;
  assert_int_equal(dea_part_material_point(&film, FR, cof, J, 1e4, 3e7, true, &straight), DEA_OK);
  film.pre_stretch[0] = D[0] * c * c + D[1] * s * s;
  film.pre_stretch[1] = D[0] * s * s + D[1] * c * c;
  film.pre_shear = (D[0] - D[1]) * s * c;
  assert_int_equal(dea_part_material_relax(&film), DEA_OK);
  assert_close(film.p0_Pa, p0, 1e-13, 0);
  J = dea_cofactors(F, cof);
  assert_int_equal(dea_part_material_point(&film, F, cof, J, 1e4, 3e7, true, &turned), DEA_OK);
  assert_close(turned.W, straight.W, 1e-13, 0);
  for (int a = 0; a < 9; a++) {
    for (int k = 0; k < 3; k++) {
      P[a] += straight.P[a / 3 * 3 + k] * R[a % 3 * 3 + k];
    }
  }
  for (int a = 0; a < 9; a++) {
    assert_close(turned.P[a], P[a], 0, 1e-13 * largest(P, 9));
    for (int b = 0; b < 9; b++) {
      double A = 0;
      for (int k = 0; k < 9; k++) {
        int from = 9 * (a / 3 * 3 + k / 3) + b / 3 * 3 + k % 3;
        A += straight.A[from] * R[a % 3 * 3 + k / 3] * R[b % 3 * 3 + k % 3];
      }
      assert_close(turned.A[9 * a + b], A, 0, 1e-13 * largest(straight.A, 81));
    }
  }
}

TESTS(context_set_up, context_tear_down)
