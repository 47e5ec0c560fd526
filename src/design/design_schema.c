/* The table of all keys of a design file: `dea schema` prints it, the reader reads with it. */
#include "design/design_schema.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#define AT(member) offsetof(struct dea_design_raw, design.member)
#define RAW(member) offsetof(struct dea_design_raw, member)

enum { RADIUS_GROUP = 1, VOLTAGE_GROUP, FIELDS_GROUP, TIP_GROUP };

static const struct dea_field film_fields[] = {
    DEA_LABEL_ROW(
        "material", AT(film.material), "elastosil-2030",
        "material of the film, from `dea materials` or this file's `materials`, or in one line",
        .required = true, .or_section = true),
    DEA_LABEL_ROW("law", AT(film.law), "yeoh-178", "id of the material's set of law parameters",
                  .absent_text = "the material's first"),
    DEA_LABEL_ROW("permittivity", AT(film.permittivity), "constant",
                  "id of the material's permittivity", .absent_text = "the material's first"),
    DEA_LABEL_ROW("breakdown", AT(film.breakdown), "datasheet",
                  "id of the material's breakdown field", .absent_text = "the material's first"),
    DEA_LABEL_ROW("viscosity", AT(film.viscosity), "none",
                  "id of the material's viscosity, for studies in time; none: without",
                  .absent_text = "the material's first"),
    DEA_NUMBER_ROW("thickness", AT(film.thickness_m), "m", "100 um",
                   "thickness of the unstretched film", .above_min = true, .max = 0.01,
                   .required = true),
};

static const struct dea_field frame_fields[] = {
    DEA_LENGTH_ROW(STRETCHED, "inner_diameter", AT(frame.radius_m), "30 mm",
                   "inner diameter of the rigid frame (a length of the stretched film)",
                   .above_min = true, .max = 2, .scale = 0.5, .required = true,
                   .group = RADIUS_GROUP, .option = 1),
    DEA_LENGTH_ROW(STRETCHED, "inner_radius", AT(frame.radius_m), "15 mm",
                   "inner radius of the rigid frame (a length of the stretched film)",
                   .above_min = true, .max = 1, .group = RADIUS_GROUP, .option = 2),
};

static const struct dea_field electrode_fields[] = {
    DEA_LENGTH_ROW(INPLANE, "diameter", AT(electrodes.radius), "5 mm unstretched",
                   "diameter of the electrodes", .above_min = true, .max = 2, .scale = 0.5,
                   .required = true, .group = RADIUS_GROUP, .option = 1),
    DEA_LENGTH_ROW(INPLANE, "radius", AT(electrodes.radius), "3.75 mm stretched",
                   "radius of the electrodes", .above_min = true, .max = 1, .group = RADIUS_GROUP,
                   .option = 2),
    DEA_LABEL_ROW("material", AT(electrodes.material), "carbon-silicone-electrode",
                  "material of the electrodes", .or_section = true, .absent_text = "none"),
    DEA_NUMBER_ROW("thickness", AT(electrodes.thickness_m), "m", "10 um",
                   "thickness of each electrode; 0: without stiffness", .max = 0.01,
                   .default_text = "0 um"),
    DEA_NUMBER_ROW("sheet_resistance", AT(electrodes.sheet_resistance_ohm), "ohm", "50 kohm",
                   "resistance of a square of each electrode, which is fed all along its edge: it "
                   "charges in time (model 3d)",
                   .max = 1e15, .default_text = "0 ohm"),
};

// Fibres ------------------------------------------------------------------------------------------

