/* Lists of models and studies, and one actuator step by step. */
#include "api/api.h"

#include "result/columns.h"
#include "study/force.h"
#include "study/observe.h"
#include "study/study.h"

#include <math.h>
#include <string.h>

static unsigned abilities_of(const struct dea_model_type *type)
{
  return (type->path != NULL ? DEA_CAN_PATH : 0u) | (type->profile != NULL ? DEA_CAN_PROFILE : 0u) |
         (type->indent != NULL ? DEA_CAN_INDENT : 0u) | (type->modes != NULL ? DEA_CAN_MODES : 0u) |
         (type->respond != NULL ? DEA_CAN_RESPOND : 0u) |
         (type->fields != NULL ? DEA_CAN_FIELDS : 0u) |
         (type->advance != NULL ? DEA_CAN_TIME : 0u) | (type->size != NULL ? DEA_CAN_REFINE : 0u);
}

const dea_model_info *dea_model_at(dea_context *ctx, size_t index)
{
  size_t count;
  char path[4096];
  const struct dea_model_type *const *all = dea_model_all(&count);
  if (index >= count) {
    return NULL;
  }
  const struct dea_model_type *type = all[index];
  ctx->model = (dea_model_info){
      .name = type->name,
      .title = type->long_name,
      .abilities = abilities_of(type),
      .available = strcmp(type->name, "3d") != 0 || dea_solid_module_find(path, sizeof path),
      .layout_abilities = type->any_layout ? abilities_of(type) & ~(unsigned)DEA_CAN_PROFILE : 0};
  return &ctx->model;
}

const dea_study_info *dea_study_at(dea_context *ctx, size_t index)
{
  size_t count;
  const struct dea_study *const *all = dea_study_all(&count);
  if (index >= count) {
    return NULL;
  }
  ctx->study = (dea_study_info){.name = all[index]->name,
                                .needs = all[index]->needs != NULL ? all[index]->needs : ""};
  return &ctx->study;
}

dea_status api_model_find(dea_context *ctx, const char *name, const struct dea_model_type **out)
{
  *out = dea_model_find(name);
  if (*out == NULL) {
    size_t count;
    const struct dea_model_type *const *all = dea_model_all(&count);
    const char *known[16];
    for (size_t i = 0; i < count && i < sizeof known / sizeof known[0]; i++) {
      known[i] = all[i]->name;
    }
    return dea_unknown_name(ctx->inner, "model", name, known, count);
  }
  return DEA_OK;
}

struct dea_actuator_handle {
  dea_context *ctx; // that made it; lent
  struct dea_design *design;
  struct dea_device *device;
  const struct dea_model_type *type;
  struct dea_model *model;
  struct dea_load_point point;     // the last one
  struct dea_monitor_set monitors; // whose values it lends
  struct api_mesh *mesh;
};

void dea_actuator_free(dea_actuator *actuator)
{
  if (actuator != NULL) {
    struct dea_context *ctx = actuator->ctx->inner;
    api_mesh_free(ctx, actuator->mesh);
    if (actuator->model != NULL) {
      actuator->type->destroy(ctx, actuator->model);
    }
    dea_monitor_set_free(&actuator->monitors);
    dea_device_destroy(ctx, actuator->device);
    dea_design_destroy(ctx, actuator->design);
    dea_free(ctx, actuator);
  }
}

dea_status dea_actuator_open(dea_context *ctx, const dea_design *design, const char *model,
                             dea_actuator **out)
{
  struct dea_context *inner = api_begin(ctx);
  *out = NULL;
  const struct dea_model_type *type;
  DEA_TRY(inner, api_model_find(ctx, model, &type));
  dea_actuator *actuator = dea_alloc(inner, 1, sizeof *actuator);
  DEA_TRY_MEMORY(actuator != NULL);
  actuator->ctx = ctx;
  actuator->point = dea_load_point_empty();
  dea_status status = api_design_build(inner, design, &actuator->design, &actuator->device);
  if (status == DEA_OK) {
    actuator->type = type;
    status = dea_model_create(inner, actuator->type, actuator->design, actuator->device,
                              &actuator->model);
  }
  status = status == DEA_OK
               ? dea_monitor_set_init(inner, actuator->type, actuator->device, &actuator->monitors)
               : status;
  DEA_TRY_ELSE(inner, status, dea_actuator_free(actuator));
  *out = actuator;
  return DEA_OK;
}

