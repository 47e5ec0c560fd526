/* Any device of flat layers, of its parts: the general form of a design. */
#include "device/generator.h"
#include "device/geometry.h"
#include "device/layout_check.h"
#include "material/plane.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

struct maker {
  struct dea_context *ctx;
  const struct dea_design *design;
  const struct dea_parts *parts;
  struct dea_layout *out;
};

static dea_status find(const struct maker *m, enum dea_named kind, const struct dea_label *label,
                       size_t *out)
{
  return dea_part_find(m->ctx, m->parts, kind, label->text, label->location, out);
}

/* A copy of a name, since a device outlives its design; NULL when the arena has failed. */
static const char *keep(const struct maker *m, const char *text)
{
  size_t size = strlen(text) + 1;
  char *copy = dea_arena_alloc(&m->out->memory, size, 1);
  return copy != NULL ? memcpy(copy, text, size) : NULL;
}

static double or_zero(const struct dea_quantity *value)
{
  return value->origin == DEA_ABSENT ? 0 : value->si;
}

// Plies ------------------------------------------------------------------------------------------

static struct dea_material_choice choice_of(const struct dea_parts_ply *ply)
{
  return (struct dea_material_choice){&ply->law, &ply->permittivity, &ply->breakdown,
                                      &ply->viscosity, NULL};
}

static dea_status resolve_ply(const struct maker *m, const struct dea_parts_ply *ply,
                              struct dea_material *out)
{
  const struct dea_material_choice choice = choice_of(ply);
  dea_status status = dea_generator_material(m->ctx, m->design, &ply->material, &choice, out);
  if (status == DEA_E_DESIGN) { // a finding lets the other plies be checked
    return DEA_OK;
  }
  DEA_TRY(m->ctx, status);
  if (out->law == NULL && out->young_modulus_Pa == 0) {
    return dea_finding_add(m->ctx, DEA_ERROR, ply->material.location,
                           "material '%s' has neither a law nor a Young's modulus, which a ply "
                           "needs",
                           out->name);
  }
  return DEA_OK;
}

/* A ply as it lies: stretched by its pre-stretch. */
static dea_status check_reach(struct maker *m, const struct dea_parts_ply *from,
                              const struct dea_layout_ply *ply)
{
  char what[80];
  struct dea_location place =
      from->pre_stretch_count > 0 ? from->pre_stretch[0].location : from->name.location;
  snprintf(what, sizeof what, "ply '%.60s'", ply->name);
  return dea_generator_check_reach(m->ctx, &ply->material, what, ply->pre_stretch, place);
}

static dea_status add_ply(struct maker *m, size_t i)
{
  const struct dea_parts_ply *from = &m->parts->plies[i];
  struct dea_layout_ply *to = &m->out->plies[i];
  double l1 = from->pre_stretch[0].si,
         l2 = from->pre_stretch_count > 1 ? from->pre_stretch[1].si : l1;
  to->name = keep(m, from->name.text);
  to->layers = (size_t)from->layers.si;
  to->thickness_unstretched_m = (double)to->layers * from->thickness_m.si;
  to->thickness_m = to->thickness_unstretched_m / (l1 * l2);
  to->pre_stretch[0] = l1;
  to->pre_stretch[1] = l2;
  to->angle_rad = from->angle_rad.si;
  to->elements = from->elements.origin == DEA_ABSENT ? 0 : (size_t)from->elements.si;
  to->location = from->name.location;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
  DEA_TRY(m->ctx, resolve_ply(m, from, &to->material));
  return check_reach(m, from, to);
}

/* Fits the breakdown fields to the layers' thicknesses and to the unstretched area between
 * electrodes of all of them, any place of which may be the weakest (docs/theory/breakdown.md). */
static void fit_breakdown(const struct maker *m)
{
  double area_m2 = 0;
  for (size_t i = 0; i < m->out->ply_count; i++) {
    const double *l = m->out->plies[i].pre_stretch;
    const double layers = (double)dea_ply_layers(&m->out->plies[i]);
    area_m2 += layers * dea_layout_active_area_m2(m->out, i) / (l[0] * l[1]);
  }
  for (size_t i = 0; i < m->out->ply_count; i++) {
    struct dea_layout_ply *ply = &m->out->plies[i];
    dea_breakdown_specialise(dea_ply_layer_m(ply), area_m2, &ply->material.breakdown);
  }
}

