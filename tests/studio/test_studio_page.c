/* The page of dea studio in a browser, from an empty folder: an example copied and changed, its
 * drawing, a run whose points come, a table dropped on it, a value fitted to it, a search, sliders,
 * a report, what another program writes, and what the keyboard does. */
// ctest: browser, nightly
#include "browser.h"
#include "studio_server.h"

static struct browser browser;
static struct studio_server studio;

static int set_up(void **state)
{
  if (command_set_up(state) != 0) {
    return -1;
  }
  char workspace[600];
  command_folder_make("room");
  snprintf(workspace, sizeof workspace, "%s/room", command_folder);
  studio_start(&studio, workspace);
  browser_start(&browser, DEA_CHROMIUM, command_folder);
  browser.site = studio.address;
  browser_open(&browser, studio.address);
  browser_ready(&browser);
  return 0;
}

static int tear_down(void **state)
{
  browser_stop(&browser);
  studio_stop(&studio, SIGTERM);
  return command_tear_down(state);
}

static void assert_quiet(void)
{
  if (browser.trouble[0] != '\0') {
    fail_msg("%s", browser.trouble);
  }
}

static void act(const char *expression)
{
  json_decref(browser_value(&browser, expression));
}

/* Waits until something is so in the page. */
static void until(const char *expression)
{
  for (int i = 0; i < 6000; i++) {
    if (browser_number(&browser, expression) == 1) {
      return;
    }
    usleep(20000);
  }
  fail_msg("does not become so in the page: %s", expression);
}

static void press(const char *key, int modifiers)
{
  static const char *const kinds[] = {"keyDown", "keyUp"};
  for (size_t i = 0; i < 2; i++) {
    browser_do(&browser, "Input.dispatchKeyEvent",
               json_pack("{s:s, s:s, s:i}", "type", kinds[i], "key", key, "modifiers", modifiers));
  }
}

// The tests stand in the order of the work
// ---------------------------------------------------------

TEST(test_copies_an_example)
{
  until("document.querySelectorAll('#gallery .shot svg').length >= 15");
  act("document.querySelector('[data-example=\"devices/cone-loading.yaml\"]').click()");
  until("document.querySelector('#picture svg') !== null && "
        "document.querySelectorAll('#form input').length > 5");
  command_read("room/cone-loading.yaml", command_out);
  assert_contains(command_out, "# The cone pulled out by a machine");
  assert_quiet();
}

TEST(test_a_value_changes_text_and_drawing)
{
  act("(() => { window.before = document.querySelector('#picture').innerHTML; "
      "const field = document.querySelector('[data-key=\"shapes[1].radius\"]'); field.focus(); "
      "field.value = '8 mm'; field.dispatchEvent(new Event('input')); })()");
  until("document.querySelector('#picture').innerHTML !== window.before && "
        "document.querySelector('#saved').textContent === 'saved'");
  command_read("room/cone-loading.yaml", command_out);
  assert_contains(command_out, "{name: hub, kind: circle, radius: 8 mm}");
  assert_contains(command_out, "# The cone pulled out by a machine"); // comments stay
  press("ArrowUp", 0); // a step of the field that has the focus
  until("document.querySelector('#saved').textContent === 'saved' && "
        "document.querySelector('[data-key=\"shapes[1].radius\"]').value === '8.1 mm'");
  until("fetch('design?name=cone-loading.yaml').then((a) => a.json()).then((j) => "
        "j.text.includes('radius: 8.1 mm'))");
  assert_quiet();
}

TEST(test_points_come)
{
  act("(() => { window.seen = []; new MutationObserver(() => { "
      "const n = document.querySelector('#curves .numbers'); if (n !== null) { "
      "window.seen.push(JSON.parse(n.textContent)[0].series[0].v[0].length); } "
      "}).observe(document.querySelector('#curves'), { childList: true }); })()");
  press("Enter", 2); // Ctrl
  until("document.querySelector('#jobs progress') !== null");
  until("document.querySelector('#jobs .head')?.textContent.includes('run: done')");
  until("window.seen.length > 0 && document.querySelectorAll('#curves figure.plot').length >= 5");
  act("document.querySelector('#curves svg.chart').dispatchEvent(new KeyboardEvent('keydown', "
      "{ key: 'ArrowRight' }))");
  until("document.querySelector('#curves .readout').textContent !== ''"); // as in a report
  until("![...document.querySelectorAll('button')].some((one) => one.textContent === 'Go on')");
  assert_quiet();
}

TEST(test_a_table_is_dropped)
{
  act("(() => { const data = new DataTransfer(); data.items.add(new File(['V (kV),true field "
      "(V/um)\\n0,0\\n2,29\\n4,57\\n'], 'mine.csv')); document.querySelector('#results')"
      ".dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true })); })()");
  until("document.querySelector('#misfit td') !== null && "
        "document.querySelector('#misfit').textContent.includes('true_field')");
  until("document.querySelector('#curves').textContent.includes('measured')");
  until("document.querySelector('#command').textContent === "
        "'dea compare cone-loading.run mine.csv --json'");
  assert_quiet();
}

