/* Study "states": the stable equilibria of a film that has lost its tension, at a few voltages, how
 * each is reached, where each ends, and the band of what a sensor reads over them
 * (docs/theory/states.md). */
#include "base/schema.h"
#include "base/sort.h"
#include "study/observe.h"
#include "study/variant.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char study_name[] = "states";

// Keys -------------------------------------------------------------------------------------------

enum { PUSHES_MAX = 6 };

/* Settings of compute.states. */
struct settings {
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: quarters of the highest
  struct dea_quantity pushes_m[PUSHES_MAX];             // rising
  size_t voltage_count, push_count;
  struct dea_quantity modes, most, apart_m;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    DEA_STUDY_STOPS_FIELD("quarters of the highest",
                          "voltages at which states are looked for; they are followed up and down "
                          "between neighbours",
                          "[7 kV, 7.5 kV, 8 kV]"),
    DEA_INTEGER_ROW("modes", AT(modes), "6",
                    "softest motions of each state that it is pushed along, to either side",
                    .min = 0, .max = DEA_SOFT_MODES_MAX, .default_text = "6"),
    DEA_NUMBER_ROW("perturbation", AT(pushes_m), "m", "[50 um, 100 um, 200 um]",
                   "largest displacements of the perturbations", .alias = "push", .above_min = true,
                   .max = 0.1, .default_text = "[200 um, 400 um]",
                   DEA_LIST(1, PUSHES_MAX, struct dea_quantity, AT(push_count))),
    DEA_NUMBER_ROW(
        "distance_tolerance", AT(apart_m), "m", "1 um",
        "states are one where the root mean square of what their films differ by is less",
        .alias = "apart", .above_min = true, .max = 0.01, .default_text = "1 um"),
    DEA_INTEGER_ROW("max_states", AT(most), "8",
                    "states at a voltage from which on no more are looked for there",
                    .alias = "most", .min = 1, .max = 100, .default_text = "8"),
};

