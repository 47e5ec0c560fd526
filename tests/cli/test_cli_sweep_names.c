/* Every number that `dea run --sensitivity` has a slope by is a variable of searches and sweeps. */
// ctest: solid
#include "command.h"
#include "study/design_file.h"
#include "study/design_gradient.h"
#include "study/force.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char disc[] =
    "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.5\n"
    "frame: {inner_diameter: 30 mm}\ngravity: fibres_up\n"
    "electrodes: {radius: 3.75 mm stretched, material: sylgard-184, thickness: 10 um}\n"
    "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet, bond: {thickness: 20 um}}\n"
    "compute: {models: [3d], voltage: {values: [2 kV]}, force: {depth: [0.5 mm], radius: 1 mm},\n"
    "  solid: {film: membrane}}\n";
static const char parts[] =
    "dea: 1\ntitle: parts\nshapes:\n  - {name: film, kind: circle, radius: 20 mm}\n"
    "  - {name: hub, kind: circle, radius: 5 mm, y: 0.5 mm}\n"
    "  - {name: active, kind: difference, of: [film, hub]}\nplies:\n"
    "  - {name: film, shape: film, material: elastosil-2030, thickness: 100 um, pre_stretch: [1.2, "
    "1.25]}\n"
    "  - {name: stiff, shape: hub, material: pet, thickness: 100 um}\n"
    "electrodes:\n  - {ply: film, side: bottom, shape: active, channel: ground}\n"
    "  - {ply: film, side: top, shape: active, channel: drive}\nsupports: [{edge: film}]\n"
    "bodies: [{name: hub, shape: hub, free: [z], mass: 2 g}]\n"
    "springs: [{body: hub, direction: z, stiffness: 20 N/m}]\n"
    "pressures: [{ply: film, side: bottom, shape: film, pressure: 20 Pa}]\ngravity: top_up\n"
    "monitors: [{name: hub, body: hub}]\n"
    "compute: {models: [3d], voltage: {values: [2 kV]}, solid: {film: membrane}}\n";

/* A command that needs model 3d; a build without it skips the test. */
static void run_solid(const char *arguments)
{
  const int code = command_run(arguments);
  if (code == 2) {
    skip();
  }
  if (code != 0) {
    fail_msg("dea %s: exit code %d:\n%s", arguments, code, command_err);
  }
}

/* Errors of a search by that name; nothing is computed, since a limit is of no quantity. */
static size_t count_errors(const char *name, double value, const char *unit, const char *state)
{
  char text[1000];
  size_t count = 0;
  snprintf(text, sizeof text,
           "dea_explore: 1\nname: names\ndesign: design.yaml\nmodel: 3d\nvoltages: [1 kV]\n"
           "quantities: [capacitance_F]\nobjectives: [{quantity: capacitance_F}]\n"
           "limits: [{quantity: nothing, above: 0}]\n"
           "variables: [{name: '%s', low: %.10g %s%s, high: %.10g %s%s}]\n",
           name, value - 0.01 * fabs(value), unit, state, value + 0.01 * fabs(value), unit, state);
  command_write("names.yaml", text);
  command_expect("optimise names.yaml", 3, "'nothing' is none of the quantities");
  for (const char *at = command_err; (at = strstr(at, "names.yaml:")) != NULL; at++) {
    count += strstr(at, "error:") != NULL ? 1U : 0U;
  }
  return count - 1; // that of the limit
}

