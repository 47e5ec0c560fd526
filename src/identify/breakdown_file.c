#include "identify/breakdown_file.h"

#define AT(member) offsetof(struct dea_breakdown_file, member)

static const struct dea_field fields[] = {
    DEA_FIT_HEAD_FIELDS("name of the material that is written", "my-silicone", "none",
                        "what the material is", "silicone film, batch 7"),
    DEA_LABEL_ROW("material", AT(material), "elastosil-2030",
                  "material of the catalogue whose law, permittivity and density are kept",
                  .required = true),
    DEA_LABEL_ROW(
        "breakdown", AT(tests), "breakdown.csv",
        "CSV table of films, counted from the folder of this file: 'voltage (kV)' or 'field "
        "(V/um)' at breakdown or the largest that was survived, 'survived' (1, or 0: it broke), "
        "and what differs of 'thickness (um)' unstretched, 'stretch', 'area (mm^2)'",
        .required = true),
    DEA_NUMBER_ROW("thickness", AT(thickness_m), "m", "100 um",
                   "thickness of all films, unstretched", .above_min = true, .max = 0.1,
                   .absent_text = "a column"),
    DEA_NUMBER_ROW("stretch", AT(stretch), "1", "1.5",
                   "stretch of all films, the mean one of the plane", .above_min = true, .max = 100,
                   .absent_text = "a column"),
    DEA_NUMBER_ROW("area", AT(area_m2), "m^2", "20 mm^2",
                   "area under the electrodes of all films, unstretched", .above_min = true,
                   .max = 10, .absent_text = "a column"),
    DEA_NUMBER_ROW("exponent", AT(exponent), "1", "0.63", "power of the stretch, where it is known",
                   .min = -10, .max = 10,
                   .absent_text = "found where stretches differ, else unknown"),
    DEA_NUMBER_ROW("thickness_exponent", AT(thickness_exponent), "1", "-0.25",
                   "power of the thickness, where it is known", .min = -10, .max = 10,
                   .absent_text = "found where unstretched thicknesses differ, else unknown"),
    DEA_NUMBER_ROW("reference_thickness", AT(thickness0_m), "m", "50 um",
                   "thickness, as stretched, that the field found belongs to", .above_min = true,
                   .max = 0.1, .absent_text = "the films' mean"),
    DEA_NUMBER_ROW("reference_area", AT(area0_m2), "m^2", "100 mm^2",
                   "unstretched area that the field found belongs to", .above_min = true, .max = 10,
                   .absent_text = "the films' mean"),
};
const struct dea_record dea_breakdown_file_record = {
    "fit file", "breakdown tests of a film, for Weibull's law of them", fields,
    sizeof fields / sizeof fields[0]};

DEA_FIT_FILE(breakdown_file, dea_breakdown_file_record, NULL)
