#include "study/design_gradient.h"

#include "design/design_schema.h"
#include "device/geometry.h"
#include "result/columns.h"
#include "study/number_rows.h"
#include "study/part_numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double step_at_state = 1e-5, step_anew = 1e-4; // of a number, to either side
// Numbers ----------------------------------------------------------------------------------------

/* A length of the workshop in a film state. */
static double in_state(const struct dea_inplane_length *length, enum dea_film_state state,
                       double pre_stretch)
{
  double factor = state == length->state   ? 1
                  : state == DEA_STRETCHED ? pre_stretch
                                           : 1 / pre_stretch;
  return factor * length->length.si;
}

/* What the workshop says of a key; NAN: nothing. state: of a length in the plane. */
static double tolerance_of(const struct dea_design *design, const char *key, double value,
                           enum dea_film_state state)
{
  const struct dea_fabrication *f = &design->fabrication;
  double l = design->pre_stretch.si;
  if (strcmp(key, "film.thickness") == 0) {
    return f->tolerance.thickness.si * value;
  }
  if (strcmp(key, "pre_stretch") == 0) {
    return f->tolerance.pre_stretch.si;
  }
  if (strcmp(key, "frame.inner_diameter") == 0 || strcmp(key, "frame.inner_radius") == 0) {
    return (strcmp(key, "frame.inner_radius") == 0 ? 0.5 : 1) * f->tolerance.frame_m.si;
  }
  if (strcmp(key, "electrodes.diameter") == 0 || strcmp(key, "electrodes.radius") == 0) {
    return (strcmp(key, "electrodes.radius") == 0 ? 0.5 : 1) *
           in_state(&f->tolerance.electrode, state, l);
  }
  bool tip = strcmp(key, "fibres.length") == 0 || strcmp(key, "fibres.tip_radius") == 0 ||
             strcmp(key, "fibres.overlap") == 0;
  return tip ? in_state(&f->tolerance.fibre, state, l) : NAN;
}

/* What of a design its device does not depend on, or only by being turned. */
static bool is_aside(const char *key)
{
  static const char *const sections[] = {"compute.", "report.", "fabrication.", "drive.",
                                         "fibres.angle"};
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    if (strncmp(key, sections[i], strlen(sections[i])) == 0) {
      return strcmp(key, "compute.coverage") != 0;
    }
  }
  return false;
}

/* One key of the file, if it is such a number and has a value. */
static void add_key(const struct dea_design *design, const struct dea_record *record,
                    const struct dea_listed *item, struct dea_design_number *numbers, size_t *count)
{
  size_t offset;
  const struct dea_field *field = dea_record_find(record, item->path, &offset);
  if (field == NULL || !dea_field_varies(field) || field->list_max > 0 || is_aside(item->path)) {
    return;
  }
  const void *place = (const char *)design + offset;
  bool inplane = field->kind == DEA_FIELD_INPLANE;
  const struct dea_inplane_length *length = place;
  const struct dea_quantity *quantity = inplane ? &length->length : place;
  struct dea_design_number number = {
      .unit = field->unit,
      .of = DEA_NUMBER_OF_DESIGN,
      .scale = field->scale != 0 ? field->scale : 1,
      .offset = offset + (inplane ? offsetof(struct dea_inplane_length, length) : 0) +
                offsetof(struct dea_quantity, si)};
  if (item->origin != DEA_ABSENT && quantity->origin != DEA_ABSENT) {
    snprintf(number.key, sizeof number.key, "%.127s", item->path);
    number.value = quantity->si / number.scale;
    number.tolerance =
        tolerance_of(design, number.key, number.value, inplane ? length->state : DEA_STRETCHED);
    dea_number_add(&number, numbers, count);
  }
}

dea_status dea_design_numbers(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, double voltage_V,
                              struct dea_design_number *out, size_t *count)
{
  struct dea_design_schema schema;
  const struct dea_design_sections none = {0};
  const struct dea_design_number voltage = {
      .key = "voltage", .value = voltage_V, .unit = "V", .tolerance = NAN, .scale = 1};
  *count = 0;
  dea_number_add(&voltage, out, count);
  if (design->parts != NULL) {
    return dea_part_numbers(ctx, design, device, false, out, count);
  }
  dea_design_schema_fill(&none, &schema);
  for (size_t i = 0; i < design->values.count; i++) {
    add_key(design, &schema.disc.record, &design->values.items[i], out, count);
  }
  dea_numbers_of_materials(device, false, out, count);
  return DEA_OK;
}

