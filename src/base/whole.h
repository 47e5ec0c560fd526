/* Numbers as whole ones: a cast of one that does not fit is undefined. */
#pragma once

/* Towards 0; beyond low and high the nearer of them, of NAN low. */
static inline int dea_whole(double value, int low, int high)
{
  return value >= high ? high : value > low ? (int)value : low;
}
