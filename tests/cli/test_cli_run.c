/* dea run: what scripts and people get. */
// ctest: quick, heavy
#include "command.h"

#include <jansson.h>
#include <signal.h>
#include <stdbool.h>

static json_t *summary(const char *arguments)
{
  assert_int_equal(command_run(arguments), 0);
  json_error_t error;
  json_t *root = json_loads(command_out, 0, &error);
  if (root == NULL) {
    fail_msg("not JSON: %s\n%.400s", error.text, command_out);
  }
  return root;
}

static double number(const json_t *point, const char *key)
{
  const json_t *value = json_object_get(point, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* Point at a voltage [V]. */
static const json_t *point_at(const json_t *root, double voltage_V)
{
  const json_t *points = json_object_get(root, "points");
  for (size_t i = 0; i < json_array_size(points); i++) {
    if (fabs(number(json_array_get(points, i), "voltage_V") - voltage_V) < 1e-6) {
      return json_array_get(points, i);
    }
  }
  fail_msg("no point at %g V", voltage_V);
  return NULL;
}

TEST(test_plain_disc_json)
{
  static const double kV[] = {1, 3, 5, 7}, strain[] = {0.365, 3.434, 10.297, 21.607};
  json_t *root = summary("run @/examples/plain-disc.yaml --model axisymmetric --json");
  assert_string_equal(json_string_value(json_object_get(root, "model")), "axisymmetric");
  for (size_t i = 0; i < 4; i++) {
    const json_t *p = point_at(root, 1e3 * kV[i]);
    assert_close(100 * (number(p, "electrode_stretch") - 1), strain[i], 0, 6e-4);
    assert_close(number(p, "electrode_edge_u_m"), 3.75e-3 * (number(p, "electrode_stretch") - 1),
                 1e-9, 0);
    assert_true(number(p, "true_field_V_per_m") > 1e7);
    assert_true(number(p, "min_tension_N_per_m") > 0);
    assert_true(json_is_true(json_object_get(p, "stable")));
    assert_int_equal(json_integer_value(json_object_get(p, "unstable_modes")), 0);
    assert_null(json_object_get(p, "centre_z_m")); // the model has no such thing
  }
  json_decref(root);
}

/* Two pulses at two voltages: cycles, creep and balance of energy are in the summary, points in the
 * table, curves in the figures. */
TEST(test_in_time)
{
  json_t *root = summary("run @/examples/protocol.yaml --study transient --json -o in-time --force "
                         "--set drive.waveform.cycles=2 --set drive.waveform.from='7 kV' "
                         "--set report.figures='[svg]'");
  const json_t *time = json_object_get(root, "transient");
  const json_t *cycles = json_object_get(time, "cycles"), *creep = json_object_get(time, "creep");
  assert_close(number(time, "end_s"), 8, 0, 1e-12);
  assert_string_equal(json_string_value(json_object_get(time, "quantity")), "centre_z_m");
  assert_int_equal(json_array_size(cycles), 4);
  assert_int_equal(json_array_size(creep), 2);
  for (size_t i = 0; i < 4; i++) {
    const json_t *cycle = json_array_get(cycles, i);
    assert_close(number(cycle, "level_V"), i < 2 ? 7000 : 8000, 0, 0);
    assert_close(number(cycle, "amplitude"), i < 2 ? 4.4e-3 : 5e-3, 0.12, 0);
  }
  assert_true(number(json_array_get(creep, 0), "creep") > 0);
  assert_true(fabs(number(json_object_get(time, "energy"), "not_accounted")) < 1e-3);
  json_decref(root);
  assert_int_equal(command_run("plot in-time --figure history --format svg -o in-time-figures"), 0);
  command_read("in-time-figures/history.svg", command_out);
  assert_contains(command_out, "</svg>");
  double highest_kV = 0;
  command_read("in-time-figures/history.gp", command_out);
  const char *range = strstr(command_out, "set yrange [*:");
  assert_non_null(range); // the voltage that is held does not lie on the border
  assert_int_equal(sscanf(range, "set yrange [*:%lf]", &highest_kV), 1);
  assert_true(highest_kV > 8.1);
  command_read("in-time/lumped_transient.csv", command_out);
  assert_contains(command_out, "time (s),source V (kV)");
}

TEST(test_run_folder)
{
  command_prints("run @/examples/frdea-4.yaml --no-figures", 0, "frdea-4.run");
  static const char *const files[] = {"summary.json", "results.h5", "lumped_sweep.csv",
                                      "lumped_path.csv", "axisymmetric_sweep.csv"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    char path[600];
    snprintf(path, sizeof path, "%s/frdea-4.run/%s", command_folder, files[i]);
    assert_int_equal(access(path, R_OK), 0);
  }
  assert_contains(command_err, "model axisymmetric: valid and below breakdown up to 3.2 kV",
                  "those of the film without its fibres");
  assert_contains(command_out, "<5017.0"); // the tip's z of model lumped is a bound
}

static bool is_there(const char *name)
{
  char path[600];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  return access(path, F_OK) == 0;
}

/* A run of the same design takes the place of the one before, with --keep a folder of its own; one
 * of another design asks for --force. What is not ours stays. */
TEST(test_folder_is_renewed)
{
  const char again[] = "run @/examples/plain-disc.yaml -m lumped --no-figures -o renewed ";
  char arguments[400];
  assert_int_equal(command_run("run @/examples/plain-disc.yaml --no-figures -o renewed"), 0);
  command_write("renewed/notes.txt", "mine\n");
  assert_true(is_there("renewed/axisymmetric_sweep.csv"));
  command_prints(again, 0, "results: renewed (");
  assert_true(is_there("renewed/lumped_sweep.csv") && is_there("renewed/notes.txt"));
  assert_false(is_there("renewed/axisymmetric_sweep.csv"));
  assert_false(is_there("renewed.part"));
  for (int i = 2; i < 4; i++) {
    snprintf(arguments, sizeof arguments, "%s--keep", again);
    assert_int_equal(command_run(arguments), 0);
    snprintf(arguments, sizeof arguments, "results: renewed-%d (", i);
    assert_contains(command_out, arguments);
  }
  command_expect("run @/examples/frdea-4.yaml -m lumped --no-figures -o renewed", 5, "--force");
  command_expect("run @/examples/frdea-4.yaml -m lumped --no-figures -o renewed --force", 0, "");
  snprintf(arguments, sizeof arguments, "%s--keep --force", again);
  command_expect(arguments, 2, "--keep takes a new folder");
}

/* A run that fails leaves no folder, and the results of before as they were: here files are longer
 * than the user's limit, an error of writing, not the end by a signal. */
TEST(test_failed_run_leaves_nothing)
{
  for (int i = 0; i < 2; i++) {
    char text[2048];
    if (i > 0) {
      assert_int_equal(command_run("run @/examples/plain-disc.yaml --no-figures -o short"), 0);
    }
    snprintf(text, sizeof text,
             "cd '%s' && ulimit -f 1 && '%s' run '%s/examples/plain-disc.yaml' -m lumped "
             "--no-figures -o short >/dev/null 2>err.txt",
             command_folder, DEA_COMMAND, DEA_SOURCE_DIR);
    int status = system(text);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 5);
    assert_false(is_there("short.part"));
    assert_int_equal(is_there("short"), i > 0);
    assert_int_equal(is_there("short/axisymmetric_sweep.csv"), i > 0);
    assert_int_equal(is_there("short/results.h5"), i > 0);
  }
}

static const char soft_disc[] = "dea: 1\n"
                                "title: soft\n"
                                "film: {material: soft, thickness: 100 um}\n"
                                "pre_stretch: 1.01\n"
                                "frame: {inner_diameter: 300 mm}\n"
                                "electrodes: {radius: 2 mm stretched}\n"
                                "materials:\n"
                                "  - name: soft\n"
                                "    title: soft rubber\n"
                                "    kind: elastomer\n"
                                "    laws:\n"
                                "      - {id: a, law: neo-hookean, parameters: {mu: 50 kPa},"
                                " source: test}\n"
                                "    permittivity:\n"
                                "      - {id: a, at_rest: 3, slope: 0, source: test}\n"
                                "compute:\n"
                                "  models: [lumped]\n"
                                "  voltage: {from: 0 kV, to: 8 kV, step: 0.5 kV}\n";

TEST(test_pull_in_keeps_what_was_computed)
{
  command_write("soft.yaml", soft_disc);
  command_expect("run soft.yaml --json", 4, "pull-in");
  json_t *root = json_loads(command_out, 0, NULL);
  assert_non_null(root);
  size_t count = json_array_size(json_object_get(root, "points"));
  assert_true(count > 2 && count < 17);
  assert_true(json_is_false(json_object_get(root, "complete")));
  const json_t *last = json_array_get(json_object_get(root, "points"), count - 1);
  double pull_in_V = number(json_object_get(root, "limits"), "pull_in_voltage_V");
  assert_true(pull_in_V > number(last, "voltage_V") && pull_in_V < number(last, "voltage_V") + 500);
  assert_close(number(last, "pull_in_distance_V"), pull_in_V - number(last, "voltage_V"), 1e-9, 0);
  json_decref(root);
  // a study after it does not take its reason away
  command_expect("run soft.yaml -m axisymmetric --sensitivity --json", 4,
                 "axisymmetric: pull-in of a slack film: not predictive (pull-in at ");
}

/* Slopes at a voltage have the flags of the state there. */
TEST(test_what_matters_has_flags)
{
  char bytes[COMMAND_TEXT_MAX];
  size_t safe = 0, beyond = 0;
  assert_int_equal(
      command_run("run @/examples/plain-disc.yaml -m axisymmetric --no-figures -o m.run "
                  "--set 'compute.sensitivity={voltage: [1 kV, 7 kV]}'"),
      0);
  const char *table = strstr(command_out, "what matters");
  assert_non_null(table);
  assert_contains(table, "breakdown\n");
  command_read("m.run/axisymmetric_sensitivity_slopes.csv", bytes);
  char *rest = NULL;
  for (char *line = strtok_r(bytes, "\n", &rest); line != NULL;
       line = strtok_r(NULL, "\n", &rest)) {
    const char *flags = strrchr(line, ',') + 1;
    safe += strncmp(line, "1,", 2) == 0 && *flags == '\0';
    beyond += strncmp(line, "7,", 2) == 0 && strcmp(flags, "breakdown") == 0;
    assert_true(strncmp(line, "7,", 2) != 0 || strstr(flags, "breakdown") != NULL);
  }
  assert_true(safe > 20 && beyond == safe);
}

/* Without pre-stretch the film has no tension at rest and less under a voltage, and with little it
 * has lost it where its pull-in is: that of a flat one is marked wherever it is said, and only
 * there. */
TEST(test_pull_in_of_a_slack_film)
{
  static const char words[] = "pull-in of a slack film: not predictive";
  static const char *const pre_stretch[] = {"1.3", "1", "1.1"};
  command_write("soft.yaml", soft_disc);
  for (int i = 0; i < 3; i++) {
    const int slack = i > 0;
    char arguments[120];
    snprintf(arguments, sizeof arguments,
             "run soft.yaml -m axisymmetric --study sweep --set pre_stretch=%s -o out --force",
             pre_stretch[i]);
    assert_int_equal(command_run(arguments), 4);
    const char *event = strstr(command_out, ": pull-in");
    assert_non_null(event);
    assert_int_equal(strncmp(event + 2, words, strlen(words)) == 0, slack);
    const char *stopped = strstr(command_out, "stopped, pull_in: ");
    assert_non_null(stopped);
    assert_int_equal(strstr(stopped, words) != NULL, slack);
    assert_int_equal(strstr(command_err, words) != NULL, slack);
    strcat(arguments, " --json");
    assert_int_equal(command_run(arguments), 4);
    json_t *root = json_loads(command_out, 0, NULL);
    assert_non_null(root);
    const json_t *mark = json_object_get(json_object_get(root, "limits"), "pull_in_of_slack_film");
    assert_true(slack ? json_is_true(mark) : json_is_false(mark));
    assert_int_equal(strstr(json_string_value(json_object_get(root, "stopped")), words) != NULL,
                     slack);
    json_decref(root);
  }
}

/* Several files: the first with the others beside it; --set holds for all of them. */
TEST(test_several_designs)
{
  json_t *root = summary("run @/examples/plain-disc.yaml @/examples/frdea-8.yaml --model lumped "
                         "--study compare-design --set 'compute.voltage={values: [6 kV]}' --json");
  const json_t *designs = json_object_get(root, "designs");
  assert_int_equal(json_array_size(json_object_get(root, "points")), 0); // no sweep was asked for
  assert_int_equal(json_array_size(designs), 2);
  const json_t *disc = json_array_get(designs, 0), *fibres = json_array_get(designs, 1);
  assert_string_equal(json_string_value(json_object_get(disc, "name")), "plain-disc");
  assert_string_equal(json_string_value(json_object_get(fibres, "name")), "frdea-8");
  const json_t *a = json_array_get(json_object_get(disc, "points"), 0);
  const json_t *b = json_array_get(json_object_get(fibres, "points"), 0);
  assert_int_equal(json_array_size(json_object_get(fibres, "points")), 1);
  assert_true(isnan(number(a, "centre_z_m")) && number(b, "centre_z_m") > 1e-3);
  json_decref(root);
  assert_int_equal(command_run("run @/examples/plain-disc.yaml --study compare-design"), 3);
  command_expect("run @/examples/plain-disc.yaml --study sweeep", 2, "did you mean 'sweep'?");
}

/* A study or a device that none of the models knows is an error before anything is made. */
TEST(test_models_that_cannot)
{
  static const struct {
    const char *arguments;
    int code;
    const char *message;
  } cases[] = {
      {"plain-disc.yaml -m lumped --study modal", 2,
       "no study 'modal' of model lumped, which does not support vibrations; there is one of 3d"},
      {"plain-disc.yaml -m lumped -m axisymmetric --study sweep --study convergence", 2,
       "no study 'convergence' of model lumped or axisymmetric, which do not support mesh "
       "refinement"},
      {"plain-disc.yaml -m lumped --study load-line", 2,
       "does not support a load line of this actuator\n"},
      {"plain-disc.yaml -m 3d --study path", 2,
       "does not support a path without compute.solid.path; there is"},
      {"devices/cone-mass.yaml -m lumped", 3, "this needs a disc in a round frame"},
  };
  char path[600];
  snprintf(path, sizeof path, "%s/cannot", command_folder);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char arguments[300];
    snprintf(arguments, sizeof arguments, "run @/examples/%s -o cannot", cases[i].arguments);
    command_expect(arguments, cases[i].code, cases[i].message);
    assert_string_equal(command_out, "");
    assert_int_not_equal(access(path, F_OK), 0);
  }
  // one of the models is enough, and what a design asks for is for those that can
  command_expect("run @/examples/plain-disc.yaml -m lumped --set compute.modal={} --no-figures "
                 "-o able",
                 0, "model lumped does not support vibrations: no study 'modal'");
  command_expect("run @/examples/frdea-4.yaml -m axisymmetric -m lumped --study load-line "
                 "--no-figures -o able --force",
                 0, "model axisymmetric does not support a load line of this actuator");
}

