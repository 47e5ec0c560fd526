/* dea check, schema, materials: what they print and their exit codes. */
// ctest: quick, heavy
#include "command.h"

#include <jansson.h>

static void write_bad_files(void)
{
  command_write("text.yaml", "hello\n");
  command_write("design.yaml", "my own\n");
  command_write(
      "coupled.yaml",
      "dea: 1\n"
      "film: {material: elastosil-2030, permittivity: stretch-dependent, thickness: 1 mm}\n"
      "pre_stretch: 1.5\n"
      "frame: {inner_radius: 15 mm}\n"
      "electrodes: {radius: 5 mm stretched}\n"
      "compute: {models: [3d],\n"
      "  solid: {field: coupled}}\n");
  command_write("answer.yaml", "dea: 1\n"
                               "film: {material: elastosil-2030, thickness: 1 mm}\n"
                               "pre_stretch: 1.5\n"
                               "frame: {inner_radius: 15 mm}\n"
                               "electrodes: {radius: 5 mm stretched}\n"
                               "compute: {models: [3d], frequency: {bias: [1 kV]},\n"
                               "  solid: {field: coupled}}\n");
  command_write("turned.yaml", "dea: 1\n"
                               "film: {material: own, thickness: 1 mm}\n"
                               "materials:\n"
                               "  - name: own\n"
                               "    kind: elastomer\n"
                               "    laws: [{id: a, law: holzapfel-gasser-ogden, parameters: {mu: "
                               "100 kPa, k1: 50 kPa}, source: t}]\n"
                               "    permittivity: [{id: a, at_rest: 3, source: t}]\n"
                               "pre_stretch: 1.5\n"
                               "frame: {inner_radius: 15 mm}\n"
                               "electrodes: {radius: 5 mm stretched}\n"
                               "compute: {models: [3d]}\n");
  command_write("tab.yaml", "dea: 1\nfilm: # für VHB\n\tthickness: 100 um\n");
  command_write("binary.yaml", "\x7f"
                               "ELF\x02\x01\xff\xfe");
  char text[600];
  snprintf(text, sizeof text, "cd '%s' && mkfifo pipe && truncate -s 100000000 big.yaml",
           command_folder);
  assert_int_equal(system(text), 0);
}

TEST(test_every_bad_file_has_its_exit_code)
{
  static const struct {
    const char *arguments;
    int code;
    const char *part;
  } bad[] = {
      {"check missing.yaml", 5, "cannot open 'missing.yaml': No such file or directory"},
      {"check .", 5, "'.' is a directory, not a file"},
      {"check pipe", 5, "'pipe' is a pipe, not a file"},
      {"check /dev/zero", 5, "is a device, not a file"},
      {"check big.yaml", 3, "larger than 4 MB"},
      {"check text.yaml", 3, "text.yaml:1:1: error: "},
      {"check binary.yaml", 3, "not a text file in UTF-8"},
      {"check", 2, "a design file is needed"},
      {"check a b", 2, "one design file at a time"},
      {"check --nonsense", 2, "--nonsense"},
      {"check @/examples/frdea-4.yaml --set x", 2, "--set takes KEY=VALUE"},
      {"check @/examples/frdea-4.yaml --set pre_stretch=0.9", 3,
       "--set pre_stretch: error: pre_stretch must be at least 1, not '0.9'"},
      {"check @/examples/frdea-4.yaml --set 'compute.models=[lumped, FEM]'", 3,
       "--set compute.models: error: there is no model 'FEM' in this version; there are: lumped"},
      {"check coupled.yaml", 3, "coupled.yaml:7:18: error: model 3d: a coupled field needs a"},
      {"check answer.yaml", 3,
       "answer.yaml:7:18: error: the study 'frequency' needs the field V/h"},
      {"check turned.yaml", 3, "turned.yaml:2:18: error: model 3d does not support a direction"},
      {"run turned.yaml -m axisymmetric --json", 3, "turned.yaml:2:18: error: model axisymmetric"},
      {"check tab.yaml", 3, "tab.yaml:3:1: error: a tab stands here; YAML indents with spaces"},
      {"run @/examples/frdea-4.yaml -o .", 5, "./design.yaml already exists"},
      {"materials nothing", 3, "there is no material 'nothing'"},
      {"schema --json --markdown", 2, "exclude each other"},
      {"optimize x", 2, "'optimize' is not a command; did you mean 'optimise'?"},
      {"run @/examples/fit/silicone.yaml", 3, "this is a fit, not a design: it is for 'dea fit'"},
      {"run @/examples/explore/grid.yaml", 3, "this is a file of many designs, not a design"},
      {"optimise @/examples/frdea-4.yaml", 3,
       "this is a design, not a file of many designs: it is for 'dea run'"},
      {"fit @/examples/frdea-4.yaml", 3, "this is a design, not a fit: it is for 'dea run'"},
  };
  write_bad_files();
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    int code = command_run(bad[i].arguments);
    if (code != bad[i].code) {
      fail_msg("dea %s gave %d: %s", bad[i].arguments, code, command_err);
    }
    assert_contains(command_err, bad[i].part);
  }
}

