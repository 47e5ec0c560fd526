#include "identify/fit_file.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "result/provenance.h"
#include "table/csv_columns.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(struct dea_fit_file, member)
#define TEST_AT(member) offsetof(struct dea_fit_test, member)

/* ---- the fit file ---- */

const char *const dea_fit_kind_names[DEA_FIT_KINDS + 1] = {
    "uniaxial", "planar", "equibiaxial", "relaxation", "cyclic", "creep", NULL};
const char *const dea_fit_use_names[] = {"fit", "check", "predict", NULL};

/* Name in a fit file, unit, an example of a title, and the other column that says the same
 * (DEA_FIT_COLUMNS: there is none). */
static const struct column_type {
  const char *key, *unit, *example;
  enum dea_fit_column twin;
} types[DEA_FIT_COLUMNS] = {
    [DEA_FIT_TIME] = {"time", "s", "time (s)", DEA_FIT_COLUMNS},
    [DEA_FIT_STRETCH] = {"stretch", "1", "stretch", DEA_FIT_DISPLACEMENT},
    [DEA_FIT_DISPLACEMENT] = {"displacement", "m", "displacement (mm)", DEA_FIT_STRETCH},
    [DEA_FIT_STRESS] = {"stress", "Pa", "stress (kPa)", DEA_FIT_FORCE},
    [DEA_FIT_FORCE] = {"force", "N", "force (N)", DEA_FIT_STRESS},
    [DEA_FIT_STRESS_STD] = {"stress_std", "Pa", "stress std (kPa)", DEA_FIT_FORCE_STD},
    [DEA_FIT_FORCE_STD] = {"force_std", "N", "force std (N)", DEA_FIT_STRESS_STD},
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
    DEA_FIELD_ROW(RECORD, "columns", TEST_AT(columns), .record = DEA_ROWS(column_fields),
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
        RECORD, "parameters", AT(parameters), .record = DEA_ROWS(parameter_fields),
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
                   .absent_text = "free",
                   DEA_LIST(0, DEA_BRANCHES_MAX, struct dea_quantity, AT(branch_time_count))),
    DEA_FIELD_ROW(RECORD, "tests", AT(tests), .record = DEA_ROWS(test_fields), .required = true,
                  .doc = "measurements of the material",
                  .example = "[{name: tension, kind: uniaxial, file: tension.csv}]",
                  DEA_LIST(1, DEA_FIT_TESTS_MAX, struct dea_fit_test, AT(test_count))),
};
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

const struct dea_fit_form dea_fit_form = {{"fit file",
                                           "measurements of a material and what is fitted",
                                           fit_fields, DEA_COUNT(fit_fields)},
                                          sizeof(struct dea_fit_file),
                                          check};

/* ---- its tests ---- */

/* Of the stress on a straight line from rest to the largest one: below it a stretched strip is
 * slack. */
static const double slack_share = 0.002;
static const double early_share = 0.02; // stress at rest above it: the zero is not where it seems

struct work {
  struct dea_context *ctx;
  const struct dea_fit_test *test;
  const struct dea_csv_columns *raw;
  struct dea_fit_series *out;
  bool measured; // there is a stress
  size_t errors;
};

static struct dea_location line_of(const struct work *w, size_t row)
{
  return (struct dea_location){w->raw->file, w->raw->line[row], 1};
}

#define FOUND(w, location, ...)                                                                    \
  do {                                                                                             \
    (w)->errors++;                                                                                 \
    DEA_TRY((w)->ctx, dea_finding_add((w)->ctx, DEA_ERROR, location, __VA_ARGS__));                \
  } while (0)

/* ---- from columns to stretch, stress, time ---- */

