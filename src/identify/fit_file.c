#include "identify/fit_file.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define AT(member) offsetof(struct dea_fit_file, member)
#define TEST_AT(member) offsetof(struct dea_fit_test, member)

const char *const dea_fit_kind_names[DEA_FIT_KINDS + 1] = {
    "uniaxial", "planar", "equibiaxial", "relaxation", "cyclic", "creep", NULL};
const char *const dea_fit_use_names[] = {"fit", "check", "predict", NULL};

const struct dea_fit_column_type dea_fit_columns[DEA_FIT_COLUMNS] = {
    [DEA_FIT_TIME] = {"time", "s", "time (s)"},
    [DEA_FIT_STRETCH] = {"stretch", "1", "stretch"},
    [DEA_FIT_DISPLACEMENT] = {"displacement", "m", "displacement (mm)"},
    [DEA_FIT_STRESS] = {"stress", "Pa", "stress (kPa)"},
    [DEA_FIT_FORCE] = {"force", "N", "force (N)"},
    [DEA_FIT_STRESS_STD] = {"stress_std", "Pa", "stress std (kPa)"},
    [DEA_FIT_FORCE_STD] = {"force_std", "N", "force std (N)"},
};

#define COLUMN_FIELD(column, word, meaning)                                                        \
  {                                                                                                \
    .key = word, .kind = DEA_FIELD_LABEL, .offset = (column) * sizeof(struct dea_label),           \
    .doc = meaning, .example = word, .absent_text = "a column of that name"                        \
  }
static const struct dea_field column_fields[] = {
    COLUMN_FIELD(DEA_FIT_TIME, "time", "time since the strip began to be stretched"),
    COLUMN_FIELD(DEA_FIT_STRETCH, "stretch", "stretch, length over unstretched length"),
    COLUMN_FIELD(DEA_FIT_DISPLACEMENT, "displacement", "change of length, with length"),
    COLUMN_FIELD(DEA_FIT_STRESS, "stress", "nominal stress, force over unstretched section"),
    COLUMN_FIELD(DEA_FIT_FORCE, "force", "force, with section"),
    COLUMN_FIELD(DEA_FIT_STRESS_STD, "stress_std", "standard uncertainty of the stress"),
    COLUMN_FIELD(DEA_FIT_FORCE_STD, "force_std", "standard uncertainty of the force"),
};
static const struct dea_record column_record = {
    "columns", "titles of the columns, without their units", column_fields, COUNT(column_fields)};

static const struct dea_field test_fields[] = {
    DEA_LABEL_ROW("name", TEST_AT(name), "tension to 3", "name of the test", .required = true),
    DEA_LABEL_ROW("file", TEST_AT(file), "tension.csv",
                  "CSV file, counted from the folder of this file", .required = true),
    DEA_CHOICE_ROW("kind", TEST_AT(kind), dea_fit_kind_names, "uniaxial",
                   "kind of test; relaxation and cyclic need times or a rate, creep times",
                   .required = true),
    DEA_CHOICE_ROW("mode", TEST_AT(mode), dea_coupon_mode_names, "uniaxial",
                   "how the piece of a relaxation or cyclic test is held",
                   .default_text = "uniaxial"),
    DEA_CHOICE_ROW("use", TEST_AT(use), dea_fit_use_names, "check",
                   "fit: fitted; check: only compared; predict: no stress is needed",
                   .default_text = "fit"),
    DEA_FIELD_ROW(RECORD, "columns", TEST_AT(columns), .record = &column_record,
                  .doc = "titles of the columns where they are others"),
    DEA_NUMBER_ROW("length", TEST_AT(length_m), "m", "80 mm",
                   "unstretched length between the clamps, with a column of displacements",
                   .above_min = true, .max = 100, .absent_text = "not needed"),
    DEA_NUMBER_ROW("section", TEST_AT(section_m2), "m^2", "22 mm^2",
                   "unstretched cross-section, with a column of forces", .above_min = true,
                   .max = 1, .absent_text = "not needed"),
    DEA_NUMBER_ROW("uncertainty", TEST_AT(relative), "1", "2 %",
                   "standard uncertainty of each stress, as a share of it", .max = 10,
                   .absent_text = "from the scatter"),
    DEA_NUMBER_ROW("uncertainty_absolute", TEST_AT(absolute_Pa), "Pa", "0.5 kPa",
                   "standard uncertainty of each stress; added to the share as squares",
                   .max = 1e12, .absent_text = "from the scatter"),
    DEA_NUMBER_ROW("rate", TEST_AT(rate_per_s), "s^-1", "0.25 s^-1", "rate of stretching",
                   .above_min = true, .max = 1e6, .absent_text = "by the times"),
    DEA_NUMBER_ROW("ramp", TEST_AT(ramp_s), "s", "4 s",
                   "of a relaxation: time in which the stretch is reached", .above_min = true,
                   .max = 1e9, .absent_text = "by the rate"),
    DEA_NUMBER_ROW("stretch", TEST_AT(stretch), "1", "3",
                   "stretch that is held in a relaxation; of other tests the one that they go to",
                   .above_min = true, .max = 100, .absent_text = "in the file"),
    DEA_NUMBER_ROW("temperature", TEST_AT(temperature_K), "K", "40 degC",
                   "temperature of this test", .min = 100, .max = 600,
                   .absent_text = "that of the file"),
};
static const struct dea_record test_record = {"test", "a test of the material", test_fields,
                                              COUNT(test_fields)};

