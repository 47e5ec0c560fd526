/* The process sheet: what is cut and printed, how it goes together, and what to check. */
#include "fabricate/process.h"

#include "base/file.h"
#include "base/html.h"
#include "device/geometry.h"
#include "fabricate/layout_parts.h"
#include "figures/dimensions.h"
#include "study/design_gradient.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// The file: HTML that needs nothing else ----------------------------------------------------------

static const char style[] =
    "body{font:15px/1.5 'DejaVu Sans',Arial,sans-serif;color:#202020;max-width:60em;"
    "margin:2em auto;padding:0 1em}h1{font-size:1.6em;border-bottom:1px solid #202020}"
    "h2{font-size:1.15em;margin-top:1.8em}table{border-collapse:collapse;width:100%;font-size:."
    "92em}"
    "th,td{text-align:left;vertical-align:top;padding:.35em .6em;border-bottom:1px solid #d5d8dd}"
    "th{border-bottom:1px solid #202020}.note{color:#6a6a6a;font-size:.88em}"
    "ol{padding-left:2.4em}li{margin:.5em 0}svg{width:100%;height:auto}"
    "@page{size:A4;margin:14mm}@media "
    "print{body{margin:0;max-width:none;font-size:10.5px}svg{max-height:150mm}h2{break-after:avoid}"
    "tr,li{break-inside:"
    "avoid}}";

/* A step, numbered and with a box to tick. */
#define STEP(words) "<li>\xe2\x98\x90 " words "</li>\n"
/* Between two cells of a row. */
#define CELL "</td><td>"

enum { NUMBER = 32, WORDS = 256 };

struct sheet {
  const struct dea_workshop *w;
  const struct dea_layout *layout;
  struct dea_text *to;
};

// Amounts -----------------------------------------------------------------------------------------

/* How much larger the flat film is than the unstretched one. */
static double stretched_area(const struct dea_layout_ply *ply)
{
  return ply->pre_stretch[0] * ply->pre_stretch[1];
}

/* The sheet of a stencil. */
static double stencil_area(const struct sheet *s, size_t ply)
{
  const double *blank = s->w->plan.blank_m;
  return 4 * blank[0] * blank[1] / stretched_area(&s->layout->plies[ply]);
}

static enum dea_part_kind stencil_kind(bool top)
{
  return top ? DEA_PART_TOP : DEA_PART_BOTTOM;
}

/* Area that is printed onto a face: all holes of its stencil, without loose pieces; 0: none. */
static double printed_area(const struct sheet *s, size_t ply, bool top)
{
  const struct dea_part *stencil = dea_workshop_part(s->w, stencil_kind(top), ply);
  return stencil != NULL ? stencil_area(s, ply) - dea_part_area_m2(stencil) : 0;
}

/* The same without its marks and pads. */
static double glued_area(const struct sheet *s, size_t ply)
{
  const struct dea_fab_plan *plan = &s->w->plan;
  double round = DEA_FAB_MARKS * plan->mark_m * plan->mark_m;
  for (size_t i = 0; i < plan->pad_count; i++) {
    const struct dea_layout_electrode *e = &s->layout->electrodes[plan->pad[i].electrode];
    round += e->ply == ply && !e->top ? plan->pad_m * plan->pad_m : 0;
  }
  return printed_area(s, ply, false) - DEA_PI * round / stretched_area(&s->layout->plies[ply]);
}

/* Blanks of plies that are cut alike. */
static double blank_area(const struct sheet *s, size_t ply)
{
  return dea_part_area_m2(dea_workshop_part(s->w, DEA_PART_BLANK, ply)) *
         (double)dea_ply_count_like(s->layout, ply);
}

static double area_of(const struct sheet *s, size_t region)
{
  return dea_region_area_m2(&s->layout->regions[region].region);
}

/* Thickness of what is printed or glued, of a ply that is not cut; 0: the design gives none. */
static double thickness_of(const struct sheet *s, enum dea_ply_kind kind)
{
  double thickness = 0;
  for (size_t i = 0; i < s->layout->ply_count; i++) {
    const struct dea_layout_ply *ply = &s->layout->plies[i];
    thickness =
        ply->kind == kind && !dea_ply_is_cut(ply) ? ply->thickness_unstretched_m : thickness;
  }
  return thickness;
}

