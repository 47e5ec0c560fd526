/* The one interface of the models: three ways to answer the same question.
 *
 * A model is one folder and one line in model_list.h. Studies know nothing else of it. */
#pragma once

#include "base/context.h"
#include "device/device.h"
#include "model/circuit.h"
#include "result/field_mesh.h"
#include "result/load_point.h"
#include "result/observation.h"
#include "result/profile.h"
#include "result/state.h"

struct dea_model; // state of one solve: device, last equilibrium

/* Takes a point of a path; anything but DEA_OK stops the path with that status. */
typedef dea_status (*dea_point_sink)(void *user, const struct dea_load_point *point);
typedef dea_status (*dea_event_sink)(void *user, const struct dea_event *event);

/* Points of a path that are enough for any, and of one that costs more than a sweep. */
enum { DEA_PATH_POINTS_MAX = 20000, DEA_LONG_PATH_POINTS_MAX = 500 };

struct dea_path_options {
  double max_stretch;   // end: total electrode stretch (pre-stretch included)
  double max_voltage_V; // end; INFINITY for none
  size_t max_points;
  bool stays; // the model then stands at the last point, stable or not, not where it did
};

/* Order of elements: the given one, 0: the usual one. */
static inline int dea_mesh_order(int given)
{
  return given > 0 ? given : 2;
}

/* How a model is computed, which its device does not know: what a model with a mesh makes of it.
 * All 0: the defaults. The models without a mesh take nothing from here. */
struct dea_model_settings {
  enum dea_solid_film film;                 // its elements
  enum dea_solid_domain domain;             // how much of the actuator is computed
  enum dea_solid_electrostatics field;      // where it comes from
  enum dea_buckling_branch buckling_branch; // side that a slack film goes to
  double refinement;                        // of the mesh; up to 1: the coarsest
  double tip_refinement;                    // where fibre tips end on a disc; 0: no other
  int order;                                // of the elements in the plane, 1 to 3; 0: usual
  int order_z;                              // through the thickness of a layer, the same
  int elements_z;           // through the film of a disc, or a ply that does not say; 0: 1
  const double (*sizes)[3]; // of elements of a free mesh: [size_count] x, y, size there [m]; lent
  size_t size_count;        // until the model is made; 0: by the refinement
  struct {                  // meshes of a layout by the error of a monitor
    const char *monitor;    // lent; NULL: not asked for
    double tolerance, voltage_V; // relative; where it is looked at
    int passes;
  } adapt;
  struct {                // model reduced
    const char *file;     // lent: that of dea reduce-order; NULL: it makes its own
    const char *monitor;  // lent; NULL: the first, or of a disc fibre tip or electrode's edge
    int motion;           // enum dea_observed; -1: the largest displacement
    double voltage_V;     // up to which
    double force;         // to either side [N] or [N m]; 0: what moves it as far as the voltage
    int voltages, forces; // of samples, odd; 0: 9 and 5
    double air_kg_per_m3; // density of the gas around the film; 0: vacuum
    const struct dea_design *design; // lent: what the file's device is compared with; NULL: nothing
  } reduced;
  /* A model of another device, whose mesh is moved to this one: so that answers change smoothly
   * with lengths. Lent, outlives the model; NULL: a mesh of its own. */
  const struct dea_model *mesh_from;
};

/* One mesh of an adaptive refinement. */
struct dea_adapt_pass {
  size_t elements, unknowns;
  double value, error; // of the monitor, and estimated; NAN: not known
  bool within;         // that is the tolerance or less
};

/* What `fields` hands out: all of the device, or the middle surface of its film. */
enum dea_fields_part { DEA_FIELDS_VOLUME, DEA_FIELDS_SURFACE };

/* A rigid tip without friction that is pressed against the middle of the film. */
enum dea_probe_shape { DEA_PROBE_SPHERE, DEA_PROBE_FLAT, DEA_PROBE_CYLINDER };
struct dea_probe {
  enum dea_probe_shape shape; // cylinder: lying on its side, along x
  double radius_m;
  double edge_radius_m; // of the flat end's rounded edge
  bool from_fibre_side; // comes from +z
};

