/* Devices for tests, made without a design file. */
#pragma once

#include "device/device.h"

#include <string.h>

/* Elastosil 2030 with Table 1 of the paper. */
static inline struct dea_material test_yeoh(void)
{
  struct dea_material m = {.name = "table 1", .law = dea_law_find("yeoh")};
  const double p[] = {178.4e3, -6.0e3, 4.2e3};
  memcpy(m.param, p, sizeof p);
  m.permittivity.at_rest = 2.8;
  m.breakdown.known = true;
  m.breakdown.at_rest_V_per_m = 80e6;
  return m;
}

/* A law with up to three parameters; permittivity such that eps = 1e-11 F/m. */
static inline struct dea_material test_material(const char *law, double p0, double p1, double p2)
{
  struct dea_material m = {.name = "test", .law = dea_law_find(law)};
  const double p[] = {p0, p1, p2};
  memcpy(m.param, p, sizeof p);
  m.permittivity.at_rest = 1e-11 / DEA_EPSILON_0;
  return m;
}

/* Disc of 100 um film in a ring of 15 mm; fibre tips at the electrode edge when there are fibres.
 */
static inline struct dea_device test_disc(struct dea_material film, double pre_stretch,
                                          double electrode_radius_m, double coverage, int fibres)
{
  struct dea_device d = {.disc = true,
                         .film = film,
                         .film_thickness_unstretched_m = 100e-6,
                         .pre_stretch = pre_stretch,
                         .film_thickness_m = 100e-6 / (pre_stretch * pre_stretch),
                         .frame_radius_m = 15e-3,
                         .electrode_radius_m = electrode_radius_m,
                         .coverage = coverage,
                         .fibre_count = fibres,
                         .fibre_tip_radius_m = electrode_radius_m,
                         .fibre_length_m = 15e-3 - electrode_radius_m};
  return d;
}

/* The paper's actuator as built with so many fibres, for model 3d. */
static inline struct dea_device test_star(int fibres)
{
  struct dea_device d = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, fibres);
  d.fibre.young_modulus_Pa = 2950e6;
  d.fibre.poisson_ratio = 0.38;
  d.fibre_width_m = d.fibre_tip_width_m = 2e-3;
  d.fibre_thickness_m = 100e-6;
  return d;
}