void dea_amounts_find(const struct dea_workshop *workshop, struct dea_amounts *out)
{
  const struct sheet s = {workshop, workshop->plan.layout, NULL};
  const struct dea_fab_plan *plan = &workshop->plan;
  *out = (struct dea_amounts){.film_area_m2 = 0};
  for (size_t i = 0; i < s.layout->ply_count; i++) {
    const struct dea_layout_ply *ply = &s.layout->plies[i];
    const double density = ply->material.density_kg_per_m3;
    const size_t layers = dea_ply_layers(ply); // printed by turns, from the bottom on
    const double below = printed_area(&s, i, false), above = printed_area(&s, i, true);
    const bool blank = dea_ply_is_blank(s.layout, i) && dea_ply_like(s.layout, i) == i;
    out->film_area_m2 += blank ? blank_area(&s, i) : 0;
    out->ink_area_m2 += (double)(layers / 2 + 1) * below + (double)((layers + 1) / 2) * above;
    out->transfer_glue_area_m2 += below > 0 && above > 0 ? glued_area(&s, i) : 0;
    for (int top = 0; top < 2; top++) {
      out->stencil_sheet_area_m2 +=
          dea_face_like(s.layout, i, top == 1) == i ? stencil_area(&s, i) : 0;
    }
    out->mass_kg += density > 0 ? density * ply->thickness_m * area_of(&s, ply->region) : NAN;
  }
  const double ink = thickness_of(&s, DEA_PLY_ELECTRODE), glue = thickness_of(&s, DEA_PLY_GLUE);
  out->ink_volume_m3 = ink > 0 ? out->ink_area_m2 * ink : NAN;
  out->bond_area_m2 = dea_region_area_m2(&plan->bonded);
  out->bond_volume_m3 = glue > 0 ? out->bond_area_m2 * glue : NAN;
  out->frame_sheet_area_m2 = (plan->round ? DEA_PI : 4) * plan->frame_m[0] * plan->frame_m[1];
}

// Bill of materials -------------------------------------------------------------------------------

/* A row of it: for what, which material, how much of one and of all; a volume of NAN is left out.
 */
static void add_material(const struct sheet *s, int copies, const char *item, const char *material,
                         double area_m2, double volume_m3, const char *note)
{
  dea_html_add(s->to,
               "<tr><td>%s" CELL "%s" CELL "%.4g\xc2\xa0"
               "cm\xc2\xb2" CELL "%.4g\xc2\xa0"
               "cm\xc2\xb2" CELL,
               item, material, 1e4 * area_m2, 1e4 * area_m2 * copies);
  if (!isnan(volume_m3)) {
    dea_html_add(s->to, "%.4g\xc2\xa0mm\xc2\xb3 each, %.4g\xc2\xa0mm\xc2\xb3 in all. ",
                 1e9 * volume_m3, 1e9 * volume_m3 * copies);
  }
  dea_html_add(s->to, "%s</td></tr>\n", note);
}

static void add_ply(const struct sheet *s, size_t i)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  const bool film = dea_ply_is_blank(s->layout, i), tabs = i == s->w->plan.on_tabs;
  const size_t count = dea_ply_count_like(s->layout, i);
  const double area = area_of(s, ply->region);
  const double cut = film   ? blank_area(s, i)
                     : tabs ? DEA_PI * s->w->plan.frame_m[0] * s->w->plan.frame_m[1]
                            : area * (double)count;
  double mass = area * dea_ply_stretched_layer_m(ply) * ply->material.density_kg_per_m3;
  char item[WORDS], note[WORDS], weight[64] = "mass unknown: the material has no density";
  if (mass > 0) {
    snprintf(weight, sizeof weight, "%.4g g of it in the device", 1e3 * mass * (double)count);
  }
  snprintf(item, sizeof item, "%.60s%s", ply->name,
           film                        ? ", as cut"
           : tabs                      ? " with holder"
           : ply->material.law == NULL ? ", finished"
                                       : "");
  if (count > 1) {
    size_t n = strlen(item);
    snprintf(item + n, sizeof item - n, ", %zu times", count);
  }
  snprintf(note, sizeof note, "%.4g \xc2\xb5m thick%s; %s%s", 1e6 * dea_ply_layer_m(ply),
           dea_ply_is_stretched(ply) ? ", before stretching" : "", weight,
           tabs ? "; discs, before cutting" : "");
  add_material(s, s->w->plan.copies, item, ply->material.name, cut, NAN, note);
}

