/* Keys of `compute.solid` and `compute.reduced`. */
#include "design/design_schema.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_design_raw, design.compute.solid.member)

// In the order of enum dea_solid_film, enum dea_solid_domain and enum dea_buckling_branch.
static const char *const films[] = {"solid", "membrane", NULL};
static const char *const electrostatics[] = {"thin", "coupled",
                                             NULL}; // enum dea_solid_electrostatics
static const char *const domains[] = {"sector", "disc", "whole", NULL}; // whole: as disc
static const char *const branches[] = {"any", "fibres", "back", NULL};

static const struct dea_field adapt_fields[] = {
    DEA_LABEL_ROW("monitor", AT(adapt.monitor), "hub",
                  "monitor whose error decides: of a point or a body its largest displacement, of "
                  "a line its length, of a shape its area",
                  .required = true),
    DEA_NUMBER_ROW("tolerance", AT(adapt.tolerance), "1", "0.5 %",
                   "estimated error that is small enough, over that motion", .above_min = true,
                   .max = 1, .default_text = "1 %"),
    DEA_INTEGER_ROW("passes", AT(adapt.passes), "3", "meshes that are made at most", .min = 1,
                    .max = 12, .default_text = "5"),
};
static const struct dea_record adapt_record = {
    "adapt", "refinement until a monitor is exact enough", adapt_fields,
    sizeof adapt_fields / sizeof adapt_fields[0]};

static const struct dea_field fields[] = {
    DEA_CHOICE_ROW("film", AT(film), films, "solid",
                   "elements of the film: solid ones, or a membrane, a faster preview within 10 to "
                   "20 % at the fibre tip",
                   .default_text = "solid"),
    DEA_CHOICE_ROW(
        "domain", AT(domain), domains, "sector",
        "from a fibre's axis halfway to the next, or between two lines of the device's symmetry; "
        "or all of it with motions that break symmetry (disc and whole are the same)",
        .default_text = "sector"),
    DEA_NUMBER_ROW("refinement", AT(refinement), "1", "1.5",
                   "fineness of the mesh: 1 is within 1 to 3 % at a fibre tip, each one more "
                   "halves all sizes in the plane",
                   .min = 1, .max = 6, .default_text = "1"),
    DEA_NUMBER_ROW(
        "tip_refinement", AT(tip_refinement), "1", "2.5",
        "the same inside the circles of the electrode's edge and the fibre tips, where the film "
        "goes slack first, where that is finer; elements also grow slower there (of a disc)",
        .min = 1, .max = 6, .absent_text = "as refinement"),
    DEA_FIELD_ROW(
        RECORD, "adapt", 0, .record = &adapt_record, .present_offset = AT(adapt.asked),
        .doc =
            "finer where the error of a monitor at the last voltage comes from, until it is small "
            "enough; of devices made of `plies`"),
    DEA_INTEGER_ROW("order", AT(order), "3", "order of the elements in the plane", .min = 1,
                    .max = 3, .default_text = "2"),
    DEA_INTEGER_ROW("order_z", AT(order_z), "3",
                    "order of the elements through the thickness of each layer", .min = 1, .max = 3,
                    .default_text = "2"),
    DEA_INTEGER_ROW("elements_z", AT(elements_z), "6",
                    "elements through the thickness of the film, thinner towards its faces; "
                    "`field: coupled` needs 6 and grades the mesh to the electrode's edge as well "
                    "(of devices made of `plies`: of each that has no `elements` of its own)",
                    .min = 1, .max = 16, .default_text = "1"),
    DEA_CHOICE_ROW(
        "field", AT(field), electrostatics, "coupled",
        "electric field: V/h where electrodes face each other, or from the potential as an "
        "unknown, with the fringe at the electrode's edge (of solid films; of devices made of "
        "`plies` without "
        "rigid bodies, with one channel)",
        .default_text = "thin"),
    DEA_CHOICE_ROW(
        "buckling_branch", AT(buckling_branch), branches, "fibres",
        "side that film and fibres are on where a film without tension may buckle to "
        "either one; any: the one that follows from 0 V; of devices made of `plies` fibres is "
        "the side of +z",
        .alias = "side", .default_text = "any"),
    DEA_CHOICE_ROW("path", AT(path), dea_no_yes, "yes",
                   "whether study path follows model 3d too: all of its equilibrium path from 0 V "
                   "to the highest voltage, through limit points and bifurcations",
                   .default_text = "no"),
};

const struct dea_record dea_solid_record = {"solid", "mesh of model 3d", fields,
                                            sizeof fields / sizeof fields[0]};

#undef AT
#define AT(member) offsetof(struct dea_design_raw, design.compute.reduced.member)

static const char *const motions[] = {"largest", "x", "y", "z", "turn_x", "turn_y", "turn_z", NULL};

static const struct dea_field reduced_fields[] = {
    DEA_LABEL_ROW("file", AT(file), "cone.json",
                  "model that dea reduce-order has written; without it a run makes its own",
                  .absent_text = "none"),
    DEA_LABEL_ROW("monitor", AT(monitor), "hub",
                  "what moves as the coordinate: a point, a shape or a body",
                  .absent_text = "the first, or of a disc its fibre tip or the electrode's edge"),
    DEA_CHOICE_ROW("motion", AT(motion), motions, "z",
                   "along or about which axis; the largest: of its displacements at the highest "
                   "voltage",
                   .default_text = "largest"),
    DEA_NUMBER_ROW("voltage", AT(voltage_V), "V", "5 kV", "highest voltage of its range",
                   .above_min = true, .max = 1e6, .absent_text = "the highest of the sweep"),
    DEA_NUMBER_ROW("force", AT(force), "N", "50 mN",
                   "force along the coordinate, to either side, of its range (of a turn 1 N stands "
                   "for 1 N m)",
                   .above_min = true,
                   .absent_text = "what moves the coordinate as far as the voltage"),
    DEA_INTEGER_ROW("voltages", AT(voltages), "17",
                    "voltages that model 3d computes, 1 more than a multiple of 4", .min = 5,
                    .max = 65, .absent_text = "5, and 9 where these are not enough"),
    DEA_INTEGER_ROW("forces", AT(forces), "9", "forces at each, the same", .min = 5, .max = 17,
                    .default_text = "5"),
    DEA_NUMBER_ROW("air", AT(air_kg_per_m3), "kg/m^3", "1.2 kg/m^3",
                   "density of the gas on both sides of the film, which moves with it as in a wide "
                   "rigid wall; 0: vacuum, as in model 3d",
                   .max = 100, .default_text = "0 kg/m^3"),
};

const struct dea_record dea_reduced_record = {"reduced", "model reduced", reduced_fields,
                                              sizeof reduced_fields / sizeof reduced_fields[0]};
