/* Parts of devices of any layout: sizes and areas against closed forms, in the film in which they
 * are cut, and what cannot be cut. */
#include "workshop_fixture.h"

#include "fabricate/dxf_write.h"
#include "fabricate/layout_parts.h"
#include "fabricate/process.h"
#include "geometry/drawing.h"

static const double pi = 3.14159265358979323846;

/* A film of 40 mm x 24 mm, stretched along x and y, with a bottom electrode secondary of the middle
 * and others on top, and a stiff ring on it. */
#define DEVICE(stretch, more)                                                                      \
  "dea: 1\n"                                                                                       \
  "shapes:\n"                                                                                      \
  "  - {name: film, kind: rectangle, width: 40 mm, height: 24 mm}\n"                               \
  "  - {name: aside, kind: rectangle, x: 8 mm, y: 3 mm, width: 12 mm, height: 9 mm}\n"             \
  "  - {name: disc, kind: circle, x: 8 mm, radius: 3 mm}\n"                                        \
  "  - {name: ring, kind: ring, x: -8 mm, inner_radius: 4 mm, outer_radius: 6 mm}\n"               \
  "plies:\n"                                                                                       \
  "  - {name: film, shape: film, material: film, thickness: 100 um, pre_stretch: " stretch "}\n"   \
  "  - {name: 'a stiff/ring', shape: ring, material: stiff, thickness: 50 um}\n"                   \
  "electrodes:\n"                                                                                  \
  "  - {ply: film, side: bottom, shape: aside, channel: ground}\n"                                 \
  "  - {ply: film, side: top, shape: disc, channel: one}\n"                                        \
  "  - {ply: film, side: top, shape: ring, channel: two}\n" more FILM_MATERIAL

static const struct dea_part *find(const char *name)
{
  const struct dea_part *part = workshop_find(name);
  assert_non_null(part);
  return part;
}

/* Area of all contours of a layer, and the box around them. */
static double layer_area(const struct dea_part *part, enum dea_layer layer, double box[4])
{
  double area = 0;
  box[0] = box[1] = INFINITY;
  box[2] = box[3] = -INFINITY;
  for (size_t i = 0; i < part->contour_count; i++) {
    const struct dea_contour contour = part->contour[i].path;
    if (part->contour[i].layer == layer) {
      area += dea_contour_area_m2(&contour);
      dea_contour_grow_box(&contour, box);
    }
  }
  return area;
}

