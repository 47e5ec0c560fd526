/* The page of dea report in a browser: it opens from disk without an error and without a request,
 * its sliders move what they say, and what it computes is what the command computes. */
// ctest: browser, nightly
#include "browser.h"
#include "command.h"
#include "fake_result.h"
#include "fake_surface.h"
#include "io/results_h5.h"

static struct browser browser;
static struct dea_context *ctx;

static int set_up(void **state)
{
  if (dea_context_create(NULL, &ctx) != DEA_OK || command_set_up(state) != 0) {
    return -1;
  }
  browser_start(&browser, DEA_CHROMIUM, command_folder);
  return 0;
}

static int tear_down(void **state)
{
  browser_stop(&browser);
  dea_context_destroy(ctx);
  return command_tear_down(state);
}

static void open_page(const char *name)
{
  char path[700];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  browser_open(&browser, path);
  browser_ready(&browser);
}

static void assert_quiet(void)
{
  if (browser.trouble[0] != '\0') {
    fail_msg("%s", browser.trouble);
  }
  assert_int_equal(browser.requests, 1); // the page itself
}

static void assert_holds(const char *expression)
{
  if (browser_number(&browser, expression) != 1) {
    fail_msg("not so in the page: %s", expression);
  }
}

// The example -------------------------------------------------------------------------------------

static void open_example(void)
{
  static bool made;
  if (!made) {
    assert_int_equal(command_run("run @/examples/frdea-4.yaml --no-figures -o a.run --set "
                                 "'compute.voltage={from: 0 kV, to: 8 kV, step: 0.5 kV}'"),
                     0);
    assert_int_equal(command_run("report a.run -o a.html"), 0);
    made = true;
  }
  open_page("a.html");
}

static void set_scheme(const char *scheme)
{
  browser_do(
      &browser, "Emulation.setEmulatedMedia",
      json_pack("{s:[{s:s, s:s}]}", "features", "name", "prefers-color-scheme", "value", scheme));
}

TEST(test_opens_without_a_request)
{
  open_example();
  assert_quiet();
  assert_holds("document.querySelectorAll('figure.plot svg.chart').length >= 7");
  assert_holds("document.querySelectorAll('nav a').length >= 8");
  // each link has its target, each image its words, each id is there once
  assert_holds("[...document.querySelectorAll('a')].every((a) => "
               "document.querySelector(a.getAttribute('href')) !== null)");
  assert_holds("[...document.querySelectorAll('svg[role=img]')].every((s) => "
               "s.getAttribute('aria-label') || "
               "document.getElementById(s.getAttribute('aria-labelledby')) !== null)");
  assert_holds("new Set([...document.querySelectorAll('[id]')].map((e) => e.id)).size === "
               "document.querySelectorAll('[id]').length");
  assert_holds("[...document.querySelectorAll('table')].every((t) => t.closest('.scroll'))");
  // the style has arrived: its hash is that of the policy
  assert_holds("getComputedStyle(document.querySelector('.cards')).display === 'grid'");
  set_scheme("dark");
  assert_holds("getComputedStyle(document.body).backgroundColor === 'rgb(15, 19, 25)'");
  // narrow: nothing but tables that scroll is wider than the window
  browser_do(&browser, "Emulation.setDeviceMetricsOverride",
             json_pack("{s:i, s:i, s:i, s:b}", "width", 390, "height", 800, "deviceScaleFactor", 1,
                       "mobile", 0));
  assert_holds("document.documentElement.scrollWidth <= 390");
  assert_quiet();
}

/* WCAG 2.1, 1.4.3: the ratio of luminances of all text that is seen to what lies behind it. */
TEST(test_contrast)
{
  static const char worst[] =
      "(() => { const rgb = (c) => c.match(/[\\d.]+/g).map(Number); "
      "const L = (c) => { const [r, g, b] = c.map((v) => { v /= 255; return v <= 0.03928 ? v / "
      "12.92 "
      ": ((v + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; }; "
      "const back = (e) => { for (; e; e = e.parentElement) { const c = "
      "rgb(getComputedStyle(e).backgroundColor); if (c.length < 4 || c[3] > 0) { return c; } } "
      "return [255, 255, 255]; }; "
      "let worst = 21, count = 0; document.querySelectorAll('details').forEach((d) => { d.open = "
      "true; }); for (const e of document.querySelectorAll('body *')) { "
      "if (![...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim()) || "
      "e.closest('script, style, svg.device, .map') || !e.checkVisibility()) { continue; } "
      "const s = getComputedStyle(e); const c = rgb(e.closest('svg') ? s.fill : s.color); "
      "const [a, b] = [L(c.slice(0, 3)), L(back(e).slice(0, 3))]; "
      "const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); count++; "
      "const large = parseFloat(s.fontSize) >= 24 || (parseFloat(s.fontSize) >= 18.7 && "
      "s.fontWeight >= 700); worst = Math.min(worst, large ? ratio * 1.5 : ratio); } "
      "return count > 200 ? worst : 0; })()";
  static const char *const schemes[] = {"light", "dark"};
  open_example();
  for (int k = 0; k < 2; k++) {
    set_scheme(schemes[k]);
    assert_true(browser_number(&browser, worst) >= 4.5);
  }
  assert_quiet();
}

