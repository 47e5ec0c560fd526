/* A reduced-order model as a linear system at a bias, in JSON. */
#include "base/json.h"
#include "base/version.h"
#include "model/reduced/reduced.h"

#include <math.h>

/* x' = A x + B u, y = C x + D u: u voltage and force, y coordinate and charge, all from the bias.
 */
enum { PORTS = 2, STATES = (1 + 2 * DEA_REDUCED_MODES) * (DEA_REDUCED_BRANCHES + 2) };

struct system {
  size_t states;
  double A[STATES][STATES], B[STATES][PORTS], C[PORTS][STATES], D[PORTS][PORTS];
};

/* The device at the bias: K, slope of strain, K with branches held. */
struct bias {
  const struct dea_reduced *core;
  struct dea_reduced_point at;
  double x, K, strain, fast, damping_ratio;
};

/* Adds what q = q[u, states] of a copy, which counts `share` and `weight`, is in the outputs. */
static void add_outputs(const struct bias *b, double share, double weight, size_t states,
                        const double *q, const double q_u[PORTS], struct system *s)
{
  const double by_q = b->K * b->at.by_voltage;
  for (size_t i = 0; i < states; i++) {
    s->C[0][i] += share * q[i];
    s->C[1][i] += weight * by_q * q[i];
  }
  for (int j = 0; j < PORTS; j++) {
    s->D[0][j] += share * q_u[j];
    s->D[1][j] += weight * by_q * q_u[j];
  }
  s->D[1][0] += weight * (b->at.charge_by_voltage - by_q * b->at.by_voltage);
}

/* A copy with a mass, or 0, under a part of the force: branches p, then q and its rate. */
static void add_copy(const struct bias *b, double mass, double part, double share, double weight,
                     struct system *s)
{
  const struct dea_reduced *core = b->core;
  const size_t first = s->states, branches = (size_t)core->branch_count, at_q = first + branches;
  const double push[PORTS] = {b->K * b->at.by_voltage, part};
  double q[STATES] = {0}, q_u[PORTS] = {0};
  s->states += branches + (mass > 0 ? 2 : 0);
  if (mass > 0) {
    q[at_q] = 1;
    s->A[at_q][at_q + 1] = 1;
    s->A[at_q + 1][at_q] = -b->fast / mass;
    s->A[at_q + 1][at_q + 1] = -(core->damping + 2 * b->damping_ratio * sqrt(b->K * mass)) / mass;
  }
  for (int j = 0; j < PORTS; j++) {
    if (mass > 0) {
      s->B[at_q + 1][j] = push[j] / mass;
    } else {
      q_u[j] = push[j] / b->fast;
    }
  }
  for (size_t i = 0; i < branches; i++) {
    const double pull = core->branch_N_per_m[i] * b->strain;
    if (mass > 0) {
      s->A[at_q + 1][first + i] = pull / mass;
    } else {
      q[first + i] = pull / b->fast;
    }
  }
  for (size_t i = 0; i < branches; i++) { // p' = (strain q - p)/tau
    const double rate = 1 / core->branch_s[i];
    for (size_t k = first; k < s->states; k++) {
      s->A[first + i][k] = rate * (b->strain * q[k] - (k == first + i ? 1 : 0));
    }
    for (int j = 0; j < PORTS; j++) {
      s->B[first + i][j] = rate * b->strain * q_u[j];
    }
  }
  add_outputs(b, share, weight, s->states, q, q_u, s);
}

static void add_all(const struct bias *b, struct system *s)
{
  add_copy(b, 0, 1, 1, 1, s);
  for (int k = 0; k < b->core->small_count; k++) {
    const struct dea_reduced_mode *mode = &b->core->modes[k];
    const double share = dea_reduced_polynomial(mode->by_q, b->x), part = mode->share / share;
    add_copy(b, dea_reduced_polynomial(mode->mass, b->x), part, share, share / part, s);
    add_copy(b, 0, part, -share, -share / part, s);
  }
}

static json_t *matrix(size_t rows, size_t columns, size_t width, const double *values)
{
  json_t *out = json_array();
  for (size_t i = 0; i < rows; i++) {
    json_t *row = json_array();
    for (size_t j = 0; j < columns; j++) {
      json_array_append_new(row, json_real(values[i * width + j]));
    }
    json_array_append_new(out, row);
  }
  return out;
}

static json_t *system_json(const struct bias *b, const struct system *s, bool turns)
{
  json_t *root = json_object();
  dea_json_add_count(root, "dea_state_space", 1);
  dea_json_add_text(root, "program", DEA_VERSION);
  json_object_set_new(root, "inputs",
                      json_pack("[s, s]", "voltage_V", turns ? "moment_N_m" : "force_N"));
  json_object_set_new(root, "outputs",
                      json_pack("[s, s]", turns ? "turn_rad" : "displacement_m", "charge_C"));
  json_object_set_new(root, "bias_inputs", json_pack("[f, f]", b->at.voltage_V, b->at.force));
  json_object_set_new(root, "bias_outputs", json_pack("[f, f]", b->at.q, b->at.charge_C));
  dea_json_add(root, "damping_ratio", b->damping_ratio);
  json_object_set_new(root, "A", matrix(s->states, s->states, STATES, s->A[0]));
  json_object_set_new(root, "B", matrix(s->states, PORTS, PORTS, s->B[0]));
  json_object_set_new(root, "C", matrix(PORTS, s->states, STATES, s->C[0]));
  json_object_set_new(root, "D", matrix(PORTS, PORTS, PORTS, s->D[0]));
  return root;
}

dea_status dea_reduced_add_state_space(const struct dea_reduced_export *e, struct dea_text *out)
{
  struct bias b = {.core = &e->order->core, .at = e->at, .damping_ratio = e->damping_ratio};
  char *text = NULL;
  b.x = b.at.q - b.core->middle;
  b.strain = dea_reduced_polynomial(b.core->strain, b.x);
  b.K = b.fast = 1 / b.at.by_force;
  for (int i = 0; i < b.core->branch_count; i++) {
    b.fast += b.core->branch_N_per_m[i] * b.strain * b.strain;
  }
  struct system *s = dea_alloc(out->ctx, 1, sizeof *s);
  DEA_TRY_MEMORY(s != NULL);
  add_all(&b, s);
  dea_status status =
      dea_json_text(out->ctx, system_json(&b, s, dea_reduced_order_turns(e->order)), &text);
  if (status == DEA_OK) {
    dea_text_add(out, "%s", text);
  }
  dea_free(out->ctx, text);
  dea_free(out->ctx, s);
  return status;
}
