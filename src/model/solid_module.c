/* Model "3d" as the rest of the library sees it: a door to a module that is loaded only when a
 * model is made, since PETSc and what it brings along take longer to load than most commands to
 * run. */
#define _POSIX_C_SOURCE 200809L // pthread_mutex_t
#include "base/module.h"
#include "model/model.h"
#include "model/solid_access.h"
#include "model/solid_check.h"

#include <pthread.h>
#include <stdio.h>

static const char module_file[] = "dea_solid_module.so";
static const char advice[] =
    "it is built when libpetsc-real-dev and libslepc-real-dev are installed";

struct dea_model {
  const struct dea_model_type *type; // of the module
  struct dea_model *inner;
};

/* Whose turn it is: numbers are given and called out as at a counter, as a mutex alone may be given
 * to the same thread again and again. */
static struct {
  pthread_mutex_t mutex;
  pthread_cond_t called;
  unsigned long given, now; // numbers
  pthread_t owner;          // of the number `now`
  unsigned depth;           // its calls in calls; 0: nobody is in
} solid_lock = {.mutex = PTHREAD_MUTEX_INITIALIZER, .called = PTHREAD_COND_INITIALIZER};

void dea_solid_enter(void)
{
  pthread_mutex_lock(&solid_lock.mutex);
  if (solid_lock.depth == 0 || !pthread_equal(solid_lock.owner, pthread_self())) {
    const unsigned long own = solid_lock.given++;
    while (solid_lock.now != own) {
      pthread_cond_wait(&solid_lock.called, &solid_lock.mutex);
    }
    solid_lock.owner = pthread_self();
  }
  solid_lock.depth++;
  pthread_mutex_unlock(&solid_lock.mutex);
}

dea_status dea_solid_leave(dea_status status)
{
  pthread_mutex_lock(&solid_lock.mutex);
  if (--solid_lock.depth == 0) {
    solid_lock.now++;
    pthread_cond_broadcast(&solid_lock.called);
  }
  pthread_mutex_unlock(&solid_lock.mutex);
  return status;
}

bool dea_solid_module_find(char *out, size_t size)
{
  return dea_module_find(module_file, out, size);
}

/* It cannot be unloaded: MPI. */
static dea_status open_module(struct dea_context *ctx, const struct dea_model_type **out)
{
  const void *type = NULL;
  DEA_TRY(ctx, DEA_SOLID_IN_TURN(dea_module_open(ctx, module_file, "dea_solid_module",
                                                 "the 3D engine", advice, &type)));
  *out = type;
  return DEA_OK;
}

dea_status dea_solid_access_open(struct dea_context *ctx, const struct dea_solid_access **out)
{
  const void *access = NULL;
  DEA_TRY(ctx, DEA_SOLID_IN_TURN(dea_module_open(ctx, module_file, "dea_solid_access",
                                                 "the 3D engine", advice, &access)));
  *out = access;
  return DEA_OK;
}

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_solid_enter();
    model->type->destroy(ctx, model->inner);
    dea_solid_leave(DEA_OK);
    dea_free(ctx, model);
  }
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = NULL;
  const struct dea_model_type *type = NULL;
  DEA_TRY(ctx, open_module(ctx, &type));
  struct dea_model *model = dea_alloc(ctx, 1, sizeof *model);
  DEA_TRY_MEMORY(model != NULL);
  model->type = type;
  struct dea_model_settings own = settings != NULL ? *settings : (struct dea_model_settings){0};
  own.mesh_from = own.mesh_from != NULL ? own.mesh_from->inner : NULL;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): open_module sets it or fails
  dea_status status = DEA_SOLID_IN_TURN(type->create(ctx, device, &own, &model->inner));
  if (status != DEA_OK) {
    dea_free(ctx, model);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = model;
  return DEA_OK;
}

static dea_status libraries(struct dea_context *ctx, char *out, size_t size)
{
  const struct dea_model_type *type = NULL;
  DEA_TRY(ctx, open_module(ctx, &type));
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(type->libraries(ctx, out, size)));
}

static const struct dea_event *limit(const struct dea_model *model)
{
  return model->type->limit(model->inner);
}

static const struct dea_event *passed(const struct dea_model *model)
{
  return model->type->passed(model->inner);
}

static dea_status solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->solve(ctx, model->inner, voltage_V, out)));
}

static dea_status indent(struct dea_context *ctx, struct dea_model *model,
                         const struct dea_probe *probe, double depth_m, struct dea_load_point *out)
{
  return DEA_CHAIN(ctx,
                   DEA_SOLID_IN_TURN(model->type->indent(ctx, model->inner, probe, depth_m, out)));
}

