/* What the process sheets of all devices have in common. */
#pragma once

#include "fabricate/document.h"
#include "fabricate/workshop.h"

/* Heading and head of the bill of materials. */
void dea_process_begin_materials(struct dea_document *document, int copies);
/* A row of it: for what, which material, how much of one and of all; a volume of NAN is left out.
 */
void dea_process_add_material(struct dea_document *document, int copies, const char *item,
                              const char *material, double area_m2, double volume_m3,
                              const char *note);
/* Cell of what a tolerance does to a value, a length in m or another one: "+12 um (+3 %)". An
 * effect of NAN is unknown. */
void dea_process_add_effect(struct dea_document *document, double effect, double value,
                            bool length);
/* Why the effects of tolerances are not at the highest voltage, if they are not. */
void dea_process_add_voltage(struct dea_document *document, double voltage_V, double highest_V);
/* Bill, steps and checks of a device that is no disc (process_layout.c). */
dea_status dea_process_write_layout(struct dea_context *ctx, const struct dea_workshop *workshop,
                                    bool sensitivity, struct dea_document *document);
