/* The models lumped and axisymmetric for the page of a report, in WebAssembly: numbers in and out
 * through arrays of this module's memory, one device and one model at a time. */
#include "model/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const struct dea_model_type dea_model_lumped, dea_model_axisymmetric; // model_list.h

#define EXPORT(name) __attribute__((export_name(#name), used))

// X(number of the device; its meaning stands in device/device.h and material/material.h)
#define INPUT_LIST(X)                                                                              \
  X(film_thickness_unstretched_m)                                                                  \
  X(pre_stretch)                                                                                   \
  X(frame_radius_m)                                                                                \
  X(electrode_radius_m)                                                                            \
  X(coverage)                                                                                      \
  X(fibre_count)                                                                                   \
  X(fibre_tip_radius_m)                                                                            \
  X(electrode_thickness_m)                                                                         \
  X(permittivity)                                                                                  \
  X(permittivity_slope)                                                                            \
  X(breakdown_V_per_m)                                                                             \
  X(breakdown_exponent)                                                                            \
  X(breakdown_thickness_exponent)                                                                  \
  X(breakdown_thickness_m)                                                                         \
  X(breakdown_shape)                                                                               \
  X(breakdown_area_m2)                                                                             \
  X(fibre_angle_rad)

enum {
#define INPUT_INDEX(name) IN_##name,
  INPUT_LIST(INPUT_INDEX)
#undef INPUT_INDEX
      IN_FILM_PARAM,
  IN_ELECTRODE_PARAM = IN_FILM_PARAM + DEA_LAW_PARAM_MAX,
  INPUTS = IN_ELECTRODE_PARAM + DEA_LAW_PARAM_MAX,
  TEXT_SIZE = 64,
  POINTS_MAX = 3000,
  EVENTS_MAX = 64,
#define COLUMN_ONE(member, si, display, factor, header, meaning) +1
  COLUMNS = 1 DEA_LOAD_POINT_LIST(COLUMN_ONE), // the last one: stable
#undef COLUMN_ONE
};

static const char names[] = "" // of the inputs, then of the columns
#define INPUT_NAME(name) #name " "
    INPUT_LIST(INPUT_NAME) "film_param electrode_param\n"
#define COLUMN_NAME(member, si, display, factor, header, meaning) #member " "
    DEA_LOAD_POINT_LIST(COLUMN_NAME) "stable";

static double inputs[INPUTS];
static char film_law[TEXT_SIZE], electrode_law[TEXT_SIZE];
static double points[POINTS_MAX][COLUMNS], events[EVENTS_MAX][COLUMNS + 1]; // kind in front
static size_t point_count, event_count;
static struct dea_context *ctx;
static struct dea_device device;
static const struct dea_model_type *type;
static struct dea_model *model;

EXPORT(explorer_names) const char *explorer_names(void)
{
  return names;
}

EXPORT(explorer_inputs) double *explorer_inputs(void)
{
  return inputs;
}

EXPORT(explorer_law) char *explorer_law(int of_electrode)
{
  return of_electrode ? electrode_law : film_law;
}

EXPORT(explorer_points) double *explorer_points(void)
{
  return points[0];
}

EXPORT(explorer_events) double *explorer_events(void)
{
  return events[0];
}

EXPORT(explorer_event_count) size_t explorer_event_count(void)
{
  return event_count;
}

/* What went wrong last; "" for nothing. */
EXPORT(explorer_message) const char *explorer_message(void)
{
  return ctx != NULL ? dea_context_message(ctx) : "out of memory";
}

static struct dea_material make_film(void)
{
  struct dea_material m = {
      .law = dea_law_find(film_law),
      .fibre_angle_rad = inputs[IN_fibre_angle_rad],
      .permittivity = {inputs[IN_permittivity], inputs[IN_permittivity_slope]},
      .breakdown = {.known = inputs[IN_breakdown_V_per_m] > 0,
                    .exponent_known = true,
                    .law = {.at_rest_V_per_m = inputs[IN_breakdown_V_per_m],
                            .exponent = inputs[IN_breakdown_exponent],
                            .thickness_exponent = inputs[IN_breakdown_thickness_exponent],
                            .thickness_m = inputs[IN_breakdown_thickness_m],
                            .shape = inputs[IN_breakdown_shape],
                            .area_m2 = inputs[IN_breakdown_area_m2],
                            .electrode_factor = 1}},
  };
  memcpy(m.param, inputs + IN_FILM_PARAM, sizeof m.param);
  strcpy(m.name, "film");
  return m;
}

