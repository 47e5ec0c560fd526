/* What every study fills and every output reads. */
#pragma once

#include "base/arena.h"
#include "design/design.h"
#include "device/device.h"
#include "result/field_mesh.h"
#include "result/load_point.h"
#include "result/profile.h"
#include "result/table.h"

/* Points in the order computed; a curve of kind "sweep" stays on stable equilibria at the asked
 * voltages, one of kind "path" is the whole equilibrium path. */
struct dea_curve {
  char model[DEA_NAME_SIZE]; // "lumped"
  char kind[DEA_NAME_SIZE];  // "sweep", "path"
  struct dea_load_point *points;
  struct dea_arena memory; // of what monitors show at them
  size_t count, capacity;
  struct dea_load_point *std; // [count] standard uncertainties by those of the design and its
                              // material, NAN: not known; owned, NULL: none are known
  struct dea_event *events;   // of a path
  size_t event_count, event_room;
  bool listed;       // the summary lists its points under its kind
  bool complete;     // false: stopped early; `stopped` says why
  dea_status status; // DEA_OK or why it stopped
  char stopped[256]; // one sentence; ""
};

/* Copy of a profile (see struct dea_profile), arrays owned: columns in that order, [6][count]. */
struct dea_profile_record {
  char model[DEA_NAME_SIZE];
  double voltage_V;
  size_t count;
  double *columns;
};

/* Middle surface of the film at a point of a sweep. */
struct dea_surface_record {
  char model[DEA_NAME_SIZE];
  size_t point; // of the sweep, from 0
  double voltage_V;
  struct dea_field_mesh *mesh; // owned
};

/* One of several computations that a study sets beside each other: on another mesh, of another
 * design. */
struct dea_variant {
  char name[DEA_NAME_SIZE];   // "refinement 1.5", "eight fibres"
  double refinement;          // of the mesh; NAN where the model has none
  struct dea_model_size size; // zeros there
  double wall_s;
  struct dea_curve curve;            // its kind is the study's name
  struct dea_profile_record profile; // at the last point; count 0: the model has none
};

/* Where a result comes from. */
struct dea_provenance {
  char program[DEA_NAME_SIZE];   // "dea 0.5.0"
  char compiler[128], build[64]; // "GCC 12.2.0", "Release"
  char libraries[256];           // "libyaml 0.2.5, HDF5 1.10.8, ..."
  char started[32];              // ISO 8601, UTC
  double wall_s;
  struct dea_solver_counters solver; // of this process; zeros: model 3d was not solved
  char input_sha256[65];             // of the design file's bytes
  char *input;                       // the design file itself; owned
  char *overrides;                   // "key=value" a line; owned, may be NULL
  char *command;                     // command line; owned, may be NULL
};

struct dea_result {
  const struct dea_design *design; // lent
  const struct dea_device *device; // lent
  struct dea_curve *curves;
  size_t curve_count;
  struct dea_profile_record *profiles;
  size_t profile_count, profile_room;
  struct dea_surface_record *surfaces;
  size_t surface_count, surface_room;
  size_t surface_bytes_max; // of one model's; may be changed before the first
  struct dea_variant *variants;
  size_t variant_count;
  struct dea_result_table *tables; // [table_count] that studies made of what is above
  size_t table_count;
  double convergence_tolerance; // relative error that the study asks for; NAN: it did not run
  struct dea_provenance provenance;
};

dea_status dea_result_create(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device, struct dea_result **out);
void dea_result_destroy(struct dea_context *ctx, struct dea_result *result);
/* A new empty curve; *out lent until the next call of this function. */
dea_status dea_result_add_curve(struct dea_context *ctx, struct dea_result *result,
                                const char *model, const char *kind, struct dea_curve **out);
/* Copies the point with what its monitors show. */
dea_status dea_curve_add_point(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_load_point *point);
dea_status dea_curve_add_event(struct dea_context *ctx, struct dea_curve *curve,
                               const struct dea_event *event);
