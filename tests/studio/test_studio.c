/* dea studio as a program on the network sees it: what it refuses, and what it answers. */
// ctest: slow
#include "cone_design.h"
#include "studio_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <jansson.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <sys/socket.h>
#include <time.h>

enum { ANSWER_MAX = 1 << 21, SLOW = 20 };

static struct studio_server studio;
static int port;
static char secret[80]; // with the slashes around it
static char answer[ANSWER_MAX];
static int slow[SLOW]; // connections that never say all

// A client ----------------------------------------------------------------------------------------

static int connect_to(void)
{
  const struct sockaddr_in to = {.sin_family = AF_INET,
                                 .sin_port = htons((uint16_t)port),
                                 .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  assert_true(s >= 0);
  assert_int_equal(connect(s, (const struct sockaddr *)&to, sizeof to), 0);
  return s;
}

static void say(int s, const char *bytes, size_t length)
{
  while (length > 0) {
    const ssize_t sent = send(s, bytes, length, MSG_NOSIGNAL);
    assert_true(sent > 0);
    bytes += sent;
    length -= (size_t)sent;
  }
}

/* Reads to the end and gives the status. */
static int hear(int s)
{
  size_t used = 0;
  ssize_t got;
  while (used + 1 < sizeof answer &&
         (got = recv(s, answer + used, sizeof answer - 1 - used, 0)) > 0) {
    used += (size_t)got;
  }
  answer[used] = '\0';
  close(s);
  return strncmp(answer, "HTTP/1.1 ", 9) == 0 ? atoi(answer + 9) : -1;
}

/* A request of these words, sent as it is. */
static int raw(const char *format, ...)
{
  char text[4096];
  va_list list;
  va_start(list, format);
  const int length = vsnprintf(text, sizeof text, format, list);
  va_end(list);
  assert_true(length > 0 && length < (int)sizeof text);
  const int s = connect_to();
  say(s, text, (size_t)length);
  return hear(s);
}

static int ask(const char *method, const char *path, const char *body)
{
  char head[2048];
  const size_t length = body != NULL ? strlen(body) : 0;
  const int used = snprintf(head, sizeof head,
                            "%s %s%s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: %zu\r\n\r\n",
                            method, secret, path, port, length);
  const int s = connect_to();
  say(s, head, (size_t)used);
  say(s, body, length);
  return hear(s);
}

/* The body of the last answer. */
static json_t *body_json(void)
{
  const char *body = strstr(answer, "\r\n\r\n");
  assert_non_null(body);
  json_t *json = json_loads(body + 4, 0, NULL);
  assert_non_null(json);
  return json;
}

static void body_text(const char *key, char *out, size_t size)
{
  json_t *json = body_json();
  const char *text = json_string_value(json_object_get(json, key));
  snprintf(out, size, "%s", text != NULL ? text : "");
  json_decref(json);
}

// The server --------------------------------------------------------------------------------------

static void start_server(void)
{
  studio_start(&studio, "room");
  assert_int_equal(sscanf(studio.address, "http://127.0.0.1:%d%79s", &port, secret), 2);
}

static const char disc[] = "dea: 1\n"
                           "title: a disc # with a comment\n"
                           "film: {material: elastosil-2030, thickness: 100 um}\n"
                           "pre_stretch: 1.5\n"
                           "frame: {inner_radius: 15 mm}\n"
                           "electrodes: {radius: 3.75 mm stretched}\n"
                           "compute: {models: [lumped], voltage: {to: 2 kV, step: 0.5 kV}}\n";

static int set_up(void **state)
{
  if (command_set_up(state) != 0 || chdir(command_folder) != 0) {
    return -1;
  }
  command_folder_make("room");
  command_folder_make("elsewhere");
  command_write("room/disc.yaml", disc);
  command_write("room/.hidden.yaml", "secret\n");
  command_write("outside.yaml", "secret\n");
  command_write("elsewhere/results.h5", "secret\n");
  if (symlink("../outside.yaml", "room/link.yaml") != 0 ||
      symlink("../elsewhere", "room/link.run") != 0) {
    return -1;
  }
  start_server();
  for (size_t i = 0; i < SLOW; i++) { // a clock runs for them from here on
    slow[i] = connect_to();
    say(slow[i], "GET / HT", 8);
  }
  return 0;
}

static int tear_down(void **state)
{
  studio_stop(&studio, SIGTERM);
  return chdir("/") == 0 ? command_tear_down(state) : -1;
}

// What is let in ----------------------------------------------------------------------------------

TEST(test_needs_the_secret)
{
  assert_int_equal(ask("GET", "", NULL), 200);
  assert_contains(answer, "Content-Security-Policy: default-src 'none'; script-src 'self'");
  assert_contains(answer, "Cache-Control: no-store");
  assert_contains(answer, "<title>dea studio</title>");
  assert_int_equal(raw("GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", port), 403);
  assert_int_equal(raw("GET /state HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", port), 403);
  char wrong[80];
  snprintf(wrong, sizeof wrong, "%s", secret);
  wrong[1] = wrong[1] == '0' ? '1' : '0';
  assert_int_equal(raw("GET %sstate HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", wrong, port), 403);
  assert_null(strstr(answer, "disc.yaml"));
}

TEST(test_other_sites_are_refused)
{
  assert_int_equal(raw("GET %s HTTP/1.1\r\nHost: evil.example:%d\r\n\r\n", secret, port), 421);
  assert_int_equal(raw("GET %s HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", secret), 421);
  assert_int_equal(raw("GET %s HTTP/1.0\r\n\r\n", secret), 421);
  assert_int_equal(raw("GET %sstate HTTP/1.1\r\nHost: localhost:%d\r\n\r\n", secret, port), 200);
  static const char *const origins[] = {"http://evil.example", "null", "http://127.0.0.1",
                                        "https://127.0.0.1:1"};
  for (size_t i = 0; i < sizeof origins / sizeof origins[0]; i++) {
    assert_int_equal(raw("POST %sjob HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nOrigin: %s\r\n"
                         "Content-Length: 2\r\n\r\n{}",
                         secret, port, origins[i]),
                     403);
  }
  assert_int_equal(raw("GET %sstate HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nOrigin: "
                       "http://127.0.0.1:%d\r\n\r\n",
                       secret, port, port),
                   200);
  assert_null(strstr(answer, "Access-Control-Allow"));
  assert_int_equal(ask("OPTIONS", "", NULL), 405);
  assert_int_equal(ask("DELETE", "design?name=disc.yaml", NULL), 405);
  assert_int_equal(ask("POST", "state", NULL), 405);
  assert_int_equal(ask("GET", "nothing", NULL), 404);
}

TEST(test_only_this_computer)
{
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  inet_pton(AF_INET, "127.0.0.2", &to.sin_addr); // this computer by another name
  const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  assert_int_not_equal(connect(s, (const struct sockaddr *)&to, sizeof to), 0);
  close(s);
}

TEST(test_no_file_outside)
{
  static const char *const names[] = {"..",
                                      "../outside.yaml",
                                      "%2e%2e/outside.yaml",
                                      "/etc/passwd",
                                      "link.yaml",
                                      "link.run/results.h5",
                                      ".hidden.yaml",
                                      "disc.yaml/../../outside.yaml",
                                      "./disc.yaml",
                                      "room//disc.yaml",
                                      "",
                                      "%2Fetc%2Fpasswd",
                                      "..%5Coutside.yaml",
                                      "%ff%fe"};
  static const char *const routes[] = {
      "design?name=",           "file?name=", "list?name=",  "curves?run=", "compare?run=",
      "curves?run=x&measured=", "film?run=",  "sliders?run="};
  char path[256];
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    for (size_t k = 0; k < sizeof routes / sizeof routes[0]; k++) {
      snprintf(path, sizeof path, "%s%s", routes[k], names[i]);
      const int status = ask("GET", path, NULL);
      if (status != 400 && status != 404) {
        fail_msg("GET %s: %d", path, status);
      }
      assert_null(strstr(answer, "secret"));
    }
    snprintf(path, sizeof path, "design?name=%s&version=", names[i]);
    const int status = ask("PUT", path, "overwritten");
    if (status < 400) {
      fail_msg("PUT %s: %d", path, status);
    }
  }
  assert_int_equal(ask("GET", "check?name=link.yaml", NULL), 404);
  assert_int_equal(ask("GET", "mesh?name=link.yaml", NULL), 404);
  assert_int_equal(
      raw("GET %s../../etc/passwd HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", secret, port), 403);
  command_read("outside.yaml", command_out);
  assert_string_equal(command_out, "secret\n");
  static const char *const jobs[] = {
      "{\"action\":\"run\",\"file\":\"disc.yaml\",\"output\":\"../out\"}",
      "{\"action\":\"run\",\"file\":\"disc.yaml\",\"output\":\"link.run\"}",
      "{\"action\":\"run\",\"file\":\"link.yaml\",\"output\":\"a.run\"}",
      "{\"action\":\"run\",\"file\":\"../outside.yaml\",\"output\":\"a.run\"}",
      "{\"action\":\"run\",\"file\":\"disc.yaml\",\"output\":\"a.run\",\"models\":[\"--force\"]}",
      "{\"action\":\"report\",\"runs\":[\"link.run\"]}",
      "{\"action\":\"drive\",\"file\":\"disc.yaml\",\"output\":\"a.run\"}",
      "{\"action\":\"fab\",\"file\":\"disc.yaml\",\"output\":\"disc.yaml\"}",
      "no json"};
  for (size_t i = 0; i < sizeof jobs / sizeof jobs[0]; i++) {
    const int status = ask("POST", "job", jobs[i]);
    if (status != 400 && status != 404) {
      fail_msg("%s: %d", jobs[i], status);
    }
  }
}