/* What a run with --sensitivity prints slopes by but the voltage, which is the file's. */
static size_t ask_for_names(const char *text)
{
  static struct dea_design_number all[DEA_NUMBERS_MAX];
  char path[600];
  size_t count;
  struct dea_context *ctx;
  struct dea_design *design;
  struct dea_device *device;
  command_write("design.yaml", text);
  snprintf(path, sizeof path, "%s/design.yaml", command_folder);
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(dea_design_read(ctx, path, NULL, 0, &design), DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_int_equal(dea_design_numbers(ctx, design, device, 0, false, all, &count), DEA_OK);
  if (dea_force_stops(design) > 0) {
    const struct dea_pressed pressed = {dea_force_indenter(design),
                                        dea_force_first_depth_m(design)};
    dea_tip_numbers(&pressed, all, &count);
  }
  for (size_t i = 0; i < count; i++) {
    const char *unit = strcmp(all[i].unit, "1") == 0 ? "" : all[i].unit;
    if (count_errors(all[i].key, all[i].value, unit, "") > 0 &&
        count_errors(all[i].key, all[i].value, unit, " stretched") > 0) {
      fail_msg("%s is no variable: %s", all[i].key, command_err);
    }
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return count;
}

TEST(test_every_name)
{
  assert_true(ask_for_names(disc) >= 22);
  assert_true(ask_for_names(parts) >= 17);
}

/* The most plies that a design has: the last one's material is among the numbers too. */
TEST(test_most_plies)
{
  static char text[16000];
  size_t at = (size_t)snprintf(text, sizeof text,
                               "dea: 1\ntitle: pile\nshapes: [{name: a, kind: circle, radius: 9 "
                               "mm}]\nmonitors: [{name: m, at: [0 mm, 0 mm]}]\n"
                               "electrodes:\n  - {ply: p1, side: bottom, shape: a, channel: "
                               "ground}\n  - {ply: p1, side: top, shape: a, channel: drive}\n"
                               "supports: [{edge: a}]\ncompute: {models: [3d], voltage: {values: "
                               "[1 kV]}}\nplies:\n");
  for (int i = 1; i <= 100; i++) {
    at += (size_t)snprintf(text + at, sizeof text - at,
                           "  - {name: p%d, shape: a, material: elastosil-2030, thickness: 100 um, "
                           "pre_stretch: [1.2, 1.3]}\n",
                           i);
  }
  command_write("design.yaml", text);
  if (count_errors("plies.p100.density", 970, "kg/m^3", "") > 0) {
    fail_msg("%s", command_err);
  }
  assert_int_equal(count_errors("shapes.a.radius", 9e-3, "m", ""), 0);
  assert_null(strstr(command_err, "are left out"));
}

/* At next to no voltage C = eps_0 eps_r pi r^2 l^2 / h, so that a limit of the capacitance is one
 * of the permittivity of the ply; the design that is written has it too. */
TEST(test_permittivity_of_a_ply)
{
  static const double eps_0 = 8.8541878128e-12, radius_m = 10e-3, h_m = 100e-6, l = 1.2,
                      wanted_F = 130e-12;
  static char bytes[COMMAND_TEXT_MAX];
  const double permittivity = wanted_F * (h_m / (l * l)) / (eps_0 * acos(-1) * radius_m * radius_m);
  double found, eps_r;
  command_write("flat.yaml",
                "dea: 1\ntitle: flat\nshapes:\n"
                "  - {name: film, kind: circle, radius: 20 mm}\n"
                "  - {name: active, kind: circle, radius: 10 mm}\n"
                "plies: [{name: film, shape: film, material: elastosil-2030, thickness: 100 um, "
                "pre_stretch: 1.2}]\nelectrodes:\n"
                "  - {ply: film, side: bottom, shape: active, channel: ground}\n"
                "  - {ply: film, side: top, shape: active, channel: drive}\n"
                "supports: [{edge: film}]\n"
                "compute: {models: [3d], voltage: {values: [1 V]}, "
                "solid: {film: membrane, refinement: 2}}\n"); // arcs of parabolas: 1e-5 with 1
  command_write("flat-best.yaml",
                "dea_explore: 1\nname: flat\ndesign: flat.yaml\nmodel: 3d\nvoltages: [1 V]\n"
                "quantities: [capacitance_F]\nstarts: 1\nmethod: slsqp\n"
                "objectives: [{quantity: capacitance_F}]\n"
                "limits: [{quantity: capacitance_F, below: 130 pF}]\n"
                "variables: [{name: plies.film.permittivity.at_rest, low: 2, high: 5}]\n");
  run_solid("optimise flat-best.yaml -j 1 -q -o flat");
  assert_contains(command_out, "gradients: of the model\n");
  const char *row = strstr(command_out, "plies.film.permittivity.at_rest");
  assert_non_null(row);
  found = strtod(row + strlen("plies.film.permittivity.at_rest"), NULL);
  assert_close(found, permittivity, 1e-5, 0); // six digits are printed
  command_read("flat/best.yaml", bytes);
  assert_contains(bytes, "flat-film");
  assert_int_equal(sscanf(strstr(bytes, "at_rest: "), "at_rest: %lf", &eps_r), 1);
  assert_close(eps_r, permittivity, 1e-6, 0);
  run_solid("run flat/best.yaml --study sweep -q --no-figures --json");
  const char *point = strstr(command_out, "\"capacitance_F\": ");
  assert_non_null(point);
  assert_close(strtod(point + strlen("\"capacitance_F\": "), NULL), wanted_F, 1e-6, 0);
}

TESTS(command_set_up, command_tear_down)
