/* Solids of the public interface: the engine's module by model/solid_access.h. */
#include "api/api.h"

#include "material/law.h"
#include "model/solid_access.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double bulk_share = 100; // bulk modulus over the shear modulus

// What the engine answers, in turn with other threads, with this function in the chain of calls.
#define ENGINE(ctx, call) DEA_CHAIN((ctx)->inner, DEA_SOLID_IN_TURN(call))

struct dea_solid_handle {
  dea_context *ctx; // that made it; lent
  const struct dea_solid_access *access;
  struct dea_solid_object *object;
  dea_array shown; // what dea_solid_array lends
  char name[32];
  struct api_mesh *mesh; // what dea_solid_mesh lends
};

const dea_law_info *dea_law_at(dea_context *ctx, size_t index)
{
  size_t count, used = 0;
  const struct dea_law *const *all = dea_law_all(&count);
  if (index >= count) {
    return NULL;
  }
  const struct dea_law *law = all[index];
  ctx->law_parameters[0] = '\0';
  for (size_t i = 0; i < law->param_count && used < sizeof ctx->law_parameters; i++) {
    int length = snprintf(ctx->law_parameters + used, sizeof ctx->law_parameters - used,
                          "%s%s [%s]", i > 0 ? ", " : "", law->params[i].key, law->params[i].unit);
    used += length > 0 ? (size_t)length : 0;
  }
  ctx->law = (dea_law_info){law->name, law->long_name, ctx->law_parameters, law->param_count};
  return &ctx->law;
}

static dea_status find_law(dea_context *ctx, const char *name, const struct dea_law **out)
{
  *out = dea_law_find(name);
  if (*out == NULL) {
    size_t count;
    const struct dea_law *const *all = dea_law_all(&count);
    const char *known[32];
    for (size_t i = 0; i < count && i < sizeof known / sizeof known[0]; i++) {
      known[i] = all[i]->name;
    }
    return api_unknown(ctx, "law", name, known, count);
  }
  return DEA_OK;
}

static dea_status read_law(dea_context *ctx, const dea_part *part, struct dea_part_spec *out)
{
  DEA_TRY(ctx->inner, find_law(ctx, part->law, &out->law));
  if (part->parameter_count != out->law->param_count) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the law '%s' has %zu parameters, not %zu",
                    part->law, out->law->param_count, part->parameter_count);
  }
  for (size_t i = 0; i < part->parameter_count; i++) {
    const struct dea_law_param *range = &out->law->params[i];
    if (!(part->parameters[i] >= range->min && part->parameters[i] <= range->max)) {
      return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                      "%s of the law '%s' is %g, but has to be in %g..%g", range->key, part->law,
                      part->parameters[i], range->min, range->max);
    }
    out->param[i] = part->parameters[i];
  }
  out->bulk_modulus_Pa = part->bulk_modulus_Pa > 0
                             ? part->bulk_modulus_Pa
                             : bulk_share * out->law->shear_modulus(out->param);
  return DEA_OK;
}

static dea_status read_part(dea_context *ctx, const dea_part *given, size_t number,
                            struct dea_part_spec *out)
{
  dea_part part = DEA_PART_INIT;
  memcpy(&part, given, given->size < sizeof part ? given->size : sizeof part);
  DOOR_CHECK(ctx, {"young_modulus_Pa", &part.young_modulus_Pa, 1, false},
             {"poisson_ratio", &part.poisson_ratio, 1, false},
             {"parameters", part.parameters, part.parameter_count, false},
             {"bulk_modulus_Pa", &part.bulk_modulus_Pa, 1, false},
             {"pre_stretch", &part.pre_stretch, 1, false},
             {"permittivity", &part.permittivity, 1, false},
             {"electrode_gap_m", &part.electrode_gap_m, 1, false},
             {"density_kg_per_m3", &part.density_kg_per_m3, 1, false});
  *out = (struct dea_part_spec){.young_modulus_Pa = part.young_modulus_Pa,
                                .poisson_ratio = part.poisson_ratio,
                                .pre_stretch = part.pre_stretch > 0 ? part.pre_stretch : 1,
                                .permittivity_F_per_m = part.permittivity * DEA_EPSILON_0,
                                .electrode_gap_m = part.electrode_gap_m,
                                .density_kg_per_m3 = part.density_kg_per_m3,
                                .channel_above = part.channel_above,
                                .channel_below = part.channel_below};
  if (part.law != NULL) {
    return read_law(ctx, &part, out);
  }
  if (!(part.young_modulus_Pa > 0) || !(part.poisson_ratio > -1 && part.poisson_ratio < 0.49)) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                    "part %zu has no law: Young's modulus above 0 and Poisson's ratio below 0.49 "
                    "are needed, not %g Pa and %g",
                    number, part.young_modulus_Pa, part.poisson_ratio);
  }
  return DEA_OK;
}

