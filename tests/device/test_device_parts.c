/* Designs of the general form: the layout that is made of their parts, and what a bad one says. */
// ctest: slow
#include "design_text.h"
#include "failing_allocator.h"
#include "model/model.h"
#include "result/columns.h"
#include "study/design_gradient.h"

#include <math.h>

#include "context_fixture.h" // after: its context shadows no name of the headers above

/* A design of which a line each can be replaced. */
enum line { SHAPES = 2, PLIES, ELECTRODES, SUPPORTS, MORE, LINES };
// a film that ends at a pre-stretch of about 2 in one direction
#define LOCKS                                                                                      \
  "  - {name: locks, kind: elastomer, laws: [{id: g, law: gent, parameters: {mu: 9 kPa, jm: "      \
  "1.8}, "                                                                                         \
  "source: s}]}\n"
#define THREE_SHAPES                                                                               \
  "shapes: [{name: film, kind: rectangle, width: 40 mm, height: 10 mm}, "                          \
  "{name: active, kind: rectangle, width: 30 mm, height: 8 mm}, "                                  \
  "{name: far, kind: circle, x: 90 mm, radius: 2 mm}"
static const char *const usual[LINES] = {
    [SHAPES] = THREE_SHAPES "]",
    [PLIES] = "plies: [{name: lower, shape: film, material: film, thickness: 100 um, "
              "pre_stretch: [1.2, 1.5]}, "
              "{name: upper, shape: film, material: film, thickness: 60 um}]",
    [ELECTRODES] = "electrodes: [{ply: lower, side: bottom, shape: active, channel: ground}, "
                   "{ply: lower, side: top, shape: active, channel: drive}]",
    [SUPPORTS] = "supports: [{edge: film}]",
    [MORE] = "title: two films",
};

#define DRAWINGS DEA_SOURCE_DIR "/tests/cases/drawings/"

static const char *write_lines(const char *const lines[LINES], enum line which, const char *text)
{
  static char all[8192];
  size_t used = (size_t)snprintf(all, sizeof all, "dea: 1\n");
  for (int i = SHAPES; i < LINES; i++) {
    used +=
        (size_t)snprintf(all + used, sizeof all - used, "%s\n", i == (int)which ? text : lines[i]);
  }
  snprintf(all + used, sizeof all - used, "%s", FILM_MATERIAL LOCKS);
  return all;
}

static const char *write_design(enum line which, const char *text)
{
  return write_lines(usual, which, text);
}

static struct dea_design *design;
static struct dea_device *device;