/* What a device of the general form is brought to beside its voltage. */
enum dea_control_kind {
  DEA_CONTROL_PLACE,     // a component of a body is held at a shift [m] or a turn [rad]
  DEA_CONTROL_FORCE,     // dead force [N] or moment [N m] on it, in place of the layout's
  DEA_CONTROL_PRESSURE,  // all pressures of the layout times a factor
  DEA_CONTROL_CONJUGATE, // dead force [N] or moment [N m] conjugate to a coordinate, beside all
                         // else
  DEA_CONTROL_CHARGE,    // charge [C] in place of a voltage (docs/theory/devices.md)
};
struct dea_control {
  enum dea_control_kind kind;
  size_t body;   // of the layout; of a charge the channel, 0: the supply's
  int component; // 0 to 2: along x, y, z; 3 to 5: about them
  /* Conjugate: the coordinate is a motion of a monitor, body its number and component an enum
   * dea_observed, that is linear in the displacements (of a point, a body or a region's mean); or
   * where column is not 0 that displacement of a disc's load points. All copies of a sector move
   * alike, and the force is the sum over them. */
  int column;
};

/* A mode of small motions, with its part of dq/dF and of dq/dV (NAN where that is 0). */
struct dea_compliance_mode {
  double frequency_Hz, share, voltage_share;
};
enum { DEA_COMPLIANCE_MODES = 12 };
enum { DEA_COMPLIANCE_WITH_MODES = 1, DEA_COMPLIANCE_WITH_FAST = 2 };

/* How a coordinate q and the charge Q of the shared voltage V change with the force F conjugate to
 * q and with V; q, F, Q are values. */
struct dea_compliance {
  double value, force;
  double by_force, by_voltage;               // dq/dF at V, dq/dV at F
  double charge_C;                           // Q
  double charge_by_force, charge_by_voltage; // dQ/dF at V, which is dq/dV, and dQ/dV at F
  double fast_by_force, fast_by_voltage;     // the same where branches do not follow, or NAN
  struct dea_compliance_mode modes[DEA_COMPLIANCE_MODES]; // the lowest, or NAN
};

/* Where a search for another state goes off: along a soft mode, or by folding what stands out of
 * the plane to one side, in all of the device or in some of `parts` equal sectors about its z axis,
 * the first of them with its middle on +x; what is kept fades out towards the neighbours. */
enum { DEA_SOFT_MODES_MAX = 40, DEA_PUSH_PARTS_MAX = 32 };
enum dea_push_kind { DEA_PUSH_MODE, DEA_PUSH_FOLD };
struct dea_push {
  enum dea_push_kind kind;
  int side;           // 1 along the mode, whose largest component is positive, or to +z; or -1
  size_t mode;        // one of those that `soften` found last, from 0
  double amplitude_m; // largest displacement along the mode
  int parts;          // 2 to DEA_PUSH_PARTS_MAX; 0 or 1: everywhere
  unsigned in;        // sectors that are pushed, bits from 1 on
};

/* A small excitation of the voltage upon a bias, and the viscous damping of what it moves: a share
 * of the critical damping of each mode, and shares of mass and stiffness. */
struct dea_ac_excitation {
  double amplitude_V;
  double damping_ratio, damping_mass_per_s, damping_stiffness_s;
};

/* How a history in time is computed. */
struct dea_time_options {
  struct dea_circuit circuit;
  /* Channels of the device's layout, [channel_count], with ground, that have a source each: steps
   * say its voltage, [channel_count]. NULL: none has. The circuit then has to be ideal. */
  const bool *own_sources;
  bool inertia;   // false: each moment is an equilibrium of the film with its branches
  double rho_inf; // spectral radius of generalised alpha at high frequencies, 0 to 1
};

/* A tip and how far it is pressed beyond touching the flat film. */
struct dea_pressed {
  struct dea_probe tip;
  double depth_m;
};

/* A small change of one number p of a design: devices and voltages at p - width/2 and p + width/2,
 * in the unit of p. A device is NULL where there is none with that number, and so no slope. */
struct dea_design_change {
  const struct dea_device *device[2];
  double voltage_V[2];
  double width;
  const struct dea_pressed *pressed[2]; // of a model with a tip; NULL: as it stands
};
/* Slopes that are wanted: of columns of load points (result/columns.h), then of a motion of
 * monitors of the layout, by changes. All lent. */
