#include "io/state_file.h"

#include "base/h5.h"
#include "base/version.h"
#include "result/provenance.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

/* A text that is written, or is to be the same: else the state is of something else. */
static void exchange_mark(struct h5 *h, hid_t object, const char *name, const char *what,
                          const char *here)
{
  char text[80];
  snprintf(text, sizeof text, "%s", here);
  dea_h5_text(h, object, name, text, sizeof text);
  if (h->status == DEA_OK && strcmp(text, here) != 0) {
    h->status = dea_fail(h->ctx, DEA_E_ARGUMENT,
                         "cannot resume from %s: the %s is another one now; run from the start "
                         "with --force",
                         h->path, what);
  }
}

static void exchange_marks(struct h5 *h, hid_t file, const char *model,
                           const struct dea_state *state)
{
  const long long schema = dea_h5_int(h, file, "schema", DEA_STATE_SCHEMA, LLONG_MIN, LLONG_MAX);
  if (h->status == DEA_OK && schema != DEA_STATE_SCHEMA) {
    h->status = dea_fail(h->ctx, DEA_E_UNSUPPORTED,
                         "%s has schema %lld of states; this version reads schema %d", h->path,
                         schema, DEA_STATE_SCHEMA);
  }
  exchange_mark(h, file, "version", "version of dea", DEA_VERSION);
  exchange_mark(h, file, "model", "model", model);
  hid_t marks = dea_h5_group(h, file, "marks");
  for (size_t i = 0; i < state->mark_count; i++) {
    const struct dea_state_mark *mark = &state->marks[i];
    char hex[65];
    dea_sha256_hex(mark->bytes, mark->size, hex);
    exchange_mark(h, marks, mark->name, mark->name, hex);
  }
  dea_h5_close(marks);
}

static void exchange_reach(struct h5 *h, hid_t file, struct dea_state_reach *reach)
{
  reach->points = (size_t)dea_h5_int(h, file, "points", (long long)reach->points, 0, LLONG_MAX);
  reach->events = (size_t)dea_h5_int(h, file, "events", (long long)reach->events, 0, LLONG_MAX);
}

/* Those of a state into the file, or such as it has from the file to out. */
static void exchange_arrays(struct h5 *h, hid_t file, const struct dea_state *state,
                            struct dea_state *out)
{
  hid_t arrays = dea_h5_group(h, file, "arrays");
  for (size_t i = 0; i < state->array_count && h->status == DEA_OK; i++) {
    struct dea_state_array array = state->arrays[i];
    double *values = h->reading ? dea_alloc(h->ctx, array.count, sizeof *values)
                                : (double *)array.values; // only read
    h->status = values == NULL ? DEA_E_MEMORY : h->status;
    dea_h5_array(h, arrays, array.name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, array.count, values,
                 "SI", "of the model alone");
    if (h->reading) {
      array.values = values;
      out->arrays[out->array_count++] = array;
    }
  }
  dea_h5_close(arrays);
}

dea_status dea_state_file_write(struct dea_context *ctx, const char *model,
                                const struct dea_state *state, struct dea_state_reach reach,
                                const char *path)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "format", "libdea state");
  exchange_marks(&h, file, model, state);
  exchange_reach(&h, file, &reach);
  exchange_arrays(&h, file, state, NULL);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  return h.status;
}

dea_status dea_state_file_read(struct dea_context *ctx, const char *model,
                               const struct dea_state *wanted, const char *path,
                               struct dea_state *out)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_open(&h, false);
  exchange_marks(&h, file, model, wanted);
  exchange_arrays(&h, file, wanted, out);
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}

dea_status dea_state_file_reach(struct dea_context *ctx, const char *path,
                                struct dea_state_reach *reach)
{
  struct h5 h;
  *reach = (struct dea_state_reach){0};
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_open(&h, false);
  exchange_reach(&h, file, reach);
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}
