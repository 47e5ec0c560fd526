#include "io/state_file.h"

#include "base/h5.h"
#include "base/version.h"
#include "result/provenance.h"

#include <string.h>

dea_status dea_state_file_write(struct dea_context *ctx, const char *model,
                                const struct dea_state *state, struct dea_state_reach reach,
                                const char *path)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "format", "libdea state");
  dea_h5_write_int(&h, file, "schema", DEA_STATE_SCHEMA);
  dea_h5_write_text(&h, file, "version", DEA_VERSION);
  dea_h5_write_text(&h, file, "model", model);
  dea_h5_write_int(&h, file, "points", (long long)reach.points);
  dea_h5_write_int(&h, file, "events", (long long)reach.events);
  hid_t marks = dea_h5_group_create(&h, file, "marks");
  for (size_t i = 0; i < state->mark_count; i++) {
    char hex[65];
    dea_sha256_hex(state->marks[i].bytes, state->marks[i].size, hex);
    dea_h5_write_text(&h, marks, state->marks[i].name, hex);
  }
  dea_h5_close(marks);
  hid_t arrays = dea_h5_group_create(&h, file, "arrays");
  for (size_t i = 0; i < state->array_count; i++) {
    dea_h5_write_array(&h, arrays, state->arrays[i].name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE,
                       state->arrays[i].count, state->arrays[i].values, "SI", "of the model alone");
  }
  dea_h5_close(arrays);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  return h.status;
}

/* "the mesh differs": refuses a state that was left by or for something else. */
static void check_same(struct h5 *h, const char *what, const char *there, const char *here)
{
  if (h->status == DEA_OK && strcmp(there, here) != 0) {
    h->status = dea_fail(h->ctx, DEA_E_ARGUMENT,
                         "cannot resume from %s: the %s is another one now; run from the start "
                         "with --force",
                         h->path, what);
  }
}

static void check_marks(struct h5 *h, hid_t file, const char *model, const struct dea_state *state)
{
  char text[80];
  long long schema = dea_h5_get_int(h, file, "schema");
  if (h->status == DEA_OK && schema != DEA_STATE_SCHEMA) {
    h->status = dea_fail(h->ctx, DEA_E_UNSUPPORTED,
                         "%s has schema %lld of states; this version reads schema %d", h->path,
                         schema, DEA_STATE_SCHEMA);
  }
  dea_h5_get_text(h, file, "version", text, sizeof text);
  check_same(h, "version of dea", text, DEA_VERSION);
  dea_h5_get_text(h, file, "model", text, sizeof text);
  check_same(h, "model", text, model);
  hid_t marks = dea_h5_group_open(h, file, "marks");
  for (size_t i = 0; i < state->mark_count; i++) {
    char hex[65];
    dea_sha256_hex(state->marks[i].bytes, state->marks[i].size, hex);
    dea_h5_get_text(h, marks, state->marks[i].name, text, sizeof text);
    check_same(h, state->marks[i].name, text, hex);
  }
  dea_h5_close(marks);
}

/* Reads the arrays that a model wants. */
static void read_arrays(struct h5 *h, hid_t file, const struct dea_state *wanted,
                        struct dea_state *out)
{
  hid_t arrays = dea_h5_group_open(h, file, "arrays");
  for (size_t i = 0; i < wanted->array_count && h->status == DEA_OK; i++) {
    const struct dea_state_array *array = &wanted->arrays[i];
    double *values = dea_alloc(h->ctx, array->count, sizeof *values);
    if (values == NULL) {
      h->status = DEA_E_MEMORY;
    }
    dea_h5_get_array(h, arrays, array->name, H5T_NATIVE_DOUBLE, array->count, values);
    out->arrays[i] = (struct dea_state_array){array->name, array->count, values};
    out->array_count = i + 1;
  }
  dea_h5_close(arrays);
}

dea_status dea_state_file_read(struct dea_context *ctx, const char *model,
                               const struct dea_state *wanted, const char *path,
                               struct dea_state *out)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_open(&h, false);
  check_marks(&h, file, model, wanted);
  read_arrays(&h, file, wanted, out);
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}

static size_t get_count(struct h5 *h, hid_t file, const char *name)
{
  const long long count = dea_h5_get_int(h, file, name);
  return h->status == DEA_OK && count > 0 ? (size_t)count : 0;
}

dea_status dea_state_file_reach(struct dea_context *ctx, const char *path,
                                struct dea_state_reach *reach)
{
  struct h5 h;
  dea_h5_begin(&h, ctx, path);
  hid_t file = dea_h5_file_open(&h, false);
  reach->points = get_count(&h, file, "points");
  reach->events = get_count(&h, file, "events");
  dea_h5_close(file);
  dea_h5_end(&h);
  return h.status;
}
