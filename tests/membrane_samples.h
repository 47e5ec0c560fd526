/* Films of the tests of membrane elements, and surface gradients with known stretches. */
#pragma once

#include "material_samples.h"
#include "model/solid/element/membrane.h"

static const double yeoh[DEA_LAW_PARAM_MAX] = {178.4e3, -6e3, 4.2e3};
static const double permittivity = 2.8 * DEA_EPSILON_0;

static inline struct dea_part_material film(const struct dea_law *law, const double *param,
                                            double g1, double g2)
{
  struct dea_part_material out = {.pre_stretch = {g1, g2, 1 / (g1 * g2)},
                                  .permittivity_F_per_m = permittivity,
                                  .thickness_m = 100e-6 / (g1 * g2)};
  dea_part_material_set_law(&out, law, param);
  return out;
}

static inline struct dea_part_material yeoh_film(double pre_stretch)
{
  return film(dea_law_find("yeoh"), yeoh, pre_stretch, pre_stretch);
}

/* Turns a by the rotation of an angle about z, then of another about x. */
static inline void rotation(double z, double x, double Q[9])
{
  const double rows[9] = {cos(z),          -sin(z),         0,
                          cos(x) * sin(z), cos(x) * cos(z), -sin(x),
                          sin(x) * sin(z), sin(x) * cos(z), cos(x)};
  memcpy(Q, rows, 9 * sizeof *Q);
}

/* F (3 x 2) = Q diag(m1, m2) R: surface stretched by m1, m2 in directions turned by an angle. */
static inline void compose(double m1, double m2, double angle, double F[6])
{
  double Q[9], c = cos(angle), s = sin(angle);
  rotation(0.7, -0.4, Q);
  for (int i = 0; i < 3; i++) {
    F[2 * i] = m1 * c * Q[3 * i] - m2 * s * Q[3 * i + 1];
    F[2 * i + 1] = m1 * s * Q[3 * i] + m2 * c * Q[3 * i + 1];
  }
}