/* What a ply needs that is a dielectric. */
static dea_status check_dielectrics(struct maker *m)
{
  bool any = false;
  for (size_t i = 0; i < m->out->ply_count; i++) {
    const struct dea_parts_ply *ply = &m->parts->plies[i];
    const struct dea_material_choice choice = choice_of(ply);
    const struct dea_generator_film film = {
        .material = &m->out->plies[i].material,
        .what = "the dielectric between two electrodes",
        .name = &ply->material,
        .choice = &choice,
        .pre_stretch = m->out->plies[i].pre_stretch,
        .pre_stretch_place = ply->pre_stretch[0].location,
    };
    if (dea_layout_is_dielectric(m->out, i)) {
      any = true;
      DEA_TRY(m->ctx, dea_generator_check_film(m->ctx, &film));
      DEA_TRY(m->ctx, dea_generator_check_film_in_time(m->ctx, m->design, &film));
    }
  }
  return any ? DEA_OK
             : dea_finding_add(m->ctx, DEA_NOTE, m->parts->place,
                               "no ply lies between electrodes of different channels: a voltage "
                               "does nothing");
}

// Electrodes and channels ------------------------------------------------------------------------

/* The channel of that name; a new one has the ratio 1. */
static dea_status add_channel(struct maker *m, const struct dea_label *label, size_t *out)
{
  struct dea_layout *l = m->out;
  *out = dea_layout_find_channel(l, label->text);
  if (*out != DEA_LAYOUT_NONE) {
    return DEA_OK;
  }
  const char *names[DEA_LAYOUT_CHANNELS_MAX];
  size_t listed = m->parts->channel_count;
  for (size_t i = 0; i < listed; i++) {
    names[i] = m->parts->channels[i].name.text;
  }
  names[listed] = "ground";
  const char *near = dea_nearest_name(label->text, names, listed + 1);
  if (near != NULL && (listed > 0 || strcmp(near, "ground") == 0)) {
    return dea_finding_add(m->ctx, DEA_ERROR, label->location,
                           "there is no channel '%.60s'; did you mean '%s'? One that is meant to "
                           "be new can be put into 'channels'",
                           label->text, near);
  }
  if (l->channel_count == DEA_LAYOUT_CHANNELS_MAX) {
    return dea_finding_add(m->ctx, DEA_ERROR, label->location,
                           "there can be %d channels at most, with ground",
                           DEA_LAYOUT_CHANNELS_MAX);
  }
  l->channels[l->channel_count] = (struct dea_layout_channel){
      .name = keep(m, label->text), .ratio = 1, .location = label->location};
  *out = l->channel_count++;
  return dea_arena_status(&l->memory);
}

static dea_status add_channels(struct maker *m)
{
  struct dea_layout *l = m->out;
  const struct dea_layout_channel ground = l->channels[0];
  l->channels = dea_arena_alloc(&l->memory, DEA_LAYOUT_CHANNELS_MAX, sizeof *l->channels);
  DEA_TRY(m->ctx, dea_arena_status(&l->memory));
  l->channels[0] = ground;
  for (size_t i = 0; i < m->parts->channel_count; i++) {
    const struct dea_parts_channel *from = &m->parts->channels[i];
    if (strcmp(from->name.text, ground.name) == 0) {
      DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_ERROR, from->name.location,
                                      "'ground' is at 0 V and needs no line of its own"));
      continue;
    }
    l->channels[l->channel_count++] = (struct dea_layout_channel){
        keep(m, from->name.text), from->ratio.si, from->voltage_V.si, from->name.location,
        from->waveform != NULL ? from->waveform->kind : NULL};
  }
  return dea_arena_status(&l->memory);
}

