/* dea report: what comes from a run arrives as text; the page is whole and asks for nothing. */
// ctest: quick, heavy
#include "base/html.h"
#include "command.h"
#include "failing_allocator.h"
#include "fake_result.h"
#include "io/results_h5.h"
#include "job/report_runs.h"
#include "job/run_folder.h"
#include "plot/plot.h"
#include "plot/plot_svg.h"

#include <ctype.h>

static struct dea_context *ctx;

static int set_up(void **state)
{
  return dea_context_create(NULL, &ctx) == DEA_OK ? command_set_up(state) : -1;
}

static int tear_down(void **state)
{
  dea_context_destroy(ctx);
  return command_tear_down(state);
}

static const char *in_folder(const char *name)
{
  static char path[700];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  return path;
}

// Writing HTML ------------------------------------------------------------------------------------

typedef void (*writer)(struct dea_text *out, const char *text);

static void label(struct dea_text *out, const char *text)
{
  dea_html_label(out, text, DEA_LABEL_SVG);
}

static void plain_label(struct dea_text *out, const char *text)
{
  dea_html_label(out, text, DEA_LABEL_PLAIN);
}

static void json_label(struct dea_text *out, const char *text)
{
  dea_html_label(out, text, DEA_LABEL_JSON);
}

static void assert_writes(writer write, const char *text, const char *wanted)
{
  struct dea_text out = {.ctx = ctx};
  write(&out, text);
  assert_string_equal(dea_text_get(&out), wanted);
  dea_text_free(&out);
}

static void assert_estimate(double value, double error, int digits, const char *wanted)
{
  struct dea_text out = {.ctx = ctx};
  dea_html_estimate(&out, value, error, digits);
  assert_string_equal(dea_text_get(&out), wanted);
  dea_text_free(&out);
}

/* No digit beyond the first of the error, and none that is not known. */
TEST(test_digits_end_with_the_error)
{
  assert_estimate(-5.701, 0.09, 3, "\342\210\2225.70 \302\261 0.09");
  assert_estimate(-43.75, 1.4, 3, "\342\210\22244 \302\261 1");
  assert_estimate(0.3, 2, 3, "0 \302\261 2");
  assert_estimate(1234.5, 23, 3, "1230 \302\261 20");
  assert_estimate(5017, NAN, 3, "5020");
  assert_estimate(-288.99, NAN, 2, "\342\210\222290");
  assert_estimate(3.9, 0, 3, "3.90");
  assert_estimate(0, NAN, 3, "0");
  assert_estimate(NAN, NAN, 3, "\342\200\223");
}

TEST(test_escaping)
{
  assert_writes(dea_html_text, "<b>&\"'", "&lt;b&gt;&amp;&quot;&#39;");
  assert_writes(dea_html_text, "\302\265m \342\210\222 \360\237\231\202",
                "\302\265m \342\210\222 \360\237\231\202");
  // cut, overlong, surrogate, beyond the last plane, control: each wrong byte once
  assert_writes(dea_html_text, "a\302", "a\357\277\275");
  assert_writes(dea_html_text, "\300\257", "\357\277\275\357\277\275");
  assert_writes(dea_html_text, "\355\240\200", "\357\277\275\357\277\275\357\277\275");
  assert_writes(dea_html_text, "\364\220\200\200",
                "\357\277\275\357\277\275\357\277\275\357\277\275");
  assert_writes(dea_html_text, "\001\177", "\357\277\275\357\277\275");
  assert_writes(dea_html_text, "\342\200\256", "\357\277\275\357\277\275\357\277\275");
  assert_writes(json_label, "</script>\n\"\302\265", "\\u003c/script\\u003e\\u000a\\u0022\302\265");
}

