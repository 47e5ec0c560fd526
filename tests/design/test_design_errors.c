/* design and device: what a bad file says, and where. */
#include "base/yaml.h"
#include "design_text.h"
#include "study/design_file.h"

#include "context_fixture.h" // after: its context shadows no name of the header above

/* Reading text must fail with exactly these errors. */
struct wanted {
  size_t line, column;
  const char *part;
};

/* Leaves a bad file and its first error in the folder that DEA_CASES names, for the test of the
 * JSON Schema. */
static void leave(const char *text, const char *part)
{
  static int number;
  const char *folder = getenv("DEA_CASES");
  char name[512];
  for (int k = 0; folder != NULL && k < 2; k++) {
    snprintf(name, sizeof name, "%s/%03d.%s", folder, number, k == 0 ? "yaml" : "error");
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    fputs(k == 0 ? text : part, file);
    assert_int_equal(fclose(file), 0);
  }
  number++;
}

static void check_errors(const char *text, const struct wanted *wanted, size_t count)
{
  struct dea_design *design;
  struct dea_device *device;
  leave(text, wanted[0].part);
  dea_finding_clear(ctx);
  assert_int_equal(read_and_build(ctx, text, NULL, 0, &design, &device), DEA_E_DESIGN);
  assert_null(device);
  dea_design_destroy(ctx, design);
  for (size_t i = 0; i < count; i++) {
    const struct dea_finding *finding = find_error(ctx, wanted[i].part);
    if (finding == NULL || finding->location.line != wanted[i].line ||
        finding->location.column != wanted[i].column) {
      print_findings(ctx);
      fail_msg("no error at %zu:%zu with '%s' in:\n%s", wanted[i].line, wanted[i].column,
               wanted[i].part, text);
    }
    assert_string_equal(finding->location.file, "t.yaml");
  }
  if (dea_finding_count(ctx, DEA_ERROR) != count) {
    print_findings(ctx);
    fail_msg("%zu errors, wanted %zu", dea_finding_count(ctx, DEA_ERROR), count);
  }
}

#define FILM "film: {material: film, thickness: 100 um}\n"
#define REST                                                                                       \
  "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"                                             \
  "electrodes: {radius: 3.75 mm stretched}\n" FILM_MATERIAL

/* What helps: keys of a section, limits in the unit that was written, and one error for a key that
 * is misspelt, not another one for want of it. */
TEST(test_help)
{
  static const struct {
    const char *text;
    struct wanted wanted;
  } cases[] = {
      {"dea: 1\n" FILM REST "fibres: [4]\n",
       {21, 9, "fibres must be a section with keys of its own (count, "}},
      {"dea: 1\nfilm: {material: film, thickness: 100 mm}\n" REST,
       {2, 35, "thickness must be at most 10 mm, not '100 mm'"}},
      {"dea: 1\nfilm: {material: film, thicknes: 1 um}\n" REST,
       {2, 24, "did you mean 'thickness'?"}}, // and no more: what it lacks is there
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
       "electrodes: {radus: 3.75 mm stretched}\n" FILM_MATERIAL,
       {5, 14, "did you mean 'radius'?"}},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    check_errors(cases[i].text, &cases[i].wanted, 1);
  }
}

