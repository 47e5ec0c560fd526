/* What can be said of a solid before anything is solved. */
#pragma once

#include "model/solid/assembly/solid.h"

/* No inverted element, laws that reach the pre-stretch, supports that leave no rigid motion (not
 * asked where loads may hold). A message says where and what to do. Nothing to do the second time.
 */
dea_status dea_solid_check(struct dea_context *ctx, struct dea_solid *solid);
