#include "explore/explore_file.h"

#include "base/correlations.h"
#include "io/sparse_grid.h"

#define AT(member) offsetof(struct dea_explore_file, member)
#define VARIABLE_AT(member) offsetof(struct dea_explore_variable, member)
#define LIMIT_AT(member) offsetof(struct dea_explore_limit, member)

static const char *const distributions[] = {"uniform", "normal", "lognormal", NULL};
static const char *const begins[] = {"nearest", "rest", NULL};
static const char *const plans[] = {"grid", "sparse-grid", "sobol", "random", "indices", NULL};

static const struct dea_field variable_fields[] = {
    DEA_LABEL_ROW("name", VARIABLE_AT(text.name), "film.thickness", DEA_DEVICE_PARAM_DOC,
                  .required = true),
    DEA_LABEL_ROW("also", VARIABLE_AT(also), "[plies.upper.thickness]",
                  "other numbers of the design that take the same value",
                  DEA_LIST(1, DEA_DEVICE_TIES_MAX, struct dea_label, VARIABLE_AT(also_count)),
                  .lone = true, .absent_text = "none"),
    DEA_LABEL_ROW("values", VARIABLE_AT(values), "[80 um, 100 um]", "the values that it takes",
                  DEA_LIST(1, DEA_EXPLORE_VALUES_MAX, struct dea_label, VARIABLE_AT(value_count)),
                  .absent_text = "from low to high"),
    DEA_LABEL_ROW("low", VARIABLE_AT(text.low), "80 um", "smallest value", .absent_text = "none"),
    DEA_LABEL_ROW("high", VARIABLE_AT(text.high), "120 um", "largest value", .absent_text = "none"),
    DEA_INTEGER_ROW("steps", VARIABLE_AT(steps), "5", "of a grid: values from low to high",
                    .min = 2, .max = 1000, .absent_text = "values"),
    DEA_CHOICE_ROW("distribution", VARIABLE_AT(distribution), distributions, "normal",
                   "of the samples; uniform: from low to high", .default_text = "uniform"),
    DEA_LABEL_ROW("mean", VARIABLE_AT(text.prior), "100 um",
                  "of a normal distribution the mean, of a lognormal one the median; or the "
                  "material of the catalogue that has it",
                  .absent_text = "none"),
    DEA_LABEL_ROW("std", VARIABLE_AT(text.prior_std), "5 um",
                  "standard deviation; of a lognormal distribution times the median that of the "
                  "logarithm",
                  .absent_text = "the material's"),
    DEA_LABEL_ROW("start", VARIABLE_AT(text.start), "100 um", "where an optimisation begins",
                  .absent_text = "the design's"),
    DEA_LABEL_ROW("scatter", VARIABLE_AT(scatter), "0.2 mm",
                  "of an optimisation: what the workshop misses the value by, to either side; of a "
                  "normal distribution its standard deviation. Without low, high and values the "
                  "design's own value is meant",
                  .absent_text = "none"),
};

static const struct dea_field limit_fields[] = {
    DEA_LABEL_ROW("quantity", LIMIT_AT(quantity), "breakdown_margin", "key of the quantity",
                  .required = true),
    DEA_LABEL_ROW("above", LIMIT_AT(above), "0.1", "it has to stay above this",
                  .absent_text = "none"),
    DEA_LABEL_ROW("below", LIMIT_AT(below), "80 V/um", "it has to stay below this",
                  .absent_text = "none"),
};

static const char *const goals[] = {"most", "least", NULL};
static const char *const gradients[] = {"model", "differences", NULL};
static const char *const methods[] = {"slsqp", "mma", "cobyla", "random", NULL};
static const struct dea_field objective_fields[] = {
    DEA_LABEL_ROW("quantity", offsetof(struct dea_explore_objective, quantity),
                  "electrode_edge_u_m", "key of the quantity, at the last voltage",
                  .required = true),
    DEA_CHOICE_ROW("goal", offsetof(struct dea_explore_objective, goal), goals, "least",
                   "whether as much of it is wanted as can be, or as little",
                   .default_text = "most"),
};