/* Begins a call that changes the actuator: what it has lent goes. */
static dea_status begin(dea_context *ctx, dea_actuator *actuator)
{
  struct dea_context *inner = api_begin(ctx);
  DEA_TRY(inner, api_check_owner(ctx, actuator->ctx, "actuator"));
  api_mesh_free(inner, actuator->mesh);
  actuator->mesh = NULL;
  return DEA_OK;
}

dea_status dea_actuator_solve(dea_context *ctx, dea_actuator *actuator, double voltage_V)
{
  DEA_TRY(ctx->inner, begin(ctx, actuator));
  DOOR_CHECK(ctx, {"voltage_V", &voltage_V, 1, false});
  struct dea_load_point point;
  DEA_TRY(ctx->inner, actuator->type->solve(ctx->inner, actuator->model, voltage_V, &point));
  DEA_TRY(ctx->inner, dea_monitor_set_read(ctx->inner, &actuator->monitors, actuator->type,
                                           actuator->model, false, &point));
  actuator->point = point;
  return DEA_OK;
}

dea_status dea_actuator_indent(dea_context *ctx, dea_actuator *actuator, dea_indenter_shape shape,
                               double radius_m, double depth_m)
{
  static const enum dea_probe_shape shapes[] = {DEA_PROBE_SPHERE, DEA_PROBE_FLAT,
                                                DEA_PROBE_CYLINDER};
  DEA_TRY(ctx->inner, begin(ctx, actuator));
  DOOR_CHECK(ctx, {"radius_m", &radius_m, 1, false}, {"depth_m", &depth_m, 1, false});
  if ((size_t)shape >= sizeof shapes / sizeof shapes[0] || !(radius_m > 0)) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "an indenter of shape %d, radius %g m, at %g m",
                    (int)shape, radius_m, depth_m);
  }
  const struct dea_probe probe = {.shape = shapes[shape],
                                  .radius_m = radius_m,
                                  .edge_radius_m =
                                      dea_force_indenter(actuator->design).edge_radius_m,
                                  .from_fibre_side = true};
  struct dea_load_point point;
  DEA_TRY(ctx->inner,
          dea_model_indent(ctx->inner, actuator->type, actuator->model, &probe, depth_m, &point));
  actuator->point = point;
  return DEA_OK;
}

dea_status dea_actuator_get(dea_context *ctx, const dea_actuator *actuator, const char *key,
                            double *out)
{
  int column = dea_column_find(ctx->inner, key);
  const struct dea_point_state *state = dea_point_state_find(key);
  *out = NAN;
  if (state != NULL) {
    *out = state->get(&actuator->point);
  } else if (column < 0) {
    const char **known = dea_column_keys(ctx->inner);
    DEA_TRY_MEMORY(known != NULL);
    dea_status status =
        dea_unknown_name(ctx->inner, "quantity", key, known, (size_t)dea_column_count(ctx->inner));
    dea_free(ctx->inner, known);
    return status;
  } else {
    *out = dea_point_get(&actuator->point, column);
  }
  return DEA_OK;
}

dea_status dea_actuator_mesh(dea_context *ctx, dea_actuator *actuator, const dea_mesh **out)
{
  struct dea_field_mesh *mesh;
  *out = NULL;
  DEA_TRY(ctx->inner, begin(ctx, actuator));
  DEA_TRY(ctx->inner,
          dea_model_fields(ctx->inner, actuator->type, actuator->model, DEA_FIELDS_VOLUME, &mesh));
  DEA_TRY(ctx->inner, api_mesh_create(ctx->inner, actuator->type->name, actuator->point.voltage_V,
                                      mesh, true, &actuator->mesh));
  *out = &actuator->mesh->shown;
  return DEA_OK;
}
