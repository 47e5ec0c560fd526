/* Blocks and plies of a plate. In a sector the lines l = 0, 1, ... go from the core to the frame:
 *
 *     polar blocks     between two circles, and between two lines or across a fibre
 *     ring blocks      from the outline of the core to the first circle
 *     core             one quadrilateral O A G B a wedge, O the centre, A and B on the wedge's
 *                      edges, G between them: three blocks meet at G, and none has an angle of 0 or
 *                      180 degrees however thin the wedge is
 *
 * A sector of more than 90 degrees (one fibre) has two wedges.
 *
 * Symbol   meaning                                                              unit
 * l        place between the first line (0: fibre axis) and the last (count)    1
 * alpha    angle of a sector, pi/N                                              rad */
#include "model/solid/mesh/fibre_disc.h"

#include "base/context.h"
#include "model/solid/mesh/cuts.h"

#include <math.h>
#include <string.h>

enum {
  CIRCLES_MAX = 4,
  WEDGES_MAX = 2,
  RINGS_MAX = 2 * WEDGES_MAX,
  POLARS_MAX = 2 * (CIRCLES_MAX - 1)
};
enum { SECTOR_BLOCKS_MAX = WEDGES_MAX + RINGS_MAX + POLARS_MAX };

static const double same = 1e-9;       // of the frame's radius: one place
static const double free_share = 0.99; // of a sector that fibres may take where they begin

double dea_fibre_disc_angle(const struct dea_fibre_disc *plate)
{
  return plate->sectors * DEA_PI / (plate->fibres > 0 ? plate->fibres : 4);
}

int dea_fibre_disc_sectors(const struct dea_fibre_disc *plate)
{
  return 2 * (plate->fibres > 0 ? plate->fibres : 4);
}

/* ---- lines from the core outwards, and the circles that they cross ---- */

struct lines {
  const struct dea_fibre_disc *plate; // lent
  double alpha;
  size_t across;              // elements across half a fibre, 0 without fibres
  size_t count;               // elements between the first line and the last
  double wider;               // beside a fibre: the last over the first of them, its logarithm
  double circle[CIRCLES_MAX]; // radii, ascending: the last is the frame
  size_t circle_count;
};

/* Half the angle that a fibre takes where its long edge, a straight line from its tip to its outer
 * end, crosses a circle; inside the tip and beyond the outer end the line goes on to the centre. */
static double fibre_angle(const struct dea_fibre_disc *p, double radius)
{
  double y1 = 0.5 * p->tip_width, x1 = sqrt(p->tip_radius * p->tip_radius - y1 * y1);
  double y2 = 0.5 * p->outer_width, x2 = sqrt(p->outer_radius * p->outer_radius - y2 * y2);
  if (radius <= p->tip_radius) {
    return atan2(y1, x1);
  }
  if (radius >= p->outer_radius) {
    return atan2(y2, x2);
  }
  // |P1 + t (P2 - P1)| = radius, the larger root: from P1 on outwards
  double dx = x2 - x1, dy = y2 - y1, a = dx * dx + dy * dy, b = x1 * dx + y1 * dy;
  double c = x1 * x1 + y1 * y1 - radius * radius;
  double t = -c / (b + sqrt(b * b - a * c));
  return atan2(y1 + t * dy, x1 + t * dx);
}

/* Share of the angle beside a fibre up to a line, counted from its edge: even or growing by the
 * same factor from element to element, and even within each. */
static double part_beside(const struct lines *lines, double l)
{
  double count = (double)(lines->count - lines->across), whole = floor(l);
  if (!(lines->wider > 0)) {
    return l / count;
  }
  double low = expm1(lines->wider * whole / count),
         high = expm1(lines->wider * (whole + 1) / count);
  return (low + (l - whole) * (high - low)) / expm1(lines->wider);
}

/* Angle at which the line l crosses the circle of that radius. */
static double line_angle(const struct lines *lines, double l, double radius)
{
  double across = (double)lines->across;
  double edge = lines->across > 0 ? fibre_angle(lines->plate, radius) : 0;
  if (l <= across && lines->across > 0) { // equal parts of the width
    return asin(sin(edge) * l / across);
  }
  return edge + (lines->alpha - edge) * part_beside(lines, l - across);
}

/* The place itself. */
static void line_point(const struct lines *lines, double l, double radius, double x[2])
{
  double angle = line_angle(lines, l, radius);
  x[0] = radius * cos(angle);
  x[1] = radius * sin(angle);
}

