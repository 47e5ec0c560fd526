/* Groups of a code and a value, as the DXF reference of AutoCAD 2000 has them: sections HEADER,
 * TABLES, BLOCKS, ENTITIES and OBJECTS, of which readers ask for the least that is legal. Handles
 * are hexadecimal numbers; 1 to 0x2f are used by tables and blocks. */
#include "fabricate/dxf.h"

#include "base/version.h"
#include "fabricate/labels.h"

#include <math.h>
#include <string.h>

enum handle {
  BLOCK_RECORDS = 1,
  LAYERS,
  STYLES,
  LINE_TYPES,
  VIEWS,
  USER_SYSTEMS,
  VIEWPORTS,
  APPLICATIONS,
  DIMENSIONS,
  MODEL_RECORD,
  PAPER_RECORD,
  MODEL_BEGIN,
  MODEL_END,
  PAPER_BEGIN,
  PAPER_END,
  ROOT,
  GROUPS,
  LAYER_ZERO,
  STYLE,
  BY_BLOCK,
  BY_LAYER,
  CONTINUOUS,
  APPLICATION,
  VIEWPORT,
  DIMENSION,
  FIRST_LAYER,
  FIRST_ENTITY = 0x30,
};

/* Names and looks of the layers of a file. */
struct layers {
  const char *const *name; // [count]
  const int *colour;
  const bool *plotted;
  size_t count;
};

