/* Model "3d" as the rest of the library sees it: a door to a module that is loaded only when a
 * model is made, since PETSc and what it brings along take longer to load than most commands to
 * run. */
#define _POSIX_C_SOURCE 200809L // pthread_mutex_t
#include "model/solid_module.h"
#include "base/module.h"
#include "model/model.h"
#include "model/solid_check.h"

#include <pthread.h>

static const char module_file[] = "dea_solid_module.so";
static const char advice[] =
    "it is built when libpetsc-real-dev and libslepc-real-dev are installed";

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

static const char model_type[] = "dea_solid_module"; // its struct dea_model_type

static const struct dea_model_type *module_of(const struct dea_model *model)
{
  return ((const struct dea_solid_head *)(const void *)model)->module;
}

/* It cannot be unloaded: MPI. */
dea_status dea_solid_module_symbol(struct dea_context *ctx, const char *name, const void **out)
{
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(
                            dea_module_open(ctx, module_file, name, "the 3D engine", advice, out)));
}

static dea_status create_inside(struct dea_context *ctx, const struct dea_device *device,
                                const struct dea_model_settings *settings, struct dea_model **out)
{
  const void *found = NULL;
  DEA_TRY(ctx, dea_solid_module_symbol(ctx, model_type, &found));
  const struct dea_model_type *module = found;
  DEA_TRY(ctx, module->create(ctx, device, settings, out));
  ((struct dea_solid_head *)(void *)*out)->module = module;
  return DEA_OK;
}

static dea_status create(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = NULL;
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(create_inside(ctx, device, settings, out)));
}

static void destroy(struct dea_context *ctx, struct dea_model *model)
{
  if (model != NULL) {
    dea_solid_enter();
    module_of(model)->destroy(ctx, model);
    dea_solid_leave(DEA_OK);
  }
}

static dea_status libraries(struct dea_context *ctx, char *out, size_t size)
{
  const void *found = NULL;
  DEA_TRY(ctx, dea_solid_module_symbol(ctx, model_type, &found));
  const struct dea_model_type *module = found;
  return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(module->libraries(ctx, out, size)));
}

static void accept(struct dea_model *model)
{
  dea_solid_enter();
  module_of(model)->accept(model);
  dea_solid_leave(DEA_OK);
}

/* A function of struct dea_model_type that lends something of a model. */
#define LENT(result, name)                                                                         \
  static result name(const struct dea_model *model)                                                \
  {                                                                                                \
    return module_of(model)->name(model);                                                          \
  }

LENT(const struct dea_event *, limit)
LENT(const struct dea_event *, passed)
LENT(const double *, answers)

static const struct dea_adapt_pass *passes(const struct dea_model *model, size_t *count)
{
  return module_of(model)->passes(model, count);
}

static void size(const struct dea_model *model, struct dea_model_size *out)
{
  module_of(model)->size(model, out);
}

/* A function of struct dea_model_type in turn: what it hands on, and what it takes behind the
 * context and the model. */
#define IN_TURN(name, arguments, ...)                                                              \
  static dea_status name(struct dea_context *ctx, struct dea_model *model, __VA_ARGS__)            \
  {                                                                                                \
    return DEA_CHAIN(ctx, DEA_SOLID_IN_TURN(module_of(model)->name arguments));                    \
  }

IN_TURN(solve, (ctx, model, voltage_V, out), double voltage_V, struct dea_load_point *out)
IN_TURN(indent, (ctx, model, tip, depth_m, out), const struct dea_probe *tip, double depth_m,
        struct dea_load_point *out)
IN_TURN(move, (ctx, model, control, value, out), const struct dea_control *control, double value,
        struct dea_load_point *out)
IN_TURN(compliance, (ctx, model, coordinate, with, out), const struct dea_control *coordinate,
        int with, struct dea_compliance *out)
IN_TURN(long_path, (ctx, model, options, points, events, user),
        const struct dea_path_options *options, dea_point_sink points, dea_event_sink events,
        void *user)
IN_TURN(soften, (ctx, model, count, stiffness_N_per_m4), size_t count, double *stiffness_N_per_m4)
IN_TURN(push, (ctx, model, perturbation, out, found), const struct dea_push *perturbation,
        struct dea_load_point *out, bool *found)
IN_TURN(gradient, (ctx, model, ask, out), const struct dea_gradient_request *ask, double *out)
IN_TURN(observe, (ctx, model, out), struct dea_observation *out)
IN_TURN(errors, (ctx, model, error), double *error)
IN_TURN(profile, (ctx, model, out), struct dea_profile *out)
IN_TURN(modes, (ctx, model, at, count, points, shapes), const struct dea_load_point *at,
        size_t count, struct dea_load_point *points, struct dea_field_mesh **shapes)
IN_TURN(respond, (ctx, model, at, excitation, frequency_Hz, count, points),
        const struct dea_load_point *at, const struct dea_ac_excitation *excitation,
        const double *frequency_Hz, size_t count, struct dea_load_point *points)
IN_TURN(fields, (ctx, model, part, out), enum dea_fields_part part, struct dea_field_mesh **out)
IN_TURN(save, (ctx, model, out), struct dea_state *out)
IN_TURN(load, (ctx, model, state), const struct dea_state *state)
IN_TURN(begin, (ctx, model, options, out), const struct dea_time_options *options,
        struct dea_load_point *out)
IN_TURN(advance, (ctx, model, step, out, error), const struct dea_time_step *step,
        struct dea_load_point *out, double *error)

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
