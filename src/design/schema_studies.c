/* Keys of studies that set several computations beside each other. */
#include "design/schema.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_design_raw, design.compute.convergence.member)

static const struct dea_field convergence_fields[] = {
    {.key = "refinement",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(refinements),
     .unit = "1",
     .min = 1,
     .max = 6,
     .default_text = "[1, 1.5, 2]",
     .list_min = 2,
     .list_max = DEA_DESIGN_MESHES_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(refinement_count),
     .doc = "meshes, as in compute.solid.refinement, rising; an order needs three",
     .example = "[1, 2, 3]"},
    {.key = "voltage",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(voltages_V),
     .unit = "V",
     .max = 1e6,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(voltage_count),
     .absent_text = "quarters of the highest",
     .doc = "voltages at which the meshes are compared, in the order to be computed",
     .example = "[2 kV, 4 kV, 6 kV]"},
    {.key = "tolerance",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(tolerance),
     .unit = "1",
     .above_min = true,
     .max = 1,
     .default_text = "0.02",
     .doc = "relative error that is small enough for a displacement",
     .example = "0.02"},
};

const struct dea_record dea_convergence_record = {
    "convergence", "study of convergence", convergence_fields,
    sizeof convergence_fields / sizeof convergence_fields[0]};

static const struct dea_field compare_fields[] = {
    {.key = "name",
     .kind = DEA_FIELD_LABEL,
     .offset = offsetof(struct dea_design_variant, name),
     .required = true,
     .doc = "name in figures and tables; an item with nothing else names the design itself",
     .example = "eight fibres"},
    {.key = "file",
     .kind = DEA_FIELD_LABEL,
     .offset = offsetof(struct dea_design_variant, file),
     .absent_text = "this file",
     .doc = "design file to be compared with; its path counts from the folder of this one",
     .example = "frdea-8.yaml"},
    {.key = "set",
     .kind = DEA_FIELD_SECTION,
     .offset = offsetof(struct dea_design_variant, set),
     .absent_text = "nothing",
     .doc = "keys of a design file with other values, as with --set; null takes a key away",
     .example = "{fibres.count: 8}"},
};

const struct dea_record dea_compare_record = {"compare", "a design that this one is compared with",
                                              compare_fields,
                                              sizeof compare_fields / sizeof compare_fields[0]};
