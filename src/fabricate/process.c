#include "fabricate/process.h"

#include "base/file.h"
#include "fabricate/part_list.h"
#include "fabricate/process_parts.h"
#include "fabricate/tolerance_effect.h"
#include "figures/dimensions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { NUMBER = 32 };

/* ---- amounts ---- */

/* Between a chord of width c of a circle and its arc. */
static double segment(double r, double c)
{
  return r * r * asin(0.5 * c / r) - 0.25 * c * sqrt(4 * r * r - c * c);
}

/* Area between the circles r0 < r1 and two edges of widths w0, w1 there. */
static double strip(double r0, double w0, double r1, double w1)
{
  double from = 0.5 * sqrt(4 * r0 * r0 - w0 * w0), to = 0.5 * sqrt(4 * r1 * r1 - w1 * w1);
  return 0.5 * (w0 + w1) * (to - from) + segment(r1, w1) - segment(r0, w0);
}

/* Area of all holes of a stencil: what is printed through it. */
static double printed_area(const struct dea_part *stencil)
{
  double box[4];
  dea_part_box(stencil, box);
  return (box[2] - box[0]) * (box[3] - box[1]) - dea_part_area_m2(stencil);
}

void dea_amounts_find(const struct dea_workshop *workshop, struct dea_amounts *out)
{
  const struct dea_fab_geometry *plan = &workshop->plan;
  const struct dea_device *d = plan->device;
  const struct dea_part *top = dea_workshop_find(workshop, "stencil-top");
  const struct dea_part *bottom = dea_workshop_find(workshop, "stencil-bottom");
  double l2 = plan->stretch * plan->stretch, side = 2 * plan->blank_m / plan->stretch;
  double marks = DEA_FAB_MARKS * pi * plan->mark_m * plan->mark_m / l2;
  *out = (struct dea_amounts){.film_area_m2 = pi * plan->blank_m * plan->blank_m / l2,
                              .ink_area_m2 = printed_area(top) + printed_area(bottom),
                              .transfer_glue_area_m2 = printed_area(bottom) - marks -
                                                       pi * plan->pad_m * plan->pad_m / l2,
                              .stencil_sheet_area_m2 = 2 * side * side,
                              .ring_area_m2 = pi * plan->ring_m * plan->ring_m};
  double thickness = d->electrode_thickness_m;
  out->ink_volume_m3 = thickness > 0 ? out->ink_area_m2 * thickness : NAN;
  out->bond_volume_m3 = NAN;
  if (d->fibre_count > 0) {
    double outer = plan->fibre_outer_m, end = plan->fibre_end_m;
    double one = strip(d->fibre_tip_radius_m, d->fibre_tip_width_m, outer, d->fibre_width_m);
    one += end > outer ? strip(outer, d->fibre_width_m, end, d->fibre_width_m) : 0;
    out->bond_area_m2 = d->fibre_count * one;
    out->fibre_sheet_area_m2 = out->ring_area_m2;
    out->bond_volume_m3 = d->bond_thickness_m > 0 ? out->bond_area_m2 * d->bond_thickness_m : NAN;
  }
}

/* ---- bill of materials ---- */

struct sheet {
  const struct dea_workshop *w;
  struct dea_document *to;
};

static void add_amount(struct sheet *s, const char *item, const char *material, double area_m2,
                       double volume_m3, const char *note)
{
  dea_process_add_material(s->to, s->w->plan.copies, item, material, area_m2, volume_m3, note);
}