TEST(test_labels)
{
  assert_writes(plain_label, "Voltage {/:Italic V} (kV)", "Voltage V (kV)");
  assert_writes(label, "{/:Italic V} <", "<tspan class=\"it\">V</tspan> &lt;");
  assert_writes(plain_label, "a\\\\_b {/:Italic x}_a", "a_b xa");
  char escaped[64];
  dea_label_escape("two_words {x}", escaped, sizeof escaped);
  assert_writes(plain_label, escaped, "two_words {x}");
  assert_writes(plain_label, "a & \"b\"", "a &amp; &quot;b&quot;");
  // within a script element entities are letters, and a line's end would end the JSON
  assert_writes(json_label, "a & \"b\"\n</script>_{x}",
                "a \\u0026 \\u0022b\\u0022\\u000a\\u003c/script\\u003ex");
}

// The page ----------------------------------------------------------------------------------------

static char *page;

static void read_page(const char *name)
{
  FILE *file = fopen(in_folder(name), "rb");
  assert_non_null(file);
  free(page);
  page = calloc(1, 4 << 20);
  assert_non_null(page);
  assert_true(fread(page, 1, (4 << 20) - 1, file) > 1000);
  fclose(file);
}

/* Every element that is opened is closed, in the right order; attributes are quoted. */
static void assert_well_formed(void)
{
  static const char *const void_tags[] = {"meta", "br", "path", "rect", "circle", "input"};
  char open[64][24];
  size_t depth = 0;
  assert_memory_equal(page, "<!DOCTYPE html>", 15);
  for (const char *c = page + 15; (c = strchr(c, '<')) != NULL; c++) {
    char tag[24] = {0};
    bool end = c[1] == '/';
    size_t n = 0;
    for (const char *t = c + 1 + end; isalnum((unsigned char)*t) && n < sizeof tag - 1; t++) {
      tag[n++] = *t;
    }
    assert_true(n > 0);
    const char *close = strchr(c, '>');
    assert_non_null(close);
    bool alone = close[-1] == '/';
    for (size_t i = 0; i < sizeof void_tags / sizeof void_tags[0]; i++) {
      alone = alone || strcmp(tag, void_tags[i]) == 0;
    }
    if (end) {
      if (depth == 0 || strcmp(open[depth - 1], tag) != 0) {
        fail_msg("</%s> closes <%s>", tag, depth > 0 ? open[depth - 1] : "nothing");
      }
      depth--;
    } else if (!alone) {
      assert_true(depth < 64);
      memcpy(open[depth++], tag, sizeof tag);
    }
    if (!end && (strcmp(tag, "script") == 0 || strcmp(tag, "style") == 0)) {
      char stop[30];
      snprintf(stop, sizeof stop, "</%s>", tag);
      c = strstr(c, stop) - 1; // what is inside is not HTML
    }
  }
  assert_int_equal(depth, 0);
}

/* Nothing is loaded, and nothing is styled or run but what the policy knows by its hash. */
static void assert_self_contained(void)
{
  assert_contains(page, "default-src 'none'");
  assert_contains(page, "style-src 'sha256-");
  assert_contains(page, "script-src 'sha256-");
  static const char *const never[] = {" src=",   "href=\"http", "url(http",      "@import",
                                      " style=", " onclick=",   "unsafe-inline", "unsafe-eval'>"};
  for (size_t i = 0; i < sizeof never / sizeof never[0]; i++) {
    if (strstr(page, never[i]) != NULL) {
      fail_msg("the page has '%s'", never[i]);
    }
  }
}

static const char evil[] =
    "dea: 1\n"
    "title: '</title><script>alert(1)</script> & \"film\"'\n"
    "# </pre><img src=x onerror=alert(2)>\n"
    "film: {material: '<i>mine</i>', thickness: 100 um}\n"
    "pre_stretch: 1.5\n"
    "frame: {inner_diameter: 30 mm}\n"
    "electrodes: {radius: 3.75 mm stretched}\n"
    "fibres: {count: 4, width: 2 mm, thickness: 100 um, overlap: 0 mm stretched, material: pet,\n"
    "         outer_end: clamped}\n"
    "materials:\n"
    "  - name: '<i>mine</i>'\n"
    "    kind: elastomer\n"
    "    laws:\n"
    "      - {id: one, law: neo-hookean, parameters: {mu: 100 kPa}, source: "
    "'<script>alert(3)</script>'}\n"
    "    permittivity: [{id: one, at_rest: 2.8, source: '<b>bold</b>'}]\n"
    "compute: {models: [lumped, axisymmetric], voltage: {from: 0 kV, to: 2 kV, step: 0.5 kV}}\n";