static dea_status read_stretch(struct work *w)
{
  const double *stretch = w->raw->values[DEA_FIT_STRETCH];
  const double *displacement = w->raw->values[DEA_FIT_DISPLACEMENT];
  const bool held = w->test->kind.value == DEA_FIT_RELAXATION;
  if (stretch == NULL && displacement != NULL && isnan(w->test->length_m.si)) {
    FOUND(w, w->test->file.location, "'%.60s' has displacements: give the length of the strip",
          w->test->name.text);
  } else if (stretch == NULL && displacement == NULL && !held) {
    FOUND(w, w->test->file.location, "'%.80s' has no column '%s', 'strain (%%)' or '%s'",
          w->raw->file, types[DEA_FIT_STRETCH].example, types[DEA_FIT_DISPLACEMENT].example);
  }
  for (size_t i = 0; i < w->raw->rows && w->errors == 0; i++) {
    w->out->stretch[i] = stretch != NULL        ? stretch[i]
                         : displacement != NULL ? 1 + displacement[i] / w->test->length_m.si
                                                : w->test->stretch.si;
    if (!(w->out->stretch[i] > 0.01 && w->out->stretch[i] < 100)) {
      FOUND(w, line_of(w, i), "the stretch %g is none; it is 1 without load", w->out->stretch[i]);
    }
  }
  return DEA_OK;
}

static bool has_std_column(const struct work *w)
{
  return w->raw->values[DEA_FIT_STRESS_STD] != NULL ||
         (w->raw->values[DEA_FIT_FORCE_STD] != NULL && !isnan(w->test->section_m2.si));
}

static dea_status read_stress(struct work *w)
{
  const struct dea_fit_test *test = w->test;
  const double *stress = w->raw->values[DEA_FIT_STRESS], *force = w->raw->values[DEA_FIT_FORCE];
  const double *stress_std = w->raw->values[DEA_FIT_STRESS_STD];
  const double *force_std = w->raw->values[DEA_FIT_FORCE_STD];
  const double section = test->section_m2.si;
  if (stress == NULL && force != NULL && isnan(section)) {
    FOUND(w, test->file.location, "'%.60s' has forces: give the section of the strip",
          test->name.text);
  } else if (stress == NULL && force == NULL && w->measured) {
    FOUND(w, test->file.location,
          "'%.80s' has no column '%s' or '%s'; a true stress is to be divided by the stretch, to "
          "force over the unstretched section",
          w->raw->file, types[DEA_FIT_STRESS].example, types[DEA_FIT_FORCE].example);
  }
  const bool known = test->relative.origin != DEA_ABSENT || test->absolute_Pa.origin != DEA_ABSENT;
  if (known && has_std_column(w)) {
    DEA_TRY(w->ctx,
            dea_finding_add(w->ctx, DEA_WARNING,
                            test->relative.origin != DEA_ABSENT ? test->relative.location
                                                                : test->absolute_Pa.location,
                            "'%.80s' has a column of uncertainties: those count, and "
                            "uncertainty and uncertainty_absolute do not",
                            w->raw->file));
  }
  const double share = isnan(test->relative.si) ? 0 : test->relative.si;
  const double absolute = isnan(test->absolute_Pa.si) ? 0 : test->absolute_Pa.si;
  for (size_t i = 0; i < w->raw->rows && w->errors == 0; i++) {
    const double s = stress != NULL ? stress[i] : force != NULL ? force[i] / section : NAN;
    w->out->stress_Pa[i] = w->measured ? s : NAN;
    w->out->std_Pa[i] = stress_std != NULL                     ? stress_std[i]
                        : force_std != NULL && !isnan(section) ? force_std[i] / section
                        : known                                ? hypot(share * s, absolute)
                                                               : NAN;
  }
  return DEA_OK;
}

/* A stress and a force over the section that are not alike: the stress counts, which is said. */
static dea_status compare_forces(struct work *w)
{
  static const double alike = 0.01; // of the largest stress
  const double *stress = w->raw->values[DEA_FIT_STRESS], *force = w->raw->values[DEA_FIT_FORCE];
  const double section = w->test->section_m2.si;
  double largest = 0, off = 0;
  if (stress == NULL || force == NULL || isnan(section)) {
    return DEA_OK;
  }
  for (size_t i = 0; i < w->raw->rows; i++) {
    largest = fmax(largest, fabs(stress[i]));
    off = fmax(off, fabs(force[i] / section - stress[i])); // not NAN
  }
  return off <= alike * largest
             ? DEA_OK
             : dea_finding_add(w->ctx, DEA_WARNING, w->test->section_m2.location,
                               "the force over the section is off the stress by up to %.3g kPa "
                               "(%.3g %% of the largest): the stress counts",
                               1e-3 * off, 100 * off / largest);
}

