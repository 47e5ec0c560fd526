#include "material/catalogue.h"

#include "base/file.h"
#include "base/file_kind.h"
#include "base/write_file.h"
#include "material/branch.h"
#include "material/plane.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DIRECTORIES_MAX = 16, DIRECTORY_SIZE = 1024, NAMES_MAX = 4096 };

/* Directories that are searched, in this order. */
struct directories {
  char path[DIRECTORIES_MAX][DIRECTORY_SIZE];
  size_t count;
};

static void add_directory(struct directories *list, const char *path, size_t length,
                          const char *below)
{
  if (length > 0 && length + strlen(below) < DIRECTORY_SIZE && list->count < DIRECTORIES_MAX) {
    snprintf(list->path[list->count++], DIRECTORY_SIZE, "%.*s%s", (int)length, path, below);
  }
}

static void find_directories(struct directories *list)
{
  list->count = 0;
  const char *own = getenv("DEA_MATERIALS");
  while (own != NULL && *own != '\0') {
    size_t length = strcspn(own, ":");
    add_directory(list, own, length, "");
    own += length + (own[length] == ':');
  }
  add_directory(list, DEA_INSTALL_DATA_DIR, strlen(DEA_INSTALL_DATA_DIR), "/materials");
  add_directory(list, DEA_SOURCE_DATA_DIR, strlen(DEA_SOURCE_DATA_DIR), "/materials");
}

/* Length of the name in "NAME.yaml", or 0. */
static size_t stem_length(const char *file)
{
  const char *dot = strrchr(file, '.');
  return dot != NULL && dot != file && file[0] != '.' && strcmp(dot, ".yaml") == 0
             ? (size_t)(dot - file)
             : 0;
}

static int compare_names(const void *a, const void *b)
{
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

struct names {
  const char **at;
  size_t count;
};

static dea_status add_name(struct dea_context *ctx, void *user, const char *file, const char *path)
{
  struct names *names = user;
  size_t length = stem_length(file);
  (void)path;
  if (length == 0 || length >= DEA_NAME_SIZE || names->count == NAMES_MAX) {
    return DEA_OK;
  }
  char name[DEA_NAME_SIZE];
  snprintf(name, sizeof name, "%.*s", (int)length, file);
  const char *kept = dea_intern(ctx, name);
  DEA_TRY_MEMORY(kept != NULL);
  for (size_t i = 0; i < names->count; i++) {
    if (names->at[i] == kept) {
      return DEA_OK;
    }
  }
  names->at[names->count++] = kept;
  return DEA_OK;
}

dea_status dea_catalogue_names(struct dea_context *ctx, const char ***names, size_t *count)
{
  struct directories list;
  struct names all = {dea_alloc(ctx, NAMES_MAX, sizeof *all.at), 0};
  find_directories(&list);
  *names = NULL;
  DEA_TRY_MEMORY(all.at != NULL);
  for (size_t i = 0; i < list.count; i++) { // one that does not exist holds no materials
    DEA_TRY_ELSE(ctx, dea_folder_visit(ctx, list.path[i], add_name, &all), dea_free(ctx, all.at));
  }
  qsort(all.at, all.count, sizeof *all.at, compare_names);
  *names = all.at;
  *count = all.count;
  return DEA_OK;
}

/* Adds the finding that there is no such material, with the nearest name and all names. */
static dea_status unknown_material(struct dea_context *ctx, const char *name,
                                   struct dea_location location)
{
  const char **names;
  size_t count;
  DEA_TRY(ctx, dea_catalogue_names(ctx, &names, &count));
  char hint[DEA_HINT_SIZE];
  dea_name_hint_list(name, names, count, " All materials: ", "; there are: ", hint);
  dea_status status =
      dea_finding_add(ctx, DEA_ERROR, location, "there is no material '%.60s'%s", name, hint);
  dea_free(ctx, names);
  DEA_TRY(ctx, status);
  return dea_fail(ctx, DEA_E_DESIGN, "there is no material '%.60s'", name);
}

/* Text of NAME.yaml from the first directory that has it; *file is interned. */
static dea_status load(struct dea_context *ctx, const char *name, struct dea_location location,
                       const char **file, char **bytes, size_t *length)
{
  struct directories list;
  find_directories(&list);
  bool plain = name[0] != '\0' && name[0] != '.' && strchr(name, '/') == NULL &&
               strlen(name) < DEA_NAME_SIZE;
  for (size_t i = 0; plain && i < list.count; i++) {
    char path[DIRECTORY_SIZE + DEA_NAME_SIZE + 8];
    snprintf(path, sizeof path, "%s/%s.yaml", list.path[i], name);
    FILE *probe = fopen(path, "r");
    if (probe == NULL && errno == ENOENT) {
      continue;
    }
    if (probe != NULL) {
      fclose(probe);
    }
    *file = dea_intern(ctx, path);
    DEA_TRY_MEMORY(*file != NULL);
    return dea_file_read(ctx, path, DEA_YAML_SIZE_MAX, bytes, length);
  }
  return unknown_material(ctx, name, location);
}

static dea_status read_entry(struct dea_context *ctx, const char *name, const char *bytes,
                             size_t length, struct dea_catalogue_entry *entry)
{
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  DEA_TRY(ctx, dea_yaml_parse(ctx, entry->file, bytes, length, &entry->yaml));
  struct dea_reader reader = {ctx, entry->yaml, &entry->listing};
  DEA_TRY(ctx, dea_file_kind_check(ctx, entry->yaml, "dea_material"));
  DEA_TRY(ctx, dea_schema_read(&reader, &dea_material_file_record, dea_yaml_root(entry->yaml), "",
                               &entry->data));
  DEA_TRY(ctx, dea_material_data_finish(&reader, "", &entry->data));
  if (entry->data.name.text[0] != '\0' && strcmp(entry->data.name.text, name) != 0) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, entry->data.name.location,
                                 "the material '%.60s' must stand in a file '%.60s.yaml'",
                                 entry->data.name.text, entry->data.name.text));
  }
  if (dea_finding_count(ctx, DEA_ERROR) > errors) {
    return dea_fail(ctx, DEA_E_DESIGN, "the material file '%s' has errors", entry->file);
  }
  return DEA_OK;
}