TEST(test_large_bodies_are_refused)
{
  assert_int_equal(raw("PUT %sdesign?name=big.yaml&version= HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n"
                       "Content-Length: 104857600\r\n\r\nx",
                       secret, port),
                   413);
  assert_int_equal(raw("PUT %sdesign?name=big.yaml&version= HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n1\r\nx\r\n",
                       secret, port),
                   411);
  assert_int_equal(access("room/big.yaml", F_OK), -1);
}

// Designs -----------------------------------------------------------------------------------------

TEST(test_writes_only_what_it_has_read)
{
  char version[80], path[256], text[2048];
  assert_int_equal(ask("GET", "design?name=disc.yaml", NULL), 200);
  body_text("version", version, sizeof version);
  body_text("text", text, sizeof text);
  assert_string_equal(text, disc);
  snprintf(path, sizeof path, "design?name=new.yaml&version=%s", version);
  assert_int_equal(ask("PUT", path, disc), 200); // no file of that name was read
  assert_contains(answer, "\"changed\":true");
  assert_int_equal(access("room/new.yaml", F_OK), -1);
  assert_int_equal(ask("PUT", "design?name=new.yaml&version=", disc), 200);
  body_text("version", version, sizeof version);
  assert_int_equal(ask("PUT", "design?name=new.yaml&version=", "other"), 200);
  assert_contains(answer, "\"changed\":true");
  command_write("room/new.yaml", "written beside\n"); // by an editor
  snprintf(path, sizeof path, "design?name=new.yaml&version=%s", version);
  assert_int_equal(ask("PUT", path, "other"), 200);
  assert_contains(answer, "\"changed\":true");
  body_text("text", text, sizeof text);
  assert_string_equal(text, "written beside\n");
  body_text("version", version, sizeof version);
  snprintf(path, sizeof path, "design?name=new.yaml&version=%s", version);
  assert_int_equal(ask("PUT", path, disc), 200);
  command_read("room/new.yaml", command_out);
  assert_string_equal(command_out, disc);
}

