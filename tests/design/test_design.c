/* design and device: what a good file gives, with defaults, overrides and the list of values. */
#include "design_text.h"
#include "model/model.h"
#include "study/design_file.h"

static struct dea_context *ctx;
static struct dea_design *design;
static struct dea_device *device;

static int set_up(void **state)
{
  design = NULL;
  device = NULL;
  return dea_context_create(NULL, &ctx) == DEA_OK ? 0 : -1;
}

static int tear_down(void **state)
{
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_context_destroy(ctx);
  return 0;
}

static void read_good(const char *text, const struct dea_override *overrides, size_t count)
{
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  dea_status status = read_and_build(ctx, text, overrides, count, &design, &device);
  if (status != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", dea_context_message(ctx));
  }
}

static const struct dea_listed *listed(const char *path)
{
  for (size_t i = 0; i < design->values.count; i++) {
    if (strcmp(design->values.items[i].path, path) == 0) {
      return &design->values.items[i];
    }
  }
  fail_msg("'%s' is not listed", path);
  return NULL;
}

TEST(test_lengths_are_those_of_the_stretched_film)
{
  read_good(GOOD_DESIGN, NULL, 0);
  assert_close(device->film_thickness_unstretched_m, 100e-6, 1e-14, 0);
  assert_close(device->film_thickness_m, 100e-6 / 2.25, 1e-14, 0);
  assert_close(device->frame_radius_m, 15e-3, 1e-14, 0);
  assert_close(device->electrode_radius_m, 3.75e-3, 1e-14, 0);
  assert_close(device->coverage, 0.25, 1e-14, 0);
  assert_close(device->fibre_tip_radius_m, 3.75e-3, 1e-14, 0);
  assert_close(device->fibre_length_m, 11.25e-3, 1e-14, 0);
  assert_close(device->fibre_overlap_m, 0, 0, 1e-18);
}

/* Editors on Windows put a mark first, end lines by CR LF, or both. */
TEST(test_files_of_other_editors)
{
  read_good("\xef\xbb\xbf" GOOD_DESIGN, NULL, 0);
  assert_int_equal(listed("pre_stretch")->location.line, 3);
  assert_int_equal(listed("dea")->location.column, 6);
  read_good("\xef\xbb\xbf"
            "dea: 1\r\nfilm: {material: film, thickness: 100 um}\r\npre_stretch: 1.5\r\n"
            "frame: {inner_diameter: 30 mm}\r\nelectrodes: {diameter: 5 mm unstretched}\r\n"
            "fibres: {count: 4, material: stiff}\r\n" FILM_MATERIAL,
            NULL, 0);
  assert_int_equal(listed("pre_stretch")->location.line, 3);
}

TEST(test_materials_of_the_file)
{
  const struct dea_override sets[] = {{"film.law", "b"}, {"film.permittivity", "sloped"}};
  read_good(GOOD_DESIGN, sets, 2);
  assert_string_equal(device->film.law->name, "neo-hookean");
  assert_string_equal(device->film.law_id, "b");
  assert_close(device->film.param[0], 300e3, 1e-14, 0);
  assert_close(device->film.permittivity.at_rest, 2.48, 1e-14, 0);
  assert_close(device->film.permittivity.slope, -0.28, 1e-14, 0);
  assert_true(device->film.breakdown.known && device->film.breakdown.exponent_known);
  assert_close(device->film.breakdown.at_rest_V_per_m, 80e6, 1e-14, 0);
  assert_close(device->fibre.young_modulus_Pa, 2950e6, 1e-14, 0);
}

