/* Study "frequency": amplitude and phase of the displacements that a small AC excitation of the
 * voltage makes about a bias. */
#include "base/schema.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.frequency; without a bias nothing is computed. */
struct settings {
  struct dea_quantity biases_V[DEA_DESIGN_STOPS_MAX];
  size_t bias_count;
  struct dea_quantity excitation_V, from_Hz, to_Hz, points;
  struct dea_quantity damping, damping_mass_per_s, damping_stiffness_s;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    {.key = "bias",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(biases_V),
     .unit = "V",
     .above_min = true,
     .max = 1e6,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(bias_count),
     .doc = "voltages that the excitation lies upon, in the order to be computed",
     .example = "[4 kV, 6 kV]"},
    {.key = "excitation",
     .alias = "ripple",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(excitation_V),
     .unit = "V",
     .above_min = true,
     .max = 1e6,
     .default_text = "1 V",
     .doc = "amplitude of the excitation: small against the bias",
     .example = "100 V"},
    {.key = "from",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(from_Hz),
     .unit = "Hz",
     .above_min = true,
     .max = 1e6,
     .default_text = "1 Hz",
     .doc = "lowest frequency",
     .example = "1 Hz"},
    {.key = "to",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(to_Hz),
     .unit = "Hz",
     .above_min = true,
     .max = 1e6,
     .default_text = "2 kHz",
     .doc = "highest frequency",
     .example = "1 kHz"},
    {.key = "points",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(points),
     .unit = "1",
     .min = 2,
     .max = 10000,
     .default_text = "400",
     .doc = "how many frequencies, evenly by their logarithm",
     .example = "400"},
    {.key = "damping",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping),
     .unit = "1",
     .max = 10,
     .default_text = "0.02",
     .doc =
         "viscous damping of each mode over its critical one; an assumption, not a measured value",
     .example = "0.05"},
    {.key = "alpha",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping_mass_per_s),
     .unit = "Hz",
     .max = 1e9,
     .default_text = "0 Hz",
     .doc = "alpha of viscous damping alpha M + beta K beside that, by the mass",
     .example = "10 Hz"},
    {.key = "beta",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(damping_stiffness_s),
     .unit = "s",
     .max = 1e3,
     .default_text = "0 s",
     .doc = "beta of viscous damping alpha M + beta K beside that, by the stiffness",
     .example = "10 us"},
};

static const struct dea_record record = {
    "frequency", "study of the response to a small AC excitation of the voltage about a bias (3d)",
    fields, sizeof fields / sizeof fields[0]};

/* Frequencies rise. */
static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  (void)design;
  const struct settings *settings = given->values;
  const struct dea_quantity *to = &settings->to_Hz;
  if (given->written && settings->bias_count == 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, to->location,
                                 "frequency: without `bias` there is no such study"));
  }
  if (to->si <= settings->from_Hz.si) {
    return dea_finding_add(ctx, DEA_ERROR, to->location, "to: %g Hz is not above `from`, %g Hz",
                           to->si, settings->from_Hz.si);
  }
  return DEA_OK;
}

static const struct dea_design_section section = {
    .key = "frequency", .record = &record, .size = sizeof(struct settings), .check = check};

static const struct settings *settings_of(const struct dea_design *design)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  return given != NULL ? given->values : NULL;
}

// Study ------------------------------------------------------------------------------------------

/* All frequencies at one bias. */
static dea_status take(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve)
{
  (void)stop;
  const struct settings *settings = settings_of(result->design);
  size_t count = (size_t)settings->points.si;
  double from = settings->from_Hz.si, to = settings->to_Hz.si;
  const struct dea_ac_excitation excitation = {
      .amplitude_V = settings->excitation_V.si,
      .damping_ratio = settings->damping.si,
      .damping_mass_per_s = settings->damping_mass_per_s.si,
      .damping_stiffness_s = settings->damping_stiffness_s.si};
  double *frequency_Hz = dea_alloc(ctx, count, sizeof *frequency_Hz);
  struct dea_load_point *points = dea_alloc(ctx, count, sizeof *points);
  dea_status status = frequency_Hz != NULL && points != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    frequency_Hz[i] = from * pow(to / from, (double)i / (double)(count - 1));
  }
  if (status == DEA_OK) {
    status = dea_model_respond(ctx, type, model, at, &excitation, frequency_Hz, count, points);
  }
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    status = dea_curve_add_point(ctx, curve, &points[i]);
  }
  dea_free(ctx, frequency_Hz);
  dea_free(ctx, points);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none
  const struct settings *settings = settings_of(result->design);
  double biases_V[DEA_DESIGN_STOPS_MAX];
  for (size_t i = 0; i < settings->bias_count; i++) {
    biases_V[i] = settings->biases_V[i].si;
  }
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, type, result, "frequency", type->respond != NULL,
                                      biases_V, settings->bias_count, take));
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  const struct settings *settings = settings_of(design);
  return settings != NULL && settings->bias_count > 0;
}

const struct dea_study dea_study_frequency = {.name = "frequency",
                                              .keys = &section,
                                              .asked = asked,
                                              .needs = "compute.frequency.bias",
                                              .own_models = true,
                                              .run = run};