static void add_circle(struct lines *lines, double radius)
{
  size_t at = lines->circle_count;
  for (size_t i = 0; i < lines->circle_count; i++) {
    if (fabs(lines->circle[i] - radius) <= same * lines->plate->frame_radius) {
      return;
    }
  }
  for (; at > 0 && lines->circle[at - 1] > radius; at--) {
    lines->circle[at] = lines->circle[at - 1];
  }
  lines->circle[at] = radius;
  lines->circle_count++;
}

static dea_status check_disc(struct dea_context *ctx, const struct dea_fibre_disc *p)
{
  double frame = p->frame_radius, N = p->fibres > 0 ? p->fibres : 4;
  if (!(p->electrode_radius > 0 && p->electrode_radius < frame && p->film_thickness >= 0 &&
        p->size > 0 && p->edge > 0) ||
      p->fibres < 0 || p->through > DEA_FIBRE_DISC_THROUGH_MAX || p->sectors < 1 ||
      p->sectors > dea_fibre_disc_sectors(p)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the mesh of a plate takes an electrode inside the frame");
  }
  if (p->fibres == 0) {
    return DEA_OK;
  }
  double capacity = fmin(DEA_PI / N, 0.5 * DEA_PI);
  bool fit = p->tip_radius > 0 && p->outer_radius > p->tip_radius * (1 + same) &&
             p->outer_radius <= frame * (1 + same) && p->tip_width > 0 && p->outer_width > 0 &&
             p->tip_width < 2 * p->tip_radius && p->outer_width < 2 * p->outer_radius &&
             p->fibre_thickness > 0;
  if (!fit || !(asin(0.5 * p->tip_width / p->tip_radius) <= free_share * capacity) ||
      !(asin(0.5 * p->outer_width / p->outer_radius) <= free_share * capacity)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the mesh of a plate takes fibres that lie between centre and frame and leave "
                    "at least %.0f %% of the film between them",
                    100 * (1 - free_share));
  }
  return DEA_OK;
}

/* Elements of about `size` in a length, at least one. */
static size_t share(double length, double size)
{
  double count = floor(length / size + 0.5);
  return count > DEA_FIBRE_DISC_LINE_MAX ? DEA_FIBRE_DISC_LINE_MAX + 1
         : count > 1                     ? (size_t)count
                                         : 1;
}

static double finer_at_tips(const struct dea_fibre_disc *p)
{
  return p->fibres > 0 && p->finer_at_tips > 1 ? p->finer_at_tips : 1;
}

/* Elements beside a fibre in a length, of one size or growing from one that is `finer`. */
static size_t share_beside(double length, double size, double finer)
{
  return share(length, finer > 1 ? size * (1 - 1 / finer) / log(finer) : size);
}

/* Elements along the electrode's edge from a fibre to the line halfway to the next one. */
static size_t share_between(const struct dea_fibre_disc *p)
{
  double a = p->electrode_radius, rest = dea_fibre_disc_angle(p) / p->sectors - fibre_angle(p, a);
  return share_beside(rest * a, p->beside > 0 ? p->beside : p->size, finer_at_tips(p));
}

static dea_status too_many(struct dea_context *ctx)
{
  return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh takes at most %d elements in a row",
                  DEA_FIBRE_DISC_LINE_MAX);
}

static dea_status lines_create(struct dea_context *ctx, const struct dea_fibre_disc *p,
                               struct lines *out)
{
  DEA_TRY(ctx, check_disc(ctx, p));
  *out = (struct lines){.plate = p, .alpha = dea_fibre_disc_angle(p) / p->sectors};
  double a = p->electrode_radius, finer = finer_at_tips(p);
  add_circle(out, a);
  add_circle(out, p->frame_radius);
  if (p->fibres > 0) {
    add_circle(out, p->tip_radius);
    add_circle(out, p->outer_radius);
    double width = fmax(p->tip_width, p->outer_width);
    // fibres are stiff and bend: half the size
    out->across = share(0.5 * width, 0.5 * p->size / finer);
  }
  out->wider = log(finer);
  out->count = out->across + (p->fibres > 0 ? share_between(p) : share(out->alpha * a, p->size));
  size_t least = out->alpha > 0.51 * DEA_PI ? 4 : 2; // two for each wedge of the core
  out->count = out->count < least ? least : out->count;
  return out->count > DEA_FIBRE_DISC_LINE_MAX ? too_many(ctx) : DEA_OK;
}

/* ---- maps of one sector ---- */

/* Between two circles and two lines, straight from circle to circle. */
struct polar {
  const struct lines *lines;
  double inner, outer, from, to; // radii, lines
};

