/* The identity of a device: a text that differs wherever an answer of a static model can. It is
 * made of every value of the design file, defaults among them, but those of a table of keys that do
 * not matter, and of what files and the catalogue add to it: materials and contours. A key that is
 * new in the schema is part of it. */
#pragma once

#include "device/device.h"

/* Whether the value of a key, "compute.voltage.to", is part of the identity. */
bool dea_identity_has(const char *path);
/* Adds the identity. device: NULL: the values of the design alone. but: keys that begin so are left
 * out too; NULL: none. */
void dea_device_identity(const struct dea_design *design, const struct dea_device *device,
                         const char *but, struct dea_text *out);

/* Adds all numbers of a material that models see, without the uncertainties, and no names. */
void dea_material_identity(const struct dea_material *material, struct dea_text *out);
