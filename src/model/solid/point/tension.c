#include "model/solid/point/tension.h"

dea_status dea_tension_taut(const struct dea_tension *film, double l1, double l2,
                            struct dea_plane *out)
{
  dea_status status = dea_plane_elastic(film->material, l1, l2, out);
  if (status == DEA_OK && film->nominal_field_V_per_m != 0) {
    struct dea_plane electric;
    dea_plane_electric(film->material, film->nominal_field_V_per_m, l1, l2, &electric);
    out->W += electric.W;
    out->s1 += electric.s1;
    out->s2 += electric.s2;
    out->k11 += electric.k11;
    out->k22 += electric.k22;
    out->k12 += electric.k12;
  }
  if (status == DEA_OK && film->viscous_Pa != NULL) {
    const double *B = film->viscous_Pa, across = B[2] / (l1 * l1 * l2 * l2);
    out->W += 0.5 * (B[0] * (l1 * l1 - 1) + B[1] * (l2 * l2 - 1) + across - B[2]);
    out->s1 += B[0] * l1 - across / l1;
    out->s2 += B[1] * l2 - across / l2;
    out->k11 += B[0] + 3 * across / (l1 * l1);
    out->k22 += B[1] + 3 * across / (l2 * l2);
    out->k12 += 2 * across / (l1 * l2);
  }
  return status;
}

/* A line of states: across it at a given length, or along equal stretches. */
struct line {
  const struct dea_tension *film;
  double l1; // 0: equal stretches
};

/* Stress and its slope along the line. Beyond the domain of a law that locks the film is stiff. */
static dea_status line_at(const struct line *line, double l, struct dea_plane *out, double *stress,
                          double *slope)
{
  dea_status status = dea_tension_taut(line->film, line->l1 > 0 ? line->l1 : l, l, out);
  *stress = status == DEA_OK ? out->s2 : 1;
  *slope = status != DEA_OK ? 0 : line->l1 > 0 ? out->k22 : out->k22 + out->k12;
  return status == DEA_E_DOMAIN ? DEA_OK : status;
}

/* Zero of the stress between low, where it is not positive, and high, where it is: Newton's method
 * kept in the bracket by bisection, to rounding. *out: the state there. */
static dea_status line_zero(const struct line *line, double low, double high, double *zero,
                            struct dea_plane *out)
{
  enum { ITERATIONS_MAX = 200 };
  double l = low, stress, slope;
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    dea_status status = line_at(line, l, out, &stress, &slope);
    if (status != DEA_OK) {
      return status;
    }
    if (stress <= 0) {
      low = l;
    } else {
      high = l;
    }
    double next = slope > 0 ? l - stress / slope : high;
    if (!(next > low && next < high)) {
      next = fabs(next - l) <= 4e-16 * l ? l : 0.5 * (low + high);
    }
    if (fabs(next - l) <= 4e-16 * l) {
      break;
    }
    l = next;
  }
  *zero = l;
  return dea_tension_taut(line->film, line->l1 > 0 ? line->l1 : l, l, out);
}

/* Energy of the slack film: that of its natural size, which is not below l. */
static dea_status slack(const struct dea_tension *film, double l, struct dea_plane *out,
                        double natural[2])
{
  static const double most = 20; // no elastomer stretches so far
  const struct line equal = {film, 0};
  double low = l > 1 || film->viscous_Pa != NULL ? l : 1, high = low, stress = 0, slope;
  while (!(stress > 0)) {
    high *= 1.05;
    dea_status status = high > most ? DEA_E_DOMAIN : line_at(&equal, high, out, &stress, &slope);
    if (status != DEA_OK) {
      return status;
    }
  }
  dea_status status = line_zero(&equal, low, high, &natural[0], out);
  natural[1] = natural[0];
  *out = (struct dea_plane){.W = out->W};
  return status;
}

/* Uniaxial tension along l1 at the natural width, between low and l1. */
static dea_status wrinkled(const struct dea_tension *film, double l1, double low,
                           struct dea_plane *out, double natural[2])
{
  const struct line across = {film, l1};
  struct dea_plane at;
  dea_status status = line_zero(&across, low, l1, &natural[1], &at);
  if (status == DEA_OK && !(at.k22 > 0)) {
    return DEA_E_DOMAIN;
  }
  *out = (struct dea_plane){.W = at.W, .s1 = at.s1, .k11 = at.k11 - at.k12 * at.k12 / at.k22};
  return status;
}

dea_status dea_tension_relaxed(const struct dea_tension *film, double l1, double l2,
                               struct dea_plane *out, double natural[2],
                               enum dea_tension_state *state)
{
  // at V = 0 the natural width is that of a uniaxial test; the field only adds to it
  const bool elastic = film->viscous_Pa == NULL;
  double narrow = elastic ? 1 / sqrt(l1) : l2, stress, slope;
  const struct line equal = {film, 0};
  natural[0] = l1;
  natural[1] = l2;
  if (l2 >= narrow && l2 > 0) {
    dea_status status = dea_tension_taut(film, l1, l2, out);
    if (status != DEA_OK || (out->s2 >= 0 && (out->s1 >= 0 || !elastic))) {
      *state = DEA_TAUT;
      return status;
    }
  }
  *state = DEA_SLACK;
  if (l1 <= 1 && elastic) {
    return slack(film, 1, out, natural);
  }
  dea_status status = line_at(&equal, l1, out, &stress, &slope);
  if (status != DEA_OK || stress <= 0) {
    return status != DEA_OK ? status : slack(film, l1, out, natural);
  }
  *state = DEA_WRINKLED;
  return wrinkled(film, l1, l2 > narrow ? l2 : narrow, out, natural);
}