/* A material in one line is the one of the list `materials` with the same numbers. */
TEST(test_material_in_one_line)
{
  static const struct {
    const char *line, *law;
    double param[4];
  } lines[] = {
      {"yeoh: [120 kPa, 5 kPa, 1 kPa]", "yeoh", {120e3, 5e3, 1e3}},
      {"neo-hookean: 60 kPa", "neo-hookean", {60e3}},
      {"mooney-rivlin: [16 kPa, 0.9 kPa]", "mooney-rivlin", {16e3, 0.9e3}},
      {"gent: [60 kPa, 120]", "gent", {60e3, 120}},
      {"ogden: [60 kPa, 1.8]", "ogden", {60e3, 1.8}},
      {"ogden: [60 kPa, 1.8, 2 kPa, -1]", "ogden", {60e3, 1.8, 2e3, -1}},
      {"arruda-boyce: [15 kPa, 20]", "arruda-boyce", {15e3, 20}},
  };
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
    char text[300];
    snprintf(text, sizeof text,
             "{%s, permittivity: 2.9, breakdown: 70 V/um, density: 1.1 g/cm^3, "
             "resistivity: 1e12 ohm m}",
             lines[i].line);
    const struct dea_override sets[] = {
        {"film.material", text}, {"fibres.material", "{young_modulus: 3 GPa, poisson_ratio: 0.3}"}};
    read_good(GOOD_DESIGN, sets, 2);
    const struct dea_material *film = &device->film;
    assert_string_equal(film->name, "film.material");
    assert_string_equal(film->law->name, lines[i].law);
    for (int k = 0; k < 4; k++) {
      assert_close(film->param[k], lines[i].param[k], 1e-14, 0);
    }
    assert_close(film->permittivity.at_rest, 2.9, 1e-14, 0);
    assert_close(film->breakdown.at_rest_V_per_m, 70e6, 1e-14, 0);
    assert_close(film->density_kg_per_m3, 1100, 1e-14, 0);
    assert_close(film->resistivity_ohm_m, 1e12, 1e-14, 0);
    assert_close(device->fibre.young_modulus_Pa, 3e9, 1e-14, 0);
  }
}

/* The same in a ply, twice, beside materials of the list. */
TEST(test_plies_with_materials_in_one_line)
{
  read_good("dea: 1\n"
            "shapes: [{name: a, kind: circle, radius: 9 mm}]\n"
            "plies:\n"
            "  - {name: one, shape: a, material: {neo-hookean: 50 kPa, permittivity: 3}, "
            "thickness: 50 um}\n"
            "  - {name: two, shape: a, material: {gent: [60 kPa, 120], permittivity: 4}, "
            "thickness: 50 um}\n"
            "  - {name: base, shape: a, material: listed, thickness: 50 um}\n"
            "electrodes: [{ply: one, side: bottom, shape: a, channel: ground}, "
            "{ply: two, side: bottom, shape: a, channel: d}]\n"
            "supports: [{edge: a}]\n"
            "materials: [{name: listed, kind: plastic, "
            "elastic: {young_modulus: 1 GPa, poisson_ratio: 0.3, source: s}}]\n",
            NULL, 0);
  const struct dea_layout *l = device->layout;
  assert_close(l->plies[0].material.param[0], 50e3, 1e-14, 0);
  assert_close(l->plies[1].material.param[1], 120, 1e-14, 0);
  assert_string_equal(l->plies[1].material.name, "plies.two.material");
  assert_close(l->plies[2].material.young_modulus_Pa, 1e9, 1e-14, 0);
}

static bool has_note(const char *part)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == DEA_NOTE && strstr(findings[i].text, part) != NULL) {
      return true;
    }
  }
  return false;
}

TEST(test_breakdown_without_a_known_exponent_is_noted)
{
  read_good(GOOD_DESIGN, NULL, 0);
  assert_false(has_note("pessimistic")); // set x has its exponent
  const struct dea_override y[] = {{"film.breakdown", "y"}, {"pre_stretch", "1"}};
  read_good(GOOD_DESIGN, &y[0], 1);
  assert_true(device->film.breakdown.known && !device->film.breakdown.exponent_known);
  assert_close(device->film.breakdown.at_rest_V_per_m, 100e6, 1e-14, 0);
  assert_true(has_note("margins at pre-stretch 1.5 are pessimistic"));
  dea_finding_clear(ctx);
  read_good(GOOD_DESIGN, y, 2);
  assert_false(has_note("pessimistic")); // the film is not pre-stretched
}

/* 51 V/um h^-0.25 s^0.63 of a 1 mm film, for 100 um: with h = H/s^2 a power of 0.63 + 0.5. */
TEST(test_breakdown_fits_the_film)
{
  const struct dea_override huang[] = {{"film.material", "vhb-4910"},
                                       {"film.law", "arruda-boyce-2016"},
                                       {"film.permittivity", "constant"},
                                       {"film.breakdown", "huang-2012"}};
  read_good(GOOD_DESIGN, huang, 4);
  assert_close(device->film.breakdown.at_rest_V_per_m, 51e6 * pow(0.1, -0.25), 1e-13, 0);
  assert_close(device->film.breakdown.exponent, 1.13, 1e-13, 0);
}