static bool has_weight(const struct dea_device *device)
{
  return device->gravity != DEA_GRAVITY_OFF;
}

void dea_numbers_at_rest(const struct dea_device *device, struct dea_design_number *numbers,
                         size_t *count)
{
  size_t kept = 0;
  for (size_t i = 0; i < *count; i++) {
    const char *end = strrchr(numbers[i].key, '.');
    if (has_weight(device) || end == NULL || strcmp(end, DEA_DENSITY_KEY) != 0) {
      numbers[kept++] = numbers[i];
    }
  }
  *count = kept;
}

void dea_tip_numbers(const struct dea_pressed *pressed, struct dea_design_number *out,
                     size_t *count)
{
  static const struct {
    const char *key;
    size_t offset;
  } all[] = {{"compute.force.depth", offsetof(struct dea_pressed, depth_m)},
             {"compute.force.radius", offsetof(struct dea_pressed, tip.radius_m)},
             {"compute.force.edge_radius", offsetof(struct dea_pressed, tip.edge_radius_m)}};
  const size_t used = pressed->tip.shape == DEA_PROBE_FLAT ? 3 : 2;
  for (size_t i = 0; i < used; i++) {
    struct dea_design_number number = {.unit = "m",
                                       .tolerance = NAN,
                                       .of = DEA_NUMBER_OF_TIP,
                                       .offset = all[i].offset,
                                       .scale = 1};
    snprintf(number.key, sizeof number.key, "%s", all[i].key);
    memcpy(&number.value, (const char *)pressed + number.offset, sizeof number.value);
    dea_number_add(&number, out, count);
  }
}

// Changed devices --------------------------------------------------------------------------------

/* Room for changed devices. */
struct changed {
  struct dea_arena memory; // of all, and of what devices are built from
  struct dea_design *scratch;
  struct dea_device *devices;        // [2 number_count], with their layouts
  struct dea_pressed *pressed;       // [2 number_count]
  struct dea_design_change *changes; // [number_count]
};

/* The device with a value in place of the design's. DEA_E_DESIGN: there is none. scratch: the
 * design of a disc, which the device does not need. */
static dea_status change(struct dea_context *ctx, const struct dea_design *design,
                         const struct dea_device *device, const struct dea_design_number *number,
                         double value, struct dea_arena *memory, struct dea_design *scratch,
                         struct dea_device *out)
{
  double kept = number->scale * value;
  if (design->parts != NULL) {
    return DEA_CHAIN(ctx, dea_part_change(ctx, design, number, value, memory, out));
  }
  *out = *device;
  out->layout = NULL; // it would be another one
  if (number->of == DEA_NUMBER_OF_DESIGN) {
    *scratch = *design;
    memcpy((char *)scratch + number->offset, &kept, sizeof kept);
    dea_geometry_fill(scratch, out);
  } else {
    memcpy((char *)out + number->offset, &kept, sizeof kept);
  }
  return DEA_OK;
}

dea_status dea_device_change(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device,
                             const struct dea_design_number *number, double value,
                             struct dea_changed_device *out)
{
  *out = (struct dea_changed_device){.memory = {.ctx = ctx}};
  struct dea_design *scratch = dea_arena_alloc(&out->memory, 1, sizeof *scratch);
  DEA_TRY(ctx, dea_arena_status(&out->memory));
  DEA_TRY(ctx, change(ctx, design, device, number, value, &out->memory, scratch, &out->device));
  if (number->of == DEA_NUMBER_OF_DESIGN) {
    DEA_TRY(ctx, dea_geometry_check(ctx, scratch, &out->device));
  }
  return DEA_OK;
}

void dea_changed_device_free(struct dea_changed_device *changed)
{
  dea_layout_destroy(changed->memory.ctx, changed->device.layout);
  dea_arena_free(&changed->memory);
}

