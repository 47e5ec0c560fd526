/* A film of any device at rest against the voltage: model 3d at voltages of which one after the
 * other is computed when it is wanted, and between them even in the voltage. */
#pragma once

#include "model/model.h"

struct dea_film_table;

/* monitor: quantity by which the film moves ("hub_z"), which points have as that of the centre and
 * the fibre tips; NULL: the first monitor's z. design, device: lent. */
dea_status dea_film_table_create(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, const char *monitor,
                                 struct dea_film_table **out);
void dea_film_table_destroy(struct dea_context *ctx, struct dea_film_table *table);
/* A point at a voltage of either sign. Fails as the model's `solve` where a voltage on the way
 * does, from then on too. */
dea_status dea_film_table_at(struct dea_context *ctx, struct dea_film_table *table,
                             double voltage_V, struct dea_load_point *out);
/* The voltage on the film after a time at whose end its source stands at to_V, over a resistance
 * and with a current of at most limit_A: implicit Euler. */
struct dea_film_step {
  double length_s, to_V;
  double film_V; // before
  double resistance_ohm, limit_A;
};
dea_status dea_film_table_charge(struct dea_context *ctx, struct dea_film_table *table,
                                 const struct dea_film_step *step, double *film_V);
