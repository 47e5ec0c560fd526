/* What a sequence of ever finer meshes says of its answers: order of convergence, value at element
 * size 0, and how far each mesh is from it (docs/theory/convergence.md). */
#pragma once

#include "base/text.h"
#include "result/result.h"

enum { DEA_CONVERGENCE_MESHES_MAX = 8 };

enum dea_order_kind {
  DEA_ORDER_OBSERVED,     // the last three values approach a limit
  DEA_ORDER_NO_CHANGE,    // the last two changes are below 1e-6 of the value
  DEA_ORDER_NOT_MONOTONE, // the last two changes have different signs
  DEA_ORDER_NOT_FALLING,  // they do not become smaller with the elements: the sequence may diverge
  DEA_ORDER_TOO_FEW,      // fewer than three meshes have a value
};

/* Richardson estimate from values [count] on meshes of element size ~ 2^-refinement[count],
 * coarsest first. errors [count]: relative ones. With an observed order they are against the
 * extrapolated value; for that the order is taken as no more than 2 and no less than 1/2. Else
 * order and extrapolated are NAN, and an error is three times the largest difference to any finer
 * mesh, for the last mesh to the one before. */
enum dea_order_kind dea_richardson(const double *refinement, const double *values, size_t count,
                                   double *order, double *extrapolated, double *errors);

/* One quantity at one voltage on all meshes; arrays in their order, NAN where a mesh has no value.
 */
struct dea_convergence_row {
  int column;                     // of load points
  const struct dea_column *shown; // the same; lent until the context dies
  bool judged;                    // by such a motion a mesh is judged
  double voltage_V;
  double values[DEA_CONVERGENCE_MESHES_MAX], errors[DEA_CONVERGENCE_MESHES_MAX];
  enum dea_order_kind kind;
  double order, extrapolated;
};

/* Study convergence of one model. */
struct dea_convergence {
  size_t mesh_count;
  const struct dea_variant *meshes[DEA_CONVERGENCE_MESHES_MAX]; // lent, coarsest first
  double tolerance;
  size_t row_count;
  struct dea_convergence_row *rows; // voltage by voltage; owned
};

/* Rows of all quantities that the model has, of monitors of their headlines (dea_curve_headlines)
 * on the finest mesh; an error of a stretch is over what it is beyond 1. DEA_E_ARGUMENT for more
 * meshes than there is room for. *out: owned by the caller; NULL without failure when the result
 * has no such study. */
dea_status dea_convergence_create(struct dea_context *ctx, const struct dea_result *result,
                                  const char *model, struct dea_convergence **out);
void dea_convergence_destroy(struct dea_context *ctx, struct dea_convergence *convergence);

/* The coarsest mesh that is, with all finer ones, within the tolerance for all that meshes are
 * judged by at a voltage; mesh_count when there is none. */
size_t dea_convergence_enough(const struct dea_convergence *convergence, double voltage_V);
/* "not monotone: no order": what is wrong with a sequence, "" for an observed order. */
const char *dea_order_text(enum dea_order_kind kind);
/* One sentence a voltage on which mesh is enough, with a line's end after each. */
void dea_convergence_verdict(const struct dea_convergence *convergence, struct dea_text *out);