static const struct dea_layout *build(enum line which, const char *text)
{
  dea_finding_clear(ctx);
  if (read_and_build(ctx, write_design(which, text), NULL, 0, &design, &device) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_true(!device->disc);
  return device->layout;
}

static void drop(void)
{
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  device = NULL;
  design = NULL;
}

TEST(test_plies_and_electrodes)
{
  const struct dea_layout *l = build(0, NULL);
  assert_int_equal(l->ply_count, 2);
  assert_string_equal(l->plies[0].name, "lower");
  assert_string_equal(l->regions[l->plies[0].region].name, "film");
  assert_close(l->plies[0].thickness_unstretched_m, 100e-6, 0, 1e-18);
  assert_close(l->plies[0].thickness_m, 100e-6 / 1.8, 0, 1e-18);
  assert_close(l->plies[0].pre_stretch[1], 1.5, 0, 1e-15);
  assert_close(l->plies[1].pre_stretch[1], 1, 0, 1e-15);
  assert_true(dea_layout_is_dielectric(l, 0));
  assert_false(dea_layout_is_dielectric(l, 1));
  assert_int_equal(l->channel_count, 2);
  assert_string_equal(l->channels[1].name, "drive");
  assert_close(l->channels[1].ratio, 1, 0, 0);
  assert_true(l->electrodes[1].top);
  assert_int_equal(l->electrodes[1].channel, 1);
  assert_int_equal(l->electrodes[0].channel, 0);
  assert_true(l->supports[0].edge);
  assert_int_equal(l->supports[0].components, 7);
  assert_int_equal(l->symmetry.order, 2); // of a rectangle, with the film's axes along it
  assert_int_equal(l->symmetry.mirrors, 2);
  drop();
}

TEST(test_bodies_springs_monitors)
{
  const struct dea_layout *l = build(
      MORE, "bodies: [{name: plate, shape: active, free: [z, turn_x], mass: 20 g, "
            "force_z: 1 mN, move_x: 2 mm}]\n"
            "springs: [{body: plate, direction: z, stiffness: 10 N/m, free_at: 1 mm}, "
            "{body: plate, direction: turn_x, table: [[0 radian, 0 N.m], [1 radian, 3 mN.m]]}]\n"
            "pressures: [{ply: lower, side: bottom, shape: film, pressure: 1 kPa}]\n"
            "monitors: [{name: middle, at: [0 mm, 1 mm]}, "
            "{name: gauge, from: [-5 mm, 0 mm], to: [5 mm, 0 mm], ply: lower}, "
            "{name: field, shape: active, ply: lower}, {name: plate, body: plate}]\n"
            "gravity: top_up");
  const struct dea_layout_body *b = &l->bodies[0];
  assert_int_equal(b->free, 4 + 8);
  assert_int_equal(b->moved, 1);
  assert_close(b->shift_m[0], 2e-3, 0, 1e-18);
  assert_close(b->mass_kg, 0.02, 0, 1e-15);
  assert_close(b->force_N[2], 1e-3, 0, 1e-15);
  assert_close(l->springs[0].stiffness, 10, 0, 1e-12);
  assert_close(l->springs[0].free_at, 1e-3, 0, 1e-15);
  assert_int_equal(l->springs[1].component, 3);
  assert_int_equal(l->springs[1].count, 2);
  assert_close(l->springs[1].force[1], 3e-3, 0, 1e-15);
  assert_close(l->pressures[0].pressure_Pa, 1000, 0, 1e-9);
  assert_int_equal(l->monitors[0].kind, DEA_MONITOR_POINT);
  assert_int_equal(l->monitors[0].ply, 1); // the uppermost one
  assert_close(l->monitors[1].at_m[1][0], 5e-3, 0, 1e-15);
  assert_int_equal(l->monitors[3].kind, DEA_MONITOR_BODY);
  assert_true(l->gravity_m_per_s2[2] < -9.7);
  drop();
}

/* Areas of what is made of other shapes, by closed forms. */
TEST(test_shapes_of_shapes)
{
  static const struct {
    const char *shape;
    double area_mm2, centre_mm[2];
  } made[] = {
      {"kind: difference, of: [film, active]", 400 - 240, {0, 0}},
      {"kind: union, of: [active, film]", 400, {0, 0}},
      {"kind: intersection, of: [film, active]", 240, {0, 0}},
      {"kind: array, of: dot, count_x: 3, pitch_x: 5 mm, count_y: 2, pitch_y: -3 mm", 6, {5, -1.5}},
      {"kind: array, of: dot, count_x: 3, pitch_x: 0.5 mm", 2, {0.5, 0}}, // they overlap
      {"kind: polar, of: away, count: 4", 4, {0, 0}},
      {"kind: polar, of: away, count: 2, angle: 90 degree", 2, {2, 2}},
      {"kind: copy, of: away, angle: 90 degree, x: 1 mm", 1, {1, 4}},
      {"kind: copy, of: away, mirror: 90 degree", 1, {-4, 0}},
      {"kind: polygon, points: [[0 mm, 0 mm], [3 mm, 0 mm], [0 mm, 3 mm]]", 4.5, {1, 1}},
      {"kind: ring, inner_radius: 1 mm, outer_radius: 2 mm", 3 * 3.14159265358979323846, {0, 0}},
  };
  for (size_t i = 0; i < sizeof made / sizeof made[0]; i++) {
    char line[1000];
    double centre[2];
    snprintf(line, sizeof line,
             "shapes: [{name: made, %s}, {name: dot, kind: rectangle, width: 1 mm, height: 1 mm}, "
             "{name: away, kind: rectangle, x: 4 mm, width: 1 mm, height: 1 mm}, %s",
             made[i].shape, usual[SHAPES] + strlen("shapes: ["));
    const struct dea_layout *l = build(SHAPES, line);
    const struct dea_region *r = &l->regions[0].region;
    assert_close(1e6 * dea_region_area_m2(r), made[i].area_mm2, 0, 1e-9 * made[i].area_mm2);
    dea_region_centroid_m(r, centre);
    assert_close(1e3 * centre[0], made[i].centre_mm[0], 0, 1e-9);
    assert_close(1e3 * centre[1], made[i].centre_mm[1], 0, 1e-9);
    drop();
  }
}

/* A line of the design, what is wrong with it, and at which words of the line. */
static const struct {
  enum line which;
  const char *text, *part, *at;
} bad[] = {
    // names
    {PLIES, "plies: [{name: lower, shape: flim, material: film, thickness: 1 um}]",
     "no shape 'flim'; did you mean 'film'?", "flim"},
    {PLIES, "plies: [{name: lower, shape: film, material: flim, thickness: 1 um}]", "flim", "flim"},
    {ELECTRODES, "electrodes: [{ply: lowest, side: top, shape: film, channel: drive}]",
     "no ply 'lowest'; did you mean 'lower'?", "lowest"},
    {MORE, "springs: [{body: hub, direction: z, stiffness: 1 N/m}]",
     "there is no body 'hub'; there are none", "hub,"},
    {SHAPES, THREE_SHAPES ", {name: a, kind: oval}]", "there is no shape 'oval'", "oval"},
    {SHAPES, THREE_SHAPES ", {name: a, kind: circle, radius: 2 mm, diameter: 4 mm}]",
     "unknown key 'diameter'", "diameter"},
    // materials
    {PLIES,
     "plies: [{name: lower, shape: film, material: film, thickness: 1 um}, {name: upper, shape: "
     "film, material: locks, thickness: 1 um, pre_stretch: [1.2, 2]}]",
     "ends before the pre-stretch 2 of ply 'upper'", "1.2, 2]"},
    // shapes
    {SHAPES,
     THREE_SHAPES ", {name: a, kind: copy, of: b}, {name: b, kind: copy, of: c}, "
                  "{name: c, kind: copy, of: a}]",
     "the shape 'a' is made of itself: its 'c' needs it again", "a}]"},
    {SHAPES,
     THREE_SHAPES ", {name: a, kind: polygon, points: [[0 mm, 0 mm], [2 mm, 2 mm], [2 mm, 0 mm], "
                  "[0 mm, 1 mm]]}]",
     "crosses or touches itself at (0.666667, 0.666667) mm", "a, kind"},
    {SHAPES,
     THREE_SHAPES ", {name: a, kind: polygon, points: [[0 mm, 0 mm], [1 mm, 1 mm], [1 mm, 2]]}]",
     "'2' has no unit", "2]]"},
    {SHAPES, THREE_SHAPES ", {name: far, kind: circle, radius: 1 mm}]",
     "the name 'far' is taken by the shape in line 2", "far, kind: circle, radius: 1"},
    {SHAPES, THREE_SHAPES ", {name: c, kind: intersection, of: [film, far]}]",
     "nothing is left of the shape 'c'", "c, kind"},
    {SHAPES, THREE_SHAPES ", {name: a, kind: drawing, file: no.dxf, layer: CUT}]", "no.dxf",
     "no.dxf"},
    {SHAPES,
     THREE_SHAPES ", {name: a, kind: drawing, file: " DRAWINGS "dxf/inch.dxf, layer: 0, unit: mm}]",
     "dxf/inch.dxf is 25.4 mm, as the file itself says: leave 'unit' out, or change the file",
     "mm}]"},
    // where things lie
    {ELECTRODES,
     "electrodes: [{ply: lower, side: top, shape: active, channel: one}, "
     "{ply: upper, side: bottom, shape: film, channel: two}]",
     "electrodes of the channels 'one' and 'two' lie on each other on one face of 'upper', about "
     "(0, 0) mm: 240 mm2",
     "film, channel: two"},
    {PLIES, "plies: [{name: lower, shape: film, material: film, thickness: 1 kV}]",
     "'1 kV' is a voltage, but a length is due", "1 kV"},
    {ELECTRODES, "electrodes: [{ply: lower, side: top, shape: far, channel: drive}]",
     "the electrode 'drive' does not lie on its ply 'lower' at all", "far"},
    {PLIES,
     "plies: [{name: lower, shape: film, material: film, thickness: 1 um}, "
     "{name: lost, shape: far, material: film, thickness: 1 um}]",
     "the ply 'lost' lies nowhere on the device", "lost"},
    {PLIES,
     "plies: [{name: lower, shape: active, material: film, thickness: 1 um}]\n"
     "channels: [{name: drive}]\nmonitors: [{name: a, at: [19 mm, 0 mm]}]",
     "no ply lies where the monitor 'a' is", NULL},
    {SUPPORTS, "supports: [{edge: film, within: far}]", "within 'far' holds nothing", "film"},
    {MORE, "bodies: [{name: hub, shape: far}]", "nothing holds the body 'hub'", "hub"},
    {MORE, "bodies: [{name: a, shape: film}, {name: b, shape: active}]",
     "the bodies 'b' and 'a' lie on each other", "b, shape"},
    {MORE, "monitors: [{name: tip, at: [0, 0 mm]}]", "write for example '0 mm'", "0, 0 mm"},
    {MORE, "monitors: [{name: tip, at: [50 mm, 0 mm]}]", "no ply lies where the monitor 'tip' is",
     "tip"},
    {MORE, "monitors: [{name: tip, shape: far, ply: lower}]",
     "the monitor 'tip' does not lie on the ply 'lower'", "tip"},
    // what does not go together
    {SUPPORTS, "supports: [{edge: film, hold: [clamped, x]}]", "'clamped' and 'hinged' stand alone",
     "clamped"},
    {SUPPORTS, "supports: [{edge: film, hold: [x, y], move_z: 1 mm}]",
     "move_z: this support does not hold z", "1 mm"},
    {SUPPORTS, "supports: [{edge: film, shape: film}]", "exclude each other", "shape"},
    {MORE,
     "bodies: [{name: hub, shape: active}]\nsprings: [{body: hub, direction: z, turn_stiffness: 1 "
     "N.m/radian}]",
     "a spring against a shift has its 'stiffness'", NULL},
    {MORE,
     "bodies: [{name: hub, shape: active}]\nsprings: [{body: hub, direction: z, table: [[0 mm, 0 "
     "N], [0 mm, 1 N]]}]",
     "places must rise", NULL},
    {MORE, "channels: [{name: ground}]", "needs no line of its own", "ground"},
    {MORE,
     "channels: [{name: drive, waveform: {kind: sine, amplitude: 1 kV, frequency: 1 Hz, cycles: "
     "1}}]\ndrive: {series_resistance: 1 Mohm}",
     "series_resistance: in time the channel 'drive' has a waveform of its own", NULL},
    // keys of the other form
    {MORE, "fibres: {count: 4}", "here a fibre is one of the 'plies'", "fibres"},
    {MORE, "stripes: 3", "shape of kind array", "stripes"},
};

TEST(test_one_error_each)
{
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    dea_finding_clear(ctx);
    dea_status status =
        read_and_build(ctx, write_design(bad[i].which, bad[i].text), NULL, 0, &design, &device);
    drop();
    const struct dea_finding *finding = find_error(ctx, bad[i].part);
    if (status != DEA_E_DESIGN || finding == NULL || dea_finding_count(ctx, DEA_ERROR) != 1) {
      print_findings(ctx);
      fail_msg("%zu errors, status %d, wanted '%s' of:\n%s", dea_finding_count(ctx, DEA_ERROR),
               (int)status, bad[i].part, bad[i].text);
    }
    if (bad[i].at != NULL) {
      const char *at = strstr(bad[i].text, bad[i].at);
      assert_non_null(at);
      if (finding->location.line != (size_t)bad[i].which ||
          finding->location.column != (size_t)(at - bad[i].text) + 1) {
        fail_msg("'%s' is said at %zu:%zu, not at %d:%zu", bad[i].part, finding->location.line,
                 finding->location.column, (int)bad[i].which, (size_t)(at - bad[i].text) + 1);
      }
    }
  }
}

