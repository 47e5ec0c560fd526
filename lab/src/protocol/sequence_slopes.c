/* How fast a sequence changes: jumps, slopes, cycles. */
#include "protocol/protocol_check.h"

#include <math.h>

static void add_jump(struct dea_protocol_slopes *out, size_t step, double jump_V)
{
  if (fabs(jump_V) > fabs(out->jump_V)) {
    out->jump_V = jump_V;
    out->jump_step = step;
  }
}

static void add_slope(struct dea_protocol_slopes *out, size_t step, const struct dea_waveform *w)
{
  struct dea_wave_extent extent;
  dea_waveform_extent(w, &extent);
  if (extent.slope_V_per_s > out->slope_V_per_s) {
    out->slope_V_per_s = extent.slope_V_per_s;
    out->slope_step = step;
  }
}

static void add_cycle(struct dea_protocol_slopes *out, size_t step, double cycle_s)
{
  if (cycle_s < out->cycle_s) {
    out->cycle_s = cycle_s;
    out->cycle_step = step;
  }
}

/* Of straight pieces: every cycle of a block is like the first one. */
static void check_pieces(struct dea_protocol_slopes *out, size_t step, const struct dea_waveform *w)
{
  const struct dea_wave_knot *before = NULL;
  for (size_t i = 0; i < w->block_count; i++) {
    const struct dea_wave_block *b = &w->blocks[i];
    const struct dea_wave_knot *first = &w->knots[b->first], *last = first + b->count - 1;
    if (before != NULL) {
      add_jump(out, step, first->value_V - before->value_V);
    }
    if (b->cycles > 1) {
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a block has knots
      add_jump(out, step, first->value_V - last->value_V);
    }
    for (const struct dea_wave_knot *k = first; k < last; k++) {
      // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a block has knots
      double time_s = (k[1].phase - k->phase) / b->frequency_Hz + k[1].offset_s - k->offset_s;
      if (!(time_s > 0)) {
        add_jump(out, step, k[1].value_V - k->value_V);
      }
    }
    add_cycle(out, step, 1 / b->frequency_Hz);
    before = last;
  }
}

void dea_protocol_slopes_find(const struct dea_protocol *protocol, struct dea_protocol_slopes *out)
{
  double before_V = 0;
  *out = (struct dea_protocol_slopes){.cycle_s = INFINITY};
  for (size_t i = 0; i < protocol->step_count; i++) {
    const struct dea_protocol_step *step = &protocol->steps[i];
    const struct dea_waveform *w = step->waveform;
    double start_V = dea_waveform_value(w, 0), end_V = dea_waveform_before(w, w->end_s);
    add_jump(out, i, start_V - before_V);
    if (step->repeat.si > 1) {
      add_jump(out, i, start_V - end_V);
    }
    add_slope(out, i, w);
    if (w->type->value != NULL) {
      add_cycle(out, i, 20 * w->longest_step_s);
    } else {
      check_pieces(out, i, w);
    }
    before_V = end_V;
    if (step->pause_s.si > 0 || i + 1 == protocol->step_count) {
      add_jump(out, i, -end_V);
      before_V = 0;
    }
  }
}