/* What is printed, and glue. */
static void add_ink(const struct sheet *s, const struct dea_amounts *a)
{
  const char *ink = s->w->plan.device->electrode.name;
  const int copies = s->w->plan.copies;
  if (a->ink_area_m2 > 0) {
    add_material(s, copies, "electrodes, leads, pads, marks", ink[0] != '\0' ? ink : "not given",
                 a->ink_area_m2, a->ink_volume_m3,
                 isnan(a->ink_volume_m3) ? "Volume unknown: the design gives them no thickness"
                                         : "Cured; solvent and what stays on the stencil come on "
                                           "top");
    add_material(s, 1, "stencils", "sheet, such as PET", a->stencil_sheet_area_m2, NAN,
                 "Before cutting. Its thickness sets how much is printed; the paper does not give "
                 "it");
  }
  if (a->transfer_glue_area_m2 > 0) {
    add_material(s, copies, "glue below bottom electrodes", "silicone (paper: LSR 4305)",
                 a->transfer_glue_area_m2, NAN,
                 "A thin layer, thickness unknown: neither the paper nor the design gives it. Pads "
                 "stay free");
  }
  if (a->bond_area_m2 > 0) {
    add_material(s, copies, "glue below fibres and anchors", "paper: ARclear 8932EE",
                 a->bond_area_m2, a->bond_volume_m3,
                 isnan(a->bond_volume_m3)
                     ? "Volume unknown: the design gives no thickness (fibres.bond.thickness)"
                     : "");
  }
}

static void add_materials(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  const struct dea_fab_plan *plan = &s->w->plan;
  struct dea_amounts a;
  dea_amounts_find(s->w, &a);
  dea_html_add(s->to,
               "<h2>Bill of materials</h2>\n<table>\n<tr><th>for</th><th>material</th>"
               "<th>one</th><th>all %d</th><th>remarks</th></tr>\n",
               plan->copies);
  for (size_t i = 0; i < l->ply_count; i++) {
    if (dea_ply_like(l, i) == i && dea_ply_is_cut(&l->plies[i])) {
      add_ply(s, i);
    }
  }
  add_ink(s, &a);
  if (dea_workshop_part(s->w, DEA_PART_FRAME, 0) != NULL) {
    add_material(s, plan->held ? plan->copies : 1, "frame", "rigid plate", a.frame_sheet_area_m2,
                 NAN, plan->held ? "Before cutting; it stays" : "Before cutting; used again");
  }
  for (size_t i = 0; i < l->body_count; i++) {
    char note[WORDS] = "The design gives it no mass beside its plies'";
    if (l->bodies[i].mass_kg > 0) {
      snprintf(note, sizeof note, "%.4g g", 1e3 * l->bodies[i].mass_kg);
    }
    add_material(s, plan->copies, l->bodies[i].name, "rigid", area_of(s, l->bodies[i].region), NAN,
                 note);
  }
  dea_html_add(s->to, "</table>\n");
}

// Steps -------------------------------------------------------------------------------------------

/* Sides of a part, or its diameter. */
static void write_size(const struct sheet *s, const struct dea_part *part, char *out)
{
  char a[NUMBER], b[NUMBER];
  double box[4];
  dea_part_box(part, box);
  dea_length_text(a, sizeof a, box[2] - box[0]);
  dea_length_text(b, sizeof b, box[3] - box[1]);
  if (s->w->plan.round && strcmp(a, b) == 0) {
    snprintf(out, WORDS, "%s mm diameter", a);
  } else {
    snprintf(out, WORDS, "%s mm x %s mm", a, b);
  }
}