static dea_status add_electrode(struct maker *m, size_t i)
{
  const struct dea_parts_electrode *from = &m->parts->electrodes[i];
  struct dea_layout_electrode *to = &m->out->electrodes[i];
  to->name = keep(m, from->name.origin == DEA_ABSENT ? from->channel.text : from->name.text);
  to->top = from->side.value == DEA_SIDE_TOP;
  to->sheet_resistance_ohm = from->sheet_resistance_ohm.si;
  to->location = from->shape.location;
  to->lead = from->lead_rad.origin != DEA_ABSENT;
  to->lead_rad = to->lead ? from->lead_rad.si : 0;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
  DEA_TRY(m->ctx, find(m, DEA_NAMED_PLY, &from->ply, &to->ply));
  return add_channel(m, &from->channel, &to->channel);
}

static dea_status check_channels(struct maker *m)
{
  const struct dea_layout *l = m->out;
  for (size_t c = m->parts->channel_count > 0 ? 1 : l->channel_count; c < l->channel_count; c++) {
    size_t i = 0;
    while (i < l->electrode_count && l->electrodes[i].channel != c) {
      i++;
    }
    if (i == l->electrode_count) {
      DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_WARNING, l->channels[c].location,
                                      "no electrode is connected to the channel '%.60s'",
                                      l->channels[c].name));
    }
  }
  return DEA_OK;
}

// Supports, bodies, springs, pressures -----------------------------------------------------------

static dea_status add_hold(const struct maker *m, const struct dea_parts_support *from,
                           struct dea_layout_support *to)
{
  bool pulled = false;
  for (size_t k = 0; k < from->hold_count; k++) {
    int hold = from->hold[k].value;
    bool alone = hold == DEA_HOLD_CLAMPED || hold == DEA_HOLD_HINGED;
    if (alone && from->hold_count > 1) {
      DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_ERROR, from->hold[k].location,
                                      "hold: 'clamped' and 'hinged' stand alone; write directions "
                                      "such as [x, z], or one of them"));
    }
    to->hinged |= hold == DEA_HOLD_HINGED;
    to->components |= alone ? 7 : hold >= DEA_HOLD_X ? 1 << (hold - DEA_HOLD_X) : 0;
  }
  for (int k = 0; k < 3; k++) {
    to->force_N[k] = or_zero(&from->force_N[k]);
    pulled = pulled || from->force_N[k].origin != DEA_ABSENT;
  }
  to->components = from->hold_count == 0 && !pulled ? 7 : to->components;
  for (int k = 0; k < 3; k++) {
    const struct dea_quantity *move = &from->move_m[k], *force = &from->force_N[k];
    to->move_m[k] = or_zero(move);
    if (force->origin != DEA_ABSENT && (to->components & 1 << k) != 0) {
      DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_ERROR, force->location,
                                      "force_%c: this support holds %c", "xyz"[k], "xyz"[k]));
    }
    if (move->origin != DEA_ABSENT && (to->components & 1 << k) == 0) {
      DEA_TRY(m->ctx,
              dea_finding_add(m->ctx, DEA_ERROR, move->location,
                              "move_%c: this support does not hold %c", "xyz"[k], "xyz"[k]));
    }
  }
  return DEA_OK;
}

static dea_status add_support(struct maker *m, size_t i)
{
  const struct dea_parts_support *from = &m->parts->supports[i];
  struct dea_layout_support *to = &m->out->supports[i];
  to->edge = from->edge.origin != DEA_ABSENT;
  const struct dea_label *shape = to->edge ? &from->edge : &from->shape;
  to->within = DEA_LAYOUT_NONE;
  to->location = shape->location;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, shape, &to->region));
  if (from->within.origin != DEA_ABSENT) {
    DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->within, &to->within));
  }
  return add_hold(m, from, to);
}

static dea_status add_motion(const struct maker *m, const struct dea_parts_body *from,
                             struct dea_layout_body *to)
{
  to->free = from->free_given ? 0 : 63;
  for (size_t k = 0; k < from->free_count; k++) {
    to->free |= from->free[k].value >= 0 ? 1 << from->free[k].value : 0;
  }
  for (int k = 0; k < DEA_DIRECTIONS; k++) {
    const struct dea_quantity *move = &from->move[k], *force = &from->force[k];
    *(k < 3 ? &to->shift_m[k] : &to->turn_rad[k - 3]) = or_zero(move);
    *(k < 3 ? &to->force_N[k] : &to->moment_N_m[k - 3]) = or_zero(force);
    to->moved |= move->origin != DEA_ABSENT ? 1 << k : 0;
    to->free &= ~to->moved;
    if (force->origin != DEA_ABSENT && force->si != 0 && (to->free & 1 << k) == 0) {
      DEA_TRY(m->ctx, dea_finding_add(m->ctx, DEA_WARNING, force->location,
                                      "%s_%c has no effect: the body is not free to %s",
                                      k < 3 ? "force" : "moment", "xyz"[k % 3],
                                      k < 3 ? "move there" : "turn there"));
    }
  }
  return DEA_OK;
}