/* One side of a change of a number; false in *there where no device is like that. */
static dea_status build_side(struct dea_context *ctx, const struct dea_design_gradient *ask,
                             size_t i, size_t side, double value, struct changed *all, bool *there)
{
  const struct dea_design_number *number = &ask->numbers[i];
  struct dea_design_change *out = &all->changes[i];
  out->device[side] = ask->device;
  out->voltage_V[side] = ask->voltage_V;
  *there = true;
  if (number->of == DEA_NUMBER_OF_TIP) {
    struct dea_pressed *pressed = &all->pressed[2 * i + side];
    *pressed = *ask->pressed;
    memcpy((char *)pressed + number->offset, &value, sizeof value);
    out->pressed[side] = pressed;
  } else if (strcmp(number->key, "voltage") == 0) {
    out->voltage_V[side] = value;
  } else {
    const dea_status status = change(ctx, ask->design, ask->device, number, value, &all->memory,
                                     all->scratch, &all->devices[2 * i + side]);
    *there = status == DEA_OK;
    DEA_TRY(ctx, status == DEA_E_DESIGN ? DEA_OK : status);
    out->device[side] = *there ? &all->devices[2 * i + side] : ask->device;
  }
  return DEA_OK;
}

/* To both sides, or to the one where there is a device: a monitor may stand at the edge of its ply,
 * which cannot be shorter. */
static dea_status build_changes(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                struct changed *all)
{
  double share = ask->type->gradient != NULL ? step_at_state : step_anew;
  for (size_t i = 0; i < ask->number_count; i++) {
    const struct dea_design_number *number = &ask->numbers[i];
    const double step = share * (number->reach > 0 ? number->reach : number->value);
    size_t sides = 0;
    for (size_t k = 0; k < 2; k++) {
      bool there;
      DEA_TRY(ctx,
              build_side(ctx, ask, i, k, number->value + (k == 0 ? -step : step), all, &there));
      sides += there ? 1 : 0;
    }
    all->changes[i].width = (double)sides * step;
    if (sides == 0) {
      all->changes[i].device[0] = NULL;
    }
  }
  return DEA_OK;
}

/* Makes the changed devices, in room that is freed by free_changes also after a failure. */
static dea_status begin_changes(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                struct changed *all)
{
  *all = (struct changed){.memory = {.ctx = ctx}};
  all->devices = dea_arena_alloc(&all->memory, 2 * ask->number_count, sizeof *all->devices);
  all->pressed = dea_arena_alloc(&all->memory, 2 * ask->number_count, sizeof *all->pressed);
  all->scratch = dea_arena_alloc(&all->memory, 1, sizeof *all->scratch);
  all->changes = dea_arena_alloc(&all->memory, ask->number_count, sizeof *all->changes);
  DEA_TRY(ctx, dea_arena_status(&all->memory));
  return DEA_CHAIN(ctx, build_changes(ctx, ask, all));
}

static void free_changes(struct dea_context *ctx, const struct dea_design_gradient *ask,
                         struct changed *all)
{
  for (size_t i = 0; all->devices != NULL && i < 2 * ask->number_count; i++) {
    dea_layout_destroy(ctx, all->devices[i].layout);
  }
  dea_arena_free(&all->memory);
}

dea_status dea_design_gradient_find(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                    double *slopes)
{
  struct changed all;
  const struct dea_model_settings settings = dea_model_settings_of(ask->design);
  dea_status status = begin_changes(ctx, ask, &all);
  if (status == DEA_OK) {
    const struct dea_gradient_request question = {.changes = all.changes,
                                                  .change_count = ask->number_count,
                                                  .columns = ask->columns,
                                                  .column_count = ask->column_count,
                                                  .modes = ask->modes,
                                                  .monitors = ask->monitors,
                                                  .monitor_count = ask->monitor_count,
                                                  .motions = ask->motions,
                                                  .holds_stretch = ask->stretch > 0,
                                                  .stretch = ask->stretch};
    status = dea_model_gradient(ctx, ask->type, ask->model, &settings, &question, slopes);
  }
  free_changes(ctx, ask, &all);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_design_gradient_critical(struct dea_context *ctx,
                                        const struct dea_design_gradient *ask,
                                        const struct dea_critical *critical, double *slopes)
{
  struct changed all;
  dea_status status = begin_changes(ctx, ask, &all);
  if (status == DEA_OK) {
    status = dea_critical_slopes(ctx, critical, all.changes, ask->number_count, slopes);
  }
  for (size_t i = 0; i < ask->number_count && status == DEA_OK; i++) {
    slopes[i] = strcmp(ask->numbers[i].key, "voltage") == 0 ? NAN : slopes[i];
  }
  free_changes(ctx, ask, &all);
  return DEA_CHAIN(ctx, status);
}
