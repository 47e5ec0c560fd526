/* The process sheet of a device of any layout: what is cut and printed, and how it goes together.
 */
#include "fabricate/layout_parts.h"
#include "fabricate/process.h"
#include "fabricate/process_parts.h"
#include "fabricate/tolerance_effect.h"
#include "figures/dimensions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NUMBER = 32, WORDS = 256 };

double dea_plies_mass_kg(const struct dea_layout *layout)
{
  double mass = 0;
  for (size_t i = 0; i < layout->ply_count; i++) {
    const struct dea_layout_ply *ply = &layout->plies[i];
    double density = ply->material.density_kg_per_m3;
    mass += density > 0 ? density * ply->thickness_m *
                              dea_region_area_m2(&layout->regions[ply->region].region)
                        : NAN;
  }
  return mass;
}

struct sheet {
  const struct dea_workshop *w;
  const struct dea_layout *layout;
  struct dea_document *to;
};

static double area_of(const struct sheet *s, size_t region)
{
  return dea_region_area_m2(&s->layout->regions[region].region);
}

/* How much larger the flat film is than the unstretched one. */
static double stretched_area(const struct dea_layout_ply *ply)
{
  return ply->pre_stretch[0] * ply->pre_stretch[1];
}

static void write_size(const struct sheet *s, const double half_m[2], const char *part, char *out)
{
  char a[NUMBER], b[NUMBER];
  double side[2] = {2 * half_m[0], 2 * half_m[1]};
  const struct dea_part *of = part != NULL ? dea_workshop_find(s->w, part) : NULL;
  if (of != NULL) {
    double box[4];
    dea_part_box(of, box);
    side[0] = box[2] - box[0];
    side[1] = box[3] - box[1];
  }
  dea_length_text(a, sizeof a, side[0]);
  dea_length_text(b, sizeof b, side[1]);
  snprintf(out, WORDS, "%s mm x %s mm", a, b);
}

/* ---- bill of materials ---- */

static void add_ply(const struct sheet *s, size_t i)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  bool film = dea_ply_is_stretched(ply);
  size_t count = dea_ply_count_like(s->layout, i);
  double area = area_of(s, ply->region);
  double cut =
      film ? 4 * s->w->capacity.blank_m[0] * s->w->capacity.blank_m[1] / stretched_area(ply) : area;
  double mass = area * dea_ply_stretched_layer_m(ply) * ply->material.density_kg_per_m3;
  char item[WORDS], note[WORDS], weight[64] = "mass unknown: the material has no density";
  if (mass > 0) {
    snprintf(weight, sizeof weight, "%.4g g of it in the device", 1e3 * mass * (double)count);
  }
  snprintf(item, sizeof item, "%.60s%s", ply->name,
           film                        ? ", as cut"
           : ply->material.law == NULL ? ", finished"
                                       : "");
  if (count > 1) {
    size_t n = strlen(item);
    snprintf(item + n, sizeof item - n, ", %zu times", count);
  }
  snprintf(note, sizeof note, "%.4g \xc2\xb5m thick%s; %s", 1e6 * dea_ply_layer_m(ply),
           film ? ", before stretching" : "", weight);
  dea_process_add_material(s->to, s->w->plan.copies, item, ply->material.name, cut * (double)count,
                           NAN, note);
}

/* Area of the electrodes of a face, as they are printed, those between layers included. */
static double printed_area(const struct sheet *s, size_t ply, bool top)
{
  const size_t layers = dea_ply_layers(&s->layout->plies[ply]);
  const size_t times = top ? (layers + 1) / 2 : layers / 2 + 1; // by turns, from the bottom on
  double area = 0;
  for (size_t i = 0; i < s->layout->electrode_count; i++) {
    const struct dea_layout_electrode *e = &s->layout->electrodes[i];
    area += e->ply == ply && e->top == top ? area_of(s, e->region) : 0;
  }
  return (double)times * area / stretched_area(&s->layout->plies[ply]);
}

