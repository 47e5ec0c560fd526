/* What the monitors and channels of a device show, as columns of a study's curves. */
#pragma once

#include "model/model.h"
#include "result/columns.h"
#include "result/figure.h"
#include "result/result.h"
#include "study/study.h"

/* The columns of a device and their values at one point; freed with dea_monitor_set_free. */
struct dea_monitor_set {
  struct dea_arena memory;
  const struct dea_monitor_column *columns; // [count]; 0: the model observes none
  size_t count;
  double *errors; // [monitor_count]
  struct dea_monitor_values *values;
};

/* Numbers of NAN for columns of monitors [count]; NULL on failure. */
struct dea_monitor_values *dea_monitor_column_values(struct dea_arena *memory,
                                                     const struct dea_monitor_column *columns,
                                                     size_t count);
dea_status dea_monitor_set_init(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_device *device, struct dea_monitor_set *out);
/* Those at the last point solved, or of a history at the last step, into the point, which borrows
 * `values` of the set. errors: with those that the model estimates. */
dea_status dea_monitor_set_read(struct dea_context *ctx, struct dea_monitor_set *set,
                                const struct dea_model_type *type, struct dea_model *model,
                                bool errors, struct dea_load_point *point);
void dea_monitor_set_free(struct dea_monitor_set *set);

/* Adds the last point solved to a curve, with what monitors and channels of the device show. */
dea_status dea_study_add_point(struct dea_context *ctx, const struct dea_study_job *job,
                               const struct dea_device *device, const struct dea_load_point *point,
                               struct dea_curve *curve);
/* The meshes of an adaptive refinement as the model's table "adaptation", once; nothing without. */
dea_status dea_study_observe_passes(struct dea_context *ctx, const struct dea_study_job *job);
/* Extremes of what the channels of a history saw, as its model's table "sources". */
dea_status dea_study_sources(struct dea_context *ctx, const struct dea_monitor_set *set,
                             const struct dea_curve *curve, struct dea_result *result);

/* Figures of these columns, for the study sweep; and what builds them and those of histories, whose
 * names begin with "history_": monitors, monitors_stretch, monitors_turn, channels, voltages,
 * currents. */
enum { DEA_OBSERVE_FIGURES = 4 };
extern const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES];
dea_status dea_observe_build(struct dea_context *ctx, const struct dea_result *result,
                             struct dea_plot *plot);
/* An axis of time from 0 to the end of the longest curve, and the key. */
void dea_observe_time_axis(struct dea_panel *panel);
