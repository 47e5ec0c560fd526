#include "lab/drive/drive.h"

#include "lab/drive/drive_loop.h"

#include <math.h>

/* Besides slewing and charging: filters of amplifier and inputs. */
static const double settle_s = 0.02, stall_s = 3;

struct opened {
  struct dea_instrument *instruments[DEA_PROTOCOL_INSTRUMENTS_MAX];
  size_t count;
};

static dea_status open_all(struct dea_context *ctx, const struct dea_protocol *protocol,
                           bool simulate, struct opened *opened)
{
  const struct dea_protocol_instrument *sections = protocol->instruments;
  size_t count = protocol->instrument_count;
  if (simulate) {
    sections = &protocol->sim;
    count = 1;
  } else if (count == 0) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s names no instruments: add a section 'instruments', or play on the "
                    "simulated bench",
                    protocol->file);
  }
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_instrument_open(ctx, &sections[i], protocol, &opened->instruments[i]));
    opened->count++;
  }
  return DEA_OK;
}

dea_status dea_drive_run(struct dea_context *ctx, const struct dea_protocol *protocol,
                         const struct dea_drive_options *options, struct dea_drive_report *out)
{
  struct dea_protocol_plan plan;
  struct opened opened = {.count = 0};
  *out = (struct dea_drive_report){.largest_current_A = NAN, .zero.volts = NAN};
  DEA_TRY(ctx, dea_protocol_check(ctx, protocol, &plan));
  dea_status status = open_all(ctx, protocol, options->simulate, &opened);
  if (status == DEA_OK) {
    struct dea_drive_bench bench = {opened.instruments, opened.count,
                                    settle_s + (isfinite(plan.rise_s) ? 2 * plan.rise_s : 0),
                                    stall_s};
    status = dea_drive_play(ctx, protocol, &bench, options->file, out);
  } else {
    out->zero.state = status == DEA_E_INTERLOCK ? DEA_ZERO_UNKNOWN : DEA_ZERO_NONE;
    // what is set up already must not stay as it is: a supply's output may be on
    for (size_t i = 0; i < opened.count; i++) {
      dea_drive_take_zero(protocol, dea_instrument_stop(ctx, opened.instruments[i]), out);
    }
  }
  for (size_t i = opened.count; i-- > 0;) {
    opened.instruments[i]->type->close(ctx, opened.instruments[i]);
  }
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
