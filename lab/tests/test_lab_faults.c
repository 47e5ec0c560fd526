/* dea drive on imitated supplies with a fault at a random moment: whatever happens, "at 0 V" is
 * only said, and a supply only taken for clean, when the imitation was at 0 V and stayed there.
 * Twelve runs by fixed seeds; `test_lab_faults COUNT [SEED [TABLE]]` makes as many as wanted,
 * prints how long it took to 0 V, or to the alarm, and writes a table of the runs
 * (verify/drive-faults.sh). */
// ctest: supply
#include "shvps_supply.h"

#include <signal.h>
#include <sys/resource.h>

enum { TOGETHER = 8, METERS_TOGETHER = 16 };
static const double limit_s = 60, after_s = 2;

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

static size_t run_count;
static struct run *runs;

/* Runs of a kind, some of them at a time. */
static struct {
  atomic_size_t next;
  size_t count;
  void (*make)(size_t i);
} work;

static void *make_some(void *user)
{
  for (size_t i; (i = atomic_fetch_add(&work.next, 1)) < work.count;) {
    work.make(i);
  }
  return user;
}

static void make_all(size_t count, void (*make)(size_t i), size_t together)
{
  pthread_t threads[METERS_TOGETHER];
  atomic_store(&work.next, 0);
  work.count = count;
  work.make = make;
  for (size_t i = 0; i < together; i++) {
    assert_int_equal(pthread_create(&threads[i], NULL, make_some, NULL), 0);
  }
  for (size_t i = 0; i < together; i++) {
    pthread_join(threads[i], NULL);
  }
}

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

static pid_t begin_drive(const char *folder)
{
  return supply_begin_in(folder, "drive p.yaml --arm -o r.h5");
}

static pid_t start_drive(const struct run *r, const char *folder, int port)
{
  char name[600];
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
          supply_zero_V, port, r->measures ? ", measure: \"MEAS:VOLT?\", is_off: \"OUTP?\"" : "");
  fclose(file);
  return begin_drive(folder);
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

static size_t read_text(const char *folder, const char *name, char *bytes, size_t capacity)
{
  char path[700];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  size_t length = file != NULL ? fread(bytes, 1, capacity - 1, file) : 0;
  bytes[length] = '\0';
  if (file != NULL) {
    fclose(file);
  }
  return length;
}

static bool has_text(const char *folder, const char *name, const char *text)
{
  char bytes[4096];
  size_t length = read_text(folder, name, bytes, sizeof bytes);
  return text != NULL ? strstr(bytes, text) != NULL : length > 0;
}

/* A guard that goes on after its program, and is a child by now, is not to write to the next line
 * or port of that name. */
static void end_guard(pid_t guard)
{
  int status;
  if (guard > 0 && waitpid(guard, &status, WNOHANG) == 0) {
    kill(guard, SIGKILL);
    waitpid(guard, &status, 0);
  }
}

/* Plays, lets the fault come and go, and looks at the supply until some time after the end. */
static void make_run(size_t i)
{
  struct run *r = &runs[i];
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
  const pid_t guard = supply_child_of(child);
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
      r->said_zero = r->ended && (has_text(folder, "out.txt", "  at 0 V") ||
                                  has_text(folder, "err.txt", "the output is at 0 V"));
    }
    up_s = supply_volts(s) > supply_zero_V ? now_s : up_s;
    dea_clock_wait(0.004);
  }
  if (!gone) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  r->later_V = supply_highest(s);
  r->zero_s = now_s - up_s > 0.5 ? fmax(up_s - fault_at_s, 0) : INFINITY;
  r->alarm_s = ended_s - fault_at_s;
  snprintf(state, sizeof state, "state/dea/supplies/scpi-127.0.0.1-%d", s->port);
  r->clean = !has_text(folder, state, NULL);
  end_guard(guard);
  supply_stop(s);
  free(s);
}

