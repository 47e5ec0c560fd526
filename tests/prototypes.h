/* What programs found that were written before this engine and share no line with it. Of them the
 * numbers are kept.
 *
 * SOLID: film and fibres as a 3D solid in dolfinx: hexahedra, displacements of second order,
 * discontinuous linear pressure (Q2/P1). Its ranges at 6 kV hold a second program with a solid film
 * too; the mesh of one of them is graded to 40 um at the fibre's tip.
 *
 * MEMBRANE: the film as an incompressible membrane, its thickness stretch 1/(l1 l2), joined to
 * solid fibres; in Python, converged over three meshes down to 8 um at the tip.
 *
 * The actuator: film of 100 um unstretched (Yeoh 178.4, -6.0, 4.2 kPa; eps_r 2.8), pre-stretch 1.5,
 * frame radius 15 mm, electrode radius 3.75 mm in the stretched film, 4 PET fibres of 2 mm x 100 um
 * clamped at the frame, their tips at the electrode's edge; a symmetric sector. Up is to the
 * fibres. */
#pragma once

struct prototype_range {
  double low, high;
};

/* Electrode edge between two fibres at 5 kV, outwards [m]: both programs. */
static const struct prototype_range prototype_edge_5kV_m = {0.237e-3, 0.239e-3};

/* At 6 kV the interface of film and fibre at its tip, and the centre [m]. SOLID: that on
 * the graded mesh -36.1 um at the tip, -34.2 um in the centre. */
static const struct prototype_range prototype_solid_tip_6kV_m = {-36.5e-6, -33e-6},
                                    prototype_solid_centre_6kV_m = {-35.5e-6, -34e-6};
static const double prototype_membrane_tip_6kV_m = -42.3e-6,
                    prototype_membrane_centre_6kV_m = -31.3e-6;

/* At 8 kV the tip [m]: both programs. */
static const struct prototype_range prototype_tip_8kV_m = {-0.19e-3, -0.12e-3};

/* Without pre-stretch: the centre at 6 kV [m], and where the film leaves its plane [V]; which
 * program is not recorded. */
static const double prototype_slack_centre_6kV_m = -1.2e-3;
static const struct prototype_range prototype_slack_onset_V = {800, 900};

/* In the range, or off it by no more than `relative` of its ends. */
#define assert_between(value, range, relative)                                                     \
  do {                                                                                             \
    double in_range_ = (value), low_ = (range).low, high_ = (range).high;                          \
    if (!(in_range_ >= low_ - (relative)*fabs(low_) &&                                             \
          in_range_ <= high_ + (relative)*fabs(high_))) {                                          \
      fail_msg("%s = %.6g, wanted %.6g to %.6g", #value, in_range_, low_, high_);                  \
    }                                                                                              \
  } while (0)
