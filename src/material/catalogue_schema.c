/* The table of a material's data, and what is checked beyond it. */
#include "base/correlations.h"
#include "base/schema_value.h"
#include "material/catalogue.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LAW(member) offsetof(struct dea_law_set, member)
#define PERMITTIVITY(member) offsetof(struct dea_permittivity_set, member)
#define BREAKDOWN(member) offsetof(struct dea_breakdown_set, member)
#define VISCOSITY(member) offsetof(struct dea_viscosity_set, member)
#define BRANCH(member) offsetof(struct dea_branch_data, member)
#define DATA(member) offsetof(struct dea_material_data, member)
#define HEAD(member) offsetof(struct dea_set_head, member)

/* Fields that every set of numbers has: uncertainty, range in words, temperature, source
 * (required), note. */
#define NOTE_FIELDS(type, member)                                                                  \
  DEA_FIELD_ROW(TEXT, "source", offsetof(type, member.source), .required = true,                   \
                .doc = "where the numbers come from", .example = "\"data sheet, maker, year\""),   \
      DEA_FIELD_ROW(TEXT, "uncertainty", offsetof(type, member.uncertainty),                       \
                    .doc = "uncertainty, in words or as +- value", .example = "\"+- 5 %\""),       \
      DEA_FIELD_ROW(TEXT, "range", offsetof(type, member.range),                                   \
                    .doc = "range in which the numbers hold, in words",                            \
                    .example = "\"23 degC, below 1 Hz\""),                                         \
      DEA_NUMBER_ROW("temperature", offsetof(type, member.temperature_K), "K", "23 degC",          \
                     "temperature that they were measured at", .min = 100, .max = 600),            \
      DEA_NUMBER_ROW(                                                                              \
          "temperature_range", offsetof(type, member.temperatures.limits), "K",                    \
          "[0 degC, 80 degC]", "lowest and highest temperature at which they hold", .min = 100,    \
          .max = 600,                                                                              \
          DEA_LIST(2, 2, struct dea_quantity, offsetof(type, member.temperatures.count))),         \
      DEA_FIELD_ROW(TEXT, "note", offsetof(type, member.note),                                     \
                    .doc = "anything else a user should know",                                     \
                    .example = "\"as bought, before curing\"")

#define STRETCH_RANGE_FIELD                                                                        \
  DEA_NUMBER_ROW("stretch_range", HEAD(range.limits), "1", "[1, 2]",                               \
                 "smallest and largest stretch that the data cover", .above_min = true,            \
                 .max = 100, DEA_LIST(2, 2, struct dea_quantity, HEAD(range.count)))

/* Smallest and largest value that sources give; checked to hold the value itself. */
#define VALUE_RANGE_FIELD(name, type, member, si)                                                  \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(type, member.limits), .unit = si,    \
    .max = 1e30, .list_min = 2, .list_max = 2, .element_size = sizeof(struct dea_quantity),        \
    .count_offset = offsetof(type, member.count),                                                  \
    .doc = "smallest and largest value that sources give"                                          \
  }

/* Of what sets begin with. */
#define ID_FIELD                                                                                   \
  DEA_LABEL_ROW("id", HEAD(id), "supplier-2020", "name by which a design chooses this set",        \
                .required = true)
#define SET_NOTE_FIELDS NOTE_FIELDS(struct dea_set_head, notes)

static const struct dea_field law_fields[] = {
    ID_FIELD,
    DEA_LABEL_ROW("law", LAW(law_name), "yeoh", "hyperelastic law", .required = true),
    DEA_FIELD_ROW(SECTION, "parameters", LAW(parameters), .required = true,
                  .doc = "parameters of the law, each with its unit",
                  .example = "{c1: 178.4 kPa, c2: -6.0 kPa, c3: 4.2 kPa}"),
    DEA_FIELD_ROW(SECTION, "standard_uncertainties", LAW(uncertainties), .absent_text = "not given",
                  .doc = "standard uncertainties of parameters, each with its unit",
                  .example = "{c1: 2.1 kPa}"),
    DEA_NUMBER_ROW("correlations", LAW(correlations), "1", "[-0.8]",
                   "correlations of these in the law's order: 2 with 1, 3 with 1, 3 with 2, ...",
                   .min = -1, .max = 1, .absent_text = "not given",
                   DEA_LIST(0, DEA_LAW_PARAM_MAX *(DEA_LAW_PARAM_MAX - 1) / 2, struct dea_quantity,
                            LAW(correlation_count))),
    DEA_NUMBER_ROW("fibre_angle", LAW(fibre_angle_rad), "radian", "30 degree",
                   "angle of an anisotropic law's fibres to the radial direction",
                   .default_text = "0 degree"),
    STRETCH_RANGE_FIELD,
    SET_NOTE_FIELDS,
};

