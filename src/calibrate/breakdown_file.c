#include "calibrate/breakdown_file.h"

#define AT(member) offsetof(struct dea_breakdown_file, member)

static const struct dea_field fields[] = {
    DEA_FIT_HEAD_FIELDS("name of the material that is written", "my-silicone", "none",
                        "what the material is", "silicone film, batch 7"),
    {.key = "material",
     .kind = DEA_FIELD_LABEL,
     .offset = AT(material),
     .required = true,
     .doc = "material of the catalogue whose law, permittivity and density are kept",
     .example = "elastosil-2030"},
    {.key = "breakdown",
     .kind = DEA_FIELD_LABEL,
     .offset = AT(tests),
     .required = true,
     .doc = "CSV table of films, counted from the folder of this file: 'voltage (kV)' or 'field "
            "(V/um)' at breakdown or the largest that was survived, 'survived' (1, or 0: it "
            "broke), and what differs of 'thickness (um)' unstretched, 'stretch', 'area (mm^2)'",
     .example = "breakdown.csv"},
    {.key = "thickness",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(thickness_m),
     .unit = "m",
     .above_min = true,
     .max = 0.1,
     .absent_text = "a column",
     .doc = "thickness of all films, unstretched",
     .example = "100 um"},
    {.key = "stretch",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(stretch),
     .unit = "1",
     .above_min = true,
     .max = 100,
     .absent_text = "a column",
     .doc = "stretch of all films, the mean one of the plane",
     .example = "1.5"},
    {.key = "area",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(area_m2),
     .unit = "m^2",
     .above_min = true,
     .max = 10,
     .absent_text = "a column",
     .doc = "area under the electrodes of all films, unstretched",
     .example = "20 mm^2"},
    {.key = "exponent",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(exponent),
     .unit = "1",
     .min = -10,
     .max = 10,
     .absent_text = "found where stretches differ, else unknown",
     .doc = "power of the stretch, where it is known",
     .example = "0.63"},
    {.key = "thickness_exponent",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(thickness_exponent),
     .unit = "1",
     .min = -10,
     .max = 10,
     .absent_text = "found where unstretched thicknesses differ, else unknown",
     .doc = "power of the thickness, where it is known",
     .example = "-0.25"},
    {.key = "reference_thickness",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(thickness0_m),
     .unit = "m",
     .above_min = true,
     .max = 0.1,
     .absent_text = "the films' mean",
     .doc = "thickness, as stretched, that the field found belongs to",
     .example = "50 um"},
    {.key = "reference_area",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(area0_m2),
     .unit = "m^2",
     .above_min = true,
     .max = 10,
     .absent_text = "the films' mean",
     .doc = "unstretched area that the field found belongs to",
     .example = "100 mm^2"},
};
const struct dea_record dea_breakdown_file_record = {
    "fit file", "breakdown tests of a film, for Weibull's law of them", fields,
    sizeof fields / sizeof fields[0]};

static dea_status check(struct dea_context *ctx, const void *file)
{
  (void)ctx;
  (void)file; // the table says it all
  return DEA_OK;
}

dea_status dea_breakdown_file_read(struct dea_context *ctx, const char *file,
                                   struct dea_breakdown_file **out)
{
  void *fit;
  dea_status status =
      dea_fit_head_read(ctx, file, &dea_breakdown_file_record, sizeof **out, check, &fit);
  *out = fit;
  return status;
}

void dea_breakdown_file_destroy(struct dea_context *ctx, struct dea_breakdown_file *fit)
{
  dea_fit_head_destroy(ctx, fit);
}