/* A study that none of the design's own models knows is left out of a run, and check says so where
 * the study is asked for; with a model that knows it there is nothing to say. */
TEST(test_studies_of_no_model)
{
  static char text[COMMAND_TEXT_MAX];
  command_read_in(DEA_SOURCE_DIR, "examples/plain-disc.yaml", text);
  char *models = strstr(text, "models: [lumped, axisymmetric]");
  assert_non_null(models);
  size_t line = 2, length = strlen(text);
  for (const char *at = text; at < models; at++) {
    line += *at == '\n';
  }
  snprintf(text + length, sizeof text - length,
           "\ndrive: {waveform: {kind: square, high: 1 kV, "
           "frequency: 1 Hz}}\n");
  memcpy(models, "models: [axisymmetric]        ", 30);
  command_write("drive.yaml", text);
  memcpy(models, "models: [lumped]\n  modal: {}  ", 30);
  command_write("modal.yaml", text);
  char wanted[200];
  snprintf(wanted, sizeof wanted,
           "modal.yaml:%zu:3: warning: no study 'modal' of model lumped, which does not support "
           "vibrations; "
           "there is one of 3d (compute.models)\n",
           line);
  command_expect("check modal.yaml", 0, wanted);
  assert_null(strstr(command_err, "'transient'"));
  assert_null(strstr(command_err, "'path'"));
  command_expect("run modal.yaml -o modal --no-figures --study sweep", 0, "");
  command_expect("check modal.yaml --set 'compute.models=[lumped, 3d]'", 0, "");
  assert_null(strstr(command_err, "warning"));
  snprintf(wanted, sizeof wanted, "drive.yaml:%zu:12: warning: no study 'transient' of model axi",
           line - 1);
  command_expect("check drive.yaml", 0, wanted);
}

/* "$NAME" of a shell that knows no NAME. */
TEST(test_empty_value)
{
  command_expect("run @/examples/frdea-4.yaml -o ''", 2, "option '--output' has an empty value");
  command_expect("run @/examples/frdea-4.yaml --output=", 2, "'--output' has an empty value");
}

/* Under mpirun a command that computes in one process would wait for the others without end. */
TEST(test_ranks_are_for_run_alone)
{
  command_before = "OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0";
  command_expect("sweep @/examples/explore/grid.yaml", 2,
                 "dea sweep runs in one process, and mpirun has started 2");
  command_before = "OMPI_COMM_WORLD_SIZE=1 OMPI_COMM_WORLD_RANK=0";
  assert_int_equal(command_run("check @/examples/frdea-4.yaml"), 0);
  command_before = "";
}

TEST(test_check_lists_values_and_what_follows)
{
  command_prints("check @/examples/frdea-4.yaml --all --set film.thickness=200um", 0,
                 "film.thickness                     200um                     --set");
  assert_contains(
      command_out, "electrodes.thickness               0 um                      default",
      "fibre length                      11.25 mm", "film thickness (stretched)        88.8889 um");
}

