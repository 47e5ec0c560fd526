/* The functions of an element (element.h) with what a test has at hand. */
#pragma once

#include "model/solid/element/hex.h"
#include "model/solid/element/membrane.h"

#include <stdint.h>

static inline struct dea_element hex_of(enum dea_element_kind kind,
                                        const struct dea_hex_shape *shape)
{
  return (struct dea_element){
      dea_element_types[kind],  shape->nodes,    shape->gauss,     shape->pressures,
      (void *)(uintptr_t)shape, shape->value[0], DEA_HEX_NODES_MAX};
}

static inline struct dea_element hexahedron(const struct dea_hex_shape *shape)
{
  return hex_of(DEA_ELEMENT_HEXAHEDRON, shape);
}

static inline struct dea_element potential_hexahedron(const struct dea_hex_shape *shape)
{
  return hex_of(DEA_ELEMENT_POTENTIAL_HEXAHEDRON, shape);
}

static inline struct dea_element membrane(const struct dea_face_shape *shape)
{
  return (struct dea_element){dea_element_types[DEA_ELEMENT_MEMBRANE],
                              shape->nodes,
                              shape->points,
                              0,
                              (void *)(uintptr_t)shape,
                              shape->value[0],
                              DEA_FACE_NODES_MAX};
}

static inline dea_status evaluate_hex(const struct dea_hex_shape *shape,
                                      const struct dea_part_material *part_material,
                                      const double *X, const double *u, const double *multiplier,
                                      double voltage_V, enum dea_eval_order order,
                                      struct dea_element_result *out)
{
  const struct dea_element element = hexahedron(shape);
  const struct dea_element_input in = {.part_material = part_material,
                                       .X = X,
                                       .u = u,
                                       .multiplier = multiplier,
                                       .voltage_V = voltage_V};
  return element.type->evaluate(&element, &in, order, out);
}

static inline dea_status evaluate_membrane(const struct dea_face_shape *shape,
                                           const struct dea_part_material *part_material,
                                           const double *X, const double *u, double voltage_V,
                                           enum dea_eval_order order,
                                           struct dea_element_result *out)
{
  const struct dea_element element = membrane(shape);
  const struct dea_element_input in = {
      .part_material = part_material, .X = X, .u = u, .voltage_V = voltage_V};
  return element.type->evaluate(&element, &in, order, out);
}
