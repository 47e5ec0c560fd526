/* Numbers of a design that can change little by little, and the slopes of a model's answers by them
 * (docs/theory/gradients.md). */
#ifndef DEA_STUDY_DESIGN_GRADIENT_H
#define DEA_STUDY_DESIGN_GRADIENT_H

#include "model/model.h"

enum { DEA_NUMBERS_MAX = 64, DEA_NUMBER_KEY_SIZE = 64 };

/* One number: a key of the design file with a value ("film.thickness"), "voltage", or one of a
 * material: "film.law.PARAMETER", "film.permittivity.at_rest", "film.permittivity.slope",
 * "electrodes.law.PARAMETER", "fibres.young_modulus", "fibres.poisson_ratio". */
struct dea_design_number {
  char key[DEA_NUMBER_KEY_SIZE];
  double value;     // SI, as the file has it: a diameter is a diameter
  const char *unit; // SI; static storage
  double tolerance; // of the workshop, SI; NAN: none
  bool of_design;   // where it is kept: in a struct dea_design, else in a struct dea_device
  size_t offset;    // there; "voltage": not used
  double scale;     // what is kept over the value
};

/* All numbers of a disc's design that its device depends on, but those that are 0. out:
 * [DEA_NUMBERS_MAX]. */
void dea_design_numbers(const struct dea_design *design, const struct dea_device *device,
                        double voltage_V, struct dea_design_number *out, size_t *count);

/* What is asked of a model that stands at a voltage. All lent. */
struct dea_design_gradient {
  const struct dea_model_type *type;
  struct dea_model *model; // of this design and device, at its last point
  const struct dea_design *design;
  const struct dea_device *device;
  double voltage_V;
  const struct dea_design_number *numbers; // [number_count]
  size_t number_count;
  const int *columns; // [column_count] of load points
  size_t column_count;
};

/* slopes [number_count][column_count], SI of the quantity by SI of the number: NAN where the model
 * knows none, or its mesh cannot follow. */
dea_status dea_design_gradient_find(struct dea_context *ctx, const struct dea_design_gradient *ask,
                                    double *slopes);

/* All from a disc's design: values [column_count] of quantities at a voltage and their slopes
 * [key_count][column_count] by keys, as above. DEA_E_ARGUMENT for a key that is no such number, and
 * as the model's `solve`. */
dea_status dea_design_gradient_at(struct dea_context *ctx, const struct dea_model_type *type,
                                  const struct dea_design *design, const struct dea_device *device,
                                  double voltage_V, const char *const *keys, size_t key_count,
                                  const int *columns, size_t column_count, double *values,
                                  double *slopes);

#endif