/* What must never be. A guard may still have been at work on what a dead program left. */
static bool is_wrong(const struct run *r)
{
  bool at_zero = r->end_V <= supply_zero_V && r->later_V <= supply_zero_V;
  if ((r->code == 0 && !r->ended) || r->code == SUPPLY_NO_DEA) {
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
static const char *table, *meter_table;

TEST(test_faults_at_random_moments)
{
  size_t wrong = 0;
  runs = calloc(run_count, sizeof *runs);
  assert_non_null(runs);
  for (size_t i = 0; i < run_count; i++) {
    choose(&runs[i], first_seed + (unsigned)i);
  }
  make_all(run_count, make_run, TOGETHER);
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

// Meters that lie, outputs that do something else -------------------------------------------------

static const double played_s = 12, deaf_s = 8, watched_s = 20, top_V = 2000;

enum wave { SQUARE, SINE, TRIANGLE, TRAPEZOID, PULSES, WAVES };
static const char *const wave_names[] = {"square", "sine", "triangle", "trapezoid", "pulses"};
static const double frequencies_Hz[] = {0.5, 1, 2};

/* What goes wrong; `always`: from the start on, else at a random moment at times. */
struct kind {
  const char *name;
  struct supply_wrong wrong;
  bool always;
};
static const struct kind kinds[] = {
    {"honest", {0}, true},
    {"meter at 0 V, output stays", {.blind = true, .latched = true}, false},
    {"meter at 0 V", {.blind = true}, false},
    {"meter stays", {.frozen = true}, false},
    {"meter and output stay", {.frozen = true, .latched = true}, false},
    {"output stays", {.latched = true}, false},
    {"output twice", {.scaled = true, .scale = 2}, true},
    {"output 0.4 times", {.scaled = true, .scale = 0.4}, true},
    {"output never moves", {.scaled = true, .scale = 0}, true},
    {"output cut off at 0.9 kV", {.most_V = 900}, true},
    {"deaf for 8 s", {.deaf = true}, false},
};
enum { HONEST, KINDS = sizeof kinds / sizeof kinds[0], DEAF = KINDS - 1 };

struct meter_run {
  unsigned seed;
  size_t kind;
  enum wave wave;
  double frequency_Hz, fault_s; // after the output rose first; below 0: from the start on
  bool serial;
  int code;               // -1: it did not end
  bool said_zero, warned; // warned: before, that it is too fast to be told
  bool late;              // ended since the imitation of a busy computer was late, not by its meter
  double end_V, later_V;  // at its end, and the highest from then on
  double zero_s;          // from a deaf one's hearing to 0 V; INFINITY: not while looked at
};
static struct meter_run *meters;
static size_t meter_count;

static void choose_meter(struct meter_run *r, unsigned seed)
{
  unsigned s = r->seed = seed;
  for (int i = 0; i < 4; i++) {
    (void)rand_r(&s);
  }
  r->kind = (seed / WAVES) % (KINDS + 2); // three times as many honest ones
  r->kind = r->kind < KINDS ? r->kind : HONEST;
  r->wave = (enum wave)(seed % WAVES);
  r->frequency_Hz = frequencies_Hz[rand_r(&s) % 3];
  r->serial = rand_r(&s) % 3 == 0;
  bool later = !kinds[r->kind].always && rand_r(&s) % 2 == 0;
  r->fault_s = later ? uniform(&s, 0, 0.6 * played_s) : r->kind == DEAF ? uniform(&s, 0, 1) : -1;
  r->zero_s = INFINITY;
}

static void start_imitation(struct supply *s, const struct meter_run *r)
{
  unsigned seed = r->seed + 1;
  memset(s, 0, sizeof *s);
  s->slew_V_per_s = uniform(&seed, 20e3, 200e3);
  if (r->serial) {
    shvps_begin(s);
  } else {
    supply_start(s);
  }
}

static void write_meter_protocol(const struct meter_run *r, const struct supply *m,
                                 const char *folder)
{
  static const char *const shapes[] = {
      "square, high: 2 kV", "sine, amplitude: 1 kV, mean: 1 kV, phase: -90 degree",
      "triangle, low: 0 kV, high: 2 kV", "", "square, high: 2 kV, duty: 0.2"};
  char shape[128], name[600];
  if (r->wave == TRAPEZOID) {
    snprintf(shape, sizeof shape, "square, high: 2 kV, rise_time: %g s", 0.15 / r->frequency_Hz);
  } else {
    snprintf(shape, sizeof shape, "%s", shapes[r->wave]);
  }
  snprintf(name, sizeof name, "%s/p.yaml", folder);
  FILE *file = fopen(name, "wb");
  if (file == NULL) {
    return;
  }
  fprintf(file,
          "dea-protocol: 1\nwaveform: {kind: %s, frequency: %g Hz, cycles: %.0f}\n"
          "amplifier: {gain: 1000, max_voltage: 5 kV%s}\nrate: 100 Hz\n"
          "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: %g V, zero_time: 3 s}\n"
          "instruments:\n",
          shape, r->frequency_Hz, played_s * r->frequency_Hz, r->serial ? ", min_voltage: 0 V" : "",
          supply_zero_V);
  if (r->serial) {
    fprintf(file, "  - {kind: shvps, device: %s, timeout: 3 s, queue: 1 s}\n", m->device);
  } else {
    fprintf(file,
            "  - {kind: scpi, address: 127.0.0.1, port: %d, timeout: 1 s, setup: [OUTP ON], queue: "
            "1 s,\n     output: \"VOLT %%g\", output_factor: 1000, output_off: OUTP OFF, "
            "measure: \"MEAS:VOLT?\"}\n",
            m->port);
  }
  fclose(file);
}

static void play_meter(struct meter_run *r, struct supply *m, pid_t child, const char *folder)
{
  double began_s = dea_clock_s(), ended_s = INFINITY, wrong_s = INFINITY, up_s = began_s;
  double now_s = began_s, until_s = INFINITY, risen_s = INFINITY;
  bool deaf = r->kind == DEAF;
  pid_t guard = 0;
  int status;
  while (now_s < began_s + limit_s && now_s < until_s) {
    now_s = dea_clock_s();
    double volts = supply_volts(m);
    risen_s = isinf(risen_s) && volts > supply_zero_V ? now_s : risen_s;
    if (isinf(wrong_s) && r->fault_s >= 0 && now_s >= risen_s + r->fault_s &&
        (volts > 0.5 * top_V || !deaf)) {
      supply_go_wrong(m, &kinds[r->kind].wrong);
      wrong_s = now_s;
    }
    if (deaf && now_s > wrong_s + deaf_s) {
      supply_go_wrong(m, &kinds[HONEST].wrong);
    }
    if (isinf(ended_s) && guard == 0 && now_s > began_s + 0.1) {
      guard = supply_child_of(child);
    }
    if (isinf(ended_s) && waitpid(child, &status, WNOHANG) == child) {
      ended_s = now_s;
      r->code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      r->end_V = supply_volts(m);
      (void)supply_highest(m);
      r->said_zero = has_text(folder, "out.txt", "  at 0 V") ||
                     has_text(folder, "err.txt", "the output is at 0 V");
      r->warned = has_text(folder, "err.txt", "too short to tell a wrong height");
      r->late = has_text(folder, "err.txt", "did not answer") ||
                has_text(folder, "err.txt", "behind with its voltage");
      until_s = deaf && r->code != 0 ? wrong_s + deaf_s + watched_s : now_s + after_s;
    }
    up_s = volts > supply_zero_V ? now_s : up_s;
    if (deaf && now_s > fmax(wrong_s + deaf_s, up_s) + 2 && now_s > ended_s + after_s) {
      break; // down for good
    }
    dea_clock_wait(0.004);
  }
  if (isinf(ended_s)) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  r->later_V = supply_highest(m);
  r->zero_s = deaf && now_s > up_s + 1 ? fmax(up_s - wrong_s - deaf_s, 0) : INFINITY;
  end_guard(guard);
}

static void make_meter_run(size_t i)
{
  struct meter_run *r = &meters[i];
  struct supply *m = malloc(sizeof *m);
  char folder[560];
  snprintf(folder, sizeof folder, "%s/meter-%u", command_folder, r->seed);
  r->code = -1;
  if (m == NULL || mkdir(folder, 0777) != 0) {
    free(m);
    return;
  }
  start_imitation(m, r);
  if (r->fault_s < 0) {
    struct supply_wrong wrong = kinds[r->kind].wrong;
    wrong.latched = false; // it moves at first, else it stays at 0 V
    supply_go_wrong(m, &wrong);
    r->fault_s = kinds[r->kind].wrong.latched ? 0.25 / r->frequency_Hz : -1;
  }
  write_meter_protocol(r, m, folder);
  play_meter(r, m, begin_drive(folder), folder);
  supply_stop(m);
  free(m);
}

static bool says_wrong(const struct meter_run *r)
{
  return r->said_zero && (r->end_V > supply_zero_V || r->later_V > supply_zero_V);
}

/* An honest supply was stopped, or not believed; a wrong one was not noticed. */
static bool judges_wrong(const struct meter_run *r)
{
  return r->kind == HONEST ? !r->late && (r->code != 0 || !r->said_zero)
                           : r->code == 0 && !r->warned;
}

static void write_meter_table(const char *path)
{
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fprintf(file, "seed,kind,waveform,frequency (Hz),supply,from (s),exit,said at 0 V,end (V),"
                "later (V),warned,said wrongly,judged wrongly,heard to 0 V (s)\n");
  for (size_t i = 0; i < meter_count; i++) {
    const struct meter_run *r = &meters[i];
    fprintf(file, "%u,\"%s\",%s,%g,%s,%.2f,%d,%d,%.0f,%.0f,%d,%d,%d,%g\n", r->seed,
            kinds[r->kind].name, wave_names[r->wave], r->frequency_Hz, r->serial ? "shvps" : "scpi",
            r->fault_s, r->code, r->said_zero, r->end_V, r->later_V, r->warned, says_wrong(r),
            judges_wrong(r), r->zero_s);
  }
  assert_int_equal(fclose(file), 0);
}

/* Whatever meter and output do: "at 0 V" is said of an output that is there, and one that does
 * something else than what was asked is noticed. */
TEST(test_meters_that_lie)
{
  size_t wrong = 0;
  meters = calloc(meter_count, sizeof *meters);
  assert_non_null(meters);
  for (size_t i = 0; i < meter_count; i++) {
    choose_meter(&meters[i], first_seed + (unsigned)i);
  }
  make_all(meter_count, make_meter_run, METERS_TOGETHER);
  if (meter_table != NULL) {
    write_meter_table(meter_table);
  }
  for (size_t i = 0; i < meter_count; i++) {
    const struct meter_run *r = &meters[i];
    bool heard = r->kind != DEAF || isfinite(r->zero_s);
    if (says_wrong(r) || judges_wrong(r) || !heard) {
      char folder[560], said[1500];
      wrong++;
      snprintf(folder, sizeof folder, "%s/meter-%u", command_folder, r->seed);
      (void)read_text(folder, "err.txt", said, sizeof said);
      print_message("seed %u, %s, %s of %g Hz, %s, from %.2f s: exit %d, said at 0 V %d, %.0f V at "
                    "the end, then up to %.0f V\n%s\n",
                    r->seed, kinds[r->kind].name, wave_names[r->wave], r->frequency_Hz,
                    r->serial ? "shvps" : "scpi", r->fault_s, r->code, r->said_zero, r->end_V,
                    r->later_V, said);
    }
  }
  free(meters);
  assert_int_equal(wrong, 0);
}

int main(int count, char **arguments)
{
  const struct CMUnitTest lies[] = {cmocka_unit_test(test_meters_that_lie)};
  prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  bool only_meters = count > 1 && strcmp(arguments[1], "meters") == 0;
  count -= only_meters;
  arguments += only_meters;
  run_count = count > 1 ? (size_t)strtoul(arguments[1], NULL, 10) : 12;
  meter_count = only_meters ? run_count : METERS_TOGETHER;
  first_seed = count > 2 ? (unsigned)strtoul(arguments[2], NULL, 10) : 1;
  *(only_meters ? &meter_table : &table) = count > 3 ? arguments[3] : NULL;
  return only_meters ? cmocka_run_group_tests(lies, command_set_up, supply_tear_down)
                     : run_all(command_set_up, supply_tear_down);
}
