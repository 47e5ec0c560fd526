/* Drawings from DXF and SVG files: areas against closed forms and against the project's own writer,
 * what is said of what is not read, and faults with their place. */
#include "fabricate/dxf_write.h"
#include "failing_allocator.h"
#include "geometry/drawing.h"
#include "workshop_fixture.h"

static const double pi = 3.14159265358979323846;
static const struct dea_location here = {"t.yaml", 3, 4};

/* A DXF of these entities, in the given unit ("" for none). */
static dea_status read_dxf_as(struct dea_context *own, const char *unit, const char *entities,
                              struct dea_drawing **out)
{
  struct dea_text text = {.ctx = own};
  if (unit[0] != '\0') {
    dea_text_add(&text, "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n%s\n0\nENDSEC\n", unit);
  }
  dea_text_add(&text, "  0\r\nSECTION\r\n  2\r\nENTITIES\r\n%s0\nENDSEC\n0\nEOF\n", entities);
  dea_status status = text.failed ? DEA_E_MEMORY : DEA_OK;
  *out = NULL;
  if (status == DEA_OK) {
    status = dea_drawing_read_dxf(own, "a.dxf", text.data, text.length, NULL, out);
  }
  dea_text_free(&text);
  return status;
}

static struct dea_drawing *read_dxf(const char *entities)
{
  struct dea_drawing *drawing;
  dea_finding_clear(ctx);
  assert_int_equal(read_dxf_as(ctx, "4", entities, &drawing), DEA_OK);
  return drawing;
}

static struct dea_drawing *read_svg(const char *text)
{
  struct dea_drawing *drawing;
  dea_finding_clear(ctx);
  dea_status status = dea_drawing_read_svg(ctx, "a.svg", text, strlen(text), NULL, &drawing);
  if (status != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  return drawing;
}

/* Area [mm2] and number of contours of a layer; frees the drawing. */
static void expect(struct dea_drawing *drawing, const char *layer, double area_mm2, size_t contours)
{
  struct dea_region region = {.ctx = ctx};
  if (dea_drawing_region(drawing, layer, here, &region) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_close(1e6 * dea_region_area_m2(&region), area_mm2, 1e-12, 0);
  assert_int_equal(region.contour_count, contours);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
}

#define AT(x, y) "10\n" #x "\n20\n" #y "\n"
#define TO(x, y) "11\n" #x "\n21\n" #y "\n"
#define LINE(layer, x0, y0, x1, y1) "0\nLINE\n8\n" #layer "\n" AT(x0, y0) TO(x1, y1)
#define CIRCLE(layer, x, y, r) "0\nCIRCLE\n8\n" #layer "\n" AT(x, y) "40\n" #r "\n"
#define ARC(layer, x, y, r, a, b)                                                                  \
  "0\nARC\n8\n" #layer "\n" AT(x, y) "40\n" #r "\n50\n" #a "\n51\n" #b "\n"

TEST(test_dxf_entities)
{
  // a stadium of lines and arcs in no order and any sense, with a hole and a disc in the hole
  static const char parts[] = ARC(cut, 5, 0, 2, 270, 90) LINE(cut, 0, 2, 5, 2)
      LINE(cut, 5, -2, 0, -2) ARC(cut, 0, 0, 2, 90, 270) CIRCLE(cut, 0, 0, 1) CIRCLE(cut, 0, 0, 0.5)
          CIRCLE(other, 100, 100, 7);
  expect(read_dxf(parts), "cut", 20 + 4 * pi - pi + 0.25 * pi, 3);
  expect(read_dxf(parts), "other", 49 * pi, 1);
  // three quarters of a disc, of one arc
  expect(read_dxf(ARC(a, 1, 1, 2, 0, 270) LINE(a, 3, 1, 1, 1) LINE(a, 1, 1, 1, -1)), "a", 3 * pi,
         1);
  // the same by polylines with bulges: old and new, seen from below, with the first point repeated
  static const char lw[] =
      "0\nLWPOLYLINE\n8\na\n90\n3\n70\n1\n" AT(2, 0) "42\n0.41421356237309503\n" AT(0, 2) AT(0, 0);
  expect(read_dxf(lw), "a", pi, 1);
  static const char below[] =
      "0\nLWPOLYLINE\n8\na\n70\n1\n230\n-1\n" AT(2, 0) "42\n0.41421356237309503\n" AT(0, 2) AT(0, 0)
          AT(2, 0);
  expect(read_dxf(below), "a", pi, 1);
  static const char old[] = "0\nPOLYLINE\n8\na\n66\n1\n70\n1\n10\n0\n20\n0\n0\nVERTEX\n8\na\n" AT(
      2, 0) "42\n"
            "0.41421356237309503\n0\nVERTEX\n8\na\n" AT(0, 2) "0\nVERTEX\n8\na\n" AT(
                0, 0) "0\nSEQEND\n";
  expect(read_dxf(old), "a", pi, 1);
  // ends 0.4 um apart are one, where the first of them is: what the lines and a short one between
  // them enclose
  expect(read_dxf(LINE(a, 0, 0, 2, 0) LINE(a, 2, 0.0004, 2, 2) LINE(a, 2, 2, 0, 0)), "a", 2, 1);
}

static void expect_fault(const char *entities, const char *layer, size_t line, const char *message)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = ctx};
  dea_finding_clear(ctx);
  dea_status status = read_dxf_as(ctx, "", entities, &drawing);
  status = status == DEA_OK ? dea_drawing_region(drawing, layer, here, &region) : status;
  const struct dea_finding *finding = find_error(ctx, message);
  if (status != DEA_E_DESIGN || finding == NULL) {
    fail_msg("%s: '%s' should hold '%s'", dea_status_name(status), dea_context_message(ctx),
             message);
  }
  assert_int_equal(finding->location.line, line);
  assert_true(finding->location.column > 0);
  assert_int_equal(region.contour_count, 0);
  dea_drawing_destroy(drawing);
}

