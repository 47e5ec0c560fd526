/* Keys of `drive`. */
#include "design/schema.h"

#include <stddef.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define AT(member) offsetof(struct dea_design_raw, design.member)

static const struct dea_field drive_fields[] = {
    {.key = "waveform",
     .kind = DEA_FIELD_SECTION,
     .offset = AT(drive.section),
     .kinds = dea_wave_records,
     .absent_text = "none",
     .doc = "voltage asked of the supply; its keys go with its kind",
     .example = "{kind: square, high: 7 kV, frequency: 0.5 Hz}"},
    {.key = "series_resistance",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(drive.series_resistance_ohm),
     .unit = "ohm",
     .max = 1e15,
     .default_text = "0 ohm",
     .doc = "resistance between supply and film, that of the electrodes in it",
     .example = "1 Mohm"},
    {.key = "current_limit",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(drive.current_limit_A),
     .unit = "A",
     .above_min = true,
     .max = 1e3,
     .absent_text = "none",
     .doc = "largest current of the supply",
     .example = "10 mA"},
    {.key = "slew_limit",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(drive.slew_limit_V_per_s),
     .unit = "V/s",
     .above_min = true,
     .max = 1e15,
     .absent_text = "none",
     .doc = "fastest change of the supply's voltage",
     .example = "700 V/us"},
};

const struct dea_record dea_drive_record = {"drive", "waveform and supply", drive_fields,
                                            COUNT(drive_fields)};