struct dea_gradient_request {
  const struct dea_design_change *changes; // [change_count]
  size_t change_count;
  const int *columns; // [column_count]
  size_t column_count;
  const size_t *modes;    // [column_count] of a frequency that of which mode, from 0; NULL: all 0
  const size_t *monitors; // [monitor_count]
  size_t monitor_count;
  const enum dea_observed *motions; // [monitor_count]; NULL: the main ones (dea_observed_main)
  /* The model stands at a point of its path: slopes at the electrode's stretch there, which is held
   * in place of the voltage. Voltages of changes are not looked at, "voltage_V" is a column. */
  bool holds_stretch;
  double stretch; // what is held
  /* One quantity in place of all these, without columns and monitors: the voltage of the limit
   * point that the last solve, which failed, has come to. */
  bool of_limit;
};

/* How many quantities that are. */
static inline size_t dea_gradient_width(const struct dea_gradient_request *ask)
{
  return ask->of_limit ? 1 : ask->column_count + ask->monitor_count;
}

struct dea_model_type {
  const char *name;      // "lumped"
  const char *long_name; // for figures
  bool any_layout;       // false: it knows only a disc in a round frame
  /* Names and versions of the libraries that compute it and that the program itself has not, "PETSc
   * 3.18.5", into out [size], once a model was made. NULL: there are none. */
  dea_status (*libraries)(struct dea_context *ctx, char *out, size_t size);
  /* device: lent, outlives the model. settings: copied; NULL: the defaults. */
  dea_status (*create)(struct dea_context *ctx, const struct dea_device *device,
                       const struct dea_model_settings *settings, struct dea_model **out);
  void (*destroy)(struct dea_context *ctx, struct dea_model *model);
  /* What this model does not take of a design: findings with their places, and DEA_E_DESIGN. Cheap.
   * NULL when it takes all. */
  dea_status (*check)(struct dea_context *ctx, const struct dea_design *design,
                      const struct dea_device *device);
  /* Stable equilibrium at a voltage [V], reached from the last one solved (at first the flat film
   * at 0 V). Where there is none: DEA_E_NO_EQUILIBRIUM beyond a limit point (pull-in; see limit),
   * DEA_E_SLACK, DEA_E_DOMAIN at the end of a law, DEA_E_INVERTED, DEA_E_NOT_CONVERGED where the
   * model does not know (docs/theory/stops.md); it then stays at its last point. */
  dea_status (*solve)(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                      struct dea_load_point *out);
  /* Where the last solve that failed came to an end, a limit point or a loss of tension; lent until
   * the next one. NULL: none was located, or the model does not look for one. */
  const struct dea_event *(*limit)(const struct dea_model *model);
  /* A limit point that the last solve or move, which succeeded, has gone past to another state;
   * lent until the next one. NULL: none is known, or the model does not look for one. */
  const struct dea_event *(*passed)(const struct dea_model *model);
  /* The whole equilibrium path by arc-length from 0 V, through limit points; events (may be NULL)
   * are located to solver accuracy. Ends at the options' limits, at a law's domain or where the
   * path itself ends, with DEA_OK. NULL when the model has none. */
  dea_status (*path)(struct dea_context *ctx, struct dea_model *model,
                     const struct dea_path_options *options, dea_point_sink points,
                     dea_event_sink events, void *user);
  /* The same where it costs more than a sweep, so that only a design that asks for it has it
   * (compute.solid.path); the model then stands where it did. `path` is NULL then. */
  dea_status (*long_path)(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_path_options *options, dea_point_sink points,
                          dea_event_sink events, void *user);
  /* Slopes of quantities of the last point solved, out [change_count][dea_gradient_width]
   * (docs/theory/gradients.md): NAN where the model has none, and of a change that its mesh cannot
   * follow, with a note. NULL: dea_model_gradient computes the changed devices. */
  dea_status (*gradient)(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_gradient_request *ask, double *out);
  /* Monitors, bodies and channels of the device's layout at the last point solved; out lends from
   * the model until the next call. NULL when the model knows none. */
  dea_status (*observe)(struct dea_context *ctx, struct dea_model *model,
                        struct dea_observation *out);
  /* Estimated errors at the last point solved of the monitors' motions that `dea_observed_main`
   * names, [monitor_count]; NAN where none is known, also of a point with a doubt. NULL when the
   * model estimates none. */
  dea_status (*errors)(struct dea_context *ctx, struct dea_model *model, double *error);
  /* The meshes that were made for it, lent; NULL when the model does not adapt. */
  const struct dea_adapt_pass *(*passes)(const struct dea_model *model, size_t *count);
  /* Profile at the last point solved, empty of what is no disc; NULL when the model has none. */
  dea_status (*profile)(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out);
  /* Brings a tip to `depth_m` beyond touching the flat film (negative: a gap) at the last voltage
   * solved, in steps of its own; later solves keep it there and their points have its force. The
   * tip of the first call stays. NULL when the model does not support tips. */
  dea_status (*indent)(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_probe *tip, double depth_m, struct dea_load_point *out);
  /* Brings a control to a value at the last voltage solved, in smaller steps where the whole way
   * fails; later solves keep it there. Where there is no equilibrium on the way the model stays at
   * the last one, with the control that belongs to it. NULL when the model does not support bodies.
   */
  dea_status (*move)(struct dea_context *ctx, struct dea_model *model,
                     const struct dea_control *control, double value, struct dea_load_point *out);
  /* What a coordinate, as of a conjugate control, and the charge change by at the last point
   * solved; with: also the modes, else NAN. NULL when the model does not know. */
  dea_status (*compliance)(struct dea_context *ctx, struct dea_model *model,
                           const struct dea_control *coordinate, int with,
                           struct dea_compliance *out);
  /* The softest motions at the last point solved, ascending: their stiffness by volume [N/m^4],
   * below 0 for unstable ones. The model keeps their shapes for `push`, until the next call. */
  dea_status (*soften)(struct dea_context *ctx, struct dea_model *model, size_t count,
                       double *stiffness_N_per_m4);
  /* Another stable equilibrium at the voltage of the last point: the film is pushed and goes down
   * from there; it may come back to where it was. *found: false where it comes to no stable
   * equilibrium, or the model does not support such push, and is then as it was. soften and push
   * are both NULL when the model knows one state only. */
  dea_status (*push)(struct dea_context *ctx, struct dea_model *model, const struct dea_push *push,
                     struct dea_load_point *out, bool *found);
  /* Force [N] out of the plane that fibre tips held at a height [m] push with at a voltage,
   * whatever was solved last; NULL when the model has no load line. */
  dea_status (*hold)(struct dea_context *ctx, const struct dea_model *model, double voltage_V,
                     double height_m, double *force_N);
  /* The lowest modes of small motions about the last point solved, `at`: copies of it with the keys
   * of a mode, [count]. shapes: the film's middle surface there with a field a mode; owned by the
   * caller, NULL on failure. NULL when the model has no mass. */
  dea_status (*modes)(struct dea_context *ctx, struct dea_model *model,
                      const struct dea_load_point *at, size_t count, struct dea_load_point *points,
                      struct dea_field_mesh **shapes);
  /* Response to an AC excitation upon the voltage of the last point solved, `at`, which has to be
   * stable: copies of it with the keys of an answer, [count]. NULL as above. */
  dea_status (*respond)(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_load_point *at, const struct dea_ac_excitation *excitation,
                        const double *frequency_Hz, size_t count, struct dea_load_point *points);
  /* What monitors of the device's layout did in the last `respond`, which succeeded: complex
   * amplitudes [count][monitor_count][DEA_OBSERVED_MOTIONS][2], real and imaginary part, NAN where
   * a monitor has no such quantity; lent until the next call. NULL when the model knows none. */
  const double *(*answers)(const struct dea_model *model);
  /* Fields at the last point solved; NULL when the model has none. out: owned by the caller
   * (dea_field_mesh_destroy), NULL on failure. */
  dea_status (*fields)(struct dea_context *ctx, struct dea_model *model, enum dea_fields_part part,
                       struct dea_field_mesh **out);
  /* State at the last point solved, and back into a model made for the same device. load: marks are
   * not looked at; DEA_E_ARGUMENT when an array is missing or of another length, the model is then
   * as it was. Both NULL when the model does not need that. */
  dea_status (*save)(struct dea_context *ctx, struct dea_model *model, struct dea_state *out);
  dea_status (*load)(struct dea_context *ctx, struct dea_model *model,
                     const struct dea_state *state);
  /* A history in time (docs/theory/time.md), all three NULL when the model has no time.
   *
   * begin: time 0, the film at rest and relaxed (A_i = C^-1) as the last solve left it (a model
   * that was never solved: flat), with the charge of that voltage. The model keeps a copy of
   * options. A second call begins anew. */
  dea_status (*begin)(struct dea_context *ctx, struct dea_model *model,
                      const struct dea_time_options *options, struct dea_load_point *out);
  /* One step from the last accepted state to a trial state, which replaces a trial that was not
   * accepted: so a step is rejected by asking for another one, and after a failure too the accepted
   * state is as it was. A step of length 0 is a jump of the supply's voltage: the film follows at
   * once as far as circuit and inertia let it, its branches do not; work of the supply is then what
   * the film takes up. Steps end at all corners of the waveform; within one the supply's voltage is
   * linear in time. out: the point at the end, time_s since begin, with charge, current, energies
   * and works. error: estimated error of this step, as the largest of those of displacement,
   * voltage and dissipated energy, over the largest displacement, voltage and work since begin. 1
   * and more: by that factor the step is longer than what happens in it. DEA_E_NO_EQUILIBRIUM: none
   * near the last state at the end of the step (pull-in without inertia); a shorter step comes
   * closer to the time at which it is lost. DEA_E_NOT_CONVERGED: try a shorter one. */
  dea_status (*advance)(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_step *step, struct dea_load_point *out,
                        double *error);
  /* The trial of the last advance, which succeeded, becomes the accepted state; solve, profile,
   * fields and save speak of it. Cannot fail. */
  void (*accept)(struct dea_model *model);
  /* Size of a model whose mesh the settings' refinement sets; NULL when it has none. */
  void (*size)(const struct dea_model *model, struct dea_model_size *out);
};

