#include "study/part_numbers.h"

#include "design/schema_parts.h"
#include "study/number_rows.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAMELESS = -1 };

/* Lists of parts with numbers, in struct dea_parts. */
static const struct list {
  const char *key;
  size_t items, count, size;
  int name; // place of the label in an item
} lists[] = {
#define LIST(word, type, items, counter, label)                                                    \
  {                                                                                                \
    word, offsetof(struct dea_parts, items), offsetof(struct dea_parts, counter),                  \
        sizeof(struct type), (label)                                                               \
  }
    LIST("plies", dea_parts_ply, plies, ply_count, offsetof(struct dea_parts_ply, name)),
    LIST("channels", dea_parts_channel, channels, channel_count,
         offsetof(struct dea_parts_channel, name)),
    LIST("supports", dea_parts_support, supports, support_count, NAMELESS),
    LIST("bodies", dea_parts_body, bodies, body_count, offsetof(struct dea_parts_body, name)),
    LIST("springs", dea_parts_spring, springs, spring_count, NAMELESS),
    LIST("pressures", dea_parts_pressure, pressures, pressure_count, NAMELESS),
    LIST("shapes", dea_parts_shape, shapes, shape_count, offsetof(struct dea_parts_shape, name)),
#undef LIST
};
enum {
  LISTS = sizeof lists / sizeof lists[0],
  PLIES = 0,
  SHAPES = LISTS - 1
}; // these go by their kinds

static const struct dea_record *record_of(const struct list *list)
{
  size_t i = 0;
  while (strcmp(dea_parts_fields[i].key, list->key) != 0) {
    i++;
  }
  return dea_parts_fields[i].record;
}

// Keys of the file --------------------------------------------------------------------------------

/* The numbers of a field of an item: one, or those of its list. size_m: of a shape; 0: of none. */
static void add_field(size_t at, size_t item, const char *base, const struct dea_field *field,
                      double size_m, struct dea_design_number *out, size_t *count)
{
  static const double reach = 0.1; // of its size or of a radian, where a shape's number is smaller
  const struct list *list = &lists[at];
  size_t own = 1;
  char name[DEA_MATERIAL_PREFIX_SIZE + 8];
  if (!dea_field_varies(field)) {
    return;
  }
  if (field->list_max > 0) {
    memcpy(&own, base + field->count_offset, sizeof own);
  }
  if (list->name == NAMELESS) {
    snprintf(name, sizeof name, "%s[%zu]", list->key, item);
  } else {
    const struct dea_label *label = (const void *)(base + list->name);
    snprintf(name, sizeof name, "%.12s.%.80s", list->key, label->text);
  }
  for (size_t k = 0; k < own; k++) {
    const size_t offset = field->offset + k * sizeof(struct dea_quantity);
    const struct dea_quantity *value = (const void *)(base + offset);
    struct dea_design_number number = {.unit = field->unit,
                                       .value = value->origin != DEA_ABSENT ? value->si : NAN,
                                       .tolerance = NAN,
                                       .of = DEA_NUMBER_OF_PART,
                                       .list = at,
                                       .item = item,
                                       .offset = offset + offsetof(struct dea_quantity, si),
                                       .scale = 1};
    if (at == SHAPES) {
      number.reach = fmax(fabs(number.value), reach * (strcmp(field->unit, "m") == 0 ? size_m : 1));
    }
    snprintf(number.key, sizeof number.key, "%s.%.18s", name, field->key);
    if (own > 1) {
      const size_t length = strlen(number.key);
      snprintf(number.key + length, sizeof number.key - length, "[%zu]", k);
    }
    dea_number_add(&number, out, count);
  }
}

// Shapes -----------------------------------------------------------------------------------------

static const struct dea_record *record_of_shape(const struct dea_shape_schema *schema,
                                                const struct dea_parts_shape *shape)
{
  size_t kind = 0;
  while (schema->make[kind] != shape->make ||
         (shape->make == DEA_MAKE_PRIMITIVE && schema->type[kind] != shape->type)) {
    kind++;
  }
  return &schema->record[kind];
}

/* Whether a field of a shape is one that the file says nothing of, and so 0. */
static bool is_default(const struct dea_parts_shape *shape, const struct dea_field *field)
{
  const struct dea_quantity *value = (const void *)((const char *)shape + field->offset);
  return value->origin == DEA_DEFAULT && value->si == 0;
}

static dea_status add_shapes(struct dea_context *ctx, const struct dea_parts *parts,
                             const struct dea_device *device, bool all,
                             struct dea_design_number *out, size_t *count)
{
  struct dea_shape_schema *schema = dea_alloc(ctx, 1, sizeof *schema);
  DEA_TRY_MEMORY(schema != NULL);
  dea_shape_schema_fill(schema);
  for (size_t i = 0; i < parts->shape_count; i++) {
    const struct dea_parts_shape *shape = &parts->shapes[i];
    const struct dea_record *record = record_of_shape(schema, shape);
    const double size_m = dea_region_size_m(&device->layout->regions[i].region);
    for (size_t f = 0; f < record->field_count; f++) {
      const struct dea_field *field = &record->fields[f];
      if (dea_field_varies(field) && (all || field->list_max > 0 || !is_default(shape, field))) {
        add_field(SHAPES, i, (const char *)shape, field, size_m, out, count);
      }
    }
  }
  dea_free(ctx, schema);
  return DEA_OK;
}

