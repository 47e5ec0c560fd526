/* Monitors and channels of a device in the tables of a result. */
#ifndef DEA_STUDY_OBSERVE_H
#define DEA_STUDY_OBSERVE_H

#include "model/model.h"
#include "result/figure.h"
#include "result/result.h"

/* Columns of a table, one for each of enum dea_observed. */
#define DEA_OBSERVED_COLUMNS                                                                       \
  DEA_NUMBER_COLUMN("x_m", "m", "um", 1e6, "x", "displacement along x"),                           \
      DEA_NUMBER_COLUMN("y_m", "m", "um", 1e6, "y", "displacement along y"),                       \
      DEA_NUMBER_COLUMN("z_m", "m", "um", 1e6, "z", "displacement out of the plane"),              \
      DEA_NUMBER_COLUMN("turn_x_rad", "rad", "deg", 57.29577951308232, "turn x",                   \
                        "turn of a body about x"),                                                 \
      DEA_NUMBER_COLUMN("turn_y_rad", "rad", "deg", 57.29577951308232, "turn y",                   \
                        "turn of a body about y"),                                                 \
      DEA_NUMBER_COLUMN("turn_z_rad", "rad", "deg", 57.29577951308232, "turn z",                   \
                        "turn of a body about z"),                                                 \
      DEA_NUMBER_COLUMN("stretch", "1", "1", 1, "stretch", "length of a line over its flat one"),  \
      DEA_NUMBER_COLUMN("stretch_x", "1", "1", 1, "stretch x",                                     \
                        "mean stretch of a region along x"),                                       \
      DEA_NUMBER_COLUMN("stretch_y", "1", "1", 1, "stretch y",                                     \
                        "mean stretch of a region along y"),                                       \
      DEA_NUMBER_COLUMN("area_stretch", "1", "1", 1, "area stretch",                               \
                        "area of a region over its flat one"),                                     \
      DEA_NUMBER_COLUMN("force_x_N", "N", "mN", 1e3, "force x",                                    \
                        "on a body, of what holds or moves it"),                                   \
      DEA_NUMBER_COLUMN("force_y_N", "N", "mN", 1e3, "force y",                                    \
                        "on a body, of what holds or moves it"),                                   \
      DEA_NUMBER_COLUMN("force_z_N", "N", "mN", 1e3, "force z",                                    \
                        "on a body, of what holds or moves it"),                                   \
      DEA_NUMBER_COLUMN("moment_x_N_m", "N m", "uN m", 1e6, "moment x",                            \
                        "on a body about its centre"),                                             \
      DEA_NUMBER_COLUMN("moment_y_N_m", "N m", "uN m", 1e6, "moment y",                            \
                        "on a body about its centre"),                                             \
      DEA_NUMBER_COLUMN("moment_z_N_m", "N m", "uN m", 1e6, "moment z",                            \
                        "on a body about its centre")

/* Adds a row for each monitor and channel at the last point solved to the model's tables "monitors"
 * and "channels", which are made by the first. Nothing for a device that has none, and for a model
 * that knows none. */
dea_status dea_study_observe(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, struct dea_result *result);
/* The meshes of an adaptive refinement as the model's table "adaptation", once; nothing without. */
dea_status dea_study_observe_passes(struct dea_context *ctx, const struct dea_model_type *type,
                                    const struct dea_model *model, struct dea_result *result);

/* How many numbers monitors and channels have at a point; 0 where nothing is observed. */
size_t dea_observe_width(const struct dea_model_type *type, const struct dea_result *result);
/* Those at the last point solved, or of a history at the last step: values [width]. */
dea_status dea_observe_take(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, double *values);
/* Tables "monitors" and "channels" of the study transient. values: [curve->count][width]. */
dea_status dea_observe_history(struct dea_context *ctx, const struct dea_model_type *type,
                               const struct dea_curve *curve, const double *values,
                               struct dea_result *result);

/* Figures of these tables, for the study sweep; and what builds those of histories. */
enum { DEA_OBSERVE_FIGURES = 4 };
extern const struct dea_figure dea_observe_figures[DEA_OBSERVE_FIGURES];
dea_status dea_observe_displacement_in_time(struct dea_context *ctx,
                                            const struct dea_result *result, struct dea_plot *plot);
dea_status dea_observe_stretches_in_time(struct dea_context *ctx, const struct dea_result *result,
                                         struct dea_plot *plot);
dea_status dea_observe_turns_in_time(struct dea_context *ctx, const struct dea_result *result,
                                     struct dea_plot *plot);
dea_status dea_observe_voltages_in_time(struct dea_context *ctx, const struct dea_result *result,
                                        struct dea_plot *plot);
dea_status dea_observe_currents_in_time(struct dea_context *ctx, const struct dea_result *result,
                                        struct dea_plot *plot);
dea_status dea_observe_charges_in_time(struct dea_context *ctx, const struct dea_result *result,
                                       struct dea_plot *plot);

#endif