static dea_status add_body(struct maker *m, size_t i)
{
  const struct dea_parts_body *from = &m->parts->bodies[i];
  struct dea_layout_body *to = &m->out->bodies[i];
  to->name = keep(m, from->name.text);
  to->mass_kg = from->mass_kg.si;
  to->location = from->name.location;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
  return add_motion(m, from, to);
}

/* A spring's numbers, by whether its direction is a turn. */
static dea_status set_stiffness(const struct maker *m, const struct dea_parts_spring *from,
                                struct dea_layout_spring *to)
{
  bool turns = from->direction.value >= 3;
  const struct dea_quantity *right =
      turns ? &from->stiffness_N_m_per_rad : &from->stiffness_N_per_m;
  const struct dea_quantity *wrong =
      turns ? &from->stiffness_N_per_m : &from->stiffness_N_m_per_rad;
  if (wrong->origin != DEA_ABSENT) {
    return dea_finding_add(m->ctx, DEA_ERROR, wrong->location, "a spring against a %s has its '%s'",
                           turns ? "turn" : "shift", turns ? "turn_stiffness" : "stiffness");
  }
  const struct dea_quantity *place = turns ? &from->free_at_rad : &from->free_at_m;
  const struct dea_quantity *other = turns ? &from->free_at_m : &from->free_at_rad;
  if (other->origin == DEA_GIVEN || other->origin == DEA_OVERRIDE) {
    return dea_finding_add(m->ctx, DEA_ERROR, other->location,
                           "a spring against a %s is free at its '%s'", turns ? "turn" : "shift",
                           turns ? "free_at_angle" : "free_at");
  }
  to->stiffness = or_zero(right);
  to->free_at = or_zero(place);
  to->count = from->row_count;
  double *at = dea_arena_alloc(&m->out->memory, to->count, sizeof *at);
  double *force = dea_arena_alloc(&m->out->memory, to->count, sizeof *force);
  DEA_TRY(m->ctx, dea_arena_status(&m->out->memory));
  for (size_t k = 0; k < to->count; k++) {
    at[k] = from->row[k][0];
    force[k] = from->row[k][1];
  }
  to->at = at;
  to->force = force;
  return DEA_OK;
}

static dea_status add_spring(struct maker *m, size_t i)
{
  const struct dea_parts_spring *from = &m->parts->springs[i];
  struct dea_layout_spring *to = &m->out->springs[i];
  to->component = from->direction.value;
  to->location = from->body.location;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_BODY, &from->body, &to->body));
  return set_stiffness(m, from, to);
}

/* What a pressure encloses. */
static dea_status add_enclosure(const struct maker *m, const struct dea_parts_pressure *from,
                                struct dea_layout_pressure *to)
{
  const bool gas = from->gas_m3.origin != DEA_ABSENT, liquid = from->liquid_m3.origin != DEA_ABSENT;
  const bool given =
      from->pressure_Pa.origin == DEA_GIVEN || from->pressure_Pa.origin == DEA_OVERRIDE;
  to->encloses = gas ? DEA_GAS : liquid ? DEA_LIQUID : DEA_OPEN;
  to->volume_m3 = gas ? from->gas_m3.si : or_zero(&from->liquid_m3);
  to->ambient_Pa = from->ambient_Pa.si;
  if (gas && liquid) {
    return dea_finding_add(m->ctx, DEA_ERROR, from->liquid_m3.location,
                           "a face encloses 'gas' or 'liquid', not both");
  }
  if (liquid && given) {
    return dea_finding_add(m->ctx, DEA_ERROR, from->pressure_Pa.location,
                           "the pressure of an enclosed liquid comes of its volume: leave "
                           "'pressure' out, or 'liquid'");
  }
  if (gas && !(to->pressure_Pa + to->ambient_Pa > 0)) {
    return dea_finding_add(m->ctx, DEA_ERROR, from->pressure_Pa.location,
                           "gas of this pressure over 'ambient' is less than none");
  }
  return gas || liquid || given
             ? DEA_OK
             : dea_finding_add(m->ctx, DEA_ERROR, from->shape.location,
                               "a pressure needs 'pressure', or 'gas' or 'liquid' that the face "
                               "encloses");
}