static const struct dea_field bond_fields[] = {
    DEA_NUMBER_ROW("thickness", AT(fibres.bond_thickness_m), "m", "50 um",
                   "thickness of the glue between fibre and film; 0: none", .max = 0.01,
                   .default_text = "0 um"),
    DEA_NUMBER_ROW("modulus", AT(fibres.bond_modulus_Pa), "Pa", "1 MPa",
                   "Young's modulus of the glue; without effect at thickness 0", .above_min = true,
                   .max = 1e13, .default_text = "1 MPa"),
};

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
    DEA_LENGTH_ROW(INPLANE, "overlap", AT(fibres.overlap), "0.5 mm stretched",
                   "how far a fibre reaches over the electrode; negative: a gap", .min = -1,
                   .max = 1, .default_text = "0 mm stretched", .group = TIP_GROUP, .option = 1),
    DEA_LENGTH_ROW(INPLANE, "length", AT(fibres.length), "11.25 mm stretched",
                   "length from the inner edge of the frame to the tip", .above_min = true,
                   .max = 1, .group = TIP_GROUP, .option = 2),
    DEA_LENGTH_ROW(INPLANE, "tip_radius", AT(fibres.tip_radius), "3.75 mm stretched",
                   "distance of the tip from the centre", .max = 1, .group = TIP_GROUP,
                   .option = 3),
    DEA_LABEL_ROW("material", AT(fibres.material), "pet", "material of the fibres",
                  .or_section = true, .default_text = "pet"),
    DEA_FIELD_ROW(RECORD, "bond", 0, .record = DEA_ROWS(bond_fields),
                  .doc = "layer of glue between fibre and film"),
    DEA_CHOICE_ROW("outer_end", AT(fibres.outer_end), outer_ends, "clamped",
                   "how the frame holds the fibre: its whole end, its lower edge only, not at all",
                   .default_text = "clamped"),
    DEA_LENGTH_ROW(INPLANE, "outer_gap", AT(fibres.outer_gap), "1 mm stretched",
                   "film between a free outer end and the frame; without effect on other ends",
                   .above_min = true, .max = 1, .default_text = "1 mm stretched"),
};

// Drive -------------------------------------------------------------------------------------------

static const struct dea_field drive_fields[] = {
    DEA_FIELD_ROW(SECTION, "waveform", AT(drive.section), .kinds = dea_wave_records,
                  .absent_text = "none",
                  .doc = "voltage asked of the supply; its keys go with its kind",
                  .example = "{kind: square, high: 7 kV, frequency: 0.5 Hz}"),
    DEA_NUMBER_ROW("series_resistance", AT(drive.series_resistance_ohm), "ohm", "1 Mohm",
                   "resistance between supply and film, that of the electrodes in it", .max = 1e15,
                   .default_text = "0 ohm"),
    DEA_NUMBER_ROW("current_limit", AT(drive.current_limit_A), "A", "10 mA",
                   "largest current of the supply", .above_min = true, .max = 1e3,
                   .absent_text = "none"),
    DEA_NUMBER_ROW("disconnect", AT(drive.disconnect_s), "s", "2 s",
                   "time at which the supply is disconnected: from then on the film keeps its "
                   "charge, less what leaks through it",
                   .absent_text = "never"),
    DEA_NUMBER_ROW("slew_limit", AT(drive.slew_limit_V_per_s), "V/s", "700 V/us",
                   "fastest change of the supply's voltage", .above_min = true, .max = 1e15,
                   .absent_text = "none"),
};

// Model 3d, and reduced ---------------------------------------------------------------------------

// In the order of enum dea_solid_film, enum dea_solid_domain and enum dea_buckling_branch.
static const char *const films[] = {"solid", "membrane", NULL};
static const char *const electrostatics[] = {"thin", "coupled",
                                             NULL}; // enum dea_solid_electrostatics
static const char *const domains[] = {"sector", "disc", "whole", NULL}; // whole: as disc
static const char *const branches[] = {"any", "fibres", "back", NULL};

static const struct dea_field adapt_fields[] = {
    DEA_LABEL_ROW("monitor", AT(compute.solid.adapt.monitor), "hub",
                  "monitor whose error decides: of a point or a body its largest displacement, of "
                  "a line its length, of a shape its area",
                  .required = true),
    DEA_NUMBER_ROW("tolerance", AT(compute.solid.adapt.tolerance), "1", "0.5 %",
                   "estimated error that is small enough, over that motion", .above_min = true,
                   .max = 1, .default_text = "1 %"),
    DEA_INTEGER_ROW("passes", AT(compute.solid.adapt.passes), "3", "meshes that are made at most",
                    .min = 1, .max = 12, .default_text = "5"),
};

