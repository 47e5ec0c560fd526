/* Files of such recordings in the program's own folder. */
#pragma once

#include "own_folder.h"
#include "recording_samples.h"

#include <hdf5.h>

static inline struct dea_recording *must_read(const char *name)
{
  struct dea_recording *recording;
  if (dea_recording_read(ctx, in_folder(name), &recording) != DEA_OK) {
    fail_msg("%s: %s", name, dea_context_message(ctx));
  }
  return recording;
}

/* cycles of 700 samples, a reading and a frame each, in pieces of changing length */
static inline void record(struct dea_recorder *recorder, size_t cycles)
{
  size_t done = 0;
  for (size_t i = 0; i < cycles; i++) {
    while (done < (i + 1) * SAMPLE_CYCLE) {
      size_t n = 1 + (done * 7919) % 1500;
      assert_int_equal(sample_add(recorder, done, n), DEA_OK);
      done += n;
    }
    struct dea_recorded_cycle cycle = sample_cycle(i);
    assert_int_equal(sample_add_reading(recorder, i), DEA_OK);
    assert_int_equal(sample_add_frame(recorder, i), DEA_OK);
    assert_int_equal(dea_recorder_add_cycle(recorder, &cycle), DEA_OK);
  }
}

static inline void make(const char *name, bool plain, size_t cycles, const char *ended)
{
  struct dea_recorder *recorder;
  unlink(in_folder(name));
  assert_int_equal(sample_create(ctx, in_folder(name), plain, 0, &recorder), DEA_OK);
  record(recorder, cycles);
  assert_int_equal(dea_recorder_finish(recorder, ended), DEA_OK);
}

/* What HDF5 still has open. */
static inline int nothing_open(void **state)
{
  return H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL) == 0 ? 0 : -1;
}
