/* Devices of the general form, made by hand. */
#pragma once

#include "device/device.h"
#include "model/model.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static const struct dea_location nowhere = {0};

static inline struct dea_material silicone(void)
{
  struct dea_material m = {
      .name = "silicone", .law = dea_law_find("yeoh"), .param = {178.4e3, -6e3, 4.2e3}};
  m.permittivity.at_rest = 2.8;
  m.density_kg_per_m3 = 1080;
  return m;
}

/* Lists of a layout, with room for what the tests need. */
static inline struct dea_device *device_new(void)
{
  struct dea_device *device = dea_alloc(ctx, 1, sizeof *device);
  assert_non_null(device);
  assert_int_equal(dea_layout_create(ctx, &device->layout), DEA_OK);
  struct dea_layout *l = device->layout;
  enum { ROOM = 8 };
  l->regions = dea_arena_alloc(&l->memory, ROOM, sizeof *l->regions);
  l->plies = dea_arena_alloc(&l->memory, ROOM, sizeof *l->plies);
  l->electrodes = dea_arena_alloc(&l->memory, ROOM, sizeof *l->electrodes);
  l->channels = dea_arena_alloc(&l->memory, ROOM, sizeof *l->channels);
  l->supports = dea_arena_alloc(&l->memory, ROOM, sizeof *l->supports);
  l->bodies = dea_arena_alloc(&l->memory, ROOM, sizeof *l->bodies);
  l->springs = dea_arena_alloc(&l->memory, ROOM, sizeof *l->springs);
  l->pressures = dea_arena_alloc(&l->memory, ROOM, sizeof *l->pressures);
  l->monitors = dea_arena_alloc(&l->memory, ROOM, sizeof *l->monitors);
  assert_false(l->memory.failed);
  l->channels[0].name = "ground";
  l->channels[1] = (struct dea_layout_channel){.name = "drive", .ratio = 1};
  l->channel_count = 2;
  return device;
}

static inline struct dea_region *add_region(struct dea_device *device, const char *name)
{
  struct dea_layout_region *region = &device->layout->regions[device->layout->region_count++];
  region->name = name;
  region->region.ctx = ctx;
  return &region->region;
}

static inline size_t add_rectangle(struct dea_device *device, const char *name, double x_m,
                                   double y_m, double width_m, double height_m)
{
  struct dea_vertex corners[4] = {{.x_m = x_m, .y_m = y_m},
                                  {.x_m = x_m + width_m, .y_m = y_m},
                                  {.x_m = x_m + width_m, .y_m = y_m + height_m},
                                  {.x_m = x_m, .y_m = y_m + height_m}};
  dea_region_add(add_region(device, name), corners, 4);
  return device->layout->region_count - 1;
}

static inline void add_film(struct dea_device *device, size_t region, double l1, double l2)
{
  struct dea_layout *l = device->layout;
  l->plies[l->ply_count++] = (struct dea_layout_ply){.name = "film",
                                                     .material = silicone(),
                                                     .region = region,
                                                     .thickness_m = 100e-6 / (l1 * l2),
                                                     .thickness_unstretched_m = 100e-6,
                                                     .pre_stretch = {l1, l2}};
}

static inline void add_electrode(struct dea_device *device, size_t ply, bool top, size_t region,
                                 size_t channel)
{
  struct dea_layout *l = device->layout;
  l->electrodes[l->electrode_count++] = (struct dea_layout_electrode){
      .name = "electrode", .region = region, .ply = ply, .top = top, .channel = channel};
}

/* A ground and a driven electrode on both sides of a ply. */
static inline void add_electrodes(struct dea_device *device, size_t ply, size_t region)
{
  add_electrode(device, ply, false, region, 0);
  add_electrode(device, ply, true, region, 1);
}

/* Components (1: x, 2: y, 4: z) of a region's edge, or of its part within another region, stay. */
static inline void hold_edge(struct dea_device *device, size_t region, size_t within,
                             int components)
{
  struct dea_layout *l = device->layout;
  l->supports[l->support_count++] = (struct dea_layout_support){
      .region = region, .edge = true, .within = within, .components = components};
}

/* All of a region stays flat, and may become thinner. */
static inline void hold_flat(struct dea_device *device, size_t region)
{
  struct dea_layout *l = device->layout;
  l->supports[l->support_count++] = (struct dea_layout_support){
      .region = region, .within = DEA_LAYOUT_NONE, .components = 4, .hinged = true};
}

static inline void add_point(struct dea_device *device, const char *name, double x_m, double y_m)
{
  struct dea_layout *l = device->layout;
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = name, .kind = DEA_MONITOR_POINT, .at_m = {{x_m, y_m}}};
}

/* A monitor of all of the first ply on the first region. */
static inline void add_film_monitor(struct dea_device *device)
{
  struct dea_layout *l = device->layout;
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = "film", .kind = DEA_MONITOR_REGION};
}

/* Annulus of film with a hub that is held and two electrodes (radii 5 and 20 mm, pre-stretch 1.2);
 * a monitor of the hub. */
static inline struct dea_device *cone_new(void)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  struct dea_region *film = add_region(device, "film");
  dea_region_add_circle(film, 0, 0, 20e-3, false, nowhere);
  dea_region_add_circle(film, 0, 0, 5e-3, true, nowhere);
  dea_region_add_circle(add_region(device, "hub"), 0, 0, 5e-3, false, nowhere);
  dea_region_add_circle(add_region(device, "frame"), 0, 0, 20e-3, false, nowhere);
  add_film(device, 0, 1.2, 1.2);
  add_electrodes(device, 0, 0);
  hold_edge(device, 2, DEA_LAYOUT_NONE, 7);
  l->bodies[l->body_count++] = (struct dea_layout_body){.name = "hub", .region = 1};
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = "hub", .kind = DEA_MONITOR_BODY, .body = 0};
  return device;
}

/* A disc of film in a round frame and electrodes on a smaller one; a monitor of their edge. */
static inline struct dea_device *disc_new(double frame_m, double active_m, double stretch)
{
  struct dea_device *device = device_new();
  dea_region_add_circle(add_region(device, "film"), 0, 0, frame_m, false, nowhere);
  dea_region_add_circle(add_region(device, "active"), 0, 0, active_m, false, nowhere);
  add_film(device, 0, stretch, stretch);
  add_electrodes(device, 0, 1);
  hold_edge(device, 0, DEA_LAYOUT_NONE, 7);
  add_point(device, "edge", active_m, 0);
  return device;
}

/* Model 3d of a device of either form. */
static inline struct dea_model *layout_model(const struct dea_device *device,
                                             const struct dea_model_settings *settings)
{
  struct dea_model *model;
  dea_status status = dea_model_find("3d")->create(ctx, device, settings, &model);
  if (status != DEA_OK) {
    print_message("%s\n", dea_context_message(ctx));
  }
  assert_int_equal(status, DEA_OK);
  return model;
}

/* What is observed at a voltage. */
static inline struct dea_observation observed_at(struct dea_model *model, double voltage_V,
                                                 struct dea_load_point *point)
{
  struct dea_observation seen;
  assert_int_equal(dea_model_find("3d")->solve(ctx, model, voltage_V, point), DEA_OK);
  assert_int_equal(dea_model_find("3d")->observe(ctx, model, &seen), DEA_OK);
  return seen;
}