static void add_cutting(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  char size[WORDS], grid[NUMBER];
  dea_length_text(grid, sizeof grid, s->w->plan.grid_m / s->w->plan.stretch);
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_layout_ply *ply = &l->plies[i];
    size_t count = dea_ply_count_like(l, i);
    if (dea_ply_like(l, i) != i || !dea_ply_is_blank(l, i)) {
      continue;
    }
    const struct dea_part *blank = dea_workshop_part(s->w, DEA_PART_BLANK, i);
    write_size(s, blank, size);
    dea_html_add(s->to,
                 STEP("Cut %zu film%s of %s (%s) from %s, %.4g \xc2\xb5m thick, and draw the "
                      "crosses of the grid, %s mm apart where the pre-stretch is the largest, and "
                      "the three alignment marks%s."),
                 count, count > 1 ? "s" : "", size, blank->name, ply->material.name,
                 1e6 * dea_ply_layer_m(ply), grid, count > 1 ? " on each" : "");
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
  const double celsius = f->cure_temperature_K.si - 273.15, hours = f->cure_time_s.si / 3600;
  char channels[WORDS];
  for (size_t i = 0; i < 2 * l->ply_count; i++) { // the bottom of each ply, then its top
    const bool top = i % 2 == 1;
    const char *ply = l->plies[i / 2].name;
    const struct dea_part *stencil = dea_workshop_part(s->w, stencil_kind(top), i / 2);
    if (stencil == NULL) {
      continue;
    }
    write_channels(s, i / 2, top, channels);
    if (!top) {
      dea_html_add(s->to,
                   STEP("Lay %s onto a PET carrier, its lower side up, so that its marks lie as in "
                        "%s, and print the bottom through it: electrodes, leads, pads and marks in "
                        "one go. Channel: %s. Cure at %.4g \xc2\xb0"
                        "C for %.4g h."),
                   ply, stencil->name, channels, celsius, hours);
      continue;
    }
    if (dea_workshop_part(s->w, DEA_PART_BOTTOM, i / 2) != NULL) {
      dea_html_add(s->to,
                   STEP("Put a thin layer of silicone glue onto the bottom electrodes of %s, leave "
                        "pads free, and transfer it onto a new PET carrier with them down."),
                   ply);
    }
    dea_html_add(s->to,
                 STEP("Print onto the top of %s through %s, its holes over the marks. Channel: %s. "
                      "Cure at %.4g \xc2\xb0"
                      "C for %.4g h."),
                 ply, stencil->name, channels, celsius, hours);
  }
}

/* "by 1.2 in all directions", or along two axes. */
static void write_stretch(const struct dea_layout_ply *ply, char *out)
{
  const double *l = ply->pre_stretch;
  double degrees = ply->angle_rad * 180 / DEA_PI;
  if (l[0] == l[1]) {
    snprintf(out, WORDS, "by %.4g in all directions", l[0]);
  } else {
    snprintf(out, WORDS, "by %.4g at %.4g\xc2\xb0 from the x axis and by %.4g across that", l[0],
             degrees, l[1]);
  }
}

/* How a ply comes to what is there. */
enum order { FIRST, ABOVE, BELOW };

static void add_layers(const struct sheet *s, size_t i)
{
  char channels[2][WORDS];
  for (int top = 0; top < 2; top++) {
    write_channels(s, i, top == 1, channels[top]);
  }
  if (dea_ply_layers(&s->layout->plies[i]) > 1) {
    dea_html_add(s->to,
                 STEP("%s has %zu layers: do so with each of them, one on the other. Electrodes "
                      "by turns from the bottom up: %s; %s."),
                 s->layout->plies[i].name, dea_ply_layers(&s->layout->plies[i]), channels[0],
                 channels[1]);
  }
}