static const struct dea_design_section section = {
    .record = {study_name,
               "study of states, made when this section is there ({}) or with --study: the stable "
               "equilibria of a slack film at voltages (3d)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings)};

// States -----------------------------------------------------------------------------------------

static const double taut_below = 0.1;   // compression ratio of a film that has one state only
static const double energy_same = 1e-8; // relative: of copies of one state by symmetry
enum { NONE = -1, UP = 0, DOWN = 1, NOTE_SIZE = 64, NAME_SIZE = 24 };

struct state {
  struct dea_load_point point;
  struct dea_state saved; // values owned
  double *u;              // [3 point_count] of the film's middle surface; owned
  size_t point_count;
  size_t level;
  double stiffness_N_per_m4; // of the softest motion; NAN: not searched
  char reached[NOTE_SIZE];
  int leads[2];   // up and down: the state at the next level, NONE where it comes to none
  bool led[2];    // that is known
  bool searched;  // or given up
  size_t copies;  // of it by symmetry that were found
  size_t variant; // of the result that it belongs to, from 0 in this study
};

struct search {
  struct dea_context *ctx;
  struct dea_study_job job; // with a model of its own
  const struct settings *settings;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  size_t level_count; // reached
  struct state *states;
  size_t count, capacity;
  size_t first_variant; // of the result, of all that are added
  bool whole;           // no plane of symmetry: each fibre goes its own way
  int parts;            // equal sectors that are pushed one by one; 0: none
};

static void free_search(struct search *s)
{
  for (size_t i = 0; i < s->count; i++) {
    dea_state_free_values(s->ctx, &s->states[i].saved);
    dea_free(s->ctx, s->states[i].u);
  }
  if (s->job.model != NULL) {
    s->job.type->destroy(s->ctx, s->job.model);
  }
  dea_free(s->ctx, s->states);
}

/* Displacements of the film where the model is, owned by the caller. */
static dea_status store_film(struct search *s, double **u, size_t *count)
{
  struct dea_context *ctx = s->ctx;
  struct dea_field_mesh *mesh;
  *u = NULL;
  DEA_TRY(ctx, dea_model_fields(ctx, s->job.type, s->job.model, DEA_FIELDS_SURFACE, &mesh));
  *count = mesh->point_count;
  s->whole = mesh->fold == 0;
  s->parts = s->whole && mesh->fibres > 1 ? mesh->fibres : 0;
  *u = dea_alloc(ctx, 3 * mesh->point_count, sizeof **u);
  if (*u != NULL) {
    memcpy(*u, dea_field_mesh_find(mesh, "displacement_m")->values,
           3 * mesh->point_count * sizeof **u);
  }
  dea_field_mesh_destroy(ctx, mesh);
  return *u != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* Root mean square of what two films differ by. */
static double distance_m(const double *u, const double *v, size_t count)
{
  double sum = 0;
  for (size_t i = 0; i < 3 * count; i++) {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): films that were found
    sum += (u[i] - v[i]) * (u[i] - v[i]);
  }
  return sqrt(sum / (double)count);
}

/* Whether a state is a copy of another one by the symmetry of the device: the same energy to the
 * solver's accuracy, and the same heights. */
static bool is_copy(const struct search *s, const struct dea_load_point *a,
                    const struct dea_load_point *b)
{
  double apart_m = s->settings->apart_m.si;
  return s->whole && fabs(a->energy_J - b->energy_J) <= energy_same * fabs(b->energy_J) &&
         !(fabs(a->highest_z_m - b->highest_z_m) > apart_m) &&
         !(fabs(a->lowest_z_m - b->lowest_z_m) > apart_m);
}

/* The state at a level that the model is at, NONE for a new one. */
static int find_state(struct search *s, size_t level, const struct dea_load_point *point,
                      const double *u)
{
  for (size_t i = 0; i < s->count; i++) {
    struct state *state = &s->states[i];
    if (state->level != level) {
      continue;
    }
    if (distance_m(state->u, u, state->point_count) < s->settings->apart_m.si) {
      return (int)i;
    }
    if (is_copy(s, point, &state->point)) {
      state->copies++;
      return (int)i;
    }
  }
  return NONE;
}

static dea_status keep_model(struct search *s, struct dea_state *kept)
{
  struct dea_state now = {0};
  DEA_TRY(s->ctx, s->job.type->save(s->ctx, s->job.model, &now));
  return dea_state_copy_values(s->ctx, &now, kept);
}

/* Adds the state that the model is at where that is new; *index: which one it is. */
static dea_status add_state(struct search *s, size_t level, const struct dea_load_point *point,
                            const char *reached, int *index)
{
  double *u;
  size_t count = 0;
  DEA_TRY(s->ctx, store_film(s, &u, &count));
  *index = find_state(s, level, point, u);
  dea_status status =
      *index == NONE ? dea_array_grow(s->ctx, &s->states, s->count, &s->capacity, sizeof *s->states)
                     : DEA_OK;
  if (status != DEA_OK || *index != NONE) {
    dea_free(s->ctx, u);
    return status;
  }
  struct state *state = &s->states[s->count];
  *state = (struct state){.point = *point,
                          .u = u,
                          .point_count = count,
                          .level = level,
                          .stiffness_N_per_m4 = NAN,
                          .leads = {NONE, NONE}};
  snprintf(state->reached, sizeof state->reached, "%s", reached);
  *index = (int)s->count++;
  return keep_model(s, &state->saved);
}

static size_t states_at(const struct search *s, size_t level)
{
  size_t count = 0;
  for (size_t i = 0; i < s->count; i++) {
    count += s->states[i].level == level;
  }
  return count;
}

/* Failures that only say that there is nothing that way. */
static dea_status forgive(struct dea_context *ctx, dea_status status)
{
  return status == DEA_E_UNSUPPORTED ? status : dea_forgive(ctx, status);
}

// Search -----------------------------------------------------------------------------------------

/* Up to each voltage from the one before. */
static dea_status sweep_up(struct search *s, size_t voltage_count)
{
  for (size_t i = 0; i < voltage_count; i++) {
    struct dea_load_point point;
    int at = 0;
    if (dea_interrupted_anywhere(s->ctx)) {
      return dea_fail(s->ctx, DEA_E_INTERRUPTED, "interrupted before the search for states");
    }
    DEA_TRY(s->ctx, s->job.type->solve(s->ctx, s->job.model, s->voltages_V[i], &point));
    DEA_TRY(s->ctx, add_state(s, i, &point, "up from 0 V", &at));
    s->level_count = i + 1;
    if (i > 0) {
      s->states[i - 1].leads[UP] = at;
      s->states[i - 1].led[UP] = true;
    }
  }
  return DEA_OK;
}

/* From a state to the level above or below. */
static dea_status lead(struct search *s, size_t from, int direction)
{
  size_t level = s->states[from].level + (direction == UP ? 1 : (size_t)-1);
  struct dea_load_point point;
  char note[NOTE_SIZE];
  int to = NONE;
  s->states[from].led[direction] = true;
  DEA_TRY(s->ctx, s->job.type->load(s->ctx, s->job.model, &s->states[from].saved));
  dea_status status = s->job.type->solve(s->ctx, s->job.model, s->voltages_V[level], &point);
  snprintf(note, sizeof note, "%s from %.4g kV", direction == UP ? "up" : "down",
           1e-3 * s->states[from].point.voltage_V);
  if (status == DEA_OK && point.stable) {
    DEA_TRY(s->ctx, add_state(s, level, &point, note, &to));
  }
  s->states[from].leads[direction] = to;
  return forgive(s->ctx, status);
}

/* From a state by one push. */
static dea_status push(struct search *s, size_t from, const struct dea_push *direction,
                       const char *note)
{
  struct dea_load_point point;
  bool found;
  int to;
  if (dea_interrupted_anywhere(s->ctx)) {
    return dea_fail(s->ctx, DEA_E_INTERRUPTED, "interrupted in the search for states");
  }
  DEA_TRY(s->ctx, s->job.type->load(s->ctx, s->job.model, &s->states[from].saved));
  dea_status status = s->job.type->push(s->ctx, s->job.model, direction, &point, &found);
  if (status == DEA_OK && found) {
    DEA_TRY(s->ctx, add_state(s, s->states[from].level, &point, note, &to));
  }
  return forgive(s->ctx, status);
}

/* From a state along a mode to either side, with growing pushes; in all of it or in one part. */
static dea_status push_mode(struct search *s, size_t from, size_t mode, int part)
{
  for (int side = 1; side >= -1; side -= 2) {
    for (size_t a = 0; a < s->settings->push_count; a++) {
      char note[NOTE_SIZE], where[24] = "";
      const struct dea_push direction = {.side = side,
                                         .mode = mode,
                                         .amplitude_m = s->settings->pushes_m[a].si,
                                         .parts = part < 0 ? 0 : s->parts,
                                         .in = part < 0 ? 0 : 1u << part};
      if (states_at(s, s->states[from].level) >= (size_t)s->settings->most.si) {
        return DEA_OK;
      }
      if (part >= 0) {
        snprintf(where, sizeof where, " at fibre %d", part + 1);
      }
      snprintf(note, sizeof note, "mode %zu%c %.0f um%s", mode + 1, side > 0 ? '+' : '-',
               1e6 * direction.amplitude_m, where);
      DEA_TRY(s->ctx, push(s, from, &direction, note));
    }
  }
  return DEA_OK;
}

/* Pushes a state along its softest motions. */
static dea_status search_from(struct search *s, size_t from)
{
  double stiffness[DEA_SOFT_MODES_MAX];
  size_t modes = (size_t)s->settings->modes.si;
  s->states[from].searched = true;
  if (modes == 0 || s->states[from].point.compression_ratio < taut_below) {
    return DEA_OK;
  }
  DEA_TRY(s->ctx, s->job.type->load(s->ctx, s->job.model, &s->states[from].saved));
  DEA_TRY(s->ctx, s->job.type->soften(s->ctx, s->job.model, modes, stiffness));
  s->states[from].stiffness_N_per_m4 = stiffness[0];
  for (int side = 1; side >= -1; side -= 2) {
    const struct dea_push fold = {.kind = DEA_PUSH_FOLD, .side = side};
    DEA_TRY(s->ctx, push(s, from, &fold, side > 0 ? "folded to the fibres" : "folded away"));
  }
  for (size_t k = 0; k < modes; k++) {
    for (int part = -1; part < s->parts; part++) {
      DEA_TRY(s->ctx, push_mode(s, from, k, part));
    }
  }
  return DEA_OK;
}

/* What is still to be done with a state; *worked: there was something. */
static dea_status work_on(struct search *s, size_t i, bool *worked)
{
  const struct state *state = &s->states[i];
  *worked = true;
  if (!state->led[UP] && state->level + 1 < s->level_count) {
    return lead(s, i, UP);
  }
  if (!state->led[DOWN] && state->level > 0) {
    return lead(s, i, DOWN);
  }
  if (!state->searched) {
    return search_from(s, i);
  }
  *worked = false;
  return DEA_OK;
}

/* Until every state was followed and searched. The lists grow on the way. */
static dea_status search_all(struct search *s)
{
  for (size_t i = 0; i < s->count; i++) {
    bool worked = true;
    while (worked) {
      DEA_TRY(s->ctx, work_on(s, i, &worked));
    }
    dea_study_progress(s->ctx, &s->job, study_name, i + 1, s->count);
  }
  return DEA_OK;
}

// Result -----------------------------------------------------------------------------------------

/* Whether two states at neighbouring levels are of one branch: each leads to the other. */
static bool is_continued(const struct search *s, size_t below, size_t above)
{
  return s->states[below].leads[UP] == (int)above && s->states[above].leads[DOWN] == (int)below;
}

/* Lowest energy first; mirror images of each other, of one energy, as they were found. */
static bool comes_before(const struct search *s, size_t a, size_t b)
{
  double one_J = s->states[a].point.energy_J, other_J = s->states[b].point.energy_J;
  return one_J < other_J || (one_J == other_J && a < b);
}

/* The state at a level that is shown after that one, or first of all where that is s->count;
 * s->count: none. */
static size_t next_state(const struct search *s, size_t level, size_t after)
{
  size_t next = s->count;
  for (size_t i = 0; i < s->count; i++) {
    if (s->states[i].level == level && (after == s->count || comes_before(s, after, i)) &&
        (next == s->count || comes_before(s, i, next))) {
      next = i;
    }
  }
  return next;
}

/* "A" to "Z", "A1", ... */
static void name_branch(size_t number, char out[NAME_SIZE])
{
  int letter = 'A' + (int)(number % 26);
  if (number < 26) {
    snprintf(out, NAME_SIZE, "%c", letter);
  } else {
    snprintf(out, NAME_SIZE, "%c%zu", letter, number / 26);
  }
}

/* A variant of the result for each branch, with the profile at its highest voltage. */
static dea_status append_state(struct search *s, size_t i, size_t *branches)
{
  struct dea_context *ctx = s->ctx;
  struct state *state = &s->states[i];
  struct dea_variant *variant = NULL;
  char name[NAME_SIZE];
  state->variant = *branches;
  for (size_t k = 0; k < s->count; k++) {
    if (s->states[k].level + 1 == state->level && is_continued(s, k, i)) {
      state->variant = s->states[k].variant;
    }
  }
  name_branch(state->variant, name);
  if (state->variant == *branches) {
    ++*branches;
    DEA_TRY(ctx, dea_result_add_variant(ctx, s->job.result, s->job.type->name, study_name, name,
                                        &variant));
    dea_variant_set_size(&s->job, dea_model_settings_of(s->job.result->design).refinement, variant);
    DEA_TRY(ctx, dea_curve_end(ctx, &variant->curve, DEA_OK));
  }
  variant = &s->job.result->variants[s->first_variant + state->variant];
  if (s->job.type->profile != NULL || s->job.type->observe != NULL) {
    DEA_TRY(ctx, s->job.type->load(ctx, s->job.model, &state->saved));
  }
  DEA_TRY(ctx,
          dea_study_add_point(ctx, &s->job, s->job.result->device, &state->point, &variant->curve));
  return DEA_CHAIN(ctx, dea_variant_add_profile(ctx, &s->job, variant));
}

enum { ALL = DEA_IN_JSON | DEA_IN_CSV | DEA_IN_SCREEN };

static const struct dea_result_column state_columns[] = {
    DEA_KV("voltage_V", "V", "voltage"),
    DEA_TEXT_COLUMN("state", "state",
                    "its branch: of the same letter where each leads to the other"),
    DEA_UJ("energy_J", "energy", "potential energy, 0 at rest"),
    DEA_UJ("above_J", "above the lowest", "energy above that of the lowest state found"),
    DEA_UM("centre_z_m", "centre", "displacement of the centre"),
    DEA_UM("fibre_tip_z_m", "fibre tip", "displacement of the fibre tip"),
    DEA_UM("electrode_edge_u_m", "edge", "radial displacement of the electrode's edge"),
    DEA_UM("highest_z_m", "highest", "largest displacement out of the plane"),
    DEA_UM("lowest_z_m", "lowest", "smallest displacement out of the plane"),
    DEA_RESULT_COLUMN(COUNT, "unstable_modes", "unstable modes",
                      .meaning = "negative modes of the tangent"),
    DEA_NUMBER_COLUMN("stiffness_N_per_m4", "N/m^4", "N/m^4", 1, "softest",
                      "stiffness of the softest motion by volume; none: not searched"),
    DEA_TEXT_COLUMN("flags", "flags", "how far the numbers are to be trusted"),
    DEA_RESULT_COLUMN(COUNT, "copies", "copies",
                      .meaning = "times that it was found again as a copy by symmetry"),
    DEA_TEXT_COLUMN("reached", "reached", "how, at first"),
    DEA_TEXT_COLUMN("leads_up", "leads up to", "state at the next voltage; -: none was found"),
    DEA_TEXT_COLUMN("leads_down", "down to", "state at the voltage before; -: none was found"),
};
static const struct dea_result_column band_columns[] = {
    DEA_KV("voltage_V", "V", "voltage"),
    DEA_RESULT_COLUMN(COUNT, "states", "states",
                      .meaning = "stable states found, copies by symmetry not counted"),
    DEA_TEXT_COLUMN("lowest", "lowest", "state of the lowest energy of those found"),
    DEA_TEXT_COLUMN("up", "from below", "state that the sweep from 0 V comes to"),
    DEA_RESULT_COLUMN(FLAG, "searched", "searched",
                      .meaning = "pushed along soft motions; not where the film is taut"),
    DEA_UM("centre_z_min_m", "centre, least", "of all states found"),
    DEA_UM("centre_z_max_m", "centre, most", "of all states found"),
    DEA_UM("fibre_tip_z_min_m", "tip, least", "of all states found"),
    DEA_UM("fibre_tip_z_max_m", "tip, most", "of all states found"),
    DEA_UM("electrode_edge_u_min_m", "edge, least", "of all states found"),
    DEA_UM("electrode_edge_u_max_m", "edge, most", "of all states found"),
    DEA_UM("lowest_z_m", "lowest z", "smallest displacement out of the plane of all states found"),
    DEA_UM("highest_z_m", "highest z", "largest displacement out of the plane of all states found"),
};

static const struct dea_result_table_type state_table =
    DEA_RESULT_TABLE(study_name, "found", state_columns, .title = "stable states", .where = ALL);
static const struct dea_result_table_type band_table =
    DEA_RESULT_TABLE(study_name, "bands", band_columns,
                     .title = "what a sensor reads over the states", .where = ALL);

/* Name of the state that one leads to; "" at the end of the voltages. */
static void name_lead(const struct search *s, const struct state *state, int direction,
                      char out[NAME_SIZE])
{
  if (state->leads[direction] == NONE) {
    snprintf(out, NAME_SIZE, "%s", state->led[direction] ? "-" : "");
  } else {
    name_branch(s->states[state->leads[direction]].variant, out);
  }
}

static dea_status add_state_row(const struct search *s, const struct state *state, double lowest_J,
                                struct dea_result_table *table)
{
  const struct dea_load_point *p = &state->point;
  char name[NAME_SIZE], up[NAME_SIZE], down[NAME_SIZE], flags[DEA_FLAGS_SIZE];
  name_branch(state->variant, name);
  name_lead(s, state, UP, up);
  name_lead(s, state, DOWN, down);
  return DEA_TABLE_ADD(
      s->ctx, table, DEA_CELL(p->voltage_V), DEA_TEXT_CELL(name), DEA_CELL(p->energy_J),
      DEA_CELL(p->energy_J - lowest_J), DEA_CELL(p->centre_z_m), DEA_CELL(p->fibre_tip_z_m),
      DEA_CELL(p->electrode_edge_u_m), DEA_CELL(p->highest_z_m), DEA_CELL(p->lowest_z_m),
      DEA_CELL(p->unstable_modes), DEA_CELL(state->stiffness_N_per_m4),
      DEA_TEXT_CELL(dea_flags_text(dea_load_point_flags(p), flags)),
      DEA_CELL((double)state->copies), DEA_TEXT_CELL(state->reached), DEA_TEXT_CELL(up),
      DEA_TEXT_CELL(down));
}

/* Least (side -1) or most (1) of a quantity over the states at a level; NAN where it is none. */
static double extreme(const struct search *s, size_t level, const char *key, int side)
{
  int column = dea_point_column_find(key);
  double out = NAN;
  for (size_t i = 0; i < s->count; i++) {
    double value = dea_point_get(&s->states[i].point, column);
    if (s->states[i].level == level && !(side * value <= side * out)) {
      out = value;
    }
  }
  return out;
}

/* States are in the order of levels as the sweep has found them: the first of each. */
static dea_status add_band_row(const struct search *s, size_t level, const struct state *lowest,
                               struct dea_result_table *table)
{
#define LEAST(key) DEA_CELL(extreme(s, level, key, -1))
#define MOST(key) DEA_CELL(extreme(s, level, key, 1))
  char name[NAME_SIZE], up[NAME_SIZE];
  name_branch(lowest->variant, name);
  name_branch(s->states[level].variant, up);
  return DEA_TABLE_ADD(s->ctx, table, DEA_CELL(s->voltages_V[level]),
                       DEA_CELL((double)states_at(s, level)), DEA_TEXT_CELL(name),
                       DEA_TEXT_CELL(up), DEA_CELL(!isnan(s->states[level].stiffness_N_per_m4)),
                       LEAST("centre_z_m"), MOST("centre_z_m"), LEAST("fibre_tip_z_m"),
                       MOST("fibre_tip_z_m"), LEAST("electrode_edge_u_m"),
                       MOST("electrode_edge_u_m"), LEAST("lowest_z_m"), MOST("highest_z_m"));
#undef LEAST
#undef MOST
}

/* Branches are lettered as they come, level by level, and then all rows can be written. */
static dea_status add_result(struct search *s)
{
  struct dea_context *ctx = s->ctx;
  struct dea_result_table *table;
  size_t branches = 0;
  s->first_variant = s->job.result->variant_count;
  for (size_t level = 0; level < s->level_count; level++) {
    bool several = states_at(s, level) > 1;
    for (size_t i = next_state(s, level, s->count); i < s->count; i = next_state(s, level, i)) {
      s->states[i].point.own_flags |= (unsigned)several << DEA_FLAG_STATES;
      DEA_TRY(ctx, append_state(s, i, &branches));
    }
  }
  DEA_TRY(ctx,
          dea_result_add_table(ctx, s->job.result, &state_table, s->job.type->name, 0, &table));
  for (size_t level = 0; level < s->level_count; level++) {
    size_t lowest = next_state(s, level, s->count);
    for (size_t i = lowest; i < s->count; i = next_state(s, level, i)) {
      DEA_TRY(ctx, add_state_row(s, &s->states[i], s->states[lowest].point.energy_J, table));
    }
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, s->job.result, &band_table, s->job.type->name, 0, &table));
  for (size_t level = 0; level < s->level_count; level++) {
    DEA_TRY(ctx, add_band_row(s, level, &s->states[next_state(s, level, s->count)], table));
  }
  return DEA_OK;
}

// Run ---------------------------------------------------------------------------------------------

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_design *design = job->result->design;
  const struct settings *settings = dea_design_settings(design, &section)->values;
  struct search s = {.ctx = ctx, .job = *job, .settings = settings};
  size_t count =
      dea_study_stops(design, settings->voltages_V, settings->voltage_count, false, s.voltages_V);
  qsort(s.voltages_V, count, sizeof *s.voltages_V, dea_rising);
  dea_status status =
      dea_model_create_whole(ctx, job->type, design, job->result->device, &s.job.model);
  dea_status swept = status == DEA_OK ? sweep_up(&s, count) : status;
  status = forgive(ctx, swept); // states at the voltages that there are
  status = status == DEA_OK && s.level_count > 0 ? search_all(&s) : status;
  if (s.level_count > 0 && status != DEA_E_MEMORY) {
    dea_status put = add_result(&s);
    status = status == DEA_OK ? put : status;
  }
  free_search(&s);
  return status == DEA_OK && swept != DEA_OK
             ? dea_fail(ctx, swept, "no states above %.4g kV",
                        s.level_count > 0 ? 1e-3 * s.voltages_V[s.level_count - 1] : 0)
             : status;
}