/* Times from their column, or by the rate along the stretches. A slow test has none. */
static dea_status read_time(struct work *w)
{
  const struct dea_fit_test *test = w->test;
  const double *time = w->raw->values[DEA_FIT_TIME], rate = test->rate_per_s.si;
  const bool held = test->kind.value == DEA_FIT_RELAXATION || test->kind.value == DEA_FIT_CREEP;
  if (time == NULL && (held || (test->kind.value == DEA_FIT_CYCLIC && isnan(rate)))) {
    FOUND(w, test->file.location, "'%.80s' has no column '%s'%s", w->raw->file,
          types[DEA_FIT_TIME].example, held ? "" : ", and the test no rate");
    return DEA_OK;
  }
  if (time == NULL && isnan(rate)) {
    w->out->time_s = NULL;
    return DEA_OK;
  }
  double t = 0, l = 1;
  for (size_t i = 0; i < w->raw->rows && w->errors == 0; i++) {
    t = time != NULL ? time[i] : t + fabs(w->out->stretch[i] - l) / rate;
    l = w->out->stretch[i];
    w->out->time_s[i] = t;
    if (!(t >= 0)) {
      FOUND(w, line_of(w, i), "the time %g s is before the start of the test", t);
    } else if (i > 0 && t < w->out->time_s[i - 1]) {
      FOUND(w, line_of(w, i), "the time goes back from %g s to %g s: the rows are not in order",
            w->out->time_s[i - 1], t);
    }
  }
  return DEA_OK;
}

/* ---- what may be wrong with them ---- */

static dea_status check_order(struct work *w)
{
  const bool one_way = w->out->time_s == NULL;
  for (size_t i = 1; i < w->raw->rows && one_way && w->errors == 0; i++) {
    if (w->out->stretch[i] < w->out->stretch[i - 1]) {
      FOUND(w, line_of(w, i),
            "the stretch goes back from %g to %g: sort the rows, or say kind: cyclic and the rate",
            w->out->stretch[i - 1], w->out->stretch[i]);
    }
  }
  return DEA_OK;
}

/* The largest of the values of all rows, `least` at least. */
static double largest_of(const struct work *w, const double *values, double least)
{
  double most = least;
  for (size_t i = 0; i < w->raw->rows; i++) {
    most = fmax(most, values[i]);
  }
  return most;
}

/* Whether the stretches of a relaxation follow from its ramp. */
static bool is_ramped(const struct work *w)
{
  return w->test->kind.value == DEA_FIT_RELAXATION && w->raw->values[DEA_FIT_STRETCH] == NULL &&
         w->raw->values[DEA_FIT_DISPLACEMENT] == NULL;
}

static dea_status check_zero(struct work *w)
{
  const double most = largest_of(w, w->out->stress_Pa, 0);
  if (w->errors == 0 && is_ramped(w) && w->out->stretch[0] <= 1 &&
      w->out->stress_Pa[0] > fmax(early_share * most, 3 * w->out->std_Pa[0])) {
    FOUND(
        w, line_of(w, 0),
        "a stress of %.3g kPa at the time %g s, when the ramp begins: times count from there, add "
        "the ramp's to those from its end",
        1e-3 * w->out->stress_Pa[0], w->out->time_s[0]);
  }
  for (size_t i = 0; i < w->raw->rows && w->errors == 0; i++) {
    if (w->out->stretch[i] <= 1 && w->out->stress_Pa[i] > early_share * most &&
        !(w->out->stress_Pa[i] <= 3 * w->out->std_Pa[i]) &&
        w->out->time_s == NULL) { // unloading in time may do so
      FOUND(w, line_of(w, i),
            "a stress of %.3g kPa at the stretch %g, before the strip is stretched: take the force "
            "at zero off, or count the stretch from where the force begins (a strain is 0 there, "
            "and its title says so)",
            1e-3 * w->out->stress_Pa[i], w->out->stretch[i]);
    }
  }
  return DEA_OK;
}