/* A figure that a run has nothing for is an error, and a quantity that is none names those that
 * are.
 */
TEST(test_nothing_to_draw)
{
  assert_int_equal(command_run("run @/examples/plain-disc.yaml -m lumped --no-figures -o bare"), 0);
  command_expect("plot bare --figure map", 2, "nothing to show in figure 'map'");
  assert_contains(command_err, "nothing is drawn");
  assert_null(strstr(command_err, "figures are in"));
  command_expect("plot bare --figure map --figure stretch", 0, "figures are in bare/figures");
  assert_contains(command_err, "nothing to show in figure 'map'");
  command_expect("compare bare bare --quantity foo", 2,
                 "'foo' is not a quantity; there are voltage_V");
  command_expect("compare bare bare --quantity centre_z", 2, "did you mean 'centre_z_m'?");
}

/* Sends SIGINT after a delay to a sweep of 9901 points; returns the lines of its table. */
static size_t interrupt_after(double delay_s)
{
  char text[4096];
  snprintf(
      text, sizeof text,
      "cd '%s' && rm -rf stopped && { '%s' run '%s/examples/plain-disc.yaml' --model "
      "axisymmetric --no-figures -o stopped --set 'compute.voltage={from: 0 kV, to: 9.9 kV, "
      "step: 1 V}' >out.txt 2>err.txt & } && pid=$! && i=0 && while [ ! -s stopped/.running ] "
      "&& [ $i -lt 1000 ]; do sleep 0.01; i=$((i+1)); done; sleep %g; kill -INT $pid; wait $pid",
      command_folder, DEA_COMMAND, DEA_SOURCE_DIR, delay_s);
  int status = system(text);
  assert_true(WIFEXITED(status));
  if (WEXITSTATUS(status) != 130) { // too late: it was done, or so early that no handler was there
    return 0;
  }
  char table[600];
  snprintf(table, sizeof table, "%s/stopped/axisymmetric_sweep.csv", command_folder);
  if (access(table, R_OK) != 0) { // no point yet
    return 0;
  }
  command_read("stopped/summary.json", command_out);
  assert_contains(command_out, "interrupted");
  command_read("stopped/axisymmetric_sweep.csv", command_out);
  size_t lines = 0;
  for (const char *c = command_out; *c != '\0'; c++) {
    lines += *c == '\n';
  }
  return lines;
}

