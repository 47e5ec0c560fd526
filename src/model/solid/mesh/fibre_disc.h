/* Mesh of an actuator: a disc of film in its frame, electrodes, radial fibres on the upper face
 * (docs/theory/mesh.md). Lengths in m, of the stretched flat film; its middle plane is z = 0 and
 * the axis of the first fibre is y = 0, x > 0. */
#pragma once

#include "device/device.h"
#include "model/solid/mesh/plane_mesh.h"

/* How the frame holds the outer ends of fibres that reach it. */
enum dea_fibre_disc_end { DEA_FIBRE_DISC_CLAMPED, DEA_FIBRE_DISC_HINGED };

struct dea_fibre_disc {
  int order, order_z; // of the elements
  int through;        // elements through the film, as dea_cuts_through has them; 0: 1
  bool membrane;      // the film is a surface at z = 0 (docs/theory/membrane.md)
  int fibres;         // N, evenly spread; 0: none
  /* Domain: so many sectors of pi/N (pi/4 without fibres) from the first fibre's axis; each second
   * one is the mirror image of that before it. 2 N (8): the whole disc. Less: its two straight
   * edges lie on mirror planes. */
  int sectors;
  double electrode_radius, frame_radius;
  double tip_radius, outer_radius; // ends of the fibres: arcs about the centre; outer <= frame
  double tip_width, outer_width;   // there; the long edges are straight
  double film_thickness, electrode_thickness, glue_thickness, fibre_thickness; // last three: or 0
  enum dea_fibre_disc_end end; // what holds at the frame when outer_radius is frame_radius
  double
      size; // of elements in the plane, up to which they grow; twice of that outside the electrode
  double
      edge; // of elements at the electrode edge and the ends of fibres; about doubling from there
  double fringe; // at the electrode edge instead of `edge`, where that is larger; 0: none
  double beside; // of elements between two fibres, along the electrode edge; 0: size
  /* Inside the circle of the electrode's edge and of the tips, and across and next to fibres, all
   * sizes are so many times smaller, and grow that much slower; 0 or 1: none are. */
  double finer_at_tips;
};

/* Bits of an element's region: inside the electrode circle, under a fibre. */
enum { DEA_FIBRE_DISC_ELECTRODE = 1, DEA_FIBRE_DISC_FIBRE = 2 };

/* Angle of the domain, from 0 to 2 pi. */
double dea_fibre_disc_angle(const struct dea_fibre_disc *plate);
/* Sectors of the whole disc. */
int dea_fibre_disc_sectors(const struct dea_fibre_disc *plate);

/* In the plane: the mesh of `like`, which may be the plate itself, with its nodes moved to the
 * lengths of `plate`: the same elements, cut at the same shares of every line, so that it changes
 * smoothly with those lengths. DEA_E_ARGUMENT for parts that do not fit together or do not lie in
 * the same order, or more than DEA_FIBRE_DISC_LINE_MAX elements in a row. out: owned by the caller,
 * NULL on failure. */
dea_status dea_fibre_disc_plane(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                                const struct dea_fibre_disc *like, struct dea_plane_mesh **out);
enum { DEA_FIBRE_DISC_LINE_MAX = 256, DEA_FIBRE_DISC_THROUGH_MAX = 16 };

/* Which of the two straight edges of the domain a node is on: bit 1 at the angle 0, bit 2 at
 * dea_fibre_disc_angle. 0 in the whole disc. */
int dea_fibre_disc_edges(const struct dea_fibre_disc *plate, const double X[3]);
