/* Gradients of devices of the general form: Taylor's remainder of each by the changed device, built
 * and solved by itself. */
// ctest: solid
#include "design_text.h"
#include "model/model.h"
#include "result/columns.h"
#include "study/design_file.h"
#include "study/design_gradient.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above
#include "lowest_frequency.h"

#include <math.h>
#include <string.h>

static const char *const keys[] = {"highest_z_m",         "true_field_V_per_m", "breakdown_margin",
                                   "min_tension_N_per_m", "capacitance_F",      "energy_J",
                                   "frequency_Hz"};
enum {
  KEYS = sizeof keys / sizeof keys[0],
  TENSION = 3,
  FREQUENCY = KEYS - 1, // of a device that vibrates
  MONITORS = 7,
  WIDTH = KEYS + MONITORS
};

/* A device with all that has numbers: a hub with a mass, a force and a spring, its own voltages. */
static const char cone[] = "dea: 1\n"
                           "title: cone\n"
                           "shapes:\n"
                           "  - {name: film, kind: circle, radius: 20 mm}\n"
                           "  - {name: hub, kind: circle, radius: 5 mm}\n"
                           "  - {name: active, kind: difference, of: [film, hub]}\n"
                           "  - {name: ring, kind: ring, inner_radius: 6 mm, outer_radius: 12 mm}\n"
                           "plies:\n"
                           "  - {name: film, shape: film, material: elastosil-2030, "
                           "thickness: 100 um, pre_stretch: [1.2, 1.25]}\n"
                           "electrodes:\n"
                           "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
                           "  - {ply: film, side: top, shape: active, channel: drive}\n"
                           "channels:\n"
                           "  - {name: drive, ratio: 0.8, voltage: 0.3 kV}\n"
                           "supports:\n"
                           "  - {edge: film}\n"
                           "bodies:\n"
                           "  - {name: hub, shape: hub, mass: 20 g, free: [z], force_z: 50 mN}\n"
                           "springs:\n"
                           "  - {body: hub, direction: z, stiffness: 10 N/m, free_at: 1 mm}\n"
                           "monitors:\n"
                           "  - {name: hub, body: hub}\n"
                           "  - {name: ring, shape: ring}\n"
                           "gravity: top_up\n"
                           "compute:\n"
                           "  voltage: {to: 3 kV, step: 1 kV}\n"
                           "  solid: {film: membrane}\n";

struct at {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_model *model; // of that, at its last point; NULL: not yet
  double voltage_V;
  size_t monitors[MONITORS], monitor_count;
  enum dea_observed motion[MONITORS]; // asked for, or found by the first that observes
  bool asked, found, vibrates;
  const char *const *only;            // those that are, ended by NULL; NULL: all
  bool again;                         // solved for once more, for what the first solution leaves
  double leaves;                      // what solutions leave of a quantity, over its size
  bool liquid;                        // its slopes are less exact, and its energy has none
  struct dea_model_settings settings; // of a critical voltage
  const struct dea_control *control;  // that is moved at the voltage; NULL: none
  double control_to;
};

static void read_design(struct at *at, const char *name, const char *text)
{
  assert_int_equal(dea_design_read_memory(ctx, name, text, strlen(text), NULL, 0, &at->design),
                   DEA_OK);
}

static size_t key_count(const struct at *at)
{
  return at->vibrates ? KEYS : FREQUENCY;
}

/* Quantities of a device that is solved by itself, out [WIDTH]: the first, whose model is kept, or
 * another one on its mesh, moved with the shapes. */
static void solve(struct at *at, const struct dea_device *device, double voltage_V, double *out)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_model *model = NULL;
  struct dea_load_point point;
  struct dea_observation seen;
  struct dea_model_settings settings = dea_model_settings_of(at->design);
  settings.mesh_from = at->model;
  if (type->create(ctx, device, &settings, &model) != DEA_OK ||
      type->solve(ctx, model, voltage_V, &point) != DEA_OK ||
      (at->control != NULL &&
       type->move(ctx, model, at->control, at->control_to, &point) != DEA_OK) ||
      (at->again && type->solve(ctx, model, voltage_V, &point) != DEA_OK) ||
      type->observe(ctx, model, &seen) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  if (at->vibrates) {
    point.frequency_Hz = frequency_of(type, model, &point);
  }
  for (int k = 0; k < KEYS; k++) {
    out[k] = dea_point_get(&point, dea_point_column_find(keys[k]));
  }
  for (size_t m = 0; m < at->monitor_count; m++) {
    const double *values = seen.monitor[at->monitors[m]];
    at->motion[m] = at->found || at->asked ? at->motion[m] : dea_observed_main(values);
    out[KEYS + m] = values[at->motion[m]];
  }
  at->found = true;
  if (at->model == NULL) {
    at->model = model;
  } else {
    type->destroy(ctx, model);
  }
}