TEST(test_one_error_each)
{
  static const struct {
    const char *text;
    struct wanted wanted;
  } bad[] = {
      {"title: x\ndea-protocol: 1\n", {2, 1, "this is a protocol, not a design"}},
      {"dea: 1\nfilm: {material: film, thickness: -100 um}\n" REST,
       {2, 35, "thickness must be above 0, not '-100 um'"}},
      {"dea: 1\nfilm: {material: film, thickness: 0 um}\n" REST, {2, 35, "must be above 0"}},
      {"dea: 1\nfilm: {material: film, thickness: 100}\n" REST,
       {2, 35, "'100' has no unit: a length is due; write for example '100 um'"}},
      {"dea: 1\nfilm: {material: film, thickness: 3 kV}\n" REST,
       {2, 35, "'3 kV' is a voltage, but a length is due"}},
      {"dea: 1\nfilm: {material: film, thickness: .nan}\n" REST, {2, 35, "not a finite number"}},
      {"dea: 1\nfilm: {material: film, thickness: nan um}\n" REST, {2, 35, "not a finite number"}},
      {"dea: 1\nfilm: {material: film, thickness: 100 um, thicknes: 1 um}\n" REST,
       {2, 43, "unknown key 'thicknes'; did you mean 'thickness'?"}},
      {"dea: 1\nfilm: {material: film, thickness: 100 um, colour: red}\n" REST,
       {2, 43, "known here are: material, law, permittivity, breakdown, viscosity, thickness"}},
      {"dea: 1\nfilm: {material: film}\n" REST, {2, 1, "section 'film' lacks 'thickness'"}},
      {"dea: 1\nfilm: {material: film, thickness: }\n" REST, {2, 35, "thickness has no value"}},
      {"dea: 1\nfilm: {material: film, thickness: [1 um]}\n" REST,
       {2, 35, "thickness must be a single value, not a list"}},
      {"dea: 1\n" FILM "thickness: 100 um\n" REST,
       {3, 1, "unknown key 'thickness' here; it belongs into a section such as 'film'"}},
      {"dea: 1\nfilm: 3\n" REST, {2, 7, "film must be a section"}},
      {"dea: 2\n" FILM REST, {1, 6, "dea must be at most 1"}},
      {FILM REST, {1, 1, "lacks 'dea'"}},
      {"dea: 1\n" FILM REST "fibers: {count: 4}\n", {21, 1, "did you mean 'fibres'?"}},
      {"dea: 1\n" FILM REST "title: a\ntitle: b\n",
       {22, 1, "the key 'title' stands twice in this section, first in line 21"}},
      {"dea: 1\n" FILM REST "fibres: {count: 4.5, material: stiff}\n",
       {21, 17, "count must be a whole number"}},
      {"dea: 1\n" FILM REST "fibres: {count: 0, material: stiff}\n", {21, 17, "at least 1"}},
      {"dea: 1\n" FILM REST "fibres: {count: 4, material: stiff, outer_end: glued}\n",
       {21, 48, "'glued' is none of: clamped, hinged, free"}},
      {"dea: 1\n" FILM REST "fibres: {count: 4, material: stiff, width: 2 mm stretched}\n",
       {21, 44, "the word 'stretched' does not belong here"}},
      {"dea: 1\n" FILM REST "fibres: {count: 4, material: stiff, length: 9 mm}\n",
       {21, 45, "write '9 mm stretched' (as built) or '9 mm unstretched'"}},
      {"dea: 1\n" FILM REST
       "fibres: {count: 4, material: stiff, length: 9 mm stretched, tip_radius: 1 mm stretched}\n",
       {21, 61, "exclude each other"}},
      {"dea: 1\n" FILM REST "compute: {coverage: 1}\n", {21, 21, "coverage must be below 1"}},
      {"dea: 1\n" FILM REST "compute: {models: lumped}\n", {21, 19, "models must be a list"}},
      {"dea: 1\n" FILM REST "compute: {voltage: {to: 8 kV, values: [1 kV]}}\n",
       {21, 31, "'to' and 'values' exclude each other"}},
      {"dea: 1\n" FILM REST "compute: {voltage: {step: 0.01 V}}\n",
       {21, 27, "more than 10000 voltages"}},
      {"dea: 1\n" FILM REST "compute: {path: {max_stretch: 1.4}}\n",
       {21, 31, "must be above the pre-stretch 1.5"}},
      {"dea: 1\n" FILM REST "report: {figures: [svg, jpg]}\n", {21, 25, "'jpg' is none of"}},
      {"dea: 1\n" FILM "pre_stretch: 0.8\nframe: {inner_diameter: 30 mm}\n"
       "electrodes: {radius: 3.75 mm stretched}\n" FILM_MATERIAL,
       {3, 14, "pre_stretch must be at least 1, not '0.8'"}},
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm unstretched}\n"
       "electrodes: {radius: 3.75 mm stretched}\n" FILM_MATERIAL,
       {4, 25, "lengths of the stretched film; write '30 mm'"}},
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
       "electrodes: {radius: 3.75 mm}\n" FILM_MATERIAL,
       {5, 22, "write '3.75 mm stretched' (as built) or '3.75 mm unstretched'"}},
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
       "electrodes: {radius: 3.75 mm unstreched}\n" FILM_MATERIAL,
       {5, 22, "did you mean 'unstretched'?"}},
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_diameter: 30 mm}\n"
       "electrodes: {thickness: 0 um}\n" FILM_MATERIAL,
       {5, 1, "'diameter: 5 mm unstretched' or 'radius: 3.75 mm stretched'"}},
      {"dea: 1\n" FILM "pre_stretch: 1.5\nframe: {}\n"
       "electrodes: {radius: 3.75 mm stretched}\n" FILM_MATERIAL,
       {4, 1, "'inner_diameter: 30 mm' or 'inner_radius: 15 mm'"}},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    check_errors(bad[i].text, &bad[i].wanted, 1);
  }
}

