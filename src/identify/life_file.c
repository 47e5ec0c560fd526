#include "identify/life_file.h"

#include <string.h>

#define AT(member) offsetof(struct dea_life_file, member)
#define OF(member) offsetof(struct dea_life_specimen, member)
#define COUNT(array) (sizeof(array) / sizeof(array)[0])

const char *const dea_life_clock_names[] = {"cycles", "time", "under_voltage", "charge", NULL};
const char *const dea_life_clock_units[] = {"cycles", "h", "h", "mC"};
const double dea_life_clock_factors[] = {1, 1 / 3600.0, 1 / 3600.0, 1e3};

static const struct dea_field specimen_fields[] = {
    DEA_LABEL_ROW("name", OF(name), "F12", "name of the specimen", .required = true),
    DEA_LABEL_ROW("reduced", OF(reduced), "[F12-week1.reduced, F12-week2.reduced]",
                  "folders that dea reduce wrote of its recordings, in time, counted from the "
                  "folder of this file",
                  DEA_LIST(1, DEA_LIFE_PARTS_MAX, struct dea_label, OF(reduced_count)),
                  .lone = true, .absent_text = "its life is given"),
    DEA_NUMBER_ROW(
        "life", OF(life), "1", "120000",
        "its life in the unit of the clock (cycles, h, h, mC), where it is known already",
        .above_min = true, .max = 1e15, .absent_text = "from its recordings"),
    DEA_CHOICE_ROW("failed", OF(failed), dea_no_yes, "yes",
                   "of a given life whether it ended by a failure; of recordings whether the "
                   "specimen failed at their end where no criterion says so",
                   .default_text = "no"),
};
static const struct dea_record specimen_record = {"specimen", "a specimen that was cycled",
                                                  specimen_fields, COUNT(specimen_fields)};

static const struct dea_field fields[] = {
    DEA_FIT_HEAD_FIELDS("name of what is fitted", "batch-7", "none", "what was cycled",
                        "discs of batch 7 at 3 kV, 10 Hz"),
    DEA_FIELD_ROW(
        RECORD, "life", AT(specimens), .record = &specimen_record, .required = true,
        .doc = "the specimens, those that survived too",
        .example = "[{name: F12, reduced: F12.reduced}, {name: F13, life: 120000, failed: yes}]",
        DEA_LIST(1, DEA_LIFE_SPECIMENS_MAX, struct dea_life_specimen, AT(specimen_count))),
    DEA_CHOICE_ROW("clock", AT(clock), dea_life_clock_names, "under_voltage",
                   "what a life is counted in: cycles, time (h), time under voltage (h), charge "
                   "brought to the film (mC)",
                   .default_text = "cycles"),
    DEA_NUMBER_ROW("stroke_loss", AT(stroke_loss), "1", "20 %",
                   "share of its first stroke that a specimen may lose", .above_min = true,
                   .max = 1, .absent_text = "no failure"),
    DEA_NUMBER_ROW("largest_leakage", AT(leakage_A), "A", "2 uA",
                   "current at the held voltage beyond which a specimen has failed",
                   .above_min = true, .max = 1, .absent_text = "no failure"),
    DEA_CHOICE_ROW("at_breakdown", AT(breakdown), dea_no_yes, "no",
                   "whether a breakdown is a failure", .default_text = "yes"),
    DEA_INTEGER_ROW("reference_cycles", AT(reference_cycles), "100",
                    "cycles whose mean is the first stroke", .min = 1, .max = 1e6,
                    .default_text = "10"),
    DEA_INTEGER_ROW("lasting", AT(lasting), "10",
                    "cycles in a row that a lost stroke or a leakage has to last; the first of "
                    "them is the failure",
                    .min = 1, .max = 1e6, .default_text = "3"),
};
const struct dea_record dea_life_file_record = {"fit file", "life tests, for Weibull's law of them",
                                                fields, COUNT(fields)};

/* A finding where a recording stands before this one already: its cycles would count twice. */
static dea_status check_once(struct dea_context *ctx, const struct dea_life_file *fit, size_t i,
                             size_t part)
{
  const struct dea_label *own = &fit->specimens[i].reduced[part];
  for (size_t k = 0; k <= i; k++) {
    const struct dea_life_specimen *other = &fit->specimens[k];
    for (size_t p = 0; p < (k < i ? other->reduced_count : part); p++) {
      if (strcmp(other->reduced[p].text, own->text) == 0) {
        return dea_finding_add(ctx, DEA_ERROR, own->location,
                               "'%.80s' is a recording of '%.60s' already, in line %zu", own->text,
                               other->name.text, other->reduced[p].location.line);
      }
    }
  }
  return DEA_OK;
}

static dea_status check(struct dea_context *ctx, const void *file)
{
  const struct dea_life_file *fit = file;
  for (size_t i = 0; i < fit->specimen_count; i++) {
    const struct dea_life_specimen *own = &fit->specimens[i];
    for (size_t p = 0; p < own->reduced_count; p++) {
      DEA_TRY(ctx, check_once(ctx, fit, i, p));
    }
    if ((own->reduced_count > 0) == (own->life.origin != DEA_ABSENT)) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, own->name.location,
                                   "'%.60s' needs %s: its recordings, or its life", own->name.text,
                                   own->reduced_count > 0 ? "one" : "something"));
    }
  }
  return dea_fit_names_check(ctx, fit->specimens, fit->specimen_count, sizeof fit->specimens[0],
                             "specimen");
}

DEA_FIT_FILE(life_file, dea_life_file_record, check)