static void press_tab(void)
{
  static const char *const kinds[] = {"rawKeyDown", "keyUp"};
  for (int k = 0; k < 2; k++) {
    browser_do(&browser, "Input.dispatchKeyEvent",
               json_pack("{s:s, s:s, s:s, s:i}", "type", kinds[k], "key", "Tab", "code", "Tab",
                         "windowsVirtualKeyCode", 9));
  }
}

/* The tabulator visits all that can be used, in the order of the page; each says what it is, and is
 * seen to have the focus. */
TEST(test_keyboard)
{
  open_example();
  assert_holds("(() => { window.stops = [...document.querySelectorAll('a[href], button, select, "
               "input, summary, canvas[tabindex], [tabindex=\"0\"]')].filter((e) => "
               "e.checkVisibility() && !e.disabled); return stops.length > 20 && "
               "document.querySelectorAll('[tabindex]:not([tabindex=\"0\"], "
               "[tabindex=\"-1\"])').length === 0; })()");
  assert_holds("stops.every((e) => e.textContent.trim() || e.getAttribute('aria-label') || "
               "e.closest('label') || (e.labels && e.labels.length > 0))");
  int count = (int)browser_number(&browser, "stops.length");
  for (int k = 0; k < count; k++) {
    press_tab();
    if (browser_number(&browser, "stops.indexOf(document.activeElement)") != k) {
      json_t *where = browser_value(&browser, "document.activeElement.outerHTML.slice(0, 200)");
      fail_msg("stop %d of %d is %s", k, count, json_string_value(where));
    }
    assert_holds("parseFloat(getComputedStyle(document.activeElement).outlineWidth) > 0");
  }
  assert_quiet();
}

TEST(test_values_under_the_pointer)
{
  open_example();
  // the same voltage on all curves; that of the drawing is what the table of points says
  assert_holds(
      "(() => { dea.setVoltage(6, null); const text = (n) => [...document.querySelectorAll("
      "'.readout')][n].textContent; return text(0).includes('6') && "
      "text(0).includes('lumped, strain') && text(1).includes('axisymmetric'); })()");
  json_t *shown = browser_value(
      &browser,
      "[...document.querySelectorAll('.readout')][0].querySelectorAll('b')[1].textContent");
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --json --model lumped --set "
                               "'compute.voltage={from: 0 kV, to: 6 kV, step: 6 kV}'"),
                   0);
  json_t *run = json_loads(command_out, 0, NULL);
  const json_t *point = json_array_get(json_object_get(run, "points"), 1);
  double stretch = json_number_value(json_object_get(point, "electrode_stretch"));
  assert_close(atof(json_string_value(shown)), 100 * (stretch - 1), 1e-3, 0);
  json_decref(shown);
  json_decref(run);
  assert_quiet();
}

/* The map's limit at the design's own pre-stretch is that of the path, and the ratio of the
 * displacement to the threshold of touch that of the numbers. */