double dea_ink_area_m2(const struct dea_workshop *workshop)
{
  const struct sheet s = {workshop, workshop->plan.device->layout, NULL};
  double area = 0;
  for (size_t i = 0; i < s.layout->ply_count; i++) {
    area += printed_area(&s, i, false) + printed_area(&s, i, true);
  }
  return area;
}

static void add_materials(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  const struct dea_fab_room *capacity = &s->w->capacity;
  double printed = dea_ink_area_m2(s->w), stencils = 0;
  int copies = s->w->plan.copies;
  dea_process_begin_materials(s->to, copies);
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_ply_like(l, i) == i) {
      add_ply(s, i);
    }
    for (int top = 0; top < 2; top++) {
      stencils +=
          dea_face_like(l, i, top == 1) == i
              ? 4 * capacity->blank_m[0] * capacity->blank_m[1] / stretched_area(&l->plies[i])
              : 0;
    }
  }
  if (printed > 0) {
    dea_process_add_material(s->to, copies, "electrodes", "not given", printed, NAN,
                             "As printed, without marks. The design gives them no thickness: a "
                             "stiff electrode is a ply");
    dea_process_add_material(s->to, 1, "stencils", "sheet, such as PET", stencils, NAN,
                             "Before cutting; its thickness sets how much is printed");
  }
  if (dea_layout_has_frame(s->w)) {
    dea_process_add_material(s->to, capacity->held ? copies : 1, "frame", "rigid plate",
                             4 * capacity->frame_m[0] * capacity->frame_m[1], NAN,
                             capacity->held ? "Before cutting; it stays"
                                            : "Before cutting; used again");
  }
  for (size_t i = 0; i < l->body_count; i++) {
    char note[WORDS] = "The design gives it no mass beside its plies'";
    if (l->bodies[i].mass_kg > 0) {
      snprintf(note, sizeof note, "%.4g g", 1e3 * l->bodies[i].mass_kg);
    }
    dea_process_add_material(s->to, copies, l->bodies[i].name, "rigid",
                             area_of(s, l->bodies[i].region), NAN, note);
  }
}

/* ---- steps ---- */

static void add_cutting(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  char name[DEA_PART_NAME], size[WORDS], grid[NUMBER];
  dea_length_text(grid, sizeof grid, s->w->capacity.grid_m);
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    size_t count = dea_ply_count_like(l, i);
    if (dea_ply_like(l, i) != i || !dea_ply_is_stretched(ply)) {
      continue;
    }
    dea_blank_name(l, i, name);
    write_size(s, s->w->capacity.blank_m, name, size);
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "Cut %zu film%s of %s (%s) from %s, %.4g \xc2\xb5m thick, and draw the "
                     "crosses of the grid and the three alignment marks%s.",
                     count, count > 1 ? "s" : "", size, name, ply->material.name,
                     1e6 * dea_ply_layer_m(ply), count > 1 ? " on each" : "");
  }
}

/* Channels of the electrodes on a face: "drive, ground". */
static void write_channels(const struct sheet *s, size_t ply, bool top, char *out)
{
  size_t used = 0;
  out[0] = '\0';
  for (size_t i = 0; i < s->layout->electrode_count && used < WORDS; i++) {
    const struct dea_layout_electrode *e = &s->layout->electrodes[i];
    if (e->ply == ply && e->top == top) {
      int n = snprintf(out + used, WORDS - used, "%s%.40s", used > 0 ? ", " : "",
                       s->layout->channels[e->channel].name);
      used += n > 0 ? (size_t)n : 0;
    }
  }
}

