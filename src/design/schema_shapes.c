/* Keys of the kinds of shapes: those of geometry/shape.h, and those made of other shapes. */
#include "design/schema_parts.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_parts_shape, member)

static const struct dea_field name_field =
    DEA_LABEL_ROW("name", AT(name), "film", "its name", .required = true);
static const struct dea_field kind_field =
    DEA_LABEL_ROW("kind", AT(kind), "circle", "kind of shape", .required = true);

#define OF(least, most, text, sample)                                                              \
  DEA_FIELD_ROW(TEXT, "of", AT(of), .required = true, .lone = true, .doc = text,                   \
                .example = sample, DEA_LIST(least, most, const char *, AT(of_count)))
#define NUMBER(member, word, si_unit, text, sample, ...)                                           \
  DEA_NUMBER_ROW(word, AT(member), si_unit, sample, text, __VA_ARGS__)
#define WHOLE(member, word, text, sample, ...)                                                     \
  DEA_INTEGER_ROW(word, AT(member), sample, text, .min = 1, .max = 1000, __VA_ARGS__)

static const struct dea_field union_fields[] = {
    OF(1, DEA_PARTS_OF_MAX, "shapes that become one", "[left, right]")};
static const struct dea_field difference_fields[] = {
    OF(2, DEA_PARTS_OF_MAX, "a shape, and those that are cut out of it", "[film, active]")};
static const struct dea_field intersection_fields[] = {
    OF(2, DEA_PARTS_OF_MAX, "shapes whose common part it is", "[film, strip]")};
static const struct dea_field array_fields[] = {
    OF(1, 1, "shape that is repeated", "active"),
    WHOLE(count_x, "count_x", "how often along x", "3", .default_text = "1"),
    WHOLE(count_y, "count_y", "how often along y", "3", .default_text = "1"),
    NUMBER(pitch_x, "pitch_x", "m", "from one to the next along x", "12 mm",
           .default_text = "0 mm"),
    NUMBER(pitch_y, "pitch_y", "m", "from one to the next along y", "12 mm",
           .default_text = "0 mm"),
};
static const struct dea_field polar_fields[] = {
    OF(1, 1, "shape that is repeated", "fibre"),
    WHOLE(count, "count", "how often", "8", .required = true),
    NUMBER(angle_rad, "angle", "radian", "from one to the next, counter-clockwise", "45 degree",
           .absent_text = "all around"),
    NUMBER(x, "x", "m", "of the centre", "0 mm", .default_text = "0 mm"),
    NUMBER(y, "y", "m", "of the centre", "0 mm", .default_text = "0 mm"),
};
static const struct dea_field copy_fields[] = {
    OF(1, 1, "shape that is copied", "left"),
    NUMBER(mirror_rad, "mirror", "radian",
           "first reflected in the line through `about` in this direction", "90 degree",
           .absent_text = "not reflected"),
    NUMBER(angle_rad, "angle", "radian", "then turned about `about`, counter-clockwise",
           "45 degree", .default_text = "0 degree"),
    NUMBER(about_m, "about", "m", "point that it is turned about", "[0 mm, 0 mm]",
           .default_text = "[0 mm, 0 mm]", DEA_LIST(2, 2, struct dea_quantity, AT(about_count))),
    NUMBER(x, "x", "m", "then moved along x", "5 mm", .default_text = "0 mm"),
    NUMBER(y, "y", "m", "then moved along y", "5 mm", .default_text = "0 mm"),
};
const char *const dea_parts_units[] = {"um", "mm", "cm", "m", "mil", "in", "ft", NULL};
const double dea_parts_unit_m[] = {1e-6, 1e-3, 1e-2, 1, 25.4e-6, 25.4e-3, 0.3048};