/* Each electrode that is too large is said at its shape. */
TEST(test_electrodes_beyond_their_film)
{
  dea_finding_clear(ctx);
  const char *text = write_design(SHAPES, "shapes: [{name: film, kind: circle, radius: 20 mm}, "
                                          "{name: active, kind: rectangle, width: 50 mm, "
                                          "height: 8 mm}]");
  assert_int_equal(read_and_build(ctx, text, NULL, 0, &design, &device), DEA_E_DESIGN);
  drop();
  assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 2);
  const struct dea_finding *finding = find_error(ctx, "'drive' reaches beyond its ply 'lower'");
  assert_non_null(finding);
  assert_int_equal(finding->location.line, ELECTRODES);
  assert_int_equal(finding->location.column,
                   strstr(usual[ELECTRODES], "active, channel: drive") - usual[ELECTRODES] + 1);
}

/* What is not held is said before anything is computed. */
TEST(test_parts_that_nothing_holds)
{
  dea_finding_clear(ctx);
  const char *text =
      write_design(SHAPES, "shapes: [{name: one, kind: rectangle, width: 40 mm, height: 10 mm}, "
                           "{name: two, kind: circle, x: 90 mm, radius: 2 mm}, "
                           "{name: film, kind: union, of: [one, two]}, "
                           "{name: active, kind: rectangle, width: 30 mm, height: 8 mm}]");
  const struct dea_override held = {"supports", "[{edge: one}]"};
  assert_int_equal(read_and_build(ctx, text, &held, 1, &design, &device), DEA_E_DESIGN);
  drop();
  assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 1);
  assert_non_null(find_error(ctx, "nothing holds the part of the device at (92, 0) mm"));
}