TEST(test_not_yaml)
{
  static const struct {
    const char *text;
    struct wanted wanted;
  } bad[] = {
      {"", {1, 1, "the file is empty"}},
      {"just text", {1, 1, "must be 'key: value' lines"}},
      {"dea: [1", {2, 1, "while parsing a flow sequence that begins in line 1"}},
      {"dea: [1]]", {1, 9, "this is not YAML"}},
      {"dea: 1\ntitle: \"x\nfilm: {}\n", {2, 8, "the quote that begins here does not end"}},
      {"dea: 1\ntitle: A: B\n", {2, 9, "a text with ': ' in it stands in quotes"}},
      {"dea: 1\ntitle: @x\n", {2, 8, "a text that does stands in quotes"}},
      {"dea: 1\nfilm:\n  law: a\n  thickness 1 um\nx: 1\n", {4, 3, "'KEY: VALUE' is due here"}},
      {"dea: 1\nfilm:\n  law: a\n  id:1 um\nx: 1\n", {4, 3, "with a space after the colon"}},
      {" dea: 1\ntitle: x\n", {2, 1, "indented like the first of them?"}},
      {"dea: 1\nfilm: {}\n  law: a\n", {3, 3, "is the line indented like its neighbours?"}},
      {"dea: 1\n  film: 2\n", {2, 7, "is the line indented like its neighbours?"}},
      {"dea: 1\nx: \xff\n", {2, 4, "not a text file in UTF-8"}},
      {"dea: \"\\0\"\n", {1, 6, "zero byte"}},
      {"dea: 1\ntitle: \"x\\e[31m\"\n", {2, 8, "a control character"}}, // colours of a terminal
      {"dea: 1\n---\ndea: 1\n", {2, 1, "a second document"}},
      {"a: &x [1]\nb: *x\n", {1, 4, "aliases"}},
      {"a: *y\n", {1, 4, "aliases"}},
      {"a: !!binary aGVsbG8=\n", {1, 4, "tags"}},
      {"? [a]\n: 1\n", {1, 3, "a key must be a word"}},
      {"a: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]\n",
       {1, 35, "nested too deeply"}},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    check_errors(bad[i].text, &bad[i].wanted, 1);
  }
}

TEST(test_all_errors_at_once)
{
  static const char text[] = "dea: 1\n"
                             "film:\n"
                             "  thicknes: 100 um\n"
                             "  thickness: -1 um\n"
                             "pre_stretch: 0.5\n"
                             "electrodes: {diameter: 5 mm, thickness: 3 kV}\n"
                             "compute: {coverage: 2, voltage: {to: 8}}\n";
  static const struct wanted wanted[] = {
      {3, 3, "unknown key 'thicknes'"},
      {2, 1, "section 'film' lacks 'material'"},
      {4, 14, "thickness must be above 0"},
      {5, 14, "pre_stretch must be at least 1"},
      {1, 1, "the file lacks 'frame'"},
      {6, 24, "does not say in which film"},
      {6, 41, "is a voltage, but a length is due"},
      {7, 21, "coverage must be below 1"},
      {7, 38, "'8' has no unit: a voltage is due"},
  };
  check_errors(text, wanted, sizeof wanted / sizeof wanted[0]);
}

#define GEOMETRY(electrode, fibres)                                                                \
  "dea: 1\n" FILM "pre_stretch: 1.5\nframe: {inner_radius: 15 mm}\n"                               \
  "electrodes: {radius: " electrode "}\nfibres: {material: stiff, " fibres "}\n" FILM_MATERIAL