// Figures ----------------------------------------------------------------------------------------

/* The branch's letter, and of its profile the voltage. */
static void name_curve(struct dea_series *look, const struct dea_variant *variant, bool profile)
{
  const struct dea_curve *curve = &variant->curve;
  bool trusted = curve->count > 0 && dea_load_point_valid(&curve->points[curve->count - 1]);
  char at[32] = "";
  if (profile) {
    snprintf(at, sizeof at, ", %.4g kV", 1e-3 * variant->profile.voltage_V);
  }
  snprintf(look->title, sizeof look->title, "%s%s%s", variant->name, at, trusted ? "" : " (?)");
}

/* Lowest energy of all states at a voltage. */
static double lowest_at(const struct dea_result *result, double voltage_V)
{
  double lowest_J = INFINITY;
  for (size_t i = 0; i < result->variant_count; i++) {
    const struct dea_curve *curve = &result->variants[i].curve;
    for (size_t k = 0; k < curve->count && strcmp(curve->kind, study_name) == 0; k++) {
      if (curve->points[k].voltage_V == voltage_V) {
        lowest_J = fmin(lowest_J, curve->points[k].energy_J);
      }
    }
  }
  return lowest_J;
}

/* What is no disc has no centre: then the place that is farthest out of the plane. */
static double height(double centre_z_m, double highest_z_m, double lowest_z_m)
{
  return !isnan(centre_z_m) ? centre_z_m : highest_z_m >= -lowest_z_m ? highest_z_m : lowest_z_m;
}

