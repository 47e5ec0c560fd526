#include "film/film_of_design.h"

#include "material/plane.h"
#include "model/model.h"
#include "study/design_file.h"
#include "study/observe.h"

#include <math.h>
#include <string.h>

enum { PATH_POINTS_MAX = 4000 };

struct film {
  struct dea_bench_film base;
  struct dea_design *design; // owned
};

struct film_model {
  struct dea_bench_model base;
  const struct dea_design *design; // lent
  struct dea_device *device;       // owned
  const struct dea_model_type *type;
  struct dea_model *model; // owned; NULL: of a check of what is no disc
  bool by_monitor;         // it moves by a quantity of its monitors
  struct dea_monitor_set monitors;
  int column; // of that quantity; -1: none
};

static void destroy(struct dea_context *ctx, struct dea_bench_film *film)
{
  if (film != NULL) {
    dea_design_destroy(ctx, ((struct film *)film)->design);
    dea_free(ctx, film);
  }
}

static dea_status read(struct dea_context *ctx, const char *file, const char *text, size_t length,
                       struct dea_bench_film **out)
{
  *out = NULL;
  struct film *film = dea_alloc(ctx, 1, sizeof *film);
  DEA_TRY_MEMORY(film != NULL);
  film->base.type = &dea_film_of_design;
  dea_status status = dea_design_read_memory(ctx, file, text, length, NULL, 0, &film->design);
  DEA_TRY_ELSE(ctx, status, destroy(ctx, &film->base));
  *out = &film->base;
  return DEA_OK;
}

static const char *model_name(size_t index, bool *moves)
{
  size_t count;
  const struct dea_model_type *const *types = dea_model_all(&count);
  *moves = index < count && types[index]->advance != NULL;
  return index < count ? types[index]->name : NULL;
}

// One model --------------------------------------------------------------------------------------

static void close_model(struct dea_context *ctx, struct dea_bench_model *model)
{
  struct film_model *m = (struct film_model *)model;
  if (m == NULL) {
    return;
  }
  if (m->model != NULL) {
    m->type->destroy(ctx, m->model);
  }
  dea_monitor_set_free(&m->monitors);
  dea_device_destroy(ctx, m->device);
  dea_free(ctx, m);
}

/* The film between the first electrodes; NULL: there is none. */
static const struct dea_material *film_of(const struct dea_device *device)
{
  const struct dea_layout_ply *film = dea_layout_film(device->layout);
  return film != NULL ? &film->material : NULL;
}

/* How far the device reaches from the origin along an axis. */
static double reach_of(const struct dea_device *device)
{
  double box[4], reach = 0; // x, y; x, y
  dea_layout_box_m(device->layout, box);
  for (size_t k = 0; k < 4; k++) {
    reach = isfinite(box[k]) ? fmax(reach, fabs(box[k])) : reach;
  }
  return reach;
}

/* The first monitor's z; -1: none. */
static int first_height(const struct dea_monitor_set *set)
{
  for (size_t i = 0; i < set->count; i++) {
    const struct dea_monitor_column *c = &set->columns[i];
    if (c->source == DEA_OF_MONITOR && c->number == DEA_OBSERVED_Z) {
      return c->column;
    }
  }
  return -1;
}

/* Finds the monitor by which it moves. */
static dea_status find_motion(struct dea_context *ctx, const char *monitor, struct film_model *m)
{
  DEA_TRY(ctx, dea_monitor_set_init(ctx, m->type, m->device, &m->monitors));
  m->column = monitor != NULL ? dea_column_find(ctx, monitor) : first_height(&m->monitors);
  if (monitor == NULL ||
      (m->column >= 0 && strcmp(dea_column_at(ctx, m->column)->si_unit, "m") == 0)) {
    return DEA_OK;
  }
  char hint[DEA_HINT_SIZE];
  DEA_TRY(ctx, dea_column_hint(ctx, monitor, NULL, hint));
  return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' is no displacement of a monitor of the film%s",
                  monitor, hint);
}

/* Height of centre and fibre tips of the last point, where it moves by a monitor. */
static dea_status read_motion(struct dea_context *ctx, struct film_model *m,
                              struct dea_load_point *point)
{
  if (!m->by_monitor) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_monitor_set_read(ctx, &m->monitors, m->type, m->model, false, point));
  const double z = m->column >= 0 ? dea_point_get(point, m->column) : NAN;
  point->centre_z_m = point->fibre_tip_z_m = z;
  point->monitors = NULL; // the set's
  return DEA_OK;
}

