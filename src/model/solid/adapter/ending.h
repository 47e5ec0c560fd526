/* A solid on its way to a voltage, and the verdict where it does not get there
 * (docs/theory/stops.md). */
#ifndef DEA_MODEL_SOLID_ADAPTER_ENDING_H
#define DEA_MODEL_SOLID_ADAPTER_ENDING_H

#include "model/solid/equilibrium/approach.h"
#include "result/load_point.h"

/* Whose solid it is; the functions look at where it is. */
struct dea_ending_owner {
  struct dea_solid *solid;
  void *model;
  dea_status (*point)(struct dea_context *ctx, void *model, double voltage_V,
                      struct dea_load_point *out);
  /* Smallest tension of the film, INFINITY without a film, and its largest true field. */
  dea_status (*film)(struct dea_context *ctx, void *model, double *tension_N_per_m,
                     double *field_V_per_m);
  double tension_scale_N_per_m; // what is small against that is none
  double flat_thickness_m;      // of the flat film where the field is largest
  double refinement;            // of the mesh
  bool membrane;
};

/* Zeroed at first but for the owner. */
struct dea_ending {
  struct dea_ending_owner owner;
  double from_V;          // where the last way began
  struct dea_event limit; // where the last way came to its end
  bool limited;           // it is known
  bool leapt;             // on the last way the film has thinned so much at once that it may have
                          // gone past a limit point to another state
  double tension[2], tension_V[2]; // smallest of the film [N/m], at the last two points looked at
  double area;                     // largest area stretch at the last of them
};

/* To a voltage from that of the last equilibrium, from_V. Where that fails the message is the
 * verdict: pull-in or snap-back (DEA_E_NO_EQUILIBRIUM), loss of tension (DEA_E_SLACK), an inverted
 * element, the end of a law, or that it is ours. */
dea_status dea_ending_go(struct dea_context *ctx, struct dea_ending *ending, double from_V,
                         double voltage_V, struct dea_solid_report *report);

#endif
