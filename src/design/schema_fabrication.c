/* Keys of `fabrication`. */
#include "design/design_schema.h"

#include <stddef.h>

#define AT(member) offsetof(struct dea_design_raw, design.fabrication.member)

static const struct dea_field sheet_fields[] = {
    DEA_NUMBER_ROW("width", AT(sheet.width_m), "m", "210 mm", "width of a sheet", .above_min = true,
                   .max = 10, .default_text = "210 mm"),
    DEA_NUMBER_ROW("height", AT(sheet.height_m), "m", "297 mm", "height of a sheet",
                   .above_min = true, .max = 10, .default_text = "297 mm"),
    DEA_NUMBER_ROW("margin", AT(sheet.margin_m), "m", "5 mm", "edge of a sheet that stays empty",
                   .max = 1, .default_text = "5 mm"),
    DEA_NUMBER_ROW("gap", AT(sheet.gap_m), "m", "3 mm", "distance between parts on a sheet",
                   .max = 1, .default_text = "3 mm"),
};

static const struct dea_field blank_fields[] = {
    DEA_LENGTH_ROW(INPLANE, "margin", AT(blank.margin), "10 mm stretched",
                   "film beyond the outer edge of the frame, for the grips of the stretcher",
                   .max = 1, .default_text = "10 mm stretched"),
};

static const struct dea_field frame_fields[] = {
    DEA_NUMBER_ROW("width", AT(ring.width_m), "m", "10 mm",
                   "width of the frame, from the box around its opening outwards",
                   .above_min = true, .max = 1, .default_text = "10 mm"),
    DEA_NUMBER_ROW(
        "gap", AT(frame_gap_m), "m", "5 mm",
        "distance of a frame from the parts, where it holds the film only until that is cut",
        .max = 1, .default_text = "5 mm"),
    DEA_NUMBER_ROW("contact_window", AT(ring.contact_window_m), "m", "3 mm",
                   "diameter of the hole in the frame through which the pad of an electrode below "
                   "is reached; 0: none",
                   .max = 1, .default_text = "3 mm"),
};

static const struct dea_field leads_fields[] = {
    DEA_LENGTH_ROW(INPLANE, "width", AT(leads.width), "1 mm unstretched", "width of a lead",
                   .above_min = true, .max = 1, .default_text = "1 mm unstretched"),
    DEA_LENGTH_ROW(INPLANE, "pad_diameter", AT(leads.pad_diameter), "5 mm stretched",
                   "diameter of the pad at the end of a lead", .above_min = true, .max = 1,
                   .default_text = "5 mm stretched"),
    DEA_NUMBER_ROW("angle", AT(leads.angle_rad), "radian", "45 degree",
                   "direction of the lead of the top electrode, from the first fibre, seen from "
                   "the fibres; that of the bottom electrode goes to the other side",
                   .min = -7, .max = 7, .absent_text = "halfway between two fibres"),
};

static const struct dea_field ring_fields[] = {
    DEA_NUMBER_ROW("width", AT(ring.width_m), "m", "10 mm",
                   "width of the ring, from the inner edge of the frame outwards",
                   .above_min = true, .max = 1, .default_text = "10 mm"),
    DEA_NUMBER_ROW("contact_window", AT(ring.contact_window_m), "m", "3 mm",
                   "diameter of the hole in the ring through which the pad of the bottom electrode "
                   "is reached; 0: none",
                   .max = 1, .default_text = "3 mm"),
};

static const struct dea_field holder_fields[] = {
    DEA_NUMBER_ROW("anchor", AT(holder.anchor_m), "m", "3 mm",
                   "length of a clamped or hinged fibre that lies on the ring", .above_min = true,
                   .max = 1, .default_text = "3 mm"),
    DEA_NUMBER_ROW("tab_width", AT(holder.tab_width_m), "m", "1 mm",
                   "width of the tab that joins a fibre to its holder and is cut after bonding",
                   .above_min = true, .max = 1, .default_text = "1 mm"),
    DEA_NUMBER_ROW("tab_length", AT(holder.tab_length_m), "m", "1.5 mm",
                   "length of the tab; of a free fibre, on the ring", .above_min = true, .max = 1,
                   .default_text = "1.5 mm"),
};

static const struct dea_field marks_fields[] = {
    DEA_LENGTH_ROW(INPLANE, "diameter", AT(mark_diameter), "1 mm unstretched",
                   "diameter of an alignment mark", .above_min = true, .max = 0.1,
                   .default_text = "1 mm unstretched"),
    DEA_LENGTH_ROW(
        INPLANE, "grid", AT(grid_spacing), "5 mm unstretched",
        "spacing of the grid of crosses on the film, from which the pre-stretch is measured",
        .above_min = true, .max = 1, .default_text = "5 mm unstretched"),
};