TEST(test_every_default_is_listed)
{
  read_good(GOOD_DESIGN, NULL, 0);
  static const struct {
    const char *path, *text;
    enum dea_origin origin;
  } wanted[] = {
      {"film.thickness", "100 um", DEA_GIVEN},
      {"film.law", "the material's first", DEA_ABSENT},
      {"electrodes.material", "none", DEA_ABSENT},
      {"electrodes.thickness", "0 um", DEA_DEFAULT},
      {"fibres.width", "2 mm", DEA_DEFAULT},
      {"fibres.thickness", "100 um", DEA_DEFAULT},
      {"fibres.overlap", "0 mm stretched", DEA_DEFAULT},
      {"fibres.bond.thickness", "0 um", DEA_DEFAULT},
      {"fibres.bond.modulus", "1 MPa", DEA_DEFAULT},
      {"fibres.outer_end", "clamped", DEA_DEFAULT},
      {"materials[0].laws[0].parameters.c2", "-6 kPa", DEA_GIVEN},
      {"compute.models[1]", "axisymmetric", DEA_DEFAULT},
      {"compute.voltage.to", "8 kV", DEA_DEFAULT},
      {"compute.voltage.step", "0.1 kV", DEA_DEFAULT},
      {"compute.path.max_stretch", "1.5 x pre_stretch, or all voltages", DEA_ABSENT},
      {"compute.coverage_by", "radius", DEA_DEFAULT},
      {"report.figures[0]", "svg", DEA_DEFAULT},
      {"report.width", "85 mm", DEA_DEFAULT},
  };
  for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
    const struct dea_listed *value = listed(wanted[i].path);
    assert_string_equal(value->text, wanted[i].text);
    assert_int_equal(value->origin, wanted[i].origin);
  }
  assert_int_equal(listed("film.thickness")->location.line, 2);
  assert_int_equal(listed("film.thickness")->location.column, 35);
}

TEST(test_sweeps)
{
  static const struct {
    const char *voltage;
    size_t count;
    double last;
  } sweeps[] = {
      {"{from: 8 kV, to: 0 kV, step: 1 kV}", 9, 0},
      {"{from: 1 kV, to: 1 kV}", 1, 1000},
      {"{to: 1 kV, step: 300 V}", 4, 900},
      {"{from: 0 kV, to: 0.9 kV, step: 0.1 kV}", 10, 900},
      {"{values: [3 kV, 1 kV, 500 V]}", 3, 500},
      {"{to: 2 kV, step: 1 kV, back: yes}", 5, 0},
      {"{values: [1 kV, 3 kV], back: yes}", 3, 1000},
  };
  for (size_t i = 0; i < sizeof sweeps / sizeof sweeps[0]; i++) {
    const struct dea_override set = {"compute.voltage", sweeps[i].voltage};
    read_good(GOOD_DESIGN, &set, 1);
    assert_int_equal(design->compute.voltage_count, sweeps[i].count);
    assert_close(design->compute.voltages_V[sweeps[i].count - 1], sweeps[i].last, 1e-14, 1e-9);
  }
}

TEST(test_three_ways_to_place_the_tip)
{
  static const struct {
    const char *key, *value;
    double tip_m;
  } ways[] = {
      {"fibres.length", "12 mm stretched", 3e-3},
      {"fibres.tip_radius", "4 mm stretched", 4e-3},
      {"fibres.tip_radius", "4 mm unstretched", 6e-3},
      {"fibres.overlap", "1 mm stretched", 2.75e-3},
      {"fibres.overlap", "-1 mm unstretched", 5.25e-3},
  };
  for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
    const struct dea_override set = {ways[i].key, ways[i].value};
    read_good(GOOD_DESIGN, &set, 1);
    assert_close(device->fibre_tip_radius_m, ways[i].tip_m, 1e-12, 0);
    assert_close(device->fibre_length_m, 15e-3 - ways[i].tip_m, 1e-12, 0);
  }
}