/* Pieces that hang in a holder. */
static void add_tabs_step(const struct sheet *s, size_t i)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  const struct dea_device *d = s->w->plan.device;
  const bool anchored = s->w->plan.piece_end_m > s->w->plan.piece_outer_m;
  const char *name = dea_workshop_part(s->w, DEA_PART_OUTLINE, i)->name;
  char a[NUMBER], b[NUMBER], c[NUMBER];
  dea_length_text(a, sizeof a, s->w->plan.piece_outer_m - d->fibre_tip_radius_m);
  dea_length_text(b, sizeof b, d->fibre_width_m);
  dea_length_text(c, sizeof c, d->fibre_tip_radius_m);
  dea_html_add(s->to,
               STEP("Cut %d %s with their holder (%s) from %s, %.4g \xc2\xb5m thick: %s mm long "
                    "inside the frame, %s mm wide."),
               d->fibre_count, ply->name, name, ply->material.name, 1e6 * ply->thickness_m, a, b);
  dea_html_add(
      s->to,
      STEP("Put glue onto the %s%s, not onto holder and tabs; lay them onto what is there, "
           "holes over the marks. The tips then lie %s mm from the centre."),
      ply->name, anchored ? " and their anchors" : "", c);
  dea_html_add(s->to,
               STEP("Once the glue holds, cut the %d tabs%s and lift the "
                    "holder off."),
               d->fibre_count, anchored ? "" : " at the outer ends");
}

/* A film on the frame, or onto what is there. */
static void add_film_step(const struct sheet *s, size_t i, const char *where)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  const char *name = dea_workshop_part(s->w, DEA_PART_BLANK, i)->name;
  char stretch[WORDS];
  write_stretch(ply, stretch);
  if (dea_ply_is_stretched(ply)) {
    dea_html_add(s->to,
                 STEP("Stretch %s (%s) %s, until its grid and marks cover the template; it is then "
                      "%.4g \xc2\xb5m thick%s."),
                 ply->name, name, stretch, 1e6 * dea_ply_stretched_layer_m(ply), where);
  } else {
    dea_html_add(s->to, STEP("Lay %s (%s) flat%s."), ply->name, name, where);
  }
}

static void add_ply_step(const struct sheet *s, size_t i, enum order order)
{
  const struct dea_layout_ply *ply = &s->layout->plies[i];
  const bool film = dea_ply_is_blank(s->layout, i);
  const struct dea_fab_plan *plan = &s->w->plan;
  char where[WORDS] = "";
  if (order != FIRST) {
    snprintf(where, sizeof where, ". %s what is there%s, marks over marks",
             film ? "Lay it onto" : "Bond it to", order == BELOW ? ", from below" : "");
  } else if (film) {
    snprintf(where, sizeof where, ". Fix it on the frame, holes over the marks%s",
             plan->pad_count > 0 && plan->window_m > 0 ? ", windows over the pads below" : "");
  }
  if (i == plan->on_tabs) {
    add_tabs_step(s, i);
    return;
  }
  if (film) {
    add_film_step(s, i, where);
    add_layers(s, i);
    return;
  }
  const struct dea_part *part = dea_workshop_part(s->w, DEA_PART_OUTLINE, i);
  const size_t pieces = dea_part_pieces(part);
  dea_html_add(s->to, STEP("Cut %s (%s, %zu piece%s) from %s, %.4g \xc2\xb5m thick%s."), ply->name,
               part->name, pieces, pieces > 1 ? "s on their carrier" : "", ply->material.name,
               1e6 * dea_ply_stretched_layer_m(ply), where);
  add_layers(s, i);
}