static const struct dea_field cure_fields[] = {
    DEA_NUMBER_ROW("temperature", AT(cure_temperature_K), "K", "80 degC", "temperature",
                   .above_min = true, .min = 200, .max = 1000, .default_text = "80 degC"),
    DEA_NUMBER_ROW("time", AT(cure_time_s), "s", "4 h", "time of each curing", .above_min = true,
                   .max = 1e7, .default_text = "4 h"),
};

static const struct dea_field tolerance_fields[] = {
    DEA_NUMBER_ROW("thickness", AT(tolerance.thickness), "1", "5 %",
                   "of the thickness of the unstretched film", .above_min = true, .max = 0.5,
                   .default_text = "5 %"),
    DEA_NUMBER_ROW("pre_stretch", AT(tolerance.pre_stretch), "1", "0.02", "of the pre-stretch",
                   .above_min = true, .max = 1, .default_text = "0.02"),
    DEA_LENGTH_ROW(INPLANE, "electrode", AT(tolerance.electrode), "0.1 mm unstretched",
                   "of the diameter of the electrodes", .above_min = true, .max = 0.1,
                   .default_text = "0.1 mm unstretched"),
    DEA_NUMBER_ROW("frame", AT(tolerance.frame_m), "m", "0.1 mm",
                   "of the inner diameter of the frame", .above_min = true, .max = 0.1,
                   .default_text = "0.1 mm"),
    DEA_LENGTH_ROW(INPLANE, "fibre_tip", AT(tolerance.fibre), "0.2 mm stretched",
                   "of the distance of a fibre tip from the centre", .above_min = true, .max = 0.1,
                   .default_text = "0.2 mm stretched"),
};

#define SECTION_ROW(word, rows, words)                                                             \
  DEA_FIELD_ROW(RECORD, word, 0, .record = DEA_ROWS(rows), .doc = words)
/* Of a section of which the general form has the first two keys only. */
#define SHORT_ROW(word, rows, words)                                                               \
  DEA_FIELD_ROW(RECORD, word, 0, .doc = words,                                                     \
                .record = &(const struct dea_record){.fields = (rows), .field_count = 2})

/* Rows of both forms. */
#define CUT_ROWS                                                                                   \
  DEA_NUMBER_ROW("kerf", AT(kerf_m), "m", "0.2 mm",                                                \
                 "width of the cut: paths lie half of it outside of parts and inside of holes",    \
                 .max = 0.01, .default_text = "0.2 mm"),                                           \
      DEA_NUMBER_ROW("minimum_feature", AT(minimum_feature_m), "m", "0.5 mm",                      \
                     "narrowest web, slot or hole that the cutter makes", .above_min = true,       \
                     .max = 0.1, .default_text = "0.5 mm"),                                        \
      DEA_INTEGER_ROW("copies", AT(copies), "4", "actuators to be made", .min = 1,                 \
                      .max = DEA_DESIGN_COPIES_MAX, .default_text = "1"),                          \
      SECTION_ROW("sheet", sheet_fields, "material that parts are cut from")
#define PRINT_ROWS                                                                                 \
  SECTION_ROW("marks", marks_fields, "alignment marks, and the grid that shows the pre-stretch"),  \
      SECTION_ROW("cure", cure_fields, "curing of the printed electrodes")

static const struct dea_field fields[] = {
    CUT_ROWS,
    SECTION_ROW("blank", blank_fields, "film as it is cut"),
    SECTION_ROW("leads", leads_fields, "leads of the electrodes, with a pad on the ring"),
    SECTION_ROW("ring", ring_fields, "the frame as a part: a ring around its inner diameter"),
    SECTION_ROW("holder", holder_fields, "what holds the fibres until they are bonded"),
    PRINT_ROWS,
    SECTION_ROW("tolerance", tolerance_fields, "tolerances of the check list"),
};

const struct dea_record dea_fabrication_record = {.fields = fields,
                                                  .field_count = DEA_COUNT(fields)};

static const struct dea_field general_fields[] = {
    CUT_ROWS,
    SECTION_ROW("blank", blank_fields, "film as it is cut, where a frame holds it"),
    SECTION_ROW("frame", frame_fields,
                "the plate that holds a stretched film, or an edge that is a support"),
    PRINT_ROWS,
    SHORT_ROW("leads", leads_fields,
              "leads of the electrodes that have one (`lead`), with a pad on the frame"),
    {.key = "ring", .elsewhere = "the frame's width is 'frame: {width: ...}' here"},
    {.key = "holder", .elsewhere = "parts lie on a carrier here, which needs no holder"},
    SHORT_ROW("tolerance", tolerance_fields, "tolerances of the check list"),
};

const struct dea_record dea_fabrication_general_record = {.fields = general_fields,
                                                          .field_count = DEA_COUNT(general_fields)};