dea_status dea_catalogue_read(struct dea_context *ctx, const char *name,
                              struct dea_location location, struct dea_catalogue_entry **out)
{
  char *bytes = NULL;
  size_t length = 0;
  *out = NULL;
  struct dea_catalogue_entry *entry = dea_alloc(ctx, 1, sizeof *entry);
  DEA_TRY_MEMORY(entry != NULL);
  dea_status status = load(ctx, name, location, &entry->file, &bytes, &length);
  status = status == DEA_OK ? read_entry(ctx, name, bytes, length, entry) : status;
  dea_free(ctx, bytes);
  DEA_TRY_ELSE(ctx, status, dea_catalogue_destroy(ctx, entry));
  *out = entry;
  return DEA_OK;
}

void dea_catalogue_destroy(struct dea_context *ctx, struct dea_catalogue_entry *entry)
{
  if (entry == NULL) {
    return;
  }
  dea_listing_free(ctx, &entry->listing);
  dea_yaml_destroy(ctx, entry->yaml);
  dea_free(ctx, entry);
}

/* Sets of one kind, and which of them is wanted. */
struct sets {
  const char *what; // "law set"
  const void *first;
  size_t count, size;
  const struct dea_label *wanted; // as of dea_material_choice
};

static const struct dea_set_head *head_at(const struct sets *sets, size_t i)
{
  return dea_set_head_at(sets->first, sets->size, i);
}

static const double near_K = 5; // so far the numbers of one temperature are taken for another's

/* How far a temperature is from those of a set, in whose range it counts as just near: one that was
 * measured closer goes first. NAN: not known. */
static double find_distance(const struct dea_data_notes *notes, double at_K)
{
  const struct dea_quantity *limits = notes->temperatures.limits;
  return notes->temperatures.count == 2
             ? fmax(near_K, fmax(limits[0].si - at_K, at_K - limits[1].si))
             : fabs(at_K - notes->temperature_K.si);
}

static bool is_given(const struct dea_quantity *temperature)
{
  return temperature != NULL && temperature->origin != DEA_ABSENT;
}

/* The set measured nearest to a temperature; the first where none is known or asked for. */
static int find_nearest(const struct sets *sets, const struct dea_quantity *temperature)
{
  int nearest = 0;
  double least_K = INFINITY;
  for (size_t i = 0; i < sets->count && is_given(temperature); i++) {
    const double off_K = find_distance(&head_at(sets, i)->notes, temperature->si);
    if (off_K < least_K) {
      nearest = (int)i;
      least_K = off_K;
    }
  }
  return nearest;
}