TEST(test_text_of_a_design_is_text)
{
  command_write("evil.yaml", evil);
  if (command_run("run evil.yaml --no-figures -o evil.run") != 0) {
    fail_msg("%s", command_err);
  }
  assert_int_equal(command_run("report evil.run -o evil.html"), 0);
  read_page("evil.html");
  assert_null(strstr(page, "<script>alert"));
  assert_null(strstr(page, "<img"));
  assert_null(strstr(page, "<i>mine"));
  assert_null(strstr(page, "<b>bold"));
  assert_contains(page,
                  "&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;film&quot;");
  assert_contains(page, "&lt;/pre&gt;&lt;img src=x onerror=alert(2)&gt;");
  assert_contains(page, "&lt;script&gt;alert(3)&lt;/script&gt;");
  assert_well_formed();
  assert_contains(page, "default-src 'none'");
}

TEST(test_page_of_an_example)
{
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --no-figures --set "
                               "'compute.voltage={from: 0 kV, to: 4 kV, step: 2 kV}' -o a.run"),
                   0);
  assert_int_equal(command_run("report a.run"), 0);
  read_page("a.run/report.html");
  assert_well_formed();
  assert_self_contained();
  assert_contains(page, "<h1>Fibre-reinforced actuator, four fibres, 100 um film</h1>");
  assert_contains(page, "178.4 kPa"); // a parameter
  assert_contains(page, "Table 1");   // and its source
  assert_contains(page, "viscosity (assumed): branch 2</th><td class=\"n\">3 % of the shear");
  assert_contains(page, "sha256-");         // of style and script
  assert_contains(page, "compute.voltage"); // a value of the design
  assert_contains(page, "--set");           // and that it was overridden
  assert_contains(page, "smallest breakdown margin");
  assert_contains(page, "<figure class=\"layout\"><svg"); // drawing
  assert_contains(page, ">fibres, 100 ");
  assert_contains(page, "upper bounds, far above"); // what lumped says of itself
  const char *figures = page;
  size_t count = 0;
  while ((figures = strstr(figures, "<figure class=\"plot\"")) != NULL) {
    figures++;
    count++;
  }
  assert_true(count >= 5);
}

/* A study with tables has a section, with its figures and its tables as the terminal has them. */
TEST(test_sections_of_studies)
{
  assert_int_equal(
      command_run("run @/examples/frdea-4.yaml @/examples/plain-disc.yaml --no-figures "
                  "--model lumped -o studies.run --set "
                  "'drive.waveform={kind: square, high: 3 kV, frequency: 1 Hz}'"),
      0);
  assert_int_equal(command_run("report studies.run -o studies.html --quiet"), 0);
  read_page("studies.html");
  assert_well_formed();
  const char *curves = strstr(page, "<section id=\"curves-1\""),
             *time = strstr(page, "<section id=\"transient-1\""),
             *designs = strstr(page, "<section id=\"compare-design-1\"");
  assert_true(curves != NULL && time > curves && designs > time);
  const char *history = strstr(page, "voltage and displacement against time");
  assert_true(history > time && history < designs); // not among the curves
  const char *given = strstr(time, "<dt>the supply gave</dt><dd>");
  assert_true(given != NULL && given < designs);
  assert_contains(designs, "<caption>lumped: designs at their last voltage</caption>");
  assert_contains(designs, "<tr><td>frdea-4</td><td class=\"n\">8</td>");
  assert_contains(designs, "<tr><td>plain-disc</td>");
  const char *flags = strstr(designs, "what a reader has to know of these numbers\">flags</th>");
  assert_true(flags != NULL && strstr(flags, "<td>breakdown bound plain</td>") != NULL);
}