/* The middle of a file: its header, its blocks and its entities. */
#define SECTION(name, inside) "0\nSECTION\n2\n" name "\n" inside "0\nENDSEC\n"
#define FILE_OF(header, blocks, entities)                                                          \
  SECTION("HEADER", "9\n$INSUNITS\n70\n4\n" header)                                                \
  SECTION("BLOCKS", blocks) SECTION("ENTITIES", entities) "0\nEOF\n"

static struct dea_drawing *read_whole_dxf(const char *text)
{
  struct dea_drawing *drawing;
  dea_finding_clear(ctx);
  if (dea_drawing_read_dxf(ctx, "a.dxf", text, strlen(text), NULL, &drawing) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  return drawing;
}

/* Area [mm2] to within so much. */
static void expect_about(struct dea_drawing *drawing, double area_mm2, double tolerance_mm2)
{
  struct dea_region region = {.ctx = ctx};
  if (dea_drawing_region(drawing, "a", here, &region) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_close(1e6 * dea_region_area_m2(&region), area_mm2, 0, tolerance_mm2);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
}

/* Ellipses and splines become arcs, at most 0.1 um away: 1e-4 mm along their length. */
TEST(test_dxf_curves)
{
#define ELLIPSE(x, y, more) "0\nELLIPSE\n8\na\n10\n3\n20\n4\n11\n" #x "\n21\n" #y "\n" more
  expect_about(read_dxf(ELLIPSE(6, 8, "40\n0.5\n")), 50 * pi, 50 * 1e-4);
  assert_non_null(find_finding(ctx, DEA_NOTE, "1 curve became circular arcs, to within"));
  // half of one, from its long axis to the other end of it; seen from below it is the other half
  expect_about(read_dxf(ELLIPSE(10, 0, "40\n0.5\n41\n0\n42\n3.141592653589793\n")
                            LINE(a, -7, 4, 13, 4) LINE(a, 13, 4, 13, 4)),
               25 * pi, 50 * 1e-4);
  expect_about(read_dxf(ELLIPSE(10, 0, "40\n0.5\n41\n0\n42\n3.141592653589793\n230\n-1\n")
                            LINE(a, -7, 4, -7, 10) LINE(a, -7, 10, 13, 10) LINE(a, 13, 10, 13, 4)),
               120 + 25 * pi, 60 * 1e-4);
  // a round one is exact
  expect(read_dxf(ELLIPSE(0, 7, "40\n1\n")), "a", 49 * pi, 1);
  assert_null(find_finding(ctx, DEA_NOTE, "became circular arcs"));
  // a circle as a rational spline of degree 2: 9 points, every other one of weight 1/sqrt(2)
  static const char circle[] =
      "0\nSPLINE\n8\na\n70\n5\n71\n2\n72\n12\n73\n9\n"
      "40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n2\n40\n2\n40\n3\n40\n3\n40\n4\n40\n4\n40\n4\n"
      "41\n1\n41\n0.7071067811865476\n41\n1\n41\n0.7071067811865476\n41\n1\n"
      "41\n0.7071067811865476\n41\n1\n41\n0.7071067811865476\n41\n1\n" AT(2, 0) AT(2, 2) AT(0, 2)
          AT(-2, 2) AT(-2, 0) AT(-2, -2) AT(0, -2) AT(2, -2) AT(2, 0);
  expect(read_dxf(circle), "a", 4 * pi, 1);
  // under y = 4 t (1 - t), x = t of degree 2 lies 2/3
  expect_about(read_dxf("0\nSPLINE\n8\na\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n" AT(
                   0, 0) AT(0.5, 2) AT(1, 0) LINE(a, 0, 0, 1, 0)),
               2.0 / 3, 3e-4);
  expect_fault("0\nSPLINE\n8\na\n71\n2\n40\n0\n40\n1\n" AT(0, 0) AT(1, 2) AT(1, 0), "a", 6,
               "a SPLINE of degree 2 with 3 control points, 0 weights and 2 knots cannot be");
  expect_fault("0\nSPLINE\n8\na\n71\n1\n40\n0\n40\n1\n40\n0\n40\n1\n" AT(0, 0) AT(1, 2), "a", 6,
               "a SPLINE needs knots that ascend");
  // curves that leave the plane are named
  struct dea_drawing *drawing = read_dxf(CIRCLE(a, 0, 0, 1) LINE(a, 1, 1, 2, 2) "31\n5\n" ELLIPSE(
      1, 0, "31\n1\n") "0\nCIRCLE\n8\na\n40\n1\n210\n1\n230\n0\n");
  expect(drawing, "a", pi, 1);
  assert_non_null(find_finding(ctx, DEA_WARNING, "1 of the kind LINE out of plane is not read"));
  assert_non_null(find_finding(ctx, DEA_WARNING, "1 of the kind ELLIPSE out of plane"));
  assert_non_null(find_finding(ctx, DEA_WARNING, "1 of the kind CIRCLE out of plane"));
#undef ELLIPSE
}

#define BLOCK(name, x, y, inside)                                                                  \
  "0\nBLOCK\n8\n0\n2\n" #name "\n" AT(x, y) inside "0\nENDBLK\n8\n0\n"
#define INSERT(layer, name, more) "0\nINSERT\n8\n" #layer "\n2\n" #name "\n" more

/* Blocks: half a disc of radius 2 about (1, 1), its base, on layer "0". */
TEST(test_dxf_blocks)
{
#define HALF ARC(0, 1, 1, 2, 0, 180) LINE(0, -1, 1, 3, 1)
#define WITH(inserts)                                                                              \
  FILE_OF("",                                                                                      \
          BLOCK(half, 1, 1, HALF)                                                                  \
              BLOCK(two, 0, 0, INSERT(0, HALF, "") INSERT(0, half, AT(8, 0) "50\n90\n")),          \
          inserts)
  expect(read_whole_dxf(WITH(INSERT(a, Half, AT(3, 4) "41\n2\n42\n2\n50\n30\n"))), "a", 8 * pi, 1);
  expect(read_whole_dxf(WITH(INSERT(a, half, AT(3, 4) "41\n-1\n42\n1\n50\n30\n"))), "a", 2 * pi, 1);
  expect(read_whole_dxf(WITH(INSERT(a, half, AT(3, 4) "230\n-1\n"))), "a", 2 * pi, 1);
  // scaled to an ellipse
  expect_about(read_whole_dxf(WITH(INSERT(a, half, "41\n3\n"))), 6 * pi, 3e-3);
  // nested, and in rows and columns that do not grow with the scale
  expect(read_whole_dxf(WITH(INSERT(a, two, AT(9, 9)))), "a", 4 * pi, 2);
  expect(read_whole_dxf(WITH(INSERT(a, two, "70\n3\n71\n2\n44\n15\n45\n-20\n"))), "a", 24 * pi, 12);
  struct dea_drawing *drawing =
      read_whole_dxf(WITH(INSERT(a, half, "41\n0.5\n42\n0.5\n50\n90\n70\n2\n44\n10\n")));
  struct dea_region region = {.ctx = ctx};
  double centre[2]; // of two half discs of radius 1 to the left of x = 0, at y = 0 and 10
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  dea_region_centroid_m(&region, centre);
  assert_close(1e3 * centre[0], -4 / (3 * pi), 1e-9, 0);
  assert_close(1e3 * centre[1], 5, 1e-9, 0);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  // a polyline with a bulge in a block that is not scaled evenly: half an ellipse
  expect_about(read_whole_dxf(FILE_OF(
                   "", BLOCK(b, 0, 0, "0\nLWPOLYLINE\n8\n0\n70\n1\n" AT(1, 0) "42\n1\n" AT(-1, 0)),
                   INSERT(a, b, "41\n4\n42\n2\n"))),
               4 * pi, 2e-3);
  // layers: "0" in a block is that of its INSERT, others are their own
  drawing = read_whole_dxf(FILE_OF("", BLOCK(b, 0, 0, CIRCLE(0, 0, 0, 1) CIRCLE(own, 0, 0, 2)),
                                   INSERT(a, b, "") INSERT(c, none, "") CIRCLE(c, 0, 0, 1)));
  assert_int_equal(dea_drawing_region(drawing, "own", here, &region), DEA_OK);
  assert_close(1e6 * dea_region_area_m2(&region), 4 * pi, 1e-12, 0);
  dea_region_free(&region);
  assert_int_equal(dea_drawing_region(drawing, "c", here, &region), DEA_OK);
  assert_non_null(find_finding(ctx, DEA_WARNING, "1 of the kind INSERT of no block is not read"));
  dea_region_free(&region);
  expect(drawing, "a", pi, 1);
  // a block in itself, and one that is too much
  static const char itself[] = FILE_OF("", BLOCK(b, 0, 0, INSERT(0, b, "")), INSERT(a, b, ""));
  assert_int_equal(dea_drawing_read_dxf(ctx, "a.dxf", itself, strlen(itself), NULL, &drawing),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "blocks are inserted in each other more than 40 deep"));
  static const char much[] =
      FILE_OF("", BLOCK(b, 0, 0, INSERT(0, c, "70\n99999\n71\n99999\n")) BLOCK(c, 0, 0, ""),
              INSERT(a, b, "70\n99999\n71\n99999\n"));
  const struct dea_drawing_settings few = {.vertices_max = 100};
  assert_int_equal(dea_drawing_read_dxf(ctx, "a.dxf", much, strlen(much), &few, &drawing),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "too much is inserted by blocks"));
#undef WITH
#undef HALF
}

