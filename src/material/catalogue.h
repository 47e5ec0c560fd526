/* The catalogue: data files of materials, and the same data inline in a design.
 *
 * A material has one or more parameter sets for its law, its permittivity and its breakdown field;
 * the first of each is the default. Numbers are SI and keep their place; texts are lent by the
 * document that they were read from. */
#pragma once

#include "base/schema.h"
#include "material/material.h"

enum { DEA_MATERIAL_VERSION = 1, DEA_MATERIAL_SETS_MAX = 8 };

/* Range of stretch or temperature that the data cover, or of values that the sources give. count is
 * 0 when it is not known, else 2. */
struct dea_data_range {
  struct dea_quantity limits[2];
  size_t count;
};

/* What every set of numbers says about itself; NULL where nothing is said. */
struct dea_data_notes {
  const char *uncertainty, *range, *source, *note;
  struct dea_quantity temperature_K;  // that it was measured at; NAN: unknown
  struct dea_data_range temperatures; // at which it holds too
};

/* What sets of all kinds begin with. */
struct dea_set_head {
  struct dea_label id;
  struct dea_data_range range; // of stretch; not of a viscosity
  struct dea_data_notes notes;
};

/* Parameters of one law. */
struct dea_law_set {
  struct dea_set_head head;
  struct dea_label law_name;
  const struct dea_law *law;         // NULL after an error in law_name
  const struct dea_node *parameters; // section as written; lent
  struct dea_quantity param[DEA_LAW_PARAM_MAX];
  const struct dea_node *uncertainties;             // section as written, NULL: none; lent
  struct dea_quantity param_std[DEA_LAW_PARAM_MAX]; // standard uncertainties, NAN: not given
  /* Of the parameters with an uncertainty, in the law's order: (2,1), (3,1), (3,2), (4,1), ... */
  struct dea_quantity correlations[DEA_LAW_PARAM_MAX * (DEA_LAW_PARAM_MAX - 1) / 2];
  size_t correlation_count; // 0: not given
  struct dea_quantity fibre_angle_rad;
};

struct dea_permittivity_set {
  struct dea_set_head head;
  struct dea_quantity at_rest, slope;
  struct dea_data_range values; // of at_rest
};

struct dea_breakdown_set {
  struct dea_set_head head;
  struct dea_quantity at_rest_V_per_m;
  struct dea_data_range values;                        // of at_rest
  struct dea_quantity exponent;                        // NAN when unknown; so the next two pairs
  struct dea_quantity thickness_exponent, thickness_m; // thickness that at_rest belongs to
  struct dea_quantity weibull_shape, area_m2;          // area that at_rest belongs to
  struct dea_quantity electrode_factor;                // 1 when not given
};

/* One branch of a viscosity: shear modulus as such or as a share of the law's at rest. */
struct dea_branch_data {
  struct dea_quantity modulus_Pa, ratio, time_s;
  struct dea_quantity modulus_std_Pa, time_std_s; // standard uncertainties, NAN: not given
};

struct dea_viscosity_set {
  struct dea_set_head head;
  struct dea_choice assumed; // 1: plausible numbers, not measured ones
  struct dea_branch_data branches[DEA_BRANCHES_MAX];
  size_t branch_count;
  /* Constants of Williams, Landel and Ferry with the notes' temperature as reference, with standard
   * uncertainties; NAN: not given. */
  bool has_wlf;
  struct dea_quantity wlf_c1, wlf_c2_K, wlf_c1_std, wlf_c2_std_K;
};

enum dea_material_kind { DEA_ELASTOMER, DEA_PLASTIC, DEA_ELECTRODE_MATERIAL };

struct dea_material_data {
  struct dea_quantity version;
  struct dea_label name, title;
  struct dea_choice kind; // enum dea_material_kind
  bool has_density;
  struct {
    struct dea_quantity value_kg_per_m3;
    struct dea_data_range values;
    struct dea_data_notes notes;
  } density;
  bool has_elastic;
  struct {
    struct dea_quantity young_modulus_Pa, poisson_ratio;
    struct dea_data_range values; // of young_modulus
    struct dea_data_notes notes;
  } elastic;
  bool has_resistivity;
  struct {
    struct dea_quantity value_ohm_m;
    struct dea_data_range values;
    struct dea_data_notes notes;
  } resistivity;
  struct dea_viscosity_set viscosity[DEA_MATERIAL_SETS_MAX];
  size_t viscosity_count;
  struct dea_law_set laws[DEA_MATERIAL_SETS_MAX];
  struct dea_permittivity_set permittivity[DEA_MATERIAL_SETS_MAX];
  struct dea_breakdown_set breakdown[DEA_MATERIAL_SETS_MAX];
  size_t law_count, permittivity_count, breakdown_count;
};

/* Head i of sets of one kind, each of `size` bytes. */
const struct dea_set_head *dea_set_head_at(const void *sets, size_t size, size_t i);

/* Schema of a data file, and of a material in a design (the same without the version). */
extern const struct dea_record dea_material_file_record, dea_material_inline_record;

/* Second half of reading: finds the laws, reads their parameters and checks what no table can. data
 * was read with one of the two records; path as for dea_schema_read. */
dea_status dea_material_data_finish(const struct dea_reader *reader, const char *path,
                                    struct dea_material_data *data);

/* One material of the catalogue with the document that its texts live in. */
struct dea_catalogue_entry {
  const char *file; // where it was found; interned
  struct dea_material_data data;
  struct dea_listing listing; // every value as written
  struct dea_yaml *yaml;
};

/* Names of all materials, sorted, each once: those of the directories of the environment variable
 * DEA_MATERIALS (separated by colons), of the installed data and of the source tree. names: owned
 * by the caller (dea_free), the texts are interned. */
dea_status dea_catalogue_names(struct dea_context *ctx, const char ***names, size_t *count);
/* Reads one material. place: where the name stands in an input, for the finding when there is no
 * such material (DEA_E_DESIGN). out: owned by the caller, NULL on failure. */
dea_status dea_catalogue_read(struct dea_context *ctx, const char *name,
                              struct dea_location location, struct dea_catalogue_entry **out);
/* NULL is fine. */
void dea_catalogue_destroy(struct dea_context *ctx, struct dea_catalogue_entry *entry);

/* Which sets of a material are wanted, lent; an empty label or NULL for the one that was measured
 * nearest to the temperature, or the first where none is known, and "none" for no viscosity. */
struct dea_material_choice {
  const struct dea_label *law, *permittivity, *breakdown, *viscosity;
  const struct dea_quantity *temperature; // of the device; NULL or absent: not given
};

/* The material as the models use it. A set that does not exist gives DEA_E_DESIGN after a finding
 * that names those that do. With a temperature, sets that were measured elsewhere are a warning,
 * and those of an unknown temperature a note. */
dea_status dea_material_select(struct dea_context *ctx, const struct dea_material_data *data,
                               const struct dea_material_choice *choice, struct dea_material *out);