static const struct dea_field robust_fields[] = {
    DEA_INTEGER_ROW("samples", offsetof(struct dea_explore_robust, samples), "32",
                    "scattered designs that stand for one, the design itself among them", .min = 2,
                    .max = DEA_EXPLORE_SCATTERED_MAX, .default_text = "16"),
    DEA_NUMBER_ROW("spread", offsetof(struct dea_explore_robust, spread), "1", "2",
                   "objectives and limits are taken so many standard deviations to the worse side "
                   "of the mean",
                   .max = 10, .default_text = "1"),
    DEA_NUMBER_ROW("quantile", offsetof(struct dea_explore_robust, quantile), "1", "0.9",
                   "in place of that: as good as this share of the scattered designs is at least, "
                   "each objective and limit by itself; 1: the worst of them",
                   .max = 1, .absent_text = "mean and spread"),
};

static const struct dea_field file_fields[] = {
    DEA_INTEGER_ROW("dea_explore", DEA_FIT_HEAD_AT(version), "1", "version of the format",
                    .min = DEA_EXPLORE_VERSION, .max = DEA_EXPLORE_VERSION, .required = true),
    DEA_LABEL_ROW("name", DEA_FIT_HEAD_AT(name), "thickness", "name of what is asked",
                  .required = true),
    DEA_LABEL_ROW("title", DEA_FIT_HEAD_AT(title), "how thick a film", "the same in words",
                  .absent_text = "the name"),
    DEA_LABEL_ROW("design", AT(design), "frdea-4.yaml",
                  "design file, counted from the folder of this file", .required = true),
    DEA_LABEL_ROW("model", AT(model), "axisymmetric",
                  "model that computes the designs; of 3d the design's compute.solid says which "
                  "film",
                  .required = true),
    DEA_NUMBER_ROW("voltages", AT(voltages_V), "V", "[6 kV]",
                   "voltages at which quantities are taken, rising", .max = 1e6,
                   DEA_LIST(1, DEA_EXPLORE_VOLTAGES_MAX, struct dea_quantity, AT(voltage_count)),
                   .lone = true, .absent_text = "the highest of the design"),
    DEA_LABEL_ROW("quantities", AT(quantities), "[centre_z_m, breakdown_margin]",
                  "keys of the quantities that are kept, as dea compare --quantity has them, those "
                  "of monitors and channels (plate_turn_y_rad); force_N: with the tip of "
                  "compute.force held at its first depth; frequency_Hz: of the lowest mode (model "
                  "3d); slack_voltage_V, breakdown_voltage_V, pull_in_voltage_V, "
                  "buckling_voltage_V: where the film comes to its end",
                  DEA_LIST(1, DEA_EXPLORE_QUANTITIES_MAX, struct dea_label, AT(quantity_count)),
                  .required = true),
    DEA_FIELD_ROW(
        RECORD, "variables", AT(variables), .record = DEA_ROWS(variable_fields),
        .absent_text = "those of from_fit", .doc = "numbers of the design that change",
        .example = "[{name: film.thickness, values: [80 um, 100 um]}]",
        DEA_LIST(1, DEA_DEVICE_PARAMS_MAX, struct dea_explore_variable, AT(variable_count))),
    DEA_LABEL_ROW(
        "from_fit", AT(from_fit), "device.fit",
        "folder that dea fit has written, or its fit.json, counted from the folder of this "
        "file: the parameters that were fitted are variables too, with the values, "
        "standard uncertainties and correlations of the fit",
        .absent_text = "none"),
    DEA_NUMBER_ROW(
        "correlations", AT(correlations), "1", "[0.8]",
        "of the variables, 2 with 1, 3 with 1, 3 with 2, ..., as dea fit writes them: of "
        "samples, and of what scatters in an optimisation; those of other "
        "distributions than normal are of the normal numbers behind them",
        .min = -1, .max = 1,
        DEA_LIST(1, DEA_EXPLORE_PAIRS_MAX, struct dea_quantity, AT(correlation_count)),
        .absent_text = "none"),
    DEA_CHOICE_ROW("plan", AT(plan), plans, "sobol",
                   "grid: every combination; sparse-grid: few designs between which dea sweep --at "
                   "and the explorer of dea report interpolate; samples of the distributions; "
                   "indices: samples for "
                   "Sobol indices, (variables + 2) times their number",
                   .default_text = "grid"),
    DEA_INTEGER_ROW("samples", AT(samples), "1000", "number of samples", .min = 1,
                    .max = DEA_EXPLORE_CASES_MAX, .default_text = "100"),
    DEA_INTEGER_ROW("level", AT(level), "3",
                    "of a sparse grid: of one variable 3, 5, 9 or 17 designs, of two 5, 13, 29 or "
                    "65, of three 7, 25, 69 or 177",
                    .min = 1, .max = DEA_EMULATOR_LEVEL_MAX, .default_text = "2"),
    DEA_INTEGER_ROW("seed", AT(seed), "7", "of the samples: another one gives others",
                    .max = 1000000000, .default_text = "1"),
    DEA_CHOICE_ROW("begin", AT(begin), begins, "rest",
                   "what model 3d solves a design of a sweep from: a solved design near it, which "
                   "takes a third of the time, or the film at rest",
                   .default_text = "nearest"),
    DEA_FIELD_ROW(
        RECORD, "limits", AT(limits), .record = DEA_ROWS(limit_fields),
        .doc = "what may not be crossed: a probability of samples, a constraint of an optimisation",
        .absent_text = "none", .example = "[{quantity: breakdown_margin, above: 0.1}]",
        DEA_LIST(1, DEA_EXPLORE_LIMITS_MAX, struct dea_explore_limit, AT(limit_count))),
    DEA_FIELD_ROW(
        RECORD, "objectives", AT(objectives), .record = DEA_ROWS(objective_fields),
        .doc = "of dea optimise: what is wanted; of two the front between them",
        .absent_text = "none", .example = "[{quantity: centre_z_m, goal: most}]",
        DEA_LIST(1, DEA_EXPLORE_OBJECTIVES_MAX, struct dea_explore_objective, AT(objective_count))),
    DEA_CHOICE_ROW("method", AT(method), methods, "mma",
                   "slsqp and mma go by gradients; cobyla does without; random: the best of random "
                   "designs",
                   .default_text = "slsqp"),
    DEA_CHOICE_ROW("gradients", AT(gradients), gradients, "differences",
                   "of slsqp and mma: those of the model where it has some of its own, or "
                   "differences of designs",
                   .default_text = "model"),
    DEA_INTEGER_ROW("starts", AT(starts), "5",
                    "places from which the search begins: the start of the variables, then others",
                    .min = 1, .max = 1000, .default_text = "3"),
    DEA_INTEGER_ROW("evaluations", AT(evaluations), "500", "most designs of one search", .min = 1,
                    .max = 1000000, .default_text = "1000"),
    DEA_NUMBER_ROW("tolerance", AT(tolerance), "1", "1e-4",
                   "the search ends where the variables change by less, as a share of their range",
                   .min = 1e-12, .max = 0.1, .default_text = "1e-5"),
    DEA_INTEGER_ROW("front", AT(front), "11", "points of the front of two objectives", .min = 2,
                    .max = DEA_EXPLORE_FRONT_MAX, .default_text = "7"),
    DEA_FIELD_ROW(RECORD, "robust", AT(robust), .record = DEA_ROWS(robust_fields),
                  .doc = "of dea optimise, where variables have a scatter: what counts of the "
                         "scattered designs"),
};
dea_status dea_explore_correlations_check(struct dea_context *ctx,
                                          const struct dea_explore_file *file)
{
  return dea_correlations_check(ctx, file->correlations, file->correlation_count,
                                file->variable_count, "variable");
}

static dea_status check(struct dea_context *ctx, const void *user)
{
  const struct dea_explore_file *file = user;
  for (size_t i = 1; i < file->voltage_count; i++) {
    if (!(file->voltages_V[i].si > file->voltages_V[i - 1].si)) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, file->voltages_V[i].location,
                                   "voltages have to rise"));
    }
  }
  DEA_TRY(ctx, dea_fit_names_check(ctx, file->variables, file->variable_count,
                                   sizeof file->variables[0], "variable"));
  if (file->from_fit.text[0] != '\0') { // which the design has a say in: from_fit.c
    return file->correlation_count == 0
               ? DEA_OK
               : dea_finding_add(ctx, DEA_ERROR, file->correlations[0].location,
                                 "correlations are those of from_fit");
  }
  if (file->variable_count == 0) {
    const struct dea_location top = {file->head.file, 1, 1};
    return dea_finding_add(ctx, DEA_ERROR, top, "variables: say what changes (or from_fit)");
  }
  return dea_explore_correlations_check(ctx, file);
}

const struct dea_fit_form dea_explore_form = {
    {"file", "designs that differ in some values, and what is asked of them", file_fields,
     DEA_COUNT(file_fields)},
    sizeof(struct dea_explore_file),
    check};
