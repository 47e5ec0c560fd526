/* dea drive on imitated supplies with a fault at a random moment: whatever happens, "at 0 V" is
 * only said, and a supply only taken for clean, when the imitation was at 0 V and stayed there.
 * Twelve runs by fixed seeds; `test_lab_faults COUNT [SEED [TABLE]]` makes as many as wanted,
 * prints how long it took to 0 V, or to the alarm, and writes a table of the runs
 * (verify/drive-faults.sh). */
// ctest: supply
#define _GNU_SOURCE
#include "command.h"
#include "supply.h"

#include <signal.h>
#include <sys/resource.h>

enum { TOGETHER = 8 };
static const double zero_V = 20, limit_s = 60, after_s = 2;

enum fault {
  NONE,
  DELAY,
  HANG,
  LIE,
  GARBAGE,
  DISCONNECT,
  STOP,
  KILL,
  CRASH,
  FULL_DISK,
  CTRL_C,
  FAULTS
};
static const char *const names[] = {"none",    "delay",      "hang",    "lie",
                                    "garbage", "disconnect", "SIGSTOP", "kill -9",
                                    "SEGV",    "full disk",  "Ctrl-C"};

struct run {
  unsigned seed;
  enum fault fault;
  double fault_s, lasts_s; // after the start; INFINITY: for good
  bool measures, one_client;
  // what came out
  int code; // of the program; negative: a signal
  bool said_zero, clean, ended;
  double end_V, later_V; // at its end (or after the death), and highest from then on
  double zero_s;         // from the fault to 0 V for good; INFINITY: it was not while looked at
  double alarm_s;        // from the fault to the end of the program
};

static size_t next_run, run_count;
static struct run *runs;
static pthread_mutex_t next_lock = PTHREAD_MUTEX_INITIALIZER;

static double uniform(unsigned *seed, double from, double to)
{
  return from + (to - from) * rand_r(seed) / RAND_MAX;
}

static void choose(struct run *r, unsigned seed)
{
  unsigned s = r->seed = seed;
  for (int i = 0; i < 4; i++) {
    (void)rand_r(&s); // small seeds are alike at first
  }
  r->fault = (enum fault)(seed % FAULTS); // each as often
  r->fault_s = uniform(&s, 0.2, 1.4);
  r->lasts_s = rand_r(&s) % 2 == 0 ? uniform(&s, 0.1, 3) : INFINITY;
  r->measures = rand_r(&s) % 8 != 0;
  r->one_client = rand_r(&s) % 3 == 0;
}

static void start_supply(struct supply *s, const struct run *r)
{
  unsigned seed = r->seed + 1;
  *s = (struct supply){.one_client = r->one_client};
  s->delay_s = uniform(&seed, 0.02, 1.2);
  s->slew_V_per_s = uniform(&seed, 5e3, 100e3);
  supply_start(s);
}

static pid_t start_drive(const struct run *r, const char *folder, int port)
{
  char command[2048], name[600];
  snprintf(name, sizeof name, "%s/p.yaml", folder);
  FILE *file = fopen(name, "wb");
  if (file == NULL) {
    return -1;
  }
  fprintf(file,
          "dea-protocol: 1\n"
          "waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: 2, frequency: 1 Hz}\n"
          "amplifier: {gain: 1000, max_voltage: 5 kV}\nrate: 200 Hz\n"
          "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: %g V, zero_time: 3 s}\n"
          "instruments:\n"
          "  - {kind: scpi, address: 127.0.0.1, port: %d, timeout: 1 s, setup: [OUTP ON],\n"
          "     output: \"VOLT %%g\", output_factor: 1000, output_off: OUTP OFF%s}\n",
          zero_V, port, r->measures ? ", measure: \"MEAS:VOLT?\", is_off: \"OUTP?\"" : "");
  fclose(file);
  snprintf(command, sizeof command,
           "cd '%s' && XDG_STATE_HOME='%s' exec '%s' drive p.yaml --arm -o r.h5 >out 2>err", folder,
           folder, DEA_COMMAND);
  pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command, (char *)NULL);
    _exit(98);
  }
  return child;
}