/* The reader finds the unknown key after a missing one, and a section's range after its list;
 * names of models are looked at last. */
TEST(test_errors_in_the_order_of_the_file)
{
  command_write("wrong.yaml", "dea: 1\nfilm:\n  thicknes: 1 um\n  thickness: -1 um\n"
                              "compute: {coverage: 2, models: [lumpd], voltage: {to: 8}}\n");
  assert_int_equal(command_run("check wrong.yaml"), 3);
  size_t before = 0, count = 0;
  for (const char *line = command_err; (line = strstr(line, "wrong.yaml:")) != NULL; count++) {
    unsigned long at = 0, column = 0;
    assert_int_equal(sscanf(line, "wrong.yaml:%lu:%lu:", &at, &column), 2);
    assert_true(100 * at + column >= before);
    before = 100 * at + column;
    line++;
  }
  assert_true(count >= 8);
  assert_contains(command_err, "wrong.yaml:5:33: error: there is no model 'lumpd'",
                  "reduced; did you mean 'lumped'?");
}

/* What is given and what follows, of either kind of device, on about a page. */
TEST(test_check_is_brief)
{
  static const char *const designs[] = {"frdea-4.yaml", "plain-disc.yaml", "devices/cone-mass.yaml",
                                        "devices/two-electrodes.yaml"};
  for (size_t i = 0; i < sizeof designs / sizeof designs[0]; i++) {
    char arguments[200];
    snprintf(arguments, sizeof arguments, "check @/examples/%s --set film.thickness=200um",
             designs[i]);
    if (strchr(designs[i], '/') != NULL) {
      *strstr(arguments, " --set") = '\0';
    }
    assert_int_equal(command_run(arguments), 0);
    size_t lines = 0;
    for (const char *at = command_out; (at = strchr(at, '\n')) != NULL; at++) {
      lines++;
    }
    assert_in_range(lines, 15, 30);
    assert_contains(command_out, "\n  symmetry ", " um, elastosil-2030, ");
    assert_null(strstr(command_out, "fabrication"));
    assert_null(strstr(command_out, "  default\n"));
  }
  command_prints("check @/examples/frdea-4.yaml --set pre_stretch=2", 0,
                 "\n  pre_stretch     2 (--set)\n");
  assert_contains(command_out, "\n  film            material elastosil-2030, law yeoh-178, perm",
                  "\n  compute         models lumped, axisymmetric, voltage.from 0 kV,");
  command_prints("check @/examples/devices/array-3x3.yaml", 0,
                 "\n  shapes[3]       grid, difference, of film, holes\n");
  assert_contains(command_out, "\n  channels        middle 1 x voltage, others 0 x voltage\n");
}

TEST(test_quiet_keeps_the_result)
{
  command_prints("run @/examples/frdea-4.yaml -m lumped --no-figures -o q --quiet", 0, "stretch");
  assert_null(strstr(command_out, "results:"));
  assert_null(strstr(command_err, "note:"));
  assert_null(strstr(command_err, "lumped sweep"));
}

static json_t *run_json(const char *arguments, int code)
{
  json_error_t error;
  assert_int_equal(command_run(arguments), code);
  json_t *json = json_loads(command_out, 0, &error);
  if (json == NULL) {
    fail_msg("%s: %s", arguments, error.text);
  }
  return json;
}

TEST(test_check_as_json)
{
  json_t *json = run_json("check @/examples/paper/fig02.yaml --json", 0);
  json_t *derived = json_object_get(json, "derived");
  assert_true(json_is_true(json_object_get(json, "good")));
  assert_close(json_number_value(json_object_get(derived, "coverage")), 0.2, 1e-12, 0);
  assert_close(json_number_value(json_object_get(derived, "fibre_length_m")), 0.01, 1e-12, 0);
  assert_true(json_array_size(json_object_get(json, "values")) > 20);
  assert_true(json_array_size(json_object_get(derived, "plies")) == 2);
  json_decref(json);
  json = run_json("check @/examples/paper/fig02.yaml --json --set film.thickness=1", 3);
  assert_true(json_is_false(json_object_get(json, "good")));
  assert_true(json_array_size(json_object_get(json, "findings")) > 0);
  json_decref(json);
}

