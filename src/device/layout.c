#include "device/layout.h"

#include <math.h>
#include <string.h>

dea_status dea_layout_create(struct dea_context *ctx, struct dea_layout **out)
{
  struct dea_layout *layout = dea_alloc(ctx, 1, sizeof *layout);
  *out = NULL;
  DEA_TRY_MEMORY(layout != NULL);
  *layout = (struct dea_layout){.ctx = ctx, .memory = {.ctx = ctx}};
  layout->channels = dea_arena_alloc(&layout->memory, 1, sizeof *layout->channels);
  if (layout->memory.failed) {
    dea_layout_destroy(ctx, layout);
    return DEA_E_MEMORY;
  }
  layout->channels[0].name = "ground";
  layout->channel_count = 1;
  *out = layout;
  return DEA_OK;
}

void dea_layout_destroy(struct dea_context *ctx, struct dea_layout *layout)
{
  if (layout != NULL) {
    for (size_t i = 0; i < layout->region_count; i++) {
      dea_region_free(&layout->regions[i].region);
    }
    dea_arena_free(&layout->memory);
    dea_free(ctx, layout);
  }
}

#define FIND_BY_NAME(items, count)                                                                 \
  for (size_t i = 0; i < (count); i++) {                                                           \
    if (strcmp((items)[i].name, name) == 0) {                                                      \
      return i;                                                                                    \
    }                                                                                              \
  }                                                                                                \
  return DEA_LAYOUT_NONE

size_t dea_layout_find_body(const struct dea_layout *layout, const char *name)
{
  FIND_BY_NAME(layout->bodies, layout->body_count);
}

size_t dea_layout_find_channel(const struct dea_layout *layout, const char *name)
{
  FIND_BY_NAME(layout->channels, layout->channel_count);
}

bool dea_layout_has_sheet_resistance(const struct dea_layout *layout)
{
  bool any = false;
  for (size_t i = 0; i < layout->electrode_count; i++) {
    any = any || layout->electrodes[i].sheet_resistance_ohm > 0;
  }
  return any;
}

/* Whether an electrode lies on that face of a ply, its own or its neighbour's in the list. */
static bool lies_on(const struct dea_layout_electrode *electrode, size_t ply, bool top)
{
  return (electrode->ply == ply && electrode->top == top) ||
         (top && electrode->ply == ply + 1 && !electrode->top) ||
         (!top && electrode->ply + 1 == ply && electrode->top);
}

bool dea_layout_next_pair(const struct dea_layout *layout, size_t ply, size_t *at,
                          const struct dea_layout_electrode *pair[2])
{
  const size_t count = layout->electrode_count;
  while (*at < count * count) {
    pair[0] = &layout->electrodes[*at / count];
    pair[1] = &layout->electrodes[*at % count];
    ++*at;
    if (lies_on(pair[0], ply, true) && lies_on(pair[1], ply, false) &&
        pair[0]->channel != pair[1]->channel) {
      return true;
    }
  }
  return false;
}

bool dea_layout_is_dielectric(const struct dea_layout *layout, size_t ply)
{
  const struct dea_layout_electrode *pair[2];
  return dea_layout_next_pair(layout, ply, &(size_t){0}, pair);
}

const struct dea_layout_ply *dea_layout_film(const struct dea_layout *layout)
{
  size_t i = 0;
  while (i < layout->ply_count && !dea_layout_is_dielectric(layout, i)) {
    i++;
  }
  return i < layout->ply_count ? &layout->plies[i] : NULL;
}

bool dea_support_pulls(const struct dea_layout_support *support)
{
  const double *force = support->force_N;
  return force[0] != 0 || force[1] != 0 || force[2] != 0;
}

bool dea_support_is_frame(const struct dea_layout_support *support)
{
  return support->edge && support->within == DEA_LAYOUT_NONE && support->components == 7;
}

void dea_layout_box_m(const struct dea_layout *layout, double out[4])
{
  out[0] = out[1] = INFINITY;
  out[2] = out[3] = -INFINITY;
  for (size_t i = 0; i < layout->ply_count; i++) {
    dea_region_grow_box(&layout->regions[layout->plies[i].region].region, out);
  }
}

// Symmetry ---------------------------------------------------------------------------------------

/* Regions with the number of what makes them differ from others. */
struct labelled {
  const struct dea_region **region;
  int *label;
  size_t count;
};

static void add(struct labelled *out, const struct dea_layout *layout, size_t region, int label)
{
  out->region[out->count] = &layout->regions[region].region;
  out->label[out->count++] = label;
}

/* Parts of one kind share labels from `first` on: the number of the first part that is like it but
 * for the region. */