/* What the workshop says of a number of a ply, of which the film may be stretched; NAN: nothing. */
static double tolerance_of(const struct dea_design *design, const struct dea_design_number *number)
{
  const struct dea_parts_ply *ply = &design->parts->plies[number->item];
  const size_t si = offsetof(struct dea_quantity, si);
  const size_t stretch = offsetof(struct dea_parts_ply, pre_stretch) + si;
  bool stretched = false;
  for (size_t k = 0; k < ply->pre_stretch_count; k++) {
    stretched = stretched || ply->pre_stretch[k].si != 1;
  }
  if (number->offset == offsetof(struct dea_parts_ply, thickness_m) + si) {
    return design->fabrication.tolerance.thickness.si * number->value;
  }
  return stretched && number->offset >= stretch &&
                 number->offset < stretch + sizeof ply->pre_stretch
             ? design->fabrication.tolerance.pre_stretch.si
             : NAN;
}

/* Whether a number says something of this device: what is outside does of enclosed gas only. */
static bool is_used(const struct list *list, const char *item, const struct dea_field *field)
{
  const struct dea_parts_pressure *pressure = (const void *)item;
  return list->items != offsetof(struct dea_parts, pressures) ||
         field->offset != offsetof(struct dea_parts_pressure, ambient_Pa) ||
         pressure->gas_m3.origin != DEA_ABSENT;
}

dea_status dea_part_numbers(struct dea_context *ctx, const struct dea_design *design,
                            const struct dea_device *device, bool all,
                            struct dea_design_number *out, size_t *count)
{
  for (size_t l = 0; l < SHAPES; l++) {
    const struct list *list = &lists[l];
    const struct dea_record *record = record_of(list);
    const char *items;
    size_t item_count;
    memcpy(&items, (const char *)design->parts + list->items, sizeof items);
    memcpy(&item_count, (const char *)design->parts + list->count, sizeof item_count);
    for (size_t i = 0; i < item_count; i++) {
      for (size_t f = 0; f < record->field_count; f++) {
        if (is_used(list, items + i * list->size, &record->fields[f])) {
          add_field(l, i, items + i * list->size, &record->fields[f], 0, out, count);
        }
      }
    }
  }
  for (size_t i = 0; i < *count; i++) {
    if (out[i].of == DEA_NUMBER_OF_PART && out[i].list == PLIES) {
      out[i].tolerance = tolerance_of(design, &out[i]);
    }
  }
  dea_numbers_of_materials(device, true, out, count);
  return DEA_CHAIN(ctx, add_shapes(ctx, design->parts, device, all, out, count));
}

// Changed devices --------------------------------------------------------------------------------

/* A copy of the parts in which a number of the file is another one. */
static dea_status change_part(struct dea_context *ctx, const struct dea_design_number *number,
                              double value, struct dea_arena *scratch, struct dea_parts *parts)
{
  const struct list *list = &lists[number->list];
  char *items, *copy;
  size_t count;
  memcpy(&items, (char *)parts + list->items, sizeof items);
  memcpy(&count, (char *)parts + list->count, sizeof count);
  copy = dea_arena_alloc(scratch, count, list->size);
  if (copy == NULL) {
    return dea_context_status(ctx);
  }
  memcpy(copy, items, count * list->size);
  memcpy(copy + number->item * list->size + number->offset, &value, sizeof value);
  memcpy((char *)parts + list->items, &copy, sizeof copy);
  return DEA_OK;
}

dea_status dea_part_change(struct dea_context *ctx, const struct dea_design *design,
                           const struct dea_design_number *number, double value,
                           struct dea_arena *scratch, struct dea_device *out)
{
  struct dea_design changed = *design;
  struct dea_parts parts = *design->parts;
  struct dea_device *device;
  changed.parts = &parts;
  *out = (struct dea_device){.layout = NULL};
  if (number->of == DEA_NUMBER_OF_PART) {
    DEA_TRY(ctx, change_part(ctx, number, value, scratch, &parts));
  }
  const size_t errors = dea_finding_trial_begin(ctx); // what there is to say has been said
  const dea_status status = dea_device_build(ctx, &changed, &device);
  dea_finding_trial_end(ctx, errors);
  DEA_TRY(ctx, status);
  *out = *device;
  dea_free(ctx, device); // its layout is that of *out
  if (number->of == DEA_NUMBER_OF_PLY) {
    memcpy((char *)&out->layout->plies[number->item].material + number->offset, &value,
           sizeof value);
    DEA_TRY(ctx, dea_device_find_disc(ctx, out));
  }
  return DEA_OK;
}
