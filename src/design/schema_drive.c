/* Keys of `drive`. */
#include "design/design_schema.h"

#include <stddef.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define AT(member) offsetof(struct dea_design_raw, design.member)

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

const struct dea_record dea_drive_record = {"drive", "waveform and supply", drive_fields,
                                            COUNT(drive_fields)};