static dea_status add_pressure(struct maker *m, size_t i)
{
  const struct dea_parts_pressure *from = &m->parts->pressures[i];
  struct dea_layout_pressure *to = &m->out->pressures[i];
  to->top = from->side.value == DEA_SIDE_TOP;
  to->name = keep(m, from->name.text);
  to->pressure_Pa = from->pressure_Pa.si;
  DEA_TRY(m->ctx, add_enclosure(m, from, to));
  to->location = from->shape.location;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
  return find(m, DEA_NAMED_PLY, &from->ply, &to->ply);
}

static dea_status add_contact(struct maker *m, size_t i)
{
  const struct dea_parts_contact *from = &m->parts->contacts[i];
  struct dea_layout_contact *to = &m->out->contacts[i];
  to->top = from->side.value == DEA_SIDE_TOP;
  to->name = keep(m, from->name.text);
  to->gap_m = or_zero(&from->gap_m);
  to->location = from->shape.location;
  to->with = DEA_LAYOUT_NONE;
  DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
  DEA_TRY(m->ctx, find(m, DEA_NAMED_PLY, &from->ply, &to->ply));
  return from->with.origin != DEA_ABSENT ? find(m, DEA_NAMED_PLY, &from->with, &to->with) : DEA_OK;
}

// Monitors ---------------------------------------------------------------------------------------

/* Whether a ply lies at both ends of a line, or in a region somewhere. */
static bool lies_there(const struct dea_layout *l, size_t ply, const struct dea_layout_monitor *to)
{
  size_t own = l->plies[ply].region;
  if (own == DEA_LAYOUT_NONE) {
    return false;
  }
  if (to->kind == DEA_MONITOR_REGION) {
    return to->region != DEA_LAYOUT_NONE && !(dea_layout_overlap_m2(l, to->region, own) <= 0);
  }
  int points = to->kind == DEA_MONITOR_LINE ? 2 : 1;
  for (int k = 0; k < points; k++) {
    if (!dea_layout_holds(l, own, to->at_m[k])) {
      return false;
    }
  }
  return true;
}

static dea_status find_own_ply(const struct maker *m, const struct dea_parts_monitor *from,
                               struct dea_layout_monitor *to)
{
  if (from->ply.origin != DEA_ABSENT) {
    return find(m, DEA_NAMED_PLY, &from->ply, &to->ply);
  }
  to->ply = m->out->ply_count;
  while (to->ply > 0 && !lies_there(m->out, to->ply - 1, to)) {
    to->ply--;
  }
  if (to->ply == 0) {
    to->ply = DEA_LAYOUT_NONE;
    return dea_finding_add(m->ctx, DEA_ERROR, from->name.location,
                           "no ply lies where the monitor '%.60s' is", from->name.text);
  }
  to->ply--;
  return DEA_OK;
}