/* Films come first: what lies below them is bonded to them from below. */
static void add_assembly(const struct sheet *s)
{
  const struct dea_layout *l = s->layout;
  size_t start = 0;
  while (start < l->ply_count && !dea_ply_is_blank(l, start)) {
    start++;
  }
  start = start < l->ply_count ? start : 0;
  for (size_t i = start; i < l->ply_count; i++) {
    if (dea_ply_is_cut(&l->plies[i])) {
      add_ply_step(s, i, i == start ? FIRST : ABOVE);
    }
  }
  for (size_t i = start; i-- > 0;) {
    if (dea_ply_is_cut(&l->plies[i])) {
      add_ply_step(s, i, BELOW);
    }
  }
  for (size_t i = 0; i < l->body_count; i++) {
    dea_html_add(s->to,
                 STEP("Cut %s (%s) from a plate that does not bend and bond it where the template "
                      "shows it."),
                 l->bodies[i].name, dea_workshop_part(s->w, DEA_PART_BODY, i)->name);
  }
  for (size_t i = 0; i < l->ply_count; i++) {
    const struct dea_part *part = dea_workshop_part(s->w, DEA_PART_OUTLINE, i);
    if (part != NULL && part->of == i && dea_ply_is_stretched(&l->plies[i])) {
      dea_html_add(s->to,
                   STEP("Hold what is a support (below), then cut %s along its outline "
                        "(%s): what it is bonded to takes its tension."),
                   l->plies[i].name, part->name);
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
    dea_html_add(s->to, STEP("Hold %s%s%s%s along %s%s."), p->edge ? "the edge of " : "",
                 l->regions[p->region].name, within ? " within " : "",
                 within ? l->regions[p->within].name : "", held,
                 p->hinged                               ? ", so that it may turn"
                 : p->edge && !within && s->w->plan.held ? ": the frame does that"
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
    dea_html_add(s->to, STEP("Fasten the spring %s to %s, %s."), along[p->component],
                 l->bodies[p->body].name, force);
  }
  for (size_t i = 1; i < l->channel_count; i++) {
    const struct dea_layout_channel *c = &l->channels[i];
    if (c->waveform != NULL) {
      dea_html_add(s->to, STEP("Connect %s to a source of its own (%s)."), c->name, c->waveform);
    } else if (c->own_V != 0) {
      dea_html_add(s->to, STEP("Connect %s: %.4g of the voltage, and %+.4g V."), c->name, c->ratio,
                   c->own_V);
    } else if (c->ratio == 0) {
      dea_html_add(s->to, STEP("Connect %s to ground."), c->name);
    } else if (c->ratio == 1) {
      dea_html_add(s->to, STEP("Connect %s to the voltage."), c->name);
    } else {
      dea_html_add(s->to, STEP("Connect %s: %.4g of the voltage."), c->name, c->ratio);
    }
  }
}

// Check list --------------------------------------------------------------------------------------

/* A thickness in um, another length in mm. */
static void write_length(char out[NUMBER], double length_m, bool thickness)
{
  char mm[NUMBER - 4];
  dea_length_text(mm, sizeof mm, length_m);
  if (thickness) {
    snprintf(out, NUMBER, "%.4g \xc2\xb5m", 1e6 * length_m);
  } else {
    snprintf(out, NUMBER, "%s mm", mm);
  }
}

/* The number of a key in words: "thickness of film". */
static void write_what(const struct dea_design_number *number, char *out)
{
  static const char *const words[][2] = {{"film.thickness", "film thickness, unstretched"},
                                         {"pre_stretch", "pre-stretch"},
                                         {"electrodes.diameter", "diameter of the electrodes"},
                                         {"electrodes.radius", "radius of the electrodes"},
                                         {"frame.inner_diameter", "inner diameter of the frame"},
                                         {"frame.inner_radius", "inner radius of the frame"},
                                         {"fibres.length", "length of the fibres"},
                                         {"fibres.tip_radius", "fibre tips from the centre"},
                                         {"fibres.overlap", "overlap of fibres and electrode"}};
  snprintf(out, WORDS, "%s", number->key);
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    if (strcmp(number->key, words[i][0]) == 0) {
      snprintf(out, WORDS, "%s", words[i][1]);
    }
  }
  const char *end = strrchr(number->key, '.');
  if (strncmp(number->key, "plies.", 6) == 0 && end > number->key + 5) {
    const bool across = strstr(end, "[1]") != NULL, thick = strcmp(end, ".thickness") == 0;
    snprintf(out, WORDS, "%s of %.*s%s", thick ? "thickness" : "pre-stretch",
             (int)(end - number->key - 6), number->key + 6,
             across                       ? ", second axis"
             : strstr(end, "[0]") != NULL ? ", first axis"
                                          : "");
  }
}

/* Its value as the file has it, and its tolerance. */
static void write_number(const struct sheet *s, const struct dea_design_number *number,
                         char *wanted, char *tolerance)
{
  const struct dea_listing *values = &s->w->plan.design->values;
  char a[NUMBER], b[NUMBER];
  if (strcmp(number->unit, "1") == 0) {
    const double grid = 5 * s->w->plan.grid_m, before = grid / number->value;
    dea_length_text(a, sizeof a, before);
    dea_length_text(b, sizeof b, grid);
    snprintf(wanted, WORDS, "%.4g: five spacings of the grid, %s mm before, are %s mm",
             number->value, a, b);
    dea_length_text(a, sizeof a, before * number->tolerance);
    snprintf(tolerance, WORDS, "\xc2\xb1%.3g: \xc2\xb1%s mm", number->tolerance, a);
    return;
  }
  const bool thickness = strstr(number->key, "thickness") != NULL;
  write_length(a, number->value, thickness);
  snprintf(wanted, WORDS, "%s", a);
  for (size_t i = 0; i < values->count && !thickness; i++) {
    if (strcmp(values->items[i].path, number->key) == 0) { // with the state of its film
      snprintf(wanted, WORDS, "%.60s", values->items[i].text);
    }
  }
  write_length(a, number->tolerance, false);
  snprintf(tolerance, WORDS, "\xc2\xb1%s", a);
  if (thickness) {
    snprintf(tolerance, WORDS, "\xc2\xb1%.3g %%", 100 * number->tolerance / number->value);
  }
}

static void add_row(const struct sheet *s, const char *what, const char *wanted,
                    const char *tolerance)
{
  dea_html_add(s->to, "<tr><td>%s" CELL "%s" CELL "%s</td></tr>\n", what, wanted, tolerance);
}

/* The ply that a key is of; DEA_LAYOUT_NONE. */
static size_t ply_of(const struct dea_layout *layout, const char *key)
{
  char start[DEA_NUMBER_KEY_SIZE];
  for (size_t i = 0; i < layout->ply_count; i++) {
    snprintf(start, sizeof start, "plies.%.80s.", layout->plies[i].name);
    if (strncmp(key, start, strlen(start)) == 0) {
      return i;
    }
  }
  return DEA_LAYOUT_NONE;
}

/* Whether a number is that of a ply that is cut as another one, which has a row. */
static bool is_again(const struct dea_layout *layout, const struct dea_design_number *numbers,
                     size_t i)
{
  const char *end = strrchr(numbers[i].key, '.');
  const size_t ply = ply_of(layout, numbers[i].key);
  const size_t like = ply == DEA_LAYOUT_NONE ? ply : dea_ply_like(layout, ply);
  bool again = false;
  for (size_t k = 0; k < i && like != ply; k++) {
    const char *other = strrchr(numbers[k].key, '.');
    again = again || (ply_of(layout, numbers[k].key) == like && strcmp(other, end) == 0);
  }
  return again;
}

static void add_number(const struct sheet *s, const struct dea_design_number *number)
{
  char what[WORDS], wanted[WORDS], tolerance[WORDS];
  write_what(number, what);
  write_number(s, number, wanted, tolerance);
  add_row(s, what, wanted, tolerance);
}

/* Numbers of the design that have a tolerance, and where fibre tips are (an overlap of 0 is no
 * number). */
static dea_status add_numbers(struct dea_context *ctx, const struct sheet *s)
{
  const struct dea_fab_plan *plan = &s->w->plan;
  struct dea_design_number *numbers = dea_alloc(ctx, DEA_NUMBERS_MAX, sizeof *numbers);
  struct dea_design_number tips = {
      .key = "fibres.tip_radius", .value = plan->device->fibre_tip_radius_m, .unit = "m"};
  size_t count = 0;
  DEA_TRY_MEMORY(numbers != NULL);
  tips.tolerance =
      dea_length_stretched_m(&plan->design->fabrication.tolerance.fibre, plan->device->pre_stretch);
  const dea_status status =
      dea_design_numbers(ctx, plan->design, plan->device, 0, false, numbers, &count);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    if (numbers[i].tolerance > 0 && !is_again(s->layout, numbers, i)) {
      add_number(s, &numbers[i]);
      tips.tolerance = strncmp(numbers[i].key, "fibres.", 7) == 0 ? 0 : tips.tolerance;
    }
  }
  if (plan->device->fibre_count > 0 && tips.tolerance > 0 && status == DEA_OK) {
    add_number(s, &tips);
  }
  dea_free(ctx, numbers);
  return status;
}