static const struct dea_field parameter_fields[] = {
    DEA_LABEL_ROW("name", offsetof(struct dea_fit_parameter_text, name), "c1",
                  "parameter of the law", .required = true),
    DEA_FIT_PARAMETER_FIELD(start, "where the search begins", "100 kPa", "found"),
    DEA_FIT_PARAMETER_FIELD(low, "lower bound", "1 kPa", "the law's"),
    DEA_FIT_PARAMETER_FIELD(high, "upper bound", "1 MPa", "the law's"),
    DEA_FIT_PARAMETER_FIELD(prior, "value that was known before", "180 kPa", "none"),
    DEA_FIT_PARAMETER_FIELD(prior_std, "standard uncertainty of the prior", "20 kPa", "none"),
    DEA_FIT_FIXED_FIELD,
};
static const struct dea_record parameter_record = {"parameter", "what is known of a parameter",
                                                   parameter_fields, COUNT(parameter_fields)};

static const struct dea_field fit_fields[] = {
    DEA_FIT_HEAD_FIELDS("name of the material that is written", "my-silicone", "none",
                        "what the material is", "silicone film, batch 7"),
    DEA_LABEL_ROW("material", AT(material), "elastosil-2030",
                  "material of the catalogue whose permittivity, breakdown and density are kept",
                  .absent_text = "none"),
    DEA_NUMBER_ROW("temperature", AT(temperature_K), "K", "23 degC", "temperature of the tests",
                   .min = 100, .max = 600, .absent_text = "unknown"),
    DEA_NUMBER_ROW("reference_temperature", AT(reference_K), "K", "20 degC",
                   "temperature from which the branches' times shift to that of each test, by "
                   "constants of Williams, Landel and Ferry that are fitted",
                   .min = 100, .max = 600, .absent_text = "no shift"),
    DEA_LABEL_ROW("laws", AT(laws), "[neo-hookean, yeoh, ogden-2]",
                  "laws to fit; of several the one that foretells held-out tests best is taken; "
                  "NAME-N: its first N terms",
                  .required = true, DEA_LIST(1, DEA_FIT_LAWS_MAX, struct dea_label, AT(law_count))),
    DEA_FIELD_ROW(
        RECORD, "parameters", AT(parameters), .record = &parameter_record,
        .absent_text = "all free",
        .doc = "what is known of parameters; those that are not named are free",
        .example = "[{name: c1, low: 1 kPa}]",
        DEA_LIST(0, DEA_LAW_PARAM_MAX, struct dea_fit_parameter_text, AT(parameter_count))),
    DEA_LABEL_ROW(
        "branches", AT(branches), "auto",
        "viscous branches with free times: none, a number, or auto (as many as the data support)",
        .default_text = "none"),
    DEA_NUMBER_ROW("branch_times", AT(branch_s), "s", "[1 s, 10 s, 100 s]",
                   "fixed relaxation times, a branch each", .above_min = true, .max = 1e12,
                   .list_max = DEA_BRANCHES_MAX, .element_size = sizeof(struct dea_quantity),
                   .count_offset = AT(branch_time_count), .absent_text = "free"),
    DEA_FIELD_ROW(RECORD, "tests", AT(tests), .record = &test_record, .required = true,
                  .doc = "measurements of the material",
                  .example = "[{name: tension, kind: uniaxial, file: tension.csv}]",
                  DEA_LIST(1, DEA_FIT_TESTS_MAX, struct dea_fit_test, AT(test_count))),
};
const struct dea_record dea_fit_record = {
    "fit file", "measurements of a material and what is fitted", fit_fields, COUNT(fit_fields)};

