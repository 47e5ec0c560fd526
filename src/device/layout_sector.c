#include "device/layout_sector.h"

#include <math.h>
#include <string.h>

static const double same = 1e-9;           // of unit vectors
enum { SHIFT_Z = 4, LINES_OF_CIRCLE = 4 }; // lines taken where every one is a line of symmetry

// What has a line ---------------------------------------------------------------------------------

/* The direction of a line, and that across it. */
struct line {
  double along[2], across[2];
};

static struct line line_at(double angle)
{
  const struct line out = {{cos(angle), sin(angle)}, {-sin(angle), cos(angle)}};
  return out;
}

static double dot(const double a[2], const double b[2])
{
  return a[0] * b[0] + a[1] * b[1];
}

static bool along_axis(const struct line *line)
{
  return fabs(line->along[0] * line->along[1]) < same;
}

/* Whether a vector is its own image: nothing of it lies across the line. */
static bool has_vector(const struct line *line, const double v[3])
{
  return fabs(dot(v, line->across)) <= same * hypot(v[0], v[1]);
}

/* The same of a turn or a moment, whose sense a mirror changes along the line. */
static bool has_turn(const struct line *line, const double w[3])
{
  double size = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  return fabs(dot(w, line->along)) <= same * size && fabs(w[2]) <= same * size;
}

static bool has_support(const struct line *line, const struct dea_layout_support *s)
{
  int plane = s->components & 3;
  return has_vector(line, s->move_m) && has_vector(line, s->force_N) &&
         (plane == 0 || plane == 3 || along_axis(line));
}

static bool has_body(const struct line *line, const struct dea_layout_body *b)
{
  return has_vector(line, b->force_N) && has_turn(line, b->moment_N_m) &&
         has_vector(line, b->shift_m) && has_turn(line, b->turn_rad);
}

/* Along a component that keeps the symmetry any spring does; across it one that has no force at
 * rest. */
static bool has_spring(const struct line *line, const struct dea_layout_spring *s)
{
  double v[6] = {0};
  v[s->component] = 1;
  bool keeps = s->component < 3 ? has_vector(line, v) : has_turn(line, v + 3);
  return keeps || (s->count == 0 && s->free_at == 0 && (along_axis(line) || s->component == 5));
}

static bool has_all(const struct dea_layout *l, double angle)
{
  const struct line line = line_at(angle);
  bool has = has_vector(&line, l->gravity_m_per_s2);
  for (size_t i = 0; i < l->support_count; i++) {
    has = has && has_support(&line, &l->supports[i]);
  }
  for (size_t i = 0; i < l->body_count; i++) {
    has = has && has_body(&line, &l->bodies[i]);
  }
  for (size_t i = 0; i < l->spring_count; i++) {
    has = has && has_spring(&line, &l->springs[i]);
  }
  return has;
}

// The sector --------------------------------------------------------------------------------------

struct dea_layout_sector dea_layout_sector_of(const struct dea_layout *l)
{
  struct dea_layout_sector out = {0};
  const struct dea_symmetry *s = &l->symmetry;
  bool round = s->order == 0;
  size_t candidates = round ? LINES_OF_CIRCLE : s->mirrors, lines = 0;
  if (!l->symmetry_found) {
    return out;
  }
  memcpy(out.centre_m, s->centre_m, sizeof out.centre_m);
  for (size_t i = 0; i < candidates; i++) {
    double angle =
        round ? DEA_PI * (double)i / LINES_OF_CIRCLE : s->mirror_rad + (double)i * s->step_rad;
    if (has_all(l, angle)) {
      out.angle_rad = lines == 0 ? angle : out.angle_rad;
      lines++;
    }
  }
  for (int fold = 1; fold <= DEA_LAYOUT_FOLD_MAX; fold++) { // lines are evenly apart
    out.fold = lines > 0 && lines % (size_t)fold == 0 ? fold : out.fold;
  }
  const struct line line = line_at(out.angle_rad);
  bool slanted_body = out.fold == 1 && l->body_count > 0 && !along_axis(&line);
  out.fold = slanted_body ? 0 : out.fold; // what it may do is no set of its components
  return out;
}

size_t dea_layout_sector_copies(const struct dea_layout_sector *sector)
{
  return sector->fold > 0 ? 2 * (size_t)sector->fold : 1;
}

struct dea_motion dea_layout_sector_copy(const struct dea_layout_sector *sector, size_t number)
{
  const size_t pair = number / 2;
  double turn = sector->fold > 0 ? DEA_PI * (double)pair / sector->fold : 0;
  // a turn by t after a mirror at an angle is a mirror at t/2 more
  return number % 2 == 1 ? dea_motion_mirror(sector->centre_m, sector->angle_rad + turn)
                         : dea_motion_rotation(sector->centre_m, 2 * turn);
}

void dea_layout_sector_turn(const struct dea_motion *copy, const double v[2], double out[2])
{
  double x = v[0], y = copy->mirrored ? -v[1] : v[1];
  out[0] = copy->cosine * x - copy->sine * y;
  out[1] = copy->sine * x + copy->cosine * y;
}

void dea_layout_sector_region(const struct dea_layout_sector *sector, double reach_m,
                              struct dea_region *out)
{
  enum { STEPS = 3 };
  struct dea_vertex corner[STEPS + 2];
  size_t count = 0;
  for (int i = 0; i <= STEPS; i++) {
    double angle = sector->angle_rad + i * DEA_PI / (STEPS * sector->fold);
    corner[count++] = (struct dea_vertex){.x_m = sector->centre_m[0] + reach_m * cos(angle),
                                          .y_m = sector->centre_m[1] + reach_m * sin(angle)};
  }
  if (sector->fold > 1) { // of one line the first and the last corner lie on both sides of it
    corner[count++] = (struct dea_vertex){.x_m = sector->centre_m[0], .y_m = sector->centre_m[1]};
  }
  dea_region_add(out, corner, count);
}

int dea_layout_sector_keeps(const struct dea_layout_sector *sector)
{
  enum { ALL = 63, SHIFT_X = 1, SHIFT_Y = 2, TURN_X = 8, TURN_Y = 16 };
  bool along_x = fabs(sin(sector->angle_rad)) < 0.5;
  switch (sector->fold) {
  case 0:
    return ALL;
  case 1:
    return along_x ? SHIFT_Z | SHIFT_X | TURN_Y : SHIFT_Z | SHIFT_Y | TURN_X;
  default:
    return SHIFT_Z;
  }
}

int dea_layout_sector_holds(const struct dea_layout_sector *sector, const double x_m[2],
                            double near_m, double Q[9])
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double from[2] = {x_m[0] - sector->centre_m[0], x_m[1] - sector->centre_m[1]};
  int held = 0;
  memcpy(Q, one, sizeof one);
  for (int side = 0; side < 2 && sector->fold > 0; side++) {
    const struct line line = line_at(sector->angle_rad + side * DEA_PI / sector->fold);
    if (fabs(dot(from, line.across)) > near_m) {
      continue;
    }
    if (held != 0 && sector->fold > 1) { // the tip lies on both
      memcpy(Q, one, sizeof one);
      return 3;
    }
    if (along_axis(&line)) {
      held = fabs(line.along[0]) > 0.5 ? 2 : 1;
    } else {
      memcpy(
          Q,
          (double[9]){line.across[0], line.across[1], 0, line.along[0], line.along[1], 0, 0, 0, 1},
          9 * sizeof *Q);
      // right-handed or not does not matter: the axes are orthonormal
      held = 1;
    }
  }
  return held;
}
