/* Keys of `compute.solid`. */
#include "design/schema.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_design_raw, design.compute.solid.member)

// In the order of enum dea_solid_film, enum dea_solid_domain and enum dea_buckling_branch.
static const char *const films[] = {"solid", "membrane", NULL};
static const char *const electrostatics[] = {"thin", "coupled",
                                             NULL}; // enum dea_solid_electrostatics
static const char *const domains[] = {"sector", "disc", "whole", NULL}; // whole: as disc
static const char *const branches[] = {"any", "fibres", "back", NULL};

static const struct dea_field adapt_fields[] = {
    {.key = "monitor",
     .kind = DEA_FIELD_LABEL,
     .offset = AT(adapt.monitor),
     .required = true,
     .doc = "monitor whose error decides: of a point or a body its largest displacement, of a line "
            "its length, of a shape its area",
     .example = "hub"},
    {.key = "tolerance",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(adapt.tolerance),
     .unit = "1",
     .above_min = true,
     .max = 1,
     .default_text = "1 %",
     .doc = "estimated error that is small enough, over that motion",
     .example = "0.5 %"},
    {.key = "passes",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(adapt.passes),
     .unit = "1",
     .min = 1,
     .max = 12,
     .default_text = "5",
     .doc = "meshes that are made at most",
     .example = "3"},
};
static const struct dea_record adapt_record = {
    "adapt", "refinement until a monitor is exact enough", adapt_fields,
    sizeof adapt_fields / sizeof adapt_fields[0]};

static const struct dea_field fields[] = {
    {.key = "film",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(film),
     .choices = films,
     .default_text = "solid",
     .doc = "elements of the film: solid ones, or a membrane, a faster preview within 10 to 20 % "
            "at the "
            "fibre tip",
     .example = "solid"},
    {.key = "domain",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(domain),
     .choices = domains,
     .default_text = "sector",
     .doc = "from a fibre's axis halfway to the next, or between two lines of the device's "
            "symmetry; or "
            "all of it with motions that break symmetry (disc and whole are the same)",
     .example = "sector"},
    {.key = "refinement",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(refinement),
     .unit = "1",
     .min = 1,
     .max = 6,
     .default_text = "1",
     .doc = "fineness of the mesh: 1 is within 1 to 3 % at a fibre tip, each one more halves all "
            "sizes in the plane",
     .example = "1.5"},
    {.key = "tip_refinement",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(tip_refinement),
     .unit = "1",
     .min = 1,
     .max = 6,
     .absent_text = "as refinement",
     .doc =
         "the same inside the circles of the electrode's edge and the fibre tips, where the film "
         "goes slack first, where that is finer; elements also grow slower there (of a disc)",
     .example = "2.5"},
    {.key = "adapt",
     .kind = DEA_FIELD_RECORD,
     .record = &adapt_record,
     .present_offset = AT(adapt.asked),
     .doc = "finer where the error of a monitor at the last voltage comes from, until it is small "
            "enough; of devices made of `plies`"},
    {.key = "order",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(order),
     .unit = "1",
     .min = 1,
     .max = 3,
     .default_text = "2",
     .doc = "order of the elements in the plane",
     .example = "3"},
    {.key = "order_z",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(order_z),
     .unit = "1",
     .min = 1,
     .max = 3,
     .default_text = "2",
     .doc = "order of the elements through the thickness of each layer",
     .example = "3"},
    {.key = "elements_z",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(elements_z),
     .unit = "1",
     .min = 1,
     .max = 16,
     .default_text = "1",
     .doc = "elements through the thickness of the film, thinner towards its faces; `field: "
            "coupled` needs 6 and grades the mesh to the electrode's edge as well (of devices made "
            "of `plies`: of each that has no `elements` of its own)",
     .example = "6"},
    {.key = "field",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(field),
     .choices = electrostatics,
     .default_text = "thin",
     .doc =
         "electric field: V/h where electrodes face each other, or from the potential as an "
         "unknown, with the fringe at the electrode's edge (solid film of a disc in a frame only)",
     .example = "coupled"},
    {.key = "buckling_branch",
     .alias = "side",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(buckling_branch),
     .choices = branches,
     .default_text = "any",
     .doc =
         "side that film and fibres are on where a film without tension may buckle to either one; "
         "any: the one that follows from 0 V",
     .example = "fibres"},
    {.key = "path",
     .kind = DEA_FIELD_CHOICE,
     .offset = AT(path),
     .choices = dea_no_yes,
     .default_text = "no",
     .doc = "whether study path follows model 3d too: all of its equilibrium path from 0 V to the "
            "highest voltage, through limit points and bifurcations",
     .example = "yes"},
};

const struct dea_record dea_solid_record = {"solid", "mesh of model 3d", fields,
                                            sizeof fields / sizeof fields[0]};