static const struct dea_field permittivity_fields[] = {
    ID_FIELD,
    DEA_NUMBER_ROW("at_rest", PERMITTIVITY(at_rest), "1", "2.8",
                   "relative permittivity of the unstretched film", .min = 1, .max = 1e5,
                   .required = true),
    VALUE_RANGE_FIELD("value_range", struct dea_permittivity_set, values, "1"),
    DEA_NUMBER_ROW("slope", PERMITTIVITY(slope), "1", "-0.28",
                   "change of the relative permittivity by unit of mean in-plane stretch",
                   .default_text = "0"),
    STRETCH_RANGE_FIELD,
    SET_NOTE_FIELDS,
};

static const struct dea_field breakdown_fields[] = {
    ID_FIELD,
    DEA_NUMBER_ROW("at_rest", BREAKDOWN(at_rest_V_per_m), "V/m", "80 V/um",
                   "breakdown field of the unstretched film; with weibull_shape the one at which "
                   "63.2 % of films have broken",
                   .above_min = true, .max = 1e10, .required = true),
    VALUE_RANGE_FIELD("value_range", struct dea_breakdown_set, values, "V/m"),
    DEA_NUMBER_ROW("exponent", BREAKDOWN(exponent), "1", "1.13",
                   "power of the mean in-plane stretch with which the field grows", .min = -10,
                   .max = 10, .absent_text = "unknown"),
    DEA_NUMBER_ROW(
        "thickness_exponent", BREAKDOWN(thickness_exponent), "1", "-0.25",
        "power of the film's thickness as it is (stretched) with which the field changes",
        .min = -2, .max = 2, .absent_text = "unknown"),
    DEA_NUMBER_ROW("reference_thickness", BREAKDOWN(thickness_m), "m", "100 um",
                   "thickness that at_rest belongs to; with thickness_exponent", .above_min = true,
                   .max = 1, .absent_text = "not given"),
    DEA_NUMBER_ROW("weibull_shape", BREAKDOWN(weibull_shape), "1", "12",
                   "shape of Weibull's distribution of the field; gives probability and area law",
                   .above_min = true, .max = 1e3, .absent_text = "unknown"),
    DEA_NUMBER_ROW("reference_area", BREAKDOWN(area_m2), "m^2", "1 cm^2",
                   "unstretched area under electrodes that at_rest belongs to; with weibull_shape",
                   .above_min = true, .max = 100, .absent_text = "not given"),
    DEA_NUMBER_ROW("electrode_factor", BREAKDOWN(electrode_factor), "1", "0.8",
                   "field with the electrodes that are meant over the field that at_rest is",
                   .above_min = true, .max = 10, .default_text = "1"),
    STRETCH_RANGE_FIELD,
    SET_NOTE_FIELDS,
};

static const struct dea_field density_fields[] = {
    DEA_NUMBER_ROW("value", DATA(density.value_kg_per_m3), "kg/m^3", "970 kg/m^3", "mass density",
                   .above_min = true, .max = 1e5, .required = true),
    VALUE_RANGE_FIELD("value_range", struct dea_material_data, density.values, "kg/m^3"),
    NOTE_FIELDS(struct dea_material_data, density.notes),
};

static const struct dea_field resistivity_fields[] = {
    DEA_NUMBER_ROW("value", DATA(resistivity.value_ohm_m), "ohm m", "1e12 ohm m",
                   "volume resistivity", .above_min = true, .max = 1e30, .required = true),
    VALUE_RANGE_FIELD("value_range", struct dea_material_data, resistivity.values, "ohm m"),
    NOTE_FIELDS(struct dea_material_data, resistivity.notes),
};

