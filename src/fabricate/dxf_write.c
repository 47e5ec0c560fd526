/* Groups of a code and a value, as the DXF reference of AutoCAD 2000 has them: sections HEADER,
 * TABLES, BLOCKS, ENTITIES and OBJECTS, of which readers ask for the least that is legal. Handles
 * are hexadecimal numbers; 1 to 0x2f are used by tables and blocks: tables from 1, block records A
 * and B, their blocks C to F, dictionaries 10 and 11, entries of tables from 12. */
#include "fabricate/dxf_write.h"

#include "base/file.h"
#include "base/version.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum handle { LAYERS = 2, MODEL_RECORD = 0xA, FIRST_LAYER = 0x1A, FIRST_ENTITY = 0x30 };

struct layer {
  const char *name;
  int colour;
  bool plotted;
};

struct file {
  struct dea_text *text;
  unsigned handle; // of the next entity; once all are written, the first that is free
  int decimals;    // of lengths in mm
};

static void group(struct file *file, int code, const char *value)
{
  dea_text_add(file->text, "%3d\n%s\n", code, value);
}

static void number(struct file *file, int code, int value)
{
  dea_text_add(file->text, "%3d\n%d\n", code, value);
}

static void handle(struct file *file, int code, unsigned value)
{
  dea_text_add(file->text, "%3d\n%X\n", code, value);
}

/* A length in mm. */
static void length(struct file *file, int code, double si)
{
  double mm = 1e3 * si;
  dea_text_add(file->text, "%3d\n%.*f\n", code, file->decimals,
               fabs(mm) < 0.5 * pow(10, -file->decimals) ? 0 : mm);
}

static void point(struct file *file, int code, double x, double y)
{
  length(file, code, x);
  length(file, code + 10, y);
}

/* Groups that are the same in every file: "CODE VALUE|CODE VALUE|". */
static void groups(struct file *file, const char *list)
{
  while (*list != '\0') {
    char *value;
    const int code = (int)strtol(list, &value, 10);
    const int length = (int)strcspn(++value, "|");
    dea_text_add(file->text, "%3d\n%.*s\n", code, length, value);
    list = value + length + 1;
  }
}

static void begin_entity(struct file *file, const char *type, unsigned own, unsigned owner,
                         const char *layer, const char *subclass)
{
  group(file, 0, type);
  handle(file, 5, own);
  handle(file, 330, owner);
  group(file, 100, "AcDbEntity");
  group(file, 8, layer);
  group(file, 100, subclass);
}

/* ---- what stands before the drawing ---- */

#define TABLE(name, own, entries)                                                                  \
  "0 TABLE|2 " name "|5 " own "|330 0|100 AcDbSymbolTable|70 " entries "|"
#define RECORD(type, own, owner, subclass, name)                                                   \
  "0 " type "|5 " own "|330 " owner "|100 AcDbSymbolTableRecord|100 " subclass "|2 " name "|"
#define LINE_TYPE(own, name, meaning)                                                              \
  RECORD("LTYPE", own, "4", "AcDbLinetypeTableRecord", name)                                       \
  "70 0|3 " meaning "|72 65|73 0|40 0.0|"
#define BLOCK(begin, end, record, name)                                                            \
  "0 BLOCK|5 " begin "|330 " record "|100 AcDbEntity|8 0|100 AcDbBlockBegin|2 " name               \
  "|70 0|10 0.0|20 0.0|30 0.0|3 " name "|1 |0 ENDBLK|5 " end "|330 " record                        \
  "|100 AcDbEntity|8 0|100 AcDbBlockEnd|"

/* In millimetres, metric. */
static void write_header(struct file *file, const double box_m[4])
{
  groups(file, "999 libdea " DEA_VERSION "|0 SECTION|2 HEADER|9 $ACADVER|1 AC1015|"
               "9 $DWGCODEPAGE|3 ANSI_1252|9 $INSUNITS|70 4|9 $MEASUREMENT|70 1|9 $EXTMIN|");
  point(file, 10, box_m[0], box_m[1]);
  length(file, 30, 0);
  group(file, 9, "$EXTMAX");
  point(file, 10, box_m[2], box_m[3]);
  length(file, 30, 0);
  group(file, 9, "$HANDSEED");
  handle(file, 5, file->handle);
  group(file, 0, "ENDSEC");
}