/* A number against the voltage, a line with a marker at each point for each branch. */
static dea_status add_branches(struct dea_context *ctx, struct dea_panel *panel,
                               const struct dea_result *result, bool energy)
{
  size_t number = 0;
  for (size_t i = 0; i < result->variant_count; i++) {
    const struct dea_curve *curve = &result->variants[i].curve;
    struct dea_series look, *series;
    if (strcmp(curve->kind, study_name) != 0) {
      continue;
    }
    look = dea_figure_style("", number++);
    look.style = DEA_LINE_MARKED;
    if (!energy) {
      name_curve(&look, &result->variants[i], false);
    }
    DEA_TRY(ctx, dea_panel_add_as(ctx, panel, curve->count, &look, &series));
    for (size_t k = 0; k < curve->count; k++) {
      const struct dea_load_point *p = &curve->points[k];
      series->values[k] = 1e-3 * p->voltage_V;
      series->values[curve->count + k] =
          1e6 * (energy ? p->energy_J - lowest_at(result, p->voltage_V)
                        : height(p->centre_z_m, p->highest_z_m, p->lowest_z_m));
    }
  }
  return DEA_OK;
}

/* The first state, at the lowest voltage; NULL: there is none. */
static const struct dea_load_point *first_state(const struct dea_result *result)
{
  for (size_t i = 0; i < result->variant_count; i++) {
    const struct dea_curve *curve = &result->variants[i].curve;
    if (strcmp(curve->kind, study_name) == 0 && curve->count > 0) {
      return &curve->points[0];
    }
  }
  return NULL;
}