static void add_materials(struct sheet *s)
{
  const struct dea_device *d = s->w->plan.device;
  struct dea_amounts a;
  char text[160];
  dea_amounts_find(s->w, &a);
  dea_process_begin_materials(s->to, s->w->plan.copies);
  snprintf(text, sizeof text, "%.4g \xc2\xb5m thick, before stretching",
           1e6 * d->film_thickness_unstretched_m);
  add_amount(s, "film, as cut", d->film.name, a.film_area_m2, NAN, text);
  add_amount(s, "electrodes, leads, pads, marks",
             d->electrode.name[0] != '\0' ? d->electrode.name : "not given", a.ink_area_m2,
             a.ink_volume_m3,
             isnan(a.ink_volume_m3)
                 ? "Volume unknown: the design gives no thickness (electrodes.thickness)"
                 : "Cured; solvent and what stays on the stencil come on top");
  add_amount(s, "glue below the bottom electrode", "silicone (paper: LSR 4305)",
             a.transfer_glue_area_m2, NAN,
             "A thin layer, thickness unknown: neither the paper nor the design gives it. The pad "
             "stays free");
  if (d->fibre_count > 0) {
    add_amount(s, "glue below fibres and anchors", "paper: ARclear 8932EE", a.bond_area_m2,
               a.bond_volume_m3,
               isnan(a.bond_volume_m3)
                   ? "Volume unknown: the design gives no thickness (fibres.bond.thickness)"
                   : "");
    snprintf(text, sizeof text, "%.4g \xc2\xb5m thick; discs, before cutting",
             1e6 * d->fibre_thickness_m);
    add_amount(s, "fibres with holder", d->fibre.name, a.fibre_sheet_area_m2, NAN, text);
  }
  add_amount(s, "stencils, both", "sheet, such as PET", a.stencil_sheet_area_m2, NAN,
             "Squares, before cutting. Its thickness sets how much is printed; the paper does not "
             "give it");
  add_amount(s, "frame", "rigid plate", a.ring_area_m2, NAN,
             "Discs, before cutting; material and thickness are not in the paper");
}

/* ---- steps ---- */

static void mm(char out[NUMBER], double length_m)
{
  dea_length_text(out, NUMBER, length_m);
}

static void add_printing(struct sheet *s)
{
  const struct dea_fab_geometry *plan = &s->w->plan;
  const struct dea_fabrication *f = &plan->design->fabrication;
  double l = plan->stretch, celsius = f->cure_temperature_K.si - 273.15;
  double hours = f->cure_time_s.si / 3600;
  char a[NUMBER], b[NUMBER];
  mm(a, 2 * plan->blank_m / l);
  mm(b, plan->grid_m / l);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cut the film: discs of %s mm diameter (film), and draw the crosses of the "
                   "grid, %s mm apart, and the three alignment marks.",
                   a, b);
  mm(a, 2 * plan->electrode_m / l);
  mm(b, 2 * plan->electrode_m);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cut the two stencils (stencil-bottom, stencil-top). The disc of an electrode "
                   "measures %s mm here and %s mm once stretched.",
                   a, b);
  dea_document_add(
      s->to, DEA_BLOCK_STEP,
      "Lay the film onto a PET carrier, its lower side up, so that its marks lie as in "
      "stencil-bottom, and print the bottom electrode: disc, lead, pad and marks in "
      "one go.");
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cure at %.4g \xc2\xb0"
                   "C for %.4g h.",
                   celsius, hours);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Put a thin layer of silicone glue onto the bottom electrode, leave its pad "
                   "free, and transfer the film onto a new PET carrier with that electrode down.");
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Print the top electrode through stencil-top, its three holes over the marks; "
                   "its lead goes to the other side.");
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cure again at %.4g \xc2\xb0"
                   "C for %.4g h.",
                   celsius, hours);
}

static void add_stretching(struct sheet *s)
{
  const struct dea_fab_geometry *plan = &s->w->plan;
  const struct dea_device *d = plan->device;
  char a[NUMBER], b[NUMBER], c[NUMBER];
  mm(a, plan->grid_m / plan->stretch);
  mm(b, plan->grid_m);
  dea_document_add(
      s->to, DEA_BLOCK_STEP,
      "Stretch the film by %.4g in all directions: crosses that were %s mm apart are "
      "%s mm apart, and film, marks and electrode cover the template. The film is then "
      "%.4g \xc2\xb5m thick.",
      plan->stretch, a, b, 1e6 * d->film_thickness_m);
  mm(a, 2 * plan->frame_m);
  mm(b, 2 * plan->contact_window_m);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Fix the film on the frame of %s mm inner diameter, holes over the marks%s%s%s.",
                   a, plan->contact_window_m > 0 ? ", window of " : "",
                   plan->contact_window_m > 0 ? b : "",
                   plan->contact_window_m > 0 ? " mm over the bottom pad" : "");
  if (d->fibre_count == 0) {
    return;
  }
  mm(a, plan->fibre_outer_m - d->fibre_tip_radius_m);
  mm(b, d->fibre_width_m);
  mm(c, d->fibre_tip_radius_m);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Cut %d fibres with their holder (fibres) from %s, %.4g \xc2\xb5m thick: %s mm "
                   "long inside the frame, %s mm wide.",
                   d->fibre_count, d->fibre.name, 1e6 * d->fibre_thickness_m, a, b);
  dea_document_add(
      s->to, DEA_BLOCK_STEP,
      "Put glue onto the fibres%s, not onto holder and tabs; lay them onto the side of "
      "the top electrode, holes over the marks. The tips then lie %s mm from the "
      "centre.",
      d->outer_end == DEA_END_FREE ? "" : " and their anchors", c);
  dea_document_add(s->to, DEA_BLOCK_STEP,
                   "Once the glue holds, cut the %d tabs%s and lift the "
                   "holder off.",
                   d->fibre_count,
                   d->outer_end == DEA_END_FREE ? " at the fibres' outer ends" : "");
}