static const char cone[] = CONE_DESIGN(
    "elastosil-2030",
    "") "monitors: [{name: hub, body: hub}]\n"
        "compute: {models: [3d], voltage: {to: 5 kV, step: 0.002 kV}, solid: {film: membrane}}\n";

TEST(test_checks_and_draws)
{
  assert_int_equal(ask("GET", "check?name=disc.yaml", NULL), 200);
  json_t *json = body_json();
  assert_true(json_is_true(json_object_get(json_object_get(json, "check"), "good")));
  assert_contains(json_string_value(json_object_get(json, "svg")), "<svg");
  assert_string_equal(json_string_value(json_object_get(json, "command")),
                      "dea check disc.yaml --svg disc.svg");
  json_decref(json);
  command_write("room/cone.yaml", cone);
  assert_int_equal(ask("GET", "mesh?name=cone.yaml", NULL), 200);
  assert_contains(answer, "\"elements\"", "$Elements", "dea mesh cone.yaml -o cone.msh");
  command_write("room/bad.yaml", "dea: 1\nfilm: {thicknes: 1 um}\n");
  assert_int_equal(ask("GET", "check?name=bad.yaml", NULL), 200);
  assert_contains(answer, "thickness");
  assert_null(strstr(answer, "\"svg\""));
  assert_int_equal(ask("GET", "schema", NULL), 200);
  assert_contains(answer, "$defs");
  assert_int_equal(ask("GET", "schema?of=explore", NULL), 200);
  assert_contains(answer, "objectives");
}