/* First event of that kind along a curve, NULL when there is none or no curve; lent. */
const struct dea_event *dea_curve_first_event(const struct dea_curve *curve,
                                              enum dea_event_kind kind);
/* Copies the profile. */
dea_status dea_result_add_profile(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, double voltage_V,
                                  const struct dea_profile *profile);
/* A new variant without points, of which a NAN refinement, size and time are the caller's to set;
 * *out lent until the next call of this function. */
dea_status dea_result_add_variant(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, const char *study, const char *name,
                                  struct dea_variant **out);
/* Copies the profile in place of the one that is there. */
dea_status dea_variant_set_profile(struct dea_context *ctx, struct dea_variant *variant,
                                   double voltage_V, const struct dea_profile *profile);
/* The record's columns as a profile; lent from the record. */
struct dea_profile dea_profile_of_record(const struct dea_profile_record *record);
/* Whether a variant is one of that model and study. */
bool dea_variant_is(const struct dea_variant *variant, const char *model, const char *study);
/* Models of a result in the order of their first curve, variant or table; names lent. Returns the
 * number. */
size_t dea_result_models(const struct dea_result *result, const char *models[], size_t max);
/* The curve of that model and kind, a new empty one when there is none; *out as above. */
dea_status dea_result_get_curve(struct dea_context *ctx, struct dea_result *result,
                                const char *model, const char *kind, struct dea_curve **out);
/* A new table in the place of the model's of that study and name; see dea_result_table_init. *out
 * lent until the next call of this function. */
dea_status dea_result_add_table(struct dea_context *ctx, struct dea_result *result,
                                const struct dea_result_table_type *type, const char *model,
                                size_t width, struct dea_result_table **out);
/* The model's table of that type, a new one without lists when there is none; *out as above. */
dea_status dea_result_get_table(struct dea_context *ctx, struct dea_result *result,
                                const struct dea_result_table_type *type, const char *model,
                                struct dea_result_table **out);
/* Moves a table here, to the place of the model's of that study and name; it leaves an empty one.
 * On failure it stays where it is. */
dea_status dea_result_adopt_table(struct dea_context *ctx, struct dea_result *result,
                                  struct dea_result_table *table);
/* Table of that model, study and name, or NULL; lent. */
const struct dea_result_table *dea_result_find_table(const struct dea_result *result,
                                                     const char *model, const char *study,
                                                     const char *name);
/* Surface of a point after those that are there. Where those of the model would take more memory
 * than surface_bytes_max, every second one goes, and from then on one of two points stays, one of
 * four, ...; the first and the last are always there. Takes the mesh, also when it fails. */
dea_status dea_result_add_surface(struct dea_context *ctx, struct dea_result *result,
                                  const char *model, size_t point, double voltage_V,
                                  struct dea_field_mesh *mesh);
/* How a curve ended, and for a failure the recorded message as the reason. Returns the status, for
 * DEA_TRY. */
dea_status dea_curve_end(struct dea_context *ctx, struct dea_curve *curve, dea_status status);
/* Whether the film has no tension somewhere where its pull-in is, as far as
 * the model tells it: that pull-in is one of a flat film, which one without tension does not stay
 * (docs/theory/stops.md). */
bool dea_curve_is_slack(const struct dea_curve *curve);
/* Kind of a stop, for tables and JSON (docs/theory/stops.md): "pull_in", "slack", "law_end",
 * "inverted_element", "not_converged" (ours); "" for what is none: success, a refusal, an
 * interruption, want of memory. Static storage. */
const char *dea_verdict_of(dea_status status);
/* Highest voltage of the curves but paths [V]; 0 for none. */
double dea_result_highest_V(const struct dea_result *result);
/* Curve of that model and kind, or NULL; lent. */
const struct dea_curve *dea_result_find(const struct dea_result *result, const char *model,
                                        const char *kind);
