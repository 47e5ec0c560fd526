/* A device as a function of numbers of its design: load points at given voltages, for a fit. */
#pragma once

#include "identify/device_fit.h"
#include "model/model.h"
#include "study/device_param.h"

enum { DEA_DEVICE_MEMO = 48, DEA_DEVICE_GROUPS_MAX = 64 };

/* Points of one path: voltages that rise, freely or with a tip held `depth_m` beyond the design's
 * first depth; or times while the design's waveform is played. */
struct dea_device_group {
  bool held, in_time;
  double depth_m;
  size_t first, count;
};

/* Points at parameters that were asked for before. */
struct dea_device_memo {
  double p[DEA_DEVICE_PARAMS_MAX];
  struct dea_load_point *points; // [stop_count]; NULL: empty
};

/* A design whose states others begin from. */
struct dea_device_start {
  bool there;
  double p[DEA_DEVICE_PARAMS_MAX];
  struct dea_state *states;      // [stop_count], owned; without values where none may begin from it
  struct dea_load_point *points; // [stop_count], owned
};

/* Zero-initialise, and set from ctx to wanted, and observed, built, stood and user where they are
 * used. */
struct dea_device_model {
  struct dea_context *ctx;
  struct dea_design_bytes file;
  const struct dea_model_type *type;
  const struct dea_device_param *params; // lent
  size_t param_count;
  struct dea_device_group groups[DEA_DEVICE_GROUPS_MAX];
  size_t group_count;
  size_t stop_count;
  double *voltage_V; // [stop_count] of a group in time its times [s]; in the arena of who fills it
  bool *wanted;      // [stop_count]: the others are not computed where they come last in a group;
                     // dea_device_model_want changes them
  struct dea_device_memo memo[DEA_DEVICE_MEMO];
  size_t memo_next;
  struct dea_state
      *states; // [stop_count] of the last evaluation, owned; NULL: none yet, or no warm starts
  struct dea_device_start start;
  bool from_start; // this evaluation begins from the states of start, which stay
  bool doubtful;   // it has gone another way than start
  size_t evaluations;
  bool observed;             // points have what monitors show
  struct dea_arena monitors; // of that, until dea_device_model_end
  /* Told of each design that is built, with its device; NULL: nobody. */
  dea_status (*built)(void *user, const struct dea_design *design, const struct dea_device *device);
  /* Told of each stop with the model that stands there, but of groups in time; NULL: nobody. */
  dea_status (*stood)(void *user, struct dea_model *model, const struct dea_design *design,
                      const struct dea_device *device, size_t stop);
  void *user;
  char why[200]; // of the last point that could not be had
};

/* Frees what evaluations have kept. */
void dea_device_model_end(struct dea_device_model *model);
/* Which stops are wanted from now on [stop_count]. Where that changes, points that were kept are
 * dropped: none may be lent. */
void dea_device_model_want(struct dea_device_model *model, const bool *wanted);
/* Points [stop_count] at p, NAN where there is no equilibrium (model->why says of the last one);
 * lent until DEA_DEVICE_MEMO others were asked for. DEA_E_DOMAIN where the design cannot be built
 * with p. */
dea_status dea_device_model_points(struct dea_device_model *model, const double *p,
                                   const struct dea_load_point **out);
/* The same of all stops, without a warm start, as a sweep of its own would find them; points:
 * [stop_count], written to. from: begun from the states of the design of these numbers, which are
 * kept for the next call (dea_device_model_end); not where one of the two is slack, unstable or
 * snaps, or none is found so; NULL: from none. The answer depends on `from` and p alone. */
dea_status dea_device_model_sweep(struct dea_device_model *model, const double *from,
                                  const double *p, struct dea_load_point *points);
/* A parameter, a text of a fit file, with what the design says of it: unit, limits, value; where it
 * starts, which with whole numbers may be 0. Errors are findings, the status DEA_OK also then. */
dea_status dea_device_param_build(struct dea_context *ctx,
                                  const struct dea_fit_parameter_text *asked,
                                  const struct dea_device_param_source *source,
                                  struct dea_device_param *out);
/* A number for a parameter, with its unit and, of a length in the film, its state; in SI. Errors
 * are findings, the status DEA_OK also then and *out NAN. */
dea_status dea_device_param_number(struct dea_context *ctx, const struct dea_device_param *param,
                                   const struct dea_label *label, double *out);
/* Values that take the place of a design's own. */
struct dea_device_values {
  const struct dea_device_param *params; // [count]
  const double *values;                  // [count], SI
  size_t count;
  int digits;              // of the values as they are written
  const char *name;        // of the film's material, where that changes: NAME-film
  const char *title;       // of the design; "": as it was
  const char *uncertainty; // compute.uncertainty, the same
};
/* Adds a design with other values, as a design file. device: built from it. */
dea_status dea_device_design_text(struct dea_context *ctx, const struct dea_design_bytes *file,
                                  const struct dea_device *device,
                                  const struct dea_device_values *with, struct dea_text *out);

// Parts of a fit (device_fit_run.h)

/* Reads the measured curves, one a quantity of each file. Errors are findings. */
dea_status dea_device_curves_read(struct dea_context *ctx, struct dea_device_fit *fit);
/* Sets groups and stops of a model: each voltage once, rising; and the stop of each row. */
dea_status dea_device_stops_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                  struct dea_device_model *model);
/* The fitted design as a file, into fit->design; file: as it was, device: built from it. */
dea_status dea_device_design_build(struct dea_context *ctx, struct dea_device_fit *fit,
                                   const struct dea_design_bytes *file,
                                   const struct dea_device *device);