TEST(test_geometry)
{
  static const struct {
    const char *text;
    struct wanted wanted;
  } bad[] = {
      {GEOMETRY("15 mm stretched", "count: 4"),
       {5, 22, "15 mm in radius (stretched), do not fit into the frame of 15 mm"}},
      {GEOMETRY("12 mm unstretched", "count: 4"), {5, 22, "18 mm in radius"}},
      {GEOMETRY("3.75 mm stretched", "count: 16"),
       {6, 34, "16 fibres of 2 mm width overlap each other at their tips, 3.75 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, overlap: 3 mm stretched"),
       {6, 34, "4 fibres of 2 mm width overlap each other"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, overlap: 3.75 mm stretched"),
       {6, 46, "meet at the centre"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, overlap: 2.5 mm unstretched"),
       {6, 46, "meet at the centre"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, length: 16 mm stretched"),
       {6, 45, "reach beyond the centre"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, tip_radius: 15 mm stretched"),
       {6, 49, "are not inside the frame of 15 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 1, width: 31 mm"), {6, 44, "do not fit into a frame"}},
      {GEOMETRY("3.75 mm stretched", "count: 1, tip_width: 8 mm"),
       {6, 48, "1 fibre of 8 mm width does not fit on the circle of its tip, 3.75 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 6, width: 16 mm, tip_width: 2 mm"),
       {6, 44, "overlap each other at the frame, where they may be at most 15 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, outer_end: free, outer_gap: 12 mm stretched"),
       {6, 65, "leaves nothing of fibres that reach 11.25 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 4}\ncompute: {force: {radius: 5 mm, depth: [1 mm]}"),
       {7, 27, "is larger than the electrode, the part that moves: at most 3.75 mm"}},
      {GEOMETRY("3.75 mm stretched", "count: 4, overlap: 2.5 mm stretched"),
       {6, 34, "at most 1.768 mm wide, or their tips must be at least 1.414 mm from the centre"}},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    check_errors(bad[i].text, &bad[i].wanted, 1);
  }
}

#define WITH(film, electrodes, fibre)                                                              \
  "dea: 1\nfilm: {thickness: 100 um, material: " film "}\npre_stretch: 1.5\n"                      \
  "frame: {inner_radius: 15 mm}\nelectrodes: {radius: 3.75 mm stretched" electrodes "}\n"          \
  "fibres: {count: 4, material: " fibre "}\n" FILM_MATERIAL

TEST(test_materials)
{
  static const struct {
    const char *text;
    struct wanted wanted;
  } bad[] = {
      {WITH("no-such-thing", "", "stiff"), {2, 37, "there is no material 'no-such-thing'"}},
      {WITH("film, law: aa", "", "stiff"), {2, 48, "no law set 'aa'; did you mean 'a'?"}},
      {WITH("film, law: z1234", "", "stiff"), {2, 48, "no law set 'z1234'; there are: a, b"}},
      {WITH("film, breakdown: sheet", "", "stiff"),
       {2, 54, "no breakdown field 'sheet'; there are: x, y"}},
      {WITH("film, permittivity: flt", "", "stiff"), {2, 57, "did you mean 'flat'?"}},
      {WITH("film", "", "film"), {6, 30, "no linear elastic constants"}},
      {WITH("film", ", thickness: 5 um", "stiff"), {5, 52, "none is given"}},
      {WITH("film", "", "stiff") "  - {name: film, kind: plastic}\n",
       {22, 12, "the name 'film' is taken by the material in line 8"}},
      {WITH("film", "", "stiff") "  - {name: x, kind: wood}\n", {22, 21, "'wood' is none of"}},
      {WITH("film", "", "stiff") "  - {name: x, kind: plastic, laws: [{id: q, law: yeho, "
                                 "parameters: {}, source: s}]}\n",
       {22, 50, "'yeho' is not a law; did you mean 'yeoh'?"}},
      {WITH(
           "film", "",
           "stiff") "  - {name: x, kind: plastic, laws: [{id: q, law: neo-hookean, parameters: {}, "
                    "source: s}]}\n",
       {22, 63, "lacks 'mu'"}},
      {WITH("film", "", "stiff") "  - {name: x, kind: plastic, laws: [{id: q, law: neo-hookean, "
                                 "parameters: {mu: 3 kPa, "
                                 "nu: 1}, source: s}]}\n",
       {22, 87, "unknown key 'nu'; did you mean 'mu'?"}},
      {WITH("film", "", "stiff") "  - {name: x, kind: plastic, density: {value: 9 kPa, source: s}}"
                                 "\n",
       {22, 47, "'9 kPa' is a pressure, but a density is due"}},
      {WITH("film", "", "stiff") "  - {name: x, kind: plastic, density: {value: 9 kg/m^3}}\n",
       {22, 30, "section 'materials[2].density' lacks 'source'"}},
      {WITH("{yeho: 1 kPa}", "", "stiff"),
       {2, 38, "a material in one line has no 'yeho'; did you mean 'yeoh'?"}},
      {WITH("{yeoh: [1 kPa, 2 kPa], permittivity: 3}", "", "stiff"),
       {2, 44, "the law 'yeoh' has the parameters [c1, c2, c3], each with its unit; here 2 of"}},
      {WITH("{yeoh: [1 kPa, 2 kPa, 3], permittivity: 3}", "", "stiff"),
       {2, 59, "c3: '3' has no unit"}},
      {WITH("{neo-hookean: 9 kPa, permittivity: 3, density: 9 kPa}", "", "stiff"),
       {2, 84, "value: '9 kPa' is a pressure, but a density is due"}},
      {WITH("{neo-hookean: 9 kPa}", "", "stiff"),
       {2, 37, "material 'film.material' has no permittivity and cannot be the film"}},
      {WITH("{gent: [9 kPa, 80], neo-hookean: 9 kPa}", "", "stiff"),
       {2, 57, "a material in one line has one law, and 'gent' stands there already"}},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    check_errors(bad[i].text, &bad[i].wanted, 1);
  }
}

/* Gent's law ends where I1 - 3 = jm: at a pre-stretch of 1.5 that is 2 1.5^2 + 1.5^-4 - 3 = 1.6975.
 * A film and electrodes that lie beyond are refused where the pre-stretch stands. */
#define GENT(jm, film, electrode)                                                                  \
  "dea: 1\nfilm: {thickness: 100 um, material: " film "}\npre_stretch: 1.5\n"                      \
  "frame: {inner_radius: 15 mm}\n"                                                                 \
  "electrodes: {radius: 3.75 mm stretched, thickness: 5 um, material: " electrode                  \
  "}\n" FILM_MATERIAL "  - {name: locks, kind: elastomer, laws: [{id: g, law: gent, "              \
  "parameters: {mu: 9 kPa, jm: " jm "}, source: s}], permittivity: [{id: p, at_rest: 3, source: "  \
  "s}]}\n"

TEST(test_law_that_ends_before_the_pre_stretch)
{
  static const struct wanted film[] = {{3, 14, "ends before the pre-stretch 1.5 of the film"}},
                             layer[] = {{3, 14, "before the pre-stretch 1.5 of the electrodes"}};
  struct dea_design *design;
  struct dea_device *device;
  check_errors(GENT("1.697", "locks", "film"), film, 1);
  check_errors(GENT("1.697", "film", "locks"), layer, 1);
  static const char *const reach[] = {GENT("1.698", "locks", "film"),
                                      GENT("1.698", "film", "locks")};
  for (int i = 0; i < 2; i++) {
    dea_finding_clear(ctx);
    assert_int_equal(read_and_build(ctx, reach[i], NULL, 0, &design, &device), DEA_OK);
    dea_device_destroy(ctx, device);
    dea_design_destroy(ctx, design);
  }
}

TEST(test_film_without_law_or_permittivity)
{
  static const struct wanted wanted[] = {{2, 37, "has no hyperelastic law"},
                                         {2, 37, "has no permittivity"}};
  check_errors(WITH("stiff", "", "stiff"), wanted, 2);
}

static void check_override(const char *key, const char *value, const char *part)
{
  struct dea_design *design;
  struct dea_device *device;
  const struct dea_override set = {key, value};
  char place[128];
  dea_finding_clear(ctx);
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, &set, 1, &design, &device), DEA_E_DESIGN);
  dea_design_destroy(ctx, design);
  const struct dea_finding *finding = find_error(ctx, part);
  if (finding == NULL) {
    print_findings(ctx);
    fail_msg("no error with '%s'", part);
  }
  snprintf(place, sizeof place, "--set %s", key);
  assert_string_equal(finding->location.file, place);
  assert_int_equal(finding->location.line, 0);
}

TEST(test_bad_overrides)
{
  check_override("film.thicknes", "200 um", "did you mean 'thickness'?");
  check_override("flim.thickness", "200 um", "did you mean 'film'?");
  check_override("film.thickness", "", "no value is given");
  check_override("film.thickness", "[", "this is not YAML");
  check_override("film.thickness", "200", "'200' has no unit");
  check_override("film.thickness.x", "200 um", "'thickness' is a value, not a section");
  check_override("materials.name", "x", "'materials' is a list, not a section");
  check_override("fibres.count", "64", "overlap each other");
  check_override("compute.voltage.values", "[1 kV, nan]", "not a finite number");
  check_override("compute.voltage.values", "[1 kV, 2]", "write for example '2 V' or '2 kV'");
  check_override("compute.force.depth", "[1]", "write for example '1 mm'");
  check_override("film.thickness", "5e-05", "write for example '5e-05 m'");
  check_override("compute.voltage", "{to:[1 kV]}", "a space is due after the colon");
}

TESTS_EACH(NULL, NULL, context_set_up, context_tear_down)
