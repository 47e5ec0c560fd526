/* The identity of a material: a text of every number that models see. */
#pragma once

#include "base/text.h"
#include "material/material.h"

/* Adds all of a material but its names and the uncertainties of its numbers. */
void dea_material_identity(const struct dea_material *material, struct dea_text *out);