TEST(test_copies_an_example)
{
  assert_int_equal(ask("GET", "examples", NULL), 200);
  assert_contains(answer, "devices/from-dxf.yaml");
  assert_null(strstr(answer, "protocol.yaml"));
  assert_int_equal(ask("GET", "picture?name=devices/lens.yaml", NULL), 200);
  assert_contains(answer, "<svg");
  assert_int_equal(ask("POST", "copy?name=devices/from-dxf.yaml&to=mine.yaml", ""), 200);
  assert_int_equal(access("room/from-dxf.dxf", F_OK), 0); // which it names
  assert_int_equal(ask("POST", "copy?name=devices/from-dxf.yaml&to=mine.yaml", ""), 409);
  assert_int_equal(ask("POST", "copy?name=../outside.yaml&to=a.yaml", ""), 404);
  assert_int_equal(ask("POST", "copy?name=devices/lens.yaml&to=../a.yaml", ""), 400);
}

// Runs --------------------------------------------------------------------------------------------

static int add_job(const char *body)
{
  assert_int_equal(ask("POST", "job", body), 200);
  json_t *json = body_json();
  const int id = (int)json_integer_value(json_object_get(json, "id"));
  json_decref(json);
  return id;
}

/* State of a job after it is neither `a` nor `b`; also what else a row has. */
static const char *wait_job(int id, const char *a, const char *b, char state[16])
{
  for (int i = 0; i < 1500; i++) {
    assert_int_equal(ask("GET", "state", NULL), 200);
    json_t *json = body_json(), *job;
    size_t k;
    json_array_foreach(json_object_get(json, "jobs"), k, job)
    {
      if (json_integer_value(json_object_get(job, "id")) == id) {
        snprintf(state, 16, "%s", json_string_value(json_object_get(job, "state")));
      }
    }
    json_decref(json);
    if (strcmp(state, a) != 0 && strcmp(state, b) != 0) {
      break;
    }
    usleep(20000);
  }
  return state;
}

static const char *wait_end(int id)
{
  static char state[16];
  return wait_job(id, "waiting", "running", state);
}

static const char grid[] = "dea_explore: 1\n"
                           "name: grid\n"
                           "design: disc.yaml\n"
                           "model: lumped\n"
                           "voltages: [0 kV, 1 kV, 2 kV]\n"
                           "quantities: [electrode_edge_u_m]\n"
                           "variables: [{name: pre_stretch, low: 1.4, high: 1.6}]\n"
                           "plan: sparse-grid\n";

TEST(test_runs_and_compares)
{
  const int id = add_job("{\"action\":\"run\",\"file\":\"disc.yaml\",\"output\":\"a.run\"}");
  assert_string_equal(wait_end(id), "done");
  assert_contains(answer, "dea run disc.yaml -o a.run");
  assert_int_equal(ask("GET", "curves?run=a.run", NULL), 200);
  assert_contains(answer, "<figure class=\"plot\"");
  assert_int_equal(ask("PUT", "design?name=mine.csv&version=",
                       "V (kV),electrode stretch\n0,1\n1,1.005\n2,1.02\n"),
                   200);
  assert_int_equal(ask("GET", "curves?run=a.run&measured=mine.csv", NULL), 200);
  assert_contains(answer, "measured");
  assert_int_equal(ask("GET", "compare?run=a.run&measured=mine.csv", NULL), 200);
  assert_contains(answer, "electrode_stretch");
  assert_contains(answer, "dea compare a.run mine.csv --json");
  assert_int_equal(ask("GET", "curves?run=a.run&run=a.run", NULL), 200);
  assert_int_equal(ask("GET", "film?run=a.run", NULL), 200);
  assert_contains(answer, "no film in space"); // a model of a point
  assert_int_equal(ask("GET", "sliders?run=a.run", NULL), 200);
  assert_contains(answer, "Content-Security-Policy: sandbox allow-scripts;");
  assert_contains(answer, "class=\"sources\"");
  assert_null(strstr(answer, "\"pre_stretch\"")); // its own points only, until there is a sweep
  command_write("room/grid.yaml", grid);
  assert_string_equal(
      wait_end(add_job("{\"action\":\"sweep\",\"file\":\"grid.yaml\",\"output\":\"grid.sweep\"}")),
      "done");
  assert_contains(answer, "\"sweeps\":[{\"name\":\"grid.sweep\"");
  assert_int_equal(ask("GET", "sliders?run=a.run", NULL), 200);
  assert_contains(answer, "\"pre_stretch\"");
  assert_string_equal(wait_end(add_job("{\"action\":\"report\",\"runs\":[\"a.run\"]}")), "done");
  assert_int_equal(ask("GET", "file?name=a.run/report.html", NULL), 200);
  assert_contains(answer, "Content-Security-Policy: sandbox allow-scripts;"); // not for the user
  assert_string_equal(
      wait_end(add_job("{\"action\":\"fab\",\"file\":\"disc.yaml\",\"output\":\"disc.fab\"}")),
      "done");
  assert_int_equal(ask("GET", "list?name=disc.fab", NULL), 200);
  assert_contains(answer, ".svg\"");
}