TEST(test_runs_beside_each_other)
{
  for (int i = 0; i < 2; i++) {
    assert_int_equal(
        command_run(i == 0 ? "run @/examples/plain-disc.yaml --no-figures -o one.run "
                             "--set 'compute.voltage={from: 0 kV, to: 1 kV, step: 1 kV}'"
                           : "run @/examples/plain-disc.yaml --no-figures -o two.run "
                             "--set 'compute.voltage={from: 0 kV, to: 2 kV, step: 1 kV}'"),
        0);
  }
  assert_int_equal(command_run("report one.run two.run -o both.html --quiet"), 0);
  assert_string_equal(command_err, "");
  read_page("both.html");
  assert_well_formed();
  assert_self_contained();
  assert_contains(page, "The runs beside each other");
  assert_contains(page, "id=\"run-2\"");
  assert_contains(page, "1 lumped");
  assert_contains(page, "2 lumped");
  assert_int_equal(command_run("report one.run nowhere.run -o none.html"), 5);
  assert_contains(command_err, "nowhere.run");
  assert_true(access(in_folder("none.html"), F_OK) != 0);
  assert_int_equal(command_run("report"), 2);
}

TEST(test_measurement)
{
  static const char measured[] = "voltage (V), z centre (um), z centre std (um)\n"
                                 "1000, 12.5, 2\n4000, 250, 15\n";
  command_write("measured.csv", measured);
  command_write("wrong.csv", "voltage, z centre (um)\n1, 2\n");
  assert_int_equal(command_run("report a.run --measurement measured.csv -o m.html"), 0);
  read_page("m.html");
  assert_well_formed();
  assert_contains(page, "Computed and measured");
  assert_contains(page, "\"t\":\"measured\",\"c\":6,\"p\":1,\"v\":[[1,4],[12.5,250]]");
  // A folder of dea reduce: the same points.
  command_folder_make("red");
  command_write("red/measurement.csv", measured);
  assert_int_equal(command_run("report a.run --measurement red -o m.html"), 0);
  read_page("m.html");
  assert_contains(page, "\"p\":1,\"v\":[[1,4],[12.5,250]]");
  assert_int_equal(command_run("report a.run --measurement wrong.csv -o w.html"), 5);
  assert_contains(command_err, "wrong.csv:1:");
  assert_int_equal(command_run("report a.run --finger 3kV -o w.html"), 2);
  assert_int_equal(command_run("report a.run --finger '-1 N/mm' -o w.html"), 2);
  assert_contains(command_err, "not negative");
  assert_int_equal(command_run("report a.run --explorer a.run -o w.html"), 5);
  assert_contains(command_err, "a.run has no emulator.json: --explorer takes the folder of");
}

/* A section of the fit beside the runs; its texts are text, its figures in the page. */
TEST(test_fit)
{
  assert_int_equal(command_run("fit @/examples/fit/device.yaml -o device.fit"), 0);
  assert_int_equal(command_run("run device.fit/sample-3.yaml --model lumped --no-figures -o "
                               "device.run"),
                   0);
  assert_int_equal(command_run("report device.run --fit device.fit -o fit.html --quiet"), 0);
  read_page("fit.html");
  assert_well_formed();
  assert_contains(page, "<section id=\"fit-0\"");
  assert_contains(page, "film.permittivity.at_rest</th>");
  assert_contains(page, "are not told apart");
  assert_contains(page, "src=\"data:image/svg+xml;base64,");
  assert_contains(page, "what one standard uncertainty changes");
  assert_int_equal(command_run("report device.run --fit device.run -o fit.html"), 5);
  assert_contains(command_err, "fit.json");
  char text[700];
  snprintf(text, sizeof text, "%s/evil.fit", command_folder);
  assert_int_equal(mkdir(text, 0777), 0);
  command_write("evil.fit/fit.json",
                "{\"parameters\": [{\"name\": \"<script>alert(1)</script>\", \"value\": 1}]}");
  assert_int_equal(command_run("report device.run --fit evil.fit -o fit.html --quiet"), 0);
  command_read("fit.html", page);
  assert_null(strstr(page, "<script>alert"));
  command_write("evil.fit/fit.json", "[1, 2]");
  assert_int_equal(command_run("report device.run --fit evil.fit -o fit.html"), 5);
  assert_contains(command_err, "holds no fit");
}

