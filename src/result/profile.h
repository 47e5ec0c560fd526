/* Values along a line of the film, and the list of them for C, CSV, HDF5 and figures. */
#pragma once

#include <stddef.h>

// X(member of struct dea_profile, SI unit, display unit, factor SI -> display, header, meaning)
#define DEA_PROFILE_LIST(X)                                                                        \
  X(radius_m, "m", "mm", 1e3, "radius", "radius in the stretched flat film")                       \
  X(displacement_m, "m", "um", 1e6, "radial displacement", "radial displacement")                  \
  X(stretch_r, "1", "1", 1.0, "radial stretch", "radial stretch from the unstretched film")        \
  X(stretch_t, "1", "1", 1.0, "hoop stretch", "hoop stretch from the unstretched film")            \
  X(tension_r_N_per_m, "N/m", "N/m", 1.0, "radial tension",                                        \
    "radial true stress x current thickness")                                                      \
  X(tension_t_N_per_m, "N/m", "N/m", 1.0, "hoop tension", "hoop true stress x current thickness")  \
  X(z_m, "m", "um", 1e6, "z", "displacement out of the plane, positive to the fibres")

/* Values along the radius, arrays [count] in ascending order of it, lent until the next call. Model
 * 3d gives them across the diagonal: radius > 0 along a fibre's axis, < 0 halfway between two
 * fibres, and twice where electrode and bare film or film under and beside a fibre meet. */
struct dea_profile {
  size_t count;
  const double *radius_m;              // in the stretched flat film
  const double *displacement_m;        // radial, outwards
  const double *stretch_r, *stretch_t; // total, from the unstretched film
  const double *tension_r_N_per_m, *tension_t_N_per_m;
  const double *z_m; // displacement out of the plane, of the film's middle surface
};
