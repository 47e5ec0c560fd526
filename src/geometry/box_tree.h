/* A tree of boxes, for finding those that meet another box without looking at all. */
#pragma once

#include "base/context.h"

/* A box {x min, y min, x max, y max} with a number. */
struct dea_box {
  double side[4];
  size_t item;
};

struct dea_box_tree {
  struct dea_box_node *node; // owned
  size_t count;
};

/* Of boxes[count], which are put in another order. */
dea_status dea_box_tree_build(struct dea_context *ctx, struct dea_box *boxes, size_t count,
                              struct dea_box_tree *out);
void dea_box_tree_free(struct dea_context *ctx, struct dea_box_tree *tree);

/* The items whose boxes meet `side`, one a call: *cursor starts at 0; false at the end. */
bool dea_box_tree_next(const struct dea_box_tree *tree, const double side[4], size_t *cursor,
                       size_t *item);