static const struct dea_field solid_fields[] = {
    DEA_CHOICE_ROW("film", AT(compute.solid.film), films, "solid",
                   "elements of the film: solid ones, or a membrane, a faster preview within 10 to "
                   "20 % at the fibre tip",
                   .default_text = "solid"),
    DEA_CHOICE_ROW(
        "domain", AT(compute.solid.domain), domains, "sector",
        "from a fibre's axis halfway to the next, or between two lines of the device's symmetry; "
        "or all of it with motions that break symmetry (disc and whole are the same)",
        .default_text = "sector"),
    DEA_NUMBER_ROW("refinement", AT(compute.solid.refinement), "1", "1.5",
                   "fineness of the mesh: 1 is within 1 to 3 % at a fibre tip, each one more "
                   "halves all sizes in the plane",
                   .min = 1, .max = 6, .default_text = "1"),
    DEA_NUMBER_ROW(
        "tip_refinement", AT(compute.solid.tip_refinement), "1", "2.5",
        "the same inside the circles of the electrode's edge and the fibre tips, where the film "
        "goes slack first, where that is finer; elements also grow slower there (of a disc)",
        .min = 1, .max = 6, .absent_text = "as refinement"),
    DEA_FIELD_ROW(
        RECORD, "adapt", 0, .record = DEA_ROWS(adapt_fields),
        .present_offset = AT(compute.solid.adapt.asked),
        .doc =
            "finer where the error of a monitor at the last voltage comes from, until it is small "
            "enough; of devices made of `plies`"),
    DEA_INTEGER_ROW("order", AT(compute.solid.order), "3", "order of the elements in the plane",
                    .min = 1, .max = 3, .default_text = "2"),
    DEA_INTEGER_ROW("order_z", AT(compute.solid.order_z), "3",
                    "order of the elements through the thickness of each layer", .min = 1, .max = 3,
                    .default_text = "2"),
    DEA_INTEGER_ROW("elements_z", AT(compute.solid.elements_z), "6",
                    "elements through the thickness of the film, thinner towards its faces; "
                    "`field: coupled` needs 6 and grades the mesh to the electrode's edge as well "
                    "(of devices made of `plies`: of each that has no `elements` of its own)",
                    .min = 1, .max = 16, .default_text = "1"),
    DEA_CHOICE_ROW(
        "field", AT(compute.solid.field), electrostatics, "coupled",
        "electric field: V/h where electrodes face each other, or from the potential as an "
        "unknown, with the fringe at the electrode's edge (of solid films; of devices made of "
        "`plies` without "
        "rigid bodies, with one channel)",
        .default_text = "thin"),
    DEA_CHOICE_ROW(
        "buckling_branch", AT(compute.solid.buckling_branch), branches, "fibres",
        "side that film and fibres are on where a film without tension may buckle to "
        "either one; any: the one that follows from 0 V; of devices made of `plies` fibres is "
        "the side of +z",
        .alias = "side", .default_text = "any"),
    DEA_CHOICE_ROW("path", AT(compute.solid.path), dea_no_yes, "yes",
                   "whether study path follows model 3d too: all of its equilibrium path from 0 V "
                   "to the highest voltage, through limit points and bifurcations",
                   .default_text = "no"),
};

static const char *const motions[] = {"largest", "x", "y", "z", "turn_x", "turn_y", "turn_z", NULL};