static dea_status add_monitor(struct maker *m, size_t i)
{
  const struct dea_parts_monitor *from = &m->parts->monitors[i];
  struct dea_layout_monitor *to = &m->out->monitors[i];
  to->name = keep(m, from->name.text);
  to->location = from->name.location;
  to->ply = to->region = to->body = to->pressure = to->contact = DEA_LAYOUT_NONE;
  if (from->body.origin != DEA_ABSENT) {
    to->kind = DEA_MONITOR_BODY;
    return find(m, DEA_NAMED_BODY, &from->body, &to->body);
  }
  if (from->pressure.origin != DEA_ABSENT) {
    to->kind = DEA_MONITOR_VOLUME;
    return find(m, DEA_NAMED_PRESSURE, &from->pressure, &to->pressure);
  }
  if (from->contact.origin != DEA_ABSENT) {
    to->kind = DEA_MONITOR_CONTACT;
    return find(m, DEA_NAMED_CONTACT, &from->contact, &to->contact);
  }
  if (from->shape.origin != DEA_ABSENT) {
    to->kind = DEA_MONITOR_REGION;
    DEA_TRY(m->ctx, find(m, DEA_NAMED_SHAPE, &from->shape, &to->region));
    return to->region != DEA_LAYOUT_NONE ? find_own_ply(m, from, to) : DEA_OK;
  }
  bool point = from->at_count > 0;
  to->kind = point ? DEA_MONITOR_POINT : DEA_MONITOR_LINE;
  for (int k = 0; k < 2; k++) {
    to->at_m[0][k] = point ? from->at_m[k].si : from->from_m[k].si;
    to->at_m[1][k] = point ? 0 : from->to_m[k].si;
  }
  return find_own_ply(m, from, to);
}

// All --------------------------------------------------------------------------------------------

/* A list of the layout, made of one of the file; or what is done between two of them. */
static const struct step {
  size_t list, count, size; // places of the list and its length in the layout; of an item
  size_t given;             // place of the length in the parts of the file
  dea_status (*add)(struct maker *m, size_t i);
  dea_status (*once)(struct maker *m); // NULL: a list
} steps[] = {
#define LIST(items, number, add)                                                                   \
  {                                                                                                \
    offsetof(struct dea_layout, items), offsetof(struct dea_layout, number),                       \
        sizeof *((struct dea_layout *)NULL)->items, offsetof(struct dea_parts, number), add, NULL  \
  }
    LIST(plies, ply_count, add_ply),
    {.once = add_channels},
    LIST(electrodes, electrode_count, add_electrode),
    {.once = check_channels},
    LIST(supports, support_count, add_support),
    LIST(bodies, body_count, add_body),
    LIST(springs, spring_count, add_spring),
    LIST(pressures, pressure_count, add_pressure),
    LIST(contacts, contact_count, add_contact),
    LIST(monitors, monitor_count, add_monitor),
#undef LIST
};

static dea_status add_list(struct maker *m, const struct step *step)
{
  char *layout = (char *)m->out;
  size_t count;
  memcpy(&count, (const char *)m->parts + step->given, sizeof count);
  void *items = dea_arena_alloc(&m->out->memory, count, step->size);
  DEA_TRY(m->ctx, dea_arena_status(&m->out->memory));
  memcpy(layout + step->list, &items, sizeof items);
  memcpy(layout + step->count, &count, sizeof count);
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(m->ctx, step->add(m, i));
  }
  return dea_arena_status(&m->out->memory);
}

dea_status dea_generator_parts(struct dea_context *ctx, const struct dea_design *design,
                               struct dea_device *device)
{
  const double g = DEA_STANDARD_GRAVITY_M_PER_S2;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  struct maker m = {.ctx = ctx, .design = design, .parts = design->parts};
  device->gravity = (enum dea_gravity)design->gravity.value;
  DEA_TRY(ctx, dea_layout_create(ctx, &device->layout));
  m.out = device->layout;
  m.out->gravity_m_per_s2[2] = device->gravity == DEA_GRAVITY_FIBRES_UP     ? -g
                               : device->gravity == DEA_GRAVITY_FIBRES_DOWN ? g
                                                                            : 0;
  DEA_TRY(ctx, dea_shape_regions_build(ctx, design, m.out));
  for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
    DEA_TRY(ctx, steps[i].once != NULL ? steps[i].once(&m) : add_list(&m, &steps[i]));
  }
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    return DEA_OK; // where things lie says nothing then
  }
  fit_breakdown(&m);
  DEA_TRY(ctx, check_dielectrics(&m));
  DEA_TRY(ctx, dea_layout_check(ctx, m.out, dea_design_highest_V(design)));
  DEA_TRY(ctx, dea_device_find_disc(ctx, device));
  DEA_TRY(ctx, dea_geometry_fit_studies(ctx, design, device));
  return dea_layout_find_symmetry(ctx, m.out);
}
