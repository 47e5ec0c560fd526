/* Solids of the public interface: the engine's module by api/own_mesh.h. */
#include "api/own_mesh.h"

#include "material/law.h"
#include "model/solid_module.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double bulk_share = 100; // bulk modulus over the shear modulus

struct dea_solid_handle {
  dea_context *ctx; // that made it; lent
  const struct dea_own_mesh *engine;
  struct dea_solid_object *object;
  dea_array shown;       // what dea_solid_array lends
  struct api_mesh *mesh; // what dea_solid_mesh lends
};

/* A call of the engine's function of that name. */
#define IN_TURN(solid, name, ...)                                                                  \
  DEA_CHAIN((solid)->ctx->inner,                                                                   \
            DEA_SOLID_IN_TURN((solid)->engine->name((solid)->ctx->inner, __VA_ARGS__)))
/* Begins a call that changes the solid, with the numbers that it was given. */
#define BEGIN(ctx, solid, ...)                                                                     \
  do {                                                                                             \
    DEA_TRY((ctx)->inner, begin(ctx, solid));                                                      \
    DOOR_CHECK(ctx, __VA_ARGS__);                                                                  \
  } while (0)

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
    return dea_unknown_name(ctx->inner, "law", name, known, count);
  }
  return DEA_OK;
}

static dea_status begin(dea_context *ctx, const dea_solid *solid)
{
  api_begin(ctx);
  return api_check_owner(ctx, solid->ctx, "solid");
}

static dea_status read_law(dea_context *ctx, dea_part *part)
{
  const struct dea_law *law;
  DEA_TRY(ctx->inner, find_law(ctx, part->law, &law));
  if (part->parameter_count != law->param_count) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "the law '%s' has %zu parameters, not %zu",
                    part->law, law->param_count, part->parameter_count);
  }
  for (size_t i = 0; i < part->parameter_count; i++) {
    const struct dea_law_param *range = &law->params[i];
    if (!(part->parameters[i] >= range->min && part->parameters[i] <= range->max)) {
      return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                      "%s of the law '%s' is %g, but has to be in %g..%g", range->key, part->law,
                      part->parameters[i], range->min, range->max);
    }
  }
  if (!(part->bulk_modulus_Pa > 0)) {
    part->bulk_modulus_Pa = bulk_share * law->shear_modulus(part->parameters);
  }
  return DEA_OK;
}

/* Checks a part, and sets what was left to its default. */
static dea_status read_part(dea_context *ctx, size_t number, dea_part *part)
{
  DOOR_CHECK(ctx, {"young_modulus_Pa", &part->young_modulus_Pa, 1, false},
             {"poisson_ratio", &part->poisson_ratio, 1, false},
             {"parameters", part->parameters, part->parameter_count, false},
             {"bulk_modulus_Pa", &part->bulk_modulus_Pa, 1, false},
             {"pre_stretch", &part->pre_stretch, 1, false},
             {"permittivity", &part->permittivity, 1, false},
             {"electrode_gap_m", &part->electrode_gap_m, 1, false},
             {"density_kg_per_m3", &part->density_kg_per_m3, 1, false});
  part->pre_stretch = part->pre_stretch > 0 ? part->pre_stretch : 1;
  if (part->law != NULL) {
    return read_law(ctx, part);
  }
  if (!(part->young_modulus_Pa > 0) || !(part->poisson_ratio > -1 && part->poisson_ratio < 0.49)) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                    "part %zu has no law: Young's modulus above 0 and Poisson's ratio below 0.49 "
                    "are needed, not %g Pa and %g",
                    number, part->young_modulus_Pa, part->poisson_ratio);
  }
  return DEA_OK;
}

static dea_status check_plies(dea_context *ctx, const dea_solid_options *o)
{
  if (o->ply_count == 0 || o->ply_thickness_m == NULL || o->fill_count == 0 || o->fills == NULL) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT,
                    "a plane mesh needs plies, and fills that say which part is where");
  }
  for (size_t i = 0; i < o->ply_count; i++) {
    const size_t through = o->ply_elements != NULL ? o->ply_elements[i] : 1;
    if (!(o->ply_thickness_m[i] > 0) || through == 0 || through > 1000) {
      return dea_fail(ctx->inner, DEA_E_ARGUMENT, "ply %zu of %g m and %zu elements", i,
                      o->ply_thickness_m[i], through);
    }
  }
  return DEA_OK;
}