/* Electrodes of two channels beside each other: at 0.5 mm dry air breaks down at
 * 24.36 0.05 + 6.72 sqrt(0.05) = 2.72 kV. */
TEST(test_gap_between_channels)
{
  static const struct {
    const char *width, *voltage, *finding;
  } gaps[] = {{"10 mm", "1 kV", "electrodes of the channels 'one' and 'two' touch on one face of"},
              {"9.5 mm", "2.6 kV", NULL},
              {"9.5 mm", "2.8 kV", "are 0.5 mm apart about ("}};
  for (size_t i = 0; i < sizeof gaps / sizeof gaps[0]; i++) {
    char shapes[600];
    snprintf(shapes, sizeof shapes,
             THREE_SHAPES ", {name: left, kind: rectangle, x: -5 mm, width: %s, height: 8 mm}, "
                          "{name: right, kind: rectangle, x: 5 mm, width: %s, height: 8 mm}]",
             gaps[i].width, gaps[i].width);
    const struct dea_override sets[] = {
        {"electrodes", "[{ply: lower, side: bottom, shape: active, channel: ground}, "
                       "{ply: lower, side: top, shape: left, channel: one}, "
                       "{ply: upper, side: bottom, shape: right, channel: two}]"},
        {"channels", "[{name: one}, {name: two, ratio: 0}]"},
        {"compute.voltage.to", gaps[i].voltage}};
    dea_finding_clear(ctx);
    const dea_status status =
        read_and_build(ctx, write_design(SHAPES, shapes), sets, 3, &design, &device);
    drop();
    assert_int_equal(status, i == 0 ? DEA_E_DESIGN : DEA_OK);
    assert_int_equal(find_finding(ctx, i == 0 ? DEA_ERROR : DEA_WARNING, " on one face of ") !=
                         NULL,
                     gaps[i].finding != NULL);
    if (gaps[i].finding != NULL) {
      assert_non_null(find_finding(ctx, i == 0 ? DEA_ERROR : DEA_WARNING, gaps[i].finding));
    }
  }
}

