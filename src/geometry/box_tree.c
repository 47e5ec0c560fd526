#include "geometry/box_tree.h"

#include <math.h>
#include <stdint.h>

/* Nodes stand in the order in which a search visits them; `skip` is where it goes on when a node's
 * box is missed. */
struct dea_box_node {
  double side[4];
  size_t skip;
  size_t item; // SIZE_MAX: an inner node
};

static double middle(const struct dea_box *box, int axis)
{
  return box->side[axis] + box->side[axis + 2];
}

/* Orders boxes so far that the first half lies before the others on an axis (Hoare's selection). */
static void halve(struct dea_box *boxes, size_t count, int axis)
{
  size_t low = 0, high = count - 1, half = count / 2;
  while (low < high) {
    double pivot = middle(&boxes[low + (high - low) / 2], axis);
    size_t i = low, j = high;
    for (;;) {
      while (middle(&boxes[i], axis) < pivot) {
        i++;
      }
      while (middle(&boxes[j], axis) > pivot) {
        j--;
      }
      if (i >= j) {
        break;
      }
      struct dea_box swapped = boxes[i];
      boxes[i++] = boxes[j];
      boxes[j--] = swapped;
    }
    // [low, i) is at most the pivot, (j, high] at least
    if (half <= j && j < high) {
      high = j;
    } else if (half >= i && i > low) {
      low = i;
    } else {
      return; // the middle is the pivot
    }
  }
}

/* Halves of the longer side, until one box is left. The depth is log2 of the number. */
static void build(struct dea_box_tree *tree, struct dea_box *boxes, size_t count)
{
  struct dea_box_node *node = &tree->node[tree->count++];
  *node = (struct dea_box_node){{INFINITY, INFINITY, -INFINITY, -INFINITY}, 0, SIZE_MAX};
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 2; k++) {
      node->side[k] = fmin(node->side[k], boxes[i].side[k]);
      node->side[k + 2] = fmax(node->side[k + 2], boxes[i].side[k + 2]);
    }
  }
  if (count == 1) {
    node->item = boxes[0].item;
  } else {
    halve(boxes, count, node->side[2] - node->side[0] > node->side[3] - node->side[1] ? 0 : 1);
    build(tree, boxes, count / 2);
    build(tree, boxes + count / 2, count - count / 2);
  }
  node->skip = tree->count;
}

dea_status dea_box_tree_build(struct dea_context *ctx, struct dea_box *boxes, size_t count,
                              struct dea_box_tree *out)
{
  *out = (struct dea_box_tree){.node = dea_alloc(ctx, 2 * count, sizeof *out->node)};
  DEA_TRY_MEMORY(out->node != NULL);
  if (count > 0) {
    build(out, boxes, count);
  }
  return DEA_OK;
}

void dea_box_tree_free(struct dea_context *ctx, struct dea_box_tree *tree)
{
  dea_free(ctx, tree->node);
  *tree = (struct dea_box_tree){0};
}

bool dea_box_tree_next(const struct dea_box_tree *tree, const double side[4], size_t *cursor,
                       size_t *item)
{
  while (*cursor < tree->count) {
    const struct dea_box_node *node = &tree->node[*cursor];
    bool meets = node->side[0] <= side[2] && side[0] <= node->side[2] && node->side[1] <= side[3] &&
                 side[1] <= node->side[3];
    bool leaf = node->item != SIZE_MAX;
    *cursor = meets ? *cursor + 1 : node->skip;
    if (meets && leaf) {
      *item = node->item;
      return true;
    }
  }
  return false;
}
