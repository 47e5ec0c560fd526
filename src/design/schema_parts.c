/* Keys of the general form of a design (docs/theory/devices.md). */
#include "design/schema_parts.h"

#include "design/design_schema.h"

#include <stddef.h>

#define RAW(member) offsetof(struct dea_design_raw, member)

/* Rows of the tables below; `type` is the struct of an item. */
#define NAME(type, member, word, text, sample, ...)                                                \
  DEA_LABEL_ROW(word, offsetof(struct type, member), sample, text, __VA_ARGS__)
#define NUMBER(type, member, word, si_unit, text, sample, ...)                                     \
  DEA_NUMBER_ROW(word, offsetof(struct type, member), si_unit, sample, text, __VA_ARGS__)
#define CHOICE(type, member, word, words, text, sample, ...)                                       \
  DEA_CHOICE_ROW(word, offsetof(struct type, member), words, sample, text, __VA_ARGS__)
/* A list in an item, with its number in `counter`. */
#define LIST(type, item, counter, least, most)                                                     \
  DEA_LIST(least, most, struct item, offsetof(struct type, counter))
#define REQUIRED .required = true
#define OPTIONAL .required = false
#define POINT(type, member, word, text, number, ...)                                               \
  NUMBER(type, member##_m, word, "m", text, "[0 mm, 0 mm]", .group = 1, .option = (number),        \
         LIST(type, dea_quantity, member##_count, 2, 2), __VA_ARGS__)
/* Six numbers along and about the axes, of which the last three turn. */
#define SIX(type, member, shift, shift_unit, shift_example, shift_text, turn, turn_unit,           \
            turn_example, turn_text)                                                               \
  NUMBER(type, member[0], shift "_x", shift_unit, shift_text " along x", shift_example, OPTIONAL), \
      NUMBER(type, member[1], shift "_y", shift_unit, shift_text " along y", shift_example,        \
             OPTIONAL),                                                                            \
      NUMBER(type, member[2], shift "_z", shift_unit, shift_text " along z", shift_example,        \
             OPTIONAL),                                                                            \
      NUMBER(type, member[3], turn "_x", turn_unit, turn_text " about x", turn_example, OPTIONAL), \
      NUMBER(type, member[4], turn "_y", turn_unit, turn_text " about y", turn_example, OPTIONAL), \
      NUMBER(type, member[5], turn "_z", turn_unit, turn_text " about z", turn_example, OPTIONAL)

static const struct dea_field ply_fields[] = {
    NAME(dea_parts_ply, name, "name", "its name", "film", REQUIRED),
    NAME(dea_parts_ply, shape, "shape", "shape that it covers", "film", REQUIRED),
    NAME(dea_parts_ply, material, "material",
         "its material, from `dea materials` or this file's `materials`, or in one line",
         "elastosil-2030", REQUIRED, .or_section = true),
    NAME(dea_parts_ply, law, "law", "id of the material's set of law parameters", "yeoh-178",
         .absent_text = "the material's first"),
    NAME(dea_parts_ply, permittivity, "permittivity", "id of the material's permittivity",
         "constant", .absent_text = "the material's first"),
    NAME(dea_parts_ply, breakdown, "breakdown", "id of the material's breakdown field", "datasheet",
         .absent_text = "the material's first"),
    NAME(dea_parts_ply, viscosity, "viscosity", "id of the material's viscosity; none: without",
         "none", .absent_text = "the material's first"),
    NUMBER(dea_parts_ply, thickness_m, "thickness", "m",
           "its thickness before the pre-stretch, of each of its `layers`", "100 um", REQUIRED,
           .above_min = true, .max = 0.1),
    NUMBER(dea_parts_ply, pre_stretch, "pre_stretch", "1",
           "stretch at which it is bonded: of both axes, or one of each", "[1.2, 1.5]", .min = 0.1,
           .max = 10, .lone = true, .default_text = "[1]",
           LIST(dea_parts_ply, dea_quantity, pre_stretch_count, 1, 2)),
    NUMBER(dea_parts_ply, angle_rad, "angle", "radian",
           "direction of the first axis of the pre-stretch, counter-clockwise from x", "30 degree",
           .default_text = "0 degree"),
    DEA_INTEGER_ROW("elements", offsetof(struct dea_parts_ply, elements), "2",
                    "elements through its thickness", .min = 1, .max = 32,
                    .absent_text = "as many as the model takes"),
    DEA_INTEGER_ROW("layers", offsetof(struct dea_parts_ply, layers), "100",
                    "equal layers, computed as one: the electrodes of its two faces lie by turns "
                    "between them",
                    .min = 1, .max = 10000, .default_text = "1"),
};

static const char *const sides[] = {"bottom", "top", NULL}; // enum dea_parts_side

static const struct dea_field electrode_fields[] = {
    NAME(dea_parts_electrode, name, "name", "its name", "upper", .absent_text = "its channel"),
    NAME(dea_parts_electrode, ply, "ply", "ply on whose face it lies", "film", REQUIRED),
    CHOICE(dea_parts_electrode, side, "side", sides,
           "face of that ply; a ply that lies there feels it too", "top", REQUIRED),
    NAME(dea_parts_electrode, shape, "shape", "shape that it covers", "active", REQUIRED),
    NAME(dea_parts_electrode, channel, "channel", "what it is connected to; ground: 0 V", "drive",
         REQUIRED),
    NUMBER(dea_parts_electrode, lead_rad, "lead", "radian",
           "direction of a lead from its middle to a pad on the frame, counter-clockwise from x, "
           "which `dea fab` makes and no model sees",
           "45 degree", .min = -7, .max = 7, .absent_text = "none"),
    NUMBER(dea_parts_electrode, sheet_resistance_ohm, "sheet_resistance", "ohm",
           "resistance of a square of it: in time it charges from where it meets an electrode of "
           "the same face and channel without one, else from all along its outer edge",
           "50 kohm", .max = 1e15, .default_text = "0 ohm"),
};

static const struct dea_field channel_fields[] = {
    NAME(dea_parts_channel, name, "name", "its name", "drive", REQUIRED),
    NUMBER(dea_parts_channel, ratio, "ratio", "1",
           "its voltage is this times compute.voltage, and `voltage` of its own", "0.5",
           .default_text = "1", .min = -1e6, .max = 1e6),
    NUMBER(dea_parts_channel, voltage_V, "voltage", "V", "voltage of its own", "2 kV",
           .default_text = "0 V", .min = -1e6, .max = 1e6),
    DEA_FIELD_ROW(
        SECTION, "waveform", offsetof(struct dea_parts_channel, section), .kinds = dea_wave_records,
        .kinds_elsewhere = true, .absent_text = "ratio times drive.waveform",
        .doc =
            "voltage in time of a source of its own, to which `voltage` is added; keys as those of "
            "drive.waveform",
        .example = "{kind: sine, mean: 2 kV, amplitude: 1 kV, frequency: 1 Hz}"),
};

static const char *const holds[] = {"clamped", "hinged", "x", "y", "z", NULL}; // dea_parts_hold

static const struct dea_field support_fields[] = {
    NAME(dea_parts_support, edge, "edge", "shape on whose boundary it holds", "film", REQUIRED,
         .group = 1, .option = 1),
    NAME(dea_parts_support, shape, "shape", "shape in which it holds", "clamp", .group = 1,
         .option = 2),
    NAME(dea_parts_support, within, "within", "only what lies in this shape too", "left",
         .absent_text = "everywhere"),
    CHOICE(dea_parts_support, hold, "hold", holds,
           "clamped; hinged: only at the bottom, so that it may turn; or the directions held; left "
           "out: clamped, or with a force nothing",
           "[x, z]", .lone = true, .absent_text = "clamped, with a force nothing",
           LIST(dea_parts_support, dea_choice, hold_count, 1, DEA_HOLDS_MAX)),
    NUMBER(dea_parts_support, move_m[0], "move_x", "m", "how far it is moved along x", "1 mm",
           OPTIONAL),
    NUMBER(dea_parts_support, move_m[1], "move_y", "m", "how far it is moved along y", "1 mm",
           OPTIONAL),
    NUMBER(dea_parts_support, move_m[2], "move_z", "m", "how far it is moved along z", "1 mm",
           OPTIONAL),
    NUMBER(dea_parts_support, force_N[0], "force_x", "N",
           "dead force along x on all of it, spread evenly along the edge or over the shape",
           "10 mN", OPTIONAL),
    NUMBER(dea_parts_support, force_N[1], "force_y", "N", "the same along y", "10 mN", OPTIONAL),
    NUMBER(dea_parts_support, force_N[2], "force_z", "N", "the same along z", "10 mN", OPTIONAL),
};

static const char *const directions[] = {"x", "y", "z", "turn_x", "turn_y", "turn_z", NULL};

static const struct dea_field body_fields[] = {
    NAME(dea_parts_body, name, "name", "its name", "hub", REQUIRED),
    NAME(dea_parts_body, shape, "shape", "all that lies in this shape moves as one", "hub",
         REQUIRED),
    CHOICE(dea_parts_body, free, "free", directions, "what it may do; []: nothing", "[z]",
           .lone = true, .absent_text = "everything",
           .present_offset = offsetof(struct dea_parts_body, free_given),
           LIST(dea_parts_body, dea_choice, free_count, 0, DEA_DIRECTIONS)),
    NUMBER(dea_parts_body, mass_kg, "mass", "kg", "its mass beside that of its plies", "20 g",
           .default_text = "0 g", .max = 1e6),
    SIX(dea_parts_body, force, "force", "N", "1 mN", "force on it", "moment", "N.m", "1 mN.m",
        "moment on it"),
    SIX(dea_parts_body, move, "move", "m", "2 mm", "how far it is moved", "turn", "radian",
        "10 degree", "how far it is turned"),
};

static const struct dea_field spring_fields[] = {
    NAME(dea_parts_spring, body, "body", "rigid body that it pulls back", "hub", REQUIRED),
    CHOICE(dea_parts_spring, direction, "direction", directions, "along or about which axis", "z",
           REQUIRED),
    NUMBER(dea_parts_spring, stiffness_N_per_m, "stiffness", "N/m", "force by shift", "10 N/m",
           REQUIRED, .group = 1, .option = 1, .max = 1e12),
    NUMBER(dea_parts_spring, stiffness_N_m_per_rad, "turn_stiffness", "N.m/radian",
           "moment by turn, of a direction turn_x, turn_y, turn_z", "1 mN.m/radian", .group = 1,
           .option = 2, .max = 1e12),
    DEA_FIELD_ROW(
        ROWS, "table", offsetof(struct dea_parts_spring, table), .group = 1, .option = 3,
        .doc = "how far it is from free_at, rising, and the force that pulls back; it may fall",
        .example = "[[0 mm, 0 mN], [1 mm, 5 mN], [2 mm, 3 mN]]"),
    NUMBER(dea_parts_spring, free_at_m, "free_at", "m", "shift at which it has no force", "1 mm",
           .default_text = "0 mm", .group = 2, .option = 1),
    NUMBER(dea_parts_spring, free_at_rad, "free_at_angle", "radian",
           "turn at which it has no moment", "10 degree", .group = 2, .option = 2),
};

static const struct dea_field pressure_fields[] = {
    NAME(dea_parts_pressure, name, "name", "its name, for a monitor", "chamber",
         .absent_text = "none"),
    NAME(dea_parts_pressure, ply, "ply", "ply on whose face it acts", "film", REQUIRED),
    CHOICE(dea_parts_pressure, side, "side", sides, "face of that ply", "bottom", REQUIRED),
    NAME(dea_parts_pressure, shape, "shape", "shape in which it acts", "film", REQUIRED),
    NUMBER(dea_parts_pressure, pressure_Pa, "pressure", "Pa",
           "follows the face and pushes into the ply; below 0 it pulls; of gas: when the film is "
           "flat, over that outside",
           "1 kPa", .min = -1e9, .max = 1e9, .default_text = "0 Pa"),
    NUMBER(dea_parts_pressure, gas_m3, "gas", "m^3",
           "volume of the gas that the face encloses when it is flat, which has its pressure by "
           "Boyle's law",
           "5 ml", OPTIONAL, .above_min = true, .max = 1e3),
    NUMBER(dea_parts_pressure, ambient_Pa, "ambient", "Pa", "pressure outside of gas", "100 kPa",
           .default_text = "101.325 kPa", .above_min = true, .max = 1e9),
    NUMBER(dea_parts_pressure, liquid_m3, "liquid", "m^3",
           "volume of a liquid that is added to what the flat face encloses; it has the pressure "
           "that keeps that volume",
           "0.5 ml", OPTIONAL, .min = -1e3, .max = 1e3),
};

static const struct dea_field contact_fields[] = {
    NAME(dea_parts_contact, name, "name", "its name, for a monitor", "floor",
         .absent_text = "none"),
    NAME(dea_parts_contact, ply, "ply", "ply whose face touches", "film", REQUIRED),
    CHOICE(dea_parts_contact, side, "side", sides, "face of that ply", "bottom", REQUIRED),
    NAME(dea_parts_contact, shape, "shape", "shape in which it may touch", "film", REQUIRED),
    NUMBER(dea_parts_contact, gap_m, "gap", "m",
           "distance of the flat face from a rigid plane that it may touch", "0.5 mm", REQUIRED,
           .min = 0, .max = 1, .group = 1, .option = 1),
    NAME(dea_parts_contact, with, "with",
         "ply beyond a gap that it may touch, with all that lies in the shape between them open",
         "lower", .group = 1, .option = 2),
};

static const struct dea_field monitor_fields[] = {
    NAME(dea_parts_monitor, name, "name", "name in results", "middle", REQUIRED),
    POINT(dea_parts_monitor, at, "at", "point x, y of a ply", 1, REQUIRED),
    POINT(dea_parts_monitor, from, "from", "one end of a line on a ply", 2, OPTIONAL),
    POINT(dea_parts_monitor, to, "to", "the other end of that line", 2, OPTIONAL),
    NAME(dea_parts_monitor, shape, "shape", "a shape of a ply", "active", .group = 1, .option = 3),
    NAME(dea_parts_monitor, body, "body", "a rigid body", "hub", .group = 1, .option = 4),
    NAME(dea_parts_monitor, pressure, "pressure",
         "name of a pressure: it, and the volume that its face has swept", "chamber", .group = 1,
         .option = 5),
    NAME(dea_parts_monitor, contact, "contact",
         "name of a contact: the force on what the face touches, and the area that touches",
         "floor", .group = 1, .option = 6),
    NAME(dea_parts_monitor, ply, "ply", "ply that the point, line or shape lies in", "film",
         .absent_text = "the uppermost one there"),
};

/* The list `word` of items of one table. */
#define ITEMS(word, id, items, most, text, ...)                                                    \
  DEA_FIELD_ROW(RECORD, word, RAW(parts.items), .record = DEA_ROWS(id##_fields), .doc = text,      \
                DEA_OWN_LIST(1, most, struct dea_parts_##id, RAW(parts.id##_count)), __VA_ARGS__)
#define NO_ITEMS .absent_text = "none"

const struct dea_field dea_parts_fields[] = {
    DEA_FIELD_ROW(SECTION, "shapes", RAW(shapes), .list_min = 1, .list_max = DEA_PARTS_SHAPES_MAX,
                  .element_size = sizeof(const struct dea_node *), .count_offset = RAW(shape_count),
                  .required = true,
                  .doc = "named parts of the plane, in the flat film as it is stretched when parts "
                         "are bonded to "
                         "it; their keys go with their kind",
                  .example = "[{name: film, kind: circle, radius: 20 mm}]"),
    ITEMS("plies", ply, plies, DEA_PARTS_PLIES_MAX,
          "sheets from bottom to top: films, stiff electrodes, glue, stiffeners, flexible frames; "
          "the key that makes a file one of the general form",
          .required = true,
          .example = "[{name: film, shape: film, material: elastosil-2030, thickness: 100 um}]"),
    ITEMS("electrodes", electrode, electrodes, DEA_PARTS_ELECTRODES_MAX,
          "electrodes without thickness, on faces of plies", NO_ITEMS),
    ITEMS("channels", channel, channels, DEA_PARTS_CHANNELS_MAX,
          "channels whose voltage is not that of compute.voltage",
          .absent_text = "those of the electrodes, all with ratio 1"),
    ITEMS("supports", support, supports, DEA_PARTS_SUPPORTS_MAX,
          "what is held, moved, or pulled by a dead force", NO_ITEMS),
    ITEMS("bodies", body, bodies, DEA_PARTS_BODIES_MAX, "rigid bodies", NO_ITEMS),
    ITEMS("springs", spring, springs, DEA_PARTS_SPRINGS_MAX,
          "springs between bodies and the outside", NO_ITEMS),
    ITEMS("pressures", pressure, pressures, DEA_PARTS_PRESSURES_MAX, "pressures on faces",
          NO_ITEMS),
    ITEMS("contacts", contact, contacts, DEA_PARTS_CONTACTS_MAX,
          "faces that touch a rigid plane or another ply, without friction", NO_ITEMS),
    ITEMS("monitors", monitor, monitors, DEA_PARTS_MONITORS_MAX, "what results are reported of",
          NO_ITEMS),
};
const size_t dea_parts_field_count = DEA_COUNT(dea_parts_fields);
