#include "identify/coupon.h"

#include "material/branch.h"
#include "material/plane.h"

#include <math.h>

const char *const dea_coupon_mode_names[DEA_COUPON_MODES + 1] = {"uniaxial", "planar",
                                                                 "equibiaxial", NULL};

double dea_coupon_across(enum dea_coupon_mode mode, double stretch)
{
  return mode == DEA_UNIAXIAL ? 1 / sqrt(stretch) : mode == DEA_PLANAR ? 1 : stretch;
}

double dea_coupon_I1(enum dea_coupon_mode mode, double stretch)
{
  const double l = stretch, l2 = dea_coupon_across(mode, l);
  return l * l + l2 * l2 + 1 / (l * l * l2 * l2);
}

static dea_status find_elastic(const struct dea_material *material, const struct dea_coupon *coupon,
                               double *stress_Pa)
{
  for (size_t i = 0; i < coupon->rows; i++) {
    const double l = coupon->stretch[i];
    struct dea_plane plane;
    DEA_TRY_STATUS(dea_plane_elastic(material, l, dea_coupon_across(coupon->mode, l), &plane));
    stress_Pa[i] = plane.s1;
  }
  return DEA_OK;
}

/* A1 l1 - A3 l3^2/l1, the derivative of A : C/2 along l3 = 1/(l1 l2): C = diag(l1^2, l2^2, l3^2), A
 * = 1 at rest (docs/theory/time.md, section 1). Of A only the entries 1 and 3 are needed. */
static void find_share(const struct dea_coupon *s, double time_s, double *share)
{
  double A1 = 1, A3 = 1, from1 = 1, from3 = 1;
  size_t row = 0;
  struct dea_branch_weights w = {0};
  double length = 0;
  for (size_t n = 0; n < s->node_count; n++) {
    const double l1 = s->node_stretch[n], l12 = l1 * dea_coupon_across(s->mode, l1);
    const double to1 = 1 / (l1 * l1), to3 = l12 * l12;
    const double h = n > 0 ? s->node_s[n] - s->node_s[n - 1] : 0;
    if (n > 0 && h > 0) {
      if (fabs(h - length) > 1e-9 * length) { // equal steps differ by rounding
        w = dea_branch_weights(h, time_s);
        length = h;
      }
      A1 = w.e * A1 + w.w0 * from1 + w.w1 * to1;
      A3 = w.e * A3 + w.w0 * from3 + w.w1 * to3;
    }
    from1 = to1;
    from3 = to3;
    for (; row < s->rows && s->node_of_row[row] == n; row++) {
      share[row] = A1 * l1 - A3 / (to3 * l1);
    }
  }
}

dea_status dea_coupon_shares_build(struct dea_arena *arena, const struct dea_coupon *coupon,
                                   size_t branch_count, struct dea_coupon_shares *out)
{
  *out = (struct dea_coupon_shares){
      .share = dea_arena_alloc(arena, branch_count * coupon->rows, sizeof *out->share)};
  return dea_arena_status(arena);
}

dea_status dea_coupon_stress(const struct dea_material *material, const struct dea_coupon *coupon,
                             struct dea_coupon_shares *shares, double *stress_Pa)
{
  if (material->law == NULL || material->law->anisotropic) {
    return DEA_E_ARGUMENT;
  }
  DEA_TRY_STATUS(find_elastic(material, coupon, stress_Pa));
  for (size_t b = 0; b < material->branch_count && coupon->node_count > 0; b++) {
    const struct dea_branch *branch = &material->branches[b];
    double *share = shares->share + b * coupon->rows;
    if (branch->time_s != shares->time_s[b]) {
      find_share(coupon, branch->time_s, share);
      shares->time_s[b] = branch->time_s;
    }
    for (size_t i = 0; i < coupon->rows; i++) {
      stress_Pa[i] += branch->modulus_Pa * share[i];
    }
  }
  return DEA_OK;
}

/* ---- the way there ---- */

/* Steps of at most 1 % between two stretches. */
static size_t steps_between(double from, double to)
{
  return 1 + (size_t)fmin(ceil(fabs(log(to / from)) / 0.01), 1e5);
}

/* Adds the nodes after (t, l) up to (t_to, l_to). */
static void add_nodes(struct dea_coupon *s, double t, double l, double t_to, double l_to)
{
  const size_t steps = steps_between(l, l_to);
  for (size_t k = 1; k <= steps; k++) {
    const double x = (double)k / (double)steps;
    s->node_s[s->node_count] = k < steps ? t + x * (t_to - t) : t_to;
    s->node_stretch[s->node_count++] = k < steps ? l + x * (l_to - l) : l_to;
  }
}

dea_status dea_coupon_follow(struct dea_arena *arena, const double *time_s, double ramp_s,
                             struct dea_coupon *s)
{
  size_t capacity = 2;
  double l = 1, t = 0;
  for (size_t i = 0; i < s->rows; i++) {
    capacity += 2 + steps_between(l, s->stretch[i]);
    l = s->stretch[i];
  }
  s->node_s = dea_arena_alloc(arena, capacity, sizeof *s->node_s);
  s->node_stretch = dea_arena_alloc(arena, capacity, sizeof *s->node_stretch);
  s->node_of_row = dea_arena_alloc(arena, s->rows, sizeof *s->node_of_row);
  DEA_TRY_MEMORY(!arena->failed);
  l = 1;
  s->node_stretch[0] = 1;
  s->node_count = 1;
  for (size_t i = 0; i < s->rows; i++) {
    const double from_l = l, to = s->stretch[i];
    if (ramp_s > t && ramp_s < time_s[i]) { // held from the ramp's end on
      add_nodes(s, t, from_l, ramp_s, to);
      add_nodes(s, ramp_s, to, time_s[i], to);
    } else {
      add_nodes(s, t, from_l, time_s[i], to);
    }
    t = time_s[i];
    l = to;
    s->node_of_row[i] = s->node_count - 1;
  }
  return DEA_OK;
}

/* ---- stability ---- */

bool dea_coupon_is_stable(const struct dea_material *material, double l1, double l2)
{
  struct dea_plane p;
  if (dea_plane_elastic(material, l1, l2, &p) != DEA_OK) {
    return false;
  }
  // t_i = l_i s_i and d t_i/d ln l_j = l_i l_j k_ij + (i = j) l_i s_i
  const double a = l1 * l1 * p.k11 + l1 * p.s1, b = l2 * l2 * p.k22 + l2 * p.s2;
  const double c = l1 * l2 * p.k12;
  return a > 0 && b > 0 && a * b > c * c;
}
