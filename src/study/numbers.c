#include "study/numbers.h"

#include "design/design_schema.h"
#include "design/schema_parts.h"
#include "device/geometry.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Where numbers are gathered. */
struct list {
  const struct dea_design *design;
  const struct dea_device *device;
  struct dea_design_number *numbers; // [DEA_NUMBERS_MAX]
  size_t *count;
  bool all;  // those that are 0 too
  bool full; // there were more
};

static void add(struct list *list, const struct dea_design_number *number)
{
  if (isnan(number->value) || (number->value == 0 && !(number->reach > 0) && !list->all)) {
    return;
  }
  list->full = list->full || *list->count == DEA_NUMBERS_MAX;
  if (!list->full) {
    list->numbers[(*list->count)++] = *number;
  }
}

// Materials --------------------------------------------------------------------------------------

/* Materials that have a number. */
enum has { ANY, LINEAR, DIELECTRIC };

#define AT(member) offsetof(struct dea_material, member)

/* All but parameters of laws and branches. */
static const struct row {
  const char *key, *unit;
  size_t offset;
  double low, high;
  bool zero; // it may be 0; else that says that it is not known
  enum has has;
} rows[] = {
    {"young_modulus", "Pa", AT(young_modulus_Pa), 0, INFINITY, false, LINEAR},
    {"poisson_ratio", "1", AT(poisson_ratio), -1, 0.5, true, LINEAR},
    {"permittivity.at_rest", "1", AT(permittivity.at_rest), 1, INFINITY, false, DIELECTRIC},
    {"permittivity.slope", "1", AT(permittivity.slope), -INFINITY, INFINITY, true, DIELECTRIC},
    {"density", "kg/m^3", AT(density_kg_per_m3), 0, INFINITY, false, ANY},
};

struct dea_material *dea_material_at(struct dea_device *device, size_t material)
{
  return material == DEA_OF_FILM         ? &device->film
         : material == DEA_OF_ELECTRODES ? &device->electrode
         : material == DEA_OF_FIBRES     ? &device->fibre
                                         : &device->layout->plies[material - DEA_OF_PLIES].material;
}

const struct dea_material *dea_material_of(const struct dea_device *device, size_t material)
{
  return dea_material_at((struct dea_device *)device, material);
}

void dea_material_prefix(const struct dea_device *device, size_t material,
                         char out[DEA_MATERIAL_PREFIX_SIZE])
{
  static const char *const prefixes[] = {"film", "electrodes", "fibres"};
  if (material < DEA_OF_PLIES) {
    snprintf(out, DEA_MATERIAL_PREFIX_SIZE, "%s", prefixes[material]);
  } else {
    snprintf(out, DEA_MATERIAL_PREFIX_SIZE, "plies.%.80s",
             device->layout->plies[material - DEA_OF_PLIES].name);
  }
}

/* Of a disc's own materials. */
static bool is_there(const struct dea_device *device, size_t material)
{
  return material == DEA_OF_ELECTRODES ? device->electrode_thickness_m > 0
         : material == DEA_OF_FIBRES   ? device->fibre_count > 0
                                       : material == DEA_OF_FILM;
}

static bool is_dielectric(const struct dea_device *device, size_t material)
{
  return material < DEA_OF_PLIES
             ? material == DEA_OF_FILM
             : dea_layout_is_dielectric(device->layout, material - DEA_OF_PLIES);
}

/* A number of a material whose key ends in its two names: "law." and "c1". */
static struct dea_design_number of_material(const struct dea_device *device, size_t material,
                                            const char *name, const char *param, size_t offset)
{
  char prefix[DEA_MATERIAL_PREFIX_SIZE];
  struct dea_design_number out = {.tolerance = NAN,
                                  .of = DEA_NUMBER_OF_MATERIAL,
                                  .item = material,
                                  .offset = offset,
                                  .scale = 1};
  dea_material_prefix(device, material, prefix);
  snprintf(out.key, sizeof out.key, "%s.%.20s%.15s", prefix, name, param);
  memcpy(&out.value, (const char *)dea_material_of(device, material) + offset, sizeof out.value);
  return out;
}

