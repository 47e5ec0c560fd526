/* A film of any device at rest against the voltage: model 3d at voltages of which one after the
 * other is computed when it is wanted, and between them even in the voltage. */
#pragma once

#include "model/model.h"
#include "study/observe.h"

/* By what quantity of its monitors a film moves. */
struct dea_film_motion {
  struct dea_monitor_set set;
  int column; // -1: none
};

/* monitor: as below. Free it with dea_monitor_set_free. */
dea_status dea_film_motion_init(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_device *device, const char *monitor,
                                struct dea_film_motion *out);
/* Height of centre and fibre tips of a model's last point. */
dea_status dea_film_motion_read(struct dea_context *ctx, struct dea_film_motion *motion,
                                const struct dea_model_type *type, struct dea_model *model,
                                struct dea_load_point *point);

/* A model in time that is at rest at every moment: it has solve, begin, advance and accept. */
extern const struct dea_model_type dea_film_table_type;

/* monitor: quantity by which the film moves ("hub_z"), which points have as that of the centre and
 * the fibre tips; NULL: the first monitor's z. design, device: lent. out: a model of this type,
 * owned by the caller. */
dea_status dea_film_table_create(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, const char *monitor,
                                 struct dea_model **out);