TEST(test_map_and_touch)
{
  open_example();
  static const char map[] =
      "(() => { const figure = document.querySelector('[id^=map] figure'); const { series } = "
      "JSON.parse(figure.querySelector('.numbers').textContent)[0]; const { v: [x, y] } = "
      "series.find((s) => s.t.startsWith('breakdown')); const i = x.findIndex((at) => at > 1.5); "
      "return y[i - 1] + (1.5 - x[i - 1]) / (x[i] - x[i - 1]) * (y[i] - y[i - 1]); })()";
  static const char ratio[] = "Number([...document.querySelectorAll('[id^=touch] tbody tr')][0]"
                              ".children[5].textContent)";
  assert_int_equal(command_run("run @/examples/frdea-4.yaml --json --model lumped --set "
                               "'compute.voltage={from: 0 kV, to: 8 kV, step: 8 kV}'"),
                   0);
  json_t *run = json_loads(command_out, 0, NULL);
  double breakdown_V =
      json_number_value(json_object_get(json_object_get(run, "limits"), "breakdown_voltage_V"));
  const json_t *last = json_array_get(json_object_get(run, "points"), 1);
  double z = json_number_value(json_object_get(last, "centre_z_m"));
  assert_close(browser_number(&browser, map), 1e-3 * breakdown_V, 2e-3,
               0);                                                   // linear between columns
  assert_close(browser_number(&browser, ratio), z / 30e-6, 5e-3, 0); // three digits
  json_decref(run);
}

// The explorer ------------------------------------------------------------------------------------

static const char pre[] = "dea_explore: 1\nname: pre\ndesign: a.yaml\nmodel: 3d\n"
                          "voltages: [0 kV, 1 kV, 2 kV, 3 kV, 4 kV]\n"
                          "quantities: [fibre_tip_z_m, true_field_V_per_m, breakdown_margin]\n"
                          "variables: [{name: pre_stretch, low: 1.1, high: 1.5}]\n"
                          "plan: sparse-grid\n";

/* The page of a run with model 3d and a sweep over its pre-stretch. */
static void open_swept(void)
{
  static bool made;
  if (!made) {
    assert_int_equal(command_run("examples frdea-4"), 0);
    command_write("a.yaml", command_out);
    command_write("pre.yaml", pre);
    assert_int_equal(command_run("sweep pre.yaml"), 0);
    assert_int_equal(command_run("run a.yaml --model lumped --model 3d --no-figures -o s.run --set "
                                 "'compute.voltage={from: 0 kV, to: 4 kV, step: 1 kV}'"),
                     0);
    assert_int_equal(command_run("report s.run --explorer pre.sweep -o s.html"), 0);
    made = true;
  }
  open_page("s.html");
}

/* z of the fibre tip at 3 kV, and its error, by the page. */
static double page_z(double pre_stretch, int k)
{
  char expression[200];
  snprintf(expression, sizeof expression,
           "dea.explorers[0].at(0, {voltage_V: 3000, pre_stretch: %.17g}).values.fibre_tip_z_m[%d]",
           pre_stretch, k);
  return browser_number(&browser, expression);
}

/* The same by model 3d of a design of its own. */
static double solved_z(double pre_stretch)
{
  char arguments[300];
  snprintf(arguments, sizeof arguments,
           "run a.yaml --json --study sweep --model 3d --set pre_stretch=%.17g --set "
           "'compute.voltage={from: 0 kV, to: 3 kV, step: 1 kV}'",
           pre_stretch);
  assert_int_equal(command_run(arguments), 0);
  json_t *run = json_loads(command_out, 0, NULL);
  double z = json_number_value(
      json_object_get(json_array_get(json_object_get(run, "points"), 3), "fibre_tip_z_m"));
  json_decref(run);
  return z;
}

/* The explorer moves with model 3d: sign, trend, and values within the error that it states; its
 * numbers are those of the command. */
TEST(test_explorer_moves_with_3d)
{
  static const double stretches[] = {1.1, 1.17, 1.23, 1.4, 1.5};
  open_swept();
  assert_true(page_z(1.1, 0) < page_z(1.5, 0) && page_z(1.5, 0) < -5e-6);
  for (size_t i = 0; i < sizeof stretches / sizeof stretches[0]; i++) {
    const double z = page_z(stretches[i], 0), error = page_z(stretches[i], 1);
    double volts, told, told_error;
    char arguments[80];
    assert_true(error < 0.15 * fabs(z));
    assert_true(fabs(z - solved_z(stretches[i])) <= error + 1e-6 * fabs(z));
    snprintf(arguments, sizeof arguments, "sweep pre.yaml --at pre_stretch=%.17g", stretches[i]);
    assert_int_equal(command_run(arguments), 0);
    const char *row = strstr(command_out, "\n3000,");
    assert_non_null(row);
    assert_int_equal(sscanf(row, "%lf,%lf,%lf", &volts, &told, &told_error), 3);
    assert_close(z, told, 0, 1e-9 * fabs(told));
    assert_close(error, told_error, 0, 1e-2 * error); // three digits
  }
  assert_true(isnan(page_z(1.09, 0)) && isnan(page_z(1.51, 0))); // beyond the range
  // z of model lumped, a bound 300 times off, is nowhere beside it
  assert_holds("!dea.explorers[0].sources.find((s) => s.title.startsWith('lumped'))"
               ".quantities.some((q) => q.key === 'fibre_tip_z_m') && "
               "!document.body.textContent.includes('fibre tip, at most')");
  assert_quiet();
}