/* A plane mesh through plies. ones, fills: [ply_count], [fill_count], of the caller. */
static dea_status read_plies(dea_context *ctx, const dea_solid_options *o, size_t *ones,
                             struct dea_fill_spec *fills, struct dea_solid_spec *out)
{
  if (o->ply_count == 0 || o->ply_thickness_m == NULL || o->fill_count == 0 || o->fills == NULL) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                    "a plane mesh needs plies, and fills that say which part is where");
  }
  for (size_t i = 0; i < o->ply_count; i++) {
    ones[i] = o->ply_elements != NULL ? o->ply_elements[i] : 1;
    if (!(o->ply_thickness_m[i] > 0) || ones[i] == 0 || ones[i] > 1000) {
      return dea_fail(ctx->inner, DEA_E_ARGUMENT, "ply %zu of %g m and %zu elements", i,
                      o->ply_thickness_m[i], ones[i]);
    }
  }
  for (size_t i = 0; i < o->fill_count; i++) {
    fills[i] = (struct dea_fill_spec){o->fills[i].ply, o->fills[i].group, o->fills[i].part};
  }
  out->msh_file = o->msh_file;
  out->msh_unit_m = o->msh_unit_m > 0 ? o->msh_unit_m : 1e-3;
  out->ply_count = o->ply_count;
  out->ply_thickness_m = o->ply_thickness_m;
  out->ply_elements = ones;
  out->fill_count = o->fill_count;
  out->fills = fills;
  return DEA_OK;
}

/* What the module is asked for; parts: [part_count], of the caller. */
static dea_status read_options(dea_context *ctx, const dea_solid_options *o,
                               struct dea_part_spec *parts, struct dea_solid_spec *out)
{
  bool box = o->msh_file == NULL && o->elements[0] > 0 && o->elements[1] > 0 && o->elements[2] > 0;
  *out = (struct dea_solid_spec){.order = dea_mesh_order(o->order),
                                 .order_z = dea_mesh_order(o->order_z),
                                 .part_count = o->part_count,
                                 .parts = parts};
  DOOR_CHECK(ctx, {"box_m", o->box_m, 3, false}, {"msh_unit_m", &o->msh_unit_m, 1, false},
             {"ply_thickness_m", o->ply_thickness_m, o->ply_count, false});
  if (out->order > 3 || out->order_z > 3) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the order of elements is 1 to 3");
  }
  if (box && (!(o->box_m[0] > 0) || !(o->box_m[1] > 0) || !(o->box_m[2] > 0))) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "a box of %g x %g x %g m", o->box_m[0], o->box_m[1],
                    o->box_m[2]);
  }
  if (!box && o->msh_file == NULL &&
      (o->point_count == 0 || o->cell_count == 0 || o->points_m == NULL || o->cells == NULL ||
       o->point_count > 100000000)) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                    "a mesh is a box with elements, points and cells, or a .msh file with plies");
  }
  if (box) {
    memcpy(out->box_m, o->box_m, sizeof out->box_m);
    memcpy(out->elements, o->elements, sizeof out->elements);
  } else {
    out->point_count = o->point_count;
    out->points_m = o->points_m;
    out->cell_count = o->cell_count;
    out->cells = o->cells;
    out->part_of = o->part_of;
  }
  for (size_t i = 0; i < o->part_count; i++) {
    DEA_TRY(ctx->inner, read_part(ctx, o->parts[i], i, &parts[i]));
  }
  return DEA_OK;
}