/* Of a critical voltage: of that where the tension is 0 more, it has the pressures. */
static double voltage_floor(enum dea_event_kind kind)
{
  return kind == DEA_EVENT_SLACK ? 1e-8 : 1e-11;
}

/* What a slope is off by, over the quantity, by central differences of its forces. */
static const double slope_accuracy = 1e-6;

enum { CHANGES = 2 };
static const double decades[CHANGES] = {3e-3, 3e-6}; // six decades of the remainder

/* What is left of the changes of a quantity falls as the square of the change. */
static void check_fall(const struct at *at, const char *what, const char *number,
                       const double *left)
{
  const double wanted = left[0] * pow(decades[1] / decades[0], 2);
  const double accuracy = at->liquid ? 1e-5 : slope_accuracy; // 3e5 times as stiff as the film
  if (!(fabs(left[1] - wanted) <= 0.1 * fabs(wanted) + accuracy * decades[1] + at->leaves)) {
    fail_msg("%s by %s: %.3e, not %.3e", what, number, left[1], wanted);
  }
}

static void check_number(struct at *at, const struct dea_design_number *number, const double *base,
                         const double *slope)
{
  double moved[CHANGES][WIDTH];
  bool voltage = strcmp(number->key, "voltage") == 0;
  const double reach = number->reach > 0 ? number->reach : number->value;
  for (int n = 0; n < CHANGES; n++) {
    struct dea_changed_device changed = {.memory = {.ctx = ctx}};
    double value = number->value + decades[n] * reach;
    if (!voltage) {
      assert_int_equal(dea_device_change(ctx, at->design, at->device, number, value, &changed),
                       DEA_OK);
    }
    solve(at, voltage ? at->device : &changed.device, voltage ? value : at->voltage_V, moved[n]);
    dea_changed_device_free(&changed);
  }
  for (size_t k = 0; k < KEYS + at->monitor_count; k++) {
    double size = fabs(base[k]);
    if (k >= KEYS && (at->motion[k - KEYS] == DEA_OBSERVED_AREA_STRETCH ||
                      at->motion[k - KEYS] == DEA_OBSERVED_STRETCH)) {
      size = fabs(base[k] - 1);
    }
    if (isnan(base[k]) || size < 1e-12) { // of what lies still
      continue;
    }
    double left[CHANGES];
    const double own = slope[k < KEYS ? k : k - KEYS + key_count(at)];
    if (at->liquid && k < KEYS && strcmp(keys[k], "energy_J") == 0) {
      assert_true(isnan(own));
      continue;
    }
    assert_true(!isnan(own));
    for (int n = 0; n < CHANGES; n++) {
      left[n] = (moved[n][k] - base[k] - own * reach * decades[n]) / size;
    }
    check_fall(at, k < KEYS ? keys[k] : "monitor", number->key, left);
  }
}

static bool is_checked(const struct at *at, const struct dea_design_number *number)
{
  size_t i = 0;
  while (at->only != NULL && at->only[i] != NULL && strcmp(at->only[i], number->key) != 0) {
    i++;
  }
  return at->only == NULL || at->only[i] != NULL;
}

static void end(struct at *at)
{
  if (at->model != NULL) {
    dea_model_find("3d")->destroy(ctx, at->model);
  }
  dea_device_destroy(ctx, at->device);
  dea_design_destroy(ctx, at->design);
}