/* What a set says of the temperature of the device; unknown gets the kinds that say nothing. */
static dea_status check_temperature(struct dea_context *ctx, const char *material,
                                    const struct sets *sets, int set,
                                    const struct dea_quantity *temperature,
                                    struct dea_text *unknown)
{
  static const double freezing_K = 273.15;
  if (!is_given(temperature) || sets->count == 0) {
    return DEA_OK;
  }
  const struct dea_set_head *head = head_at(sets, (size_t)set);
  const struct dea_data_notes *notes = &head->notes;
  const double off_K = find_distance(notes, temperature->si);
  if (isnan(off_K)) {
    dea_text_add(unknown, "%s%s", dea_text_get(unknown)[0] != '\0' ? ", " : "", sets->what);
    return DEA_OK;
  }
  if (off_K <= near_K) {
    return DEA_OK;
  }
  const bool is_range = notes->temperatures.count == 2;
  char at[64];
  snprintf(at, sizeof at, is_range ? "holds from %.4g to %.4g degC" : "was measured at %.4g degC",
           (is_range ? notes->temperatures.limits[0] : notes->temperature_K).si - freezing_K,
           notes->temperatures.limits[1].si - freezing_K);
  return dea_finding_add(ctx, DEA_WARNING, temperature->location,
                         "the %s '%s' of '%s' %s, not at %.4g degC", sets->what, head->id.text,
                         material, at, temperature->si - freezing_K);
}

/* Index of the set that is wanted; -1 after adding a finding. */
static int find_set(struct dea_context *ctx, const struct dea_material_data *data,
                    const struct sets *sets, const struct dea_quantity *temperature)
{
  const char *names[DEA_MATERIAL_SETS_MAX] = {NULL}, *what = sets->what;
  char hint[DEA_HINT_SIZE];
  const char *wanted = sets->wanted != NULL ? sets->wanted->text : "";
  if (wanted[0] == '\0') {
    return find_nearest(sets, temperature);
  }
  for (size_t i = 0; i < sets->count; i++) {
    names[i] = head_at(sets, i)->id.text;
    if (strcmp(names[i], wanted) == 0) {
      return (int)i;
    }
  }
  dea_name_hint_list(wanted, names, sets->count, " All: ", "; there are: ", hint);
  dea_status status =
      dea_finding_add(ctx, DEA_ERROR, sets->wanted->location, "material '%s' has no %s '%.60s'%s",
                      data->name.text, what, wanted, hint);
  if (status == DEA_OK) {
    dea_fail(ctx, DEA_E_DESIGN, "material '%s' has no %s '%.60s'", data->name.text, what, wanted);
  }
  return -1;
}

/* Standard uncertainties, and correlations of those that have one, in the order of the file. */
static void read_uncertainties(const struct dea_law_set *set, struct dea_material *out)
{
  size_t next = 0;
  for (size_t i = 0; i < set->law->param_count; i++) {
    out->param_std[i] = isnan(set->param_std[i].si) ? 0 : set->param_std[i].si;
    out->correlation[i][i] = 1;
    for (size_t k = 0; k < i; k++) {
      if (out->param_std[i] > 0 && out->param_std[k] > 0 && next < set->correlation_count) {
        out->correlation[i][k] = out->correlation[k][i] = set->correlations[next++].si;
      }
    }
  }
}

static void read_law(const struct dea_law_set *set, struct dea_material *out)
{
  snprintf(out->law_id, sizeof out->law_id, "%.63s", set->head.id.text);
  out->law = set->law;
  for (size_t i = 0; i < set->law->param_count; i++) {
    out->param[i] = isnan(set->param[i].si) ? 0 : set->param[i].si; // optional, not given
  }
  read_uncertainties(set, out);
  out->fibre_angle_rad = set->fibre_angle_rad.si;
  if (set->head.range.count == 2) {
    out->stretch_min = set->head.range.limits[0].si;
    out->stretch_max = set->head.range.limits[1].si;
  }
}

static double given_or(const struct dea_quantity *value, double otherwise)
{
  return isnan(value->si) ? otherwise : value->si;
}

static void read_breakdown(const struct dea_breakdown_set *set, struct dea_breakdown *out)
{
  double at_rest = set->at_rest_V_per_m.si;
  bool band = set->values.count == 2;
  *out = (struct dea_breakdown){
      .known = true,
      .exponent_known = !isnan(set->exponent.si),
      .law = {.at_rest_V_per_m = at_rest,
              .exponent = given_or(&set->exponent, 0),
              .thickness_exponent = given_or(&set->thickness_exponent, 0),
              .thickness_m = given_or(&set->thickness_m, 0),
              .shape = given_or(&set->weibull_shape, 0),
              .area_m2 = given_or(&set->area_m2, 0),
              .electrode_factor = set->electrode_factor.si,
              .low = band ? set->values.limits[0].si / at_rest : 1,
              .high = band ? set->values.limits[1].si / at_rest : 1},
  };
  dea_breakdown_specialise(0, 0, out);
}

/* Branches as moduli, a ratio being of the law's shear modulus at rest, with their times at the
 * temperature of the device. */