static const struct dea_field reduced_fields[] = {
    DEA_LABEL_ROW("file", AT(compute.reduced.file), "cone.json",
                  "model that dea reduce-order has written; without it a run makes its own",
                  .absent_text = "none"),
    DEA_LABEL_ROW("monitor", AT(compute.reduced.monitor), "hub",
                  "what moves as the coordinate: a point, a shape or a body",
                  .absent_text = "the first, or of a disc its fibre tip or the electrode's edge"),
    DEA_CHOICE_ROW("motion", AT(compute.reduced.motion), motions, "z",
                   "along or about which axis; the largest: of its displacements at the highest "
                   "voltage",
                   .default_text = "largest"),
    DEA_NUMBER_ROW("voltage", AT(compute.reduced.voltage_V), "V", "5 kV",
                   "highest voltage of its range", .above_min = true, .max = 1e6,
                   .absent_text = "the highest of the sweep"),
    DEA_NUMBER_ROW("force", AT(compute.reduced.force), "N", "50 mN",
                   "force along the coordinate, to either side, of its range (of a turn 1 N stands "
                   "for 1 N m)",
                   .above_min = true,
                   .absent_text = "what moves the coordinate as far as the voltage"),
    DEA_INTEGER_ROW("voltages", AT(compute.reduced.voltages), "17",
                    "voltages that model 3d computes, 1 more than a multiple of 4", .min = 5,
                    .max = 65, .absent_text = "5, and 9 where these are not enough"),
    DEA_INTEGER_ROW("forces", AT(compute.reduced.forces), "9", "forces at each, the same", .min = 5,
                    .max = 17, .default_text = "5"),
    DEA_NUMBER_ROW("air", AT(compute.reduced.air_kg_per_m3), "kg/m^3", "1.2 kg/m^3",
                   "density of the gas on both sides of the film, which moves with it as in a wide "
                   "rigid wall; 0: vacuum, as in model 3d",
                   .max = 100, .default_text = "0 kg/m^3"),
};

// Compute -----------------------------------------------------------------------------------------

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

static const struct dea_field voltage_fields[] = {
    DEA_NUMBER_ROW("from", RAW(from_V), "V", "0 kV", "first voltage", .max = 1e6,
                   .default_text = "0 kV", .group = VOLTAGE_GROUP, .option = 1),
    DEA_NUMBER_ROW("to", RAW(to_V), "V", "8 kV", "last voltage; below `from` the sweep goes down",
                   .max = 1e6, .default_text = "8 kV", .group = VOLTAGE_GROUP, .option = 1),
    DEA_NUMBER_ROW("step", RAW(step_V), "V", "0.1 kV", "step between voltages", .above_min = true,
                   .max = 1e6, .default_text = "0.1 kV", .group = VOLTAGE_GROUP, .option = 1),
    DEA_CHOICE_ROW("back", RAW(back), dea_no_yes, "yes",
                   "whether the sweep goes back the same way: snap-through shows as hysteresis",
                   .default_text = "no"),
    DEA_NUMBER_ROW("values", RAW(voltages_V), "V", "[0 kV, 1 kV, 2 kV]",
                   "the voltages themselves, in the order to be computed", .max = 1e6,
                   .group = VOLTAGE_GROUP, .option = 2,
                   DEA_LIST(1, DEA_DESIGN_VOLTAGES_MAX, struct dea_quantity, RAW(voltage_count))),
};

static const struct dea_field path_fields[] = {
    DEA_NUMBER_ROW("max_stretch", AT(compute.path_max_stretch), "1", "2.2",
                   "total stretch of the electrode, pre-stretch included, at which the path ends",
                   .min = 1, .above_min = true, .max = 20,
                   .absent_text = "1.5 x pre_stretch, or all voltages"),
};

// In the order of enum dea_coverage_by.
static const char *const coverage_ways[] = {"radius", "area", NULL};

static const struct dea_field compute_fields[] = {
    DEA_LABEL_ROW("models", AT(compute.models), "[lumped, axisymmetric]", "models to be computed",
                  .default_text = "[lumped, axisymmetric]",
                  DEA_LIST(1, DEA_DESIGN_MODELS_MAX, struct dea_label, AT(compute.model_count))),
    DEA_FIELD_ROW(RECORD, "voltage", 0, .record = DEA_ROWS(voltage_fields),
                  .doc = "voltages of the sweep"),
    DEA_FIELD_ROW(RECORD, "path", 0, .record = DEA_ROWS(path_fields), .doc = "equilibrium path"),
    DEA_FIELD_ROW(RECORD, "solid", 0, .record = DEA_ROWS(solid_fields), .doc = "mesh of model 3d"),
    DEA_FIELD_ROW(RECORD, "reduced", 0, .record = DEA_ROWS(reduced_fields),
                  .doc = "range of model reduced, a fast model made by model 3d"),
    DEA_FIELD_ROW(
        RECORD, "compare", AT(compute.compare), .record = DEA_ROWS(compare_fields),
        .absent_text = "none",
        .doc = "study compare-design: other designs in one figure with this one",
        DEA_LIST(1, DEA_DESIGN_VARIANTS_MAX, struct dea_design_variant, AT(compute.compare_count))),
    DEA_CHOICE_ROW(
        "coverage_by", AT(compute.coverage_by), coverage_ways, "radius",
        "coverage of paper eq 17: ratio of the radii or of the areas of electrode and frame",
        .default_text = "radius"),
    DEA_NUMBER_ROW("coverage", AT(compute.coverage), "1", "0.2",
                   "coverage itself; takes the place of coverage_by", .above_min = true, .max = 1,
                   .below_max = true, .absent_text = "from coverage_by"),
};