static const struct dea_field branch_fields[] = {
    DEA_NUMBER_ROW("modulus", BRANCH(modulus_Pa), "Pa", "26.06 kPa", "shear modulus of the branch",
                   .above_min = true, .max = 1e12, .required = true, .group = 1, .option = 1),
    DEA_NUMBER_ROW("ratio", BRANCH(ratio), "1", "0.05",
                   "shear modulus of the branch over that of the law at rest", .above_min = true,
                   .max = 1e6, .group = 1, .option = 2),
    DEA_NUMBER_ROW("time", BRANCH(time_s), "s", "0.6074 s", "relaxation time of the branch",
                   .above_min = true, .max = 1e12, .required = true),
    DEA_NUMBER_ROW("modulus_uncertainty", BRANCH(modulus_std_Pa), "Pa", "0.8 kPa",
                   "standard uncertainty of the modulus", .max = 1e12, .absent_text = "not given"),
    DEA_NUMBER_ROW("time_uncertainty", BRANCH(time_std_s), "s", "0.05 s",
                   "standard uncertainty of the time", .max = 1e12, .absent_text = "not given"),
};

static const struct dea_field wlf_fields[] = {
    DEA_NUMBER_ROW("c1", VISCOSITY(wlf_c1), "1", "2.4",
                   "first constant of Williams, Landel and Ferry", .above_min = true, .max = 100,
                   .required = true),
    DEA_NUMBER_ROW("c2", VISCOSITY(wlf_c2_K), "K", "57 K", "second constant", .above_min = true,
                   .max = 1e5, .required = true),
    DEA_NUMBER_ROW("c1_uncertainty", VISCOSITY(wlf_c1_std), "1", "0.3",
                   "standard uncertainty of c1", .max = 100, .absent_text = "not given"),
    DEA_NUMBER_ROW("c2_uncertainty", VISCOSITY(wlf_c2_std_K), "K", "8 K",
                   "standard uncertainty of c2", .max = 1e5, .absent_text = "not given"),
};

static const struct dea_field viscosity_fields[] = {
    ID_FIELD,
    DEA_FIELD_ROW(RECORD, "branches", VISCOSITY(branches), .record = DEA_ROWS(branch_fields),
                  .required = true,
                  .doc = "Maxwell branches beside the law, which is the slow limit",
                  .example = "[{ratio: 0.05, time: 1 s}]",
                  DEA_LIST(1, DEA_BRANCHES_MAX, struct dea_branch_data, VISCOSITY(branch_count))),
    DEA_CHOICE_ROW("assumed", VISCOSITY(assumed), dea_no_yes, "yes",
                   "whether the numbers are plausible rather than measured; runs then say so",
                   .default_text = "no"),
    DEA_FIELD_ROW(RECORD, "wlf", 0, .record = DEA_ROWS(wlf_fields),
                  .present_offset = VISCOSITY(has_wlf), .absent_text = "none",
                  .doc = "factor a of all times at the temperature T; holds in temperature_range",
                  .example = "{c1: 2.4, c2: 57 K}"),
    SET_NOTE_FIELDS,
};

static const struct dea_field elastic_fields[] = {
    DEA_NUMBER_ROW("young_modulus", DATA(elastic.young_modulus_Pa), "Pa", "2950 MPa",
                   "Young's modulus", .above_min = true, .max = 1e13, .required = true),
    VALUE_RANGE_FIELD("young_modulus_range", struct dea_material_data, elastic.values, "Pa"),
    DEA_NUMBER_ROW("poisson_ratio", DATA(elastic.poisson_ratio), "1", "0.38", "Poisson's ratio",
                   .min = -1, .above_min = true, .max = 0.5, .required = true),
    NOTE_FIELDS(struct dea_material_data, elastic.notes),
};

static const char *const kinds[] = {"elastomer", "plastic", "electrode", NULL};

#define SET_LIST_FIELD(name, member, counter, rows, none, text)                                    \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_RECORD, .offset = DATA(member), .record = DEA_ROWS(rows),       \
    .list_min = 1, .list_max = DEA_MATERIAL_SETS_MAX,                                              \
    .element_size = sizeof((struct dea_material_data *)0)->member[0],                              \
    .count_offset = DATA(counter), .absent_text = none, .doc = text                                \
  }

