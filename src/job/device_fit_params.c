/* Parameters of a fit of a device: numbers of its design with where the search begins, bounds and
 * priors. */
#include "job/device_evaluation.h"

#include "base/units.h"
#include "material/catalogue.h"
#include "study/numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define AT(member) offsetof(struct dea_material, member)

/* What a material of the catalogue says of a parameter; NAN where it says nothing. law: that the
 * material of the design has. */
static void find_value(const struct dea_material_data *data, const struct dea_device_param *param,
                       const struct dea_law *law, double *value, double *std)
{
  const size_t offset = param->offset;
  *value = *std = NAN;
  if (param->kind != DEA_DEVICE_MATERIAL) {
    return;
  }
  if (offset >= AT(param) && offset < AT(param) + DEA_LAW_PARAM_MAX * sizeof(double)) {
    const size_t k = (offset - AT(param)) / sizeof(double);
    for (size_t i = 0; i < data->law_count; i++) {
      if (data->laws[i].law == law) {
        *value = data->laws[i].param[k].si;
        *std = data->laws[i].param_std[k].si;
        return;
      }
    }
  } else if (offset == AT(density_kg_per_m3) && data->has_density) {
    *value = data->density.value_kg_per_m3.si;
  } else if (offset == AT(young_modulus_Pa) && data->has_elastic) {
    *value = data->elastic.young_modulus_Pa.si;
  } else if (offset == AT(poisson_ratio) && data->has_elastic) {
    *value = data->elastic.poisson_ratio.si;
  } else if (data->permittivity_count > 0 &&
             (offset == AT(permittivity.at_rest) || offset == AT(permittivity.slope))) {
    const struct dea_permittivity_set *set = &data->permittivity[0];
    *value = offset == AT(permittivity.at_rest) ? set->at_rest.si : set->slope.si;
  }
}

/* Puts numbers in the place of the name of a material. */
static dea_status prior_of_material(struct dea_context *ctx, const struct dea_device *device,
                                    struct dea_fit_parameter_text *text,
                                    struct dea_device_param *out)
{
  struct dea_catalogue_entry *entry;
  double value, std;
  DEA_TRY(ctx, dea_catalogue_read(ctx, text->prior.text, text->prior.location, &entry));
  find_value(&entry->data, out, dea_material_of(device, out->material)->law, &value, &std);
  dea_catalogue_destroy(ctx, entry);
  snprintf(out->prior_of, sizeof out->prior_of, "%.63s", text->prior.text);
  if (isnan(value)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, text->prior.location,
                                 "the material '%.40s' says nothing of %s", text->prior.text,
                                 out->param.name));
  } else if (text->prior_std.text[0] == '\0' && isnan(std)) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_ERROR, text->prior.location,
                            "the material '%.40s' gives no uncertainty of %s: say one (prior_std)",
                            text->prior.text, out->param.name));
  }
  snprintf(text->prior.text, sizeof text->prior.text, "%.17g%s%s", value,
           DEA_UNIT_BEHIND(out->param.unit));
  if (text->prior_std.text[0] == '\0' && !isnan(std)) {
    snprintf(text->prior_std.text, sizeof text->prior_std.text, "%.17g%s%s", std,
             DEA_UNIT_BEHIND(out->param.unit));
  }
  return DEA_OK;
}

/* A prior that begins with a letter names a material. */
static bool names_material(const struct dea_label *prior)
{
  const char c = prior->text[0];
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Start and scale, once bounds and priors are known. */
static dea_status settle(struct dea_context *ctx, const struct dea_fit_parameter_text *text,
                         bool whole, bool start_given, struct dea_device_param *out)
{
  struct dea_fit_param *param = &out->param;
  char shown[80];
  if (!(param->start >= param->low && param->start <= param->high)) {
    dea_device_param_text(out, param->start, 6, shown);
    return dea_finding_add(ctx, DEA_ERROR, start_given ? text->start.location : text->name.location,
                           "%s starts at %.40s, outside of its bounds %.6g and %.6g%s%s",
                           param->name, shown, param->low, param->high,
                           DEA_UNIT_BEHIND(param->unit));
  }
  const bool bounded = text->low.text[0] != '\0' && text->high.text[0] != '\0';
  param->scale = fabs(param->start);
  if (bounded && param->scale < 0.25 * (param->high - param->low)) {
    param->scale = 0.25 * (param->high - param->low);
  }
  if (param->scale == 0 && !whole) {
    return dea_finding_add(ctx, DEA_ERROR, text->name.location,
                           "%s starts at 0, which does not say what a large change is: give low "
                           "and high",
                           param->name);
  }
  return DEA_OK;
}

dea_status dea_device_param_build(struct dea_context *ctx,
                                  const struct dea_fit_parameter_text *asked,
                                  const struct dea_device_param_source *source,
                                  struct dea_device_param *out)
{
  struct dea_fit_parameter_text text = *asked;
  const char *name = text.name.text;
  bool good;
  *out = (struct dea_device_param){.state = ""};
  out->param = (struct dea_fit_param){.start = NAN, .prior = NAN, .prior_std = NAN};
  DEA_TRY(ctx, dea_device_param_find(ctx, source, &text.name, out, &good));
  if (!good) {
    return DEA_OK;
  }
  struct dea_label *labels[] = {&text.start, &text.low, &text.high, &text.prior};
  for (size_t k = 0; k < 4; k++) { // all of them in the state of the design's value
    const char *state = dea_device_param_split_state(labels[k]->text);
    out->state = out->state[0] == '\0' ? state : out->state;
    if (state[0] != '\0' && strcmp(state, out->state) != 0) {
      return dea_finding_add(ctx, DEA_ERROR, labels[k]->location,
                             "%s is a length%s in the design: write it so here too", name,
                             out->state);
    }
  }
  DEA_TRY(ctx, names_material(&text.prior) ? prior_of_material(ctx, source->device, &text, out)
                                           : DEA_OK);
  const bool start_given = text.start.text[0] != '\0';
  if (!start_given && isnan(out->designed)) {
    return dea_finding_add(ctx, DEA_ERROR, text.name.location,
                           "the design has no single value of %s: give a start", name);
  }
  if (!start_given) {
    snprintf(text.start.text, sizeof text.start.text, "%.17g%s%s", out->designed,
             DEA_UNIT_BEHIND(out->param.unit));
  }
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, dea_fit_param_read(ctx, &text, &out->param));
  return dea_finding_count(ctx, DEA_ERROR) == errors
             ? settle(ctx, &text, source->whole, start_given, out)
             : DEA_OK;
}

dea_status dea_device_param_number(struct dea_context *ctx, const struct dea_device_param *param,
                                   const struct dea_label *label, double *out)
{
  char text[DEA_TITLE_SIZE], why[DEA_WHY_SIZE] = "";
  snprintf(text, sizeof text, "%s", label->text);
  const char *state = dea_device_param_split_state(text);
  *out = NAN;
  if (state[0] != '\0' && strcmp(state, param->state) != 0) {
    snprintf(why, sizeof why, "it is a length%s in the design: write it so here too", param->state);
  } else if (dea_units_read(ctx, text, (struct dea_measure){param->param.unit, "1.5"}, out, why)) {
    return DEA_OK;
  } else if (why[0] == '\0') {
    return dea_context_status(ctx);
  }
  return dea_finding_add(ctx, DEA_ERROR, label->location, "%s: '%.60s': %s", param->param.name,
                         label->text, why);
}
