/* The device: a design resolved to what the models need, in SI, in the stretched flat film.
 *
 * Reference configuration of all lengths here: the pre-stretched, flat film (what is cut, glued and
 * measured), except film_thickness_unstretched_m. A device is constant once built. */
#pragma once

#include "design/design.h"
#include "device/layout.h"

/* Acceleration of free fall, by definition (3rd CGPM, 1901). */
#define DEA_STANDARD_GRAVITY_M_PER_S2 9.80665

struct dea_device {
  struct dea_layout *layout; // owned; NULL of a device that was filled by hand, or changed
  enum dea_gravity gravity;

  /* The layout is a disc in a round frame, bare or with radial fibres, and the rest are its
   * numbers; otherwise they are 0. */
  bool disc;
  double centre_m[2];
  double angle_rad; // of the first fibre from the x axis, up to that to the next one

  struct dea_material film;
  struct dea_material electrode;       // name "" when the design names none
  double film_thickness_unstretched_m; // H0
  double pre_stretch;                  // l_pre
  double film_thickness_m;             // h = H0 / l_pre^2
  double frame_radius_m;               // L_r of paper eq 20
  double electrode_radius_m;           // r_a of paper eq 18
  double electrode_thickness_m;        // 0: without stiffness
  double sheet_resistance_ohm[2];      // of the lower and the upper electrode; 0: ideal
  double coverage;                     // R of paper eq 17

  int fibre_count; // 0: none; the rest then is 0
  double fibre_width_m, fibre_thickness_m;
  double fibre_tip_width_m;  // fibre_width_m is that of the outer end
  double fibre_tip_radius_m; // distance of the tip from the centre
  double fibre_length_m;     // L_f of paper eq 19: frame radius - tip radius
  double fibre_overlap_m;    // electrode radius - tip radius; negative: a gap
  struct dea_material fibre;
  double bond_thickness_m, bond_modulus_Pa;
  enum dea_outer_end outer_end;
  double fibre_outer_gap_m; // from a free outer end to the frame; 0 for other ends
};

/* Resolves materials (design's own first, then the catalogue) and checks the geometry as a whole:
 * electrode inside the frame, fibres that meet neither each other nor the centre, and so on.
 * Findings point at the value that is at fault; any error gives DEA_E_DESIGN. out: owned by the
 * caller. */
dea_status dea_device_build(struct dea_context *ctx, const struct dea_design *design,
                            struct dea_device **out);
/* Looks whether the layout is a disc, and takes its numbers from there. DEA_E_MEMORY. */
dea_status dea_device_find_disc(struct dea_context *ctx, struct dea_device *device);
/* DEA_E_DESIGN with what first is not as in a disc, of one that is none. */
dea_status dea_device_require_disc(struct dea_context *ctx, const struct dea_device *device);
/* Whether monitors and channels of its layout say what it does: it has monitors, or is no disc,
 * which has its own columns of load points. */
bool dea_device_is_observed(const struct dea_device *device);
/* DEA_E_DESIGN with the number that no disc can have, such as a coverage that is not between 0 and
 * 1, of a device that was filled by hand. */
dea_status dea_device_check(struct dea_context *ctx, const struct dea_device *device);
/* Total stretch of the electrodes at which a path ends: what the design says, or 1.5 times the
 * pre-stretch. */
double dea_device_path_end(const struct dea_device *device, const struct dea_design *design);
/* Of the film: of what is no disc of the first ply between electrodes, along its first axis; 1
 * without one. */
double dea_device_pre_stretch(const struct dea_device *device);
/* Whether all that has weight and inertia has a density: film, fibres, plies. DEA_E_DESIGN. */
dea_status dea_device_check_densities(struct dea_context *ctx, const struct dea_device *device);
/* The same with a finding at what asks for weight or inertia. */
dea_status dea_device_refuse_densities(struct dea_context *ctx, struct dea_location where,
                                       const struct dea_device *device);
/* Fits the breakdown field of the film, if it is known, to its thickness and to the area of the
 * electrodes, by the law of its material. */
void dea_device_fit_breakdown(struct dea_device *device);
void dea_device_destroy(struct dea_context *ctx, struct dea_device *device);
