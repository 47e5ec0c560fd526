/* The reduction as a whole: recordings whose truth is known. */
// ctest: quick, heavy
#include "lab_reduced.h"

// Uncertainties ----------------------------------------------------------------------------------

/* Amplitudes of a point laser with a given correlation: of one cycle, and of the level's mean. */
static void pulls_of(double rho, const char *what)
{
  struct signal_pulls cycle = {0}, level = {0};
  struct signal_bench b = signal_bench_plain();
  char name[64];
  b.displacement = true;
  b.sigma = 4e-6;
  b.rho = rho;
  b.drift_per_s = 2e-6;
  for (uint64_t seed = 1; seed <= 200; seed++) {
    record(&b, seed);
    reduce(&plain);
    assert_int_equal(out->level_count, 1);
    assert_int_equal(out->levels[0].cycles, 5);
    const struct dea_cycle_value *v = &out->cycles[2].values[DEA_REDUCED_DISPLACEMENT];
    signal_pull(&cycle, v->amplitude, 300e-6, v->uncertainty);
    signal_pull(&level, out->levels[0].mean[DEA_REDUCED_DISPLACEMENT], 300e-6,
                out->levels[0].uncertainty[DEA_REDUCED_DISPLACEMENT]);
  }
  snprintf(name, sizeof name, "a cycle, %s", what);
  signal_check_pulls(name, &cycle);
  snprintf(name, sizeof name, "a level, %s", what);
  signal_check_pulls(name, &level);
}

TEST(test_uncertainty_of_samples)
{
  pulls_of(0.0, "independent");
  pulls_of(0.7, "correlated");
}

TEST(test_uncertainty_of_profiles)
{
  struct signal_pulls centre = {0}, tip = {0};
  struct signal_bench b = line_laser();
  struct dea_reduce_options options = plain;
  options.film_radius_m = b.film_m;
  options.electrode_radius_m = b.electrode_m;
  options.fibre_tip_radius_m = 6e-3;
  double tip_truth = 300e-6 * signal_shape(&b, 6e-3);
  for (uint64_t seed = 1; seed <= 120; seed++) {
    record(&b, seed);
    reduce(&options);
    assert_true(out->levelling.by_frame);
    const struct dea_voltage_level *level = &out->levels[0];
    signal_pull(&centre, level->mean[DEA_REDUCED_CENTRE], 300e-6,
                level->uncertainty[DEA_REDUCED_CENTRE]);
    signal_pull(&tip, level->mean[DEA_REDUCED_FIBRE_TIP], tip_truth,
                level->uncertainty[DEA_REDUCED_FIBRE_TIP]);
  }
  signal_check_pulls("a level's centre", &centre);
  signal_check_pulls("a level's fibre tips", &tip);
}

// The frame --------------------------------------------------------------------------------------

TEST(test_frame_is_found_and_taken_off)
{
  struct signal_bench b = line_laser();
  b.points = 800;
  for (int known = 0; known < 2; known++) {
    struct dea_reduce_options options = plain;
    options.film_radius_m = known == 1 ? b.film_m : NAN;
    options.electrode_radius_m = b.electrode_m;
    record(&b, 7);
    reduce(&options);
    const struct dea_levelling *l = &out->levelling;
    double pitch = r.profiles.x_m[1] - r.profiles.x_m[0];
    assert_true(l->by_frame);
    assert_close(l->centre_m, b.centre_m, 0.0, 2.0 * pitch);
    assert_close(0.5 * (l->edges_m[1] - l->edges_m[0]), b.film_m, 0.0, 2.0 * pitch);
    assert_close(tan(l->tilt_rad), b.tilt, 0.0, 2e-4);
    assert_close(l->frame_height_m, b.frame_m, 0.05, 0.0);
    double lost = (double)l->invalid / (double)l->total;
    assert_close(lost, b.lost, 0.1, 0.0);
    assert_close((double)l->outliers / (double)l->total, b.outliers, 0.15, 0.0);
    for (size_t i = 0; i < out->points; i++) { // nothing of the frame is left
      double z = out->levels[0].z_m[i];
      assert_true(fabs(out->radius_m[i]) < b.film_m ||
                  isnan(z)); // and the film is where it should be
      if (!isnan(z)) {
        assert_close(z, 300e-6 * signal_shape(&b, out->radius_m[i]), 0.0, 15e-6);
      }
    }
  }
}