/* The number that a name ends with ("VHB 2.5", "strip_2.5.csv"), with a decimal point: others may
 * count pieces. NAN: none. */
static double last_number(const char *name)
{
  size_t end = strlen(name), dot = 0;
  end -= end > 4 && strcmp(name + end - 4, ".csv") == 0 ? 4U : 0U;
  size_t begin = end;
  while (begin > 0 && (isdigit((unsigned char)name[begin - 1]) || name[begin - 1] == '.')) {
    begin--;
    dot += name[begin] == '.' ? 1U : 0U;
  }
  const bool alone = begin == 0 || strchr(" _-=", name[begin - 1]) != NULL;
  const double value = alone && dot == 1 && end > begin + 2 ? strtod(name + begin, NULL) : NAN;
  return value >= 1 && value < 50 ? value : NAN;
}

/* The number after "stretch" or "lambda" in a text, NAN: none. */
static double named_stretch(const char *text)
{
  static const char *const words[] = {"stretch", "lambda"};
  for (size_t k = 0; k < 2; k++) {
    for (const char *c = text; *c != '\0'; c++) {
      size_t n = 0;
      while (words[k][n] != '\0' && tolower((unsigned char)c[n]) == words[k][n]) {
        n++;
      }
      if (words[k][n] == '\0') {
        c += n;
        c += strspn(c, " _=-");
        char *end;
        double value = isdigit((unsigned char)*c) ? strtod(c, &end) : NAN;
        return value >= 1 && value < 50 ? value : NAN;
      }
    }
  }
  return NAN;
}

static dea_status check_reach(struct work *w)
{
  const struct dea_fit_test *test = w->test;
  const double most = largest_of(w, w->out->stretch, 1);
  double named = test->stretch.si;
  named = isnan(named) ? named_stretch(test->name.text) : named;
  named = isnan(named) ? named_stretch(w->raw->file) : named;
  named = isnan(named) ? last_number(test->name.text) : named;
  named = isnan(named) ? last_number(w->raw->file) : named;
  if (w->errors == 0 && most < 0.98 * named) {
    return dea_finding_add(w->ctx, DEA_WARNING, line_of(w, w->raw->rows - 1),
                           "'%.60s' is named for the stretch %g, but its file ends at %g",
                           test->name.text, named, most);
  }
  return DEA_OK;
}

/* ---- what is left out ---- */

static void keep_row(struct dea_fit_series *out, size_t to, size_t from)
{
  out->line[to] = out->line[from];
  out->stretch[to] = out->stretch[from];
  out->stress_Pa[to] = out->stress_Pa[from];
  out->std_Pa[to] = out->std_Pa[from];
  if (out->time_s != NULL) {
    out->time_s[to] = out->time_s[from];
    out->coupon.node_of_row[to] = out->coupon.node_of_row[from];
  }
}