TEST(test_runs_beside_each_other)
{
  press("Enter", 10); // Ctrl and Shift
  until("[...document.querySelectorAll('#shown input')].filter((box) => box.checked).length === 2");
  until("document.querySelector('#curves').textContent.includes('2 cone-loading-2.run')");
  assert_quiet();
}

/* Fills the entries of a file for a fit or a search, and runs it. */
static void run_study(const char *kind, const char *entries)
{
  char script[1000];
  snprintf(script, sizeof script,
           "(() => { const set = (id, text) => { const field = document.querySelector(id); "
           "field.value = text; for (const name of ['input', 'change']) { field.dispatchEvent(new "
           "Event(name, { bubbles: true })); } }; document.querySelector('#study').open = true; "
           "set('#study-kind', '%s'); set('#study-keys select', 'plies.film.thickness'); %s; "
           "document.querySelector('#study-run').click(); })()",
           kind, entries);
  act("document.querySelector('#study').open = true");
  until("document.querySelector('#study-keys select') !== null");
  act(script);
  snprintf(script, sizeof script,
           "[...document.querySelectorAll('#jobs .head')].some((one) => "
           "one.textContent.includes('cone-loading-%s') && one.textContent.includes(': done'))",
           kind);
  until(script);
  assert_quiet();
}

TEST(test_fits_a_value)
{
  run_study("fit", "set('#study-table', 'mine.csv')");
  command_read("room/cone-loading-fit.yaml", command_out);
  assert_contains(command_out, "design: cone-loading.yaml",
                  "{name: plies.film.thickness, low: 90 um", "file: mine.csv");
  until("document.querySelector('#jobs pre').textContent.includes('as built')");
  until("[...document.querySelectorAll('#files img')].length > 0");
}

TEST(test_optimises)
{
  run_study("optimise", "set('#study-objective', 'capacitance_F'); set('#study-limit', "
                        "'breakdown_margin'); set('#study-quantities', 'capacitance_F, "
                        "breakdown_margin'); set('#study-voltages', '3 kV')");
  until("document.querySelectorAll('#files tbody tr').length > 1"); // its designs
  act("[...document.querySelectorAll('#files button')].find((one) => "
      "one.nextElementSibling.textContent === 'best.yaml').click()");
  until(
      "document.querySelector('#edit-title').textContent === 'cone-loading-optimise-best.yaml' && "
      "document.querySelector('#picture svg') !== null");
  act("location.hash = 'cone-loading.yaml'");
  until("document.querySelector('#edit-title').textContent === 'cone-loading.yaml' && "
        "document.querySelector('[data-key=title]') !== null");
  assert_quiet();
}

/* The report's sliders move its curves, over a number of the design where there is a sweep. */
TEST(test_sliders)
{
  run_study("sliders", "set('#study-quantities', 'capacitance_F')");
  act("document.querySelector('#sliders').open = true");
  until("document.querySelector('#sliders iframe').src.includes('sliders?run=cone-loading.run')");
  until("fetch(document.querySelector('#sliders iframe').src).then((a) => a.text()).then((text) => "
        "text.includes('plies.film.thickness'))");
  assert_quiet();
}

TEST(test_a_report_opens)
{
  act("document.querySelector('#film').open = true");
  until("document.querySelector('#film iframe').src.includes('film?run=cone-loading.run')");
  act("document.querySelector('#report').click()");
  until("document.querySelector('#files iframe') !== null");
  assert_quiet();
}

/* Another program writes the file: read again, merged where other lines were changed here, else
 * asked. */
TEST(test_another_program_writes)
{
  static const char text[] = "fetch('design?name=cone-loading.yaml').then((a) => a.json())";
  char script[1000];
  command_read("room/cone-loading.yaml", command_out);
  char *title = strstr(command_out, "cone pulled out\n");
  assert_non_null(title);
  memcpy(title, "CONE", 4);
  command_write("room/cone-loading.yaml", command_out);
  until("document.querySelector('[data-key=title]').value === 'CONE pulled out'");
  assert_quiet();
  // now at the same time: something else, then the same line
  static const char other[] = "j.text + '# theirs\\n'",
                    same[] = "j.text.replace(/title: .*/, 'title: theirs')";
  for (size_t i = 0; i < 2; i++) {
    snprintf(
        script, sizeof script,
        "%s.then((j) => { fetch('design?name=cone-loading.yaml&version=' + j.version, { method: "
        "'PUT', body: %s }); const field = document.querySelector('[data-key=title]'); "
        "field.value = 'mine %zu'; field.dispatchEvent(new Event('input')); })",
        text, i == 0 ? other : same, i);
    act(script);
    if (i == 1) {
      until("!document.querySelector('#asked').hidden && "
            "document.querySelector('#asked-other').textContent.includes('title: theirs')");
      act("document.querySelector('#asked-mine').click()");
    }
    snprintf(script, sizeof script,
             "%s.then((j) => j.text.includes('title: mine %zu') && j.text.includes('# theirs'))",
             text, i);
    until(script);
  }
  assert_quiet();
}

TESTS(set_up, tear_down)