/* What is cut before the film is stretched is smaller by its two pre-stretches. */
TEST(test_unstretched)
{
  assert_int_equal(workshop_make(DEVICE("[1.25, 1.6]", ""), NULL, 0), DEA_OK);
  const double l1 = 1.25, l2 = 1.6;
  double box[4];
  // film, gap of 5 mm, frame of 10 mm, margin of 10 mm on all sides
  double area = layer_area(find("blank-film"), DEA_LAYER_CUT_OUTER, box);
  assert_close(box[2] - box[0], (40 + 50) * 1e-3 / l1, 1e-12, 0);
  assert_close(box[3] - box[1], (24 + 50) * 1e-3 / l2, 1e-12, 0);
  assert_close(area, 90e-3 * 74e-3 / (l1 * l2), 1e-12, 0);
  // what is below is seen from there: its middle lies at -8 mm then; marks are round when stretched
  const struct dea_part *bottom = find("stencil-film-bottom");
  assert_true(bottom->mirrored);
  const struct dea_contour opening = bottom->contour[0].path;
  double place[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  dea_contour_grow_box(&opening, place);
  assert_close(place[0], -14e-3 / l1, 1e-12, 0);
  assert_close(place[2], -2e-3 / l1, 1e-12, 0);
  assert_close(place[1], -1.5e-3 / l2, 1e-12, 0);
  double radius = 0.5e-3 * sqrt(l1 * l2), marks = 3 * pi * radius * radius;
  assert_close(layer_area(bottom, DEA_LAYER_CUT_INNER, box), (108e-6 + marks) / (l1 * l2), 1e-8, 0);
  // circles become ellipses, and the inside of the ring is a loose piece
  const struct dea_part *top = find("stencil-film-top");
  double loose = pi * 16e-6;
  assert_close(layer_area(top, DEA_LAYER_CUT_INNER, box), (pi * 45e-6 + marks) / (l1 * l2), 1e-7,
               0);
  assert_close(dea_part_area_m2(top), (90e-3 * 74e-3 - pi * 29e-6 - marks) / (l1 * l2), 1e-7, 0);
  assert_int_equal(dea_part_pieces(top), 2);
  assert_non_null(find_finding(ctx, DEA_NOTE, "1 piece within an electrode is loose"));
  struct dea_amounts a; // marks are printed too
  dea_amounts_find(workshop, &a);
  assert_close(a.ink_area_m2, (108e-6 + pi * 45e-6 - loose + 2 * marks) / (l1 * l2), 1e-7, 0);
}

/* What is cut in the flat film has the lengths of the design; the frame goes once the film is cut
 * along its outline. */
TEST(test_flat)
{
  assert_int_equal(workshop_make(DEVICE("1.3", ""), NULL, 0), DEA_OK);
  double box[4];
  assert_close(dea_part_area_m2(find("ply-a-stiff-ring")), pi * 20e-6, 1e-12, 0);
  assert_close(dea_part_area_m2(find("ply-film")), 960e-6, 1e-12, 0);
  layer_area(find("frame"), DEA_LAYER_CUT_OUTER, box);
  assert_close(box[2] - box[0], 70e-3, 1e-12, 0);
  double marks = 3 * pi * 0.25e-6 * 1.69; // 1 mm unstretched
  assert_close(dea_part_area_m2(find("frame")), 70e-3 * 54e-3 - 50e-3 * 34e-3 - marks, 1e-12, 0);
  assert_true(find("template")->paper);
  // an edge that is held stays on the frame, whose opening it is
  assert_int_equal(workshop_make(DEVICE("1.3", "supports: [{edge: film}]\n"), NULL, 0), DEA_OK);
  assert_null(workshop_find("ply-film"));
  assert_close(dea_part_area_m2(find("frame")), 60e-3 * 44e-3 - 960e-6 - marks, 1e-12, 0);
  // a film that is not stretched needs no frame, and is cut as it is
  assert_int_equal(workshop_make(DEVICE("1", ""), NULL, 0), DEA_OK);
  assert_null(workshop_find("frame"));
  assert_null(workshop_find("blank-film"));
  assert_close(dea_part_area_m2(find("ply-film")), 960e-6, 1e-12, 0);
  assert_string_equal(dea_part_film_name(find("ply-film")), "flat");
}

/* Axes of the pre-stretch at an angle: a square of film becomes a parallelogram, of which
 * stretching makes the square again. */
TEST(test_turned_axes)
{
  assert_int_equal(workshop_make(DEVICE("[1.2, 1.5], angle: 30 degree", ""), NULL, 0), DEA_OK);
  const struct dea_part *blank = find("blank-film");
  const double c = cos(pi / 6), s = sin(pi / 6);
  for (size_t i = 0; i < blank->contour_count; i++) {
    const struct dea_contour contour = blank->contour[i].path;
    for (size_t k = 0; k < contour.count && blank->contour[i].layer == DEA_LAYER_CUT_OUTER; k++) {
      double x = contour.vertex[k].x_m, y = contour.vertex[k].y_m;
      double first = 1.2 * (c * x + s * y), across = 1.5 * (c * y - s * x); // along the axes
      assert_close(fabs(c * first - s * across), 45e-3, 1e-12, 0);
      assert_close(fabs(s * first + c * across), 37e-3, 1e-12, 0);
    }
  }
  double box[4];
  const struct dea_part *bottom = find("stencil-film-bottom");
  double marks = 3 * pi * 0.25e-6 * 1.8;
  assert_close(layer_area(bottom, DEA_LAYER_CUT_INNER, box), (108e-6 + marks) / 1.8, 1e-7, 0);
}

/* Marks on a frame of any proportions: a sheet that is turned over or around does not fit. */
TEST(test_marks_beside_rectangles)
{
  static const char *const heights[] = {"4 mm", "12 mm", "24 mm", "60 mm", "200 mm"};
  for (size_t i = 0; i < 5; i++) {
    const struct dea_override sets[] = {{"shapes[0].height", heights[i]},
                                        {"shapes[1].height", "2 mm"},
                                        {"shapes[1].y", "0 mm"},
                                        {"shapes[2].radius", "1 mm"},
                                        {"shapes[3].outer_radius", "1.9 mm"},
                                        {"shapes[3].inner_radius", "0.6 mm"},
                                        {"fabrication.sheet.height", "400 mm"}};
    assert_int_equal(workshop_make(DEVICE("1.3", ""), sets, 7), DEA_OK);
    double side[3];
    for (size_t k = 0; k < 3; k++) {
      const double *a = workshop->plan.mark_at_m[k], *b = workshop->plan.mark_at_m[(k + 1) % 3];
      side[k] = hypot(a[0] - b[0], a[1] - b[1]);
    }
    for (size_t k = 0; k < 3; k++) {
      assert_true(fabs(side[k] - side[(k + 1) % 3]) > 1e-3);
    }
  }
}

/* Films that are alike have one file, and faces that are. */
TEST(test_alike)
{
  static const char text[] =
      "dea: 1\nshapes:\n"
      "  - {name: film, kind: circle, radius: 10 mm}\n"
      "  - {name: active, kind: circle, radius: 5 mm}\n"
      "plies:\n"
      "  - {name: a b, shape: film, material: film, thickness: 20 um}\n"
      "  - {name: a-b, shape: film, material: film, thickness: 30 um}\n"
      "  - {name: c, shape: film, material: film, thickness: 20 um}\n"
      "electrodes:\n"
      "  - {ply: a b, side: bottom, shape: active, channel: ground}\n"
      "  - {ply: a b, side: top, shape: active, channel: drive}\n"
      "  - {ply: a-b, side: top, shape: active, channel: ground}\n"
      "  - {ply: c, side: top, shape: active, channel: drive}\n" FILM_MATERIAL;
  assert_int_equal(workshop_make(text, NULL, 0), DEA_OK);
  assert_int_equal(find("ply-a-b-1")->quantity, 2); // names that give the same file have numbers
  assert_int_equal(find("ply-a-b-2")->quantity, 1);
  assert_null(workshop_find("ply-c"));
  find("stencil-a-b-1-bottom");
  find("stencil-a-b-1-top");
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(dea_face_like(device->layout, i, true), 0);
  }
  assert_int_equal(workshop->count, 5); // and the template
}