TEST(test_override_wins_over_the_other_way_to_say_it)
{
  const struct dea_override sets[] = {{"electrodes.radius", "4 mm stretched"},
                                      {"frame.inner_radius", "20 mm"},
                                      {"film.thickness", "200um"},
                                      {"compute.coverage_by", "area"}};
  read_good(GOOD_DESIGN, sets, 4);
  assert_close(device->electrode_radius_m, 4e-3, 1e-14, 0);
  assert_close(device->frame_radius_m, 20e-3, 1e-14, 0);
  assert_close(device->film_thickness_unstretched_m, 200e-6, 1e-14, 0);
  assert_close(device->coverage, 0.04, 1e-14, 0);
  assert_int_equal(listed("film.thickness")->origin, DEA_OVERRIDE);
  assert_string_equal(listed("film.thickness")->location.file, "--set film.thickness");
}

TEST(test_null_takes_a_section_away)
{
  const struct dea_override set = {"fibres", "null"};
  read_good(GOOD_DESIGN, &set, 1);
  assert_false(design->has_fibres);
  assert_int_equal(device->fibre_count, 0);
  assert_true(isnan(design->fibres.width_m.si));
  assert_string_equal(listed("fibres")->text, "none");
}

TEST(test_pre_stretch_beyond_the_data_is_a_warning)
{
  const struct dea_override set = {"pre_stretch", "2.5"};
  read_good(GOOD_DESIGN, &set, 1);
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1);
  assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 0);
}

TEST(test_taper_and_free_end)
{
  const struct dea_override sets[] = {{"fibres.width", "3 mm"},
                                      {"fibres.tip_width", "1 mm"},
                                      {"fibres.outer_end", "free"},
                                      {"fibres.outer_gap", "2 mm unstretched"},
                                      {"compute.solid.domain", "disc"},
                                      {"compute.solid.refinement", "2.5"},
                                      {"compute.solid.side", "fibres"},
                                      {"compute.solid.order", "3"},
                                      {"compute.solid.order_z", "1"},
                                      {"compute.solid.elements_z", "3"},
                                      {"compute.solid.tip_refinement", "3.5"}};
  read_good(GOOD_DESIGN, sets, 11);
  assert_close(device->fibre_width_m, 3e-3, 1e-14, 0);
  assert_close(device->fibre_tip_width_m, 1e-3, 1e-14, 0);
  assert_close(device->fibre_outer_gap_m, 3e-3, 1e-14, 0);
  const struct dea_model_settings settings = dea_model_settings_of(design);
  assert_int_equal(settings.domain, DEA_DOMAIN_DISC);
  assert_int_equal(settings.film, DEA_FILM_SOLID);
  assert_int_equal(settings.buckling_branch, DEA_BRANCH_FIBRES);
  assert_close(settings.refinement, 2.5, 0, 0);
  assert_close(settings.tip_refinement, 3.5, 0, 0);
  assert_int_equal(settings.order, 3);
  assert_int_equal(settings.order_z, 1);
  assert_int_equal(settings.elements_z, 3);
}