static const struct dea_field material_fields[] = {
    DEA_INTEGER_ROW("dea_material", DATA(version), "1", "version of the format",
                    .min = DEA_MATERIAL_VERSION, .max = DEA_MATERIAL_VERSION, .required = true),
    DEA_LABEL_ROW("name", DATA(name), "elastosil-2030",
                  "name by which a design chooses the material", .required = true),
    DEA_LABEL_ROW("title", DATA(title), "ELASTOSIL Film 2030 (Wacker)", "what the material is",
                  .absent_text = "none"),
    DEA_CHOICE_ROW("kind", DATA(kind), kinds, "elastomer", "kind of material", .required = true),
    DEA_FIELD_ROW(RECORD, "density", 0, .record = DEA_ROWS(density_fields),
                  .present_offset = DATA(has_density), .absent_text = "unknown",
                  .doc = "mass density"),
    SET_LIST_FIELD("laws", laws, law_count, law_fields, "none",
                   "sets of parameters of hyperelastic laws; the first is the default"),
    DEA_FIELD_ROW(RECORD, "elastic", 0, .record = DEA_ROWS(elastic_fields),
                  .present_offset = DATA(has_elastic), .absent_text = "none",
                  .doc = "linear elastic constants"),
    SET_LIST_FIELD("permittivity", permittivity, permittivity_count, permittivity_fields, "unknown",
                   "relative permittivity; the first is the default"),
    SET_LIST_FIELD("breakdown", breakdown, breakdown_count, breakdown_fields, "unknown",
                   "breakdown field; the first is the default; left out when unknown"),
    SET_LIST_FIELD("viscosity", viscosity, viscosity_count, viscosity_fields, "none",
                   "viscosity; the first is the default; left out when unknown"),
    DEA_FIELD_ROW(RECORD, "resistivity", 0, .record = DEA_ROWS(resistivity_fields),
                  .present_offset = DATA(has_resistivity), .absent_text = "unknown",
                  .doc = "electrical resistivity, for leakage"),
};

const struct dea_record dea_material_file_record = {"material file", "data file of a material",
                                                    material_fields, DEA_COUNT(material_fields)};
const struct dea_record dea_material_inline_record = {
    "material", "a material of this design", material_fields + 1, DEA_COUNT(material_fields) - 1};

/* Finds the law of a set; an unknown one is a finding with the nearest name and all names. */
static dea_status find_law(const struct dea_reader *reader, struct dea_law_set *set)
{
  if (set->law_name.text[0] == '\0') {
    return DEA_OK; // already an error
  }
  set->law = dea_law_find(set->law_name.text);
  if (set->law != NULL && set->law->compressible != NULL) {
    set->law = NULL;
    return dea_schema_error(reader, set->law_name.location,
                            "'%s' is the law of parts that have young_modulus and poisson_ratio: "
                            "give those in place of a law",
                            set->law_name.text);
  }
  if (set->law != NULL) {
    return DEA_OK;
  }
  size_t count;
  const struct dea_law *const *laws = dea_law_all(&count);
  const char *names[32];
  size_t named = 0;
  char hint[DEA_HINT_SIZE];
  for (size_t i = 0; i < count && named < DEA_COUNT(names); i++) {
    if (laws[i]->compressible == NULL) {
      names[named++] = laws[i]->name;
    }
  }
  dea_name_hint_list(set->law_name.text, names, named, " All laws: ", "; there are: ", hint);
  return dea_schema_error(reader, set->law_name.location, "'%.60s' is not a law%s",
                          set->law_name.text, hint);
}

static const char *example_of(const char *unit)
{
  return strcmp(unit, "Pa") == 0 ? "100 kPa" : strcmp(unit, "radian") == 0 ? "30 degree" : "1.5";
}

/* Reads the parameters with a table made from those of the law, or their standard uncertainties. */
static dea_status read_parameters(const struct dea_reader *reader, const char *path,
                                  const struct dea_law_set *set, const struct dea_node *node,
                                  bool uncertainties, struct dea_quantity *out)
{
  struct dea_field fields[DEA_LAW_PARAM_MAX];
  memset(fields, 0, sizeof fields);
  for (size_t i = 0; i < set->law->param_count; i++) {
    const struct dea_law_param *param = &set->law->params[i];
    fields[i].key = param->key;
    fields[i].kind = DEA_FIELD_NUMBER;
    fields[i].offset = i * sizeof set->param[0];
    fields[i].unit = param->unit;
    fields[i].min = uncertainties ? 0 : param->min;
    fields[i].max = uncertainties ? 1e12 : param->max;
    fields[i].required = param->required && !uncertainties;
    fields[i].absent_text = uncertainties ? "not given" : "0";
    fields[i].doc = param->meaning;
    fields[i].example = example_of(param->unit);
  }
  struct dea_record record = {set->law->name, set->law->long_name, fields, set->law->param_count};
  return dea_schema_read(reader, &record, node, path, out);
}

