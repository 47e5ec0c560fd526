/* All shapes, in the order in which they are offered. A new one is a table of its parameters with a
 * function in shapes.c, or a file of its own, and a line here. */
// X(name): `const struct dea_shape_type dea_shape_<name>`.
#define DEA_SHAPE_LIST(X)                                                                          \
  X(circle)                                                                                        \
  X(ring)                                                                                          \
  X(sector)                                                                                        \
  X(rectangle)                                                                                     \
  X(rounded_rectangle)                                                                             \
  X(polygon)                                                                                       \
  X(strip)                                                                                         \
  X(stadium)                                                                                       \
  X(arc_strip)
