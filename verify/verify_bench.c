/* The bench from end to end: a protocol is played to the simulated bench, recorded, read and
 * reduced; what comes out is laid beside what the film does by study "transient" of model lumped,
 * which knows nothing of the bench. */
#include "base/file.h"
#include "compare/compare_set.h"
#include "drive/drive.h"
#include "film/film_of_design.h"
#include "protocol/protocol.h"
#include "reduce/output.h"
#include "result/result.h"
#include "study/design_file.h"
#include "study/study.h"
#include "verify.h"

#include <unistd.h>

enum { SETS_MAX = 16 };
static const double pi = 3.14159265358979323846;

static const char protocol_file[] = DEA_SOURCE_DIR "/lab/examples/cyclic.yaml";
/* Those of the example, and a force cell. */
static const char channels[] =
    "[{name: amplifier voltage, quantity: voltage, input: ai0, per_volt: 1 kV}, "
    "{name: amplifier current, quantity: current, input: ai1, per_volt: 1 mA}, "
    "{name: centre laser, quantity: displacement, input: ai2, per_volt: 1 mm, filter: 100 Hz}, "
    "{name: force cell, quantity: force, input: ai3, per_volt: 24.5 mN, filter: 50 Hz}]";
static const char design_file[] = DEA_SOURCE_DIR "/examples/frdea-4.yaml";

/* Columns of the truth for each kind that is reduced, the point laser measuring the centre. */
static const struct {
  enum dea_reduced_kind kind;
  int column;
  const char *title, *unit;
  double factor;
} quantities[] = {
    {DEA_REDUCED_CENTRE, -1, "centre, profile", "um", 1e6},
    {DEA_REDUCED_FIBRE_TIP, -2, "fibre tips, profile", "um", 1e6},
    {DEA_REDUCED_DISPLACEMENT, -1, "centre, point laser", "um", 1e6},
    {DEA_REDUCED_FORCE, -3, "force cell", "mN", 1e3},
};
enum { QUANTITIES = sizeof quantities / sizeof quantities[0] };

static const char *const keys[] = {"centre_z_m", "fibre_tip_z_m", "force_N"};

/* What is played. */
struct measurement {
  const char *sequence; // waveform
  double frequency_Hz, duty;
  size_t level_count, cycles;
  double tilt_degree, centre_mm;
  bool drifts; // the film creeps, so that its sweep is not what it does in time
  const char *design;
};

static double column_at(const struct dea_load_point *point, int column)
{
  return dea_point_get(point, dea_point_column_find(keys[-column - 1]));
}

/* Mean of a column over a span of time, by straight lines between the points. */
static double mean_over(const struct dea_curve *curve, int column, double from_s, double to_s)
{
  double sum = 0;
  for (size_t i = 1; i < curve->count; i++) {
    const struct dea_load_point *a = &curve->points[i - 1], *b = &curve->points[i];
    double t0 = fmax(a->time_s, from_s), t1 = fmin(b->time_s, to_s), length = b->time_s - a->time_s;
    if (t1 > t0 && length > 0) {
      double x = column_at(a, column), slope = (column_at(b, column) - x) / length;
      sum += (t1 - t0) * (x + slope * (0.5 * (t0 + t1) - a->time_s));
    }
  }
  return sum / (to_s - from_s);
}

/* Mean amplitude of the cycles at a level: settled end of each active part, less the mean of those
 * of the rests on both sides (of the one that there is, at the ends of the sequence). */
static double amplitude_of(const struct dea_curve *curve, const struct measurement *m, size_t level,
                           int column)
{
  static const double settle = 0.2;
  double period = 1 / m->frequency_Hz, on = m->duty * period, off = period - on, sum = 0;
  for (size_t k = 0; k < m->cycles; k++) {
    double start = period * (double)(level * m->cycles + k);
    double active = mean_over(curve, column, start + (1 - settle) * on, start + on);
    double behind = mean_over(curve, column, start + period - settle * off, start + period);
    double before = start > 0 ? mean_over(curve, column, start - settle * off, start) : behind;
    sum += active - 0.5 * (before + behind);
  }
  return sum / (double)m->cycles;
}

/* What a protocol and the study are about: the paper's film as it is in examples/, or one that does
 * not creep, in a file of its own. */
static char elastic_file[] = "/tmp/dea-elastic-XXXXXX";