static void write_viewport(struct file *file, const double box_m[4])
{
  double width = box_m[2] - box_m[0], height = box_m[3] - box_m[1];
  groups(file, TABLE("VPORT", "7", "1") RECORD("VPORT", "18", "7", "AcDbViewportTableRecord",
                                               "*Active") "70 0|10 0.0|20 0.0|11 1.0|21 1.0|");
  point(file, 12, 0.5 * (box_m[0] + box_m[2]), 0.5 * (box_m[1] + box_m[3]));
  length(file, 40, 1.05 * height); // shown height
  dea_text_add(file->text, " 41\n%.6f\n", width / height);
  group(file, 0, "ENDTAB");
}

static void write_layers(struct file *file, const struct layer *layers, size_t count)
{
  dea_text_add(file->text, "  0\nTABLE\n  2\nLAYER\n  5\n%X\n330\n0\n", LAYERS);
  group(file, 100, "AcDbSymbolTable");
  number(file, 70, (int)count + 1);
  groups(file, RECORD("LAYER", "12", "2", "AcDbLayerTableRecord", "0") "70 0|62 7|6 Continuous|");
  for (size_t i = 0; i < count; i++) {
    group(file, 0, "LAYER");
    handle(file, 5, FIRST_LAYER + (unsigned)i);
    handle(file, 330, LAYERS);
    groups(file, "100 AcDbSymbolTableRecord|100 AcDbLayerTableRecord|");
    group(file, 2, layers[i].name);
    number(file, 70, 0);
    number(file, 62, layers[i].colour);
    group(file, 6, "Continuous");
    number(file, 290, layers[i].plotted);
  }
  group(file, 0, "ENDTAB");
}

static void write_tables(struct file *file, const double box_m[4], const struct layer *layers,
                         size_t count)
{
  groups(file, "0 SECTION|2 TABLES|");
  write_viewport(file, box_m);
  groups(file, TABLE("LTYPE", "4", "3") LINE_TYPE("14", "ByBlock", "") LINE_TYPE(
                   "15", "ByLayer", "") LINE_TYPE("16", "Continuous", "Solid line") "0 ENDTAB|");
  write_layers(file, layers, count);
  groups(file, TABLE("STYLE", "3", "1")
                   RECORD("STYLE", "13", "3", "AcDbTextStyleTableRecord",
                          "Standard") "70 0|40 0.0|41 1.0|50 0.0|71 0|42 2.5|3 txt|4 |0 ENDTAB|");
  groups(file, TABLE("VIEW", "5", "0") "0 ENDTAB|" TABLE("UCS", "6", "0") "0 ENDTAB|");
  groups(file, TABLE("APPID", "8", "1")
                   RECORD("APPID", "17", "8", "AcDbRegAppTableRecord", "ACAD") "70 0|0 ENDTAB|");
  groups(file, TABLE("DIMSTYLE", "9",
                     "1") "100 AcDbDimStyleTable|0 DIMSTYLE|105 19|330 9|100 AcDbSymbolTableRecord|"
                          "100 AcDbDimStyleTableRecord|2 Standard|70 0|0 ENDTAB|");
  groups(file, TABLE("BLOCK_RECORD", "1", "2")
                   RECORD("BLOCK_RECORD", "A", "1", "AcDbBlockTableRecord", "*Model_Space")
                       RECORD("BLOCK_RECORD", "B", "1", "AcDbBlockTableRecord",
                              "*Paper_Space") "0 ENDTAB|0 ENDSEC|");
  groups(file, "0 SECTION|2 BLOCKS|" BLOCK("C", "D", "A", "*Model_Space")
                   BLOCK("E", "F", "B", "*Paper_Space") "0 ENDSEC|");
}

static const char objects[] = // after the drawing
    "0 SECTION|2 OBJECTS|0 DICTIONARY|5 10|330 0|100 AcDbDictionary|281 1|3 ACAD_GROUP|350 11|"
    "0 DICTIONARY|5 11|330 10|100 AcDbDictionary|281 1|0 ENDSEC|0 EOF|";

/* ---- the drawing ---- */

/* The whole file around the entities that were written to file->text, which is freed. */
static dea_status write_file(struct file *file, const double box_m[4], const struct layer *layers,
                             size_t count, struct dea_text *out)
{
  struct dea_text *entities = file->text;
  file->text = out;
  write_header(file, box_m);
  write_tables(file, box_m, layers, count);
  groups(file, "0 SECTION|2 ENTITIES|");
  dea_text_add(out, "%s", dea_text_get(entities));
  group(file, 0, "ENDSEC");
  groups(file, objects);
  dea_text_free_in(entities, out);
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}

