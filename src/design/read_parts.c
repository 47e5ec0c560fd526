/* Reading of the general form: what the tables of schema_parts.c cannot do alone. */
#include "base/schema_value.h"
#include "design/schema_parts.h"

#include <stdio.h>
#include <string.h>

/* Places and copies of the names in the key `of` of a shape. */
static void read_shapes(const struct dea_node *node, struct dea_parts_shape *shape)
{
  const struct dea_node *of = dea_node_find(node, "of");
  if (of == NULL || shape->of_count == 0) {
    return;
  }
  const struct dea_node *item = of->kind == DEA_NODE_LIST ? of->child : of;
  for (size_t i = 0; i < shape->of_count && item != NULL; i++, item = item->next) {
    shape->of_place[i] = item->location;
  }
}

/* A number of a row; *out is not used after a finding. */
static dea_status read_cell(const struct dea_reader *reader, const struct dea_node *node,
                            const char *key, const struct dea_measure *due, double *out)
{
  char why[DEA_WHY_SIZE];
  if (node->kind != DEA_NODE_VALUE || node->empty) {
    return dea_schema_error(reader, node->location, "%s: a number such as '%s' is missing here",
                            key, due->example);
  }
  if (dea_units_read(reader->ctx, node->text, *due, out, why)) {
    return DEA_OK;
  }
  return why[0] == '\0' ? dea_context_status(reader->ctx)
                        : dea_schema_error(reader, node->location, "%s: %s", key, why);
}

/* Numbers of a DEA_FIELD_ROWS of two columns, at least `least` rows, in SI into the parts' memory;
 * none after a finding. */
static dea_status read_rows(const struct dea_reader *reader, struct dea_parts *parts,
                            const struct dea_node *node, const char *key,
                            const struct dea_measure due[2], size_t least, const double (**out)[2],
                            size_t *count)
{
  struct dea_context *ctx = reader->ctx;
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  *out = NULL;
  *count = 0;
  if (node == NULL) {
    return DEA_OK;
  }
  if (node->child_count < least) {
    return dea_schema_error(reader, node->location,
                            "%s needs %zu or more of lists such as [%s, %s], not %zu", key, least,
                            due[0].example, due[1].example, node->child_count);
  }
  double(*rows)[2] = dea_arena_alloc(&parts->memory, node->child_count, sizeof *rows);
  DEA_TRY_MEMORY(rows != NULL);
  size_t i = 0;
  for (const struct dea_node *row = node->child; row != NULL; row = row->next, i++) {
    if (row->kind != DEA_NODE_LIST || row->child_count != 2) {
      DEA_TRY(ctx, dea_schema_error(reader, row->location,
                                    "%s: this must be a list of 2 numbers such as [%s, %s]", key,
                                    due[0].example, due[1].example));
      continue;
    }
    DEA_TRY(ctx, read_cell(reader, row->child, key, &due[0], &rows[i][0]));
    DEA_TRY(ctx, read_cell(reader, row->child->next, key, &due[1], &rows[i][1]));
  }
  if (dea_finding_count(ctx, DEA_ERROR) == errors) {
    *out = (const double(*)[2])rows;
    *count = node->child_count;
  }
  return DEA_OK;
}

/* A shape that is none of the plane, which no name nearby would help with. */
static dea_status refuse_curved(const struct dea_reader *reader, const struct dea_node *node,
                                bool *refused)
{
  static const char *const curved[] = {"tube",   "cylinder", "roll", "balloon",
                                       "sphere", "dome",     "cone"};
  const struct dea_node *kind = dea_node_find(node, "kind");
  for (size_t i = 0; kind != NULL && i < sizeof curved / sizeof curved[0]; i++) {
    if (strcmp(kind->text, curved[i]) == 0) {
      *refused = true;
      return dea_schema_error(
          reader, kind->location,
          "a device is made of flat plies, and a %s is no shape of the plane; a "
          "film that is flat at first may be inflated (pressures) or pulled out "
          "(bodies, springs): docs/limits.md",
          curved[i]);
    }
  }
  return DEA_OK;
}

static dea_status read_shape(const struct dea_reader *reader, const struct dea_shape_schema *schema,
                             const struct dea_node *node, size_t number, struct dea_parts *parts)
{
  static const struct dea_measure point[2] = {{"m", "0 mm"}, {"m", "0 mm"}};
  struct dea_parts_shape *shape = &parts->shapes[number];
  const char *names[DEA_SHAPE_KINDS_MAX];
  char path[32];
  size_t kind, errors = dea_finding_count(reader->ctx, DEA_ERROR);
  for (size_t i = 0; i < schema->count; i++) {
    names[i] = schema->record[i].name;
  }
  bool refused = false;
  DEA_TRY(reader->ctx, refuse_curved(reader, node, &refused));
  if (refused) {
    return DEA_OK;
  }
  DEA_TRY(reader->ctx, dea_schema_kind(reader, node, "a shape", names, schema->count, &kind));
  if (kind == schema->count) {
    return DEA_OK;
  }
  snprintf(path, sizeof path, "shapes[%zu]", number);
  DEA_TRY(reader->ctx, dea_schema_read(reader, &schema->record[kind], node, path, shape));
  shape->make = schema->make[kind];
  shape->type = schema->type[kind];
  read_shapes(node, shape);
  return dea_finding_count(reader->ctx, DEA_ERROR) == errors
             ? read_rows(reader, parts, shape->points, "points", point, 1, &shape->point_m,
                         &shape->point_count)
             : DEA_OK;
}