static void map_polar(const void *self, double s, double t, double x[2])
{
  const struct polar *b = self;
  double l = b->from + t * (b->to - b->from), in[2], out[2];
  line_point(b->lines, l, b->inner, in);
  line_point(b->lines, l, b->outer, out);
  x[0] = (1 - s) * in[0] + s * out[0];
  x[1] = (1 - s) * in[1] + s * out[1];
}

/* From a straight edge of the core to the first circle. */
struct ring {
  const struct lines *lines;
  double from, to; // lines
  double start[2], end[2];
};

static void map_ring(const void *self, double s, double t, double x[2])
{
  const struct ring *b = self;
  double out[2];
  line_point(b->lines, b->from + t * (b->to - b->from), b->lines->circle[0], out);
  for (int i = 0; i < 2; i++) {
    x[i] = (1 - s) * ((1 - t) * b->start[i] + t * b->end[i]) + s * out[i];
  }
}

/* Quadrilateral O A G B: s along O A, t along O B. */
struct core {
  double A[2], G[2], B[2];
};

static void map_core(const void *self, double s, double t, double x[2])
{
  const struct core *b = self;
  for (int i = 0; i < 2; i++) {
    x[i] = s * (1 - t) * b->A[i] + s * t * b->G[i] + (1 - s) * t * b->B[i];
  }
}

/* ---- the sectors of the domain ---- */

/* A block in the k-th sector: turned there, or mirrored (and its axes swapped, so that it keeps its
 * sense). */
struct copy {
  const struct dea_block *block;
  double turn;
  bool mirrored;
};

static void map_copy(const void *self, double s, double t, double x[2])
{
  const struct copy *c = self;
  double at[2], cosine = cos(c->turn), sine = sin(c->turn);
  c->block->map(c->block->self, c->mirrored ? t : s, c->mirrored ? s : t, at);
  double y = c->mirrored ? -at[1] : at[1];
  x[0] = cosine * at[0] - sine * y;
  x[1] = sine * at[0] + cosine * y;
}

static struct dea_block copied(const struct dea_block *block, const struct copy *copy)
{
  struct dea_block out = *block;
  out.map = map_copy;
  out.self = copy;
  if (copy->mirrored) {
    out.cuts_s = block->cuts_t;
    out.cuts_t = block->cuts_s;
    out.count_s = block->count_t;
    out.count_t = block->count_s;
  }
  return out;
}

/* ---- building ---- */

struct builder {
  struct lines lines; // where nodes lie
  struct lines cuts;  // of the plate that says how many elements there are and where lines are cut
  struct polar polars[POLARS_MAX];
  struct ring rings[RINGS_MAX];
  struct core cores[WEDGES_MAX];
  double even[DEA_FIBRE_DISC_LINE_MAX + 1][DEA_FIBRE_DISC_LINE_MAX + 1]; // [count]: its even cuts
  double radial[CIRCLES_MAX][DEA_FIBRE_DISC_LINE_MAX + 1];
  struct dea_block blocks[SECTOR_BLOCKS_MAX];
  size_t polar_count, ring_count, core_count, block_count;
};

/* Cuts of [0, 1] into `count` equal parts. */
static const double *even_cuts(struct builder *b, size_t count)
{
  for (size_t i = 0; i <= count; i++) {
    b->even[count][i] = (double)i / (double)count;
  }
  return b->even[count];
}

static void add_block(struct builder *b, void (*map)(const void *, double, double, double[2]),
                      const void *self, const double *cuts_s, size_t count_s, size_t count_t,
                      int region)
{
  b->blocks[b->block_count++] =
      (struct dea_block){map, self, cuts_s, even_cuts(b, count_t), count_s, count_t, region};
}

/* Size of elements at a circle: fine where something ends there. */
static double size_at(const struct dea_fibre_disc *p, double radius)
{
  double close = same * p->frame_radius, edge = fmin(p->edge, p->size);
  bool electrode = fabs(radius - p->electrode_radius) < close;
  bool tip = p->fibres > 0 && fabs(radius - p->tip_radius) < close;
  bool outer_end =
      p->fibres > 0 && fabs(radius - p->outer_radius) < close && radius < p->frame_radius - close;
  if (electrode && p->fringe > 0) {
    edge = fmin(p->fringe, edge);
  }
  return electrode || tip ? edge / finer_at_tips(p) : outer_end ? edge : 2 * p->size;
}

/* Cuts between two circles of which the inner has elements of that size; the number of them. */
static size_t cut_between(const struct dea_fibre_disc *p, double inner, double outer, double first,
                          double *cuts)
{
  double close = same * p->frame_radius, tip = p->fibres > 0 ? p->tip_radius : 0;
  double finer = outer < fmax(p->electrode_radius, tip) + close ? finer_at_tips(p) : 1;
  double widest = outer < p->electrode_radius + close ? p->size : 2 * p->size;
  return dea_cuts_graded(outer - inner, first, size_at(p, outer), exp2(1 / finer), widest / finer,
                         DEA_FIBRE_DISC_LINE_MAX, cuts);
}