static void add_printing(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  const struct dea_fabrication *f = &s->w->plan.design->fabrication;
  char name[DEA_PART_NAME], channels[WORDS];
  for (size_t i = 0; i < 2 * l->ply_count; i++) { // the bottom of each ply, then its top
    bool top = i % 2 == 1;
    size_t like = dea_face_like(l, i / 2, top);
    if (like == DEA_LAYOUT_NONE) {
      continue;
    }
    dea_stencil_name(l, like, top, name);
    write_channels(s, i / 2, top, channels);
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "Print onto the %s of %s through %s, its holes over the marks%s. Channel: %s.",
                     top ? "top" : "bottom", l->plies[i / 2].name, name,
                     dea_ply_is_stretched(&l->plies[i / 2]) ? ", before it is stretched" : "",
                     channels);
  }
  if (l->electrode_count > 0) {
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "After each printing cure at %.4g \xc2\xb0"
                     "C for %.4g h.",
                     f->cure_temperature_K.si - 273.15, f->cure_time_s.si / 3600);
  }
}

/* "by 1.2 in all directions", or along two axes. */
static void write_stretch(const struct dea_layout_ply *ply, char *out)
{
  const double *l = ply->pre_stretch;
  double degrees = ply->angle_rad * 180 / acos(-1);
  if (l[0] == l[1]) {
    snprintf(out, WORDS, "by %.4g in all directions", l[0]);
  } else {
    snprintf(out, WORDS, "by %.4g at %.4g\xc2\xb0 from the x axis and by %.4g across that", l[0],
             degrees, l[1]);
  }
}

/* How a ply comes to what is there. */
enum way { FIRST, ABOVE, BELOW };

static void add_layers(const struct sheet *s, size_t i)
{
  char channels[2][WORDS];
  for (int top = 0; top < 2; top++) {
    write_channels(s, i, top == 1, channels[top]);
  }
  if (dea_ply_layers(&s->layout->plies[i]) > 1) {
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "%s has %zu layers: do so with each of them, one on the other. Electrodes "
                     "by turns from the bottom up: %s; %s.",
                     s->layout->plies[i].name, dea_ply_layers(&s->layout->plies[i]), channels[0],
                     channels[1]);
  }
}

static void add_ply_step(const struct sheet *s, size_t i, enum way way)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  char name[DEA_PART_NAME], stretch[WORDS], where[WORDS];
  bool film = dea_ply_is_stretched(ply);
  size_t like = dea_ply_like(s->layout, i);
  if (way == FIRST) {
    snprintf(where, sizeof where, "%s", film ? ". Fix it on the frame, holes over the marks" : "");
  } else {
    snprintf(where, sizeof where, ". %s what is there%s, marks over marks",
             film ? "Lay it onto" : "Bond it to", way == BELOW ? ", from below" : "");
  }
  if (film) {
    dea_blank_name(s->layout, like, name);
    write_stretch(ply, stretch);
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "Stretch %s (%s) %s, until its grid and marks cover the template; it is then "
                     "%.4g \xc2\xb5m thick%s.",
                     ply->name, name, stretch, 1e6 * dea_ply_stretched_layer_m(ply), where);
    add_layers(s, i);
    return;
  }
  dea_outline_name(s->layout, like, name);
  const struct dea_part *part = dea_workshop_find(s->w, name);
  size_t pieces = part != NULL ? dea_part_pieces(part) : 1;
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cut %s (%s, %zu piece%s) from %s, %.4g \xc2\xb5m thick%s.", ply->name, name,
                   pieces, pieces > 1 ? "s on their carrier" : "", ply->material.name,
                   1e6 * dea_ply_stretched_layer_m(ply), where);
  add_layers(s, i);
}

/* Films that are stretched come first: what lies below them is bonded to them from below. */
static void add_assembly(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  size_t start = 0;
  while (start < l->ply_count && !dea_ply_is_stretched(&l->plies[start])) {
    start++;
  }
  start = start < l->ply_count ? start : 0;
  for (size_t i = start; i < l->ply_count; i++) {
    add_ply_step(s, i, i == start ? FIRST : ABOVE);
  }
  for (size_t i = start; i-- > 0;) {
    add_ply_step(s, i, BELOW);
  }
  for (size_t i = 0; i < l->body_count; i++) {
    char name[DEA_PART_NAME];
    dea_body_name(l, i, name);
    dea_document_add(s->to, DEA_BLOCK_STEP,
                     "Cut %s (%s) from a plate that does not bend and bond it where the template "
                     "shows it.",
                     l->bodies[i].name, name);
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_layout_has_outline(s->w, i) && dea_ply_is_stretched(&l->plies[i])) {
      char name[DEA_PART_NAME];
      dea_outline_name(l, i, name);
      dea_document_add(s->to, DEA_BLOCK_STEP,
                       "Hold what is a support (below), then cut %s along its outline "
                       "(%s): what it is bonded to takes its tension.",
                       l->plies[i].name, name);
    }
  }
}