static dea_status move(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_control *control, double value, struct dea_load_point *out)
{
  return DEA_CHAIN(ctx,
                   DEA_SOLID_IN_TURN(model->type->move(ctx, model->inner, control, value, out)));
}

static dea_status compliance(struct dea_context *ctx, struct dea_model *model,
                             const struct dea_control *coordinate, int with,
                             struct dea_compliance *out)
{
  return DEA_CHAIN(
      ctx, DEA_SOLID_IN_TURN(model->type->compliance(ctx, model->inner, coordinate, with, out)));
}

static dea_status long_path(struct dea_context *ctx, struct dea_model *model,
                            const struct dea_path_options *options, dea_point_sink points,
                            dea_event_sink events, void *user)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->long_path(ctx, model->inner, options, points,
                                                                 events, user)));
}

static dea_status soften(struct dea_context *ctx, struct dea_model *model, size_t count,
                         double *stiffness_N_per_m4)
{
  return DEA_CHAIN(
      ctx, DEA_SOLID_IN_TURN(model->type->soften(ctx, model->inner, count, stiffness_N_per_m4)));
}

static dea_status push(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_push *perturbation, struct dea_load_point *out, bool *found)
{
  return DEA_CHAIN(
      ctx, DEA_SOLID_IN_TURN(model->type->push(ctx, model->inner, perturbation, out, found)));
}

static dea_status gradient(struct dea_context *ctx, struct dea_model *model,
                           const struct dea_gradient_request *ask, double *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->gradient(ctx, model->inner, ask, out)));
}

static dea_status observe(struct dea_context *ctx, struct dea_model *model,
                          struct dea_observation *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->observe(ctx, model->inner, out)));
}

static dea_status errors(struct dea_context *ctx, struct dea_model *model, double *error)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->errors(ctx, model->inner, error)));
}

static const struct dea_adapt_pass *passes(const struct dea_model *model, size_t *count)
{
  return model->type->passes(model->inner, count);
}

static dea_status profile(struct dea_context *ctx, struct dea_model *model, struct dea_profile *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->profile(ctx, model->inner, out)));
}

static dea_status modes(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_load_point *at, size_t count,
                        struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  return DEA_CHAIN(
      ctx, DEA_SOLID_IN_TURN(model->type->modes(ctx, model->inner, at, count, points, shapes)));
}

static dea_status respond(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->respond(ctx, model->inner, at, excitation,
                                                               frequency_Hz, count, points)));
}

static const double *answers(const struct dea_model *model)
{
  return model->type->answers(model->inner);
}

static dea_status fields(struct dea_context *ctx, struct dea_model *model,
                         enum dea_fields_part part, struct dea_field_mesh **out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->fields(ctx, model->inner, part, out)));
}

static dea_status save(struct dea_context *ctx, struct dea_model *model, struct dea_state *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->save(ctx, model->inner, out)));
}

static dea_status load(struct dea_context *ctx, struct dea_model *model,
                       const struct dea_state *state)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->load(ctx, model->inner, state)));
}

static dea_status begin(struct dea_context *ctx, struct dea_model *model,
                        const struct dea_time_options *options, struct dea_load_point *out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(model->type->begin(ctx, model->inner, options, out)));
}

static dea_status advance(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  return DEA_CHAIN(ctx,
                   DEA_SOLID_IN_TURN(model->type->advance(ctx, model->inner, step, out, error)));
}

static void accept(struct dea_model *model)
{
  dea_solid_enter();
  model->type->accept(model->inner);
  dea_solid_leave(DEA_OK);
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  model->type->size(model->inner, out);
}

const struct dea_model_type dea_model_3d = {
    .name = "3d",
    .any_layout = true,
    .long_name = "3D solid",
    .libraries = libraries,
    .create = create,
    .destroy = destroy,
    .check = dea_solid_check_design,
    .limit = limit,
    .passed = passed,
    .solve = solve,
    .gradient = gradient,
    .observe = observe,
    .errors = errors,
    .passes = passes,
    .indent = indent,
    .move = move,
    .compliance = compliance,
    .long_path = long_path,
    .soften = soften,
    .push = push,
    .modes = modes,
    .respond = respond,
    .answers = answers,
    .profile = profile,
    .fields = fields,
    .save = save,
    .load = load,
    .begin = begin,
    .advance = advance,
    .accept = accept,
    .size = size,
};