/* bodies: [body_count] places and copies that those lend from, of the caller. */
static dea_status read_bodies(dea_context *ctx, const dea_solid_options *o, dea_body *copies,
                              struct dea_body_spec *bodies, struct dea_solid_spec *out)
{
  static const dea_body all = DEA_BODY_INIT;
  for (size_t i = 0; i < o->body_count; i++) {
    size_t size = o->bodies[i]->size;
    copies[i] = all;
    memcpy(&copies[i], o->bodies[i], size < sizeof all ? size : sizeof all);
    // NOLINTBEGIN(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c): as it was made
    bool everywhere = memcmp(copies[i].low_m, copies[i].high_m, sizeof all.low_m) == 0 &&
                      memcmp(copies[i].low_m, all.low_m, sizeof all.low_m) == 0;
    // NOLINTEND(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c)
    bodies[i] = (struct dea_body_spec){.low_m = everywhere ? NULL : copies[i].low_m,
                                       .high_m = everywhere ? NULL : copies[i].high_m,
                                       .curve = copies[i].curve,
                                       .nodes = copies[i].nodes,
                                       .node_count = copies[i].node_count};
    DOOR_CHECK(ctx, {"low_m", copies[i].low_m, 3, true}, {"high_m", copies[i].high_m, 3, true},
               {"centre_m", copies[i].centre_m, 3, false});
    memcpy(bodies[i].centre_m, copies[i].centre_m, sizeof bodies[i].centre_m);
  }
  out->body_count = o->body_count;
  out->bodies = bodies;
  return DEA_OK;
}

dea_status dea_solid_new(dea_context *ctx, const dea_solid_options *options, dea_solid **out)
{
  struct dea_context *inner = api_begin(ctx);
  dea_solid_options all = DEA_SOLID_OPTIONS_INIT;
  *out = NULL;
  memcpy(&all, options, options->size < sizeof all ? options->size : sizeof all);
  if (all.part_count == 0 || all.parts == NULL) {
    return dea_fail(inner, DEA_E_ARGUMENT, "a solid needs a part: what it is made of");
  }
  struct dea_solid_spec spec;
  dea_solid *solid = dea_alloc(inner, 1, sizeof *solid);
  struct dea_part_spec *parts = dea_alloc(inner, all.part_count, sizeof *parts);
  struct dea_fill_spec *fills = dea_alloc(inner, all.fill_count, sizeof *fills);
  size_t *ply_elements = dea_alloc(inner, all.ply_count, sizeof *ply_elements);
  dea_body *copies = dea_alloc(inner, all.body_count, sizeof *copies);
  struct dea_body_spec *bodies = dea_alloc(inner, all.body_count, sizeof *bodies);
  bool enough = solid != NULL && parts != NULL && fills != NULL && ply_elements != NULL &&
                copies != NULL && bodies != NULL;
  dea_status status = enough ? read_options(ctx, &all, parts, &spec) : DEA_E_MEMORY;
  status = status == DEA_OK ? read_bodies(ctx, &all, copies, bodies, &spec) : status;
  if (status == DEA_OK && all.msh_file != NULL) {
    status = read_plies(ctx, &all, ply_elements, fills, &spec);
  }
  status = status == DEA_OK ? dea_solid_access_open(inner, &solid->access) : status;
  status = status == DEA_OK ? DEA_SOLID_IN_TURN(solid->access->create(inner, &spec, &solid->object))
                            : status;
  dea_free(inner, bodies);
  dea_free(inner, copies);
  dea_free(inner, ply_elements);
  dea_free(inner, fills);
  dea_free(inner, parts);
  if (status != DEA_OK) {
    dea_free(inner, solid);
    return dea_fail_chain(inner, status, __func__, __FILE__, __LINE__);
  }
  solid->ctx = ctx;
  *out = solid;
  return DEA_OK;
}

void dea_solid_free(dea_solid *solid)
{
  if (solid != NULL) {
    api_mesh_free(solid->ctx->inner, solid->mesh);
    dea_solid_enter();
    solid->access->destroy(solid->ctx->inner, solid->object);
    dea_solid_leave(DEA_OK);
    dea_free(solid->ctx->inner, solid);
  }
}

/* Begins a call that changes the solid. */
static dea_status begin(dea_context *ctx, const dea_solid *solid)
{
  api_begin(ctx);
  return api_check_owner(ctx, solid->ctx, "solid");
}