static void add_supports(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  for (size_t i = 0; i < l->support_count; i++) {
    const struct dea_layout_support *p = &l->supports[i];
    bool within = p->within != DEA_LAYOUT_NONE;
    char held[NUMBER] = "";
    if (p->components == 0) {
      continue;
    }
    for (int k = 0; k < 3; k++) {
      size_t n = strlen(held);
      if ((p->components & 1 << k) != 0) {
        snprintf(held + n, sizeof held - n, "%s%c", n > 0 ? ", " : "", "xyz"[k]);
      }
    }
    dea_document_add(s->to, DEA_BLOCK_STEP, "Hold %s%s%s%s along %s%s.",
                     p->edge ? "the edge of " : "", l->regions[p->region].name,
                     within ? " within " : "", within ? l->regions[p->within].name : "", held,
                     p->hinged                                   ? ", so that it may turn"
                     : p->edge && !within && s->w->capacity.held ? ": the frame does that"
                                                                 : "");
  }
  for (size_t i = 0; i < l->spring_count; i++) {
    const struct dea_layout_spring *p = &l->springs[i];
    static const char *const along[] = {"along x", "along y", "along z",
                                        "about x", "about y", "about z"};
    char force[WORDS] = "with the force of its table";
    if (p->count == 0) {
      snprintf(force, sizeof force, "%.4g %s", p->stiffness, p->component < 3 ? "N/m" : "N m/rad");
    }
    dea_document_add(s->to, DEA_BLOCK_STEP, "Fasten the spring %s to %s, %s.", along[p->component],
                     l->bodies[p->body].name, force);
  }
  for (size_t i = 1; i < l->channel_count; i++) {
    const struct dea_layout_channel *c = &l->channels[i];
    if (c->waveform != NULL) {
      dea_document_add(s->to, DEA_BLOCK_STEP, "Connect %s to a source of its own (%s).", c->name,
                       c->waveform);
    } else if (c->own_V != 0) {
      dea_document_add(s->to, DEA_BLOCK_STEP, "Connect %s: %.4g of the voltage, and %+.4g V.",
                       c->name, c->ratio, c->own_V);
    } else if (c->ratio == 0) {
      dea_document_add(s->to, DEA_BLOCK_STEP, "Connect %s to ground.", c->name);
    } else if (c->ratio == 1) {
      dea_document_add(s->to, DEA_BLOCK_STEP, "Connect %s to the voltage.", c->name);
    } else {
      dea_document_add(s->to, DEA_BLOCK_STEP, "Connect %s: %.4g of the voltage.", c->name,
                       c->ratio);
    }
  }
}

/* ---- check list ---- */

/* Main motions of monitors, in the order of enum dea_observed. */
static const char *const motions[DEA_OBSERVED_COUNT] = {[DEA_OBSERVED_X] = "x",
                                                        [DEA_OBSERVED_Y] = "y",
                                                        [DEA_OBSERVED_Z] = "z",
                                                        [DEA_OBSERVED_STRETCH] = "stretch",
                                                        [DEA_OBSERVED_AREA_STRETCH] =
                                                            "area stretch"};

