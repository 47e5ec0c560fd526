#include "identify/device_file.h"

#define AT(member) offsetof(struct dea_device_file, member)
#define CURVE_AT(member) offsetof(struct dea_device_curve_text, member)

static const char *const kinds[] = {"sweep", "force", "transient", NULL}; // enum dea_device_kind
static const char *const uses[] = {"fit", "check", NULL}; // the first of enum dea_fit_use

static const struct dea_field curve_fields[] = {
    DEA_LABEL_ROW("name", CURVE_AT(name), "strain", "name of the measurement", .required = true),
    DEA_LABEL_ROW("file", CURVE_AT(file), "strain.csv",
                  "CSV table of quantities over the voltage, or a folder written by dea reduce; "
                  "counted from the folder of this file",
                  .required = true),
    DEA_LABEL_ROW(
        "quantities", CURVE_AT(quantities), "[electrode_stretch, capacitance_F]",
        "keys of the quantities that are taken, as dea compare --quantity has them",
        DEA_LIST(1, DEA_DEVICE_QUANTITIES_MAX, struct dea_label, CURVE_AT(quantity_count)),
        .absent_text = "all of the file"),
    DEA_CHOICE_ROW("kind", CURVE_AT(kind), kinds, "force",
                   "sweep: the film moves freely; force: the tip of compute.force is held at its "
                   "first depth, from which a column 'tip depth (um)' counts; transient: the "
                   "design's waveform is played, rows have 'time (s)'",
                   .default_text = "sweep"),
    DEA_CHOICE_ROW("use", CURVE_AT(use), uses, "check", "fit: fitted; check: only compared",
                   .default_text = "fit"),
    DEA_NUMBER_ROW("uncertainty", CURVE_AT(relative), "1", "2 %",
                   "standard uncertainty of each value, as a share of it", .max = 10,
                   .absent_text = "the columns std, or from the scatter"),
    DEA_LABEL_ROW("uncertainty_absolute", CURVE_AT(absolute), "2 um",
                  "standard uncertainty of each value in the unit of the one quantity; added to "
                  "the share as squares",
                  .absent_text = "the columns std, or from the scatter"),
};

static const struct dea_field parameter_fields[] = {
    DEA_LABEL_ROW("name", offsetof(struct dea_fit_parameter_text, name), "film.thickness",
                  DEA_DEVICE_PARAM_DOC ", or film.branch.N.modulus or .time", .required = true),
    DEA_FIT_PARAMETER_FIELD(start, "where the search begins", "100 um", "the design's"),
    DEA_FIT_PARAMETER_FIELD(low, "lower bound", "80 um", "the key's"),
    DEA_FIT_PARAMETER_FIELD(high, "upper bound", "120 um", "the key's"),
    DEA_FIT_PARAMETER_FIELD(
        prior, "value that was known before, or the material of the catalogue that has it",
        "100 um", "none"),
    DEA_FIT_PARAMETER_FIELD(prior_std, "standard uncertainty of the prior", "5 um",
                            "none, or the material's"),
    DEA_FIT_FIXED_FIELD,
};

static const struct dea_field file_fields[] = {
    DEA_FIT_HEAD_FIELDS("name of the design that is written", "sample-3", "the design's",
                        "what the device is", "sample 3 as built"),
    DEA_LABEL_ROW("design", AT(design), "frdea-4.yaml",
                  "design file of the device as it was meant, counted from the folder of this file",
                  .required = true),
    DEA_LABEL_ROW(
        "model", AT(model), "axisymmetric",
        "model that computes the curves; of 3d the design's compute.solid says which film",
        .required = true),
    DEA_FIELD_ROW(
        RECORD, "parameters", AT(parameters), .record = DEA_ROWS(parameter_fields),
        .required = true, .doc = "numbers of the design that are fitted",
        .example = "[{name: pre_stretch, low: 1.2, high: 1.6}]",
        DEA_LIST(1, DEA_DEVICE_PARAMS_MAX, struct dea_fit_parameter_text, AT(parameter_count))),
    DEA_FIELD_ROW(RECORD, "curves", AT(curves), .record = DEA_ROWS(curve_fields), .required = true,
                  .doc = "measurements of the device",
                  .example = "[{name: strain, file: strain.csv}]",
                  DEA_LIST(1, DEA_DEVICE_FILES_MAX, struct dea_device_curve_text, AT(curve_count))),
};
static dea_status check(struct dea_context *ctx, const void *file)
{
  const struct dea_device_file *fit = file;
  DEA_TRY(ctx,
          dea_fit_names_check(ctx, fit->curves, fit->curve_count, sizeof fit->curves[0], "curve"));
  return dea_fit_names_check(ctx, fit->parameters, fit->parameter_count, sizeof fit->parameters[0],
                             "parameter");
}

const struct dea_fit_form dea_device_form = {
    {"fit file", "measurements of a device and what of its design is fitted", file_fields,
     DEA_COUNT(file_fields)},
    sizeof(struct dea_device_file),
    check};