/* All numbers of a design. Returns how many there are. */
static size_t check(struct at *at)
{
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  size_t count, checked = 0;
  int columns[KEYS];
  double base[WIDTH];
  assert_int_equal(dea_device_build(ctx, at->design, &at->device), DEA_OK);
  assert_int_equal(
      dea_design_numbers(ctx, at->design, at->device, at->voltage_V, false, numbers, &count),
      DEA_OK);
  if (!at->vibrates) {
    dea_numbers_at_rest(at->device, numbers, &count);
  }
  if (!at->asked) {
    at->monitor_count = at->device->layout->monitor_count;
    assert_in_range(at->monitor_count, 1, MONITORS);
    for (size_t m = 0; m < at->monitor_count; m++) {
      at->monitors[m] = m;
    }
  }
  for (int k = 0; k < KEYS; k++) {
    columns[k] = dea_point_column_find(keys[k]);
  }
  solve(at, at->device, at->voltage_V, base);
  const struct dea_design_gradient ask = {.type = dea_model_find("3d"),
                                          .model = at->model,
                                          .design = at->design,
                                          .device = at->device,
                                          .voltage_V = at->voltage_V,
                                          .numbers = numbers,
                                          .number_count = count,
                                          .of = {.columns = columns,
                                                 .column_count = key_count(at),
                                                 .monitors = at->monitors,
                                                 .monitor_count = at->monitor_count,
                                                 .motions = at->asked ? at->motion : NULL}};
  const size_t width = key_count(at) + at->monitor_count;
  double *slopes = dea_alloc(ctx, count * width, sizeof *slopes);
  assert_non_null(slopes);
  if (dea_design_gradient_find(ctx, &ask, slopes) != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  for (size_t i = 0; i < count; i++) {
    if (is_checked(at, &numbers[i])) {
      check_number(at, &numbers[i], base, slopes + i * width);
      checked++;
    }
  }
  assert_true(at->only == NULL || at->only[checked] == NULL); // all of them are there
  dea_free(ctx, slopes);
  end(at);
  return count;
}

TEST(test_cone)
{
  struct at at = {.voltage_V = 3e3};
  read_design(&at, "cone.yaml", cone);
  /* voltage, thickness, two stretches, ratio and voltage of a channel, mass, force, stiffness and
   * free end of a spring, three of the law, permittivity, density (it has a weight), four radii */
  assert_int_equal(check(&at), 19);
}

/* The lowest frequency of it: a body on a film and a spring. */
TEST(test_frequency_of_the_cone)
{
  static const char *const only[] = {"voltage",
                                     "plies.film.thickness",
                                     "plies.film.density",
                                     "bodies.hub.mass",
                                     "springs[0].stiffness",
                                     "shapes.hub.radius",
                                     NULL};
  struct at at = {.voltage_V = 3e3, .only = only, .vibrates = true};
  read_design(&at, "cone.yaml", cone);
  check(&at);
}

/* Its hub where study loading has brought it, and pushed by more than its own force: that is held.
 */
TEST(test_moved_hub)
{
  static const struct dea_control place = {.kind = DEA_CONTROL_PLACE, .component = 2},
                                  force = {.kind = DEA_CONTROL_FORCE, .component = 2};
  static const char *const of_place[] = {"voltage", "plies.film.thickness", "bodies.hub.mass",
                                         "shapes.hub.radius", NULL},
                           *const of_force[] = {"springs[0].stiffness", "bodies.hub.force_z", NULL};
  struct at at = {.voltage_V = 3e3,
                  .monitors = {0, 1},
                  .monitor_count = 2,
                  .motion = {DEA_OBSERVED_FORCE_Z, DEA_OBSERVED_Z},
                  .asked = true,
                  .only = of_place,
                  .control = &place,
                  .control_to = 2e-3};
  read_design(&at, "cone.yaml", cone);
  check(&at);
  at = (struct at){.voltage_V = 3e3, .only = of_force, .control = &force, .control_to = 80e-3};
  read_design(&at, "cone.yaml", cone);
  check(&at);
}

/* Two plies under a pressure, the upper one without a field. */
static const struct dea_override skin = {
    "plies", "[{name: film, shape: film, material: elastosil-2030, thickness: 100 um, "
             "pre_stretch: 1.1}, {name: skin, shape: active, material: elastosil-2030, "
             "thickness: 50 um, pre_stretch: 1.05}]"};

static void read_diaphragm(struct at *at)
{
  assert_int_equal(dea_design_read(ctx, DEA_SOURCE_DIR "/examples/devices/diaphragm.yaml", &skin, 1,
                                   &at->design),
                   DEA_OK);
}

/* Pressures half again as large as the design has them; the factor is held. */
TEST(test_moved_pressure)
{
  static const struct dea_control pressure = {.kind = DEA_CONTROL_PRESSURE};
  static const char *const only[] = {"pressures[0].pressure", "shapes.active.radius", NULL};
  struct at at = {.voltage_V = 3e3, .only = only, .control = &pressure, .control_to = 1.5};
  read_diaphragm(&at);
  check(&at);
}

/* Over a closed volume of liquid, which is a monitor too. */
TEST(test_lens)
{
  static const char *const only[] = {"pressures[0].liquid", "plies.film.thickness",
                                     "plies.film.pre_stretch", NULL};
  static const struct dea_override surface = {"compute.solid", "{film: membrane}"};
  // the volume is solved to 1e-9
  struct at at = {.voltage_V = 3e3, .only = only, .leaves = 1e-9, .liquid = true};
  assert_int_equal(
      dea_design_read(ctx, DEA_SOURCE_DIR "/examples/devices/lens.yaml", &surface, 1, &at.design),
      DEA_OK);
  check(&at);
}

TEST(test_two_plies_under_pressure)
{
  static const char *const only[] = {"plies.skin.thickness", "plies.skin.pre_stretch",
                                     "pressures[0].pressure", "shapes.active.radius",
                                     NULL}; // the others are like those of a cone
  struct at at = {.voltage_V = 3e3, .only = only};
  read_diaphragm(&at);
  /* voltage, two thicknesses and stretches, pressure, twice three of the law, permittivity, two
   * radii */
  assert_int_equal(check(&at), 15);
}

/* A body secondary of the middle, on legs that reach over the film's edge and over each other: its
 * place and size, an angle, and where outlines cross. */
TEST(test_shapes)
{
  static const char device[] =
      "dea: 1\n"
      "title: a body aside\n"
      "shapes:\n"
      "  - {name: film, kind: circle, radius: 20 mm}\n"
      "  - {name: hub, kind: circle, radius: 4 mm, x: 3 mm, y: 0 mm}\n"
      "  - {name: beam, kind: rectangle, width: 24 mm, height: 3 mm}\n"
      "  - {name: leg, kind: copy, of: beam, angle: 20 degree, x: 12 mm, y: 0.5 mm}\n"
      "  - {name: left, kind: rectangle, x: -12 mm, width: 30 mm, height: 50 mm}\n"
      "  - {name: half, kind: intersection, of: [film, left]}\n"
      "  - {name: active, kind: difference, of: [half, hub]}\n"
      "plies:\n"
      "  - {name: film, shape: film, material: elastosil-2030, thickness: 100 um, pre_stretch: "
      "1.2}\n"
      "  - {name: leg, shape: leg, material: elastosil-2030, thickness: 50 um}\n"
      "electrodes:\n"
      "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
      "  - {ply: film, side: top, shape: active, channel: drive}\n"
      "supports:\n"
      "  - {edge: film}\n"
      "bodies:\n"
      "  - {name: hub, shape: hub, force_z: 20 mN}\n"
      "monitors:\n"
      "  - {name: hub, body: hub}\n"
      "  - {name: leg, shape: leg, ply: film}\n"
      "compute:\n"
      "  voltage: {to: 3 kV, step: 1 kV}\n"
      "  solid: {film: membrane, order: 1}\n";
  static const char *const only[] = {"shapes.hub.x", "shapes.leg.angle", "shapes.beam.height",
                                     NULL};
  struct at at = {.voltage_V = 3e3,
                  .monitors = {0, 1},
                  .monitor_count = 2,
                  .motion = {DEA_OBSERVED_TURN_Y, DEA_OBSERVED_Z},
                  .asked = true,
                  .only = only,
                  .leaves = 5e-12};
  read_design(&at, "aside.yaml", device);
  /* beside the shapes: voltage, thickness, stretch, law, permittivity of the film, thickness,
   * stretch and law of the leg, force; of shapes also the y that is said to be 0 */
  assert_int_equal(check(&at), 14 + 13);
}

/* Motions that are asked for by name: how high a region is in the mean, and its area. */
TEST(test_region)
{
  static const char *const only[] = {"voltage", "plies.film.thickness", NULL};
  struct at at = {.voltage_V = 3e3,
                  .monitors = {1, 1},
                  .monitor_count = 2,
                  .motion = {DEA_OBSERVED_Z, DEA_OBSERVED_AREA_STRETCH},
                  .asked = true,
                  .only = only};
  read_design(&at, "cone.yaml", cone);
  check(&at);
}

/* A plate on a film, turned and pulled secondary by electrodes that lie askew, on a film whose
 * permittivity goes with its stretch: all its motions, and how long a line becomes, by numbers of
 * every kind. */
TEST(test_plate_askew)
{
  only_nightly();
  static const char device[] =
      "dea: 1\n"
      "title: a plate askew\n"
      "shapes:\n"
      "  - {name: film, kind: circle, radius: 20 mm}\n"
      "  - {name: plate, kind: rectangle, width: 8 mm, height: 5 mm}\n"
      "  - {name: back, kind: difference, of: [film, plate]}\n"
      "  - {name: east, kind: sector, inner_radius: 7 mm, outer_radius: 18 mm, start: -25 degree, "
      "end: 70 degree}\n"
      "materials:\n"
      "  - name: soft\n"
      "    title: soft\n"
      "    kind: elastomer\n"
      "    laws:\n"
      "      - {id: a, law: neo-hookean, parameters: {mu: 300 kPa}, source: a test}\n"
      "    permittivity:\n"
      "      - {id: a, at_rest: 3, slope: -0.3, source: a test}\n"
      "  - name: stiff\n"
      "    title: stiff\n"
      "    kind: plastic\n"
      "    elastic: {young_modulus: 20 MPa, poisson_ratio: 0.38, source: a test}\n"
      "plies:\n"
      "  - {name: film, shape: film, material: soft, thickness: 100 um, pre_stretch: 1.3}\n"
      "  - {name: stiff, shape: east, material: stiff, thickness: 20 um}\n"
      "electrodes:\n"
      "  - {ply: film, side: bottom, shape: back, channel: ground}\n"
      "  - {ply: film, side: top, shape: east, channel: drive}\n"
      "supports:\n"
      "  - {edge: film}\n"
      "bodies:\n"
      "  - {name: plate, shape: plate, force_y: 5 mN, force_z: 20 mN, moment_x: 0.02 mN.m, "
      "moment_z: 0.05 mN.m}\n"
      "monitors:\n"
      "  - {name: plate, body: plate}\n"
      "  - {name: line, from: [8 mm, 1 mm], to: [17 mm, 2 mm], ply: film}\n"
      "compute:\n"
      "  voltage: {to: 3 kV, step: 1 kV}\n"
      "  solid: {film: membrane, order: 1}\n";
  static const char *const only[] = {"voltage",
                                     "plies.film.thickness",
                                     "plies.film.permittivity.slope",
                                     "plies.stiff.young_modulus",
                                     "plies.stiff.poisson_ratio",
                                     "bodies.plate.force_y",
                                     "bodies.plate.moment_x",
                                     "bodies.plate.moment_z",
                                     "shapes.plate.width",
                                     "shapes.east.end",
                                     NULL};
  struct at at = {.voltage_V = 3e3,
                  .monitors = {0, 0, 0, 0, 0, 0, 1},
                  .monitor_count = 7,
                  .motion = {DEA_OBSERVED_X, DEA_OBSERVED_Y, DEA_OBSERVED_Z, DEA_OBSERVED_TURN_X,
                             DEA_OBSERVED_TURN_Y, DEA_OBSERVED_TURN_Z, DEA_OBSERVED_STRETCH},
                  .asked = true,
                  .only = only,
                  .leaves = 5e-11};
  read_design(&at, "askew.yaml", device);
  check(&at);
}

/* A hub that is held secondary and askew, as blocked forces are measured: what it takes to hold it,
 * and mean stretches of a region, by numbers of the film and by where it is moved to. */
TEST(test_held_hub)
{
  static const char device[] =
      "dea: 1\n"
      "title: a hub that is held\n"
      "shapes:\n"
      "  - {name: film, kind: circle, radius: 20 mm}\n"
      "  - {name: hub, kind: circle, x: 2 mm, radius: 5 mm}\n"
      "  - {name: active, kind: difference, of: [film, hub]}\n"
      "  - {name: side, kind: rectangle, x: 12 mm, y: 3 mm, width: 6 mm, height: 4 mm}\n"
      "plies:\n"
      "  - {name: film, shape: film, material: elastosil-2030, thickness: 100 um, "
      "pre_stretch: [1.2, 1.25]}\n"
      "electrodes:\n"
      "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
      "  - {ply: film, side: top, shape: active, channel: drive}\n"
      "supports:\n"
      "  - {edge: film, move_y: 0.2 mm}\n"
      "bodies:\n"
      "  - {name: hub, shape: hub, free: [], move_x: 0.5 mm, move_y: 0.3 mm, move_z: 2 mm, "
      "turn_y: 3 degree, turn_z: 2 degree}\n"
      "monitors:\n"
      "  - {name: hub, body: hub}\n"
      "  - {name: side, shape: side}\n"
      "compute:\n"
      "  voltage: {to: 2 kV, step: 1 kV}\n"
      "  solid: {film: membrane, order: 1}\n";
  static const char *const only[] = {"voltage",
                                     "plies.film.thickness",
                                     "bodies.hub.move_x",
                                     "bodies.hub.move_z",
                                     "bodies.hub.turn_y",
                                     "shapes.hub.radius",
                                     "shapes.film.radius",
                                     "supports[0].move_y",
                                     NULL};
  struct at at = {.voltage_V = 1e3,
                  .monitors = {0, 0, 0, 0, 0, 1, 1},
                  .monitor_count = 7,
                  .motion = {DEA_OBSERVED_FORCE_X, DEA_OBSERVED_FORCE_Y, DEA_OBSERVED_FORCE_Z,
                             DEA_OBSERVED_MOMENT_Y, DEA_OBSERVED_MOMENT_Z, DEA_OBSERVED_STRETCH_X,
                             DEA_OBSERVED_STRETCH_Y},
                  .asked = true,
                  .only = only,
                  .again = true,
                  .leaves = 5e-11};
  read_design(&at, "held.yaml", device);
  check(&at);
}

static const char bender[] =
    "dea: 1\n"
    "title: bender\n"
    "shapes:\n"
    "  - {name: strip, kind: rectangle, x: 4 mm, width: 8 mm, height: 4 mm}\n"
    "  - {name: end, kind: rectangle, x: 7 mm, width: 1 mm, height: 2 mm}\n"
    "  - {name: root, kind: rectangle, width: 0.2 mm, height: 5 mm}\n"
    "plies:\n"
    "  - {name: passive, shape: strip, material: elastosil-2030, thickness: 200 um}\n"
    "  - {name: film, shape: strip, material: elastosil-2030, thickness: 200 um}\n"
    "electrodes:\n"
    "  - {ply: film, side: bottom, shape: strip, channel: ground}\n"
    "  - {ply: film, side: top, shape: strip, channel: drive}\n"
    "supports:\n"
    "  - {edge: strip, within: root}\n"
    "monitors:\n"
    "  - {name: end, shape: end}\n"
    "compute:\n"
    "  voltage: {to: 0.5 kV, step: 0.5 kV}\n";

/* A bender without pre-stretch, whose principal membrane forces are nearly equal: the remainder of
 * the smaller one falls as the square of the change. */
TEST(test_tension_of_a_bender)
{
  static const double shares[] = {1e-2, 1e-4, 1e-6};
  struct at at = {.voltage_V = 500, .again = true};
  double base[WIDTH], moved[WIDTH], slope, left[3];
  assert_int_equal(read_and_build(ctx, bender, NULL, 0, &at.design, &at.device), DEA_OK);
  solve(&at, at.device, at.voltage_V, base);
  const struct dea_model_type *type = dea_model_find("3d");
  const int column = dea_point_column_find(keys[TENSION]);
  const struct dea_design_change change = {{at.device, at.device},
                                           {at.voltage_V * (1 - 1e-5), at.voltage_V * (1 + 1e-5)},
                                           2e-5,
                                           {NULL, NULL}};
  const struct dea_gradient_request ask = {
      .changes = &change, .change_count = 1, .columns = &column, .column_count = 1};
  assert_int_equal(type->gradient(ctx, at.model, &ask, &slope), DEA_OK);
  for (int n = 0; n < 3; n++) {
    solve(&at, at.device, at.voltage_V * (1 + shares[n]), moved);
    left[n] = (moved[TENSION] - base[TENSION] - slope * shares[n]) / base[TENSION];
    assert_close(left[n], left[0] * pow(shares[n] / shares[0], 2), 0.1, 1e-11);
  }
  end(&at);
}

/* What the mesh of the device does not follow, and what it does. */
TEST(test_what_cannot_follow)
{
  struct at at = {.voltage_V = 1e3};
  double base[WIDTH], slope;
  assert_int_equal(read_and_build(ctx, cone, NULL, 0, &at.design, &at.device), DEA_OK);
  at.monitor_count = at.device->layout->monitor_count;
  solve(&at, at.device, at.voltage_V, base);
  const struct dea_model_type *type = dea_model_find("3d");
  const struct {
    struct dea_override change;
    bool follows;
  } all[] = {
      {{"shapes.film.radius", "20.001 mm"}, true},
      {{"supports", "[{edge: film, hold: [x, y, z], move_z: 1 um}]"}, true},
      {{"shapes.hub.x", "1 um"}, false},              // not in a sector
      {{"shapes.ring.outer_radius", "25 mm"}, false}, // over another outline: other pieces
      {{"monitors", "[{name: hub, body: hub}, {name: edge, at: [20 mm, 0 mm]}]"}, true},
  };
  const int column = dea_point_column_find("energy_J");
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
    struct dea_design *design;
    struct dea_device *device;
    assert_int_equal(read_and_build(ctx, cone, &all[i].change, 1, &design, &device), DEA_OK);
    const struct dea_design_change change = {
        {at.device, device}, {at.voltage_V, at.voltage_V}, 1e-6, {NULL, NULL}};
    const struct dea_gradient_request ask = {
        .changes = &change, .change_count = 1, .columns = &column, .column_count = 1};
    assert_int_equal(type->gradient(ctx, at.model, &ask, &slope), DEA_OK);
    assert_int_equal(!isnan(slope), all[i].follows);
    dea_device_destroy(ctx, device);
    dea_design_destroy(ctx, design);
  }
  end(&at);
}