static dea_status add_checks(struct dea_context *ctx, const struct sheet *s)
{
  const struct dea_device *d = s->w->plan.device;
  char wanted[WORDS], number[NUMBER], width[NUMBER];
  dea_html_add(s->to, "<h2>Check list</h2>\n<table>\n<tr><th>what</th><th>wanted</th>"
                      "<th>tolerance</th></tr>\n");
  DEA_TRY(ctx, add_numbers(ctx, s));
  if (s->w->plan.on_tabs != DEA_LAYOUT_NONE) {
    write_length(width, d->fibre_width_m, false);
    write_length(number, d->fibre_thickness_m, true);
    snprintf(wanted, sizeof wanted, "%s, %s", width, number);
    add_row(s, "width and thickness of the fibres", wanted, "not given");
    add_row(s, "glue below the fibres", d->bond_thickness_m > 0 ? "even" : "thin, even",
            "not given");
  }
  if (s->layout->electrode_count > 1) {
    add_row(s, "top over bottom electrodes", "as in the template", "not given");
  }
  write_length(number, s->w->plan.kerf_m, false);
  snprintf(wanted, sizeof wanted, "%s, on a test square", number);
  add_row(s, "kerf of the cutter", wanted, "not given");
  dea_html_add(
      s->to,
      "</table>\n<p class=\"note\">Tolerances are those of the design&#39;s section "
      "fabrication.tolerance; those that nobody wrote are assumptions "
      "(docs/fabrication.md). &#39;dea run --sensitivity&#39; computes what they do (change by "
      "tolerance).</p>\n");
  return DEA_OK;
}