/* What a design says of how to compute (compute.solid). */
struct dea_model_settings dea_model_settings_of(const struct dea_design *design);
/* What a model does not take of a design, as `check` above. */
dea_status dea_model_check(struct dea_context *ctx, const struct dea_model_type *type,
                           const struct dea_design *design, const struct dea_device *device);
/* A model of a device with the settings of its design, which it has to take; type: the one that
 * speaks for it. */
dea_status dea_model_create(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_design *design, const struct dea_device *device,
                            struct dea_model **out);
/* The same of all of a device of the general form, where the design may leave a sector of it: for
 * what breaks its symmetry. Discs are computed as the design says. */
dea_status dea_model_create_whole(struct dea_context *ctx, const struct dea_model_type *type,
                                  const struct dea_design *design, const struct dea_device *device,
                                  struct dea_model **out);

/* Calls of functions that not every model has, for callers that do not check: DEA_E_UNSUPPORTED,
 * with a message, where the pointer is NULL. */
dea_status dea_model_path(struct dea_context *ctx, const struct dea_model_type *type,
                          struct dea_model *model, const struct dea_path_options *options,
                          dea_point_sink points, dea_event_sink events, void *user);
/* Follows the path from rest to the first equilibrium, stable or not, with that stretch of the
 * electrode, 1 at rest, where the model then stands. DEA_E_NO_EQUILIBRIUM where the path ends
 * before; also as dea_model_path. */
dea_status dea_model_stretch(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, const struct dea_device *device,
                             double stretch, struct dea_load_point *out);
/* Of any model: one without a gradient of its own is made anew for each changed device and solved
 * at its voltage, with these settings. */
dea_status dea_model_gradient(struct dea_context *ctx, const struct dea_model_type *type,
                              struct dea_model *model, const struct dea_model_settings *settings,
                              const struct dea_gradient_request *ask, double *out);
dea_status dea_model_indent(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_probe *tip, double depth_m,
                            struct dea_load_point *out);
dea_status dea_model_fields(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, enum dea_fields_part part,
                            struct dea_field_mesh **out);

/* Path of the module that holds the 3D engine, into out[size]; false when it is not here. */
bool dea_solid_module_find(char *out, size_t size);

/* Model of that name, or NULL. Static storage. */
const struct dea_model_type *dea_model_find(const char *name);
/* The same into *out; NULL after an error at that place, which names the models that there are. */
dea_status dea_model_seek(struct dea_context *ctx, const char *name, struct dea_location place,
                          const struct dea_model_type **out);
const struct dea_model_type *const *dea_model_all(size_t *count);