// of a sheet, by enum dea_layer
static const struct layer sheet_layers[] = {
#define LAYER_ROW(name, meaning, dxf, screen) {#name, dxf, DEA_LAYER_##name != DEA_LAYER_NOTE},
    DEA_LAYER_LIST(LAYER_ROW)
#undef LAYER_ROW
};

static void begin_drawn(struct file *file, const char *type, const char *subclass,
                        const char *layer)
{
  begin_entity(file, type, file->handle++, MODEL_RECORD, layer, subclass);
}

static void write_polyline(struct file *file, const char *layer, const struct dea_contour *path,
                           const double at[2])
{
  const struct dea_vertex *v = path->vertex;
  begin_drawn(file, "LWPOLYLINE", "AcDbPolyline", layer);
  number(file, 90, (int)path->count);
  number(file, 70, path->closed);
  length(file, 43, 0);
  for (size_t i = 0; i < path->count; i++) {
    point(file, 10, at[0] + v[i].x_m, at[1] + v[i].y_m);
    if (v[i].bulge != 0) {
      dea_text_add(file->text, " 42\n%.15f\n", v[i].bulge);
    }
  }
}

/* A circle of two halves. */
static void write_circle(struct file *file, const char *layer, const struct dea_vertex *v,
                         const double at[2])
{
  begin_drawn(file, "CIRCLE", "AcDbCircle", layer);
  point(file, 10, at[0] + 0.5 * (v[0].x_m + v[1].x_m), at[1] + 0.5 * (v[0].y_m + v[1].y_m));
  length(file, 30, 0);
  length(file, 40, 0.5 * hypot(v[1].x_m - v[0].x_m, v[1].y_m - v[0].y_m));
}

/* Letters beyond ASCII are written as \\U+XXXX. */
static void add_escaped(struct dea_text *out, const char *text)
{
  while (*text != '\0') {
    unsigned code;
    const size_t length = dea_letter_read(text, &code);
    if (code < 0x80) {
      dea_text_add(out, "%c", dea_letter_is_control(code) ? ' ' : (char)code);
    } else {
      dea_text_add(out, code <= 0xffff ? "\\U+%04X" : "?", code);
    }
    text += length > 0 ? length : 1;
  }
}

static void write_words(struct file *file, enum dea_layer layer, double x, double y, double height,
                        bool centred, const char *text)
{
  begin_drawn(file, "TEXT", "AcDbText", sheet_layers[layer].name);
  point(file, 10, x, y);
  length(file, 30, 0);
  length(file, 40, height);
  dea_text_add(file->text, "  1\n");
  add_escaped(file->text, text);
  dea_text_add(file->text, "\n");
  if (centred) {
    number(file, 72, 1);
    point(file, 11, x, y);
    length(file, 31, 0);
  }
  group(file, 100, "AcDbText");
}

static dea_status write_copy(struct file *file, const struct dea_workshop *workshop,
                             const struct dea_part *part, const double at[2])
{
  for (size_t i = 0; i < part->contour_count; i++) {
    struct dea_context *ctx = part->memory->ctx;
    const char *layer = sheet_layers[part->contour[i].layer].name;
    struct dea_vertex *memory;
    struct dea_contour path;
    DEA_TRY(ctx, dea_workshop_path(workshop, part, i, &memory, &path));
    if (part->contour[i].circle) {
      write_circle(file, layer, path.vertex, at);
    } else {
      write_polyline(file, layer, &path, at);
    }
    dea_free(ctx, memory);
  }
  if (part->word != NULL) {
    write_words(file, DEA_LAYER_MARK, at[0], at[1] + part->word_y_m, part->word_height_m, true,
                part->word);
  }
  return DEA_OK;
}

void dea_sheet_labels(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct dea_part *part = &workshop->part[index];
  int copies = workshop->layout[index].count;
  dea_text_add(out, "%.80s: %s; %s; lengths of the %s film in mm; ",
               dea_path_name(workshop->plan.design->file), part->title, dea_part_seen(part),
               dea_part_film_name(part));
  if (part->paper) {
    dea_text_add(out, "not to be cut");
  } else {
    if (part->quantity > 1) {
      dea_text_add(out, "to be cut %zu times; ", part->quantity);
    }
    dea_text_add(out, "%d cop%s, kerf of %.4g mm taken into account", copies,
                 copies > 1 ? "ies" : "y", 1e3 * workshop->plan.kerf_m);
  }
}