TEST(test_explorer_follows_its_sliders)
{
  open_swept();
  assert_holds("(async () => { const host = document.querySelector('.explorer'); "
               "const cell = () => host.querySelector('tbody td').textContent; "
               "const frames = () => new Promise((done) => requestAnimationFrame(() => "
               "requestAnimationFrame(done))); const before = cell(); "
               "const [volts, stretch] = host.querySelectorAll('input'); stretch.value = 1.2; "
               "stretch.dispatchEvent(new Event('input')); await frames(); const after = cell(); "
               "host.querySelector('button').click(); await frames(); "
               "return before !== after && before === cell() && volts.max === '4' && "
               "host.querySelectorAll('svg.chart').length === 3; })()");
  // from the start of a frame to its layout, over moves of the slider of the sparse grid; the
  // quickest tenth: what else the machine does counts in the rest
  const double work_ms = browser_number(
      &browser,
      "(async () => { const host = document.querySelector('.explorer'); "
      "const stretch = host.querySelectorAll('input')[1]; const work = []; "
      "for (let i = 0; i < 200; i++) { stretch.value = 1.1 + 0.4 * i / 199; "
      "stretch.dispatchEvent(new Event('input')); "
      "work.push(await new Promise((done) => requestAnimationFrame((t) => { "
      "host.getBoundingClientRect(); done(performance.now() - t); }))); } "
      "host.querySelector('button').click(); return work.sort((a, b) => a - b)[20]; })()");
  print_message("a move of a slider takes %.1f ms: 60 frames a second are %.1f ms\n", work_ms,
                1000.0 / 60);
  assert_true(work_ms < 1000.0 / 60);
  // each source can be chosen, and shows numbers
  assert_holds(
      "(() => { const select = document.querySelector('.explorer select'); "
      "return dea.explorers[0].sources.every((_, i) => { select.value = i; "
      "select.dispatchEvent(new Event('change')); const cells = "
      "[...document.querySelectorAll('.explorer tbody td:nth-child(2)')]; "
      "return cells.length > 2 && cells.every((c) => c.textContent !== '\u2013'); }); })()");
  assert_quiet();
}

TEST(test_map_of_two_parameters)
{
  open_swept();
  assert_holds("(() => { document.querySelector('.explorer details').open = true; "
               "dea.explorers[0].map(); const map = document.querySelector('.map'); "
               "const before = map.querySelector('.plot').innerHTML; "
               "const what = map.querySelectorAll('select')[2]; what.value = 1; "
               "what.dispatchEvent(new Event('change')); "
               "return map.querySelectorAll('rect').length > 1000 && "
               "map.querySelector('.plot').innerHTML !== before && "
               "map.textContent.includes('breakdown'); })()");
  assert_quiet();
}

/* Model reduced in the page is that of the command, between the samples of its fit. */
TEST(test_explorer_has_the_reduced_model)
{
  static const double volts[] = {0, 1300, 2600, 3900};
  assert_int_equal(command_run("reduce-order @/examples/devices/cone-mass.yaml -o cone.json --set "
                               "compute.reduced.voltages=5"),
                   0);
  assert_int_equal(
      command_run("run @/examples/devices/cone-mass.yaml --model reduced --study sweep "
                  "--no-figures -o cone.run --set compute.reduced.file=cone.json --set "
                  "'compute.voltage={from: 0 V, to: 3.9 kV, step: 1.3 kV}' --json"),
      0);
  json_t *run = json_loads(command_out, 0, NULL);
  assert_int_equal(command_run("report cone.run -o cone.html"), 0);
  open_page("cone.html");
  for (size_t k = 0; k < sizeof volts / sizeof volts[0]; k++) {
    const json_t *point = json_array_get(json_object_get(run, "points"), k);
    static const char *const keys[] = {"hub_z_m", "true_field_V_per_m", "highest_z_m"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
      char expression[160];
      const double told = json_number_value(json_object_get(point, keys[i]));
      snprintf(expression, sizeof expression,
               "dea.explorers[0].at(0, {voltage_V: %.17g}).values.%s[0]", volts[k], keys[i]);
      assert_close(browser_number(&browser, expression), told, 1e-15, 1e-9);
    }
  }
  // q falls with the force by 1 / stiffness; a load line is drawn; beyond its range it says nothing
  assert_holds("(() => { const at = (force) => dea.explorers[0].at(0, { voltage_V: 2000, force })"
               ".values; const f = 1e-4; const slope = (at(f).hub_z_m[0] - at(-f).hub_z_m[0]) / "
               "(2 * f); return Math.abs(slope * at(0).stiffness[0] - 1) < 1e-4 && "
               "at(1).hub_z_m === undefined && "
               "document.querySelector('.explorer svg[aria-label=\"Load line\"]') !== null; })()");
  json_decref(run);
  assert_quiet();
}