struct file {
  struct dea_text *text;
  unsigned handle; // of the next entity
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

static void begin_section(struct file *file, const char *name)
{
  group(file, 0, "SECTION");
  group(file, 2, name);
}

static void begin_object(struct file *file, const char *type, unsigned own, unsigned owner)
{
  group(file, 0, type);
  handle(file, 5, own);
  handle(file, 330, owner);
}

static void begin_entity(struct file *file, const char *type, unsigned own, unsigned owner,
                         const char *layer, const char *subclass)
{
  begin_object(file, type, own, owner);
  group(file, 100, "AcDbEntity");
  group(file, 8, layer);
  group(file, 100, subclass);
}

/* ---- what stands before the drawing ---- */

static void write_header(struct file *file, const double box_m[4], unsigned handles)
{
  group(file, 999, "libdea " DEA_VERSION);
  begin_section(file, "HEADER");
  group(file, 9, "$ACADVER");
  group(file, 1, "AC1015");
  group(file, 9, "$DWGCODEPAGE");
  group(file, 3, "ANSI_1252");
  group(file, 9, "$INSUNITS"); // millimetres
  number(file, 70, 4);
  group(file, 9, "$MEASUREMENT"); // metric
  number(file, 70, 1);
  group(file, 9, "$EXTMIN");
  point(file, 10, box_m[0], box_m[1]);
  length(file, 30, 0);
  group(file, 9, "$EXTMAX");
  point(file, 10, box_m[2], box_m[3]);
  length(file, 30, 0);
  group(file, 9, "$HANDSEED");
  handle(file, 5, handles);
  group(file, 0, "ENDSEC");
}

static void begin_table(struct file *file, const char *name, unsigned own, int entries)
{
  group(file, 0, "TABLE");
  group(file, 2, name);
  handle(file, 5, own);
  handle(file, 330, 0);
  group(file, 100, "AcDbSymbolTable");
  number(file, 70, entries);
}

static void begin_record(struct file *file, const char *type, unsigned own, unsigned owner,
                         const char *subclass, const char *name)
{
  begin_object(file, type, own, owner);
  group(file, 100, "AcDbSymbolTableRecord");
  group(file, 100, subclass);
  group(file, 2, name);
}

static void begin_entry(struct file *file, const char *type, unsigned own, unsigned owner,
                        const char *subclass, const char *name)
{
  begin_record(file, type, own, owner, subclass, name);
  number(file, 70, 0);
}

static void end_table(struct file *file)
{
  group(file, 0, "ENDTAB");
}

static void write_viewport(struct file *file, const double box_m[4])
{
  double width = box_m[2] - box_m[0], height = box_m[3] - box_m[1];
  begin_table(file, "VPORT", VIEWPORTS, 1);
  begin_entry(file, "VPORT", VIEWPORT, VIEWPORTS, "AcDbViewportTableRecord", "*Active");
  dea_text_add(file->text, " 10\n0.0\n 20\n0.0\n 11\n1.0\n 21\n1.0\n");
  point(file, 12, 0.5 * (box_m[0] + box_m[2]), 0.5 * (box_m[1] + box_m[3]));
  length(file, 40, 1.05 * height); // shown height
  dea_text_add(file->text, " 41\n%.6f\n", width / height);
  end_table(file);
}

static void write_line_types(struct file *file)
{
  static const struct {
    enum handle own;
    const char *name, *meaning;
  } types[] = {{BY_BLOCK, "ByBlock", ""},
               {BY_LAYER, "ByLayer", ""},
               {CONTINUOUS, "Continuous", "Solid line"}};
  begin_table(file, "LTYPE", LINE_TYPES, 3);
  for (size_t i = 0; i < 3; i++) {
    begin_entry(file, "LTYPE", types[i].own, LINE_TYPES, "AcDbLinetypeTableRecord", types[i].name);
    group(file, 3, types[i].meaning);
    number(file, 72, 65);
    number(file, 73, 0);
    dea_text_add(file->text, " 40\n0.0\n");
  }
  end_table(file);
}

static void write_layers(struct file *file, const struct layers *layers)
{
  begin_table(file, "LAYER", LAYERS, (int)layers->count + 1);
  begin_entry(file, "LAYER", LAYER_ZERO, LAYERS, "AcDbLayerTableRecord", "0");
  number(file, 62, 7);
  group(file, 6, "Continuous");
  for (size_t i = 0; i < layers->count; i++) {
    begin_entry(file, "LAYER", FIRST_LAYER + (unsigned)i, LAYERS, "AcDbLayerTableRecord",
                layers->name[i]);
    number(file, 62, layers->colour[i]);
    group(file, 6, "Continuous");
    number(file, 290, layers->plotted[i]);
  }
  end_table(file);
}

static void write_styles(struct file *file)
{
  begin_table(file, "STYLE", STYLES, 1);
  begin_entry(file, "STYLE", STYLE, STYLES, "AcDbTextStyleTableRecord", "Standard");
  dea_text_add(file->text, " 40\n0.0\n 41\n1.0\n 50\n0.0\n 71\n0\n 42\n2.5\n");
  group(file, 3, "txt");
  group(file, 4, "");
  end_table(file);
}

static void write_dimension_style(struct file *file)
{
  begin_table(file, "DIMSTYLE", DIMENSIONS, 1);
  group(file, 100, "AcDbDimStyleTable");
  group(file, 0, "DIMSTYLE");
  handle(file, 105, DIMENSION);
  handle(file, 330, DIMENSIONS);
  group(file, 100, "AcDbSymbolTableRecord");
  group(file, 100, "AcDbDimStyleTableRecord");
  group(file, 2, "Standard");
  number(file, 70, 0);
  end_table(file);
}

static void write_block_records(struct file *file)
{
  begin_table(file, "BLOCK_RECORD", BLOCK_RECORDS, 2);
  for (int paper = 0; paper < 2; paper++) {
    begin_record(file, "BLOCK_RECORD", paper ? PAPER_RECORD : MODEL_RECORD, BLOCK_RECORDS,
                 "AcDbBlockTableRecord", paper ? "*Paper_Space" : "*Model_Space");
  }
  end_table(file);
}

static void write_tables(struct file *file, const double box_m[4], const struct layers *layers)
{
  begin_section(file, "TABLES");
  write_viewport(file, box_m);
  write_line_types(file);
  write_layers(file, layers);
  write_styles(file);
  begin_table(file, "VIEW", VIEWS, 0);
  end_table(file);
  begin_table(file, "UCS", USER_SYSTEMS, 0);
  end_table(file);
  begin_table(file, "APPID", APPLICATIONS, 1);
  begin_entry(file, "APPID", APPLICATION, APPLICATIONS, "AcDbRegAppTableRecord", "ACAD");
  end_table(file);
  write_dimension_style(file);
  write_block_records(file);
  group(file, 0, "ENDSEC");
}

static void write_blocks(struct file *file)
{
  begin_section(file, "BLOCKS");
  for (int paper = 0; paper < 2; paper++) {
    const char *name = paper ? "*Paper_Space" : "*Model_Space";
    unsigned record = paper ? PAPER_RECORD : MODEL_RECORD;
    begin_entity(file, "BLOCK", paper ? PAPER_BEGIN : MODEL_BEGIN, record, "0", "AcDbBlockBegin");
    group(file, 2, name);
    number(file, 70, 0);
    dea_text_add(file->text, " 10\n0.0\n 20\n0.0\n 30\n0.0\n");
    group(file, 3, name);
    group(file, 1, "");
    begin_entity(file, "ENDBLK", paper ? PAPER_END : MODEL_END, record, "0", "AcDbBlockEnd");
  }
  group(file, 0, "ENDSEC");
}

static void begin_dictionary(struct file *file, unsigned own, unsigned owner)
{
  begin_object(file, "DICTIONARY", own, owner);
  group(file, 100, "AcDbDictionary");
  number(file, 281, 1);
}

/* What stands after the drawing. */
static void write_objects(struct file *file)
{
  begin_section(file, "OBJECTS");
  begin_dictionary(file, ROOT, 0);
  group(file, 3, "ACAD_GROUP");
  handle(file, 350, GROUPS);
  begin_dictionary(file, GROUPS, ROOT);
  group(file, 0, "ENDSEC");
  group(file, 0, "EOF");
}

/* ---- the drawing ---- */

// of a sheet, by enum dea_layer
static const char *const sheet_names[] = {
#define LAYER_NAME(name, meaning, dxf, screen) #name,
    DEA_LAYER_LIST(LAYER_NAME)
#undef LAYER_NAME
};
static const int sheet_colours[] = {
#define LAYER_COLOUR(name, meaning, dxf, screen) dxf,
    DEA_LAYER_LIST(LAYER_COLOUR)
#undef LAYER_COLOUR
};
static const bool sheet_plotted[] = {
#define LAYER_PLOTTED(name, meaning, dxf, screen) DEA_LAYER_##name != DEA_LAYER_NOTE,
    DEA_LAYER_LIST(LAYER_PLOTTED)
#undef LAYER_PLOTTED
};

static void begin_drawn(struct file *file, const char *type, const char *subclass,
                        const char *layer)
{
  begin_entity(file, type, file->handle++, MODEL_RECORD, layer, subclass);
}

static void write_polyline(struct file *file, const char *layer, bool closed,
                           const struct dea_vertex *v, size_t count, const double at[2])
{
  begin_drawn(file, "LWPOLYLINE", "AcDbPolyline", layer);
  number(file, 90, (int)count);
  number(file, 70, closed);
  length(file, 43, 0);
  for (size_t i = 0; i < count; i++) {
    point(file, 10, at[0] + v[i].x_m, at[1] + v[i].y_m);
    if (v[i].bulge != 0) {
      dea_text_add(file->text, " 42\n%.15f\n", v[i].bulge);
    }
  }
}

static void write_path(struct file *file, const struct dea_part_contour *contour,
                       const struct dea_vertex *v, size_t count, const double at[2])
{
  if (contour->circle) {
    begin_drawn(file, "CIRCLE", "AcDbCircle", sheet_names[contour->layer]);
    point(file, 10, at[0] + 0.5 * (v[0].x_m + v[1].x_m), at[1] + 0.5 * (v[0].y_m + v[1].y_m));
    length(file, 30, 0);
    length(file, 40, 0.5 * hypot(v[1].x_m - v[0].x_m, v[1].y_m - v[0].y_m));
    return;
  }
  write_polyline(file, sheet_names[contour->layer], contour->closed, v, count, at);
}

/* Letters beyond ASCII are written as \\U+XXXX. */
static void add_escaped(struct dea_text *out, const char *text)
{
  for (unsigned code; (code = dea_letter_next(&text)) != 0;) {
    if (code < 0x80) {
      dea_text_add(out, "%c", (char)code);
    } else {
      dea_text_add(out, code <= 0xffff ? "\\U+%04X" : "?", code);
    }
  }
}

static void write_words(struct file *file, enum dea_layer layer, double x, double y, double height,
                        bool centred, const char *text)
{
  begin_drawn(file, "TEXT", "AcDbText", sheet_names[layer]);
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
    struct dea_vertex *path;
    size_t count;
    DEA_TRY(part->ctx, dea_workshop_path(workshop, part, i, &path, &count));
    write_path(file, &part->contour[i], path, count, at);
    dea_free(part->ctx, path);
  }
  for (size_t i = 0; i < part->text_count; i++) {
    const struct dea_part_text *text = &part->text[i];
    write_words(file, DEA_LAYER_MARK, at[0] + text->x_m, at[1] + text->y_m, text->height_m, true,
                text->text);
  }
  return DEA_OK;
}