/* Between the circles i and i + 1: a block across the fibre and one between fibres. */
static dea_status add_polars(struct dea_context *ctx, struct builder *b, size_t i)
{
  const struct lines *lines = &b->lines;
  const struct dea_fibre_disc *p = b->cuts.plate;
  double inner = b->cuts.circle[i], outer = b->cuts.circle[i + 1], close = same * p->frame_radius;
  bool electrode = outer < p->electrode_radius + close;
  size_t count = cut_between(p, inner, outer, size_at(p, inner), b->radial[i]);
  if (count == 0) {
    return too_many(ctx);
  }
  bool fibre = p->fibres > 0 && inner > p->tip_radius - close && outer < p->outer_radius + close;
  double ends[3] = {0, (double)lines->across, (double)lines->count};
  for (int k = lines->across > 0 ? 0 : 1; k < 2; k++) {
    struct polar *polar = &b->polars[b->polar_count++];
    *polar = (struct polar){lines, lines->circle[i], lines->circle[i + 1], ends[k], ends[k + 1]};
    add_block(b, map_polar, polar, b->radial[i], count, (size_t)(ends[k + 1] - ends[k]),
              (electrode ? DEA_FIBRE_DISC_ELECTRODE : 0) |
                  (fibre && k == 0 ? DEA_FIBRE_DISC_FIBRE : 0));
  }
  return DEA_OK;
}

/* The wedge between the lines from and to; its edge A has `along` elements from O. rho: distance of
 * A and B from O; cuts: of the rings. */
static void add_wedge(struct builder *b, size_t from, size_t to, size_t along, double rho,
                      const double *cuts, size_t count)
{
  const struct lines *lines = &b->lines;
  size_t middle = to - along;
  double first = lines->circle[0], angle[3] = {line_angle(lines, (double)from, first),
                                               line_angle(lines, (double)middle, first),
                                               line_angle(lines, (double)to, first)};
  // far enough out that the corner at G is as open in a thin wedge as in a wide one
  double far = rho * fmax(1.1, 1.4 * cos(0.5 * (angle[2] - angle[0])));
  struct core *core = &b->cores[b->core_count++];
  *core = (struct core){{rho * cos(angle[0]), rho * sin(angle[0])},
                        {far * cos(angle[1]), far * sin(angle[1])},
                        {rho * cos(angle[2]), rho * sin(angle[2])}};
  for (int k = 0; k < 2; k++) {
    const double *start = k == 0 ? core->A : core->G, *end = k == 0 ? core->G : core->B;
    size_t begins = k == 0 ? from : middle, ends = k == 0 ? middle : to;
    struct ring *ring = &b->rings[b->ring_count++];
    *ring =
        (struct ring){lines, (double)begins, (double)ends, {start[0], start[1]}, {end[0], end[1]}};
    add_block(b, map_ring, ring, cuts, count, ends - begins, DEA_FIBRE_DISC_ELECTRODE);
  }
  add_block(b, map_core, core, even_cuts(b, to - middle), to - middle, middle - from,
            DEA_FIBRE_DISC_ELECTRODE);
}

/* The line of a wedge that its corner is on: that in the middle by number or, where lines are not
 * evenly apart, by angle. */
static size_t middle_line(const struct lines *lines)
{
  size_t line = lines->count - lines->count / 2;
  while (lines->wider > 0 && line + 1 < lines->count &&
         line_angle(lines, (double)line + 0.5, lines->circle[0]) < 0.5 * lines->alpha) {
    line++;
  }
  return line;
}

/* Everything inside the first circle, which is that of the electrodes or of the tips on them. */
static dea_status add_inside(struct dea_context *ctx, struct builder *b)
{
  const struct lines *lines = &b->cuts;
  const struct dea_fibre_disc *p = lines->plate;
  double first = lines->circle[0], *cuts = b->radial[CIRCLES_MAX - 1];
  bool one = lines->alpha <= 0.51 * DEA_PI;
  double part = fmin(1, lines->alpha / (one ? 1 : 2) / (0.25 * DEA_PI));
  double rho = 0.55 * b->lines.circle[0] * part;
  size_t count = cut_between(p, 0.55 * first * part, first, p->size / finer_at_tips(p), cuts);
  if (count == 0) {
    return too_many(ctx);
  }
  if (one) {
    add_wedge(b, 0, lines->count, lines->count - middle_line(lines), rho, cuts, count);
    return DEA_OK;
  }
  size_t half = 2; // the line nearest to half the angle; two lines at least on both sides
  while (half + 2 < lines->count &&
         line_angle(lines, (double)half + 0.5, first) < 0.5 * lines->alpha) {
    half++;
  }
  size_t shared = (half < lines->count - half ? half : lines->count - half) / 2;
  add_wedge(b, 0, half, half - shared, rho, cuts, count);
  add_wedge(b, half, lines->count, shared, rho, cuts, count);
  return DEA_OK;
}

