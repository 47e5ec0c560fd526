/* Gradients of a question's quantities, by the model's own where it has them
 * (docs/theory/gradients.md). */
#pragma once

#include "explore/case_key.h"

/* The question's evaluator with gradients: at the last voltage, of quantities that an objective or
 * a limit is of, by variables that are searched; NAN for all others, and where the model has none
 * at a design. The evaluator without gradients where the model has none of its own, or the file's
 * method wants none. user: lent by the question. */
struct dea_evaluator dea_case_key_with_slopes(const struct dea_case_key *case_key);