static void expect_refusal(const char *text, const char *key, const char *value, const char *said)
{
  const struct dea_override set = {key, value};
  assert_int_equal(workshop_make(text, &set, 1), DEA_E_DESIGN);
  if (find_error(ctx, said) == NULL) {
    print_findings(ctx);
    fail_msg("nothing says '%s'", said);
  }
}

/* A round film with electrodes off its middle: leads to pads halfway on the ring, in the direction
 * that is asked for, by closed forms; and leads that cannot be. */
TEST(test_leads)
{
  static const char text[] =
      "dea: 1\nshapes:\n"
      "  - {name: film, kind: circle, radius: 20 mm}\n"
      "  - {name: left, kind: circle, x: -6 mm, radius: 4 mm}\n"
      "  - {name: right, kind: circle, x: 6 mm, radius: 4 mm}\n"
      "plies: [{name: film, shape: film, material: film, thickness: 100 um, pre_stretch: 1.25}]\n"
      "supports: [{edge: film}]\n"
      "electrodes:\n"
      "  - {ply: film, side: bottom, shape: right, channel: ground, lead: 45 degree}\n"
      "  - {ply: film, side: top, shape: right, channel: drive, lead: 0 degree}\n"
      "  - {ply: film, side: top, shape: left, channel: other, lead: 180 degree}\n"
      "fabrication: {leads: {width: 2 mm stretched, pad_diameter: 5 mm stretched}}\n" FILM_MATERIAL;
  static const char no_frame[] = DEVICE("1.3", "");
  assert_int_equal(workshop_make(text, NULL, 0), DEA_OK);
  const double R = 25, c = 6 * cos(pi / 4), along = -c + sqrt(c * c + R * R - 36);
  const double cut = 16 * asin(1.0 / 4) - sqrt(15), pad = 6.25 * asin(1 / 2.5) - sqrt(5.25);
  const double lead = 2 * (R - 6 - sqrt(15) - sqrt(5.25)); // straight outwards, between the arcs
  const double one = 16 * pi - cut + lead + 6.25 * pi - pad;
  const double marks = 3 * pi * 0.25 * 1.25 * 1.25;
  double box[4];
  assert_close(layer_area(find("stencil-film-top"), DEA_LAYER_CUT_INNER, box),
               1e-6 * (2 * one + marks) / 1.5625, 1e-9, 0);
  assert_close(box[2], (R + 2.5) * 1e-3 / 1.25, 1e-9, 0);
  const double slanted = one + 2 * (along - (R - 6));
  assert_close(layer_area(find("stencil-film-bottom"), DEA_LAYER_CUT_INNER, box),
               1e-6 * (slanted + marks) / 1.5625, 1e-9, 0);
  // a ring with its window over the pad below, and round films
  assert_close(dea_part_area_m2(find("frame")), 1e-6 * (pi * (900 - 400 - 1.5 * 1.5) - marks), 1e-9,
               0);
  assert_close(dea_part_area_m2(find("blank-film")), 1e-6 * pi * 1600 / 1.5625, 1e-9, 0);
  // across the film of another channel's electrode, and where no frame stays
  expect_refusal(text, "electrodes[1].lead", "180 degree", "touch on one face");
  expect_refusal(text, "electrodes[0].lead", "180 degree", "active film that is not in the design");
  expect_refusal(no_frame, "electrodes[0].lead", "0 degree", "but no frame stays");
}

