/* The page of dea studio in a browser, from an empty folder: an example copied and changed, its
 * drawing, a run whose points come, a table dropped on it, what another program writes, and what
 * the keyboard does. */
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
  char room[600];
  command_folder_make("room");
  snprintf(room, sizeof room, "%s/room", command_folder);
  studio_start(&studio, room);
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
  for (int i = 0; i < 1500; i++) {
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

static void resize(int width, int height)
{
  browser_do(&browser, "Emulation.setDeviceMetricsOverride",
             json_pack("{s:i, s:i, s:i, s:b}", "width", width, "height", height,
                       "deviceScaleFactor", 1, "mobile", 0));
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

TEST(test_a_report_opens)
{
  act("document.querySelector('#space').open = true");
  until("document.querySelector('#space iframe').src.includes('film?run=cone-loading.run')");
  act("document.querySelector('#report').click()");
  until("document.querySelector('#files iframe') !== null");
  assert_quiet();
}

TEST(test_both_widths_and_schemes)
{
  static const int widths[] = {390, 1600};
  static const char *const schemes[] = {"dark", "light"};
  for (size_t i = 0; i < 2; i++) {
    browser_do(&browser, "Emulation.setEmulatedMedia",
               json_pack("{s:[{s:s, s:s}]}", "features", "name", "prefers-color-scheme", "value",
                         schemes[i]));
    for (size_t k = 0; k < 2; k++) {
      char fits[80];
      resize(widths[k], 900);
      snprintf(fits, sizeof fits, "document.documentElement.scrollWidth <= %d", widths[k]);
      until(fits);
    }
    until(i == 0 ? "getComputedStyle(document.body).backgroundColor === 'rgb(15, 19, 25)'"
                 : "getComputedStyle(document.body).backgroundColor === 'rgb(245, 246, 248)'");
  }
  // what is used has a name for who does not see it
  until("[...document.querySelectorAll('button, select, input, textarea')].every((e) => "
        "!e.checkVisibility() || "
        "e.textContent.trim() !== '' || e.labels?.length > 0 || e.getAttribute('aria-label') || "
        "e.closest('.CodeMirror'))");
  assert_quiet();
}

/* Another program writes the file: read again where nothing is lost, else asked. */
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
  // now at the same time
  snprintf(script, sizeof script,
           "%s.then((j) => { fetch('design?name=cone-loading.yaml&version=' + j.version, { method: "
           "'PUT', body: j.text + '# theirs\\n' }); const field = "
           "document.querySelector('[data-key=title]'); field.value = 'mine'; "
           "field.dispatchEvent(new Event('input')); })",
           text);
  act(script);
  until("!document.querySelector('#asked').hidden && "
        "document.querySelector('#asked-other').textContent.includes('# theirs')");
  act("document.querySelector('#asked-mine').click()");
  snprintf(script, sizeof script, "%s.then((j) => j.text.includes('title: mine'))", text);
  until(script);
}

TESTS(set_up, tear_down)