/* Frames that lie higher and lower in turn, by as much: the scatter of their offsets. */
TEST(test_scatter_of_the_frames)
{
  struct signal_bench b = line_laser();
  b.point_sigma = b.common_sigma = b.drift_per_s = b.outliers = b.lost = 0.0;
  struct dea_reduce_options options = plain;
  options.film_radius_m = b.film_m;
  options.electrode_radius_m = b.electrode_m;
  record(&b, 3);
  const struct dea_profiles *p = &r.profiles;
  double n = (double)p->count, squares = 0.0, sum = 0.0;
  for (size_t f = 0; f < p->count; f++) {
    double by = f % 2 == 0 ? 40e-6 : -20e-6;
    sum += by;
    squares += by * by;
    for (size_t i = 0; i < p->points; i++) {
      p->z_m[f * p->points + i] += by;
    }
  }
  reduce(&options);
  assert_true(out->levelling.by_frame);
  assert_close(out->levelling.offset_std_m, sqrt((squares - sum * sum / n) / (n - 1.0)), 1e-4, 0.0);
}

TEST(test_line_beside_the_centre_is_said)
{
  struct signal_bench b = line_laser();
  struct dea_reduce_options options = plain;
  b.film_m = 14e-3; // a chord of a film of 15 mm
  options.film_radius_m = 15e-3;
  record(&b, 3);
  reduce(&options);
  assert_close(out->levelling.beside_m, sqrt(225.0 - 196.0) * 1e-3, 0.03, 0.0);
  assert_true(noted("beside the centre"));
}

TEST(test_without_frame_the_outer_film_levels)
{
  struct signal_bench b = line_laser();
  b.framed = false;
  b.drift_per_s = 0.0;
  b.points = 500;
  struct dea_reduce_options options = plain;
  options.fibre_tip_radius_m = 6e-3;
  record(&b, 5);
  reduce(&options);
  assert_false(out->levelling.by_frame);
  assert_true(noted("no frame"));
  assert_true(isnan(out->levelling.frame_height_m));
  assert_close(out->levelling.centre_m, b.centre_m, 0.0, 0.4e-3);
  assert_close(tan(out->levelling.tilt_rad), b.tilt, 0.0, 1e-3);
  assert_close(out->levels[0].mean[DEA_REDUCED_CENTRE], 300e-6, 0.0, 8e-6);
}

TEST(test_shape)
{
  const double cones[] = {0.0, 0.5, 1.0};
  for (int k = 0; k < 3; k++) {
    struct signal_bench b = line_laser();
    b.cone = cones[k];
    b.points = 400;
    struct dea_reduce_options options = plain;
    options.film_radius_m = b.film_m;
    options.electrode_radius_m = b.electrode_m;
    record(&b, 11);
    reduce(&options);
    const struct dea_voltage_level *level = &out->levels[0];
    assert_true(level->shape_uncertainty > 0.0 && level->shape_uncertainty < 0.08);
    assert_close(level->shape, b.cone, 0.0, 4.0 * level->shape_uncertainty + 0.01);
  }
}

// Levels, times, force ---------------------------------------------------------------------------

static void check_levels(const struct signal_bench *b)
{
  assert_int_equal(out->level_count, b->level_count);
  for (size_t l = 0; l < out->level_count; l++) {
    const struct dea_voltage_level *level = &out->levels[l];
    double V = b->levels_V[l];
    assert_int_equal(level->cycles, b->cycles);
    assert_close(level->voltage_V, V, 0.0, 5.0);
    assert_close(level->mean[DEA_REDUCED_DISPLACEMENT], b->m_per_V2 * V * V, 0.0, 2e-6);
    assert_close(level->mean[DEA_REDUCED_FORCE], b->N_per_V2 * V * V, 0.0, 2e-6);
    if (V > 1500.0) { // ln 9 tau; less is too near to the noise
      assert_close(level->rise_s[DEA_REDUCED_DISPLACEMENT], log(9.0) * b->tau_s, 0.1, 0.0);
      assert_close(level->fall_s[DEA_REDUCED_DISPLACEMENT], log(9.0) * b->tau_s, 0.1, 0.0);
      assert_close(level->creep[DEA_REDUCED_DISPLACEMENT], 0.0, 0.0, 1e-6);
    }
    assert_close(level->drift[DEA_REDUCED_DISPLACEMENT], b->drift_per_s * b->cycle_s, 0.0,
                 5.0 * level->drift_uncertainty[DEA_REDUCED_DISPLACEMENT]);
  }
}