// Critical voltages -------------------------------------------------------------------------------

/* Two soft films, bonded, the electrode between them: the field breaks the lower one down, then the
 * lower one is slack, then the laminate is pulled in. */
static const char laminate[] =
    "dea: 1\n"
    "title: two soft films bonded\n"
    "shapes:\n"
    "  - {name: film, kind: circle, radius: 15.5 mm}\n"
    "  - {name: active, kind: circle, radius: 2.6 mm}\n"
    "materials:\n"
    "  - name: soft\n"
    "    title: soft\n"
    "    kind: elastomer\n"
    "    laws:\n"
    "      - {id: a, law: arruda-boyce, parameters: {mu: 15.36 kPa, lambda_m: 5.99}, source: a "
    "test}\n"
    "    permittivity:\n"
    "      - {id: a, at_rest: 4.8, source: a test}\n"
    "    breakdown:\n"
    "      - {id: a, at_rest: 40 V/um, source: a test}\n"
    "  - name: stiff\n"
    "    title: stiff\n"
    "    kind: elastomer\n"
    "    laws:\n"
    "      - {id: a, law: neo-hookean, parameters: {mu: 20 kPa}, source: a test}\n"
    "    permittivity:\n"
    "      - {id: a, at_rest: 3, source: a test}\n"
    "    breakdown:\n"
    "      - {id: a, at_rest: 40 V/um, source: a test}\n"
    "plies:\n"
    "  - {name: lower, shape: film, material: soft, thickness: 30 um, pre_stretch: 1.2}\n"
    "  - {name: upper, shape: film, material: stiff, thickness: 20 um, pre_stretch: 1.3}\n"
    "electrodes:\n"
    "  - {ply: lower, side: bottom, shape: active, channel: ground}\n"
    "  - {ply: lower, side: top, shape: active, channel: drive}\n"
    "  - {ply: upper, side: top, shape: active, channel: ground}\n"
    "supports:\n"
    "  - {edge: film}\n"
    "monitors:\n"
    "  - {name: middle, at: [0 mm, 0 mm]}\n"
    "compute:\n"
    "  voltage: {to: 600 V, step: 50 V}\n"
    "  solid: {order: 1}\n";

