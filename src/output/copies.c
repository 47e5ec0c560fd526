#include "output/copies.h"

#include <math.h>
#include <string.h>

size_t dea_copy_count(const struct dea_field_mesh *mesh)
{
  return mesh->fold > 0 ? 2 * (size_t)mesh->fold : 1;
}

struct dea_copy dea_copy_at(const struct dea_field_mesh *mesh, size_t number)
{
  struct dea_copy copy = {{1, 0, 0, 1}, number % 2 == 1};
  if (number == 0) {
    return copy;
  }
  double turn = 2 * acos(-1) * (double)(number / 2) / mesh->fold;
  // a turn by t after a mirror at angle a is a mirror at a + t/2
  double angle = copy.mirrored ? 2 * mesh->symmetry_angle + turn : turn;
  double c = cos(angle), s = sin(angle), sign = copy.mirrored ? -1 : 1;
  memcpy(copy.m, (double[4]){c, -sign * s, s, sign * c}, sizeof copy.m);
  return copy;
}

void dea_copy_move(const struct dea_copy *copy, const double in[3], double out[3])
{
  out[0] = copy->m[0] * in[0] + copy->m[1] * in[1];
  out[1] = copy->m[2] * in[0] + copy->m[3] * in[1];
  out[2] = in[2];
}
