/* A material as the models use it: a law with its numbers, permittivity, density, breakdown.
 *
 * It is filled by the catalogue (data/materials) or from a design file, and is plain data. */
#pragma once

#include "material/law.h"

enum { DEA_NAME_SIZE = 64, DEA_BRANCHES_MAX = 8 };

/* Vacuum permittivity [F/m], CODATA 2018. */
#define DEA_EPSILON_0 8.8541878128e-12

/* Relative permittivity eps_r = at_rest + slope * (s - 1), s = sqrt(lambda_1 lambda_2) the mean
 * in-plane stretch from the unstretched film. */
struct dea_permittivity {
  double at_rest; // at s = 1
  double slope;   // per unit of s; 0 for a constant permittivity
};

/* Breakdown as it was measured (docs/theory/breakdown.md): at the mean in-plane stretch s, in a
 * film that then is h thick, under electrodes of an unstretched area A,
 *
 *   E_b = factor at_rest s^exponent (h / thickness_m)^thickness_exponent (area_m2 / A)^(1 / shape)
 */
struct dea_breakdown_law {
  double at_rest_V_per_m;
  double exponent;           // 0 where a dependence on stretch is unknown
  double thickness_exponent; // 0: unknown
  double thickness_m;        // that at_rest belongs to; 0 with an unknown exponent
  double shape;              // of Weibull's distribution of E_b; 0: unknown
  double area_m2;            // that at_rest belongs to, unstretched; 0 with an unknown shape
  double electrode_factor;   // of the electrodes upon E_b, 1 when none is given
  double low, high; // smallest and largest at_rest of the sources, over at_rest; 1: no band
};

/* True breakdown field of the film of a device, E_b = at_rest s^exponent; known is false when no
 * value was sourced. dea_breakdown_specialise makes the two numbers from the law. */
struct dea_breakdown {
  bool known;
  double at_rest_V_per_m;
  double exponent; // 0 where a dependence on stretch is unknown
  bool exponent_known;
  struct dea_breakdown_law law;
};

/* A spring in series with a dashpot beside the law (docs/theory/time.md, section 1). */
struct dea_branch {
  double modulus_Pa; // shear modulus G_i of the spring
  double time_s;     // relaxation time tau_i
};

struct dea_material {
  char name[DEA_NAME_SIZE];        // catalogue name or the design's own
  char law_id[DEA_NAME_SIZE];      // which parameter set ("yeoh-178"); "" for a single one
  const struct dea_law *law;       // NULL for a material without a hyperelastic law (PET)
  double param[DEA_LAW_PARAM_MAX]; // of the law, SI
  /* Standard uncertainties of the law's parameters, 0: not given; and their correlations, filled
   * where both of a pair have one. */
  double param_std[DEA_LAW_PARAM_MAX], correlation[DEA_LAW_PARAM_MAX][DEA_LAW_PARAM_MAX];
  double fibre_angle_rad; // of an anisotropic law: angle of a0 to the radial direction
  struct dea_permittivity permittivity; // at_rest = 0 when unknown
  struct dea_breakdown breakdown;
  double density_kg_per_m3;         // 0 when unknown
  char viscosity_id[DEA_NAME_SIZE]; // "" without branches
  struct dea_branch branches[DEA_BRANCHES_MAX];
  size_t branch_count;      // 0: not viscous, or not known to be
  bool viscosity_assumed;   // plausible numbers, not measured ones
  double resistivity_ohm_m; // 0 when unknown: no leakage
  double young_modulus_Pa;  // linear elastic materials; 0 when not given
  double poisson_ratio;
  double stretch_min,
      stretch_max; // range of the law's data (uniaxial or biaxial stretch); 0 unknown
};