/* The devices here are discs: nothing of layouts is linked. */
dea_status dea_device_require_disc(struct dea_context *context, const struct dea_device *of)
{
  (void)context;
  (void)of;
  return DEA_OK;
}

static void fill_device(void)
{
  double l_pre = inputs[IN_pre_stretch];
  device = (struct dea_device){
      .disc = true,
      .film = make_film(),
      .film_thickness_unstretched_m = inputs[IN_film_thickness_unstretched_m],
      .pre_stretch = l_pre,
      .film_thickness_m = inputs[IN_film_thickness_unstretched_m] / (l_pre * l_pre),
      .frame_radius_m = inputs[IN_frame_radius_m],
      .electrode_radius_m = inputs[IN_electrode_radius_m],
      .electrode_thickness_m = inputs[IN_electrode_thickness_m],
      .coverage = inputs[IN_coverage],
      .fibre_count = (int)inputs[IN_fibre_count],
      .fibre_tip_radius_m = inputs[IN_fibre_tip_radius_m],
  };
  dea_device_fit_breakdown(&device);
  device.fibre_length_m = device.frame_radius_m - device.fibre_tip_radius_m;
  device.fibre_overlap_m = device.electrode_radius_m - device.fibre_tip_radius_m;
  device.electrode.law = dea_law_find(electrode_law);
  memcpy(device.electrode.param, inputs + IN_ELECTRODE_PARAM, sizeof device.electrode.param);
}

/* Makes the model (0 lumped, 1 axisymmetric) of the inputs in place of the last one; a status. */
EXPORT(explorer_make) int explorer_make(int axisymmetric)
{
  if (model != NULL) {
    type->destroy(ctx, model);
    model = NULL;
  }
  if (ctx == NULL && dea_context_create(NULL, &ctx) != DEA_OK) {
    return DEA_E_MEMORY;
  }
  dea_context_clear(ctx);
  dea_finding_clear(ctx);
  fill_device();
  type = axisymmetric ? &dea_model_axisymmetric : &dea_model_lumped;
  return (int)type->create(ctx, &device, NULL, &model);
}

static void put(const struct dea_load_point *point, double *out)
{
#define COLUMN_PUT(member, si, display, factor, header, meaning) *out++ = point->member;
  DEA_LOAD_POINT_LIST(COLUMN_PUT)
#undef COLUMN_PUT
  *out = point->stable;
}

static dea_status take_point(void *user, const struct dea_load_point *point)
{
  (void)user;
  put(point, points[point_count++]);
  return DEA_OK;
}

static dea_status take_event(void *user, const struct dea_event *event)
{
  (void)user;
  if (event_count < EVENTS_MAX) {
    events[event_count][0] = (double)event->kind;
    put(&event->point, events[event_count++] + 1);
  }
  return DEA_OK;
}

/* The path up to a voltage or a total stretch, into points and events; number of points. */
EXPORT(explorer_path) size_t explorer_path(double max_voltage_V, double max_stretch)
{
  const struct dea_path_options options = {max_stretch, max_voltage_V, POINTS_MAX};
  point_count = event_count = 0;
  if (model != NULL) {
    type->path(ctx, model, &options, take_point, take_event, NULL); // keeps what came before an end
  }
  return point_count;
}

/* The stable equilibrium that follows the last one solved, into the first point; a status. */
EXPORT(explorer_solve) int explorer_solve(double voltage_V)
{
  struct dea_load_point point;
  if (model == NULL) {
    return DEA_E_ARGUMENT;
  }
  dea_status status = type->solve(ctx, model, voltage_V, &point);
  if (status == DEA_OK) {
    put(&point, points[0]);
  }
  return (int)status;
}