TEST(test_levels_with_and_without_a_list)
{
  for (int k = 0; k < 4; k++) {
    struct signal_bench b = signal_bench_plain();
    b.level_count = 8;
    for (size_t l = 0; l < 8; l++) {
      b.levels_V[l] = 1000.0 * (double)(l + 1);
    }
    b.list = k < 2;
    b.command = k % 2 == 0;
    b.voltage = k > 0;
    b.displacement = b.force = true;
    b.sigma = 1e-6;
    b.drift_per_s = 0.5e-6;
    b.preload_N = 20e-3;
    b.cell_N = -3e-3;
    b.lead_s = 3.0;
    record(&b, 21);
    reduce(&plain);
    check_levels(&b);
    assert_close(out->noise[DEA_REDUCED_DISPLACEMENT], 1e-6, 0.1, 0.0);
    assert_close(out->force_offset_N, b.cell_N, 0.0, 2e-6);
    assert_close(out->preload_N, b.preload_N, 0.0, 5e-6);
    assert_int_equal(noted("was not measured"), k == 0);
  }
}

/* A level of 0 V has no edges; its cycles are where the others have theirs. */
TEST(test_cycles_at_rest)
{
  struct signal_bench b = signal_bench_plain();
  b.level_count = 3;
  b.levels_V[0] = 0.0;
  b.levels_V[1] = 2000.0;
  b.levels_V[2] = 4000.0;
  b.displacement = true;
  b.sigma = 1e-6;
  record(&b, 2);
  reduce(&plain);
  assert_int_equal(out->level_count, 3);
  assert_close(out->levels[0].voltage_V, 0.0, 0.0, 1e-9);
  assert_close(out->levels[0].mean[DEA_REDUCED_DISPLACEMENT], 0.0, 0.0,
               4.0 * out->levels[0].uncertainty[DEA_REDUCED_DISPLACEMENT]);
  assert_true(isnan(out->levels[0].rise_s[DEA_REDUCED_DISPLACEMENT]));
}

static void fill_voltage(double (*voltage)(double))
{
  for (size_t i = 0; i < r.channels[0].count; i++) {
    double t = dea_channel_time(&r.channels[0], i), V = voltage(t);
    r.channels[0].values[i] = V;
    r.channels[1].values[i] = 1e-9 * fabs(V);
  }
}

static double staircase(double t)
{
  return t < 1.0 || t >= 9.0 ? 0.0 : 1000.0 * floor(t);
}

static double one_step(double t)
{
  return t < 2.0 ? 0.0 : 5000.0;
}

static double half_sine(double t)
{
  return 2500.0 * (1.0 - cos(2.0 * acos(-1.0) * t));
}

static double triangle(double t)
{
  return 5000.0 * (1.0 - fabs(2.0 * (t - floor(t)) - 1.0));
}

static double both_signs(double t)
{
  return fmod(t, 2.0) < 1.0 ? 0.0 : fmod(t, 4.0) < 2.0 ? 3000.0 : -3000.0;
}