double dea_fit_temperature_K(const struct dea_fit_file *file, const struct dea_fit_test *test)
{
  const bool is_own = test->temperature_K.origin != DEA_ABSENT;
  const struct dea_quantity *temperature = is_own ? &test->temperature_K : &file->temperature_K;
  return temperature->origin != DEA_ABSENT ? temperature->si : NAN;
}

/* What the table cannot say of a test. */
static dea_status check_test(struct dea_context *ctx, const struct dea_fit_test *test)
{
  bool relaxation = test->kind.value == DEA_FIT_RELAXATION;
  bool ramp = test->ramp_s.origin != DEA_ABSENT, rate = test->rate_per_s.origin != DEA_ABSENT;
  if (relaxation && ramp == rate) {
    return dea_finding_add(ctx, DEA_ERROR, test->kind.location,
                           "'%.60s': a relaxation needs %s: in which time or at which rate its "
                           "stretch was reached",
                           test->name.text, ramp ? "either ramp or rate" : "ramp or rate");
  }
  if (relaxation && test->stretch.origin == DEA_ABSENT) {
    return dea_finding_add(ctx, DEA_ERROR, test->kind.location,
                           "'%.60s': a relaxation needs the stretch that is held", test->name.text);
  }
  const bool is_mode = test->kind.value <= DEA_FIT_EQUIBIAXIAL; // says how it is held itself
  if (is_mode && test->mode.origin == DEA_GIVEN && test->mode.value != test->kind.value) {
    return dea_finding_add(ctx, DEA_ERROR, test->mode.location,
                           "'%.60s' is %s by its kind; mode is of relaxations, cycles and creep",
                           test->name.text, dea_fit_kind_names[test->kind.value]);
  }
  if (!relaxation && ramp) {
    return dea_finding_add(ctx, DEA_ERROR, test->ramp_s.location,
                           "ramp is of relaxations; '%.60s' may have a rate", test->name.text);
  }
  return DEA_OK;
}

static dea_status check(struct dea_context *ctx, const void *file)
{
  const struct dea_fit_file *fit = file;
  for (size_t i = 0; i < fit->test_count; i++) {
    DEA_TRY(ctx, check_test(ctx, &fit->tests[i]));
    if (fit->reference_K.origin != DEA_ABSENT &&
        isnan(dea_fit_temperature_K(fit, &fit->tests[i]))) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, fit->tests[i].name.location,
                                   "'%.60s' has no temperature, which a fit with a "
                                   "reference_temperature needs",
                                   fit->tests[i].name.text));
    }
  }
  if (fit->parameter_count > 0 && fit->law_count > 1) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_ERROR, fit->parameters[0].name.location,
                            "parameters are those of one law; %zu laws are given", fit->law_count));
  }
  DEA_TRY(ctx, dea_fit_names_check(ctx, fit->parameters, fit->parameter_count,
                                   sizeof fit->parameters[0], "parameter"));
  return dea_fit_names_check(ctx, fit->tests, fit->test_count, sizeof fit->tests[0], "test");
}

DEA_FIT_FILE(fit_file, dea_fit_record, check)
