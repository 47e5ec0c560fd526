/* Numbers of a design that can change little by little, and the slopes of a model's answers by them
 * (docs/theory/gradients.md). */
#pragma once

#include "study/critical.h"
#include "study/material_numbers.h"

enum { DEA_NUMBERS_MAX = 256 };

/* Where a number is kept. */
enum dea_number_of {
  DEA_NUMBER_OF_DEVICE, // in a struct dea_device; "voltage": nowhere
  DEA_NUMBER_OF_DESIGN, // in a struct dea_design
  DEA_NUMBER_OF_PART,   // in an item of a list of struct dea_parts (part_numbers.h)
  DEA_NUMBER_OF_PLY,    // in the material of a ply of the layout
  DEA_NUMBER_OF_TIP,    // in a struct dea_pressed
};

/* One number: a key of the design file with a value ("film.thickness"), "voltage", or one of a
 * material (material_numbers.h); of the general form those of part_numbers.h. */
struct dea_design_number {
  char key[DEA_NUMBER_KEY_SIZE];
  double value;     // SI, as the file has it: a diameter is a diameter
  const char *unit; // SI; static storage
  double tolerance; // of the workshop, SI; NAN: none
  enum dea_number_of of;
  size_t list, item; // of a part: list and place in it; of a ply: its place
  size_t offset;     // there; "voltage": not used
  double scale;      // what is kept over the value
  double reach;      // what small changes are shares of; 0: the value, which then is not 0
};

/* How the keys of densities end. */
#define DEA_DENSITY_KEY ".density"

/* All numbers of a design that its device depends on, but those that are 0; of the general form
 * with places of shapes that the file says to be 0. out:
 * [DEA_NUMBERS_MAX]. */
dea_status dea_design_numbers(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, double voltage_V,
                              struct dea_design_number *out, size_t *count);

/* A device with another value of one of them. */
struct dea_changed_device {
  struct dea_device device;
  struct dea_arena memory;
};

/* DEA_E_DESIGN: there is no such device, or a finding says what of it does not fit together. Also
 * after a failure to be freed; outlived by design and device. */
dea_status dea_device_change(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device,
                             const struct dea_design_number *number, double value,
                             struct dea_changed_device *out);
void dea_changed_device_free(struct dea_changed_device *changed);

/* Takes those away that nothing but vibrations depends on: densities, where there is no weight. */
void dea_numbers_at_rest(const struct dea_device *device, struct dea_design_number *numbers,
                         size_t *count);

/* Those of the tip that a model is pressed by, but those that are 0: "compute.force.depth", which
 * is here where it stands, and its radii; added to out [DEA_NUMBERS_MAX]. */
void dea_tip_numbers(const struct dea_pressed *pressed, struct dea_design_number *out,
                     size_t *count);

/* What is asked of a model that stands at a voltage. All lent. */
struct dea_design_gradient {
  const struct dea_model_type *type;
  struct dea_model *model; // of this design and device, at its last point
  const struct dea_design *design;
  const struct dea_device *device;
  double voltage_V;
  /* It stands at a point of its path with this stretch of the electrode, which is held while the
   * voltage follows; 0: the voltage is held. */
  double stretch;
  const struct dea_pressed *pressed;       // the tip of the model; NULL: it has none
  const struct dea_design_number *numbers; // [number_count]
  size_t number_count;
  const int *columns; // [column_count] of load points
  size_t column_count;
  const size_t *modes;    // [column_count] of frequencies; NULL: the lowest
  const size_t *monitors; // [monitor_count] of the layout
  size_t monitor_count;
  const enum dea_observed *motions; // [monitor_count] of them; NULL: the main ones
};

/* slopes [number_count][column_count + monitor_count], SI of the quantity by SI of the number: NAN
 * where the model knows none, or its mesh cannot follow. */
dea_status dea_design_gradient_find(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                    double *slopes);

/* slopes [number_count] of a critical voltage that was found of the device; model, voltage, columns
 * and monitors of the question are not looked at. NAN as above, and by "voltage". */
dea_status dea_design_gradient_critical(struct dea_context *ctx,
                                        const struct dea_design_gradient *ask,
                                        const struct dea_critical *critical, double *slopes);