/* Names of layers by version, codepage and escapes; one name in any case. */
TEST(test_dxf_names)
{
#define NAMED(header, name) FILE_OF(header, "", "0\nCIRCLE\n8\n" name "\n40\n1\n")
#define PAGE(name) "9\n$DWGCODEPAGE\n3\n" name "\n"
  static const struct {
    const char *text, *layer;
  } cases[] = {
      {NAMED(PAGE("ANSI_1252"), "\xe9lectrode"), "électrode"},
      {NAMED(PAGE("ansi_1251"), "\xf0\xe0\xec\xea\xe0"), "рамка"},
      {NAMED(PAGE("dos850"), "\x82lectrode"), "électrode"},
      {NAMED(PAGE("ANSI_936"), "\xcd\xe2\xbf\xf2"), "外框"},
      {NAMED(PAGE("ANSI_932"), "\x98\x67"), "枠"},
      {NAMED(PAGE("ANSI_949"), "\xc5\xd7\xb5\xce\xb8\xae"), "테두리"},
      {NAMED(PAGE("no such page"), "\xe9lectrode"), "électrode"},
      {NAMED(PAGE("ANSI_1251") "9\n$ACADVER\n1\nAC1032\n", "électrode"), "électrode"},
      {NAMED("", "électrode"), "électrode"},
      {NAMED("", "\\U+00E9lectrode \\u+"), "électrode \\u+"},
      {NAMED("", "\\M+5CDE2\\M+5BFF2"), "外框"},
      {NAMED("", "\\M+19867\\U+12"), "枠\\U+12"},
      {NAMED("", "Electrode"), "ELECTRODE"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    expect(read_whole_dxf(cases[i].text), cases[i].layer, pi, 1);
    assert_null(find_finding(ctx, DEA_NOTE, "codepage"));
  }
  // without a codepage it is told what was taken, and names of messages are letters
  expect(read_whole_dxf(NAMED("", "\xe9\x81")), "é\xc2\x81", pi, 1);
  assert_non_null(find_finding(ctx, DEA_NOTE, "($DWGCODEPAGE): they are read as ANSI_1252"));
  struct dea_region region = {.ctx = ctx};
  struct dea_drawing *drawing = read_whole_dxf(NAMED("", "\xe9lectrode"));
  assert_int_equal(dea_drawing_region(drawing, "x", here, &region), DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "its layers are '0', 'électrode'"));
  dea_drawing_destroy(drawing);
#undef NAMED
#undef PAGE
}

