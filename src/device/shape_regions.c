/* Shapes of a design as regions, and parts by their names. */
#include "device/generator.h"

#include "base/file.h"
#include "base/text.h"
#include "geometry/boolean.h"
#include "geometry/drawing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Names ------------------------------------------------------------------------------------------

/* Parts of one kind: a list of structs that begin with their name. */
struct named {
  const char *what;
  const void *items;
  size_t count, size;
};

static const char *name_of(const struct named *parts, size_t i)
{
  const char *items = parts->items;
  return ((const struct dea_label *)(const void *)(items + i * parts->size))->text;
}

static dea_status not_there(struct dea_context *ctx, const struct named *names, const char *name,
                            struct dea_location location)
{
  struct dea_text list = {.ctx = ctx};
  const char **all = dea_alloc(ctx, names->count, sizeof *all);
  DEA_TRY_MEMORY(all != NULL);
  for (size_t i = 0; i < names->count; i++) {
    all[i] = name_of(names, i);
    if (list.length < 300) {
      dea_text_add(&list, "%s'%.60s'", i > 0 ? ", " : "", all[i]);
    }
  }
  char hint[DEA_HINT_SIZE];
  dea_status status =
      dea_name_hint(name, all, names->count, hint)[0] != '\0'
          ? dea_finding_add(ctx, DEA_ERROR, location, "there is no %s '%.60s'%s", names->what, name,
                            hint)
          : dea_finding_add(ctx, DEA_ERROR, location, "there is no %s '%.60s'; there %s %s",
                            names->what, name, names->count == 1 ? "is" : "are",
                            names->count > 0 ? dea_text_get(&list) : "none");
  dea_text_free(&list);
  dea_free(ctx, all);
  return status;
}

dea_status dea_part_find(struct dea_context *ctx, const struct dea_parts *parts,
                         enum dea_named kind, const char *name, struct dea_location location,
                         size_t *out)
{
  const struct named all[] = {
      {"shape", parts->shapes, parts->shape_count, sizeof *parts->shapes},
      {"ply", parts->plies, parts->ply_count, sizeof *parts->plies},
      {"body", parts->bodies, parts->body_count, sizeof *parts->bodies},
      {"pressure", parts->pressures, parts->pressure_count, sizeof *parts->pressures},
      {"contact", parts->contacts, parts->contact_count, sizeof *parts->contacts},
  };
  const struct named *names = &all[kind];
  for (*out = 0; *out < names->count; ++*out) {
    if (strcmp(name_of(names, *out), name) == 0) {
      return DEA_OK;
    }
  }
  *out = DEA_LAYOUT_NONE;
  return not_there(ctx, names, name, location);
}

// Regions ----------------------------------------------------------------------------------------

enum state { NEW, BEING_MADE, MADE, WRONG };

/* A file that was read; several shapes are of its layers. */
struct read_drawing {
  const char *file; // path, interned
  double unit_m;    // that the shape gives, 0: none
  struct dea_drawing *drawing;
};

struct maker {
  struct dea_context *ctx;
  const struct dea_design *design;
  const struct dea_parts *parts;
  struct dea_layout *layout;
  struct dea_arena arena;
  enum state *state;             // [shape_count]
  struct read_drawing *drawings; // [shape_count]
  size_t drawing_count;
};

static dea_status build(struct maker *m, size_t number);

/* Number of the shape `which` of those that a shape is made of, which is made now if it was not;
 * *of = DEA_LAYOUT_NONE when there is none, or it is wrong. */