TEST(test_other_waveforms)
{
  const struct {
    double (*voltage)(double);
    size_t levels, cycles;
    double largest_V, within;
  } all[] = {{staircase, 8, 8, 8000.0, 1e-9},
             {one_step, 1, 1, 5000.0, 1e-9},
             {half_sine, 1, 10, 5000.0, 0.02},
             {triangle, 1, 10, 5000.0, 0.03},
             {both_signs, 2, 5, 3000.0, 1e-9}};
  for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
    record_two(500.0, 5000);
    fill_voltage(all[k].voltage);
    reduce(&plain);
    assert_int_equal(out->level_count, all[k].levels);
    assert_int_equal(out->cycle_count, all[k].cycles);
    const struct dea_voltage_level *last = &out->levels[out->level_count - 1];
    assert_close(last->voltage_V, all[k].largest_V, all[k].within, 0.0);
    if (k != 2 && k != 3) { // those of a peak rest where the voltage is not yet 0
      assert_close(last->mean[DEA_REDUCED_DISPLACEMENT], 1e-9 * all[k].largest_V, 1e-9, 1e-15);
    } else {
      assert_close(last->mean[DEA_REDUCED_DISPLACEMENT], 1e-9 * all[k].largest_V, 0.04, 0.0);
      assert_true(noted("hold no voltage"));
    }
  }
}

/* Creep that goes on through the active part, and a rise between two samples. */
TEST(test_creep_and_fast_rise)
{
  struct signal_bench b = signal_bench_plain();
  b.displacement = true;
  b.tau_s = 1e-4;
  record(&b, 1);
  struct dea_channel *z = &r.channels[1];
  for (size_t i = 0; i < z->count; i++) {
    double since = fmod(dea_channel_time(z, i) - b.lead_s + 1e-9, b.cycle_s);
    z->values[i] += since >= 0.0 && since < 1.0 ? 20e-6 * since : 0.0;
  }
  reduce(&plain);
  const struct dea_voltage_level *level = &out->levels[0];
  assert_true(isnan(level->rise_s[DEA_REDUCED_DISPLACEMENT]));            // faster than the samples
  assert_close(level->creep[DEA_REDUCED_DISPLACEMENT], 16e-6, 0.03, 0.0); // 20 um/s for 0.8 s
}

/* A displacement whose clock was put wrongly beside the voltage's is told, with how far it is off;
 * one that lags as films do is not. */
TEST(test_clocks_that_do_not_agree)
{
  static const struct {
    double off_s;
    const char *said; // NULL: nothing
  } all[] = {{0.0, NULL}, {0.02, NULL}, {0.3, "later"}, {-0.3, "earlier"}, {0.4, "later"}};
  for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
    struct signal_bench b = signal_bench_plain();
    b.displacement = true;
    b.sigma = 1e-6;
    record(&b, 3);
    struct dea_channel *z = &r.channels[1];
    z->start_s += all[k].off_s;
    reduce(&plain);
    assert_true(noted("is most like the square of the voltage") == (all[k].said != NULL));
    if (all[k].said != NULL) {
      size_t count;
      const struct dea_finding *findings = dea_finding_get(ctx, &count);
      bool found = false;
      for (size_t i = 0; i < count && !found; i++) {
        const char *at = strstr(findings[i].text, "the voltage ");
        found = at != NULL && findings[i].severity == DEA_WARNING;
        if (found) {
          assert_close(strtod(at + strlen("the voltage "), NULL), fabs(all[k].off_s), 0, 0.06);
          assert_non_null(strstr(at, all[k].said));
        }
      }
      assert_true(found);
    }
  }
}

/* A film of 4 ms behind a filter of 17 ms: the time is the filter's, which is said; one of its own
 * is not doubted. */
TEST(test_rise_of_the_filter)
{
  struct signal_bench b = signal_bench_plain();
  b.rate_Hz = 2000.0;
  b.tau_s = 0.002;
  b.displacement = true;
  for (int slow = 0; slow < 2; slow++) {
    b.tau_s = slow ? 0.03 : 0.002;
    record(&b, 7);
    for (size_t c = 0; c < r.channel_count; c++) {
      r.channels[c].filter_Hz = r.channels[c].kind == DEA_CHANNEL_DISPLACEMENT ? 20.0 : NAN;
    }
    reduce(&plain);
    double rise_s = out->levels[0].rise_s[DEA_REDUCED_DISPLACEMENT];
    assert_int_equal(noted("which is its filter of 20 Hz (16.5 ms of a step)"), !slow);
    // of two that follow each other about the root of the sum of squares
    double own_s = 0.3297 / 20.0, film_s = log(9.0) * b.tau_s;
    assert_close(rise_s, sqrt(own_s * own_s + film_s * film_s), 0.05, 0.0);
  }
}

TESTS(context_set_up, reduced_tear_down)