static dea_status read_table(const struct dea_reader *reader, struct dea_parts *parts,
                             struct dea_parts_spring *spring)
{
  static const struct dea_measure shift[2] = {{"m", "1 mm"}, {"N", "5 mN"}};
  static const struct dea_measure turn[2] = {{"radian", "10 degree"}, {"N.m", "1 mN.m"}};
  DEA_TRY(reader->ctx, read_rows(reader, parts, spring->table, "table",
                                 spring->direction.value < 3 ? shift : turn, 2, &spring->row,
                                 &spring->row_count));
  for (size_t i = 1; i < spring->row_count; i++) {
    if (!(spring->row[i][0] > spring->row[i - 1][0])) {
      const struct dea_node *row = spring->table->child;
      for (size_t k = 0; k < i; k++) {
        row = row->next;
      }
      return dea_schema_error(reader, row->location, "table: places must rise from row to row");
    }
  }
  return DEA_OK;
}

dea_status dea_check_names(struct dea_context *ctx, const char *what, const void *items,
                           size_t count, size_t size, size_t offset)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_label *a = (const void *)((const char *)items + i * size + offset);
    for (size_t j = 0; j < i && a->text[0] != '\0'; j++) {
      const struct dea_label *b = (const void *)((const char *)items + j * size + offset);
      if (strcmp(a->text, b->text) == 0) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, a->location,
                                     "the name '%.60s' is taken by the %s in line %zu", a->text,
                                     what, b->location.line));
        break;
      }
    }
  }
  return DEA_OK;
}

#define CHECK_NAMES(what, type, items, count)                                                      \
  dea_check_names(ctx, what, items, count, sizeof *(items), offsetof(struct type, name))

static dea_status check_all_names(struct dea_context *ctx, const struct dea_parts *p)
{
  DEA_TRY(ctx, CHECK_NAMES("shape", dea_parts_shape, p->shapes, p->shape_count));
  DEA_TRY(ctx, CHECK_NAMES("ply", dea_parts_ply, p->plies, p->ply_count));
  DEA_TRY(ctx, CHECK_NAMES("channel", dea_parts_channel, p->channels, p->channel_count));
  DEA_TRY(ctx, CHECK_NAMES("body", dea_parts_body, p->bodies, p->body_count));
  DEA_TRY(ctx, CHECK_NAMES("pressure", dea_parts_pressure, p->pressures, p->pressure_count));
  DEA_TRY(ctx, CHECK_NAMES("contact", dea_parts_contact, p->contacts, p->contact_count));
  return CHECK_NAMES("monitor", dea_parts_monitor, p->monitors, p->monitor_count);
}

/* beside: the design file. */
static dea_status read_waveforms(const struct dea_reader *reader, const char *beside,
                                 struct dea_parts *parts)
{
  for (size_t i = 0; i < parts->channel_count; i++) {
    struct dea_parts_channel *channel = &parts->channels[i];
    char path[40];
    snprintf(path, sizeof path, "channels[%zu].waveform", i);
    if (channel->section != NULL) {
      DEA_TRY(reader->ctx,
              dea_waveform_read(reader, channel->section, path, beside, &channel->waveform));
    }
  }
  return DEA_OK;
}

static dea_status check_lines(const struct dea_reader *reader, const struct dea_parts *parts)
{
  for (size_t i = 0; i < parts->monitor_count; i++) {
    const struct dea_parts_monitor *m = &parts->monitors[i];
    if ((m->from_count > 0) != (m->to_count > 0)) {
      DEA_TRY(reader->ctx, dea_schema_error(reader, m->name.location,
                                            "the line '%.60s' needs both its ends, 'from' and 'to'",
                                            m->name.text));
    }
  }
  return DEA_OK;
}

dea_status dea_parts_read(const struct dea_reader *reader, const struct dea_shape_schema *schema,
                          const char *beside, const struct dea_node *const *shapes, size_t count,
                          struct dea_parts *parts)
{
  struct dea_context *ctx = reader->ctx;
  parts->memory.ctx = ctx;
  parts->shapes = dea_arena_alloc(&parts->memory, count, sizeof *parts->shapes);
  DEA_TRY_MEMORY(parts->shapes != NULL);
  parts->shape_count = count;
  for (size_t i = 0; i < count; i++) {
    if (shapes[i] != NULL) { // else it is no section, which was said
      DEA_TRY(ctx, read_shape(reader, schema, shapes[i], i, parts));
    }
  }
  for (size_t i = 0; i < parts->spring_count; i++) {
    DEA_TRY(ctx, read_table(reader, parts, &parts->springs[i]));
  }
  DEA_TRY(ctx, read_waveforms(reader, beside, parts));
  DEA_TRY(ctx, check_lines(reader, parts));
  return check_all_names(ctx, parts);
}

bool dea_parts_in_time(const struct dea_parts *parts)
{
  bool any = false;
  for (size_t i = 0; parts != NULL && i < parts->channel_count; i++) {
    any = any || parts->channels[i].waveform != NULL;
  }
  return any;
}

void dea_parts_clear(struct dea_context *ctx, struct dea_parts *parts)
{
  void *const lists[] = {parts->plies,     parts->electrodes, parts->channels,
                         parts->supports,  parts->bodies,     parts->springs,
                         parts->pressures, parts->contacts,   parts->monitors};
  for (size_t i = 0; i < parts->channel_count; i++) {
    dea_waveform_destroy(parts->channels[i].waveform);
  }
  for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
    dea_free(ctx, lists[i]);
  }
  dea_arena_free(&parts->memory);
  *parts = (struct dea_parts){0};
}

void dea_parts_destroy(struct dea_context *ctx, struct dea_parts *parts)
{
  if (parts != NULL) {
    dea_parts_clear(ctx, parts);
    dea_free(ctx, parts);
  }
}