TEST(test_only_pages_are_replaced)
{
  command_write("mine.txt", "mine");
  assert_int_equal(command_run("report a.run -o mine.txt"), 5);
  assert_contains(command_err, "mine.txt already exists and is not a page");
  static char text[COMMAND_TEXT_MAX];
  command_read("mine.txt", text);
  assert_string_equal(text, "mine");
  assert_int_equal(command_run("report a.run -o again.html"), 0);
  assert_int_equal(command_run("report a.run -o again.html"), 0);
}

/* A run whose design cannot be read any more still has a page, which says why there is no drawing.
 */
static void write_made_up_run(void)
{
  const struct dea_design design = fake_design();
  struct dea_result *result;
  assert_int_equal(fake_result(ctx, &design, 1.0, &result), DEA_OK);
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("made-up.h5")), DEA_OK);
  dea_result_destroy(ctx, result);
}

TEST(test_design_that_is_gone)
{
  write_made_up_run();
  assert_int_equal(command_run("report made-up.h5 -o made-up.html"), 0);
  read_page("made-up.html");
  assert_well_formed();
  assert_contains(page, "cannot be built again");
  assert_contains(page, "A made-up actuator, \302\265 and &quot;quotes&quot;");
  assert_contains(page, "pull-in"); // its path has one, and it stands in the table
}

static dea_status write_report(struct dea_context *own)
{
  const char *const runs[] = {in_folder("made-up.h5")};
  const struct dea_report_options options = {.command = "dea report"};
  char from[700];
  snprintf(from, sizeof from, "%s", runs[0]);
  const char *const copies[] = {from};
  return dea_job_report(own, copies, 1, &options, in_folder("memory.html"));
}

TEST(test_memory)
{
  write_made_up_run();
  struct failing_attempt attempt = {.call = write_report};
  struct failing_count count;
  long n = 0, step = 1;
  for (; failing_run(failing_attempt_run, &attempt, n, &count); n += step) {
    assert_int_equal(attempt.status, DEA_E_MEMORY);
    step = n < 20 ? 1 : 61; // the later ones are much alike
  }
  assert_int_equal(attempt.status, DEA_OK);
  assert_true(n > 60);
}

static dea_status write_whole_report(struct dea_context *own)
{
  char from[700];
  snprintf(from, sizeof from, "%s", in_folder("a.run"));
  const char *const runs[] = {from};
  const struct dea_report_options options = {.command = "dea report", .finger_N_per_m = 500};
  return dea_job_report(own, runs, 1, &options, in_folder("memory.html"));
}

/* The same with all sections; a material that could not be read is left out there. */
TEST(test_memory_of_all_sections)
{
  struct failing_attempt attempt = {.call = write_whole_report};
  struct failing_count count;
  long n = 0;
  for (; failing_run(failing_attempt_run, &attempt, n, &count); n += n / 2 + 1) {
    assert_true(attempt.status == DEA_E_MEMORY || attempt.status == DEA_OK);
  }
  assert_int_equal(attempt.status, DEA_OK);
  assert_true(n > 1000); // so many places, each of which can fail
  free(page);
  page = NULL;
}

TESTS(set_up, tear_down)