dea_status dea_process_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                             const char *drawing, struct dea_text *out)
{
  const struct sheet s = {workshop, workshop->plan.layout, out};
  const struct dea_design *design = workshop->plan.design;
  const char *file = dea_path_name(design->file);
  const char *title = design->title.text[0] != '\0' ? design->title.text : file;
  dea_html_add(out,
               "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
               "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
               "style-src 'unsafe-inline'\">\n"
               "<meta name=\"viewport\" content=\"width=device-width\">\n"
               "<title>Process sheet: %s</title>\n<style>",
               title);
  dea_text_add(out, "%s</style>\n</head>\n<body>\n", style);
  dea_html_add(out,
               "<h1>Process sheet: %s</h1>\n<p class=\"note\">Made by dea fab from %s for %d "
               "actuator%s. Steps after section 3.1 of the paper, with the numbers of the design. "
               "DXF and SVG files have the kerf of the cutter in them, parts.pdf shows the "
               "finished parts at 1:1.%s</p>\n",
               title, file, workshop->plan.copies, workshop->plan.copies > 1 ? "s" : "",
               s.layout->ply_count > 1
                   ? " Plies lie on each other from bottom to top. Glue that has a thickness "
                     "that counts is a ply of its own."
                   : "");
  dea_text_add(out, "<div role=\"img\" aria-label=\"Drawing of the actuator\">%s</div>\n",
               drawing != NULL ? drawing : "");
  add_materials(&s);
  dea_html_add(out, "<h2>Steps</h2>\n<ol>\n");
  add_cutting(&s);
  add_printing(&s);
  add_assembly(&s);
  add_supports(&s);
  dea_html_add(out, "</ol>\n");
  DEA_TRY(ctx, add_checks(ctx, &s));
  dea_html_add(out, "</body>\n</html>\n");
  return out->failed ? DEA_E_MEMORY : DEA_OK;
}
