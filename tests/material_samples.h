/* Parameter sets on which the battery of test_material_*.c runs every registered law, and what
 * these tests share. A law that is registered without a set here fails them. */
#pragma once

#include "material/law.h"
#include "testing.h"

#include <string.h>

struct material_sample {
  const char *law;
  double param[DEA_LAW_PARAM_MAX];
};

static const struct material_sample material_samples[] = {
    {"neo-hookean", {356.8e3}},
    {"mooney-rivlin", {160e3, 18.4e3}},
    {"mooney-rivlin", {200e3, -20e3}},
    {"yeoh", {178.4e3, -6.0e3, 4.2e3}},
    {"third-order", {160e3, 18.4e3, -3e3, 2e3, 0.5e3}},
    {"gent", {43e3, 115.0}},
    {"gent", {43e3, 12.0}},
    {"ogden", {630e3, 1.3, 1.2e3, 5.0, -10e3, -2.0}}, // rubber of Ogden (1972)
    {"ogden", {40e3, 2.0}},
    {"ogden", {0.27e3, 8.5}},
    {"arruda-boyce", {300e3, 3.0}},
    {"arruda-boyce", {15e3, 5.99}},
    {"holzapfel-gasser-ogden", {100e3, 400e3, 0.8, 0.1}},
    {"holzapfel-gasser-ogden", {100e3, 400e3, 0.8, 0.0}},
    {"holzapfel-gasser-ogden", {100e3, 400e3, 0.0, 0.0}}, // standard reinforcing model
    {"holzapfel-gasser-ogden", {100e3, 400e3, 1e-9, 0.2}},
    {"compressible-neo-hookean", {4e9, 0.38}},
    {"compressible-neo-hookean", {1.2e6, 0.0}},
    {"compressible-neo-hookean", {3e5, 0.49}},
};

/* Calls check(law, param) for every sample of every registered law. */
static inline void for_each_law(void (*check)(const struct dea_law *law, const double *param))
{
  size_t count, used = 0;
  const struct dea_law *const *laws = dea_law_all(&count);
  for (size_t i = 0; i < count; i++) {
    const size_t before = used;
    for (size_t j = 0; j < sizeof material_samples / sizeof material_samples[0]; j++) {
      if (strcmp(material_samples[j].law, laws[i]->name) == 0) {
        check(laws[i], material_samples[j].param);
        used++;
      }
    }
    if (used == before) {
      fail_msg("law %s has no sample in material_samples.h", laws[i]->name);
    }
  }
  assert_int_equal(used, sizeof material_samples / sizeof material_samples[0]);
}

/* Deterministic numbers, uniform in [low, high) (Numerical Recipes' 64-bit LCG constants). */
static inline double uniform(uint64_t *seed, double low, double high)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return low + (high - low) * (double)(*seed >> 11) / 9007199254740992.0;
}

static inline double largest(const double *values, size_t count)
{
  double most = 0.0;
  for (size_t i = 0; i < count; i++) {
    most = fmax(most, fabs(values[i]));
  }
  return most;
}

/* Every |value - wanted| <= tolerance * scale; a NaN fails. */
static inline void assert_all_close(const char *what, const double *values, const double *wanted,
                                    size_t count, double tolerance, double scale)
{
  for (size_t i = 0; i < count; i++) {
    if (!(fabs(values[i] - wanted[i]) <= tolerance * scale)) {
      fail_msg("%s, entry %zu: %.16g, wanted %.16g, off by %.3g of the scale %.3g", what, i,
               values[i], wanted[i], (values[i] - wanted[i]) / scale, scale);
    }
  }
}
