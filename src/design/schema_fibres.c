/* Keys of `fibres`. */
#include "design/design_schema.h"

#include <stddef.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define AT(member) offsetof(struct dea_design_raw, design.member)

enum { TIP_GROUP = 1 };

static const struct dea_field bond_fields[] = {
    DEA_NUMBER_ROW("thickness", AT(fibres.bond_thickness_m), "m", "50 um",
                   "thickness of the glue between fibre and film; 0: none", .max = 0.01,
                   .default_text = "0 um"),
    DEA_NUMBER_ROW("modulus", AT(fibres.bond_modulus_Pa), "Pa", "1 MPa",
                   "Young's modulus of the glue; without effect at thickness 0", .above_min = true,
                   .max = 1e13, .default_text = "1 MPa"),
};

static const struct dea_record bond_record = {"bond", "layer of glue between fibre and film",
                                              bond_fields, COUNT(bond_fields)};

// In the order of enum dea_outer_end.
static const char *const outer_ends[] = {"clamped", "hinged", "free", NULL};

static const struct dea_field fibre_fields[] = {
    DEA_INTEGER_ROW("count", AT(fibres.count), "4", "number of fibres, evenly spread", .min = 1,
                    .max = 360, .required = true),
    DEA_NUMBER_ROW("angle", AT(fibres.angle_rad), "radian", "15 degree",
                   "of the first fibre from the x axis, counter-clockwise, seen from the fibres",
                   .min = -7, .max = 7, .default_text = "0 degree"),
    DEA_NUMBER_ROW("width", AT(fibres.width_m), "m", "2 mm",
                   "width of a fibre; it is bonded free of stress, so this is its own width",
                   .above_min = true, .max = 1, .default_text = "2 mm"),
    DEA_NUMBER_ROW("tip_width", AT(fibres.tip_width_m), "m", "1 mm",
                   "width of a fibre at its tip, if it tapers", .above_min = true, .max = 1,
                   .absent_text = "width"),
    DEA_NUMBER_ROW("thickness", AT(fibres.thickness_m), "m", "100 um", "thickness of a fibre",
                   .above_min = true, .max = 0.1, .default_text = "100 um"),
    DEA_FIELD_ROW(INPLANE, "overlap", AT(fibres.overlap), .unit = "m", .min = -1, .max = 1,
                  .default_text = "0 mm stretched", .group = TIP_GROUP, .option = 1,
                  .doc = "how far a fibre reaches over the electrode; negative: a gap",
                  .example = "0.5 mm stretched"),
    DEA_FIELD_ROW(INPLANE, "length", AT(fibres.length), .unit = "m", .above_min = true, .max = 1,
                  .group = TIP_GROUP, .option = 2,
                  .doc = "length from the inner edge of the frame to the tip",
                  .example = "11.25 mm stretched"),
    DEA_FIELD_ROW(INPLANE, "tip_radius", AT(fibres.tip_radius), .unit = "m", .max = 1,
                  .group = TIP_GROUP, .option = 3, .doc = "distance of the tip from the centre",
                  .example = "3.75 mm stretched"),
    DEA_LABEL_ROW("material", AT(fibres.material), "pet", "material of the fibres",
                  .or_section = true, .default_text = "pet"),
    DEA_FIELD_ROW(RECORD, "bond", 0, .record = &bond_record,
                  .doc = "layer of glue between fibre and film"),
    DEA_CHOICE_ROW("outer_end", AT(fibres.outer_end), outer_ends, "clamped",
                   "how the frame holds the fibre: its whole end, its lower edge only, not at all",
                   .default_text = "clamped"),
    DEA_FIELD_ROW(INPLANE, "outer_gap", AT(fibres.outer_gap), .unit = "m", .above_min = true,
                  .max = 1, .default_text = "1 mm stretched",
                  .doc =
                      "film between a free outer end and the frame; without effect on other ends",
                  .example = "1 mm stretched"),
};

const struct dea_record dea_fibres_record = {
    "fibres", "radial fibres on the upper face, from the frame towards the centre", fibre_fields,
    COUNT(fibre_fields)};