static double find_critical(struct at *at, const struct dea_device *device,
                            enum dea_event_kind kind, double first_V, struct dea_critical *out)
{
  struct dea_model_settings *settings = &at->settings;
  *settings = dea_model_settings_of(at->design);
  settings->mesh_from = at->model;
  const struct dea_critical_request ask = {
      dea_model_find("3d"), device, settings, kind, first_V, 2e3};
  if (dea_critical_find(ctx, &ask, out) != DEA_OK || isnan(out->voltage_V)) {
    fail_msg("%s: %s %s", dea_event_name(kind), dea_context_message(ctx), out->why);
  }
  return out->voltage_V;
}

/* The remainder of a critical voltage falls as the square of the change of a number. */
static void check_critical_number(struct at *at, enum dea_event_kind kind,
                                  const struct dea_design_number *number, double base_V,
                                  double slope)
{
  enum { COUNT = 2 };
  static const double shares[COUNT] = {1e-3, 1e-5};
  const double reach = number->reach > 0 ? number->reach : number->value;
  double left[COUNT];
  for (int n = 0; n < COUNT; n++) {
    struct dea_changed_device changed;
    struct dea_critical there;
    assert_int_equal(dea_device_change(ctx, at->design, at->device, number,
                                       number->value + shares[n] * reach, &changed),
                     DEA_OK);
    left[n] = (find_critical(at, &changed.device, kind,
                             kind == DEA_EVENT_PULL_IN ? at->voltage_V : 0.95 * base_V, &there) -
               base_V - slope * reach * shares[n]) /
              base_V;
    dea_critical_end(ctx, &there);
    dea_changed_device_free(&changed);
  }
  for (int n = 0; n < COUNT; n++) {
    const double wanted = left[0] * pow(shares[n] / shares[0], 2);
    if (!(fabs(left[n] - wanted) <= 0.2 * fabs(wanted) + 5e-6 * shares[n] + voltage_floor(kind))) {
      fail_msg("%s by %s at %.0e: %.3e, not %.3e", dea_event_name(kind), number->key, shares[n],
               left[n], wanted);
    }
  }
}

