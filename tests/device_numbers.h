/* A device of model 3d as a function of its numbers, for tests of gradients by changed devices. */
#pragma once

#include "devices.h"
#include "model/model.h"

extern const struct dea_model_type dea_solid_module;
static const struct dea_model_type *const solid = &dea_solid_module;

enum {
  VOLTAGE,
  THICKNESS,
  MODULUS,
  STIFFENING,
  PERMITTIVITY,
  PRE_STRETCH,
  ELECTRODE,
  FRAME,
  TIP,
  WIDTH,
  TIP_WIDTH,
  FIBRE_THICKNESS,
  FIBRE_MODULUS,
  GLUE,
  GLUE_MODULUS,
  OF_DEVICE,
  DEPTH = OF_DEVICE, // these two of a tip
  TIP_SIZE,
  NUMBERS,
  PERMITTIVITY_SLOPE = NUMBERS, // these of a device that has them
  POISSON_RATIO,
  OUTER_GAP,
  ELECTRODE_THICKNESS,
  ELECTRODE_MODULUS,
  FILM_DENSITY,
  FIBRE_DENSITY,
  ALL,
};
static const char *const names[ALL] = {"voltage",
                                       "thickness",
                                       "modulus",
                                       "stiffening",
                                       "permittivity",
                                       "pre-stretch",
                                       "electrode",
                                       "frame",
                                       "tip",
                                       "width",
                                       "tip width",
                                       "fibre thickness",
                                       "fibre modulus",
                                       "glue",
                                       "glue modulus",
                                       "depth",
                                       "size of the tip",
                                       "slope of the permittivity",
                                       "Poisson ratio",
                                       "outer gap",
                                       "electrode thickness",
                                       "electrode modulus",
                                       "film density",
                                       "fibre density"};

struct state {
  struct dea_device device;
  double voltage_V;
  struct dea_pressed pressed; // radius 0: nothing
};

static inline double *number_of(struct state *s, int i)
{
  double *const all[ALL] = {&s->voltage_V,
                            &s->device.film_thickness_unstretched_m,
                            &s->device.film.param[0],
                            &s->device.film.param[2],
                            &s->device.film.permittivity.at_rest,
                            &s->device.pre_stretch,
                            &s->device.electrode_radius_m,
                            &s->device.frame_radius_m,
                            &s->device.fibre_tip_radius_m,
                            &s->device.fibre_width_m,
                            &s->device.fibre_tip_width_m,
                            &s->device.fibre_thickness_m,
                            &s->device.fibre.young_modulus_Pa,
                            &s->device.bond_thickness_m,
                            &s->device.bond_modulus_Pa,
                            &s->pressed.depth_m,
                            &s->pressed.tip.radius_m,
                            &s->device.film.permittivity.slope,
                            &s->device.fibre.poisson_ratio,
                            &s->device.fibre_outer_gap_m,
                            &s->device.electrode_thickness_m,
                            &s->device.electrode.param[0],
                            &s->device.film.density_kg_per_m3,
                            &s->device.fibre.density_kg_per_m3};
  return all[i];
}

static inline struct state changed(const struct state *from, int i, double share)
{
  struct state s = *from;
  *number_of(&s, i) *= 1 + share;
  s.device.film_thickness_m =
      s.device.film_thickness_unstretched_m / (s.device.pre_stretch * s.device.pre_stretch);
  return s;
}

/* Changes of `count` of its numbers by shares of themselves to either side, out [count], over the
 * share; sides [2 count] are lent to them. Of all numbers of the device: numbers NULL. */
static inline void make_changes(const struct state *at, const int *numbers, size_t count,
                                struct state *sides, struct dea_design_change *out)
{
  const double share = 1e-5;
  for (size_t i = 0; i < count; i++) {
    for (size_t k = 0; k < 2; k++) {
      sides[2 * i + k] =
          changed(at, numbers != NULL ? numbers[i] : (int)i, k == 0 ? -share : share);
    }
    out[i] = (struct dea_design_change){.device = {&sides[2 * i].device, &sides[2 * i + 1].device},
                                        .width = 2 * share};
  }
}

/* Of a slope: what differences of residuals over 1e-5 of a number leave, rounding of 1e-11 over
 * that (docs/theory/gradients.md). */
static const double slope_accuracy = 5e-6;

static inline struct state star(void)
{
  struct state at = {.device = test_star(4), .voltage_V = 3e3};
  at.device.fibre_tip_radius_m = 3.2e-3;
  at.device.fibre_tip_width_m = 1e-3;
  at.device.bond_thickness_m = 50e-6;
  at.device.bond_modulus_Pa = 1e6;
  return at;
}

/* A soft disc, whose path turns back. */
static inline struct state soft_disc(void)
{
  struct state at = {.device = test_disc(test_material("arruda-boyce", 15.36e3, 5.99, 0), 1.2,
                                         2.6e-3, 2.6 / 15.5, 0),
                     .voltage_V = 100};
  at.device.film_thickness_unstretched_m = 30e-6;
  at.device.film_thickness_m = 30e-6 / 1.44;
  at.device.frame_radius_m = 15.5e-3;
  at.device.film.permittivity.at_rest = 4.8;
  return at;
}
