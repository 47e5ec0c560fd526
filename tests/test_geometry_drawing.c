/* Drawings from DXF and SVG files: areas against closed forms and against the project's own writer,
 * what is said of what is not read, and faults with their place. */
#include "fabricate/dxf.h"
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

static void test_dxf_entities(void **state)
{
  (void)state;
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
  // ends 0.4 um apart are one
  expect(read_dxf(LINE(a, 0, 0, 2, 0) LINE(a, 2, 0.0004, 2, 2) LINE(a, 2, 2, 0, 0)), "a",
         2 - 0.0004, 1);
}

static void test_units(void **state)
{
  (void)state;
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

static void expect_fault(const char *entities, const char *layer, size_t line, const char *message)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = ctx};
  dea_finding_clear(ctx);
  dea_status status = read_dxf_as(ctx, "", entities, &drawing);
  if (status == DEA_OK) {
    status = dea_drawing_region(drawing, layer, here, &region);
  }
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

static void test_dxf_faults(void **state)
{
  (void)state;
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

static void test_svg_elements(void **state)
{
  (void)state;
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

/* Curves become lines to within the tolerance that is told. */
static void test_svg_curves(void **state)
{
  (void)state;
  struct dea_drawing *drawing = read_svg(SVG("<ellipse cx='20' cy='20' rx='10' ry='5'/>"));
  assert_non_null(find_finding(ctx, DEA_NOTE, "became lines, to within 0.0001 mm"));
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

static void expect_svg_fault(const char *text, const char *message)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = ctx};
  dea_finding_clear(ctx);
  dea_status status = dea_drawing_read_svg(ctx, "a.svg", text, strlen(text), NULL, &drawing);
  if (status == DEA_OK) {
    status = dea_drawing_region(drawing, "a", here, &region);
  }
  if (status != DEA_E_DESIGN || find_error(ctx, message) == NULL) {
    fail_msg("%s: '%s' should hold '%s'", dea_status_name(status), dea_context_message(ctx),
             message);
  }
  dea_drawing_destroy(drawing);
}

/* The unit is known where a side has a length and the view box says how many units it is. */
static void test_svg_units(void **state)
{
  (void)state;
  static const struct {
    const char *root;
    double unit_mm;
    bool known;
  } cases[] = {{"width='50mm' height='50mm' viewBox='0 0 100 100'", 0.5, true},
               {"width='50mm' viewBox='0 0 100 100'", 0.5, true},
               {"height='50mm' viewBox='0 0 100 100'", 0.5, true},
               {"height='50mm' viewBox='0 -5 100 100'", 0.5, true},
               {"width='50mm' height='20mm' viewBox='0 0 100 100'", 0.2, true},
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

static void test_svg_faults(void **state)
{
  (void)state;
  expect_svg_fault(SVG("<path d='M0 0L10 0L10 10'/>"),
                   "the contour is open (the nearest other end");
  expect_svg_fault(SVG("<path d='M0 0L10 0 x'/>"), "the path is not understood at 'x'");
  expect_svg_fault(SVG("<path d='L10 0'/>"), "the path is not understood at 'L10 0'");
  expect_svg_fault(SVG("<circle r='1' transform='shear(1)'/>"), "the transform 'shear'");
  expect_svg_fault(SVG("<circle r='1'>"), "the file is no sound XML: mismatched tag");
  expect_svg_fault("<html/>", "the file is no SVG but 'html'");
  expect_svg_fault(SVG("<polygon points='0,0 6 0 0'/>"), "a point has an x and no y");
  struct dea_drawing *drawing = read_svg(SVG("<text>x</text><use/><circle r='1'/>"));
  expect(drawing, "a", pi, 1);
  assert_non_null(find_finding(ctx, DEA_WARNING, "layer 'a': 1 of the kind text is not read"));
}

/* Every part of a design as the project's own writer writes it. */
static void test_round_trip(void **state)
{
  (void)state;
  assert_int_equal(workshop_make(GOOD_DESIGN, NULL, 0), DEA_OK);
  size_t seen = 0;
  for (size_t i = 0; i < workshop->count; i++) {
    const struct dea_part *part = &workshop->part[i];
    struct dea_text text = {.ctx = ctx};
    struct dea_drawing *drawing;
    struct dea_region outer = {.ctx = ctx};
    assert_int_equal(dea_dxf_write(workshop, i, &text), DEA_OK);
    assert_int_equal(dea_drawing_read_dxf(ctx, part->name, text.data, text.length, NULL, &drawing),
                     DEA_OK);
    double wanted = 0;
    for (size_t c = 0; c < part->contour_count; c++) {
      struct dea_vertex *path;
      size_t count;
      if (part->contour[c].layer == DEA_LAYER_CUT_OUTER) {
        assert_int_equal(dea_workshop_path(workshop, part, c, &path, &count), DEA_OK);
        const struct dea_contour contour = {path, count, true};
        wanted += dea_contour_area_m2(&contour);
        dea_free(ctx, path);
      }
    }
    if (wanted > 0) {
      assert_int_equal(dea_drawing_region(drawing, "CUT_OUTER", here, &outer), DEA_OK);
      assert_close(dea_region_area_m2(&outer), wanted * workshop->layout[i].count, 1e-9, 0);
      seen++;
    }
    dea_region_free(&outer);
    dea_drawing_destroy(drawing);
    dea_text_free(&text);
  }
  assert_true(seen > 2);
}

static dea_status read_some(struct dea_context *own)
{
  struct dea_drawing *drawing;
  struct dea_region region = {.ctx = own};
  dea_status status = read_dxf_as(own, "",
                                  LINE(a, 0, 0, 2, 0) LINE(a, 2, 0, 2, 2) LINE(a, 2, 2, 0, 0)
                                      CIRCLE(a, 5, 5, 1) "0\nX\n",
                                  &drawing);
  if (status == DEA_OK) {
    status = dea_drawing_region(drawing, "a", here, &region);
  }
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
  if (status == DEA_OK) {
    status = dea_drawing_region(drawing, "a", here, &region);
  }
  dea_region_free(&region);
  dea_drawing_destroy(drawing);
  return status;
}

static void test_memory(void **state)
{
  (void)state;
  assert_true(failing_ends(read_some, DEA_OK) > 20);
  assert_true(failing_ends(read_some_svg, DEA_OK) > 20);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_dxf_entities), cmocka_unit_test(test_units),
      cmocka_unit_test(test_dxf_faults),   cmocka_unit_test(test_svg_elements),
      cmocka_unit_test(test_svg_curves),   cmocka_unit_test(test_svg_faults),
      cmocka_unit_test(test_svg_units),    cmocka_unit_test(test_round_trip),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, workshop_set_up, workshop_tear_down);
}