/* One run at a time writes into a folder; a run that was killed holds it no longer. */
TEST(test_one_run_a_folder)
{
  char text[4096], path[600];
  snprintf(text, sizeof text,
           "cd '%s' && { '%s' run '%s/examples/plain-disc.yaml' --model 3d --no-figures "
           "-o shared --set 'compute.voltage={from: 0 kV, to: 5 kV, step: 1 V}' "
           ">/dev/null 2>&1 & echo $! >pid; i=0; while [ ! -s shared/.running ] && "
           "[ $i -lt 1000 ]; do sleep 0.01; i=$((i+1)); done; }",
           command_folder, DEA_COMMAND, DEA_SOURCE_DIR);
  assert_int_equal(system(text), 0);
  const char again[] = "run @/examples/plain-disc.yaml -m lumped --no-figures -o shared --force";
  int code = command_run(again);
  command_read("pid", command_out);
  long pid = strtol(command_out, NULL, 10);
  assert_true(pid > 1);
  kill((pid_t)pid, SIGKILL);
  assert_int_equal(code, 5);
  snprintf(path, sizeof path, "another run writes into shared (process %ld on ", pid);
  assert_contains(command_err, path);
  for (int i = 0; i < 1000 && (code = command_run(again)) == 5; i++) {
    usleep(10000); // until the process is gone
  }
  assert_int_equal(code, 0);
  snprintf(path, sizeof path, "%s/shared/.running", command_folder);
  assert_int_not_equal(access(path, F_OK), 0);
}