/* Holds what lies at a place. */
static dea_status hold(dea_context *ctx, const dea_solid *solid, struct dea_solid_place place,
                       int components, const double displacement_m[3])
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"low_m", place.low_m, 3, true}, {"high_m", place.high_m, 3, true},
             {"displacement_m", displacement_m, 3, false});
  return ENGINE(ctx,
                solid->access->hold(ctx->inner, solid->object, place, components, displacement_m));
}

dea_status dea_solid_hold(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], int components, const double displacement_m[3])
{
  return hold(ctx, solid, (struct dea_solid_place){low_m, high_m, NULL, NULL, 0}, components,
              displacement_m);
}

dea_status dea_solid_hold_nodes(dea_context *ctx, dea_solid *solid, const int *nodes, size_t count,
                                int components, const double displacement_m[3])
{
  return hold(ctx, solid, (struct dea_solid_place){NULL, NULL, NULL, nodes, count}, components,
              displacement_m);
}

dea_status dea_solid_hold_curve(dea_context *ctx, dea_solid *solid, const char *curve,
                                const double low_m[3], const double high_m[3], int components,
                                const double displacement_m[3])
{
  if ((low_m == NULL) != (high_m == NULL)) {
    return dea_fail(api_begin(ctx), DEA_E_ARGUMENT, "a box has two corners");
  }
  return hold(ctx, solid, (struct dea_solid_place){low_m, high_m, curve, NULL, 0}, components,
              displacement_m);
}

dea_status dea_solid_hold_body(dea_context *ctx, dea_solid *solid, size_t body, int components,
                               const double shift_m[3], const double turn_rad[3])
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"shift_m", shift_m, 3, false}, {"turn_rad", turn_rad, 3, false});
  return ENGINE(ctx, solid->access->hold_body(ctx->inner, solid->object, body, components, shift_m,
                                              turn_rad));
}

dea_status dea_solid_push_body(dea_context *ctx, dea_solid *solid, size_t body,
                               const double force_N[3], const double moment_N_m[3])
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"force_N", force_N, 3, false}, {"moment_N_m", moment_N_m, 3, false});
  return ENGINE(ctx,
                solid->access->push_body(ctx->inner, solid->object, body, force_N, moment_N_m));
}

dea_status dea_solid_add_spring(dea_context *ctx, dea_solid *solid, const dea_body_spring *spring)
{
  dea_body_spring all = DEA_BODY_SPRING_INIT;
  DEA_TRY(ctx->inner, begin(ctx, solid));
  memcpy(&all, spring, spring->size < sizeof all ? spring->size : sizeof all);
  DOOR_CHECK(ctx, {"place", &all.place, 1, false}, {"stiffness", &all.stiffness, 1, false},
             {"at", all.at, all.count, false}, {"force", all.force, all.count, false});
  struct dea_spring_spec spec = {.body = all.body,
                                 .place = all.place,
                                 .stiffness = all.stiffness,
                                 .count = all.count,
                                 .at = all.at,
                                 .force = all.force};
  while (spec.component < 6 && all.component != 1 << spec.component) {
    spec.component++;
  }
  return ENGINE(ctx, solid->access->add_spring(ctx->inner, solid->object, &spec));
}

dea_status dea_solid_move_spring(dea_context *ctx, dea_solid *solid, size_t spring, double place)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"place", &place, 1, false});
  return ENGINE(ctx, solid->access->move_spring(ctx->inner, solid->object, spring, place));
}

dea_status dea_solid_pull(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], const double traction_Pa[3])
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"low_m", low_m, 3, true}, {"high_m", high_m, 3, true},
             {"traction_Pa", traction_Pa, 3, false});
  return ENGINE(ctx, solid->access->pull(ctx->inner, solid->object,
                                         (struct dea_solid_place){low_m, high_m, NULL, NULL, 0},
                                         traction_Pa));
}

dea_status dea_solid_set_channel(dea_context *ctx, dea_solid *solid, int channel, double voltage_V)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"voltage_V", &voltage_V, 1, false});
  return ENGINE(ctx, solid->access->set_channel(ctx->inner, solid->object, channel, voltage_V));
}

dea_status dea_solid_find_charges(dea_context *ctx, dea_solid *solid)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return ENGINE(ctx, solid->access->find_charges(ctx->inner, solid->object));
}