static void add_branches(struct list *list, size_t material)
{
  for (size_t k = 0; k < dea_material_of(list->device, material)->branch_count; k++) {
    const size_t offset = AT(branches) + k * sizeof(struct dea_branch);
    for (size_t time = 0; time < 2; time++) {
      char name[32];
      snprintf(name, sizeof name, "branch.%zu.", k + 1);
      struct dea_design_number number =
          of_material(list->device, material, name, time ? "time" : "modulus",
                      offset + (time ? offsetof(struct dea_branch, time_s)
                                     : offsetof(struct dea_branch, modulus_Pa)));
      number.unit = time ? "s" : "Pa";
      number.high = INFINITY;
      add(list, &number);
    }
  }
}

static void add_material(struct list *list, size_t i)
{
  const struct dea_law *law = dea_material_of(list->device, i)->law;
  for (size_t k = 0; law != NULL && k < law->param_count; k++) {
    const struct dea_law_param *param = &law->params[k];
    struct dea_design_number number =
        of_material(list->device, i, "law.", param->key, AT(param) + k * sizeof(double));
    number.unit = param->unit;
    number.low = param->min;
    number.high = param->max;
    add(list, &number);
  }
  for (size_t k = 0; k < DEA_COUNT(rows); k++) {
    const struct row *row = &rows[k];
    struct dea_design_number number = of_material(list->device, i, row->key, "", row->offset);
    const bool has = row->has == ANY || (row->has == LINEAR && law == NULL) ||
                     (row->has == DIELECTRIC && is_dielectric(list->device, i));
    number.unit = row->unit;
    number.low = row->low;
    number.high = row->high;
    if (has && (number.value != 0 || row->zero)) {
      add(list, &number);
    }
  }
  if (list->all) {
    add_branches(list, i);
  }
}

static void add_materials(struct list *list)
{
  const bool plies = list->design->parts != NULL;
  const size_t end = DEA_OF_PLIES + (plies ? list->device->layout->ply_count : 0);
  for (size_t i = plies ? DEA_OF_PLIES : 0; i < end; i++) {
    if (plies || is_there(list->device, i)) {
      add_material(list, i);
    }
  }
}

// Parts ------------------------------------------------------------------------------------------

enum { NAMELESS = -1 };