/* A full disk behind standard output is an error of exit code 5, said on stderr. */
TEST(test_lost_output)
{
  static const char *const commands[] = {
      "--version", "run '" DEA_SOURCE_DIR "/examples/plain-disc.yaml' --json", "schema --json"};
  for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
    char text[2048];
    snprintf(text, sizeof text, "'%s' %s --quiet >/dev/full 2>'%s/err.txt'", DEA_COMMAND,
             commands[i], command_folder);
    int status = system(text);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 5);
    command_read("err.txt", command_err);
    assert_contains(command_err, "standard output");
  }
}

/* Figures are not removed and written behind a link, whatever --force says. */
TEST(test_linked_figures)
{
  char text[2048];
  snprintf(text, sizeof text,
           "cd '%s' && mkdir elsewhere linked && echo mine > elsewhere/stretch.svg && "
           "ln -s ../elsewhere linked/figures",
           command_folder);
  assert_int_equal(system(text), 0);
  command_expect("run @/examples/plain-disc.yaml -m lumped --force -o linked", 5, "is a link");
  command_read("elsewhere/stretch.svg", command_out);
  assert_string_equal(command_out, "mine\n");
}

/* Little memory ends model 3d with a message: not in OpenBLAS, which asks for its work space
 * without end where there is no room for it (10 s of processor time end that). */