TEST(test_schema)
{
  command_prints("schema", 0, "film.thickness\n      thickness of the unstretched film");
  command_prints("schema --material", 0, "laws[].parameters");
  json_t *json = run_json("schema --json", 0);
  json_t *disc = json_object_get(json, "else"), *general = json_object_get(json, "then");
  assert_non_null(json_object_get(json_object_get(general, "properties"), "plies"));
  json_t *film = json_object_get(json_object_get(disc, "properties"), "film");
  assert_non_null(json_object_get(json_object_get(film, "properties"), "thickness"));
  assert_true(json_is_false(json_object_get(film, "additionalProperties")));
  json_decref(json);
}

/* What is told and drawn of a design of the general form. */
TEST(test_layout)
{
  json_t *json = run_json("check @/examples/devices/from-dxf.yaml --svg drawing.svg --json", 0);
  json_t *derived = json_object_get(json, "derived");
  json_t *area = json_object_get(derived, "area_m2");
  assert_close(json_real_value(json_object_get(area, "stiffeners")), 4 * 1e-3 * 18e-3, 1e-11, 0);
  assert_close(json_real_value(json_object_get(area, "hub")), acos(-1) * 2.5e-3 * 2.5e-3, 1e-11, 0);
  assert_int_equal(
      json_integer_value(json_object_get(json_object_get(derived, "symmetry"), "mirrors")), 2);
  json_decref(json);
  static char svg[COMMAND_TEXT_MAX];
  command_read("drawing.svg", svg);
  assert_contains(svg, ">stiffeners, 50 ");
  // what does not fit in one line stands in two
  assert_int_equal(command_run("check @/examples/devices/cone-loading.yaml --svg drawing.svg"), 0);
  command_read("drawing.svg", svg);
  assert_contains(svg, ">active, inside<", ">8.333 unstretched<");
  assert_int_equal(command_run("check @/examples/frdea-4.yaml --svg disc.svg"), 0);
  command_read("disc.svg", svg);
  assert_contains(svg, ">4 of 11.25 \303\227 2 mm<");
  command_expect("run @/examples/devices/two-electrodes.yaml -o x -m lumped", 3,
                 "this needs a disc in a round frame");
}

/* A design with a material of its own. */
static void write_with(const char *name, const char *parts, const char *material)
{
  char text[2000];
  snprintf(text, sizeof text,
           "dea: 1\n%s\nmaterials:\n  - {name: mine, title: mine, kind: elastomer,\n"
           "     laws: [{id: a, source: me, %s}],\n"
           "     permittivity: [{id: a, at_rest: 2.8, source: me}]}\n",
           parts, material);
  command_write(name, text);
}