/* Lists of parts with numbers, in struct dea_parts. */
static const struct part_list {
  const char *key;
  size_t items, count, size;
  int name; // place of the label in an item
} part_lists[] = {
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
enum { PLIES = 0, SHAPES = DEA_COUNT(part_lists) - 1 }; // these go by their kinds

static const struct dea_record *record_of(const struct part_list *list)
{
  size_t i = 0;
  while (strcmp(dea_parts_fields[i].key, list->key) != 0) {
    i++;
  }
  return dea_parts_fields[i].record;
}

static const char *items_of(const struct dea_parts *parts, const struct part_list *list,
                            size_t *count)
{
  const char *items;
  memcpy(&items, (const char *)parts + list->items, sizeof items);
  memcpy(count, (const char *)parts + list->count, sizeof *count);
  return items;
}

/* What the workshop says of a number of a ply, of which the film may be stretched; NAN: nothing. */
static double tolerance_of_ply(const struct dea_design *design,
                               const struct dea_design_number *number)
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

/* The numbers of a field of an item: one, or those of its list. size_m: of a shape; 0: of none. */
static void add_field(struct list *list, size_t at, size_t item, const char *base,
                      const struct dea_field *field, double size_m)
{
  static const double reach = 0.1; // of its size or of a radian, where a shape's number is smaller
  const struct part_list *parts = &part_lists[at];
  size_t own = 1;
  char name[DEA_MATERIAL_PREFIX_SIZE + 8];
  if (!dea_field_varies(field)) {
    return;
  }
  if (field->list_max > 0) {
    memcpy(&own, base + field->count_offset, sizeof own);
  }
  if (parts->name == NAMELESS) {
    snprintf(name, sizeof name, "%s[%zu]", parts->key, item);
  } else {
    const struct dea_label *label = (const void *)(base + parts->name);
    snprintf(name, sizeof name, "%.12s.%.80s", parts->key, label->text);
  }
  for (size_t k = 0; k < own; k++) {
    const size_t offset = field->offset + k * sizeof(struct dea_quantity);
    const struct dea_quantity *value = (const void *)(base + offset);
    struct dea_design_number number = {.unit = field->unit,
                                       .value = value->origin != DEA_ABSENT ? value->si : NAN,
                                       .low = -INFINITY, // the file's reader says what cannot be
                                       .high = INFINITY,
                                       .tolerance = NAN,
                                       .of = DEA_NUMBER_OF_PART,
                                       .list = at,
                                       .item = item,
                                       .offset = offset + offsetof(struct dea_quantity, si),
                                       .scale = 1};
    if (at == SHAPES) {
      number.reach = fmax(fabs(number.value), reach * (strcmp(field->unit, "m") == 0 ? size_m : 1));
    } else if (at == PLIES) {
      number.tolerance = tolerance_of_ply(list->design, &number);
    }
    snprintf(number.key, sizeof number.key, "%s.%.18s", name, field->key);
    if (own > 1) {
      const size_t length = strlen(number.key);
      snprintf(number.key + length, sizeof number.key - length, "[%zu]", k);
    }
    add(list, &number);
  }
}

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

static dea_status add_shapes(struct dea_context *ctx, struct list *list)
{
  const struct dea_parts *parts = list->design->parts;
  struct dea_shape_schema *schema = dea_alloc(ctx, 1, sizeof *schema);
  DEA_TRY_MEMORY(schema != NULL);
  dea_shape_schema_fill(schema);
  for (size_t i = 0; i < parts->shape_count; i++) {
    const struct dea_parts_shape *shape = &parts->shapes[i];
    const struct dea_record *record = record_of_shape(schema, shape);
    const double size_m = dea_region_size_m(&list->device->layout->regions[i].region);
    for (size_t f = 0; f < record->field_count; f++) {
      const struct dea_field *field = &record->fields[f];
      if (dea_field_varies(field) &&
          (list->all || field->list_max > 0 || !is_default(shape, field))) {
        add_field(list, SHAPES, i, (const char *)shape, field, size_m);
      }
    }
  }
  dea_free(ctx, schema);
  return DEA_OK;
}

/* Whether a number says something of this device: what is outside does of enclosed gas only. */
static bool is_used(const struct part_list *list, const char *item, const struct dea_field *field)
{
  const struct dea_parts_pressure *pressure = (const void *)item;
  return list->items != offsetof(struct dea_parts, pressures) ||
         field->offset != offsetof(struct dea_parts_pressure, ambient_Pa) ||
         pressure->gas_m3.origin != DEA_ABSENT;
}

static void add_parts(struct list *list)
{
  for (size_t l = 0; l < SHAPES; l++) {
    const struct part_list *parts = &part_lists[l];
    const struct dea_record *record = record_of(parts);
    size_t count;
    const char *items = items_of(list->design->parts, parts, &count);
    for (size_t i = 0; i < count; i++) {
      for (size_t f = 0; f < record->field_count; f++) {
        if (is_used(parts, items + i * parts->size, &record->fields[f])) {
          add_field(list, l, i, items + i * parts->size, &record->fields[f], 0);
        }
      }
    }
  }
}

// Keys of a disc ---------------------------------------------------------------------------------

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
  for (size_t i = 0; i < DEA_COUNT(sections); i++) {
    if (strncmp(key, sections[i], strlen(sections[i])) == 0) {
      return strcmp(key, "compute.coverage") != 0;
    }
  }
  return false;
}

/* One key of the file, if it is such a number and has a value. */
static void add_key(struct list *list, const struct dea_record *record,
                    const struct dea_listed *item)
{
  size_t offset;
  const struct dea_field *field = dea_record_find(record, item->path, &offset);
  if (field == NULL || !dea_field_varies(field) || field->list_max > 0 || is_aside(item->path)) {
    return;
  }
  const void *place = (const char *)list->design + offset;
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
    number.tolerance = tolerance_of(list->design, number.key, number.value,
                                    inplane ? length->state : DEA_STRETCHED);
    add(list, &number);
  }
}

// Lists ------------------------------------------------------------------------------------------

dea_status dea_design_numbers(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, double voltage_V, bool all,
                              struct dea_design_number *out, size_t *count)
{
  struct dea_design_schema schema;
  const struct dea_design_sections none = {0};
  struct list list = {design, device, out, count, all, false};
  *count = 0;
  add(&list, &(struct dea_design_number){
                 .key = "voltage", .value = voltage_V, .unit = "V", .tolerance = NAN, .scale = 1});
  if (design->parts != NULL) {
    add_parts(&list);
    add_materials(&list);
    DEA_TRY(ctx, add_shapes(ctx, &list));
  } else {
    dea_design_schema_fill(&none, &schema);
    for (size_t i = 0; i < design->values.count; i++) {
      add_key(&list, &schema.disc.record, &design->values.items[i]);
    }
    add_materials(&list);
  }
  return list.full ? dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                     "more than %d numbers of the design: the last ones are left "
                                     "out",
                                     DEA_NUMBERS_MAX)
                   : DEA_OK;
}