// The membrane ------------------------------------------------------------------------------------

enum { STEPS = 3 };
static const double step_V[STEPS] = {0, 3000, 6000};

static void write_membrane(void)
{
  const struct dea_design design = fake_design();
  struct dea_result *result;
  char path[700];
  assert_int_equal(fake_result(ctx, &design, 1.0, &result), DEA_OK);
  for (size_t i = 0; i < STEPS; i++) {
    assert_int_equal(
        dea_result_add_surface(ctx, result, "3d", i, step_V[i], fake_surface(ctx, step_V[i])),
        DEA_OK);
  }
  snprintf(path, sizeof path, "%s/film.h5", command_folder);
  assert_int_equal(dea_results_h5_write(ctx, result, path), DEA_OK);
  dea_result_destroy(ctx, result);
  assert_int_equal(command_run("report film.h5 -o film.html"), 0);
}

TEST(test_membrane_is_the_surface)
{
  write_membrane();
  open_page("film.html");
  assert_quiet();
  assert_holds("dea.films.length === 1 && dea.films[0].film.voltages.length === 3");
  struct dea_field_mesh *mesh = fake_surface(ctx, step_V[2]);
  double range = browser_number(&browser, "dea.films[0].film.channels[2].high - "
                                          "dea.films[0].film.channels[2].low");
  for (size_t p = 0; p < mesh->point_count; p += 17) {
    char expression[120];
    double wanted = fake_height_m(mesh->X[3 * p], mesh->X[3 * p + 1], step_V[2]);
    snprintf(expression, sizeof expression, "dea.films[0].film.channels[2].steps[2][%zu]", p);
    assert_close(browser_number(&browser, expression), wanted, 0, range / 65535);
    snprintf(expression, sizeof expression, "dea.films[0].film.y[%zu]", p);
    assert_close(browser_number(&browser, expression), mesh->X[3 * p + 1], 0,
                 2 * fake_radius_m / 65535);
  }
  dea_field_mesh_destroy(ctx, mesh);
}

TEST(test_slider_moves_the_membrane)
{
  write_membrane();
  open_page("film.html");
  assert_holds("document.querySelector('.membrane canvas') !== null"); // WebGL is there
  assert_holds("(() => { const { canvas } = dea.films[0]; const slider = "
               "document.querySelector('.membrane input'); const words = () => "
               "document.querySelector('.membrane .readout').textContent; "
               "const before = [canvas.toDataURL(), words()]; slider.value = 1; "
               "slider.dispatchEvent(new Event('input')); "
               "return canvas.toDataURL() !== before[0] && words() !== before[1] && "
               "words().startsWith('3 kV'); })()");
  // the colour of the electrode's middle is not the background's
  assert_holds(
      "(() => { const { canvas } = dea.films[0]; const small = "
      "document.createElement('canvas'); small.width = small.height = 1; const c = "
      "small.getContext('2d'); c.drawImage(canvas, canvas.width / 2, canvas.height / 2, 1, "
      "1, 0, 0, 1, 1); return c.getImageData(0, 0, 1, 1).data[3] === 255; })()");
  // arrow keys turn it; a voltage chosen on a curve moves it
  assert_holds("(() => { const { canvas, state } = dea.films[0]; const before = state.turn; "
               "canvas.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' })); "
               "return state.turn !== before; })()");
  assert_holds("(() => { dea.setVoltage(1.5, null); return Math.abs(dea.films[0].state.at - 0.5) < "
               "1e-9; })()");
  assert_quiet();
}

TESTS(set_up, tear_down)