// In the order of the DEA_FIGURE_* constants.
static const char *const figure_formats[] = {"svg", "pdf", "png", NULL};

// In the order of enum dea_fields_at and enum dea_fields_of.
static const char *const fields_at[] = {"all", "last", "none", NULL};
static const char *const fields_of[] = {"whole", "sector", NULL};

static const struct dea_field report_fields[] = {
    DEA_CHOICE_ROW(
        "figures", RAW(figures), figure_formats, "[svg, pdf]",
        "formats of the figures; those of a run that is done: dea plot RUN --format LIST",
        .default_text = "[svg]",
        DEA_LIST(0, DEA_FIGURE_COUNT, struct dea_choice, RAW(figure_count))),
    DEA_NUMBER_ROW("width", AT(report.width_m), "m", "85 mm", "width of a figure", .min = 0.02,
                   .max = 1, .default_text = "85 mm"),
    DEA_CHOICE_ROW(
        "fields", AT(report.fields), fields_at, "all",
        "voltages of the sweep at which a 3D model leaves its fields, for ParaView (some MB each)",
        .default_text = "last", .group = FIELDS_GROUP, .option = 1),
    DEA_NUMBER_ROW("fields_at", RAW(fields_at_V), "V", "[4 kV, 6 kV]", "these voltages themselves",
                   .max = 1e6, .group = FIELDS_GROUP, .option = 2,
                   DEA_LIST(1, DEA_DESIGN_FIELDS_MAX, struct dea_quantity, RAW(fields_at_count))),
    DEA_CHOICE_ROW(
        "fields_of", AT(report.fields_of), fields_of, "sector",
        "fields of the whole actuator, with mirrored copies, or of the part that was computed",
        .default_text = "whole"),
};

static const char *const gravities[] = {"off", "fibres_up", "fibres_down", NULL}; // dea_gravity

static const struct dea_field design_fields[] = {
    DEA_INTEGER_ROW("dea", RAW(version), "1", "version of the format of design files",
                    .min = DEA_DESIGN_VERSION, .max = DEA_DESIGN_VERSION, .required = true),
    DEA_LABEL_ROW("title", AT(title), "Actuator with four fibres",
                  "what the design is, for figures and reports", .absent_text = "none",
                  .one_line = true),
    DEA_FIELD_ROW(RECORD, "film", 0, .record = DEA_ROWS(film_fields), .required = true,
                  .doc = "the dielectric film"),
    DEA_NUMBER_ROW("pre_stretch", AT(pre_stretch), "1", "1.5",
                   "equibiaxial stretch at which the frame holds the film; 1: none", .min = 1,
                   .max = 10, .required = true),
    DEA_FIELD_ROW(RECORD, "frame", 0, .record = DEA_ROWS(frame_fields), .required = true,
                  .doc = "the frame that holds the pre-stretch"),
    DEA_FIELD_ROW(RECORD, "electrodes", 0, .record = DEA_ROWS(electrode_fields), .required = true,
                  .doc = "a disc on both faces of the film"),
    DEA_FIELD_ROW(RECORD, "fibres", 0, .record = DEA_ROWS(fibre_fields),
                  .present_offset = AT(has_fibres), .absent_text = "none",
                  .doc = "radial fibres on the upper face; without this section there are none"),
    DEA_CHOICE_ROW("gravity", AT(gravity), gravities, "fibres_up",
                   "weight, and which way the side of the fibres faces (3d); without fibres: +z",
                   .default_text = "off"),
    DEA_NUMBER_ROW("temperature", AT(temperature_K), "K", "23 degC",
                   "temperature of the device: chooses among sets of a material that were measured "
                   "at different ones, and shifts the times of branches (wlf)",
                   .min = 100, .max = 600, .absent_text = "unknown"),
    DEA_FIELD_ROW(RECORD, "drive", 0, .record = DEA_ROWS(drive_fields),
                  .doc = "waveform and supply for what happens in time"),
    DEA_FIELD_ROW(
        RECORD, "materials", AT(materials), .record = &dea_material_inline_record,
        .absent_text = "none of its own",
        .doc = "materials of this design; they go before those of the catalogue",
        DEA_OWN_LIST(1, DEA_DESIGN_MATERIALS_MAX, struct dea_material_data, AT(material_count))),
    DEA_FIELD_ROW(RECORD, "compute", 0, .record = DEA_ROWS(compute_fields),
                  .doc = "what to compute"),
    DEA_FIELD_ROW(RECORD, "fabrication", 0, .record = &dea_fabrication_record,
                  .doc = "what `dea fab` needs to make files for the workshop"),
    DEA_FIELD_ROW(RECORD, "report", 0, .record = DEA_ROWS(report_fields), .doc = "how to report"),
};