/* What a run refuses before it solves, check refuses with the same words. */
TEST(test_what_run_refuses)
{
#define DISC                                                                                       \
  "film: {material: mine, thickness: 100 um}\npre_stretch: 1.2\n"                                  \
  "frame: {inner_diameter: 40 mm}\nelectrodes: {diameter: 10 mm stretched}\n"
#define PLIES                                                                                      \
  "shapes: [{name: film, kind: circle, radius: 9 mm}]\nsupports: [{edge: film}]\n"                 \
  "plies: [{name: film, shape: film, material: mine, thickness: 100 um}]\n"
#define AT_REST "voltage: {values: [0 kV]}"
  static const char plain[] = "law: neo-hookean, parameters: {mu: 200 kPa}";
  static const char hgo[] = "law: holzapfel-gasser-ogden, parameters: {mu: 200 kPa, k1: 200 kPa}";
  static const char density[] = "weight and inertia need the density of the material 'mine'";
  static const struct {
    const char *parts, *material, *message;
  } cases[] = {
      {DISC "gravity: fibres_up\ncompute: {models: [3d], " AT_REST "}", plain, density},
      {PLIES "gravity: top_up\ncompute: {" AT_REST "}", plain, density},
      {DISC "compute: {models: [3d], modal: {}, " AT_REST "}", plain, density},
      {DISC "compute: {models: [3d], frequency: {bias: [1 V]}, " AT_REST "}", plain, density},
      {DISC "drive: {waveform: {kind: sine, amplitude: 1 kV, frequency: 1 Hz}}\n"
            "compute: {models: [lumped], transient: {inertia: yes}, " AT_REST "}",
       plain, density},
      {DISC "compute: {models: [3d], " AT_REST "}", hgo,
       "does not support a direction that turns with the radius"},
      {DISC "compute: {models: [axisymmetric], " AT_REST "}", hgo, "pulls harder in one direction"},
      {PLIES "compute: {models: [lumped], " AT_REST "}", plain,
       "this needs a disc in a round frame"},
      {DISC "compute: {models: [3d], frequency: {bias: [1 V]}, solid: {field: coupled}, " AT_REST
            "}",
       plain, "the study 'frequency' needs the field V/h"},
      {PLIES "electrodes:\n  - {ply: film, side: bottom, shape: film, channel: ground}\n"
             "  - {ply: film, side: top, shape: film, channel: a}\n"
             "channels: [{name: a, voltage: 1 kV}]\ncompute: {solid: {field: coupled}, " AT_REST
             "}",
       plain, "a coupled field has one channel, at a share of the sweep's voltage alone"},
      {DISC "compute: {models: [3d], compare: [{name: a, set: {film: {thickness: 100 um}, "
            "electrodes: {diameter: 50 mm stretched}}}], " AT_REST "}",
       plain, "the electrode"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char ran[4096];
    write_with("refused.yaml", cases[i].parts, cases[i].material);
    command_expect("run refused.yaml -o refused.run", 3, cases[i].message);
    snprintf(ran, sizeof ran, "%.4000s", command_err);
    command_expect("check refused.yaml", 3, cases[i].message);
    for (char *save = NULL, *line = strtok_r(ran, "\n", &save); line != NULL;
         line = strtok_r(NULL, "\n", &save)) {
      if (strstr(line, "error: ") != NULL) {
        assert_contains(command_err, line);
      }
    }
  }
}

/* A module that this build has, but not its folders, is no matter of packages. */
TEST(test_doctor_without_modules)
{
  if (SANITIZED) {
    skip(); // its library wants to be the first
  }
  assert_int_equal(command_run("doctor"), 0);
  if (strstr(command_out, "ok       booleans of regions") == NULL) {
    skip(); // it was not configured
  }
  command_before = "LD_PRELOAD='" DEA_FAKE_FOLDER "/fake_access.so'";
  int code = command_run("doctor");
  command_before = "";
  assert_int_equal(code, 0);
  assert_contains(command_out, "missing  booleans of regions    not found\n",
                  "dea_geos_module.so belongs to this build");
  assert_null(strstr(command_out, "install libgeos-dev"));
}

TEST(test_materials)
{
  command_prints("materials", 0, "elastosil-2030");
  command_prints("materials elastosil-2030", 0, "c1             178.4 kPa");
  json_t *json = run_json("materials --json", 0);
  assert_true(json_array_size(json) >= 5);
  json_decref(json);
}

/* A file's name that changes the colours of a terminal is shown without what it obeys. */
TEST(test_names_do_not_reach_the_terminal)
{
  command_write("odd\x1b[31m.yaml", "hello\n");
  command_expect("check 'odd\x1b[31m.yaml'", 3, "odd [31m.yaml:1:1: error: ");
  assert_null(strchr(command_err, '\x1b'));
}

TESTS(command_set_up, command_tear_down)