/* Checks what kind of a mesh is asked for, and sets what was left to its default. */
static dea_status read_mesh(dea_context *ctx, dea_solid_options *o)
{
  bool box = o->msh_file == NULL && o->elements[0] > 0 && o->elements[1] > 0 && o->elements[2] > 0;
  o->order = dea_mesh_order(o->order);
  o->order_z = dea_mesh_order(o->order_z);
  o->msh_unit_m = o->msh_unit_m > 0 ? o->msh_unit_m : 1e-3;
  o->elements[0] = box ? o->elements[0] : 0;
  DOOR_CHECK(ctx, {"box_m", o->box_m, 3, false}, {"msh_unit_m", &o->msh_unit_m, 1, false},
             {"ply_thickness_m", o->ply_thickness_m, o->ply_count, false});
  if (o->order > 3 || o->order_z > 3) {
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
  return DEA_OK;
}

/* parts, bodies: those of the options, of the caller. */
static dea_status read_options(dea_context *ctx, dea_solid_options *o, dea_part *parts,
                               dea_body *bodies)
{
  DEA_TRY(ctx->inner, read_mesh(ctx, o));
  for (size_t i = 0; i < o->part_count; i++) {
    parts[i] = (dea_part)DEA_PART_INIT;
    DOOR_COPY(parts[i], o->parts[i]);
    DEA_TRY(ctx->inner, read_part(ctx, i, &parts[i]));
  }
  for (size_t i = 0; i < o->body_count; i++) {
    bodies[i] = (dea_body)DEA_BODY_INIT;
    DOOR_COPY(bodies[i], o->bodies[i]);
    DOOR_CHECK(ctx, {"low_m", bodies[i].low_m, 3, true}, {"high_m", bodies[i].high_m, 3, true},
               {"centre_m", bodies[i].centre_m, 3, false});
  }
  return o->msh_file != NULL ? check_plies(ctx, o) : DEA_OK;
}

dea_status dea_solid_new(dea_context *ctx, const dea_solid_options *options, dea_solid **out)
{
  struct dea_context *inner = api_begin(ctx);
  dea_solid_options all = DEA_SOLID_OPTIONS_INIT;
  const void *engine = NULL;
  *out = NULL;
  DOOR_COPY(all, options);
  if (all.part_count == 0 || all.parts == NULL) {
    return dea_fail(inner, DEA_E_ARGUMENT, "a solid needs a part: what it is made of");
  }
  dea_solid *solid = dea_alloc(inner, 1, sizeof *solid);
  dea_part *parts = dea_alloc(inner, all.part_count, sizeof *parts);
  dea_body *bodies = dea_alloc(inner, all.body_count, sizeof *bodies);
  bool enough = solid != NULL && parts != NULL && bodies != NULL;
  dea_status status = enough ? read_options(ctx, &all, parts, bodies) : DEA_E_MEMORY;
  status = status == DEA_OK ? dea_solid_module_symbol(inner, "dea_own_mesh", &engine) : status;
  if (status == DEA_OK) {
    solid->ctx = ctx;
    solid->engine = engine;
    status = IN_TURN(solid, create, &all, parts, bodies, &solid->object);
  }
  dea_free(inner, bodies);
  dea_free(inner, parts);
  DEA_TRY_ELSE(inner, status, dea_free(inner, solid));
  *out = solid;
  return DEA_OK;
}

void dea_solid_free(dea_solid *solid)
{
  if (solid != NULL) {
    api_mesh_free(solid->ctx->inner, solid->mesh);
    dea_solid_enter();
    solid->engine->destroy(solid->ctx->inner, solid->object);
    dea_solid_leave(DEA_OK);
    dea_free(solid->ctx->inner, solid);
  }
}

static dea_status hold(dea_context *ctx, dea_solid *solid, struct dea_solid_place place,
                       int components, const double displacement_m[3])
{
  BEGIN(ctx, solid, {"low_m", place.low_m, 3, true}, {"high_m", place.high_m, 3, true},
        {"displacement_m", displacement_m, 3, false});
  if ((place.low_m == NULL) != (place.high_m == NULL)) {
    return dea_fail(ctx->inner, DEA_E_ARGUMENT, "a box has two corners");
  }
  return IN_TURN(solid, hold, solid->object, place, components, displacement_m);
}

dea_status dea_solid_hold(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], int components, const double displacement_m[3])
{
  const struct dea_solid_place place = {.low_m = low_m, .high_m = high_m};
  return hold(ctx, solid, place, components, displacement_m);
}

dea_status dea_solid_hold_nodes(dea_context *ctx, dea_solid *solid, const int *nodes, size_t count,
                                int components, const double displacement_m[3])
{
  const struct dea_solid_place place = {.nodes = nodes, .node_count = count};
  return hold(ctx, solid, place, components, displacement_m);
}

dea_status dea_solid_hold_curve(dea_context *ctx, dea_solid *solid, const char *curve,
                                const double low_m[3], const double high_m[3], int components,
                                const double displacement_m[3])
{
  const struct dea_solid_place place = {.low_m = low_m, .high_m = high_m, .curve = curve};
  return hold(ctx, solid, place, components, displacement_m);
}