/* Any device is as high everywhere, and moves by a monitor; in a check it is at rest, by model 3d.
 */
static dea_status build_any(struct dea_context *ctx, bool moves, const char *monitor,
                            struct film_model *m)
{
  const struct dea_material *film = film_of(m->device);
  m->base.material = film != NULL ? film->name : "";
  m->base.frame_radius_m = m->base.fibre_tip_radius_m = reach_of(m->device);
  if (!moves) {
    m->type = dea_model_find("3d");
    m->base.name = m->type->name;
    return DEA_OK;
  }
  if (m->type != dea_model_find("reduced")) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED,
                    "the simulated film moves by a monitor, or is no disc, which model reduced "
                    "knows: write 'sim: {model: reduced}'");
  }
  m->by_monitor = true;
  DEA_TRY(ctx, dea_model_create(ctx, m->type, m->design, m->device, &m->model));
  return DEA_CHAIN(ctx, find_motion(ctx, monitor, m));
}

static dea_status build(struct dea_context *ctx, bool moves, const char *monitor,
                        struct film_model *m)
{
  DEA_TRY(ctx, dea_device_build(ctx, m->design, &m->device));
  if (monitor != NULL || !m->device->disc) {
    return DEA_CHAIN(ctx, build_any(ctx, moves, monitor, m));
  }
  struct dea_device *device = m->device;
  if (!moves) { // in a check the film knows neither, and need not say so
    device->fibre_count = 0;
    device->gravity = DEA_GRAVITY_OFF;
  }
  m->base.material = device->film.name;
  m->base.frame_radius_m = device->frame_radius_m;
  m->base.fibre_tip_radius_m =
      device->fibre_count > 0 ? device->fibre_tip_radius_m : device->electrode_radius_m;
  return moves ? dea_model_create(ctx, m->type, m->design, device, &m->model)
               : m->type->create(ctx, device, NULL, &m->model);
}

static dea_status open_model(struct dea_context *ctx, const struct dea_bench_film *film,
                             const char *name, const char *monitor, struct dea_bench_model **out)
{
  const struct dea_model_type *type = dea_model_find(name != NULL ? name : "lumped");
  *out = NULL;
  if (type == NULL || type->advance == NULL) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "the simulated bench cannot use model '%s': it %s",
                    name, type == NULL ? "is not there" : "does not support transients");
  }
  struct film_model *m = dea_alloc(ctx, 1, sizeof *m);
  DEA_TRY_MEMORY(m != NULL);
  *m = (struct film_model){.base = {.type = &dea_film_of_design, .name = type->name},
                           .design = ((const struct film *)film)->design,
                           .type = type};
  dea_status status = build(ctx, name != NULL, monitor, m);
  DEA_TRY_ELSE(ctx, status, close_model(ctx, &m->base));
  *out = &m->base;
  return DEA_OK;
}

/* Of any device: the field that the film stands where it is nearest to that. */
static struct dea_bench_point complete_any(const struct film_model *m,
                                           const struct dea_load_point *point)
{
  const struct dea_material *film = film_of(m->device);
  struct dea_bench_point out = {.point = *point,
                                .breakdown_V_per_m = NAN,
                                .breakdown_probability_band = {NAN, NAN},
                                .leakage_s = INFINITY};
  if (film == NULL) {
    return out;
  }
  const double low = film->breakdown.law.low > 0 ? film->breakdown.law.low : 1;
  const double used = 1 - point->breakdown_margin; // of the field that it stands
  dea_breakdown_probability_band(&film->breakdown, point->breakdown_margin,
                                 out.breakdown_probability_band);
  out.breakdown_V_per_m = low * (used > 0 ? point->true_field_V_per_m / used : NAN);
  out.leakage_s = film->resistivity_ohm_m > 0
                      ? film->resistivity_ohm_m * DEA_EPSILON_0 * film->permittivity.at_rest
                      : (double)INFINITY;
  return out;
}