/* The row of a study's section. */
static struct dea_field section_field(const struct dea_design_section *section, size_t index)
{
  size_t at = AT(compute.settings) + index * sizeof(struct dea_settings);
  return (struct dea_field)DEA_FIELD_ROW(
      SETTINGS, section->record.name, at + offsetof(struct dea_settings, values),
      .present_offset = at + offsetof(struct dea_settings, written), .element_size = section->size,
      .record = &section->record, .doc = section->record.doc);
}

/* Keys of the short form that the general one has not, and what to write there. */
static const struct dea_field not_general[] = {
    {.key = "film",
     .elsewhere = "'film' belongs to the short form of a disc; here a film is one of the 'plies', "
                  "with its shape and its own pre_stretch"},
    {.key = "pre_stretch",
     .elsewhere = "'pre_stretch' belongs to the short form of a disc; here each of the 'plies' has "
                  "its own, along one axis or two"},
    {.key = "frame",
     .elsewhere = "'frame' belongs to the short form of a disc; here a rigid frame is one of the "
                  "'supports', such as '{edge: film}', and a flexible one is one of the 'plies'"},
    {.key = "fibres",
     .elsewhere =
         "'fibres' belongs to the short form of a disc; here a fibre is one of the 'plies', "
         "with a shape such as a rectangle, a strip, or an array or polar of them"},
    {.key = "stripes",
     .elsewhere = "there are no 'stripes': they are one of the 'plies', with a shape of kind array "
                  "of rectangles"},
    {.key = "layers", .elsewhere = "layers are the 'plies' here"},
    {.key = "hub", .elsewhere = "a hub is one of the 'bodies' here, with its shape"},
};

#define ONLY_GENERAL(word, what)                                                                   \
  {                                                                                                \
    .key = word, .elsewhere =                                                                      \
                     "'" word "' belongs to the general form of a design, which lists " what       \
                     " (docs/design-file.md); this file is of the short form of a "                \
                     "disc in a frame, because it has no 'plies'"                                  \
  }
/* The other way round. */
static const struct dea_field not_short[] = {
    ONLY_GENERAL("shapes", "shapes, and 'plies' of them"),
    ONLY_GENERAL("channels", "'plies', and electrodes with their channels"),
    ONLY_GENERAL("supports", "'plies', and supports that hold them"),
    ONLY_GENERAL("bodies", "'plies', and rigid bodies"),
    ONLY_GENERAL("springs", "'plies', and rigid bodies with springs"),
    ONLY_GENERAL("pressures", "'plies', and pressures on them"),
    ONLY_GENERAL("contacts", "'plies', and contacts of these"),
    ONLY_GENERAL("monitors", "'plies', and monitors"),
    ONLY_GENERAL("stripes", "'plies', of which one can be an array of stripes"),
    ONLY_GENERAL("layers", "'plies'"),
    ONLY_GENERAL("hub", "'plies', and rigid bodies such as a hub"),
};