static dea_status need(struct maker *m, const struct dea_parts_shape *shape, size_t which,
                       size_t *of)
{
  *of = DEA_LAYOUT_NONE;
  size_t found;
  DEA_TRY(m->ctx, dea_part_find(m->ctx, m->parts, DEA_NAMED_SHAPE, shape->of[which],
                                shape->of_place[which], &found));
  if (found == DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  if (m->state[found] == BEING_MADE) {
    m->state[found] = WRONG;
    return dea_finding_add(m->ctx, DEA_ERROR, shape->of_place[which],
                           "the shape '%.60s' is made of itself: its '%.60s' needs it again",
                           shape->of[which], shape->name.text);
  }
  DEA_TRY(m->ctx, build(m, found));
  *of = m->state[found] == MADE ? found : DEA_LAYOUT_NONE;
  return DEA_OK;
}

static const struct dea_region *region_of(const struct maker *m, size_t number)
{
  return &m->layout->regions[number].region;
}

static void append(struct dea_region *out, const struct dea_region *from)
{
  const struct dea_motion still = dea_motion_translation(0, 0);
  dea_region_add_moved(out, from, &still);
}

/* What a list of shapes makes: all of them as one, the first without the others, or what they have
 * in common. */
static dea_status combine(struct maker *m, const struct dea_parts_shape *shape,
                          struct dea_region *out)
{
  struct dea_region first = {.ctx = m->ctx}, rest = {.ctx = m->ctx};
  dea_status status = DEA_OK;
  bool good = true;
  for (size_t i = 0; i < shape->of_count && status == DEA_OK; i++) {
    size_t of;
    status = need(m, shape, i, &of);
    good = good && of != DEA_LAYOUT_NONE;
    if (status != DEA_OK || !good) {
      continue;
    }
    if (i == 0 || shape->make == DEA_MAKE_UNION) {
      append(&first, region_of(m, of));
    } else if (shape->make == DEA_MAKE_DIFFERENCE) {
      append(&rest, region_of(m, of));
    } else {
      struct dea_region common = {.ctx = m->ctx};
      status = dea_region_combine(m->ctx, DEA_INTERSECTION, &first, region_of(m, of), &common);
      dea_region_free(&first);
      first = common;
    }
  }
  if (status == DEA_OK && good && shape->make == DEA_MAKE_INTERSECTION) {
    append(out, &first);
    status = dea_region_status(&first) == DEA_OK ? dea_region_status(out) : DEA_E_MEMORY;
  } else if (status == DEA_OK && good) {
    status = dea_region_combine(m->ctx, shape->make == DEA_MAKE_UNION ? DEA_UNION : DEA_DIFFERENCE,
                                &first, &rest, out);
  }
  dea_region_free(&first);
  dea_region_free(&rest);
  return status == DEA_OK && !good ? DEA_E_DESIGN : status;
}

/* Copies that overlap become one. */
static dea_status unite(struct maker *m, const struct dea_region *copies, struct dea_region *out)
{
  size_t before = dea_finding_trial_begin(m->ctx);
  dea_status status = dea_region_check(m->ctx, copies, true);
  dea_finding_trial_end(m->ctx, before);
  if (status == DEA_OK) {
    append(out, copies);
  } else if (status == DEA_E_DESIGN) {
    dea_context_clear(m->ctx);
    status = dea_region_combine(m->ctx, DEA_UNION, copies, NULL, out);
  }
  return status == DEA_OK ? dea_region_status(out) : status;
}

static dea_status repeat(struct maker *m, const struct dea_parts_shape *shape,
                         struct dea_region *out)
{
  struct dea_region copies = {.ctx = m->ctx};
  size_t of;
  DEA_TRY(m->ctx, need(m, shape, 0, &of));
  if (of == DEA_LAYOUT_NONE) {
    return DEA_E_DESIGN;
  }
  if (shape->make == DEA_MAKE_POLAR) {
    double count = shape->count.si;
    double step = shape->angle_rad.origin == DEA_ABSENT ? 2 * DEA_PI / count : shape->angle_rad.si;
    const double centre[2] = {shape->x.si, shape->y.si};
    dea_region_add_polar(&copies, region_of(m, of), (size_t)count, centre, step);
  } else {
    const double steps[2][2] = {{shape->pitch_x.si, 0}, {0, shape->pitch_y.si}};
    const size_t counts[2] = {(size_t)shape->count_x.si, (size_t)shape->count_y.si};
    dea_region_add_grid(&copies, region_of(m, of), counts, steps);
  }
  dea_status status = dea_region_status(&copies);
  status = status == DEA_OK ? unite(m, &copies, out) : status;
  dea_region_free(&copies);
  return status;
}

static dea_status copy(struct maker *m, const struct dea_parts_shape *shape, struct dea_region *out)
{
  const double about[2] = {shape->about_m[0].si, shape->about_m[1].si};
  const struct dea_motion turn = dea_motion_rotation(about, shape->angle_rad.si);
  const struct dea_motion shift = dea_motion_translation(shape->x.si, shape->y.si);
  struct dea_region mirrored = {.ctx = m->ctx}, turned = {.ctx = m->ctx};
  size_t of;
  DEA_TRY(m->ctx, need(m, shape, 0, &of));
  if (of == DEA_LAYOUT_NONE) {
    return DEA_E_DESIGN;
  }
  const struct dea_region *from = region_of(m, of);
  if (shape->mirror_rad.origin != DEA_ABSENT) {
    const struct dea_motion mirror = dea_motion_mirror(about, shape->mirror_rad.si);
    dea_region_add_moved(&mirrored, from, &mirror);
    from = &mirrored;
  }
  dea_region_add_moved(&turned, from, &turn);
  dea_region_add_moved(out, &turned, &shift);
  bool failed = mirrored.failed || turned.failed;
  dea_region_free(&mirrored);
  dea_region_free(&turned);
  return failed ? DEA_E_MEMORY : dea_region_status(out);
}

/* Path of a drawing: it lies beside the design, or in the folder above, as of a design that a fit
 * or a search has written into a folder of its own. Owned by the caller; NULL on failure. */
static char *path_of(struct dea_context *ctx, const char *design, const char *name)
{
  char *path = dea_path_beside(ctx, design, name), above[1024], first;
  size_t length;
  if (path == NULL || dea_file_head(path, &first, 1, &length) || name[0] == '/') {
    return path;
  }
  snprintf(above, sizeof above, "../%s", name);
  char *other = dea_path_beside(ctx, design, above);
  const bool there = other != NULL && dea_file_head(other, &first, 1, &length);
  dea_free(ctx, there || other == NULL ? path : other);
  return there || other == NULL ? other : path;
}

/* The drawing of a file, read once; *out NULL: it cannot be read, which was said. */
static dea_status read_drawing(struct maker *m, const struct dea_parts_shape *shape,
                               const struct dea_drawing **out)
{
  struct dea_context *ctx = m->ctx;
  double unit_m = shape->unit.origin == DEA_ABSENT ? 0 : dea_parts_unit_m[shape->unit.value];
  char *path = path_of(ctx, m->design->file, shape->file.text);
  const char *file = path != NULL ? dea_intern(ctx, path) : NULL;
  dea_free(ctx, path);
  *out = NULL;
  DEA_TRY_MEMORY(file != NULL);
  for (size_t i = 0; i < m->drawing_count; i++) {
    if (m->drawings[i].file == file && m->drawings[i].unit_m == unit_m) {
      *out = m->drawings[i].drawing;
      return DEA_OK;
    }
  }
  struct read_drawing *next = &m->drawings[m->drawing_count++];
  next->file = file;
  next->unit_m = unit_m;
  const struct dea_drawing_settings settings = {.unit_m = unit_m};
  dea_status status = dea_drawing_read(ctx, file, &settings, &next->drawing);
  if (status == DEA_E_IO) {
    return dea_finding_add(ctx, DEA_ERROR, shape->file.location, "file: %s",
                           dea_context_message(ctx));
  }
  *out = next->drawing;
  return status == DEA_E_DESIGN ? DEA_OK : status;
}

static dea_status draw(struct maker *m, const struct dea_parts_shape *shape, struct dea_region *out)
{
  const struct dea_drawing *drawing;
  DEA_TRY(m->ctx, read_drawing(m, shape, &drawing));
  if (drawing == NULL) {
    return DEA_E_DESIGN;
  }
  if (drawing->settings.unit_m > 0 && drawing->unit_is_known &&
      fabs(drawing->unit_m / drawing->settings.unit_m - 1) > 1e-6) {
    DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_ERROR, shape->unit.location,
                                    "the unit of %s is %.6g mm, as the file itself says: leave "
                                    "'unit' out, or change the file",
                                    shape->file.text, 1e3 * drawing->unit_m));
    return DEA_E_DESIGN;
  }
  return dea_drawing_region(drawing, shape->layer.text, shape->layer.location, out);
}