static void write_elastic(struct dea_context *ctx)
{
  char *text;
  size_t length;
  int handle = mkstemp(elastic_file);
  FILE *file = handle >= 0 ? fdopen(handle, "w") : NULL;
  verify_ok(ctx, dea_file_read(ctx, design_file, 1000000, &text, &length));
  const char *film = strstr(text, "\nfilm:\n");
  if (file == NULL || film == NULL) {
    fprintf(stderr, "no design without viscosity can be made\n");
    exit(1);
  }
  film += strlen("\nfilm:\n");
  fprintf(file, "%.*s  viscosity: none\n%s", (int)(film - text), text, film);
  fclose(file);
  dea_free(ctx, text);
}

/* The film in time by the study, with the same waveform. */
struct truth {
  struct dea_result *result;
  struct dea_device *device;
  struct dea_design *design;
  const struct dea_curve *curve;
};

static struct truth find_truth(struct dea_context *ctx, const struct measurement *m)
{
  static const char *const studies[] = {"sweep", "transient"};
  const struct dea_override sets[] = {{"drive.waveform", m->sequence},
                                      {"compute.voltage", "{from: 0 kV, to: 8 kV, step: 1 kV}"},
                                      {"compute.transient.interval", "5 ms"}};
  struct truth t;
  verify_ok(ctx, dea_design_read(ctx, m->design, sets, 3, &t.design));
  verify_ok(ctx, dea_device_build(ctx, t.design, &t.device));
  verify_ok(ctx, dea_result_create(ctx, t.design, t.device, &t.result));
  verify_ok(ctx, dea_study_run(ctx, dea_model_find("lumped"), studies, 2, t.result));
  t.curve = dea_result_find(t.result, "lumped", "transient");
  return t;
}

/* Writes the tables of a reduction, reads them back and compares them with the model's result: what
 * `dea compare` does. */
static struct dea_compare_set *compare(struct dea_context *ctx, const struct truth *truth,
                                       const struct dea_recording *recording,
                                       const struct dea_reduction *reduction,
                                       struct dea_measured **measured)
{
  static const char *const files[] = {"measurement.csv", "levels.csv",   "cycles.csv",
                                      "discharges.csv",  "profiles.csv", "history.csv"};
  char folder[] = "/tmp/dea-reduced-XXXXXX", path[64];
  static struct dea_compare_set set; // until the next one
  struct dea_set_curve curve = {.name = "lumped", .result = truth->result, .model = "lumped"};
  if (mkdtemp(folder) == NULL) {
    fprintf(stderr, "no folder for the tables\n");
    exit(1);
  }
  verify_ok(ctx, dea_reduction_write_tables(ctx, recording, reduction, folder));
  verify_ok(ctx, dea_measured_read(ctx, folder, measured));
  set = (struct dea_compare_set){
      .reference = "measured", .measured = *measured, .memory = {.ctx = ctx}};
  verify_ok(ctx, dea_compare_set_add(ctx, &set, &curve, ""));
  verify_ok(ctx, dea_compare_set_compute(ctx, &set, NULL, 0));
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    snprintf(path, sizeof path, "%s/%s", folder, files[i]);
    unlink(path);
  }
  rmdir(folder);
  return &set;
}

static void print_comparison(const struct measurement *m, const struct dea_compare_set *set)
{
  size_t histories = 0;
  for (size_t i = 0; i < set->misfit_count; i++) {
    histories += set->misfits[i].kind == DEA_SET_HISTORY ? 1U : 0U;
  }
  verify_absolute("comparisons with the sweep", (double)(set->misfit_count - histories), 3, 0);
  verify_absolute("histories", (double)histories, 3, 0);
  printf(
      "\nThe tables of the reduction, written, read back and set beside the model as `dea compare` "
      "does. The force cell drifts, which\nstays in its history.\n");
  printf("\n| compared with the model | points | root mean square | chi2/point "
         "|\n|---|---|---|---|\n");
  for (size_t i = 0; i < set->misfit_count; i++) {
    const struct dea_misfit *misfit = &set->misfits[i].misfit;
    const struct dea_column *column = misfit->quantity;
    if (set->misfits[i].kind == DEA_SET_VOLTAGE) {
      printf("| %s against voltage | %zu | %.3f %s | %.3f |\n", column->header, misfit->count,
             column->factor * misfit->rms, column->display_unit, misfit->chi_square);
      verify_absolute("chi2/point", misfit->chi_square, 0.5, 0.5); // of the scatter of one cycle
    } else if (set->misfits[i].kind == DEA_SET_HISTORY) {
      printf("| %s in time | %zu | %.3f %s | |\n", column->header, misfit->count,
             column->factor * misfit->rms, column->display_unit);
      verify_absolute("shift of the clocks [s]", set->misfits[i].clock.shift_s, 0, 0);
      // of the frame's own height nothing drifts; of the force cell it does, and stays in a history
      double length_s = (double)(m->level_count * m->cycles) / m->frequency_Hz;
      verify_absolute("history's root mean square", column->factor * misfit->rms, 0,
                      strcmp(column->display_unit, "um") == 0 ? 3 : 0.5 + 0.02 * length_s);
    }
  }
}