/* Of those numbers that are in at->only, or all. Returns how many numbers there are, with the
 * slopes of all: out [DEA_NUMBERS_MAX]. */
static size_t check_critical(struct at *at, enum dea_event_kind kind, double *voltage_V,
                             double *slopes)
{
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  size_t count;
  struct dea_critical base;
  const double base_V = find_critical(at, at->device, kind, at->voltage_V, &base);
  assert_int_equal(dea_design_numbers(ctx, at->design, at->device, base_V, false, numbers, &count),
                   DEA_OK);
  dea_numbers_at_rest(at->device, numbers, &count);
  const struct dea_design_gradient ask = {.type = base.ask.type,
                                          .design = at->design,
                                          .device = at->device,
                                          .numbers = numbers,
                                          .number_count = count};
  assert_int_equal(dea_design_gradient_critical(ctx, &ask, &base, slopes), DEA_OK);
  at->model = base.model;
  for (size_t i = 0; i < count; i++) {
    if (strcmp(numbers[i].key, "voltage") != 0 && is_checked(at, &numbers[i])) {
      check_critical_number(at, kind, &numbers[i], base_V, slopes[i]);
    }
  }
  at->model = NULL;
  dea_critical_end(ctx, &base);
  *voltage_V = base_V;
  return count;
}