#define PI 3.14159265358979323846
#define IN 25.4        // mm
#define PX (25.4 / 96) // mm
/* Files as other programs write them, with what they must give. */
static const struct {
  const char *file, *layer;
  double area_mm2;
  const char *fault; // NULL: none
} others[] = {
    {"closed-contour-refused/rect-10x2.005.dxf", "0", 20.05, NULL},
    {"closed-contour-refused/rect-10x2.dxf", "0", 20, NULL},
    {"closed-contour-refused/rect-10.005x4.dxf", "0", 40.02, NULL},
    {"closed-contour-refused/rect-20.363x8.dxf", "0", 162.904, NULL},
    {"closed-contour-refused/poly-10x2.005.dxf", "0", 20.05, NULL},
    {"closed-contour-refused/rect.svg", "CUT", 20.05, NULL},
    {"dxf/arc360.dxf", "0", 800 - 16 * PI, NULL},
    {"dxf/arc360b.dxf", "0", 800 - 16 * PI, NULL},
    {"dxf/binary.dxf", "0", 0, "binary DXF files are not read"},
    {"dxf/bom.dxf", "0", 2 * IN *IN, NULL},
    {"dxf/case.dxf", "CUT", 800, NULL},
    {"dxf/case2.dxf", "Cut", 800 - 16 * PI, NULL},
    {"dxf/case2.dxf", "CUT", 800 - 16 * PI, NULL},
    {"dxf/closing-vertex.dxf", "0", 800, NULL},
    {"dxf/comments.dxf", "0", 2 * IN *IN, NULL},
    {"dxf/cp1251.dxf", "ðàìêà", 800, NULL},
    {"dxf/cr-only.dxf", "0", 2 * IN *IN, NULL},
    {"dxf/degenerate-lw.dxf", "0", 800, NULL},
    {"dxf/dup-circle.dxf", "0", 0, "two contours have an edge in common"},
    {"dxf/dup-rect.dxf", "0", 0, "more than two lines meet (one that is drawn twice?)"},
    {"dxf/frozen.dxf", "OFF", 800, NULL},
    {"dxf/gbk.dxf", "Íâ¿ò", 800, NULL},
    {"dxf/inch.dxf", "0", 2 * IN *IN, NULL},
    {"dxf/invisible.dxf", "0", 800, NULL},
    {"dxf/island.dxf", "0", 800 - 64 * PI + 9 * PI, NULL},
    {"dxf/latin1.dxf", "électrode", 800, NULL},
    {"dxf/mbcs-escape.dxf", "走", 800, NULL},
    {"dxf/micron.dxf", "0", 200, NULL},
    {"dxf/nounits0.dxf", "0", 2, NULL},
    {"dxf/ocs-arc.dxf", "0", 50 * PI, NULL},
    {"dxf/ocs-circle.dxf", "0", 800 - 16 * PI, NULL},
    {"dxf/ocs-lw-alone.dxf", "0", 50, NULL},
    {"dxf/ocs-lw-bulge.dxf", "0", 45.631882636703004, NULL},
    {"dxf/ocs-lw-first.dxf", "0", 750, NULL},
    {"dxf/ocs-lwpoly.dxf", "0", 750, NULL},
    {"dxf/overlap-rects.dxf", "0", 0, "two contours cross"},
    {"dxf/paper.dxf", "0", 800, NULL},
    {"dxf/poly-open-gap.dxf", "0", 800, NULL},
    {"dxf/poly3d-flat.dxf", "0", 800, NULL},
    {"dxf/selfcross.dxf", "0", 0, "the contour crosses or touches itself"},
    {"dxf/sjis.dxf", "˜g", 800, NULL},
    {"dxf/spline-in-polyline.dxf", "0", 240, NULL},
    {"dxf/thick-line.dxf", "0", 0, "the contour is open"},
    {"dxf/tiny-gap2um.dxf", "0", 0, "the contour is open (the nearest other end is 0.002 mm"},
    {"dxf/tiny-line.dxf", "0", 800, NULL},
    {"dxf/unicode-escape.dxf", "électrode", 800, NULL},
    {"dxf/utf8-2007.dxf", "électrode", 800, NULL},
    {"dxf/zero-apart.dxf", "0", 800, NULL},
    {"dxf/zero-arc.dxf", "0", 800, NULL},
    {"dxf/zero-line.dxf", "0", 800, NULL},
    {"svg/attr-circle-cm.svg", "Cut", 100 * PI, NULL},
    {"svg/attr-in.svg", "Cut", 0.96 * 0.96 * IN *IN, NULL},
    {"svg/attr-mm.svg", "Cut", 800, NULL},
    {"svg/attr-percent.svg", "Cut", 800, NULL},
    {"svg/clip.svg", "Cut", 800, NULL},
    {"svg/closepath-implicit.svg", "Cut", 800, NULL},
    {"svg/compact-arc.svg", "Cut", 100 * PI, NULL},
    {"svg/compact-num.svg", "Cut", 800.625, NULL},
    {"svg/defs.svg", "Cut", 800, NULL},
    {"svg/ellipse.svg", "Cut", 200 * PI, NULL},
    {"svg/entity.svg", "Découpe & pli", 800, NULL},
    {"svg/evenodd.svg", "Cut", 600, NULL},
    {"svg/hidden-attr.svg", "Cut", 800, NULL},
    {"svg/hidden.svg", "Cut", 800, NULL},
    {"svg/illu-esc.svg", "Cut_x20_lines", 800, NULL},
    {"svg/illu.svg", "Layer_1", 800 * PX *PX, NULL},
    {"svg/ink-layer-tr.svg", "Cut", 800, NULL},
    {"svg/ink-layer.svg", "Cut", 800, NULL},
    {"svg/kicad.svg", "0", 800, NULL},
    {"svg/nested-layers.svg", "Cut", 800, NULL},
    {"svg/nogroup.svg", "0", 800, NULL},
    {"svg/nonuniform-none.svg", "Cut", 1000, NULL},
    {"svg/nonuniform.svg", "Cut", 800, NULL},
    {"svg/open-filled.svg", "Cut", 0, "the contour is open"},
    {"svg/overlap.svg", "Cut", 0, "two contours cross"},
    {"svg/percent.svg", "Cut", 800 * PX *PX, NULL},
    {"svg/pt.svg", "Cut", 800 * (IN / 72) * (IN / 72), NULL},
    {"svg/px.svg", "Cut", 800 * PX *PX, NULL},
    {"svg/rrect.svg", "Cut", 700 + 25 * PI, NULL},
    {"svg/same-label.svg", "Cut", 800 + 25 * PI, NULL},
    {"svg/skew.svg", "Cut", 100 * PI, NULL},
    {"svg/sodipodi.svg", "Cut", 100 * PI, NULL},
    {"svg/text.svg", "Cut", 800, NULL},
    {"svg/thickline.svg", "Cut", 0, "the contour is open"},
    {"svg/tref.svg", "Cut", 200, NULL},
    {"svg/unit-attr-px.svg", "Cut", 800, NULL},
    {"svg/unit-attr.svg", "Cut", 800 / PX / PX, NULL},
    {"svg/use.svg", "Cut", 800, NULL},
    {"svg/use2.svg", "Cut", 800 - 16 * PI, NULL},
    {"svg/utf.svg", "Découpe", 800, NULL},
    {"svg/vbonly.svg", "Cut", 800 * PX *PX, NULL},
};