static dea_status build_primitive(const struct dea_parts_shape *shape, struct dea_region *out)
{
  double value[DEA_SHAPE_PARAMETERS_MAX];
  for (size_t i = 0; i < shape->type->count; i++) {
    value[i] = shape->value[i].si;
  }
  return dea_region_add_shape(out, shape->type, value, shape->point_m, shape->point_count,
                              shape->name.location);
}

static dea_status build_region(struct maker *m, const struct dea_parts_shape *shape,
                               struct dea_region *out)
{
  switch (shape->make) {
  case DEA_MAKE_PRIMITIVE:
    return build_primitive(shape, out);
  case DEA_MAKE_UNION:
  case DEA_MAKE_DIFFERENCE:
  case DEA_MAKE_INTERSECTION:
    return combine(m, shape, out);
  case DEA_MAKE_ARRAY:
  case DEA_MAKE_POLAR:
    return repeat(m, shape, out);
  case DEA_MAKE_COPY:
    return copy(m, shape, out);
  case DEA_MAKE_DRAWING:
    return draw(m, shape, out);
  }
  return DEA_OK;
}

static dea_status build(struct maker *m, size_t number)
{
  const struct dea_parts_shape *shape = &m->parts->shapes[number];
  struct dea_region *out = &m->layout->regions[number].region;
  if (m->state[number] != NEW) {
    return DEA_OK;
  }
  m->state[number] = BEING_MADE;
  dea_status status = build_region(m, shape, out);
  bool good = status == DEA_OK && m->state[number] != WRONG;
  m->state[number] = good ? MADE : WRONG;
  if (good && !(dea_region_area_m2(out) > 0)) {
    m->state[number] = WRONG;
    return dea_finding_add(m->ctx, DEA_ERROR, shape->name.location,
                           "nothing is left of the shape '%.60s'", shape->name.text);
  }
  if (m->state[number] == WRONG) {
    dea_region_free(out);
  }
  return status == DEA_E_DESIGN ? DEA_OK : status;
}