/* Items of lists go by their names in --set. */
TEST(test_override_by_name)
{
  const struct dea_override override = {"plies.upper.thickness", "50 um"};
  assert_int_equal(read_and_build(ctx, write_design(0, NULL), &override, 1, &design, &device),
                   DEA_OK);
  assert_close(device->layout->plies[1].thickness_m, 50e-6, 0, 1e-18);
  drop();
  const struct dea_override wrong = {"plies.middle.thickness", "50 um"};
  dea_finding_clear(ctx);
  assert_int_equal(read_and_build(ctx, write_design(0, NULL), &wrong, 1, &design, &device),
                   DEA_E_DESIGN);
  drop();
  assert_non_null(
      find_error(ctx, "'plies' is a list, not a section, and has no item of that name"));
}

static dea_status build_example(struct dea_context *own)
{
  struct dea_design *read;
  struct dea_device *made = NULL;
  dea_status status =
      dea_design_read(own, DEA_SOURCE_DIR "/examples/devices/from-dxf.yaml", NULL, 0, &read);
  status = status == DEA_OK ? dea_device_build(own, read, &made) : status;
  dea_device_destroy(own, made);
  dea_design_destroy(own, read);
  return status;
}

static dea_status build_shapes(struct dea_context *own)
{
  struct dea_design *read;
  struct dea_device *made;
  dea_status status = read_and_build(
      own,
      write_design(SHAPES, THREE_SHAPES ", {name: a, kind: polar, of: active, count: 3}, "
                                        "{name: b, kind: difference, of: [a, film]}, "
                                        "{name: c, kind: copy, of: b, mirror: 0 degree}]"),
      NULL, 0, &read, &made);
  dea_device_destroy(own, made);
  dea_design_destroy(own, read);
  return status;
}

TEST(test_failing_memory)
{
  assert_true(failing_ends(build_example, DEA_OK) > 100);
  assert_true(failing_ends(build_shapes, DEA_OK) > 100);
}

/* The unit of drawings: that of the file, or of the key where the file says none; the same file in
 * two units is two drawings. */
TEST(test_units_of_drawings)
{
  const struct dea_layout *layout =
      build(SHAPES, THREE_SHAPES
            ", {name: a, kind: drawing, file: " DRAWINGS
            "dxf/nounits0.dxf, layer: 0, unit: cm}, {name: b, kind: drawing, file: " DRAWINGS
            "dxf/nounits0.dxf, layer: 0, unit: in}, {name: c, kind: drawing, file: " DRAWINGS
            "dxf/inch.dxf, layer: 0, unit: in}, {name: d, kind: drawing, file: " DRAWINGS
            "svg/px.svg, layer: Cut, unit: mm}, {name: e, kind: drawing, file: " DRAWINGS
            "svg/attr-mm.svg, layer: Cut, unit: cm}]");
  static const double area_mm2[] = {200, 2 * 25.4 * 25.4, 2 * 25.4 * 25.4, 800, 800};
  for (size_t i = 0; i < 5; i++) {
    assert_close(1e6 * dea_region_area_m2(&layout->regions[3 + i].region), area_mm2[i], 1e-12, 0);
  }
  assert_null(find_finding(ctx, DEA_NOTE, "does not say its"));
  drop();
  build(SHAPES,
        THREE_SHAPES ", {name: a, kind: drawing, file: " DRAWINGS "dxf/nounits0.dxf, layer: 0}]");
  assert_non_null(find_finding(ctx, DEA_NOTE, "mm is assumed (the key unit of a shape says it)"));
  drop();
}

// The disc that a layout is
// ------------------------------------------------------------------------

#define FILM_OF "plies: [{name: film, shape: film, material: film, thickness: 100 um, pre_stretch: "
#define ROUND "{name: film, kind: circle, radius: 15 mm}"

static const char *const disc_lines[LINES] = {
    [SHAPES] = "shapes: [" ROUND ", {name: active, kind: circle, radius: 4 mm}, "
               "{name: rod, kind: rectangle, x: 12 mm, width: 10 mm, height: 2 mm}, "
               "{name: short, kind: copy, of: rod, x: -4 mm}, "
               "{name: two, kind: polar, of: rod, count: 2}, "
               "{name: rods, kind: intersection, of: [two, film]}, "
               "{name: bent, kind: polar, of: rod, count: 2, angle: 90 degree}, "
               "{name: corner, kind: intersection, of: [bent, film]}]",
    [PLIES] = FILM_OF "1.2}]",
    [ELECTRODES] = "electrodes: [{ply: film, side: bottom, shape: active, channel: ground}, "
                   "{ply: film, side: top, shape: active, channel: drive}]",
    [SUPPORTS] = "supports: [{edge: film}]",
    [MORE] = "title: disc",
};

/* A disc in both forms. */
struct disc {
  double stretch, film_um, frame_mm, active_mm, x_mm, electrode_um;
  const char *gravity[2];
  int fibres;
  double width_mm, tip_mm, gap_mm, fibre_um, glue_um; // tip: its distance from the centre
  const char *film;                                   // its material
};