const dea_solid_setting *dea_solid_setting_at(dea_context *ctx, const dea_solid *solid,
                                              size_t index)
{
  const char *text[3];
  double value;
  if (!solid->access->setting(solid->object, index, text, &value)) {
    return NULL;
  }
  ctx->setting = (dea_solid_setting){text[0], text[1], text[2], value};
  return &ctx->setting;
}

dea_status dea_solid_set(dea_context *ctx, dea_solid *solid, const char *name, double value)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"value", &value, 1, false});
  return ENGINE(ctx, solid->access->set(ctx->inner, solid->object, name, value));
}

dea_status dea_solid_solve(dea_context *ctx, dea_solid *solid, double voltage_V)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"voltage_V", &voltage_V, 1, false});
  return ENGINE(ctx, solid->access->solve(ctx->inner, solid->object, voltage_V));
}

dea_status dea_solid_modes(dea_context *ctx, dea_solid *solid, size_t count)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return ENGINE(ctx, solid->access->modes(ctx->inner, solid->object, count));
}

dea_status dea_solid_path_begin(dea_context *ctx, dea_solid *solid, double voltage_V, double step,
                                double unit_m)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  DOOR_CHECK(ctx, {"voltage_V", &voltage_V, 1, false}, {"step", &step, 1, false},
             {"unit_m", &unit_m, 1, false});
  return ENGINE(ctx, solid->access->path(ctx->inner, solid->object, voltage_V, step, unit_m));
}

dea_status dea_solid_path_step(dea_context *ctx, dea_solid *solid)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return ENGINE(ctx, solid->access->step(ctx->inner, solid->object));
}

dea_status dea_solid_array(dea_context *ctx, dea_solid *solid, const char *name,
                           const dea_array **out)
{
  static const char *const known[] = {"points_m",         "displacement_m",  "reaction_N",
                                      "force_N",          "mode_Hz",         "mode_shape",
                                      "channel_V",        "charge_C",        "capacitance_held_F",
                                      "capacitance_F",    "body_shift_m",    "body_turn_rad",
                                      "body_force_N",     "body_moment_N_m", "spring_force_N",
                                      "spring_moment_N_m"};
  const char *unit = "";
  size_t shape[3] = {0, 0, 0};
  *out = NULL;
  dea_solid_enter();
  const double *data = solid->access->array(solid->object, name, &unit, shape);
  dea_solid_leave(DEA_OK);
  if (data == NULL) {
    return api_unknown(ctx, "array", name, known, sizeof known / sizeof known[0]);
  }
  snprintf(solid->name, sizeof solid->name, "%s", name);
  solid->shown = (dea_array){.name = solid->name, .unit = unit, .meaning = "", .data = data};
  for (int i = 0; i < 3; i++) {
    solid->shown.rank += shape[i] > 0;
    solid->shown.shape[i] = shape[i] > 0 ? shape[i] : 1;
  }
  *out = &solid->shown;
  return DEA_OK;
}

dea_status dea_solid_mesh(dea_context *ctx, dea_solid *solid, const dea_mesh **out)
{
  struct dea_field_mesh *mesh;
  double voltage_V = NAN;
  *out = NULL;
  DEA_TRY(ctx->inner, begin(ctx, solid));
  api_mesh_free(ctx->inner, solid->mesh);
  solid->mesh = NULL;
  (void)solid->access->number(solid->object, "voltage_V", &voltage_V);
  DEA_TRY(ctx->inner, DEA_SOLID_IN_TURN(solid->access->mesh(ctx->inner, solid->object, &mesh)));
  DEA_TRY(ctx->inner, api_mesh_create(ctx->inner, "solid", voltage_V, mesh, true, &solid->mesh));
  *out = &solid->mesh->shown;
  return DEA_OK;
}

dea_status dea_solid_number(dea_context *ctx, const dea_solid *solid, const char *name, double *out)
{
  static const char *const known[] = {"voltage_V",  "energy_J", "unstable_modes",
                                      "iterations", "load",     "arc"};
  *out = NAN;
  return solid->access->number(solid->object, name, out)
             ? DEA_OK
             : api_unknown(ctx, "number", name, known, sizeof known / sizeof known[0]);
}