/* Row of a number of a ply; plies that are cut alike deviate alike. found: NULL: not asked for. */
static void add_check(const struct sheet *s, const struct dea_layout_sensitivity *found, size_t ply,
                      enum dea_ply_deviation deviation, const char *wanted, const char *tolerance)
{
  static const char *const what[] = {"thickness", "pre-stretch", "pre-stretch across it"};
  const double *stretch = s->layout->plies[ply].pre_stretch;
  dea_document_add(s->to, DEA_BLOCK_ROW, "%s of %s%s", what[deviation], s->layout->plies[ply].name,
                   deviation == DEA_PLY_PRE_STRETCH && stretch[0] != stretch[1] ? ", first axis"
                                                                                : "");
  dea_document_cell(s->to, "%s", wanted);
  dea_document_cell(s->to, "%s", tolerance);
  for (size_t m = 0; found != NULL && m < found->seen; m++) {
    const bool length = found->motion[m] <= DEA_OBSERVED_Z;
    const double value = found->value[m] - (length ? 0 : 1);
    double effect = 0;
    for (size_t i = ply; i < s->layout->ply_count; i++) {
      effect += dea_ply_like(s->layout, i) == ply ? found->effect[i][deviation][m] : 0;
    }
    dea_process_add_effect(s->to, effect, value, length);
  }
}

static void add_ply_checks(const struct sheet *s, const struct dea_layout_sensitivity *found,
                           size_t i)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  const struct dea_fabrication *f = &s->w->plan.design->fabrication;
  const double grid = 5 * s->w->capacity.grid_m;
  char number[NUMBER], other[NUMBER], wanted[WORDS], tolerance[WORDS];
  snprintf(wanted, sizeof wanted, "%.4g \xc2\xb5m%s", 1e6 * dea_ply_layer_m(ply),
           dea_ply_is_stretched(ply) ? " unstretched" : "");
  snprintf(tolerance, sizeof tolerance, "\xc2\xb1%.3g %%", 100 * f->tolerance.thickness.si);
  add_check(s, found, i, DEA_PLY_THICKNESS, wanted, tolerance);
  for (int k = 0; k < 2 && dea_ply_is_stretched(ply); k++) {
    if (k == 1 && ply->pre_stretch[0] == ply->pre_stretch[1]) {
      break;
    }
    dea_length_text(number, sizeof number, grid);
    dea_length_text(other, sizeof other, grid / ply->pre_stretch[k]);
    snprintf(wanted, sizeof wanted, "%.4g: five spacings of the grid, %s mm before, are %s mm",
             ply->pre_stretch[k], other, number);
    dea_length_text(number, sizeof number,
                    grid / ply->pre_stretch[k] * f->tolerance.pre_stretch.si);
    snprintf(tolerance, sizeof tolerance, "\xc2\xb1%.3g: \xc2\xb1%s mm",
             f->tolerance.pre_stretch.si, number);
    add_check(s, found, i, k == 0 ? DEA_PLY_PRE_STRETCH : DEA_PLY_PRE_STRETCH_ACROSS, wanted,
              tolerance);
  }
}

/* What the effects are of. */
static void add_source(const struct sheet *s, const struct dea_layout_sensitivity *found)
{
  if (found->seen == 0 || isnan(found->voltage_V)) {
    dea_document_add(
        s->to, DEA_BLOCK_TEXT,
        found->seen == 0
            ? "What a deviation does is unknown: the design has no monitor."
            : "What a deviation does is unknown: model 3d is not installed "
              "(dea doctor), or has no state to be trusted at the voltages of this design; a "
              "preview (compute.solid.film: membrane beside stiff parts) is none.");
    return;
  }
  dea_document_add(s->to, DEA_BLOCK_TEXT,
                   "Effect of each tolerance (plus, with everything else as designed; plies that "
                   "are cut alike deviate alike; per cent below 0: it moves less) by model 3d at "
                   "%.4g kV, on:",
                   1e-3 * found->voltage_V);
  for (size_t m = 0; m < found->seen; m++) {
    const bool length = found->motion[m] <= DEA_OBSERVED_Z;
    dea_document_add(s->to, DEA_BLOCK_TEXT, "\xe2\x80\x93 %s: %s %.4g%s from the flat film",
                     s->layout->monitors[m].name, motions[found->motion[m]],
                     (length ? 1e6 : 1) * found->value[m], length ? " \xc2\xb5m" : "");
  }
  if (found->seen < s->layout->monitor_count) {
    dea_document_add(s->to, DEA_BLOCK_TEXT, "\xe2\x80\x93 not of the %zu monitors after these",
                     s->layout->monitor_count - found->seen);
  }
  dea_process_add_voltage(s->to, found->voltage_V, dea_design_highest_V(s->w->plan.design));
}