#define DISC_MATERIALS                                                                             \
  FILM_MATERIAL                                                                                    \
  "  - {name: glue, kind: plastic,\n"                                                              \
  "     elastic: {young_modulus: 1 MPa, poisson_ratio: 0.5, source: test}}\n"

static void write_short(const struct disc *d, char *out, size_t size)
{
  char fibres[400] = "", gap[80] = "", glue[80] = "";
  if (d->gap_mm > 0) {
    snprintf(gap, sizeof gap, ", outer_end: free, outer_gap: %g mm stretched", d->gap_mm);
  }
  if (d->glue_um > 0) {
    snprintf(glue, sizeof glue, ", bond: {thickness: %g um, modulus: 1 MPa}", d->glue_um);
  }
  if (d->fibres > 0) {
    snprintf(fibres, sizeof fibres,
             "fibres: {count: %d, width: %g mm, thickness: %g um, material: pet, "
             "tip_radius: %g mm stretched%s%s}\n",
             d->fibres, d->width_mm, d->fibre_um, d->tip_mm, gap, glue);
  }
  snprintf(out, size,
           "dea: 1\nfilm: {material: %s, thickness: %g um}\npre_stretch: %g\n"
           "frame: {inner_radius: %g mm}\n"
           "electrodes: {radius: %g mm stretched, material: film, thickness: %g um}\n"
           "%sgravity: %s\n" DISC_MATERIALS,
           d->film, d->film_um, d->stretch, d->frame_mm, d->active_mm, d->electrode_um, fibres,
           d->gravity[0]);
}

/* Shapes and plies of the fibres, those from the film up. */
static void write_fibres(const struct disc *d, char *shapes, char *plies, size_t size)
{
  const double end_mm = d->frame_mm + (d->gap_mm > 0 ? 0 : 1);
  const bool filled = d->electrode_um > 0 && d->tip_mm < d->active_mm;
  char filler[160] = "", glue[120] = "";
  if (filled) {
    snprintf(filler, sizeof filler,
             "  - {name: filler, shape: beyond, material: %s, thickness: %.17g um}\n",
             d->glue_um > 0 ? "glue" : "pet", d->electrode_um / (d->stretch * d->stretch));
  }
  if (d->glue_um > 0) {
    snprintf(glue, sizeof glue,
             "  - {name: glue, shape: fibres, material: glue, thickness: %g um}\n", d->glue_um);
  }
  snprintf(shapes, size,
           "  - {name: strip, kind: rectangle, x: %.17g mm, width: %.17g mm, height: %g mm}\n"
           "  - {name: strips, kind: polar, of: strip, count: %d}\n"
           "  - {name: end, kind: circle, radius: %.17g mm}\n"
           "  - {name: fibres, kind: intersection, of: [strips, end]}\n"
           "  - {name: beyond, kind: difference, of: [fibres, active]}\n",
           0.5 * (d->tip_mm + end_mm), end_mm - d->tip_mm, d->width_mm, d->fibres,
           d->frame_mm - d->gap_mm);
  snprintf(plies, size, "%s%s  - {name: fibres, shape: fibres, material: pet, thickness: %g um}\n",
           filler, glue, d->fibre_um);
}

static void write_parts(const struct disc *d, char *out, size_t size)
{
  char skin[2][200] = {"", ""}, shapes[800] = "", plies[500] = "";
  if (d->fibres > 0) {
    write_fibres(d, shapes, plies, sizeof plies);
  }
  for (int i = 0; i < 2 && d->electrode_um > 0; i++) {
    snprintf(skin[i], sizeof skin[i],
             "  - {name: skin %d, shape: active, material: film, thickness: %g um, pre_stretch: "
             "%g}\n",
             i, d->electrode_um, d->stretch);
  }
  snprintf(out, size,
           "dea: 1\nshapes:\n  - {name: film, kind: circle, x: %g mm, radius: %g mm}\n"
           "  - {name: active, kind: circle, x: %g mm, radius: %g mm}\n%splies:\n%s"
           "  - {name: film, shape: film, material: %s, thickness: %g um, pre_stretch: %g}\n%s%s"
           "electrodes:\n  - {ply: film, side: top, shape: active, channel: ground}\n"
           "  - {ply: film, side: bottom, shape: active, channel: drive}\n"
           "supports: [{edge: film}]\ngravity: %s\n" DISC_MATERIALS,
           d->x_mm, d->frame_mm, d->x_mm, d->active_mm, shapes, skin[0], d->film, d->film_um,
           d->stretch, skin[1], plies, d->gravity[1]);
}

enum { STEPS = 3 }; // of 1 kV, from 0 on

/* What a model says of a disc. */
struct answer {
  struct dea_load_point points[STEPS];
  double path_end;
  size_t notes, profile_count;
};