void dea_numbers_at_rest(const struct dea_device *device, struct dea_design_number *numbers,
                         size_t *count)
{
  size_t kept = 0;
  for (size_t i = 0; i < *count; i++) {
    const char *end = strrchr(numbers[i].key, '.');
    if (device->gravity != DEA_GRAVITY_OFF || end == NULL || strcmp(end, ".density") != 0) {
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
  struct list list = {.numbers = out, .count = count};
  const size_t used = pressed->tip.shape == DEA_PROBE_FLAT ? 3 : 2;
  for (size_t i = 0; i < used; i++) {
    struct dea_design_number number = {.unit = "m",
                                       .tolerance = NAN,
                                       .of = DEA_NUMBER_OF_TIP,
                                       .offset = all[i].offset,
                                       .scale = 1};
    snprintf(number.key, sizeof number.key, "%s", all[i].key);
    memcpy(&number.value, (const char *)pressed + number.offset, sizeof number.value);
    add(&list, &number);
  }
}

// Changed devices --------------------------------------------------------------------------------

/* A copy of the parts in which a number of the file is another one. */
static dea_status change_part(const struct dea_design_number *number, double value,
                              struct dea_arena *memory, struct dea_parts *parts)
{
  const struct part_list *list = &part_lists[number->list];
  size_t count;
  const char *items = items_of(parts, list, &count);
  char *copy = dea_arena_alloc(memory, count, list->size);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  memcpy(copy, items, count * list->size);
  memcpy(copy + number->item * list->size + number->offset, &value, sizeof value);
  memcpy((char *)parts + list->items, &copy, sizeof copy);
  return DEA_OK;
}

/* Of a design with plies. */
static dea_status build_changed(struct dea_context *ctx, const struct dea_design *design,
                                const struct dea_design_number *number, double value,
                                struct dea_changed_device *out)
{
  struct dea_design changed = *design;
  struct dea_parts parts = *design->parts;
  struct dea_device *device;
  changed.parts = &parts;
  if (number->of == DEA_NUMBER_OF_PART) {
    DEA_TRY(ctx, change_part(number, value, &out->memory, &parts));
  }
  const size_t errors = dea_finding_trial_begin(ctx); // what there is to say has been said
  const dea_status status = dea_device_build(ctx, &changed, &device);
  dea_finding_trial_end(ctx, errors);
  DEA_TRY(ctx, status);
  out->device = *device;
  dea_free(ctx, device); // its layout is that of out
  return DEA_OK;
}

dea_status dea_device_change(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device,
                             const struct dea_design_number *number, double value,
                             struct dea_changed_device *out)
{
  const double kept = number->scale * value;
  *out = (struct dea_changed_device){.memory = {.ctx = ctx}};
  if (design->parts != NULL) {
    DEA_TRY(ctx, build_changed(ctx, design, number, value, out));
  } else {
    out->device = *device;
    out->device.layout = NULL; // it would be another one
  }
  if (number->of == DEA_NUMBER_OF_MATERIAL) {
    memcpy((char *)dea_material_at(&out->device, number->item) + number->offset, &kept,
           sizeof kept);
    return DEA_CHAIN(ctx, design->parts != NULL ? dea_device_find_disc(ctx, &out->device) : DEA_OK);
  }
  if (number->of == DEA_NUMBER_OF_DESIGN) {
    struct dea_design *scratch = dea_arena_alloc(&out->memory, 1, sizeof *scratch);
    DEA_TRY(ctx, dea_arena_status(&out->memory));
    *scratch = *design;
    memcpy((char *)scratch + number->offset, &kept, sizeof kept);
    dea_geometry_fill(scratch, &out->device);
    DEA_TRY(ctx, dea_geometry_check(ctx, scratch, &out->device));
  }
  return DEA_OK;
}

void dea_changed_device_free(struct dea_changed_device *changed)
{
  dea_layout_destroy(changed->memory.ctx, changed->device.layout);
  dea_arena_free(&changed->memory);
}