/* Plays, records, reads and reduces. */
static struct dea_reduction *measure(struct dea_context *ctx, const struct measurement *m,
                                     const struct truth *truth, const struct dea_override *sets,
                                     size_t set_count, struct dea_compare_set **set,
                                     struct dea_measured **measured)
{
  char file[] = "/tmp/dea-bench-XXXXXX", sequence[512];
  struct dea_override all[SETS_MAX];
  struct dea_protocol *protocol;
  struct dea_recording *recording;
  struct dea_drive_report report;
  struct dea_reduction *reduction;
  int handle = mkstemp(file); // only its name is wanted
  if (handle < 0 || close(handle) != 0 || unlink(file) != 0) {
    fprintf(stderr, "no file for the recording\n");
    exit(1);
  }
  snprintf(sequence, sizeof sequence, "[{label: cyclic, waveform: %s}]", m->sequence);
  all[0] = (struct dea_override){"sequence", sequence};
  all[1] = (struct dea_override){"design", m->design};
  all[2] = (struct dea_override){"channels", channels};
  memcpy(all + 3, sets, set_count * sizeof *sets);
  verify_ok(ctx, dea_protocol_read(ctx, &dea_film_of_design, protocol_file, all, set_count + 3,
                                   &protocol));
  const struct dea_drive_options options = {.simulate = true, .file = file};
  verify_ok(ctx, dea_drive_run(ctx, protocol, &options, &report));
  verify_absolute("cycles", (double)report.cycles, (double)(m->level_count * m->cycles), 0);
  verify_ok(ctx, dea_recording_read(ctx, file, &recording));
  const struct dea_device *device = truth->device;
  const struct dea_reduce_options radii = {
      .fibre_tip_radius_m = device->fibre_count > 0 ? device->fibre_tip_radius_m : (double)NAN,
      .film_radius_m = device->frame_radius_m,
      .electrode_radius_m = device->electrode_radius_m,
      .force_offset_N = NAN,
  };
  verify_ok(ctx, dea_reduce(ctx, recording, &radii, &reduction));
  verify_absolute("levels", (double)reduction->level_count, (double)m->level_count, 0);
  if (set != NULL) {
    *set = compare(ctx, truth, recording, reduction, measured);
  }
  dea_recording_destroy(ctx, recording);
  dea_protocol_destroy(ctx, protocol);
  unlink(file);
  return reduction;
}

/* Differences from the truth over their uncertainties. */
struct pulls {
  double squares, largest;
  size_t count;
};

static void print_quantity(const struct measurement *m, const struct dea_curve *truth,
                           const struct dea_reduction *r, size_t q, struct pulls *pulls)
{
  double factor = quantities[q].factor;
  enum dea_reduced_kind kind = quantities[q].kind;
  if (!m->drifts) {
    printf("\n| kV | cycles | %s, true [%s] | reduced [%s] | uncertainty | difference | over "
           "uncertainty |\n|---|---|---|---|---|---|---|\n",
           quantities[q].title, quantities[q].unit, quantities[q].unit);
  }
  for (size_t l = 0; l < r->level_count; l++) {
    const struct dea_voltage_level *level = &r->levels[l];
    size_t number = (size_t)lround(1e-3 * level->voltage_V);
    double want = amplitude_of(truth, m, number, quantities[q].column);
    double pull = (level->mean[kind] - want) / level->uncertainty[kind];
    if (!m->drifts && number % 4 == 0) { // a few rows; what follows counts all levels
      printf("| %zu | %zu | %.2f | %.2f | %.2f | %+.2f | %+.2f |\n", number, level->cycles,
             factor * want, factor * level->mean[kind], factor * level->uncertainty[kind],
             factor * (level->mean[kind] - want), pull);
    }
    pulls->squares += pull * pull;
    pulls->largest = fmax(pulls->largest, fabs(pull));
    pulls->count++;
  }
}

static void print_sets(const struct dea_override *sets, size_t count)
{
  printf("\nSimulated bench (`--set`):");
  for (size_t i = 0; i < count; i++) {
    printf("%s `%s=%s`", i > 0 ? "," : "", sets[i].key, sets[i].value);
  }
  printf(".\n");
}