static dea_status write_entities(struct file *file, const struct dea_workshop *workshop,
                                 size_t index)
{
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  const struct dea_part *part = &workshop->part[index];
  const struct dea_part_contour edge = {DEA_LAYER_NOTE, true, false, 0, 4};
  const struct dea_vertex corners[4] = {{.x_m = 0, .y_m = 0},
                                        {.x_m = layout->width_m, .y_m = 0},
                                        {.x_m = layout->width_m, .y_m = layout->height_m},
                                        {.x_m = 0, .y_m = layout->height_m}};
  const double origin[2] = {0, 0};
  struct dea_text words = {.ctx = part->ctx};
  begin_section(file, "ENTITIES");
  write_path(file, &edge, corners, 4, origin);
  dea_sheet_labels(workshop, index, &words);
  double height = dea_sheet_labels_height(layout);
  write_words(file, DEA_LAYER_NOTE, 2e-3, -2 * height, height, false, dea_text_get(&words));
  dea_status status = words.failed ? DEA_E_MEMORY : DEA_OK;
  dea_text_free(&words);
  for (int copy = 0; copy < layout->count && status == DEA_OK; copy++) {
    double at[2];
    dea_sheet_place(layout, copy, at);
    status = write_copy(file, workshop, part, at);
  }
  group(file, 0, "ENDSEC");
  return status;
}

