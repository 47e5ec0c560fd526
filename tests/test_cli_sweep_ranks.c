#define _GNU_SOURCE
/* dea sweep and dea optimise with several ranks at each design (--ranks). */
// ctest: solid
#include "command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Tests may run as root, and on fewer cores than ranks. */
#define MPI                                                                                        \
  "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "                                     \
  "OMPI_MCA_rmaps_base_oversubscribe=1 timeout 600 "

enum { DESIGNS = 4, NUMBERS = 5 };

static const char design[] =
    "dea: 1\nfilm: {material: elastosil-2030, thickness: 100 um}\npre_stretch: 1.5\n"
    "frame: {inner_diameter: 30 mm}\nelectrodes: {radius: 3.75 mm stretched}\n"
    "fibres: {count: 4, width: 2 mm, thickness: 100 um, material: pet}\n"
    "compute: {models: [3d], voltage: {values: [6 kV]}, solid: {film: membrane}}\n";

/* The last design cannot be built: no film outside of the electrode. */
static const char question[] =
    "dea_explore: 1\nname: together\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [2 kV]\n"
    "quantities: [electrode_edge_u_m, min_tension_N_per_m, frequency_Hz]\nvariables:\n"
    "  - {name: electrodes.radius, values: [3.75 mm stretched, 16 mm stretched]}\n"
    "  - {name: film.thickness, values: [100 um, 110 um]}\n";

/* Skips where there is no mpirun or no model 3d. */
static void begin(const char *text)
{
  if (system("mpirun --version >/dev/null 2>&1") != 0) {
    skip();
  }
  command_before = MPI;
  command_write("membrane.yaml", design);
  command_write("together.yaml", text);
}

static void run(const char *arguments)
{
  const int code = command_run(arguments);
  if (code == 2) {
    skip();
  }
  assert_int_equal(code, 0);
}

static int left_processes(void)
{
  return system("pgrep -f 'together.yaml --[s]erve' >pids.txt") == 0;
}

/* A table's numbers behind the hash, the hash and reasons. */
static void read_cases(const char *name, double q[DESIGNS][NUMBERS], char words[DESIGNS][200])
{
  static char bytes[COMMAND_TEXT_MAX];
  command_read(name, bytes);
  char *line = strchr(bytes, '\n');
  for (int i = 0; i < DESIGNS; i++) {
    assert_non_null(line);
    const char *at = strchr(line + 1, ',') + 1, *end = strchr(line + 1, '\n');
    char id[40];
    snprintf(id, sizeof id, "%.*s", (int)strcspn(at, ","), at);
    for (int j = 0; j < NUMBERS; j++) {
      at = strchr(at, ',') + 1;
      q[i][j] = *at == ',' ? NAN : strtod(at, NULL);
    }
    at = strchr(strchr(at, ',') + 1, ',') + 1; // behind the time
    snprintf(words[i], sizeof words[i], "%s %.*s", id, (int)(end - at), at);
    line = strchr(line + 1, '\n');
  }
}

/* Two ranks find what one process does: numbers, hashes, and why a design has none. */
static void test_same_table(void **state)
{
  (void)state;
  static double one[DESIGNS][NUMBERS], two[DESIGNS][NUMBERS];
  static char of_one[DESIGNS][200], of_two[DESIGNS][200];
  begin(question);
  run("sweep together.yaml -j 1 -q -o one");
  run("sweep together.yaml -j 1 --ranks 2 -q -o two");
  read_cases("one/cases.csv", one, of_one);
  read_cases("two/cases.csv", two, of_two);
  for (int i = 0; i < DESIGNS; i++) {
    assert_string_equal(of_two[i], of_one[i]);
    for (int j = 0; j < NUMBERS; j++) {
      assert_int_equal(isnan(two[i][j]), isnan(one[i][j]));
      assert_true(isnan(one[i][j]) || fabs(two[i][j] / one[i][j] - 1) < 1e-9);
    }
  }
  assert_true(one[0][2] > 1e-6 && one[0][4] > 100 && isnan(one[DESIGNS - 1][2]));
  assert_true(strlen(of_one[DESIGNS - 1]) > 20); // a reason
  assert_int_equal(left_processes(), 0);
}

