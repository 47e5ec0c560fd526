#include "model/alpha.h"

struct dea_alpha dea_alpha_of(double spectral_radius)
{
  double r = spectral_radius, m = (2 * r - 1) / (r + 1), f = r / (r + 1);
  return (struct dea_alpha){m, f, 0.25 * (1 - m + f) * (1 - m + f), 0.5 - m + f};
}