static dea_status build_all(struct maker *m)
{
  size_t count = m->parts->shape_count;
  m->state = dea_arena_alloc(&m->arena, count, sizeof *m->state);
  m->drawings = dea_arena_alloc(&m->arena, count, sizeof *m->drawings);
  m->layout->regions = dea_arena_alloc(&m->layout->memory, count, sizeof *m->layout->regions);
  DEA_TRY(m->ctx, dea_arena_status(&m->arena));
  DEA_TRY(m->ctx, dea_arena_status(&m->layout->memory));
  m->layout->region_count = count;
  for (size_t i = 0; i < count; i++) {
    const struct dea_label *name = &m->parts->shapes[i].name;
    const char *text = dea_intern(m->ctx, name->text);
    m->layout->regions[i] = (struct dea_layout_region){
        .name = text, .region = {.ctx = m->ctx}, .location = name->location};
    DEA_TRY_MEMORY(text != NULL);
  }
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(m->ctx, build(m, i));
  }
  return DEA_OK;
}

dea_status dea_shape_regions_build(struct dea_context *ctx, const struct dea_design *design,
                                   struct dea_layout *layout)
{
  struct maker m = {.ctx = ctx,
                    .design = design,
                    .parts = design->parts,
                    .layout = layout,
                    .arena = {.ctx = ctx}};
  dea_status status = build_all(&m);
  for (size_t i = 0; i < m.drawing_count; i++) {
    dea_drawing_destroy(m.drawings[i].drawing);
  }
  dea_arena_free(&m.arena);
  return status;
}