static const char *const general_gravities[] = {"off", "top_up", "top_down", NULL}; // dea_gravity

/* Fields of a form that are those of the other one, or differ a little. */
static bool is_of(const struct dea_field *fields, size_t count, const char *key)
{
  for (size_t i = 0; i < count; i++) {
    if (strcmp(fields[i].key, key) == 0) {
      return true;
    }
  }
  return false;
}

/* `compute` with the sections of studies, into a form whose rows of the top are there. */
static void fill_compute(const struct dea_design_sections *sections, bool general,
                         struct dea_design_form *out)
{
  size_t count = 0;
  for (size_t i = 0; i < DEA_COUNT(compute_fields); i++) {
    if (!general || strncmp(compute_fields[i].key, "coverage", strlen("coverage")) != 0) {
      out->compute[count++] = compute_fields[i];
    }
  }
  if (general) {
    out->compute[0].default_text = "[3d]"; // the only one that knows more than a disc
    out->compute[0].example = "[3d]";
  }
  for (size_t i = 0; i < sections->count && i < DEA_DESIGN_SECTIONS_MAX; i++) {
    out->compute[count++] = section_field(sections->items[i], i);
  }
  out->compute_record = (struct dea_record){.fields = out->compute, .field_count = count};
  for (size_t i = 0; i < out->record.field_count; i++) {
    if (strcmp(out->top[i].key, "compute") == 0) {
      out->top[i].record = &out->compute_record;
    }
  }
  out->record.fields = out->top;
}

static void add_fields(struct dea_design_form *out, const struct dea_field *fields, size_t count)
{
  memcpy(out->top + out->record.field_count, fields, count * sizeof *fields);
  out->record.field_count += count;
}

static void fill_general(const struct dea_shape_schema *shapes, struct dea_design_form *out)
{
  out->record =
      (struct dea_record){"design file", "design of any actuator of flat layers", NULL, 0};
  for (size_t i = 0; i < DEA_COUNT(design_fields); i++) {
    const char *key = design_fields[i].key;
    if (strcmp(key, "gravity") == 0) { // the parts come before it
      add_fields(out, dea_parts_fields, dea_parts_field_count);
    }
    if (!is_of(not_general, DEA_COUNT(not_general), key) &&
        !is_of(dea_parts_fields, dea_parts_field_count, key)) {
      add_fields(out, &design_fields[i], 1);
    }
  }
  for (size_t i = 0; i < out->record.field_count; i++) {
    struct dea_field *field = &out->top[i];
    if (strcmp(field->key, "gravity") == 0) {
      field->choices = general_gravities;
      field->doc = "weight, and which way the top of the plies faces";
      field->example = "top_up";
    } else if (strcmp(field->key, "fabrication") == 0) {
      field->record = &dea_fabrication_general_record;
    } else if (strcmp(field->key, "shapes") == 0) {
      field->kinds = shapes->kinds;
    }
  }
  add_fields(out, not_general, DEA_COUNT(not_general));
}

void dea_design_schema_fill(const struct dea_design_sections *sections,
                            struct dea_design_schema *out)
{
  static_assert(DEA_COUNT(design_fields) + DEA_COUNT(not_short) <= DEA_DESIGN_TOP_MAX,
                "room for the top");
  static_assert(DEA_COUNT(design_fields) + DEA_COUNT(not_general) + 9 <= DEA_DESIGN_TOP_MAX,
                "room for the top with all parts");
  static_assert(DEA_COUNT(compute_fields) + DEA_DESIGN_SECTIONS_MAX <= DEA_DESIGN_COMPUTE_MAX,
                "room for all of compute");
  dea_shape_schema_fill(&out->shapes);
  out->disc.record =
      (struct dea_record){"design file", "design of a dielectric elastomer actuator", NULL, 0};
  add_fields(&out->disc, design_fields, DEA_COUNT(design_fields));
  add_fields(&out->disc, not_short, DEA_COUNT(not_short));
  fill_general(&out->shapes, &out->general);
  fill_compute(sections, false, &out->disc);
  fill_compute(sections, true, &out->general);
}