static const struct dea_field drawing_fields[] = {
    DEA_LABEL_ROW("file", AT(file), "stripes.dxf",
                  "DXF or SVG file; its path counts from the folder of the design file",
                  .required = true),
    DEA_LABEL_ROW("layer", AT(layer), "CUT", "layer whose closed contours it is", .required = true),
    DEA_CHOICE_ROW("unit", AT(unit), dea_parts_units, "mm", "unit of a file that does not say it",
                   .absent_text = "as the file says"),
};

static const struct {
  const char *name, *doc;
  enum dea_parts_build make;
  const struct dea_field *fields;
  size_t count;
} made[] = {
    {"union", "several shapes as one", DEA_MAKE_UNION, union_fields, DEA_COUNT(union_fields)},
    {"difference", "a shape without others", DEA_MAKE_DIFFERENCE, difference_fields,
     DEA_COUNT(difference_fields)},
    {"intersection", "the common part of shapes", DEA_MAKE_INTERSECTION, intersection_fields,
     DEA_COUNT(intersection_fields)},
    {"array", "a shape in rows and columns, from its own place on", DEA_MAKE_ARRAY, array_fields,
     DEA_COUNT(array_fields)},
    {"polar", "a shape again and again about a centre", DEA_MAKE_POLAR, polar_fields,
     DEA_COUNT(polar_fields)},
    {"copy", "a shape reflected, turned and moved", DEA_MAKE_COPY, copy_fields,
     DEA_COUNT(copy_fields)},
    {"drawing", "a layer of a drawing", DEA_MAKE_DRAWING, drawing_fields,
     DEA_COUNT(drawing_fields)},
};

static struct dea_field parameter_field(const struct dea_shape_parameter *p, size_t index)
{
  bool angle = p->unit == DEA_SHAPE_ANGLE;
  struct dea_field field = DEA_NUMBER_ROW(
      p->name, AT(value) + index * sizeof(struct dea_quantity), angle ? "radian" : "m",
      angle ? "45 degree" : "5 mm", p->doc, .required = !p->optional,
      .default_text = p->optional ? (angle ? "0 degree" : "0 mm") : NULL);
  if (p->unit == DEA_SHAPE_LENGTH) {
    field.max = 10;
    field.above_min = !p->optional;
  }
  return field;
}

static const struct dea_field points_field =
    DEA_FIELD_ROW(ROWS, "points", AT(points), .required = true,
                  .example = "[[0 mm, 0 mm], [5 mm, 0 mm], [5 mm, 3 mm]]");

/* Starts the next kind with the keys that all have; returns its fields. */
static struct dea_field *start(struct dea_shape_schema *out, const char *name, const char *doc)
{
  struct dea_field *field = out->field[out->count];
  field[0] = name_field;
  field[1] = kind_field;
  field[1].example = name;
  out->record[out->count] = (struct dea_record){name, doc, field, 2};
  out->kinds[out->count] = &out->record[out->count];
  return field;
}

void dea_shape_schema_fill(struct dea_shape_schema *out)
{
  *out = (struct dea_shape_schema){0};
  for (size_t t = 0; dea_shape_types[t] != NULL; t++) {
    const struct dea_shape_type *type = dea_shape_types[t];
    struct dea_field *field = start(out, type->name, type->doc);
    size_t *n = &out->record[out->count].field_count;
    for (size_t i = 0; i < type->count; i++) {
      field[(*n)++] = parameter_field(&type->parameter[i], i);
    }
    if (type->points_min > 0) {
      field[*n] = points_field;
      field[(*n)++].doc = type->points_doc;
    }
    out->type[out->count] = type;
    out->make[out->count++] = DEA_MAKE_PRIMITIVE;
  }
  for (size_t m = 0; m < DEA_COUNT(made); m++) {
    struct dea_field *field = start(out, made[m].name, made[m].doc);
    size_t *n = &out->record[out->count].field_count;
    for (size_t i = 0; i < made[m].count; i++) {
      field[(*n)++] = made[m].fields[i];
    }
    out->make[out->count++] = made[m].make;
  }
}
