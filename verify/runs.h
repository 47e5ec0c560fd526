/* Runs of a model on the paper's actuator with some keys changed; for programs that print numbers
 * of several. */
#pragma once

#include "design/design.h"
#include "model/model.h"
#include "study/design_file.h"
#include "verify.h"

enum { VOLTAGES_MAX = 40, SETS_MAX = 12 };

static struct dea_context *runs_ctx;

/* Keys that take another value than in examples/frdea-4.yaml, up to one with key NULL. */
struct variant {
  struct dea_override sets[SETS_MAX];
};

/* The points of a model at some voltages, from rest. */
struct swept {
  size_t count;
  struct dea_load_point at[VOLTAGES_MAX];
};

struct opened {
  struct dea_design *design;
  struct dea_device *device;
  const struct dea_model_type *type;
  struct dea_model *model;
};

/* sets: of `variant`, then of `more` (may be NULL). */
static inline struct opened open_model(const char *name, const struct variant *variant,
                                       const struct variant *more)
{
  struct dea_override sets[2 * SETS_MAX];
  struct opened open;
  size_t count = 0;
  for (int v = 0; v < 2; v++) {
    const struct variant *from = v == 0 ? variant : more;
    for (size_t i = 0; from != NULL && i < SETS_MAX && from->sets[i].key != NULL; i++) {
      sets[count++] = from->sets[i];
    }
  }
  verify_ok(runs_ctx, dea_design_read(runs_ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", sets,
                                      count, &open.design));
  verify_ok(runs_ctx, dea_device_build(runs_ctx, open.design, &open.device));
  open.type = dea_model_find(name);
  verify_ok(runs_ctx, dea_model_create(runs_ctx, open.type, open.design, open.device, &open.model));
  return open;
}

static inline void close_model(struct opened *open)
{
  open->type->destroy(runs_ctx, open->model);
  dea_device_destroy(runs_ctx, open->device);
  dea_design_destroy(runs_ctx, open->design);
}

/* In steps from 0 V up to `top_V`. */
static inline struct swept sweep(const char *name, const struct variant *variant,
                                 const struct variant *more, double step_V, double top_V)
{
  struct opened open = open_model(name, variant, more);
  struct swept run = {.count = (size_t)lround(top_V / step_V) + 1};
  for (size_t i = 0; i < run.count; i++) {
    verify_ok(runs_ctx, open.type->solve(runs_ctx, open.model, step_V * (double)i, &run.at[i]));
  }
  close_model(&open);
  return run;
}

static inline const struct dea_load_point *point_of(const struct swept *run, double voltage_V)
{
  size_t best = 0;
  for (size_t i = 0; i < run->count; i++) {
    if (fabs(run->at[i].voltage_V - voltage_V) < fabs(run->at[best].voltage_V - voltage_V)) {
      best = i;
    }
  }
  return &run->at[best];
}

static inline double centre_um(const struct swept *run, double voltage_V)
{
  return 1e6 * point_of(run, voltage_V)->centre_z_m;
}

static inline double tip_um(const struct swept *run, double voltage_V)
{
  return 1e6 * point_of(run, voltage_V)->fibre_tip_z_m;
}

/* Farthest that any place of the film is from its plane, with its sign. */
static inline double farthest_um(const struct swept *run, double voltage_V)
{
  const struct dea_load_point *p = point_of(run, voltage_V);
  return 1e6 * (p->highest_z_m > -p->lowest_z_m ? p->highest_z_m : p->lowest_z_m);
}