/* Correlations belong to all pairs of the parameters with an uncertainty. */
static dea_status check_correlations(const struct dea_reader *reader, const struct dea_law_set *set)
{
  size_t known = 0;
  for (size_t i = 0; set->law != NULL && i < set->law->param_count; i++) {
    known += set->uncertainties != NULL && !isnan(set->param_std[i].si) ? 1U : 0U;
  }
  const size_t wanted = known > 0 ? known * (known - 1) / 2 : 0;
  if (set->correlation_count != 0 && set->correlation_count != wanted) {
    return dea_schema_error(reader, set->correlations[0].location,
                            "%zu correlations; the %zu parameters with an uncertainty have %zu",
                            set->correlation_count, known, wanted);
  }
  return dea_correlations_check(reader->ctx, set->correlations, set->correlation_count, known,
                                "parameter");
}

/* Below 0 the unstretched film is unstable: any small shear lowers its energy. */
static dea_status check_rest(const struct dea_reader *reader, const struct dea_law_set *set)
{
  double param[DEA_LAW_PARAM_MAX];
  bool complete = set->law != NULL && set->parameters != NULL;
  for (size_t i = 0; complete && i < set->law->param_count; i++) {
    complete = !isnan(set->param[i].si) || !set->law->params[i].required;
    param[i] = isnan(set->param[i].si) ? 0 : set->param[i].si;
  }
  const double modulus_Pa = complete ? set->law->shear_modulus(param) : 1;
  return modulus_Pa > 0 ? DEA_OK
                        : dea_schema_error(reader, set->parameters->location,
                                           "the shear modulus at rest is %.4g kPa with these "
                                           "parameters; it has to be above 0, else the film has "
                                           "no equilibrium",
                                           1e-3 * modulus_Pa);
}

static dea_status check_length(const struct dea_reader *reader, const struct dea_label *label)
{
  if (strlen(label->text) < DEA_NAME_SIZE) {
    return DEA_OK;
  }
  return dea_schema_error(reader, label->location, "'%.60s...' is longer than %d bytes",
                          label->text, DEA_NAME_SIZE - 1);
}

static dea_status check_range(const struct dea_reader *reader, const struct dea_data_range *range,
                              const char *key)
{
  if (range->count != 2 || !(range->limits[0].si >= range->limits[1].si)) {
    return DEA_OK;
  }
  return dea_schema_error(reader, range->limits[1].location, "%s must rise; %g is not above %g",
                          key, range->limits[1].si, range->limits[0].si);
}

/* The range of what sources give holds what was taken. */
static dea_status check_values(const struct dea_reader *reader, const struct dea_quantity *value,
                               const struct dea_data_range *values)
{
  if (values->count != 2 || isnan(value->si) ||
      (values->limits[0].si <= value->si && value->si <= values->limits[1].si)) {
    return DEA_OK;
  }
  return dea_schema_error(reader, values->limits[0].location,
                          "the range %g to %g does not hold the value %g", values->limits[0].si,
                          values->limits[1].si, value->si);
}

/* Two numbers of which neither says anything alone. */
static dea_status check_pair(const struct dea_reader *reader, const struct dea_quantity *a,
                             const struct dea_quantity *b, const char *name_a, const char *name_b)
{
  bool has_a = a->origin != DEA_ABSENT, has_b = b->origin != DEA_ABSENT;
  if (has_a == has_b) {
    return DEA_OK;
  }
  return dea_schema_error(reader, has_a ? a->location : b->location,
                          "%s belongs to %s, which lacks", has_a ? name_a : name_b,
                          has_a ? name_b : name_a);
}

/* A shift is of a temperature, in a range that its formula has. */
static dea_status check_shift(const struct dea_reader *reader, const struct dea_viscosity_set *set)
{
  const struct dea_data_notes *notes = &set->head.notes;
  DEA_TRY(reader->ctx, check_range(reader, &notes->temperatures, "temperature_range"));
  if (!set->has_wlf || isnan(set->wlf_c2_K.si) ||
      (!isnan(notes->temperature_K.si) && notes->temperatures.count == 2 &&
       set->wlf_c2_K.si > notes->temperature_K.si - notes->temperatures.limits[0].si)) {
    return DEA_OK;
  }
  return dea_schema_error(reader, set->wlf_c1.location,
                          "wlf needs a temperature, its reference, and a temperature_range that "
                          "ends less than c2 below it");
}