TEST(test_files_of_others)
{
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
    char file[400];
    struct dea_drawing *drawing;
    struct dea_region region = {.ctx = ctx};
    snprintf(file, sizeof file, "%s/%s", DEA_SOURCE_DIR "/tests/cases/drawings", others[i].file);
    dea_finding_clear(ctx);
    dea_status status = dea_drawing_read(ctx, file, NULL, &drawing);
    status =
        status == DEA_OK ? dea_drawing_region(drawing, others[i].layer, here, &region) : status;
    double area = status == DEA_OK ? 1e6 * dea_region_area_m2(&region) : 0;
    // curves: 0.1 um along their length
    double near = strstr(file, "/ellipse.") != NULL || strstr(file, "/skew.") != NULL ? 0.01 : 0;
    bool good = others[i].fault == NULL
                    ? status == DEA_OK && fabs(area - others[i].area_mm2) <= near + 1e-9 * area
                    : status == DEA_E_DESIGN && find_error(ctx, others[i].fault) != NULL;
    if (!good) {
      fail_msg("%s: %.10g mm2, %s", others[i].file, area, dea_context_message(ctx));
    }
    dea_region_free(&region);
    dea_drawing_destroy(drawing);
  }
}

static unsigned draw_number(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return *seed >> 8;
}

/* Polygons of 60 lines about a point, whose coordinates are whole um, in any order and sense. */
TEST(test_random_polygons)
{
  enum { POLYGONS = 40, LINES = 60 };
  unsigned seed = 1;
  for (int polygon = 0; polygon < POLYGONS; polygon++) {
    double x[LINES + 1][2], twice_mm2 = 0;
    size_t order[LINES];
    for (size_t i = 0; i < LINES; i++) {
      double angle = 2 * pi * ((double)i + 0.8 * draw_number(&seed) / (1 << 24)) / LINES;
      double radius = 10 + 10.0 * draw_number(&seed) / (1 << 24);
      x[i][0] = round(1e3 * (30 + radius * cos(angle))) / 1e3;
      x[i][1] = round(1e3 * (20 + radius * sin(angle))) / 1e3;
      order[i] = i;
    }
    memcpy(x[LINES], x[0], sizeof x[0]);
    for (size_t i = LINES - 1; i > 0; i--) {
      size_t k = draw_number(&seed) % (i + 1), keep = order[i];
      order[i] = order[k];
      order[k] = keep;
    }
    struct dea_text text = {.ctx = ctx};
    for (size_t n = 0; n < LINES; n++) {
      size_t i = order[n], back = draw_number(&seed) % 2;
      twice_mm2 += x[i][0] * x[i + 1][1] - x[i][1] * x[i + 1][0];
      dea_text_add(&text, "0\nLINE\n8\na\n10\n%.3f\n20\n%.3f\n11\n%.3f\n21\n%.3f\n", x[i + back][0],
                   x[i + back][1], x[i + 1 - back][0], x[i + 1 - back][1]);
    }
    expect(read_dxf(dea_text_get(&text)), "a", 0.5 * twice_mm2, 1);
    dea_text_free(&text);
  }
}

TEST(test_units)
{
  static const struct {
    const char *code;
    double mm;
  } units[] = {{"1", 25.4}, {"2", 304.8}, {"4", 1}, {"5", 10},
               {"6", 1000}, {"13", 1e-3}, {"0", 1}, {"", 1}};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    struct dea_drawing *drawing;
    dea_finding_clear(ctx);
    assert_int_equal(read_dxf_as(ctx, units[i].code, CIRCLE(a, 0, 0, 3), &drawing), DEA_OK);
    assert_true((find_finding(ctx, DEA_NOTE, "mm is assumed") != NULL) == (i >= 6));
    expect(drawing, "a", 9 * pi * units[i].mm * units[i].mm, 1);
  }
}