/* A disc written either way is cut alike. */
TEST(test_disc_in_both_forms)
{
  static const char *const texts[] = {
      "dea: 1\nfilm: {material: film, thickness: 100 um}\npre_stretch: 1.5\n"
      "frame: {inner_radius: 15 mm}\nelectrodes: {radius: 4 mm stretched}\n" FILM_MATERIAL,
      "dea: 1\nshapes:\n  - {name: film, kind: circle, radius: 15 mm}\n"
      "  - {name: active, kind: circle, radius: 4 mm}\n"
      "plies: [{name: film, shape: film, material: film, thickness: 100 um, pre_stretch: 1.5}]\n"
      "supports: [{edge: film}]\nelectrodes:\n"
      "  - {ply: film, side: bottom, shape: active, channel: ground, lead: 180 degree}\n"
      "  - {ply: film, side: top, shape: active, channel: drive, lead: 0 degree}\n" FILM_MATERIAL};
  struct dea_amounts amounts[2];
  double area[2][8], length[2][8];
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(workshop_make(texts[k], NULL, 0), DEA_OK);
    dea_amounts_find(workshop, &amounts[k]);
    assert_int_equal(workshop->count, 5);
    for (size_t i = 0; i < 5; i++) {
      area[k][i] = dea_part_area_m2(&workshop->part[i]);
      length[k][i] = dea_part_length_m(&workshop->part[i], DEA_LAYER_CUT_INNER) +
                     dea_part_length_m(&workshop->part[i], DEA_LAYER_MARK);
    }
  }
  for (size_t i = 0; i < 5; i++) {
    assert_close(area[1][i], area[0][i], 1e-12, 0);
    assert_close(length[1][i], length[0][i], 1e-12, 0);
  }
  assert_close(amounts[1].ink_area_m2, amounts[0].ink_area_m2, 1e-12, 0);
  assert_close(amounts[1].film_area_m2, amounts[0].film_area_m2, 1e-12, 0);
}

TEST(test_refusals)
{
  static const char good[] = DEVICE("1.3", "");
  expect_refusal(good, "fabrication.minimum_feature", "2.5 mm",
                 "only 2 mm lie between two edges at");
  // a round edge is no web, however small; what is too small across is told
  static const char round[] = DEVICE("[1.3, 1.2]", "");
  expect_refusal(round, "fabrication.marks.diameter", "0.45 mm unstretched", "lie between two");
  expect_refusal(good, "fabrication.kerf", "1 mm", "makes no features");
  expect_refusal(good, "fabrication.sheet.width", "50 mm", "is too small for the part");
  expect_refusal(good, "fabrication.frame.width", "1.5 mm", "alignment marks of 1.3 mm");
  expect_refusal(good, "fabrication.copies", "30", "copies: a sheet of");
}

/* A sheet as it is written, without kerf, read back. */
TEST(test_sheet_read_back)
{
  const struct dea_override sharp = {"fabrication.kerf", "0 mm"};
  const struct dea_location here = {0};
  assert_int_equal(workshop_make(DEVICE("[1.25, 1.6]", ""), &sharp, 1), DEA_OK);
  for (size_t i = 0; i < workshop->count; i++) {
    const struct dea_part *part = &workshop->part[i];
    struct dea_text text = {.ctx = ctx};
    struct dea_drawing *drawing;
    struct dea_region outer = {.ctx = ctx};
    double box[4];
    if (part->paper || strncmp(part->name, "stencil", 7) == 0) {
      continue; // of a stencil with loose pieces one layer is no region by itself
    }
    assert_int_equal(dea_dxf_write(workshop, i, &text), DEA_OK);
    assert_int_equal(dea_drawing_read_dxf(ctx, part->name, text.data, text.length, NULL, &drawing),
                     DEA_OK);
    assert_int_equal(dea_drawing_region(drawing, "CUT_OUTER", here, &outer), DEA_OK);
    assert_close(dea_region_area_m2(&outer), layer_area(part, DEA_LAYER_CUT_OUTER, box), 1e-9, 0);
    dea_region_free(&outer);
    dea_drawing_destroy(drawing);
    dea_text_free(&text);
  }
}

TESTS(workshop_set_up, workshop_tear_down)
