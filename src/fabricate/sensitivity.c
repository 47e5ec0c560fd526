#include "fabricate/sensitivity.h"

#include "device/geometry.h"
#include "model/model.h"

#include <math.h>

/* A displacement that a model answers with; which deviations it sees. */
static const struct question {
  const char *model, *what;
  size_t offset; // of the member of a load point
  bool sees[DEA_DEVIATION_COUNT];
} questions[DEA_SENSITIVITIES] = {
    {"axisymmetric",
     "electrode edge, outwards",
     offsetof(struct dea_load_point, electrode_edge_u_m),
     {true, true, true, true, false}},
    {"lumped",
     "fibre tip, out of plane",
     offsetof(struct dea_load_point, fibre_tip_z_m),
     {true, true, true, true, true}},
};

/* A length of the design's own film state, changed by a length given in one or the other. */
static void change(struct dea_inplane_length *length, double factor,
                   const struct dea_inplane_length *by, double share, double pre_stretch)
{
  double other = by->state == length->state     ? 1
                 : by->state == DEA_UNSTRETCHED ? pre_stretch
                                                : 1 / pre_stretch;
  length->length.si += share * factor * other * by->length.si;
}

/* share: -1 or 1 of the tolerance. The tip's distance is changed by whichever key places it. */
static void deviate(struct dea_design *design, const struct dea_design *from,
                    enum dea_deviation which, double share)
{
  const struct dea_fabrication *f = &from->fabrication;
  double l = from->pre_stretch.si;
  switch (which) {
  case DEA_DEVIATION_THICKNESS:
    design->film.thickness_m.si *= 1 + share * f->tolerance.thickness.si;
    break;
  case DEA_DEVIATION_PRE_STRETCH:
    design->pre_stretch.si += share * f->tolerance.pre_stretch.si;
    break;
  case DEA_DEVIATION_ELECTRODE:
    change(&design->electrodes.radius, 0.5, &f->tolerance.electrode, share, l);
    break;
  case DEA_DEVIATION_FRAME:
    design->frame.radius_m.si += 0.5 * share * f->tolerance.frame_m.si;
    break;
  case DEA_DEVIATION_FIBRE:
    if (from->fibres.length.length.origin != DEA_ABSENT) {
      change(&design->fibres.length, -1, &f->tolerance.fibre, share, l);
    } else if (from->fibres.tip_radius.length.origin != DEA_ABSENT) {
      change(&design->fibres.tip_radius, 1, &f->tolerance.fibre, share, l);
    } else {
      change(&design->fibres.overlap, -1, &f->tolerance.fibre, share, l);
    }
    break;
  case DEA_DEVIATION_COUNT:
    break;
  }
}

/* The displacement of a device; NAN when the model has none there. Only want of memory and an
 * interruption are failures. */
static dea_status ask(struct dea_context *ctx, const struct dea_device *device,
                      const struct question *question, double voltage_V, double *out)
{
  const struct dea_model_type *type = dea_model_find(question->model);
  struct dea_model *model = NULL;
  struct dea_load_point point;
  dea_status status = type->create(ctx, device, NULL, &model);
  if (status == DEA_OK) {
    status = type->solve(ctx, model, voltage_V, &point);
  }
  *out = NAN;
  if (status == DEA_OK) {
    *out = *(const double *)(const void *)((const char *)&point + question->offset);
  }
  type->destroy(ctx, model);
  if (status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

/* The device that a changed design gives; materials stay. */
static dea_status ask_changed(struct dea_context *ctx, struct dea_design *scratch,
                              const struct dea_design *design, const struct dea_device *device,
                              const struct question *question, enum dea_deviation which,
                              double share, double voltage_V, double *out)
{
  struct dea_device changed = *device;
  *scratch = *design;
  deviate(scratch, design, which, share);
  dea_geometry_fill(scratch, &changed);
  *out = NAN;
  bool possible =
      changed.pre_stretch >= 1 && changed.electrode_radius_m > 0 &&
      changed.electrode_radius_m < changed.frame_radius_m &&
      (changed.fibre_count == 0 ||
       (changed.fibre_tip_radius_m > 0 && changed.fibre_tip_radius_m < changed.frame_radius_m));
  return possible ? ask(ctx, &changed, question, voltage_V, out) : DEA_OK;
}

static dea_status differentiate(struct dea_context *ctx, struct dea_design *scratch,
                                const struct dea_design *design, const struct dea_device *device,
                                const struct question *question, double voltage_V,
                                struct dea_sensitivity *out)
{
  for (int d = 0; d < DEA_DEVIATION_COUNT; d++) {
    double low = NAN, high = NAN;
    if (question->sees[d] && !isnan(out->displacement_m) &&
        (d != DEA_DEVIATION_FIBRE || device->fibre_count > 0)) {
      DEA_TRY(ctx, ask_changed(ctx, scratch, design, device, question, (enum dea_deviation)d, -1,
                               voltage_V, &low));
      DEA_TRY(ctx, ask_changed(ctx, scratch, design, device, question, (enum dea_deviation)d, 1,
                               voltage_V, &high));
    }
    out->effect_m[d] = 0.5 * (high - low);
  }
  return DEA_OK;
}

static dea_status find(struct dea_context *ctx, struct dea_design *scratch,
                       const struct dea_design *design, const struct dea_device *device,
                       double *voltage_V, struct dea_sensitivity out[DEA_SENSITIVITIES])
{
  double highest = dea_design_highest_V(design);
  size_t asked = device->fibre_count > 0 ? DEA_SENSITIVITIES : 1;
  *voltage_V = NAN;
  for (size_t q = 0; q < DEA_SENSITIVITIES; q++) {
    out[q] = (struct dea_sensitivity){questions[q].model, questions[q].what, NAN, {0}};
  }
  for (int quarter = 4; quarter > 0 && isnan(*voltage_V) && highest > 0; quarter--) {
    double voltage = highest * quarter / 4;
    bool all = true;
    for (size_t q = asked; q-- > 0 && all;) { // the quicker model first
      DEA_TRY(ctx, ask(ctx, device, &questions[q], voltage, &out[q].displacement_m));
      all = !isnan(out[q].displacement_m);
    }
    *voltage_V = all ? voltage : NAN;
  }
  for (size_t q = 0; q < DEA_SENSITIVITIES; q++) {
    out[q].displacement_m = isnan(*voltage_V) ? NAN : out[q].displacement_m;
    DEA_TRY(ctx, differentiate(ctx, scratch, design, device, &questions[q], *voltage_V, &out[q]));
  }
  return DEA_OK;
}

dea_status dea_sensitivities_find(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_device *device, double *voltage_V,
                                  struct dea_sensitivity out[DEA_SENSITIVITIES])
{
  struct dea_design *scratch = dea_alloc(ctx, 1, sizeof *scratch); // too large for the stack
  if (scratch == NULL) {
    return DEA_E_MEMORY;
  }
  dea_status status = find(ctx, scratch, design, device, voltage_V, out);
  dea_free(ctx, scratch);
  return status;
}