TEST(test_dxf_faults)
{
  expect_fault(LINE(a, 0, 0, 2, 0) LINE(a, 2, 0, 2, 2) LINE(a, 2, 2.002, 0, 0), "a", 18,
               "the contour is open (the nearest other end is 0.002 mm away, ends within 0.001 mm "
               "are joined) at (2, 2) mm");
  expect_fault(LINE(a, 0, 0, 2, 0) LINE(a, 2, 0, 2, 2) LINE(a, 2, 2, 0, 0) LINE(a, 0, 0, 2, 0), "a",
               42, "more than two lines meet (one that is drawn twice?) at (0, 0) mm");
  expect_fault("0\nLWPOLYLINE\n8\na\n70\n1\n" AT(0, 0) AT(2, 2) AT(2, 0) AT(0, 3), "a", 6,
               "crosses or touches itself at (1.2, 1.2) mm");
  expect_fault(CIRCLE(a, 0, 0, 2) CIRCLE(a, 3, 0, 2), "a", 6, "two contours cross at (1.5, ");
  expect_fault(CIRCLE(a, 0, 0, 2) CIRCLE(a, 0, 0, 2), "a", 6, "an edge in common");
  expect_fault(CIRCLE(cuts, 0, 0, 2), "cut", 3,
               "'a.dxf' has no layer 'cut'; its layers are '0', 'cuts'; is 'cuts' meant?");
  expect_fault("0\nTEXT\n8\nb\n", "b", 3, "layer 'b' of the drawing holds no contour");
  expect_fault("0\nCIRCLE\n8\na\n10\nzero\n", "a", 10, "'zero' is no number");
  expect_fault(CIRCLE(a, 0, 0, -1), "a", 6, "the radius of this CIRCLE is not above 0");
  expect_fault("8\n", "a", 7, "a whole number is due here");
  // an unknown kind is named with its layer and number, once
  struct dea_drawing *drawing =
      read_dxf("0\nSPLINE\n8\na\n0\nHATCH\n8\nb\n0\nSPLINE\n8\na\n" CIRCLE(a, 0, 0, 1));
  struct dea_region region = {.ctx = ctx};
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  assert_non_null(find_finding(ctx, DEA_WARNING, "layer 'a': 2 of the kind SPLINE are not read"));
  assert_null(find_finding(ctx, DEA_WARNING, "HATCH"));
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  // too much
  const struct dea_drawing_settings few = {.vertices_max = 3};
  static const char two[] =
      "0\nSECTION\n2\nENTITIES\n" CIRCLE(a, 0, 0, 1) CIRCLE(a, 9, 0, 1) "0\nENDSEC\n0\nEOF\n";
  assert_int_equal(dea_drawing_read_dxf(ctx, "a.dxf", two, sizeof two - 1, &few, &drawing),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "more than 3 vertices, which is too many"));
  assert_null(drawing);
  static const char binary[] = "AutoCAD Binary DXF\r\n\x1a";
  assert_int_equal(dea_drawing_read_dxf(ctx, "b.dxf", binary, sizeof binary, NULL, &drawing),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "binary DXF files are not read"));
  static const char cut_off[] = "0\nSECTION\n2\nENTITIES\n";
  assert_int_equal(dea_drawing_read_dxf(ctx, "c.dxf", cut_off, sizeof cut_off - 1, NULL, &drawing),
                   DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "ends early"));
}

#define SVG(inside)                                                                                \
  "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='50mm' viewBox='0 0 100 50'>"      \
  "<g id='a'>" inside "</g></svg>"

TEST(test_svg_elements)
{
  expect(read_svg(SVG("<circle cx='10' cy='10' r='3'/>")), "a", 9 * pi, 1);
  expect(read_svg(SVG("<rect x='1' y='2' width='6' height='4' rx='1'/>")), "a", 24 - 4 + pi, 1);
  expect(read_svg(SVG("<polygon points='0,0 6 0 0,3'/>")), "a", 9, 1);
  // a ring of two subpaths, absolute and relative, with flags that stick to the numbers
  expect(read_svg(SVG("<path d='M 5,0 A5 5 0 0 1 -5 0 A 5 5 0 0 1 5 0 z m-2 0a3 3 0 11-6 0 3 3 0 "
                      "016 0Z'/>")),
         "a", 16 * pi, 2);
  expect(read_svg(SVG("<path d='m1 1h4v3H1Z'/>")), "a", 12, 1);
  // three quarters of a disc by its large arc
  expect(read_svg(SVG("<path d='M0 0L2 0A2 2 0 1 0 0 2z'/>")), "a", 3 * pi, 1);
  // groups in groups, moved, turned, mirrored and scaled: circles stay exact
  expect(read_svg(SVG("<g transform='translate(3 4) rotate(30)'><g transform='scale(-2,2) matrix(0 "
                      "1 1 0 5 5)'><circle r='1.5'/></g></g>")),
         "a", 9 * pi, 1);
  // half of the page for as many units
  expect(read_svg("<svg width='50mm' height='25mm' viewBox='0 0 100 50'><circle r='4'/></svg>"),
         "0", 4 * pi, 1);
  assert_null(find_finding(ctx, DEA_NOTE, "assumed"));
  expect(read_svg("<svg width='50' height='25'><circle r='4'/></svg>"), "0",
         16 * pi * (25.4 / 96) * (25.4 / 96), 1);
  assert_non_null(find_finding(ctx, DEA_NOTE, "96 units to the inch are assumed"));
  // what is not drawn is not there
  expect(read_svg(SVG("<defs><circle r='9'/></defs><circle r='9' style='display:none'/><circle "
                      "r='1'/>")),
         "a", pi, 1);
  // y goes up
  struct dea_drawing *drawing = read_svg(SVG("<circle cx='10' cy='10' r='3'/>"));
  struct dea_region region = {.ctx = ctx};
  double centre[2];
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  dea_region_centroid_m(&region, centre);
  assert_close(centre[0], 10e-3, 1e-12, 0);
  assert_close(centre[1], 40e-3, 1e-12, 0);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
}