static void write_checks(const struct sheet *s, const struct dea_layout_sensitivity *found)
{
  static const double widths[][3 + DEA_SEEN_MAX] = {{0.3, 0.5, 0.2},
                                                    {0.25, 0.37, 0.15, 0.23},
                                                    {0.18, 0.28, 0.14, 0.2, 0.2},
                                                    {0.15, 0.22, 0.12, 0.17, 0.17, 0.17}};
  const struct dea_layout *l = s->layout;
  const struct dea_layout_sensitivity *shown =
      found != NULL && !isnan(found->voltage_V) ? found : NULL;
  char number[NUMBER];
  dea_document_add(s->to, DEA_BLOCK_HEADING, "Check list");
  if (found != NULL) {
    add_source(s, found);
  }
  dea_document_add(s->to, DEA_BLOCK_HEAD, "what");
  dea_document_cell(s->to, "wanted");
  dea_document_cell(s->to, "tolerance");
  for (size_t m = 0; shown != NULL && m < shown->seen; m++) {
    dea_document_cell(s->to, "%s, %s", l->monitors[m].name, motions[shown->motion[m]]);
  }
  dea_document_widths(s->to, widths[shown != NULL ? shown->seen : 0]);
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_ply_like(l, i) == i) {
      add_ply_checks(s, shown, i);
    }
  }
  dea_length_text(number, sizeof number, s->w->plan.kerf_m);
  dea_document_add(s->to, DEA_BLOCK_ROW, "kerf of the cutter");
  dea_document_cell(s->to, "%s mm, on a test square", number);
  dea_document_cell(s->to, "not given");
  for (size_t m = 0; shown != NULL && m < shown->seen; m++) {
    dea_document_cell(s->to, "unknown");
  }
  dea_document_add(
      s->to, DEA_BLOCK_NOTE,
      "Tolerances are those of the design's section fabrication.tolerance; those that nobody wrote "
      "are assumptions (docs/fabrication.md). %s",
      found == NULL ? "'dea fab --sensitivity' computes what they do to the monitors."
                    : "'dea run --sensitivity' has slopes by other numbers of the design.");
}

static dea_status add_checks(struct dea_context *ctx, const struct sheet *s, bool sensitivity)
{
  struct dea_layout_sensitivity found = {.effect = NULL};
  dea_status status = DEA_OK;
  if (sensitivity) {
    status = dea_layout_sensitivity_find(ctx, s->w->plan.design, s->w->plan.device, &found);
  }
  if (status == DEA_OK) {
    write_checks(s, sensitivity ? &found : NULL);
  }
  dea_free(ctx, found.effect);
  return status;
}

dea_status dea_process_write_layout(struct dea_context *ctx, const struct dea_workshop *workshop,
                                    bool sensitivity, struct dea_document *document)
{
  const struct sheet s = {workshop, workshop->plan.device->layout, document};
  add_materials(&s);
  dea_document_add(document, DEA_BLOCK_HEADING, "Steps");
  if (s.layout->ply_count > 1) {
    dea_document_add(document, DEA_BLOCK_NOTE,
                     "Plies lie on each other as the design lists them, from bottom to top. Glue "
                     "that has a thickness that counts is a ply of its own; there is no other.");
  }
  add_cutting(&s);
  add_printing(&s);
  add_assembly(&s);
  add_supports(&s);
  DEA_TRY(ctx, add_checks(ctx, &s, sensitivity));
  return DEA_OK;
}