static dea_status build_states(struct dea_context *ctx, const struct dea_result *result,
                               struct dea_plot *plot)
{
  struct dea_panel *panels = plot->panels;
  const struct dea_load_point *first = first_state(result);
  plot->panel_count = 2;
  DEA_TRY(ctx, add_branches(ctx, &panels[0], result, false));
  DEA_TRY(ctx, add_branches(ctx, &panels[1], result, true));
  snprintf(panels[0].y_label, DEA_LABEL_SIZE, "%s {/:Italic z} (\302\265m)",
           first != NULL && !isnan(first->centre_z_m) ? "Centre" : "Farthest place");
  snprintf(panels[1].y_label, DEA_LABEL_SIZE, "Energy above the lowest (\302\265J)");
  for (size_t p = 0; p < plot->panel_count; p++) {
    dea_panel_voltage_axis(&panels[p]);
    if (first != NULL && 1e-3 * first->voltage_V < panels[p].x_max) {
      panels[p].x_min = 1e-3 * first->voltage_V;
    }
    dea_panel_even_tics(&panels[p], 7);
  }
  panels[0].key = "above horizontal samplen 1.5";
  return DEA_OK;
}

static dea_status build_profiles(struct dea_context *ctx, const struct dea_result *result,
                                 struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  size_t number = 0;
  for (size_t i = 0; i < result->variant_count; i++) {
    const struct dea_variant *variant = &result->variants[i];
    const struct dea_profile_record *shape = &variant->profile;
    struct dea_series look, *series;
    if (strcmp(variant->curve.kind, study_name) != 0 || shape->count == 0) {
      continue;
    }
    look = dea_figure_style("", number++);
    name_curve(&look, variant, true);
    const struct dea_profile profile = dea_profile_of_record(shape);
    DEA_TRY(ctx, dea_panel_add_as(ctx, panel, shape->count, &look, &series));
    for (size_t k = 0; k < shape->count; k++) {
      series->values[k] = 1e3 * shape->columns[k];
      series->values[shape->count + k] = 1e6 * profile.z_m[k];
    }
    dea_figure_sides(panel, shape);
  }
  snprintf(panel->y_label, DEA_LABEL_SIZE, "Displacement {/:Italic z} (\302\265m)");
  snprintf(panel->x_label, DEA_LABEL_SIZE, "Radius in the stretched flat film {/:Italic R} (mm)");
  dea_panel_even_tics(panel, 7);
  panel->key = "above horizontal samplen 1.5";
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE(
        "states", study_name, build_states,
        "centre, or the place farthest out of the plane, and energy of the stable states "
        "that were found; one line where each leads to the other (?: not to be trusted at its "
        "highest voltage)"),
    DEA_STUDY_FIGURE(
        "state_profiles", study_name, build_profiles,
        "shape of each state at its highest voltage (of model 3d: to the right along a "
        "fibre, to the left between fibres; ?: not to be trusted)"),
};

// The study --------------------------------------------------------------------------------------

const struct dea_study dea_study_states = {
    .name = study_name,
    .keys = &section,
    .own_models = true,
    .ability = "several states at a voltage",
    .able_by = offsetof(struct dea_model_type, push),
    .run = run,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