/* Curves become arcs to within the tolerance that is told. */
TEST(test_svg_curves)
{
  struct dea_drawing *drawing = read_svg(SVG("<ellipse cx='20' cy='20' rx='10' ry='5'/>"));
  assert_non_null(find_finding(ctx, DEA_NOTE, "1 curve became circular arcs, to within"));
  struct dea_region region = {.ctx = ctx};
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  assert_close(dea_region_area_m2(&region), 50e-6 * pi, 0, 50e-3 * 1e-7);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  // under a parabola and its chord lies a third of the triangle twice; smooth ones go on
  drawing = read_svg(SVG("<path d='M0 20Q10 0 20 20T40 20H40V40H0z'/>"));
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  assert_close(dea_region_area_m2(&region), 800e-6, 0, 150e-3 * 1e-7);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  drawing = read_svg(SVG("<path d='M0 20C0 10 20 10 20 20S40 30 40 20H41V40H0z'/>"));
  assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
  assert_close(dea_region_area_m2(&region), 820e-6, 0, 150e-3 * 1e-7);
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
}

/* A circle as programs write one: four cubics with handles of so many radii, in this format. */
static void add_bezier_circle(struct dea_text *text, const char *number, double x, double y,
                              double r, double handle)
{
  static const double cosine[5] = {1, 0, -1, 0, 1}, sine[5] = {0, 1, 0, -1, 0};
  for (int k = 0; k < 4; k++) {
    const double c = cosine[k], s = sine[k], d = cosine[k + 1], t = sine[k + 1], h = handle;
    const double v[4][2] = {{c, s}, {c - h * s, s + h * c}, {d + h * t, t - h * d}, {d, t}};
    for (int i = k == 0 ? 0 : 1; i < 4; i++) {
      dea_text_add(text, i == 0 ? "<path d='M" : i == 1 ? "C" : " ");
      dea_text_add(text, number, x + r * v[i][0]);
      dea_text_add(text, ",");
      dea_text_add(text, number, y + r * v[i][1]);
    }
  }
  dea_text_add(text, "z'/>\n");
}

/* Circles of four cubics become four arcs, whatever program wrote them; 900 holes are no more. */
TEST(test_svg_bezier_circles)
{
  static const struct {
    const char *number;
    double radius, handle, tolerance; // of the area: that of rounded radii
    int holes;                        // in a row and a column
  } cases[] = {{"%.8g", 40, 0.5522847498, 1e-7, 0},
               {"%.8g", 40, 0.551915, 3e-4, 0}, // 2e-4 of the radius inside in its middle
               {"%.3f", 28.346, 0.5523, 1e-4, 0},
               {"%.2f", 40, 0.5523, 1e-4, 0},
               {"%.8g", 40, 0.5522847498, 1e-7, 30}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct dea_text text = {.ctx = ctx};
    double area = cases[i].radius * cases[i].radius * pi;
    int holes = cases[i].holes;
    dea_text_add(&text, "<svg width='100mm' height='100mm' viewBox='0 0 100 100'><g id='a'>");
    add_bezier_circle(&text, cases[i].number, 50, 50, cases[i].radius, cases[i].handle);
    for (int k = 0; k < holes * holes; k++) {
      add_bezier_circle(&text, cases[i].number, 25 + 1.6 * (k % holes), 25 + 1.6 * (k / holes), 0.4,
                        cases[i].handle);
      area -= 0.16 * pi;
    }
    dea_text_add(&text, "</g></svg>");
    struct dea_drawing *drawing = read_svg(dea_text_get(&text));
    struct dea_region region = {.ctx = ctx};
    assert_int_equal(dea_drawing_region(drawing, "a", here, &region), DEA_OK);
    assert_int_equal(region.contour_count, 1 + holes * holes);
    assert_int_equal(region.vertex_count, 4 * region.contour_count);
    assert_close(1e6 * dea_region_area_m2(&region), area, cases[i].tolerance, 0);
    assert_non_null(find_finding(ctx, DEA_NOTE, "curves became circular arcs, to within 0.0"));
    assert_true(drawing->deviation_m < 4e-4 * 1e-3 * cases[i].radius);
    dea_region_free(&region);
    dea_drawing_destroy(drawing);
    dea_text_free(&text);
  }
  // an ellipse of four cubics is none: the area under them, not that of circles
  double area = pi * 20 * 10, per_quarter = 0;
  for (int k = 0; k < 20000; k++) { // of the curve x dy by its middle points
    double t = (k + 0.5) / 20000, u = 1 - t, h = 0.5522847498;
    double x = u * u * u + 3 * u * u * t + 3 * u * t * t * h;
    per_quarter += x * (3 * u * u * h + 6 * u * t * (1 - h)) / 20000;
  }
  area = 4 * per_quarter * 20 * 10;
  expect_about(
      read_svg(SVG("<g transform='translate(50,25) scale(20,10)'><path d='M1,0C1,.5522847498 "
                   ".5522847498,1 0,1-.5522847498,1-1,.5522847498-1,0-1-.5522847498"
                   "-.5522847498-1,0-1,.5522847498-1,1-.5522847498,1,0z'/></g>")),
      area, 97 * 1e-4);
}