/* Takes slack and repeated rows out, and those of a slow test at rest, which say nothing. */
static dea_status cut(struct work *w)
{
  struct dea_fit_series *out = w->out;
  const double most = largest_of(w, w->out->stress_Pa, 0),
               reach = fmax(largest_of(w, w->out->stretch, 1) - 1, 1e-9);
  size_t kept = 0;
  double from = INFINITY, to = 0;
  for (size_t i = 0; i < w->raw->rows; i++) {
    const double l = out->stretch[i], s = out->stress_Pa[i];
    const bool same = kept > 0 && l == out->stretch[kept - 1] && s == out->stress_Pa[kept - 1] &&
                      (out->time_s == NULL || out->time_s[i] == out->time_s[kept - 1]);
    const bool at_rest = fabs(l - 1) < 1e-9 && fabs(s) <= slack_share * most;
    if (w->measured && l > 1 && s <= slack_share * most * (l - 1) / reach) {
      out->slack++;
      from = fmin(from, l);
      to = fmax(to, l);
    } else if (same && w->measured) {
      out->repeated++;
    } else if (!(at_rest && w->measured)) {
      if (w->measured && out->std_Pa[i] <= 0) {
        FOUND(w, line_of(w, i), "the uncertainty of this stress is %.3g kPa: %s",
              1e-3 * out->std_Pa[i],
              has_std_column(w) ? "it has to be more than 0"
                                : "add uncertainty_absolute to the test");
        return DEA_OK;
      }
      keep_row(out, kept++, i);
    }
  }
  out->rows = kept;
  if (out->slack > 0 && kept > 0) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_WARNING, (struct dea_location){w->raw->file, 0, 0},
                                    "%zu of %zu rows, at stretches %.3g to %.3g, carry no force: "
                                    "the strip is slack there, they are left out",
                                    out->slack, w->raw->rows, from, to));
  }
  if (out->repeated > 0) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_WARNING, (struct dea_location){w->raw->file, 0, 0},
                                    "%zu of %zu rows repeat the one before and are left out",
                                    out->repeated, w->raw->rows));
  }
  return DEA_OK;
}

static dea_status check_count(struct work *w)
{
  if (w->errors > 0 || w->out->rows > 1 || (!w->measured && w->out->rows > 0)) {
    return DEA_OK;
  }
  if (w->out->rows == 0 && w->out->slack > 0) {
    FOUND(w, line_of(w, 0), "all %zu rows are slack: no stretch with a force", w->raw->rows);
  } else {
    FOUND(w, line_of(w, 0), "%zu row%s with a stretch and a force %s no curve", w->out->rows,
          w->out->rows == 1 ? "" : "s", w->out->rows == 1 ? "is" : "are");
  }
  return DEA_OK;
}

/* ---- all of it ---- */

static dea_status build(struct dea_arena *arena, struct work *w)
{
  struct dea_fit_series *out = w->out;
  const struct dea_fit_test *test = w->test;
  DEA_TRY(w->ctx, read_stretch(w));
  DEA_TRY(w->ctx, read_stress(w));
  DEA_TRY(w->ctx, compare_forces(w));
  DEA_TRY(w->ctx, read_time(w));
  double ramp = 0;
  if (test->kind.value == DEA_FIT_RELAXATION && w->errors == 0) {
    ramp = !isnan(test->ramp_s.si) ? test->ramp_s.si
                                   : fabs(test->stretch.si - 1) / test->rate_per_s.si;
    for (size_t i = 0; i < w->raw->rows && is_ramped(w); i++) { // on its way
      out->stretch[i] = 1 + (test->stretch.si - 1) * fmin(1, out->time_s[i] / ramp);
    }
  }
  DEA_TRY(w->ctx, check_order(w));
  DEA_TRY(w->ctx, check_zero(w));
  DEA_TRY(w->ctx, check_reach(w));
  if (w->errors == 0) {
    // the way goes through all rows, also those that are left out
    out->coupon.rows = w->raw->rows;
    out->coupon.stretch = out->stretch;
    DEA_TRY(w->ctx, out->time_s != NULL ? dea_coupon_follow(arena, out->time_s, ramp, &out->coupon)
                                        : DEA_OK);
    DEA_TRY(w->ctx, cut(w));
    DEA_TRY(w->ctx, check_count(w));
    out->coupon.rows = out->rows;
  }
  return w->errors == 0
             ? DEA_OK
             : dea_fail(w->ctx, DEA_E_IO, "the test '%.60s' cannot be used", test->name.text);
}