static void solve_form(const char *text, const char *name, struct answer *out)
{
  const struct dea_model_type *type = dea_model_find(name);
  struct dea_model *model;
  struct dea_profile profile = {0};
  dea_finding_clear(ctx);
  if (read_and_build(ctx, text, NULL, 0, &design, &device) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", dea_context_message(ctx));
  }
  if (dea_device_require_disc(ctx, device) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  dea_finding_clear(ctx);
  assert_int_equal(dea_model_create(ctx, type, design, device, &model), DEA_OK);
  for (int i = 0; i < STEPS; i++) {
    assert_int_equal(type->solve(ctx, model, 1e3 * i, &out->points[i]), DEA_OK);
  }
  if (type->profile != NULL) {
    assert_int_equal(type->profile(ctx, model, &profile), DEA_OK);
  }
  out->profile_count = profile.count;
  out->path_end = dea_device_path_end(device, design);
  out->notes = dea_finding_count(ctx, DEA_NOTE);
  type->destroy(ctx, model);
  drop();
}

static void assert_same_number(double value, double wanted, double tolerance)
{
  assert_true(isnan(value) == isnan(wanted));
  if (!isnan(wanted)) {
    assert_close(value, wanted, tolerance, 1e-16);
  }
}

/* A disc is the same one however it is written: every column of each model that knows it. Its
 * lengths are the same numbers in mm and in m: an estimated error, which is what is left of large
 * numbers, tells them apart in their last bit. */
TEST(test_disc_of_both_forms)
{
#define LEVEL                                                                                      \
  {                                                                                                \
    "off", "off"                                                                                   \
  }
  static const struct disc discs[] = {
      {1.5, 100, 15, 3.75, 0, 0, LEVEL, 4, 2, 3.75, 0, 100, 0, "elastosil-2030"},
      {1.5,
       100,
       15,
       3.75,
       0,
       0,
       {"fibres_up", "top_up"},
       8,
       1.5,
       3.5,
       0,
       125,
       20,
       "elastosil-2030"},
      {1.5, 100, 15, 3.75, 0, 0, LEVEL, .film = "elastosil-2030"},
      {1.2, 60, 20, 8, 0, 0, LEVEL, 6, 2, 10, 1, 50, 0, "film, law: b"},
      {1.2, 60, 20, 10, 0, 5, LEVEL, 4, 2, 8, 0, 100, 25, "film"},
      {1.2, 60, 20, 10, 0, 5, {"fibres_up", "top_up"}, .film = "elastosil-2030"},
      {1.1, 100, 10, 8, 3, 2, {"fibres_down", "top_down"}, .film = "film"},
  };
  static const char *const models[] = {"lumped", "axisymmetric", "3d"};
  for (size_t i = 0; i < 3 * sizeof discs / sizeof discs[0]; i++) {
    const struct disc *disc = &discs[i / 3];
    static struct answer answers[2];
    char text[4000];
    if (i % 3 == 2 && disc->x_mm != 0) {
      continue; // of a free mesh
    }
    for (int k = 0; k < 2; k++) {
      (k == 0 ? write_short : write_parts)(disc, text, sizeof text);
      solve_form(text, models[i % 3], &answers[k]);
    }
    const struct dea_load_point *points[2] = {answers[0].points, answers[1].points};
    assert_int_equal(answers[1].notes, answers[0].notes);
    assert_int_equal(answers[1].profile_count, answers[0].profile_count);
    assert_close(answers[1].path_end, answers[0].path_end, 1e-12, 0);
    assert_true(points[1][STEPS - 1].electrode_stretch > 1.0002);
    for (size_t k = 0; k < STEPS * DEA_LOAD_POINT_COLUMNS; k++) {
      const int column = (int)(k / STEPS);
      assert_same_number(dea_point_get(&points[1][k % STEPS], column),
                         dea_point_get(&points[0][k % STEPS], column), 1e-9);
    }
  }
}

/* Sum of the slopes of the electrode's edge at 2 kV by the numbers whose keys end so. */
static double slope_by(const char *text, const char *outcome)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_model *model;
  struct dea_load_point point;
  static struct dea_design_number numbers[DEA_NUMBERS_MAX];
  static double slopes[DEA_NUMBERS_MAX];
  size_t count = 0;
  double sum = 0;
  assert_int_equal(read_and_build(ctx, text, NULL, 0, &design, &device), DEA_OK);
  assert_int_equal(dea_model_create(ctx, type, design, device, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, 2e3, &point), DEA_OK);
  assert_int_equal(dea_design_numbers(ctx, design, device, 2e3, false, numbers, &count), DEA_OK);
  const int column = dea_point_column_find("electrode_edge_u_m");
  const struct dea_design_gradient ask = {.type = type,
                                          .model = model,
                                          .design = design,
                                          .device = device,
                                          .voltage_V = 2e3,
                                          .numbers = numbers,
                                          .number_count = count,
                                          .of = {.columns = &column, .column_count = 1}};
  assert_int_equal(dea_design_gradient_find(ctx, &ask, slopes), DEA_OK);
  for (size_t i = 0; i < count; i++) {
    const size_t length = strlen(numbers[i].key), end = strlen(outcome);
    if (length >= end && strcmp(numbers[i].key + length - end, outcome) == 0 &&
        strstr(numbers[i].key, "film") == NULL) {
      sum += slopes[i];
    }
  }
  type->destroy(ctx, model);
  drop();
  return sum;
}