static dea_status write_entities(struct file *file, const struct dea_workshop *workshop,
                                 size_t index)
{
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  const struct dea_part *part = &workshop->part[index];
  const struct dea_vertex corners[4] = {{.x_m = 0, .y_m = 0},
                                        {.x_m = layout->width_m, .y_m = 0},
                                        {.x_m = layout->width_m, .y_m = layout->height_m},
                                        {.x_m = 0, .y_m = layout->height_m}};
  const struct dea_contour edge = {corners, 4, true};
  const double origin[2] = {0, 0};
  struct dea_text words = {.ctx = part->memory->ctx};
  write_polyline(file, sheet_layers[DEA_LAYER_NOTE].name, &edge, origin);
  dea_sheet_labels(workshop, index, &words);
  const double height = fmin(2.5e-3, layout->width_m / 130); // so that they fit
  write_words(file, DEA_LAYER_NOTE, 2e-3, -2 * height, height, false, dea_text_get(&words));
  dea_status status = dea_text_free(&words);
  for (int copy = 0; copy < layout->count && status == DEA_OK; copy++) {
    double at[2];
    dea_sheet_place(layout, copy, at);
    status = write_copy(file, workshop, part, at);
  }
  return status;
}

dea_status dea_dxf_write(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  const double box[4] = {0, 0, layout->width_m, layout->height_m};
  struct dea_text entities = {.ctx = out->ctx};
  struct file file = {&entities, FIRST_ENTITY, 9}; // to the picometre
  const dea_status status = write_entities(&file, workshop, index);
  const dea_status written = write_file(&file, box, sheet_layers, DEA_LAYER_COUNT, out);
  return status == DEA_OK ? written : status;
}

// The shapes of a layout -------------------------------------------------------------------------

/* Whether some part is of a region. */
static bool is_used(const struct dea_layout *l, size_t region)
{
  bool used = false;
  for (size_t i = 0; i < l->ply_count; i++) {
    used |= l->plies[i].region == region;
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    used |= l->electrodes[i].region == region;
  }
  for (size_t i = 0; i < l->support_count; i++) {
    used |= l->supports[i].region == region || l->supports[i].within == region;
  }
  for (size_t i = 0; i < l->body_count; i++) {
    used |= l->bodies[i].region == region;
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    used |= l->pressures[i].region == region;
  }
  for (size_t i = 0; i < l->contact_count; i++) {
    used |= l->contacts[i].region == region;
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    used |= l->monitors[i].region == region;
  }
  return used;
}

/* The name of a layer: letters of ASCII but for those that DXF keeps for itself. */
static const char *layer_of(struct dea_arena *memory, const char *name)
{
  char *out = dea_arena_alloc(memory, strlen(name) + 1, 1);
  for (size_t i = 0; out != NULL && name[i] != '\0'; i++) {
    bool plain = name[i] >= ' ' && name[i] < 0x7f && strchr("<>/\\\":;?*|=,'`", name[i]) == NULL;
    out[i] = plain ? name[i] : '_';
  }
  return out != NULL ? out : "";
}

dea_status dea_dxf_write_layout(const struct dea_layout *layout, struct dea_text *out)
{
  const double origin[2] = {0, 0};
  struct dea_arena memory = {.ctx = out->ctx};
  struct layer *layers = dea_arena_alloc(&memory, layout->region_count, sizeof *layers);
  struct dea_text entities = {.ctx = out->ctx};
  struct file file = {&entities, FIRST_LAYER, 12}; // to the femtometre
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  size_t count = 0;
  for (size_t i = 0; i < layout->region_count; i++) {
    file.handle += is_used(layout, i) ? 1 : 0; // those of the layers come first
  }
  file.handle = file.handle > FIRST_ENTITY ? file.handle : FIRST_ENTITY;
  for (size_t i = 0; i < layout->region_count && layers != NULL; i++) {
    const struct dea_region *region = &layout->regions[i].region;
    if (is_used(layout, i)) {
      layers[count] =
          (struct layer){layer_of(&memory, layout->regions[i].name), 1 + (int)(count % 7), true};
      for (size_t k = 0; k < region->contour_count; k++) {
        const struct dea_contour contour = dea_region_contour(region, k);
        write_polyline(&file, layers[count].name, &contour, origin);
      }
      dea_region_grow_box(region, box);
      count++;
    }
  }
  out->failed |= memory.failed;
  const dea_status status = write_file(&file, box, layers, count, out);
  dea_arena_free(&memory);
  return status;
}