/* What the material makes of a point. */
static struct dea_bench_point complete(const struct film_model *m,
                                       const struct dea_load_point *point)
{
  if (!m->device->disc || isnan(point->electrode_stretch)) {
    return complete_any(m, point);
  }
  const struct dea_material *film = &m->device->film;
  double stretch = point->electrode_stretch * m->device->pre_stretch;
  double permittivity =
      DEA_EPSILON_0 * (film->permittivity.at_rest + film->permittivity.slope * (stretch - 1));
  const double low = film->breakdown.law.low; // of the values that sources give; 0: by hand
  double band[2];
  dea_breakdown_probability_band(&film->breakdown, point->breakdown_margin, band);
  return (struct dea_bench_point){
      .point = *point,
      .breakdown_probability_band = {band[0], band[1]},
      .breakdown_V_per_m = (low > 0 ? low : 1) * dea_breakdown_field(film, stretch),
      .leakage_s =
          film->resistivity_ohm_m > 0 ? film->resistivity_ohm_m * permittivity : (double)INFINITY,
  };
}

// At rest ----------------------------------------------------------------------------------------

static dea_status first_pull_in(void *user, const struct dea_event *event)
{
  double *pull_in_V = user;
  if (event->kind == DEA_EVENT_PULL_IN && isnan(*pull_in_V)) {
    *pull_in_V = event->point.voltage_V;
  }
  return DEA_OK;
}

static dea_status no_point(void *user, const struct dea_load_point *point)
{
  (void)user;
  (void)point;
  return DEA_OK;
}

static dea_status pull_in(struct dea_context *ctx, struct dea_bench_model *model, double *voltage_V)
{
  struct film_model *m = (struct film_model *)model;
  const struct dea_path_options options = {
      .max_stretch = dea_device_path_end(m->device, m->design),
      .max_voltage_V = INFINITY,
      .max_points = PATH_POINTS_MAX,
  };
  *voltage_V = NAN;
  if (m->model == NULL) { // `solve` says it
    return DEA_OK;
  }
  return dea_model_path(ctx, m->type, m->model, &options, no_point, first_pull_in, voltage_V);
}

/* By a model of its own. */
static dea_status solve(struct dea_context *ctx, struct dea_bench_model *model, double voltage_V,
                        struct dea_bench_point *out)
{
  const struct film_model *m = (struct film_model *)model;
  const struct dea_model_settings settings = dea_model_settings_of(m->design);
  struct dea_model *fresh;
  struct dea_load_point point;
  DEA_TRY(ctx, m->type->create(ctx, m->device, m->model == NULL ? &settings : NULL, &fresh));
  const dea_status status = m->type->solve(ctx, fresh, voltage_V, &point);
  m->type->destroy(ctx, fresh);
  if (status == DEA_OK) {
    *out = complete(m, &point);
  }
  return status;
}

// In time ----------------------------------------------------------------------------------------

static dea_status begin(struct dea_context *ctx, struct dea_bench_model *model,
                        const struct dea_bench_circuit *circuit, struct dea_bench_point *out)
{
  struct film_model *m = (struct film_model *)model;
  struct dea_load_point point;
  const struct dea_time_options options = {
      .circuit = {circuit->series_resistance_ohm, circuit->current_limit_A},
      .rho_inf = 0.8,
  };
  DEA_TRY(ctx, m->type->solve(ctx, m->model, 0, &point));
  DEA_TRY(ctx, m->type->begin(ctx, m->model, &options, &point));
  DEA_TRY(ctx, read_motion(ctx, m, &point));
  *out = complete(m, &point);
  return DEA_OK;
}

static dea_status advance(struct dea_context *ctx, struct dea_bench_model *model, double length_s,
                          double source_V, struct dea_bench_point *out, double *error)
{
  struct film_model *m = (struct film_model *)model;
  const struct dea_time_step step = {.length_s = length_s, .source_voltage_V = source_V};
  struct dea_load_point point;
  dea_status status = m->type->advance(ctx, m->model, &step, &point, error);
  status = status == DEA_OK ? read_motion(ctx, m, &point) : status;
  if (status == DEA_OK) {
    *out = complete(m, &point);
  }
  return status;
}

static void accept(struct dea_bench_model *model)
{
  struct film_model *m = (struct film_model *)model;
  m->type->accept(m->model);
}

static dea_status profile(struct dea_context *ctx, struct dea_bench_model *model,
                          struct dea_profile *out)
{
  struct film_model *m = (struct film_model *)model;
  *out = (struct dea_profile){.count = 0};
  return m->type->profile != NULL ? m->type->profile(ctx, m->model, out) : DEA_OK;
}

const struct dea_bench_film_type dea_film_of_design = {
    .read = read,
    .destroy = destroy,
    .model = model_name,
    .open = open_model,
    .close = close_model,
    .pull_in = pull_in,
    .solve = solve,
    .begin = begin,
    .advance = advance,
    .accept = accept,
    .profile = profile,
};
