/* Studies: what is asked of a model. They speak to the model interface only and fill a result.
 *
 * A study is one file and one line in study_list.h. */
#pragma once

#include "model/model.h"
#include "result/figure.h"
#include "result/result.h"

struct dea_checkpoint_sink; // result/checkpoint_sink.h

/* What a run lends to its studies. */
struct dea_study_services {
  const struct dea_checkpoint_sink *checkpoint; // who keeps a sweep as it goes; NULL: nobody
  /* dea_study_run, for studies that run others of changed designs; NULL: they do not. */
  dea_status (*run)(struct dea_context *ctx, const struct dea_model_type *type,
                    const char *const names[], size_t name_count, struct dea_result *result);
};

/* What a study works with. */
struct dea_study_job {
  const struct dea_model_type *type;
  struct dea_model *model; // NULL: of a study with own_models
  struct dea_result *result;
  struct dea_study_services services;
};

struct dea_study {
  const char *name;
  const struct dea_design_section *keys; // compute.NAME: its keys and settings; NULL: none
  /* Whether the design asks for it; NULL: where its section is written, or without keys always. */
  bool (*asked)(const struct dea_design *design);
  const char *needs; // keys of the design without which it cannot run; NULL: none
  bool by_name_only; // no design asks for it
  bool own_models;   // makes its own
  /* What a model has to know for it ("vibrations"): by a function of its type, where that stands
   * in struct dea_model_type, 0: none; and whether it does of the result's device, NULL: it does.
   * `run` is not called with one that does not. */
  const char *ability;
  size_t able_by;
  bool (*able)(const struct dea_model_type *type, const struct dea_result *result);
  /* What a design has that models that are able do not take with it: a finding at its place, and
   * DEA_E_DESIGN. NULL: nothing. */
  dea_status (*refuse)(struct dea_context *ctx, const struct dea_design *design,
                       const struct dea_device *device);
  /* Runs and adds its curves to the result. Partial results stay in the result when it fails; the
   * curve then says why it stopped. */
  dea_status (*run)(struct dea_context *ctx, const struct dea_study_job *job);
  /* Makes tables (result/table.h) of what the result has of that model; NULL: none. */
  dea_status (*tables)(struct dea_context *ctx, const char *model, struct dea_result *result);
  const struct dea_figure *figures; // [figure_count] of what a result has of it
  size_t figure_count;
};

/* Runs the studies of these names with one model, whether the result's design asks for them or not;
 * NULL: all that it asks for. Returns the first failure, after all studies had their turn (an
 * interrupt ends it at once). DEA_E_ARGUMENT for a name that is none, DEA_E_DESIGN for one whose
 * keys the design lacks. */
dea_status dea_study_run(struct dea_context *ctx, const struct dea_model_type *type,
                         const char *const names[], size_t name_count, struct dea_result *result);
/* The same with services; NULL for none. */
dea_status dea_study_run_with(struct dea_context *ctx, const struct dea_model_type *type,
                              const char *const names[], size_t name_count,
                              const struct dea_study_services *services, struct dea_result *result);
/* Whether these names can be run for a design, as above; NULL: what it asks for, which can. */
dea_status dea_study_check(struct dea_context *ctx, const char *const names[], size_t name_count,
                           const struct dea_design *design);
/* DEA_E_ARGUMENT where none of the models knows what one of these studies needs, of the device of a
 * result. names: NULL: fine, what a design asks for is for those models that can. DEA_E_DESIGN,
 * after a finding, where one that can does not take it of that design. */
dea_status dea_study_check_models(struct dea_context *ctx,
                                  const struct dea_model_type *const types[], size_t type_count,
                                  const char *const names[], size_t name_count,
                                  const struct dea_result *result);
/* A warning at each study that a design asks for and that none of the models it names knows. */
dea_status dea_study_warn(struct dea_context *ctx, const struct dea_design *design,
                          const struct dea_device *device);
/* Whether a design asks for the study of that name. */
bool dea_study_asked(const struct dea_design *design, const char *name);
/* Highest voltage that the result's curves have reached, or without any that of its design [V]. */
double dea_study_highest_V(const struct dea_result *result);
/* The first curve of that kind with so many points at least, of any model; NULL: none. */
const struct dea_curve *dea_study_first_curve(const struct dea_result *result, const char *kind,
                                              size_t least);
/* Voltage of the next limit point above a point's stretch on its model's path, minus the point's
 * voltage; NAN when the path, which may be NULL, has none. */
double dea_study_distance_to_pull_in(const struct dea_curve *path,
                                     const struct dea_load_point *point);
/* Solves at voltages [count] in their order and adds the points to a curve, with what the device's
 * monitors show. DEA_E_INTERRUPTED when
 * the run is ended on the way. */
dea_status dea_study_add_points(struct dea_context *ctx, const struct dea_study_job *job,
                                const struct dea_device *device, const double *voltages_V,
                                size_t count, struct dea_curve *curve);
/* Columns of a table in the units that people read them in. */
#define DEA_KV(key, title, meaning) DEA_NUMBER_COLUMN(key, "V", "kV", 1e-3, title, meaning)
#define DEA_UM(key, title, meaning) DEA_NUMBER_COLUMN(key, "m", "um", 1e6, title, meaning)
#define DEA_MM(key, title, meaning) DEA_NUMBER_COLUMN(key, "m", "mm", 1e3, title, meaning)
#define DEA_MN(key, title, meaning) DEA_NUMBER_COLUMN(key, "N", "mN", 1e3, title, meaning)
#define DEA_UJ(key, title, meaning) DEA_NUMBER_COLUMN(key, "J", "uJ", 1e6, title, meaning)
#define DEA_BARE(key, title, meaning) DEA_NUMBER_COLUMN(key, NULL, NULL, 1, title, meaning)
/* The field of voltages that a study stops at, in members `voltages_V` and `voltage_count` of its
 * `struct settings`. */
#define DEA_STUDY_STOPS_FIELD(absent, what, shown)                                                 \
  DEA_NUMBER_ROW("voltage", offsetof(struct settings, voltages_V), "V", shown, what, .max = 1e6,   \
                 .absent_text = absent,                                                            \
                 DEA_LIST(1, DEA_DESIGN_STOPS_MAX, struct dea_quantity,                            \
                          offsetof(struct settings, voltage_count)))
/* Voltages that a study stops at: those of the design, or without any the quarters of the highest
 * of the sweep, with 0 V if that is wanted. Returns their number. */
size_t dea_study_stops(const struct dea_design *design, const struct dea_quantity *given,
                       size_t given_count, bool with_rest, double out[DEA_DESIGN_STOPS_MAX]);
/* A job with a model of its own goes through voltages [count] in their order; `add` adds what there
 * is at each stop to the curve of that kind. whole: of all of a device of the general form, not a
 * sector. */
typedef dea_status (*dea_study_stop)(struct dea_context *ctx, const struct dea_study_job *job,
                                     const struct dea_load_point *at, size_t stop,
                                     struct dea_curve *curve);
dea_status dea_study_stop_by_stop(struct dea_context *ctx, const struct dea_study_job *job,
                                  const char *kind, bool whole, const double *voltages_V,
                                  size_t count, dea_study_stop add);
/* Reports the progress of a study: `done` of `total`. */
void dea_study_progress(struct dea_context *ctx, const struct dea_study_job *job, const char *study,
                        size_t done, size_t total);
/* Whether a model knows what the study needs of it. */
bool dea_study_known_to(const struct dea_study *study, const struct dea_model_type *type,
                        const struct dea_result *result);
/* All studies in their order; static storage. */
const struct dea_study *const *dea_study_all(size_t *count);