/* A disc whose electrodes are changed one after the other, which is none between, changes as one
 * whose electrodes are changed together. */
TEST(test_slopes_of_both_forms)
{
  const struct disc disc = {1.2, 100, 15, 3.75, 0, 10, LEVEL, .film = "film"};
  static const char *const outcomes[] = {".thickness", ".law.c1"};
  for (size_t i = 0; i < sizeof outcomes / sizeof outcomes[0]; i++) {
    char text[2][4000];
    write_short(&disc, text[0], sizeof text[0]);
    write_parts(&disc, text[1], sizeof text[1]);
    const double wanted = slope_by(text[0], outcomes[i]);
    assert_true(fabs(wanted) > 0);
    assert_close(slope_by(text[1], outcomes[i]), wanted, 1e-7, 0);
  }
}

TEST(test_what_is_no_disc)
{
#define RODS(shape, more)                                                                          \
  FILM_OF "1.2}, {name: rods, shape: " shape ", thickness: 9 um, material: " more "}]"
  static const struct {
    enum line which;
    const char *text, *message; // NULL: it is one
  } cases[] = {
      {PLIES, RODS("rods", "stiff"), NULL},
      {PLIES, FILM_OF "1.2, layers: 3}]", "ply 'film' is of several layers"},
      {PLIES, RODS("rods", "film"), "ply 'rods' is not linear elastic"},
      {PLIES, RODS("rods", "stiff, pre_stretch: 1.1"), "ply 'rods' is stretched"},
      {PLIES, RODS("corner", "stiff"), "ply 'rods' has not the shape"},
      {PLIES, RODS("short", "stiff"), "nor are its parts radial fibres that end at a circle"},
      {MORE, "monitors: [{name: edge, at: [4 mm, 0 mm]}]", NULL},
      {MORE, "bodies: [{name: hub, shape: active}]", "body 'hub' is no part of one"},
      {MORE, "pressures: [{ply: film, side: top, shape: film, pressure: 1 kPa}]",
       "the pressure on ply 'film' is no load of one"},
      {MORE, "channels: [{name: drive, ratio: 0.5}]", "channel 'drive' has a voltage of its own"},
      {SHAPES, "shapes: [" ROUND ", {name: active, kind: circle, x: 1 mm, radius: 4 mm}]",
       "electrode 'ground' is not in the middle of the film"},
      {SHAPES, "shapes: [" ROUND ", {name: active, kind: rectangle, width: 4 mm, height: 4 mm}]",
       "electrode 'ground' is not round"},
      {SHAPES,
       "shapes: [{name: film, kind: rectangle, width: 30 mm, height: 30 mm}, "
       "{name: active, kind: circle, radius: 4 mm}]",
       "ply 'film' is not round"},
      {ELECTRODES,
       "electrodes: [{ply: film, side: bottom, shape: active, channel: ground}, "
       "{ply: film, side: top, shape: film, channel: drive}]",
       "electrode 'drive' is not as the other one"},
      {ELECTRODES,
       "electrodes: [{ply: film, side: bottom, shape: film, channel: ground}, "
       "{ply: film, side: top, shape: film, channel: drive}]",
       "electrode 'ground' does not end before the edge of the film"},
      {PLIES, FILM_OF "[1.2, 1.3]}]", "ply 'film' has two pre-stretches"},
      {PLIES,
       FILM_OF "1.2}, {name: skin, shape: active, material: film, thickness: 9 um, pre_stretch: "
               "1.2}]",
       "ply 'skin' is not one of two electrodes"},
      {PLIES, FILM_OF "1.2}, {name: cap, shape: film, material: film, thickness: 9 um}]",
       "ply 'cap' is neither the film nor of its electrodes' shape"},
      {SUPPORTS, "supports: [{edge: film, hold: [hinged]}]",
       "the support of 'film' does not clamp the edge of the film"},
      {SUPPORTS, "supports: [{edge: film, move_x: 1 mm}]",
       "the support of 'film' does not clamp the edge of the film"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    dea_finding_clear(ctx);
    dea_context_clear(ctx);
    const char *text = write_lines(disc_lines, cases[i].which, cases[i].text);
    if (read_and_build(ctx, text, NULL, 0, &design, &device) != DEA_OK) {
      print_findings(ctx);
      fail_msg("%s", dea_context_message(ctx));
    }
    assert_true(device->disc == (cases[i].message == NULL));
    assert_int_equal(dea_device_require_disc(ctx, device),
                     cases[i].message != NULL ? DEA_E_DESIGN : DEA_OK);
    if (cases[i].message != NULL && strstr(dea_context_message(ctx), cases[i].message) == NULL) {
      fail_msg("'%s' instead of '%s'", dea_context_message(ctx), cases[i].message);
    }
    drop();
  }
}

TESTS(context_set_up, context_tear_down)