/* Number of entities, for the handles. */
static unsigned count_entities(const struct dea_workshop *workshop, size_t index)
{
  const struct dea_part *part = &workshop->part[index];
  return 2 + (unsigned)workshop->layout[index].count *
                 (unsigned)(part->contour_count + part->text_count);
}

dea_status dea_dxf_write(const struct dea_workshop *workshop, size_t index, struct dea_text *out)
{
  const struct layers layers = {sheet_names, sheet_colours, sheet_plotted, DEA_LAYER_COUNT};
  const struct dea_sheet_layout *layout = &workshop->layout[index];
  const double box[4] = {0, 0, layout->width_m, layout->height_m};
  struct file file = {out, FIRST_ENTITY, 9}; // to the picometre
  write_header(&file, box, FIRST_ENTITY + count_entities(workshop, index));
  write_tables(&file, box, &layers);
  write_blocks(&file);
  dea_status status = write_entities(&file, workshop, index);
  write_objects(&file);
  return status == DEA_OK && out->failed ? DEA_E_MEMORY : status;
}

// The shapes of a layout -------------------------------------------------------------------------

static void note(bool *used, size_t region)
{
  if (region != DEA_LAYOUT_NONE) {
    used[region] = true;
  }
}

/* Regions that some part is of. */
static void find_used(const struct dea_layout *l, bool *used)
{
  for (size_t i = 0; i < l->ply_count; i++) {
    note(used, l->plies[i].region);
  }
  for (size_t i = 0; i < l->electrode_count; i++) {
    note(used, l->electrodes[i].region);
  }
  for (size_t i = 0; i < l->support_count; i++) {
    note(used, l->supports[i].region);
    note(used, l->supports[i].within);
  }
  for (size_t i = 0; i < l->body_count; i++) {
    note(used, l->bodies[i].region);
  }
  for (size_t i = 0; i < l->pressure_count; i++) {
    note(used, l->pressures[i].region);
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    note(used, l->monitors[i].region);
  }
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

static size_t write_shapes(struct file *file, const struct dea_layout *l, const bool *used,
                           const struct layers *layers)
{
  const double origin[2] = {0, 0};
  size_t layer = 0, count = 0;
  for (size_t i = 0; i < l->region_count; i++) {
    for (size_t k = 0; used[i] && k < l->regions[i].region.contour_count; k++, count++) {
      const struct dea_contour contour = dea_region_contour(&l->regions[i].region, k);
      if (file != NULL) {
        write_polyline(file, layers->name[layer], true, contour.vertex, contour.count, origin);
      }
    }
    layer += used[i] ? 1 : 0;
  }
  return count;
}

dea_status dea_dxf_write_layout(const struct dea_layout *layout, struct dea_text *out)
{
  struct dea_arena memory = {.ctx = out->ctx};
  size_t n = layout->region_count;
  bool *used = dea_arena_alloc(&memory, n, sizeof *used);
  bool *plotted = dea_arena_alloc(&memory, n, sizeof *plotted);
  int *colour = dea_arena_alloc(&memory, n, sizeof *colour);
  const char **name = dea_arena_alloc(&memory, n, sizeof *name);
  double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  struct layers layers = {name, colour, plotted, 0};
  if (memory.failed) {
    dea_arena_free(&memory);
    return DEA_E_MEMORY;
  }
  find_used(layout, used);
  for (size_t i = 0; i < n; i++) {
    if (used[i]) {
      name[layers.count] = layer_of(&memory, layout->regions[i].name);
      colour[layers.count] = 1 + (int)(layers.count % 7);
      plotted[layers.count++] = true;
      dea_region_grow_box(&layout->regions[i].region, box);
    }
  }
  unsigned first = FIRST_LAYER + (unsigned)layers.count;
  first = first > FIRST_ENTITY ? first : FIRST_ENTITY;
  struct file file = {out, first, 12}; // to the femtometre
  write_header(&file, box, first + (unsigned)write_shapes(NULL, layout, used, &layers));
  write_tables(&file, box, &layers);
  write_blocks(&file);
  begin_section(&file, "ENTITIES");
  write_shapes(&file, layout, used, &layers);
  group(&file, 0, "ENDSEC");
  write_objects(&file);
  dea_status status = memory.failed || out->failed ? DEA_E_MEMORY : DEA_OK;
  dea_arena_free(&memory);
  return status;
}