dea_status dea_solid_hold_body(dea_context *ctx, dea_solid *solid, size_t body, int components,
                               const double shift_m[3], const double turn_rad[3])
{
  BEGIN(ctx, solid, {"shift_m", shift_m, 3, false}, {"turn_rad", turn_rad, 3, false});
  return IN_TURN(solid, hold_body, solid->object, body, components, shift_m, turn_rad);
}

dea_status dea_solid_push_body(dea_context *ctx, dea_solid *solid, size_t body,
                               const double force_N[3], const double moment_N_m[3])
{
  BEGIN(ctx, solid, {"force_N", force_N, 3, false}, {"moment_N_m", moment_N_m, 3, false});
  return IN_TURN(solid, push_body, solid->object, body, force_N, moment_N_m);
}

dea_status dea_solid_add_spring(dea_context *ctx, dea_solid *solid, const dea_body_spring *spring)
{
  dea_body_spring all = DEA_BODY_SPRING_INIT;
  DOOR_COPY(all, spring);
  BEGIN(ctx, solid, {"place", &all.place, 1, false}, {"stiffness", &all.stiffness, 1, false},
        {"at", all.at, all.count, false}, {"force", all.force, all.count, false});
  return IN_TURN(solid, add_spring, solid->object, &all);
}

dea_status dea_solid_move_spring(dea_context *ctx, dea_solid *solid, size_t spring, double place)
{
  BEGIN(ctx, solid, {"place", &place, 1, false});
  return IN_TURN(solid, move_spring, solid->object, spring, place);
}

dea_status dea_solid_pull(dea_context *ctx, dea_solid *solid, const double low_m[3],
                          const double high_m[3], const double traction_Pa[3])
{
  const struct dea_solid_place place = {.low_m = low_m, .high_m = high_m};
  BEGIN(ctx, solid, {"low_m", low_m, 3, true}, {"high_m", high_m, 3, true},
        {"traction_Pa", traction_Pa, 3, false});
  return IN_TURN(solid, pull, solid->object, place, traction_Pa);
}

dea_status dea_solid_set_channel(dea_context *ctx, dea_solid *solid, int channel, double voltage_V)
{
  BEGIN(ctx, solid, {"voltage_V", &voltage_V, 1, false});
  return IN_TURN(solid, set_channel, solid->object, channel, voltage_V);
}

dea_status dea_solid_find_charges(dea_context *ctx, dea_solid *solid)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return IN_TURN(solid, find_charges, solid->object);
}

const dea_solid_setting *dea_solid_setting_at(dea_context *ctx, const dea_solid *solid,
                                              size_t index)
{
  return solid->engine->setting(solid->object, index, &ctx->setting) ? &ctx->setting : NULL;
}

dea_status dea_solid_set(dea_context *ctx, dea_solid *solid, const char *name, double value)
{
  BEGIN(ctx, solid, {"value", &value, 1, false});
  return IN_TURN(solid, set, solid->object, name, value);
}

dea_status dea_solid_solve(dea_context *ctx, dea_solid *solid, double voltage_V)
{
  BEGIN(ctx, solid, {"voltage_V", &voltage_V, 1, false});
  return IN_TURN(solid, solve, solid->object, voltage_V);
}

dea_status dea_solid_modes(dea_context *ctx, dea_solid *solid, size_t count)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return IN_TURN(solid, modes, solid->object, count);
}

dea_status dea_solid_path_begin(dea_context *ctx, dea_solid *solid, double voltage_V, double step,
                                double unit_m)
{
  BEGIN(ctx, solid, {"voltage_V", &voltage_V, 1, false}, {"step", &step, 1, false},
        {"unit_m", &unit_m, 1, false});
  return IN_TURN(solid, path, solid->object, voltage_V, step, unit_m);
}

dea_status dea_solid_path_step(dea_context *ctx, dea_solid *solid)
{
  DEA_TRY(ctx->inner, begin(ctx, solid));
  return IN_TURN(solid, step, solid->object);
}

dea_status dea_solid_array(dea_context *ctx, dea_solid *solid, const char *name,
                           const dea_array **out)
{
  *out = NULL;
  DEA_TRY(ctx->inner,
          DEA_SOLID_IN_TURN(solid->engine->array(ctx->inner, solid->object, name, &solid->shown)));
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
  DEA_TRY(ctx->inner, solid->engine->number(ctx->inner, solid->object, "voltage_V", &voltage_V));
  DEA_TRY(ctx->inner, DEA_SOLID_IN_TURN(solid->engine->mesh(ctx->inner, solid->object, &mesh)));
  DEA_TRY(ctx->inner, api_mesh_create(ctx->inner, "solid", voltage_V, mesh, true, &solid->mesh));
  *out = &solid->mesh->shown;
  return DEA_OK;
}

dea_status dea_solid_number(dea_context *ctx, const dea_solid *solid, const char *name, double *out)
{
  *out = NAN;
  return solid->engine->number(ctx->inner, solid->object, name, out);
}
