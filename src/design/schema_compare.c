/* Keys of `compute.compare`. */
#include "design/design_schema.h"

#include <stddef.h>

static const struct dea_field compare_fields[] = {
    DEA_LABEL_ROW("name", offsetof(struct dea_design_variant, name), "eight fibres",
                  "name in figures and tables; an item with nothing else names the design itself",
                  .required = true),
    DEA_LABEL_ROW("file", offsetof(struct dea_design_variant, file), "frdea-8.yaml",
                  "design file to be compared with; its path counts from the folder of this one",
                  .absent_text = "this file"),
    DEA_FIELD_ROW(
        SECTION, "set", offsetof(struct dea_design_variant, set), .absent_text = "nothing",
        .doc = "keys of a design file with other values, as with --set; null takes a key away",
        .example = "{fibres.count: 8}"),
};

const struct dea_record dea_compare_record = {"compare", "a design that this one is compared with",
                                              compare_fields,
                                              sizeof compare_fields / sizeof compare_fields[0]};