TEST(test_little_memory)
{
  if (SANITIZED) {
    skip(); // the address space is taken
  }
  int told = 0, done = 0;
  for (int mebibytes = 240; mebibytes <= 400; mebibytes += 40) {
    char text[2048];
    snprintf(text, sizeof text,
             "cd '%s' && ulimit -t 10 && ulimit -v %d && OMP_NUM_THREADS=1 '%s' run "
             "'%s/examples/plain-disc.yaml' -m 3d --study sweep --no-figures -o little --force "
             "--set 'compute.voltage={values: [1 kV]}' >/dev/null 2>err.txt",
             command_folder, 1024 * mebibytes, DEA_COMMAND, DEA_SOURCE_DIR);
    int status = system(text);
    command_read("err.txt", command_err);
    assert_true(WIFEXITED(status));
    assert_true(WEXITSTATUS(status) < 128); // not ended by the limit of time
    told += WEXITSTATUS(status) == 5 && strstr(command_err, "memory") != NULL;
    done += WEXITSTATUS(status) == 0;
    assert_int_equal(is_there("little"), done > 0);
  }
  assert_true(told > 0);
}

/* Interrupted in a long sweep: exit code 130, and what was computed is there. How fast this machine
 * is is not known, so several delays are tried until one falls into the sweep; soon after it began,
 * as sanitizers take long to write many points. */
TEST(test_interrupt_keeps_points)
{
  size_t lines = 0;
  for (double delay_s = 0.04; delay_s < 10 && lines <= 3; delay_s *= 1.3) {
    lines = interrupt_after(delay_s);
  }
  assert_true(lines > 3 && lines < 9902);
}

TESTS(command_set_up, command_tear_down)
