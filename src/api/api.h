/* What the files of the public interface share: the objects behind its handles. */
#pragma once

#include "base/arena.h"
#include "base/context.h"
#include "base/text.h"
#include "design/design.h"
#include "io/results_h5.h"
#include "model/model.h"
#include "result/result.h"

#define DEA_INSIDE
#include "api/dea.h"

struct dea_context_handle {
  struct dea_context *inner;
  dea_context_options options;
  bool running;       // notes and warnings are told to the caller
  dea_finding *shown; // [shown_count] what dea_finding_at lends
  size_t shown_count;
  dea_model_info model; // that dea_model_at lends: one a list entry
  dea_study_info study;
  dea_law_info law;
  dea_solid_setting setting;
  char law_parameters[256];
};

/* Pairs of texts: values of a design that were set, texts of a result under their names. */
struct api_texts {
  struct dea_arena memory; // of all of it
  struct dea_override *at; // [count]
  size_t count, room;
};

struct dea_design_handle {
  dea_context *ctx; // that made it; lent
  char *name, *bytes;
  size_t length; // of bytes, which are the design as it was read
  struct api_texts settings;
  struct dea_design *inner; // with what was set
  dea_value *values;        // of inner, [inner->values.count]
  struct dea_text text, svg;
};

/* What was computed of a design as it was then. */
struct dea_result_handle {
  dea_context *ctx; // that made it; lent
  struct dea_design *design;
  struct dea_device *device;
  struct dea_run *run; // of one that was read; owns inner then
  struct dea_result *inner;
  struct dea_arena memory; // of the arrays
  dea_array **arrays;      // [array_count]
  size_t array_count, array_room;
  struct api_texts texts;
  struct api_mesh **meshes; // [mesh_count]
  size_t mesh_count;
  char *summary; // NULL: not asked for yet
  struct dea_text svg;
};

/* A mesh with what its public form points to. */
struct api_mesh {
  dea_mesh shown;
  char name[2 * DEA_NAME_SIZE];
  const struct dea_field_mesh *inner; // lent
  struct dea_field_mesh *owned;       // NULL, or inner
  struct api_mesh *whole;             // made when it is asked for; NULL: not yet
  dea_cells cells[DEA_MESH_BLOCKS_MAX];
  const dea_cells *cells_at[DEA_MESH_BLOCKS_MAX];
  dea_array arrays[DEA_MESH_FIELDS_MAX];
  dea_field fields[DEA_MESH_FIELDS_MAX];
  const dea_field *fields_at[DEA_MESH_FIELDS_MAX];
};

/* Begins a call that leaves findings: those of the last one go. */
struct dea_context *api_begin(dea_context *ctx);
/* DEA_E_ARGUMENT when an object belongs to another context. */
dea_status api_check_owner(dea_context *ctx, const dea_context *owner, const char *what);
/* Numbers of a call, as dea.h names them. values: NULL: not given. */
struct api_numbers {
  const char *name;
  const double *values; // [count]
  size_t count;
  bool endless; // infinity means something, only NAN does not
};
/* DEA_E_ARGUMENT where one is no finite number. */
dea_status api_check_numbers(dea_context *ctx, const struct api_numbers *numbers, size_t count);
/* What an older or a newer caller has filled, over the defaults of all members. */
#define DOOR_COPY(all, given)                                                                      \
  memcpy(&(all), given, (given)->size < sizeof(all) ? (given)->size : sizeof(all))
#define DOOR_CHECK(ctx, ...)                                                                       \
  DEA_TRY((ctx)->inner, api_check_numbers(ctx, (const struct api_numbers[]){__VA_ARGS__},          \
                                          sizeof((const struct api_numbers[]){__VA_ARGS__}) /      \
                                              sizeof(struct api_numbers)))
/* Room for one more item of that size in an array in the arena: where the items are now, NULL
 * without memory. */
void *api_grow(struct dea_arena *memory, void *items, size_t count, size_t *capacity, size_t size);
/* Adds a pair of copies; without memory the arena has failed. */
void api_texts_add(struct api_texts *texts, const char *key, size_t key_length, const char *value,
                   size_t value_length);

/* A design's own copy of its inner form, and its device; both owned by the caller, also after a
 * failure. Findings of the design are added. */
dea_status api_design_build(struct dea_context *ctx, const dea_design *design,
                            struct dea_design **inner, struct dea_device **device);
/* A design of a text and of what was set, "key=value" a line (NULL: nothing). */
dea_status api_design_create(dea_context *ctx, const char *name, const char *text, const char *set,
                             dea_design **out);

/* DEA_E_ARGUMENT for a model that is none. */
dea_status api_model_find(dea_context *ctx, const char *name, const struct dea_model_type **out);

/* The public form of a mesh; name: copied. inner: lent, or owned if `own`. */
dea_status api_mesh_create(struct dea_context *ctx, const char *name, double voltage_V,
                           struct dea_field_mesh *inner, bool own, struct api_mesh **out);
void api_mesh_free(struct dea_context *ctx, struct api_mesh *mesh);