/* Copies the blocks of the first sector into all of the domain. */
static dea_status spread(struct dea_context *ctx, const struct builder *b,
                         struct dea_plane_mesh **out)
{
  const struct dea_fibre_disc *p = b->lines.plate;
  size_t count = b->block_count * (size_t)p->sectors;
  struct dea_arena memory = {.ctx = ctx};
  struct copy *copies = dea_arena_alloc(&memory, count, sizeof *copies);
  struct dea_block *blocks = dea_arena_alloc(&memory, count, sizeof *blocks);
  dea_status status = dea_arena_status(&memory);
  for (size_t i = 0; i < count && status == DEA_OK; i++) {
    size_t sector = i / b->block_count;
    bool mirrored = sector % 2 == 1;
    copies[i] = (struct copy){&b->blocks[i % b->block_count],
                              b->lines.alpha * (double)(sector + mirrored), mirrored};
    blocks[i] = copied(copies[i].block, &copies[i]);
  }
  status = status == DEA_OK ? dea_blocks_mesh(ctx, p->order, blocks, count, p->frame_radius, out)
                            : status;
  dea_arena_free(&memory);
  return status;
}

/* Which of the ends of the fibres lie inside the electrode circle, as bits. */
static int inside(const struct dea_fibre_disc *p)
{
  double edge = p->electrode_radius - same * p->frame_radius;
  return p->fibres == 0 ? 0 : (p->tip_radius < edge ? 1 : 0) | (p->outer_radius < edge ? 2 : 0);
}

/* Whether the parts of two plates are the same ones in the same order from the centre. */
static bool alike(const struct lines *a, const struct lines *b)
{
  const struct dea_fibre_disc *p = a->plate, *q = b->plate;
  return p->order == q->order && p->order_z == q->order_z && p->fibres == q->fibres &&
         p->through == q->through && p->membrane == q->membrane && p->sectors == q->sectors &&
         p->end == q->end && inside(p) == inside(q) && a->circle_count == b->circle_count;
}

static dea_status build(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                        const struct dea_fibre_disc *like, struct builder *b,
                        struct dea_plane_mesh **out)
{
  DEA_TRY(ctx, lines_create(ctx, plate, &b->lines));
  DEA_TRY(ctx, lines_create(ctx, like, &b->cuts));
  if (!alike(&b->lines, &b->cuts)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "the mesh of a plate cannot be moved to one whose parts lie otherwise");
  }
  b->lines.across = b->cuts.across;
  b->lines.count = b->cuts.count;
  b->lines.wider = b->cuts.wider;
  DEA_TRY(ctx, add_inside(ctx, b));
  for (size_t i = 0; i + 1 < b->lines.circle_count; i++) {
    DEA_TRY(ctx, add_polars(ctx, b, i));
  }
  return DEA_CHAIN(ctx, spread(ctx, b, out));
}

dea_status dea_fibre_disc_plane(struct dea_context *ctx, const struct dea_fibre_disc *plate,
                                const struct dea_fibre_disc *like, struct dea_plane_mesh **out)
{
  *out = NULL;
  struct builder *b = dea_alloc(ctx, 1, sizeof *b);
  DEA_TRY_MEMORY(b != NULL);
  dea_status status = build(ctx, plate, like, b, out);
  dea_free(ctx, b);
  return DEA_CHAIN(ctx, status);
}

/* ---- supports ---- */

int dea_fibre_disc_edges(const struct dea_fibre_disc *p, const double X[3])
{
  double close = same * p->frame_radius, beta = dea_fibre_disc_angle(p);
  if (p->sectors == dea_fibre_disc_sectors(p)) {
    return 0;
  }
  bool centre = hypot(X[0], X[1]) < close;
  bool first = centre || (fabs(X[1]) < close && X[0] > 0);
  double across = -sin(beta) * X[0] + cos(beta) * X[1], along = cos(beta) * X[0] + sin(beta) * X[1];
  bool last = centre || (fabs(across) < close && along > 0);
  return (first ? 1 : 0) | (last ? 2 : 0);
}