TEST(test_critical_voltages_of_a_laminate)
{
  static const enum dea_event_kind kinds[] = {DEA_EVENT_BREAKDOWN, DEA_EVENT_SLACK,
                                              DEA_EVENT_PULL_IN};
  static const char *const only[][2] = {
      {"plies.upper.pre_stretch"}, {"plies.lower.thickness"}, {"plies.upper.pre_stretch"}};
  struct at at = {.voltage_V = 200};
  double voltage_V, slopes[DEA_NUMBERS_MAX];
  assert_int_equal(read_and_build(ctx, laminate, NULL, 0, &at.design, &at.device), DEA_OK);
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    at.only = only[k];
    check_critical(&at, kinds[k], &voltage_V, slopes);
  }
  end(&at);
}

/* A strip without pre-stretch between two clamps, flat until it buckles. */
static const char strut[] =
    "dea: 1\n"
    "title: a strip between clamps\n"
    "shapes:\n"
    "  - {name: strip, kind: rectangle, width: 8 mm, height: 2 mm}\n"
    "  - {name: left, kind: rectangle, x: -4 mm, width: 0.2 mm, height: 3 mm}\n"
    "  - {name: right, kind: rectangle, x: 4 mm, width: 0.2 mm, height: 3 mm}\n"
    "materials:\n"
    "  - name: soft\n"
    "    title: soft\n"
    "    kind: elastomer\n"
    "    laws:\n"
    "      - {id: a, law: neo-hookean, parameters: {mu: 100 kPa}, source: a test}\n"
    "    permittivity:\n"
    "      - {id: a, at_rest: 3, source: a test}\n"
    "    density: {value: 1000 kg/m^3, source: a test}\n"
    "plies:\n"
    "  - {name: film, shape: strip, material: soft, thickness: 200 um}\n"
    "electrodes:\n"
    "  - {ply: film, side: bottom, shape: strip, channel: ground}\n"
    "  - {ply: film, side: top, shape: strip, channel: drive}\n"
    "supports:\n"
    "  - {edge: strip, within: left}\n"
    "  - {edge: strip, within: right}\n"
    "monitors:\n"
    "  - {name: middle, at: [0 mm, 0 mm]}\n"
    "compute:\n"
    "  voltage: {to: 2 kV, step: 1 kV}\n";