/* Waits until a run has kept a file. */
static void wait_points(const char *results)
{
  for (int i = 0; i < 1500 && access(results, F_OK) != 0; i++) {
    usleep(20000);
  }
  assert_int_equal(access(results, F_OK), 0);
}

TEST(test_stops_a_run)
{
  char now[16];
  command_write("room/cone.yaml", cone);
  const int id = add_job("{\"action\":\"run\",\"file\":\"cone.yaml\",\"output\":\"cone.run\"}");
  assert_int_equal(
      ask("POST", "job", "{\"action\":\"run\",\"file\":\"cone.yaml\",\"output\":\"cone.run\"}"),
      200);
  assert_contains(answer, "another one writes there");
  wait_points("room/cone.run/results.h5");
  assert_string_equal(wait_job(id, "waiting", "", now), "running");
  assert_int_equal(ask("GET", "curves?run=cone.run", NULL), 200); // while it goes on
  assert_contains(answer, "<figure");
  assert_int_equal(ask("GET", "film?run=cone.run", NULL), 200);
  assert_contains(answer, "class=\"surface\"");
  char stop[32];
  snprintf(stop, sizeof stop, "{\"id\":%d}", id);
  assert_int_equal(ask("POST", "stop", stop), 200);
  assert_string_equal(wait_end(id), "stopped");
  assert_int_equal(ask("POST", "stop", stop), 404);
  assert_int_equal(ask("GET", "file?name=cone.run/summary.json", NULL), 200);
  assert_contains(answer, "\"DEA_E_INTERRUPTED\""); // by which the page offers to go on
}

TEST(test_slow_clients_are_left)
{
  assert_int_equal(ask("GET", "state", NULL), 200);
  for (size_t i = 0; i < SLOW; i++) { // none of them has got an answer, all are let go
    char byte;
    struct pollfd ready = {.fd = slow[i], .events = POLLIN};
    assert_true(poll(&ready, 1, 20000) > 0);
    while (recv(slow[i], &byte, 1, 0) > 0) {
    }
    close(slow[i]);
  }
}

/* The server dies: its run dies with it and has kept its points, which the next server shows, and
 * goes on.
 */
TEST(test_nothing_is_lost)
{
  char now[16], stop[32];
  command_write("room/cone.yaml", cone);
  add_job("{\"action\":\"run\",\"file\":\"cone.yaml\",\"output\":\"killed.run\"}");
  wait_points("room/killed.run/3d_state.h5");
  studio_stop(&studio, SIGKILL);
  usleep(200000); // until it is gone
  start_server();
  assert_int_equal(ask("GET", "curves?run=killed.run", NULL), 200);
  assert_contains(answer, "<figure");
  const int id = add_job(
      "{\"action\":\"run\",\"file\":\"cone.yaml\",\"output\":\"killed.run\",\"resume\":true}");
  usleep(300000);
  if (strcmp(wait_job(id, "waiting", "", now), "running") != 0) { // refused
    fail_msg("%s", strstr(answer, "\"jobs\""));
  }
  snprintf(stop, sizeof stop, "{\"id\":%d}", id);
  assert_int_equal(ask("POST", "stop", stop), 200);
  assert_string_equal(wait_end(id), "stopped");
}

TESTS(set_up, tear_down)