#define LIKE_ONES(items, count, same)                                                              \
  for (size_t i = 0; i < (count); i++) {                                                           \
    size_t j = 0;                                                                                  \
    while (j < i && !(same)) {                                                                     \
      j++;                                                                                         \
    }                                                                                              \
    add(out, layout, (items)[i].region, first + (int)j);                                           \
  }                                                                                                \
  first += (int)(count)

static void label_all(const struct dea_layout *layout, struct labelled *out)
{
  const struct dea_layout_electrode *e = layout->electrodes;
  const struct dea_layout_support *s = layout->supports;
  const struct dea_layout_body *b = layout->bodies;
  const struct dea_layout_pressure *p = layout->pressures;
  const struct dea_layout_contact *c = layout->contacts;
  int first = 1;
  for (size_t i = 0; i < layout->ply_count; i++) { // two plies are never one another's image
    add(out, layout, layout->plies[i].region, first++);
  }
  LIKE_ONES(e, layout->electrode_count,
            e[j].ply == e[i].ply && e[j].top == e[i].top && e[j].channel == e[i].channel &&
                e[j].sheet_resistance_ohm == e[i].sheet_resistance_ohm);
  LIKE_ONES(s, layout->support_count,
            s[j].edge == s[i].edge && s[j].components == s[i].components &&
                s[j].hinged == s[i].hinged &&
                // written alike
                // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c)
                memcmp(s[j].move_m, s[i].move_m, sizeof s[i].move_m) == 0 &&
                // a force is that of one support alone
                (j == i || !dea_support_pulls(&s[i])));
  for (size_t i = 0; i < layout->support_count; i++) {
    if (s[i].within != DEA_LAYOUT_NONE) {
      add(out, layout, s[i].within, first + (int)i);
    }
  }
  first += (int)layout->support_count;
  LIKE_ONES(b, layout->body_count, false);
  LIKE_ONES(p, layout->pressure_count,
            p[j].ply == p[i].ply && p[j].top == p[i].top && p[j].pressure_Pa == p[i].pressure_Pa &&
                (j == i || (p[j].encloses == DEA_OPEN && p[i].encloses == DEA_OPEN)));
  LIKE_ONES(c, layout->contact_count, false);
  for (size_t i = 0; i < layout->monitor_count; i++) {
    if (layout->monitors[i].kind == DEA_MONITOR_REGION) {
      add(out, layout, layout->monitors[i].region, first + (int)i);
    }
  }
}

/* Of what a symmetry has, what a film with two axes of pre-stretch keeps: half a turn, and mirrors
 * along these axes. */
static void keep_axes(struct dea_symmetry *symmetry, double angle_rad)
{
  const double quarter = 0.5 * DEA_PI;
  bool all = symmetry->order == 0;
  double off = symmetry->mirrors > 0 ? (angle_rad - symmetry->mirror_rad) / symmetry->step_rad : 0;
  bool mirrored = all || (symmetry->mirrors > 0 && fabs(off - round(off)) < 1e-6);
  double axis = fmod(fmod(angle_rad, quarter) + quarter, quarter);
  bool half_turn = symmetry->order % 2 == 0;
  symmetry->order = half_turn ? 2 : 1;
  symmetry->mirrors = mirrored ? symmetry->order : 0;
  symmetry->mirror_rad = half_turn ? axis : fmod(angle_rad + 2 * quarter, 2 * quarter);
  symmetry->step_rad = half_turn ? quarter : 2 * quarter;
}

dea_status dea_layout_find_symmetry(struct dea_context *ctx, struct dea_layout *layout)
{
  size_t most = layout->ply_count + layout->electrode_count + 2 * layout->support_count +
                layout->body_count + layout->pressure_count + layout->contact_count +
                layout->monitor_count;
  struct dea_arena arena = {.ctx = ctx};
  struct labelled all = {.region = dea_arena_alloc(&arena, most + 1, sizeof *all.region),
                         .label = dea_arena_alloc(&arena, most + 1, sizeof *all.label)};
  dea_status status = dea_arena_status(&arena);
  if (status == DEA_OK) {
    label_all(layout, &all);
    status = dea_symmetry_find(ctx, all.region, all.label, all.count, 0, &layout->symmetry);
    layout->symmetry_found = status == DEA_OK;
  }
  for (size_t i = 0; i < layout->ply_count && status == DEA_OK; i++) {
    const struct dea_layout_ply *ply = &layout->plies[i];
    if (ply->pre_stretch[0] != ply->pre_stretch[1]) {
      keep_axes(&layout->symmetry, ply->angle_rad);
    }
    if (ply->material.law != NULL && ply->material.law->anisotropic && !layout->polar) {
      keep_axes(&layout->symmetry, ply->angle_rad + ply->material.fibre_angle_rad);
    }
  }
  dea_arena_free(&arena);
  return status;
}
