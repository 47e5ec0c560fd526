/* A sensor whose range is too small, from the simulated bench to the table: said while it is
 * measured, and left out where it was cut off. */
#include "design_text.h"
#include "drive/drive.h"
#include "film/film_of_design.h"
#include "own_folder.h"
#include "protocol/protocol.h"
#include "reduce/reduce.h"

/* The laser shows +-1.5 mm; the film moves 0.5, 1.1 and 1.6 mm. */
TEST(test_too_small_range)
{
  static const struct dea_override sets[] = {
      {"sequence", "[{waveform: {kind: staircase, from: 0 kV, to: 3 kV, step: 1 kV, cycles: 3, "
                   "frequency: 2 Hz}}]"},
      {"channels",
       "[{name: hv, quantity: voltage, input: ai0, per_volt: 1 kV}, "
       "{name: laser, quantity: displacement, input: ai1, range: 10 V, per_volt: 0.15 mm}]"},
      {"sim.profile_points", "0"},
  };
  struct dea_protocol *protocol;
  struct dea_recording *recording;
  struct dea_reduction *r;
  struct dea_drive_report report;
  char file[sizeof path];
  snprintf(file, sizeof file, "%s", in_folder("range.h5"));
  assert_int_equal(dea_protocol_read(ctx, &dea_film_of_design,
                                     DEA_SOURCE_DIR "/lab/examples/cyclic.yaml", sets, 3,
                                     &protocol),
                   DEA_OK);
  const struct dea_drive_options options = {.simulate = true, .file = file};
  assert_int_equal(dea_drive_run(ctx, protocol, &options, &report), DEA_OK);
  assert_non_null(
      find_finding(ctx, DEA_WARNING, "channel 'laser' was at the end of its range of +-10 V"));
  assert_null(find_finding(ctx, DEA_WARNING, "channel 'hv' was"));
  assert_int_equal(dea_recording_read(ctx, file, &recording), DEA_OK);
  const struct dea_channel *laser = dea_recording_kind(recording, DEA_CHANNEL_DISPLACEMENT);
  assert_close(laser->highest, 1.5e-3, 1e-12, 0);
  assert_close(laser->lowest, -1.5e-3, 1e-12, 0);
  assert_int_equal(dea_reduce(ctx, recording, NULL, &r), DEA_OK);
  assert_int_equal(r->level_count, 4);
  for (size_t l = 0; l < 4; l++) {
    double mean = r->levels[l].mean[DEA_REDUCED_DISPLACEMENT];
    assert_true(l < 3 ? mean > 4e-4 * (double)l - 1e-4 && mean < 1.4e-3 : isnan(mean));
  }
  assert_non_null(
      find_finding(ctx, DEA_NOTE, "channel 'laser' is at the end of its range in 3 of 12 cycles"));
  dea_reduction_destroy(ctx, r);
  dea_recording_destroy(ctx, recording);
  dea_protocol_destroy(ctx, protocol);
}

TESTS(set_up, tear_down)