/* ---- check list ---- */

/* With the effect of the tolerance: "+12 um (+3 %)", or that it is unknown. */
static void add_check(struct sheet *s, const struct dea_sensitivity *found, const char *what,
                      const char *wanted, const char *tolerance, int deviation)
{
  const double effect = deviation >= 0 ? found->effect_m[deviation] : NAN;
  dea_document_add(s->to, DEA_BLOCK_ROW, "%s", what);
  dea_document_cell(s->to, "%s", wanted);
  dea_document_cell(s->to, "%s", tolerance);
  dea_process_add_effect(s->to, effect, found->displacement_m, true);
}

/* A length of the film in the state that its tolerance is given in. */
static void add_length_check(struct sheet *s, const struct dea_sensitivity *found, const char *what,
                             double stretched_m, const struct dea_inplane_length *tolerance,
                             int deviation)
{
  char number[NUMBER], wanted[64], text[64];
  bool before = tolerance->state == DEA_UNSTRETCHED;
  mm(number, before ? stretched_m / s->w->plan.stretch : stretched_m);
  snprintf(wanted, sizeof wanted, "%s mm %s", number, dea_film_state_name(tolerance->state));
  mm(number, tolerance->length.si);
  snprintf(text, sizeof text, "\xc2\xb1%s mm", number);
  add_check(s, found, what, wanted, text, deviation);
}

static void add_check_rows(struct sheet *s, const struct dea_sensitivity *found)
{
  const struct dea_fab_geometry *plan = &s->w->plan;
  const struct dea_device *d = plan->device;
  const struct dea_fabrication *f = &plan->design->fabrication;
  char wanted[96], tolerance[64], number[NUMBER];
  snprintf(wanted, sizeof wanted, "%.4g \xc2\xb5m", 1e6 * d->film_thickness_unstretched_m);
  snprintf(tolerance, sizeof tolerance, "\xc2\xb1%.3g %%", 100 * f->tolerance.thickness.si);
  add_check(s, found, "film thickness, unstretched", wanted, tolerance, DEA_DEVIATION_THICKNESS);
  mm(number, 5 * plan->grid_m);
  snprintf(wanted, sizeof wanted, "%.4g: five spacings of the grid are %s mm", plan->stretch,
           number);
  mm(number, 5 * plan->grid_m / plan->stretch * f->tolerance.pre_stretch.si);
  snprintf(tolerance, sizeof tolerance, "\xc2\xb1%.3g: \xc2\xb1%s mm", f->tolerance.pre_stretch.si,
           number);
  add_check(s, found, "pre-stretch", wanted, tolerance, DEA_DEVIATION_PRE_STRETCH);
  add_length_check(s, found, "diameter of the electrodes", 2 * plan->electrode_m,
                   &f->tolerance.electrode, DEA_DEVIATION_ELECTRODE);
  mm(number, 2 * plan->frame_m);
  snprintf(wanted, sizeof wanted, "%s mm", number);
  mm(number, f->tolerance.frame_m.si);
  snprintf(tolerance, sizeof tolerance, "\xc2\xb1%s mm", number);
  add_check(s, found, "inner diameter of the frame", wanted, tolerance, DEA_DEVIATION_FRAME);
  if (d->fibre_count > 0) {
    add_length_check(s, found, "fibre tips from the centre", d->fibre_tip_radius_m,
                     &f->tolerance.fibre, DEA_DEVIATION_FIBRE);
    mm(number, d->fibre_width_m);
    snprintf(wanted, sizeof wanted, "%s mm, %.4g \xc2\xb5m", number, 1e6 * d->fibre_thickness_m);
    add_check(s, found, "width and thickness of the fibres", wanted, "not given", -1);
    add_check(s, found, "glue below the fibres", d->bond_thickness_m > 0 ? "even" : "thin, even",
              "not given", -1);
  }
  add_check(s, found, "top over bottom electrode", "concentric", "not given", -1);
  mm(number, plan->kerf_m);
  snprintf(wanted, sizeof wanted, "%s mm, on a test square", number);
  add_check(s, found, "kerf of the cutter", wanted, "see diameters", -1);
}