/* Held along its sides (y) and guided at its ends, which turn as little as their bottom edges move:
 * a slab of that has an exact mode. */
static const char supports_of_slab[] = "[{edge: strip, hold: [y]},"
                                       " {edge: strip, within: left, hold: [x]},"
                                       " {edge: strip, within: right, hold: [x]},"
                                       " {edge: strip, within: left, hold: hinged},"
                                       " {edge: strip, within: right, hold: hinged}]",
                  shapes_of_slab[] =
                      "[{name: strip, kind: rectangle, width: 8 mm, height: 1 mm},"
                      " {name: left, kind: rectangle, x: -5 mm, width: 2 mm, height: 3 mm},"
                      " {name: right, kind: rectangle, x: 5 mm, width: 2 mm, height: 3 mm}]";

/* The slab of the numbers of the design: thickness before the pre-stretch l. */
struct slab {
  double h, l, mu, eps;
};

/* In plane strain, X along the film and Z through it, with J = 1 and the pre-stretch in the moduli,
 * the energy is
 *
 *   (1/2) s |F e_X|^2 + (1/2) m |F e_Z|^2,   s = mu l^2 - eps (V/H)^2,   m = mu / l^4,   H = h /
 * l^2,
 *
 * so that a motion (f' sin kX, -k f cos kX) off the flat film is still where (s d_X^2 + m d_Z^2)
 * lap f cos kX = 0: f = A cosh kZ + B cosh k b Z, b^2 = s/m. No traction at Z = +-H/2 asks for
 *
 *   tanh a (1 + b^2)^2 = 4 b tanh(b a),   a = k H / 2,
 *
 * with k = 2 pi / L between guided ends. Of thin films 1 - b^2 = (k H)^2/3, Euler's formula. */
static double slab_voltage(const struct slab *at)
{
  const double H = at->h / (at->l * at->l), k = 2 * acos(-1) / 8e-3, a = 0.5 * k * H;
  const double m = at->mu / pow(at->l, 4);
  double low = 0.1 * a * a, high = 4 * a * a; // of 1 - b^2
  for (int i = 0; i < 100; i++) {
    const double middle = 0.5 * (low + high), b = sqrt(1 - middle);
    if (tanh(a) * pow(2 - middle, 2) < 4 * b * tanh(b * a)) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return H * sqrt((at->mu * at->l * at->l - m * (1 - low)) / at->eps);
}

TEST(test_buckling_of_a_slab)
{
  only_nightly();
  enum { VOLTAGE, THICKNESS, STRETCH, MU, PERMITTIVITY, NUMBERS };
  static const double share = 1e-6;
  static const char *const none[] = {NULL};
  const struct dea_override changes[] = {{"shapes", shapes_of_slab},
                                         {"supports", supports_of_slab},
                                         {"compute.solid.refinement", "2"}};
  const double relative = 3 * 8.8541878128e-12;
  struct at at = {.voltage_V = 500, .only = none};
  struct slab slab = {200e-6, 1, 100e3, relative};
  double *const number[NUMBERS] = {NULL, &slab.h, &slab.l, &slab.mu, &slab.eps};
  double V, by[DEA_NUMBERS_MAX];
  assert_int_equal(read_and_build(ctx, strut, changes, 3, &at.design, &at.device), DEA_OK);
  check_critical(&at, DEA_EVENT_BUCKLING, &V, by);
  by[PERMITTIVITY] /= relative / 3;
  assert_close(V, slab_voltage(&slab), 1e-5, 0);
  for (int i = THICKNESS; i < NUMBERS; i++) {
    const double own = *number[i];
    double sides_V[2];
    for (int k = 0; k < 2; k++) {
      *number[i] = own * (k == 0 ? 1 - share : 1 + share);
      sides_V[k] = slab_voltage(&slab);
    }
    *number[i] = own;
    assert_close(by[i], (sides_V[1] - sides_V[0]) / (2 * share * own), i == THICKNESS ? 5e-4 : 1e-5,
                 0); // of the thickness the mesh is seen
  }
  end(&at);
}

TESTS(context_set_up, context_tear_down)