static dea_status read_viscosity(struct dea_context *ctx, const struct dea_viscosity_set *set,
                                 const struct dea_quantity *temperature, struct dea_material *out)
{
  double shift = 1;
  if (is_given(temperature) && set->has_wlf) { // a temperature out of range: its end
    const struct dea_data_notes *notes = &set->head.notes;
    const struct dea_quantity *limits = notes->temperatures.limits;
    const double at_K = fmin(fmax(temperature->si, limits[0].si), limits[1].si);
    shift = dea_branch_shift(set->wlf_c1.si, set->wlf_c2_K.si, at_K - notes->temperature_K.si);
  }
  snprintf(out->viscosity_id, sizeof out->viscosity_id, "%.63s", set->head.id.text);
  out->viscosity_assumed = set->assumed.value == 1;
  out->branch_count = set->branch_count;
  for (size_t i = 0; i < set->branch_count; i++) {
    const struct dea_branch_data *branch = &set->branches[i];
    bool relative = branch->ratio.origin != DEA_ABSENT;
    if (relative && out->law == NULL) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, branch->ratio.location,
                                   "ratio: '%s' has no law whose modulus it could be a share of",
                                   out->name));
      return dea_fail(ctx, DEA_E_DESIGN, "a branch of '%s' has no modulus", out->name);
    }
    out->branches[i].time_s = shift * branch->time_s.si;
    out->branches[i].modulus_Pa =
        relative ? branch->ratio.si * out->law->shear_modulus(out->param) : branch->modulus_Pa.si;
  }
  return DEA_OK;
}

dea_status dea_material_select(struct dea_context *ctx, const struct dea_material_data *data,
                               const struct dea_material_choice *choice, struct dea_material *out)
{
  const bool viscous = choice->viscosity == NULL || strcmp(choice->viscosity->text, "none") != 0;
#define SETS(what, member, counter, wanted)                                                        \
  {                                                                                                \
    what, data->member, data->counter, sizeof data->member[0], wanted                              \
  }
  const struct sets all[] = {
      SETS("law set", laws, law_count, choice->law),
      SETS("permittivity", permittivity, permittivity_count, choice->permittivity),
      SETS("breakdown field", breakdown, breakdown_count, choice->breakdown),
      SETS("viscosity", viscosity, viscosity_count, viscous ? choice->viscosity : NULL),
  };
#undef SETS
  enum { LAW, PERMITTIVITY, BREAKDOWN, VISCOSITY, KINDS };
  const struct dea_quantity *temperature = choice->temperature;
  int chosen[KINDS];
  bool found = true;
  *out = (struct dea_material){0};
  snprintf(out->name, sizeof out->name, "%.63s", data->name.text);
  for (int k = 0; k < KINDS; k++) {
    chosen[k] = find_set(ctx, data, &all[k], temperature);
    found = found && chosen[k] >= 0;
  }
  if (!found) {
    return dea_context_status(ctx);
  }
  struct dea_text unknown = {.ctx = ctx};
  dea_status status = DEA_OK;
  for (int k = 0; k < KINDS - !viscous && status == DEA_OK; k++) {
    status = check_temperature(ctx, out->name, &all[k], chosen[k], temperature, &unknown);
  }
  if (status == DEA_OK && dea_text_get(&unknown)[0] != '\0') {
    status = dea_finding_add(ctx, DEA_NOTE, temperature->location,
                             "the temperature at which '%s' was measured is unknown: %s", out->name,
                             dea_text_get(&unknown));
  }
  dea_text_free(&unknown);
  DEA_TRY(ctx, status);
  if (data->law_count > 0) {
    read_law(&data->laws[chosen[LAW]], out);
  }
  if (data->permittivity_count > 0) {
    const struct dea_permittivity_set *set = &data->permittivity[chosen[PERMITTIVITY]];
    out->permittivity = (struct dea_permittivity){set->at_rest.si, set->slope.si};
  }
  if (data->breakdown_count > 0) {
    read_breakdown(&data->breakdown[chosen[BREAKDOWN]], &out->breakdown);
  }
  if (viscous && data->viscosity_count > 0) {
    DEA_TRY(ctx, read_viscosity(ctx, &data->viscosity[chosen[VISCOSITY]], temperature, out));
  }
  if (data->has_resistivity) {
    out->resistivity_ohm_m = data->resistivity.value_ohm_m.si;
  }
  if (data->has_density) {
    out->density_kg_per_m3 = data->density.value_kg_per_m3.si;
  }
  if (data->has_elastic) {
    out->young_modulus_Pa = data->elastic.young_modulus_Pa.si;
    out->poisson_ratio = data->elastic.poisson_ratio.si;
  }
  return DEA_OK;
}