/* A rank that is killed costs its design and no other, and none of its fellows stays. */
static void test_rank_killed(void **state)
{
  (void)state;
  static char bytes[COMMAND_TEXT_MAX];
  begin("dea_explore: 1\nname: killed\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [1 kV, 2 kV]\n"
        "quantities: [electrode_edge_u_m]\nbegin: rest\nvariables:\n"
        "  - {name: film.thickness, low: 90 um, high: 110 um, steps: 4}\n");
  // the second of the first ranks ends itself when a design is done; so then does its program
  command_write(
      "killing.sh",
      "n=$2; shift 2\nexec mpirun -n $n sh -c '\n"
      "if [ $OMPI_COMM_WORLD_RANK = 1 ] && mkdir once; then\n"
      "  \"$@\" &\n  while [ $(wc -l <killed/part-1-of-1.csv) -lt 2 ]; do sleep 0.02; done\n"
      "  kill -9 $$\nfi\nexec \"$@\"' - \"$@\"\n");
  command_before = MPI "env DEA_MPIRUN='sh killing.sh'";
  run("sweep together.yaml -j 1 --ranks 2 -q -o killed");
  assert_contains(command_out, "designs: 4 of 4 are there, 4 of them computed now");
  assert_contains(command_out, "without all values: 1 (for example: the ranks of this case ended");
  command_read("killed/cases.csv", bytes);
  assert_contains(bytes, "rank 1");
  assert_contains(bytes, "signal 9");
  assert_int_equal(left_processes(), 0);
}

/* What mpirun says may come in one piece with what the ranks do. */
static void test_other_lines(void **state)
{
  (void)state;
  begin("dea_explore: 1\nname: noisy\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [1 kV]\n"
        "quantities: [electrode_edge_u_m]\nvariables:\n"
        "  - {name: film.thickness, values: [100 um, 110 um]}\n");
  command_write("noisy.sh", "mpirun \"$@\" | while IFS= read -r line; do\n"
                            "  printf 'a warning\\n%s\\n' \"$line\"\ndone\n");
  command_before = MPI "env DEA_MPIRUN='sh noisy.sh'";
  run("sweep together.yaml -j 1 --ranks 2 -q -o noisy");
  assert_contains(command_out, "designs: 2 of 2 are there, 2 of them computed now");
}

/* Ctrl-C ends all ranks; the same command goes on, with however many. */
static void test_interrupted(void **state)
{
  (void)state;
  begin("dea_explore: 1\nname: stopped\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [1 kV]\n"
        "quantities: [electrode_edge_u_m]\nvariables:\n"
        "  - {name: film.thickness, low: 90 um, high: 110 um, steps: 24}\n");
  command_write("interrupting.sh", // once two designs are done
                "(while [ ! -e stopped/part-1-of-1.csv ] ||\n"
                "  [ $(wc -l <stopped/part-1-of-1.csv) -lt 3 ]; do sleep 0.02; done\n"
                "kill -INT $$) &\nexec \"$@\"\n");
  command_before = MPI "sh interrupting.sh";
  assert_int_equal(command_run("sweep together.yaml -j 1 --ranks 2 -q -o stopped"), 130);
  assert_contains(command_err, "interrupted; what was done is kept");
  assert_int_equal(left_processes(), 0);
  command_before = MPI;
  run("sweep together.yaml -j 2 -q -o stopped");
  assert_contains(command_out, "designs: 24 of 24 are there");
  assert_null(strstr(command_out, "24 of them computed now"));
}

/* A search by the model's gradients. */
static void test_search(void **state)
{
  (void)state;
  begin("dea_explore: 1\nname: best\ndesign: membrane.yaml\nmodel: 3d\nvoltages: [2 kV]\n"
        "quantities: [electrode_edge_u_m]\nstarts: 1\nevaluations: 2\n"
        "objectives: [{quantity: electrode_edge_u_m}]\nvariables:\n"
        "  - {name: film.thickness, low: 90 um, high: 110 um}\n");
  run("optimise together.yaml -j 1 -q -o best-one");
  char *line = strstr(command_out, "electrode_edge_u_m");
  const double edge_um = strtod(line + strlen("electrode_edge_u_m"), NULL);
  run("optimise together.yaml -j 1 --ranks 2 -q -o best-two");
  assert_contains(command_out, "gradients: of the model\n");
  line = strstr(command_out, "electrode_edge_u_m");
  assert_close(strtod(line + strlen("electrode_edge_u_m"), NULL), edge_um, 1e-5, 0); // as printed
}

/* What cannot be is said before a design is computed. */
static void test_refused(void **state)
{
  (void)state;
  begin("dea_explore: 1\nname: flat\ndesign: membrane.yaml\nmodel: lumped\nvoltages: [2 kV]\n"
        "quantities: [electrode_edge_u_m]\nvariables:\n"
        "  - {name: film.thickness, values: [100 um]}\n");
  command_expect("sweep together.yaml --ranks 2 -q", 2,
                 "model lumped computes a design in one process");
  command_write("together.yaml", question);
  command_before = MPI "env DEA_MPIRUN='sh -c false'";
  command_expect("sweep together.yaml --ranks 2 -q -o refused", 5,
                 "2 ranks could not be started by mpirun");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_same_table),  cmocka_unit_test(test_rank_killed),
      cmocka_unit_test(test_other_lines), cmocka_unit_test(test_interrupted),
      cmocka_unit_test(test_search),      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