/* What the effects are of, and by which model. */
static void add_source(struct sheet *s, const struct dea_sensitivity *found)
{
  const bool bound = strcmp(found->model, "lumped") == 0;
  if (isnan(found->voltage_V)) {
    dea_document_add(s->to, DEA_BLOCK_TEXT,
                     "What a deviation does to the displacement is unknown: the models have no "
                     "state to be trusted at the voltages of this design.");
    return;
  }
  if (bound) {
    dea_document_add(s->to, DEA_BLOCK_TEXT,
                     "Model 3d is not installed (dea doctor), or has no state to be trusted at the "
                     "voltages of this design (a preview, compute.solid.film: membrane, is none). "
                     "What follows is by model lumped, of rigid, hinged fibres without the film "
                     "between them: an upper bound, no prediction.");
  }
  dea_document_add(s->to, DEA_BLOCK_TEXT,
                   "Effect of each tolerance (plus, with everything else as designed; per cent "
                   "below 0: it moves less) on the displacement at %.4g kV: %s, %.4g \xc2\xb5m by "
                   "model %s%s.",
                   1e-3 * found->voltage_V, found->what, 1e6 * found->displacement_m, found->model,
                   bound ? ""
                   : s->w->plan.device->fibre_count > 0
                       ? " (the film and its fibres)"
                       : " (exact for film and electrodes in a ring)");
  dea_process_add_voltage(s->to, found->voltage_V, dea_design_highest_V(s->w->plan.design));
}

static dea_status add_checks(struct dea_context *ctx, struct sheet *s)
{
  static const double widths[] = {0.25, 0.32, 0.21, 0.22};
  struct dea_sensitivity found;
  DEA_TRY(ctx, dea_sensitivity_find(ctx, s->w->plan.design, s->w->plan.device, &found));
  dea_document_add(s->to, DEA_BLOCK_HEADING, "Check list");
  add_source(s, &found);
  dea_document_add(s->to, DEA_BLOCK_HEAD, "what");
  dea_document_cell(s->to, "wanted");
  dea_document_cell(s->to, "tolerance");
  dea_document_cell(s->to, "effect (%s)", found.model);
  dea_document_widths(s->to, widths);
  add_check_rows(s, &found);
  dea_document_add(s->to, DEA_BLOCK_NOTE,
                   "Tolerances are those of the design's section fabrication.tolerance; those that "
                   "nobody wrote are assumptions (docs/fabrication.md). Unknown: no tolerance is "
                   "given, or the model has no slope; 'dea run --sensitivity' has slopes of more.");
  return DEA_OK;
}

dea_status dea_process_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                             bool sensitivity, struct dea_document *document)
{
  struct sheet s = {workshop, document};
  const struct dea_design *design = workshop->plan.design;
  const char *title = design->title.text;
  dea_document_add(document, DEA_BLOCK_TITLE, "Process sheet: %s",
                   title[0] != '\0' ? title : dea_path_name(design->file));
  dea_document_add(
      document, DEA_BLOCK_NOTE,
      "Made by dea fab from %s for %d actuator%s. Steps%s "
      "with the numbers of the design. DXF and SVG files have the kerf of the cutter in "
      "them, parts.pdf shows the finished parts at 1:1.",
      dea_path_name(design->file), workshop->plan.copies, workshop->plan.copies > 1 ? "s" : "",
      workshop->plan.design->parts != NULL ? "" : " after section 3.1 of the paper,");
  if (workshop->plan.design->parts != NULL) {
    DEA_TRY(ctx, dea_process_write_layout(ctx, workshop, sensitivity, document));
    return document->failed ? DEA_E_MEMORY : DEA_OK;
  }
  add_materials(&s);
  dea_document_add(document, DEA_BLOCK_HEADING, "Steps");
  add_printing(&s);
  add_stretching(&s);
  DEA_TRY(ctx, add_checks(ctx, &s));
  return document->failed ? DEA_E_MEMORY : DEA_OK;
}