/* The recording cannot grow any more. */
static void fill_disk(const char *folder, pid_t child)
{
  char path[600];
  struct stat info;
  snprintf(path, sizeof path, "%s/r.h5", folder);
  rlim_t size = stat(path, &info) == 0 ? (rlim_t)info.st_size : 0;
  (void)prlimit(child, RLIMIT_FSIZE, &(struct rlimit){size, size}, NULL);
}

static void begin_fault(const struct run *r, const char *folder, struct supply *s, pid_t child)
{
  static const int of_supply[FAULTS] = {[DELAY] = SUPPLY_SLOW,
                                        [HANG] = SUPPLY_HANGS,
                                        [LIE] = SUPPLY_LIES,
                                        [GARBAGE] = SUPPLY_GARBLES,
                                        [DISCONNECT] = SUPPLY_HANGS_UP};
  static const int signals[FAULTS] = {
      [STOP] = SIGSTOP, [KILL] = SIGKILL, [CRASH] = SIGSEGV, [CTRL_C] = SIGINT};
  atomic_store(&s->fault, of_supply[r->fault]);
  if (signals[r->fault] != 0) {
    kill(child, signals[r->fault]);
  } else if (r->fault == FULL_DISK) {
    fill_disk(folder, child);
  }
}

static bool has_text(const char *folder, const char *name, const char *text)
{
  char path[700], bytes[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  size_t length = file != NULL ? fread(bytes, 1, sizeof bytes - 1, file) : 0;
  bytes[length] = '\0';
  if (file != NULL) {
    fclose(file);
  }
  return text != NULL ? strstr(bytes, text) != NULL : length > 0;
}

/* Plays, lets the fault come and go, and looks at the supply until some time after the end. */
static void make_run(struct run *r)
{
  struct supply *s = malloc(sizeof *s);
  char folder[560], state[64];
  int status;
  snprintf(folder, sizeof folder, "%s/run-%u", command_folder, r->seed);
  if (s == NULL || mkdir(folder, 0777) != 0) {
    return;
  }
  start_supply(s, r);
  pid_t child = start_drive(r, folder, s->port);
  double began_s = dea_clock_s(), up_s = began_s, ended_s = INFINITY, now_s = began_s, fault_at_s;
  bool faulty = false, over = false, gone = false;
  (void)supply_reaches(s, 1, 10); // it plays
  began_s = dea_clock_s();
  fault_at_s = began_s + r->fault_s;
  while (now_s < began_s + limit_s && !(gone && now_s > ended_s + after_s)) {
    now_s = dea_clock_s();
    if (!faulty && now_s >= fault_at_s && !gone) {
      begin_fault(r, folder, s, child);
      faulty = true;
    }
    if (faulty && !over && (now_s >= fault_at_s + fmin(r->lasts_s, r->fault == STOP ? 4 : 1e9))) {
      atomic_store(&s->fault, SUPPLY_GOOD);
      kill(gone ? 0x7fffffff : child, r->fault == STOP ? SIGCONT : 0);
      over = true;
    }
    if (!gone && waitpid(child, &status, WNOHANG) == child) {
      gone = true;
      ended_s = now_s;
      r->ended = WIFEXITED(status);
      r->code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      r->end_V = supply_volts(s);
      (void)supply_highest(s);
      r->said_zero = r->ended && (has_text(folder, "out", "  at 0 V") ||
                                  has_text(folder, "err", "the output is at 0 V"));
    }
    up_s = supply_volts(s) > zero_V ? now_s : up_s;
    dea_clock_wait(0.004);
  }
  if (!gone) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  r->later_V = supply_highest(s);
  r->zero_s = now_s - up_s > 0.5 ? fmax(up_s - fault_at_s, 0) : INFINITY;
  r->alarm_s = ended_s - fault_at_s;
  snprintf(state, sizeof state, "dea/supplies/scpi-127.0.0.1-%d", s->port);
  r->clean = !has_text(folder, state, NULL);
  supply_stop(s);
  free(s);
}

static void *make_runs(void *user)
{
  for (;;) {
    pthread_mutex_lock(&next_lock);
    size_t i = next_run++;
    pthread_mutex_unlock(&next_lock);
    if (i >= run_count) {
      return user;
    }
    make_run(&runs[i]);
  }
}

/* What must never be. A guard may still have been at work on what a dead program left. */
static bool is_wrong(const struct run *r)
{
  bool at_zero = r->end_V <= zero_V && r->later_V <= zero_V;
  if ((r->code == 0 && !r->ended) || r->code == 98) {
    return true; // it never ended, or never began: such a run shows nothing
  }
  if (r->said_zero && (!at_zero || !r->measures)) {
    return true;
  }
  return r->clean && r->measures && isinf(r->zero_s);
}

static void print_histogram(void)
{
  static const double edges_s[] = {0.1, 0.3, 1, 2, 3, 5, 10, INFINITY};
  enum { BINS = sizeof edges_s / sizeof edges_s[0] };
  print_message("%-12s  runs  at 0 V  other |  time from the fault to 0 V: ", "fault");
  for (size_t b = 0; b < BINS; b++) {
    print_message(" <%-4g", edges_s[b]);
  }
  print_message("  never | longest alarm\n");
  for (int f = 0; f < FAULTS; f++) {
    size_t bins[BINS + 1] = {0}, count = 0, zero = 0;
    double alarm_s = 0;
    for (size_t i = 0; i < run_count; i++) {
      const struct run *r = &runs[i];
      if ((int)r->fault == f) {
        size_t b = 0;
        while (b < BINS && !(r->zero_s < edges_s[b])) {
          b++;
        }
        bins[b]++;
        count++;
        zero += r->said_zero;
        alarm_s = isfinite(r->alarm_s) ? fmax(alarm_s, r->alarm_s) : alarm_s;
      }
    }
    print_message("%-12s  %4zu  %6zu  %5zu |%32s", names[f], count, zero, count - zero, "");
    for (size_t b = 0; b < BINS; b++) {
      print_message(" %5zu", bins[b]);
    }
    print_message("  %5zu | %.2f s\n", bins[BINS], alarm_s);
  }
}

/* A row a run: times [s] after the fault; inf: never. */
static void write_table(const char *path)
{
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fprintf(file, "seed,fault,after (s),lasts (s),read back,exit,said at 0 V,end (V),later (V),"
                "at 0 V (s),alarm (s),wrong\n");
  for (size_t i = 0; i < run_count; i++) {
    const struct run *r = &runs[i];
    fprintf(file, "%u,%s,%.3f,%g,%d,%d,%d,%.0f,%.0f,%g,%g,%d\n", r->seed, names[r->fault],
            r->fault_s, r->lasts_s, r->measures, r->code, r->said_zero, r->end_V, r->later_V,
            r->zero_s, r->alarm_s, is_wrong(r));
  }
  assert_int_equal(fclose(file), 0);
}

static unsigned first_seed = 1;
static const char *table;

static void test_faults_at_random_moments(void **state)
{
  (void)state;
  pthread_t threads[TOGETHER];
  size_t wrong = 0;
  runs = calloc(run_count, sizeof *runs);
  assert_non_null(runs);
  for (size_t i = 0; i < run_count; i++) {
    choose(&runs[i], first_seed + (unsigned)i);
  }
  for (size_t i = 0; i < TOGETHER; i++) {
    assert_int_equal(pthread_create(&threads[i], NULL, make_runs, NULL), 0);
  }
  for (size_t i = 0; i < TOGETHER; i++) {
    pthread_join(threads[i], NULL);
  }
  print_histogram();
  if (table != NULL) {
    write_table(table);
  }
  for (size_t i = 0; i < run_count; i++) {
    const struct run *r = &runs[i];
    if (is_wrong(r)) {
      wrong++;
      print_message(
          "seed %u, %s after %.3f s for %.3g s: exit %d, said at 0 V %d, clean %d, %.0f V "
          "at the end, then up to %.0f V, 0 V after %.2f s\n",
          r->seed, names[r->fault], r->fault_s, r->lasts_s, r->code, r->said_zero, r->clean,
          r->end_V, r->later_V, r->zero_s);
    }
  }
  free(runs);
  assert_int_equal(wrong, 0);
}

int main(int count, char **arguments)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_faults_at_random_moments)};
  run_count = count > 1 ? (size_t)strtoul(arguments[1], NULL, 10) : 12;
  first_seed = count > 2 ? (unsigned)strtoul(arguments[2], NULL, 10) : 1;
  table = count > 3 ? arguments[3] : NULL;
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