const struct dea_set_head *dea_set_head_at(const void *sets, size_t size, size_t i)
{
  return (const void *)((const char *)sets + i * size);
}

/* What holds for sets of all kinds: of two with one name a design could never choose the second.
 * sets: [i + 1] of `size` bytes, which begin with their heads. */
static dea_status check_set(const struct dea_reader *reader, const void *sets, size_t size,
                            size_t i)
{
  const struct dea_set_head *set = dea_set_head_at(sets, size, i);
  DEA_TRY(reader->ctx, check_range(reader, &set->range, "stretch_range"));
  for (size_t j = 0; j < i && set->id.text[0] != '\0'; j++) {
    const struct dea_label *other = &dea_set_head_at(sets, size, j)->id;
    if (strcmp(set->id.text, other->text) == 0) {
      DEA_TRY(reader->ctx, dea_schema_error(reader, set->id.location,
                                            "the id '%.60s' is taken by the set in line %zu",
                                            other->text, other->location.line));
    }
  }
  return DEA_OK;
}

static dea_status check_sets(const struct dea_reader *reader, const struct dea_material_data *data)
{
  struct dea_context *ctx = reader->ctx;
  DEA_TRY(ctx, check_values(reader, &data->density.value_kg_per_m3, &data->density.values));
  DEA_TRY(ctx, check_values(reader, &data->elastic.young_modulus_Pa, &data->elastic.values));
  DEA_TRY(ctx, check_values(reader, &data->resistivity.value_ohm_m, &data->resistivity.values));
  DEA_TRY(ctx, check_length(reader, &data->name));
  for (size_t i = 0; i < data->law_count; i++) {
    DEA_TRY(ctx, check_length(reader, &data->laws[i].head.id));
    DEA_TRY(ctx, check_set(reader, data->laws, sizeof data->laws[0], i));
  }
  for (size_t i = 0; i < data->permittivity_count; i++) {
    const struct dea_permittivity_set *set = &data->permittivity[i];
    DEA_TRY(ctx, check_set(reader, data->permittivity, sizeof *set, i));
    DEA_TRY(ctx, check_values(reader, &set->at_rest, &set->values));
  }
  for (size_t i = 0; i < data->viscosity_count; i++) {
    DEA_TRY(ctx, check_shift(reader, &data->viscosity[i]));
    DEA_TRY(ctx, check_set(reader, data->viscosity, sizeof data->viscosity[0], i));
  }
  for (size_t i = 0; i < data->breakdown_count; i++) {
    const struct dea_breakdown_set *set = &data->breakdown[i];
    DEA_TRY(ctx, check_set(reader, data->breakdown, sizeof *set, i));
    DEA_TRY(ctx, check_values(reader, &set->at_rest_V_per_m, &set->values));
    DEA_TRY(ctx, check_pair(reader, &set->thickness_exponent, &set->thickness_m,
                            "thickness_exponent", "reference_thickness"));
    DEA_TRY(ctx, check_pair(reader, &set->weibull_shape, &set->area_m2, "weibull_shape",
                            "reference_area"));
  }
  return DEA_OK;
}

dea_status dea_material_data_finish(const struct dea_reader *reader, const char *path,
                                    struct dea_material_data *data)
{
  for (size_t i = 0; i < data->law_count; i++) {
    struct dea_law_set *set = &data->laws[i];
    DEA_TRY(reader->ctx, find_law(reader, set));
    char inner[DEA_KEY_PATH_SIZE];
    const char *dot = path[0] != '\0' ? "." : "";
    if (set->law != NULL && set->parameters != NULL) {
      snprintf(inner, sizeof inner, "%s%slaws[%zu].parameters", path, dot, i);
      DEA_TRY(reader->ctx, read_parameters(reader, inner, set, set->parameters, false, set->param));
    }
    if (set->law != NULL && set->uncertainties != NULL) {
      snprintf(inner, sizeof inner, "%s%slaws[%zu].standard_uncertainties", path, dot, i);
      DEA_TRY(reader->ctx,
              read_parameters(reader, inner, set, set->uncertainties, true, set->param_std));
    }
    DEA_TRY(reader->ctx, check_correlations(reader, set));
    DEA_TRY(reader->ctx, check_rest(reader, set));
  }
  return check_sets(reader, data);
}