static dea_status build_series(struct dea_arena *arena, const struct dea_fit_test *test,
                               const struct dea_csv_columns *raw, struct dea_fit_series *out)
{
  struct work w = {arena->ctx, test, raw, out, test->use.value != DEA_FIT_PREDICTED, 0};
  out->test = test;
  out->file = raw->file;
  out->line = dea_arena_alloc(arena, raw->rows, sizeof *out->line);
  out->stretch = dea_arena_alloc(arena, raw->rows, sizeof *out->stretch);
  out->time_s = dea_arena_alloc(arena, raw->rows, sizeof *out->time_s);
  out->stress_Pa = dea_arena_alloc(arena, raw->rows, sizeof *out->stress_Pa);
  out->std_Pa = dea_arena_alloc(arena, raw->rows, sizeof *out->std_Pa);
  DEA_TRY(arena->ctx, dea_arena_status(arena));
  memcpy(out->line, raw->line, raw->rows * sizeof *out->line);
  const int kind = test->kind.value; // the first say how the piece is held themselves
  out->coupon.mode = (enum dea_coupon_mode)(kind <= DEA_FIT_EQUIBIAXIAL ? kind : test->mode.value);
  return build(arena, &w);
}

/* ---- the files ---- */

/* What a test wants of its file, by the titles that it names. */
static void want(const struct dea_fit_test *test, char names[][DEA_CSV_FIELD_MAX],
                 struct dea_csv_wanted *wanted)
{
  for (int c = 0; c < DEA_FIT_COLUMNS; c++) {
    const struct column_type *type = &types[c];
    const char *title = test->columns[c].text;
    char unit[DEA_CSV_FIELD_MAX];
    dea_csv_split_title(title[0] != '\0' ? title : type->key, names[c], unit);
    wanted[c] = (struct dea_csv_wanted){.name = names[c],
                                        .title = title[0] != '\0' ? title : type->example,
                                        .measure = {type->unit, type->example},
                                        .needed = title[0] != '\0',
                                        .filled = true,
                                        .strain = c == DEA_FIT_STRETCH};
    const bool has_twin =
        type->twin != DEA_FIT_COLUMNS && test->columns[type->twin].text[0] != '\0';
    if (title[0] == '\0' && has_twin) { // another title for the same was chosen
      wanted[c].name = " ";             // none has that
      wanted[c].strain = false;
    }
  }
  for (int c = 0; c < DEA_FIT_COLUMNS && test->use.value == DEA_FIT_PREDICTED; c++) {
    const bool result = c >= DEA_FIT_STRESS;
    wanted[c].filled = !result;
    wanted[c].needed = wanted[c].needed && !result;
  }
}

/* Reads a test of its file. */
static dea_status read_path(struct dea_arena *arena, const struct dea_fit_test *test,
                            const char *path, struct dea_fit_series *out)
{
  char names[DEA_FIT_COLUMNS][DEA_CSV_FIELD_MAX];
  struct dea_csv_wanted wanted[DEA_FIT_COLUMNS];
  struct dea_csv_columns columns;
  want(test, names, wanted);
  dea_sha256_file(path, out->sha256);
  DEA_TRY(arena->ctx,
          dea_csv_columns_read(arena->ctx, path, wanted, DEA_FIT_COLUMNS, NULL, &columns));
  dea_status status = build_series(arena, test, &columns, out);
  dea_csv_columns_free(arena->ctx, &columns);
  return status;
}

dea_status dea_fit_series_read(struct dea_arena *arena, const struct dea_fit_file *file,
                               struct dea_fit_series **out)
{
  dea_status worst = DEA_OK;
  *out = dea_arena_alloc(arena, file->test_count, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  for (size_t i = 0; i < file->test_count; i++) { // all of them, for all that is wrong
    const struct dea_fit_test *test = &file->tests[i];
    char *path = dea_path_beside(arena->ctx, file->head.file, test->file.text);
    dea_status status = path != NULL ? read_path(arena, test, path, &(*out)[i]) : DEA_E_MEMORY;
    dea_free(arena->ctx, path);
    worst = status != DEA_OK ? status : worst;
  }
  return worst;
}