static void expect_svg_fault(const char *text, const char *message)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = ctx};
  dea_finding_clear(ctx);
  dea_status status = dea_drawing_read_svg(ctx, "a.svg", text, strlen(text), NULL, &drawing);
  status = status == DEA_OK ? dea_drawing_region(drawing, "a", here, &region) : status;
  if (status != DEA_E_DESIGN || find_error(ctx, message) == NULL) {
    fail_msg("%s: '%s' should hold '%s'", dea_status_name(status), dea_context_message(ctx),
             message);
  }
  dea_drawing_destroy(drawing);
}

/* The unit is known where a side has a length and the view box says how many units it is. */
TEST(test_svg_units)
{
  static const struct {
    const char *root;
    double unit_mm;
    bool known;
  } cases[] = {
      {"width='50mm' height='50mm' viewBox='0 0 100 100'", 0.5, true},
      {"width='50mm' viewBox='0 0 100 100'", 0.5, true},
      {"height='50mm' viewBox='0 0 100 100'", 0.5, true},
      {"height='50mm' viewBox='0 -5 100 100'", 0.5, true},
      {"width='50mm' height='20mm' viewBox='0 0 100 100'", 0.2, true},
      {"width='50mm' height='20mm' viewBox='0 0 100 100' preserveAspectRatio='none'", 0.5, true},
      {"width='50mm' height='20mm' viewBox='0 0 100 100' preserveAspectRatio='xMidYMid slice'", 0.5,
       true},
      {"width='5mm' height='5mm' viewBox='0 0 0.5 0.5'", 10, true},
      {"width='50mm' height='50mm'", 25.4 / 96, false},
      {"width='50mm' height='50mm' viewBox='0 0 0 0'", 25.4 / 96, false},
      {"width='50' height='50' viewBox='0 0 100 100'", 0.5 * 25.4 / 96, false},
      {"viewBox='0 0 100 100'", 25.4 / 96, false}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char text[512];
    snprintf(text, sizeof text,
             "<svg xmlns='http://www.w3.org/2000/svg' %s><g id='a'><circle r='10'/></g></svg>",
             cases[i].root);
    dea_finding_clear(ctx);
    struct dea_drawing *drawing = read_svg(text);
    assert_close(drawing->unit_m, 1e-3 * cases[i].unit_mm, 1e-12, 0);
    if (drawing->unit_is_known != cases[i].known) {
      fail_msg("%s: %s", cases[i].root, drawing->unit_is_known ? "known" : "not known");
    }
    dea_drawing_destroy(drawing);
  }
}

TEST(test_svg_faults)
{
  expect_svg_fault(SVG("<path d='M0 0L10 0L10 10'/>"),
                   "the contour is open (the nearest other end");
  expect_svg_fault(SVG("<path d='M0 0L10 0 x'/>"), "the path is not understood at 'x'");
  expect_svg_fault(SVG("<path d='L10 0'/>"), "the path is not understood at 'L10 0'");
  expect_svg_fault(SVG("<circle r='1' transform='shear(1)'/>"), "the transform 'shear'");
  expect_svg_fault(SVG("<circle r='1'>"), "the file is no sound XML: mismatched tag");
  expect_svg_fault("<html/>", "the file is no SVG but 'html'");
  expect_svg_fault(SVG("<polygon points='0,0 6 0 0'/>"), "a point has an x and no y");
  expect_svg_fault(SVG("<circle r='2em'/>"), "r '2em' is no length that is understood");
  expect_svg_fault("<svg><rect width='5%' height='1'/></svg>", "width '5%' is no length");
  // a drawing within is named
  expect(read_svg(SVG("<circle r='1'/><svg viewBox='0 0 1 1'><circle r='3'/></svg>")), "a", pi, 1);
  assert_non_null(find_finding(ctx, DEA_WARNING, "layer 'a': 1 of the kind svg is not read"));
  struct dea_drawing *drawing = read_svg(SVG("<text>x</text><use/><circle r='1'/>"));
  expect(drawing, "a", pi, 1);
  assert_non_null(find_finding(ctx, DEA_WARNING, "layer 'a': 1 of the kind text is not read"));
}

static dea_status read_some(struct dea_context *own)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = own};
  static const char text[] = FILE_OF(
      "", BLOCK(b, 0, 0, "0\nSPLINE\n8\n0\n71\n1\n40\n0\n40\n0\n40\n1\n40\n1\n" AT(5, 9) AT(7, 9)),
      INSERT(a, b, "") INSERT(a, b, AT(0, 2) "42\n-1\n")
          LINE(a, 7, 9, 7, -7) "0\nLWPOLYLINE\n8\na\n" AT(5, 9) AT(5, -7) LINE(a, 0, 0, 2, 0)
              LINE(a, 2, 0, 2, 2) LINE(a, 2, 2, 0, 0) CIRCLE(\xe9, 5, 5, 1) "0\nX\n");
  dea_status status = dea_drawing_read_dxf(own, "a.dxf", text, strlen(text), NULL, &drawing);
  status = status == DEA_OK ? dea_drawing_region(drawing, "a", here, &region) : status;
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  return status;
}

static dea_status read_some_svg(struct dea_context *own)
{
  static const char text[] = SVG("<path d='M0 0h9q1 1 2 2z'/><text/>");
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = own};
  dea_status status = dea_drawing_read_svg(own, "a.svg", text, sizeof text - 1, NULL, &drawing);
  status = status == DEA_OK ? dea_drawing_region(drawing, "a", here, &region) : status;
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  return status;
}

TEST(test_memory)
{
  assert_true(failing_ends(read_some, DEA_OK) > 20);
  assert_true(failing_ends(read_some_svg, DEA_OK) > 20);
}

TESTS(workshop_set_up, workshop_tear_down)