/* A whole measurement, and its tables. Pulls have to be those of numbers with a standard deviation
 * of 1, or below it where the film's own creep makes the scatter from cycle to cycle. */
static void check(struct dea_context *ctx, const struct measurement *m,
                  const struct dea_override *sets, size_t set_count, double least_rms)
{
  struct truth truth = find_truth(ctx, m);
  struct dea_measured *measured = NULL;
  struct dea_compare_set *set = NULL;
  struct dea_reduction *r =
      measure(ctx, m, &truth, sets, set_count, m->drifts ? NULL : &set, &measured);
  struct pulls pulls = {0};
  const struct dea_levelling *l = &r->levelling;
  if (!m->drifts) {
    print_sets(sets, set_count);
  }
  for (size_t q = 0; q < QUANTITIES; q++) {
    print_quantity(m, truth.curve, r, q, &pulls);
  }
  double rms = sqrt(pulls.squares / (double)pulls.count);
  printf("\nDifferences over uncertainties: root mean square %.2f of %zu values, largest %.2f.\n",
         rms, pulls.count, pulls.largest);
  if (!(rms >= least_rms && rms <= 1.5 && pulls.largest <= 4)) {
    verify_absolute("root mean square of the pulls", rms, 1, 0.5);
    verify_absolute("largest pull", pulls.largest, 0, 4);
  }
  printf("Tilt %.4f degree, centre at %.4f mm, frame %.4f mm high; %zu of %zu points invalid, %zu "
         "taken for outliers.\n",
         180 / pi * l->tilt_rad, 1e3 * l->centre_m, 1e3 * l->frame_height_m, l->invalid, l->total,
         l->outliers);
  verify_absolute("tilt [degree]", 180 / pi * l->tilt_rad, m->tilt_degree, 2e-3);
  verify_absolute("centre [mm]", 1e3 * l->centre_m, m->centre_mm, 0.06); // half a point
  if (set != NULL) {
    print_comparison(m, set);
    dea_arena_free(&set->memory);
  }
  dea_measured_destroy(ctx, measured);
  dea_reduction_destroy(ctx, r);
  dea_result_destroy(ctx, truth.result);
  dea_device_destroy(ctx, truth.device);
  dea_design_destroy(ctx, truth.design);
}

#define STAIRS(top, cycles)                                                                        \
  "{kind: staircase, from: 0 kV, to: " top " kV, step: 1 kV, cycles: " cycles                      \
  ", frequency: 0.5 Hz, duty: 50 %}"

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  const struct measurement m = {.sequence = small ? STAIRS("3", "4") : STAIRS("8", "15"),
                                .frequency_Hz = 0.5,
                                .duty = 0.5,
                                .level_count = small ? 4 : 9,
                                .cycles = small ? 4 : 15,
                                .tilt_degree = 1.5,
                                .centre_mm = 0.7};
  const struct dea_override sets[] = {
      {"sim.tilt", "1.5 degree"},
      {"sim.centre", "0.7 mm"},
      {"sim.outliers", "1 %"},
      {"sim.missing", "3 %"},
      {"sim.lost", "0.5 %"},
      {"sim.displacement_drift", "0.05 um/s"},
      {"sim.force_drift", "0.02 mN/s"},
      {"sim.force_offset", "7 mN"},
  };
  enum { SETS = sizeof sets / sizeof sets[0] };
  struct dea_context *ctx;
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  write_elastic(ctx);
  printf("# The bench, from end to end\n"
         "\n"
         "Written by `scripts/verify bench`. A protocol (`lab/examples/cyclic.yaml`%s) is played "
         "to the simulated\n"
         "bench, recorded, read back and reduced (`dea drive --sim`, `dea reduce`). The truth is "
         "study `transient` of model `lumped`, averaged over\n"
         "the same parts of each cycle.\n",
         small ? ", shortened" : "");
  printf(
      "\n## A film that does not creep\n\nThe scatter from cycle to cycle is noise alone, so the "
      "differences over their uncertainties should scatter with 1.\n");
  struct measurement elastic = m;
  elastic.design = elastic_file;
  check(ctx, &elastic, sets, SETS, 0.5);
  printf("\n"
         "## The film as in the catalogue, which creeps by an assumption\n"
         "\n"
         "The first cycles at a voltage differ from the later ones, and the uncertainties are "
         "those of such a scatter.\n");
  struct measurement viscous = m;
  viscous.design = design_file;
  viscous.drifts = true;
  check(ctx, &viscous, sets, SETS, 0);
  unlink(elastic_file);
  dea_context_destroy(ctx);
  return verify_end();
}