/* An older word of a key is read as the key; the list of values knows the key only. */
TEST(test_older_words_of_keys)
{
  const struct dea_override old[] = {{"compute.solid.side", "fibres"}};
  const struct dea_override new[] = {{"compute.solid.buckling_branch", "fibres"}};
  const struct dea_override both[] = {{"compute.solid.buckling_branch", "fibres"},
                                      {"compute.solid.side", "back"}};
  for (int i = 0; i < 2; i++) {
    bool listed = false;
    read_good(GOOD_DESIGN, i == 0 ? old : new, 1);
    assert_int_equal(design->compute.solid.buckling_branch.value, DEA_BRANCH_FIBRES);
    for (size_t k = 0; k < design->values.count; k++) {
      const struct dea_listed *value = &design->values.items[k];
      assert_string_not_equal(value->path, "compute.solid.side");
      listed = listed || (strcmp(value->path, "compute.solid.buckling_branch") == 0 &&
                          value->origin == DEA_OVERRIDE);
    }
    assert_true(listed);
  }
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  device = NULL;
  assert_int_equal(
      dea_design_read_memory(ctx, "t.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), both, 2, &design),
      DEA_E_DESIGN);
  assert_true(dea_finding_count(ctx, DEA_ERROR) == 1);
  dea_finding_clear(ctx);
}

/* Whether the reader refuses a value of a key, which it has to know. */
static bool is_refused(const char *path, const char *value)
{
  char limit[160], choice[160];
  const struct dea_override set = {path, value};
  const char *key = strrchr(path, '.') != NULL ? strrchr(path, '.') + 1 : path;
  snprintf(limit, sizeof limit, "%s must be ", key);
  snprintf(choice, sizeof choice, "%s: '%s' is none of", key, value);
  dea_finding_clear(ctx);
  dea_design_destroy(ctx, design);
  dea_design_read_memory(ctx, "t.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), &set, 1, &design);
  if (find_error(ctx, "unknown key") != NULL) {
    print_findings(ctx);
    fail_msg("the reference has '%s'", path);
  }
  return find_error(ctx, limit) != NULL || find_error(ctx, choice) != NULL;
}

/* A limit of a form, "> 0" or "<= 1e+06": by the sign its own value may be written or not, and what
 * is beyond it may not. */
static void check_limit(const char *path, const char *form, const char *sign)
{
  char unit[32] = "", value[200], *end;
  const char *at = strstr(form, sign);
  if (at == NULL) {
    return;
  }
  bool inclusive = at[1] == '=', list = strncmp(form, "list of ", 8) == 0;
  double limit = strtod(at + 1 + inclusive, &end);
  double beyond = limit + (*sign == '<' ? 1 : -1) * fmax(1, 0.01 * fabs(limit));
  form += list ? 8 : 0;
  if (strncmp(form, "length", 6) == 0) {
    strcpy(unit, " m stretched");
  } else if (sscanf(form, "number in %30[^,]", unit + 1) == 1) {
    unit[0] = ' ';
  }
  for (int i = 0; i < 2; i++) {
    double number = i == 0 ? limit : beyond;
    snprintf(value, sizeof value, "%.17g%s", number, unit);
    if (list) {
      snprintf(value, sizeof value, "[%.17g%s, %.17g%s, %.17g%s]", number, unit, number, unit,
               number, unit);
    }
    if (is_refused(path, value) != (i > 0 || !inclusive)) {
      print_findings(ctx);
      fail_msg("%s: %s, but the reference says %s", path, value, form);
    }
  }
}

/* The table of keys says what the reader does: every key is known and takes its example, limits
 * are where they are said to be, one of a choice is taken and nothing else; and no value that is
 * read lacks its row. */
TEST(test_reference_says_what_is_read)
{
  struct dea_design_schema schema;
  struct dea_text page = {.ctx = ctx};
  char path[120], form[200], line[1000];
  size_t rows = 0;
  dea_design_file_schema(&schema);
  dea_schema_print_markdown(&schema.disc.record, &page);
  assert_false(page.failed);
  const char *keys = dea_text_get(&page);
  for (const char *row = keys; (row = strstr(row, "\n| `")) != NULL; row++) {
    snprintf(line, sizeof line, "%.*s", (int)strcspn(row + 1, "\n"), row + 1);
    char *tail = line + strlen(line) - strlen("` |");
    if (sscanf(line, "| `%119[^`]` | %199[^|]", path, form) != 2 || strcmp(tail, "` |") != 0 ||
        strpbrk(path, "[(") != NULL) {
      continue; // a section; of the rows of lists and kinds the key has no path of its own
    }
    *tail = '\0';
    const char *example = strrchr(line, '`') + 1;
    if (is_refused(path, example)) {
      print_findings(ctx);
      fail_msg("%s: the example '%s' is refused", path, example);
    }
    check_limit(path, form, "<");
    check_limit(path, form, ">");
    if (strncmp(form, "one of: ", 8) == 0) {
      assert_true(is_refused(path, "nonsense"));
      for (char *word = strtok(form + 8, ", "); word != NULL; word = strtok(NULL, ", ")) {
        assert_false(is_refused(path, word));
      }
    }
    rows++;
  }
  assert_true(rows > 60);
  read_good(GOOD_DESIGN, NULL, 0);
  for (size_t i = 0; i < design->values.count; i++) {
    const char *value = design->values.items[i].path;
    snprintf(line, sizeof line, "\n| `%s", value);
    const char *row = strstr(keys, line);
    while (row != NULL && strchr("`[", row[strlen(line)]) == NULL) {
      row = strstr(row + 1, line);
    }
    if (strchr(value, '[') == NULL && row == NULL) {
      fail_msg("the reference lacks '%s'", value);
    }
  }
  dea_text_free(&page);
}

TESTS_EACH(NULL, NULL, set_up, tear_down)
