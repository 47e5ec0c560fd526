/* A script of lines and arcs is written, in mm. Each contour is a surface of its own there, and
 * boolean fragments cut them along each other's edges, so the mesh conforms; what is a hole or
 * outside is taken away afterwards, by where the elements' middles are. Sizes come from distances
 * to points along the fine edges, whose numbers the fragments do not change. */
#include "model/solid/mesh/gmsh.h"

#include "base/arena.h"
#include "base/context.h"
#include "base/file.h"
#include "base/program.h"
#include "base/text.h"
#include "base/whole.h"
#include "base/write_file.h"
#include "model/solid/mesh/edge_layers.h"
#include "model/solid/mesh/msh_read.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LINES_SAID = 6, SAMPLES_MAX = 20000, LATTICE = 300 };
#define SIZES_FILE "sizes.txt"
static const double mm = 1e3, unit_m = 1e-3; // of the script
static const double near = 1e-6;             // of the mesh's size: a node on a contour

// Shapes ------------------------------------------------------------------------------------------

static bool is_inside(const struct dea_gmsh_shape *shape, const double x[2])
{
  bool inside = false;
  for (size_t k = 0; k < shape->count; k++) {
    inside = inside != dea_contour_inside(&shape->contours[k], x[0], x[1]);
  }
  return inside;
}

static double distance_to(const struct dea_gmsh_shape *shape, const double x[2])
{
  double least = INFINITY;
  for (size_t k = 0; k < shape->count; k++) {
    least = fmin(least, dea_contour_distance_m(&shape->contours[k], x));
  }
  return least;
}

/* A curve, by its number: those of the shapes come first. */
static const struct dea_gmsh_shape *curve_of(const struct dea_gmsh_plan *plan, size_t curve)
{
  return curve < plan->shape_count ? &plan->shapes[curve]
                                   : &plan->curves[curve - plan->shape_count];
}

// The script --------------------------------------------------------------------------------------

/* Ways to quadrilaterals, each for where the one before it leaves triangles or bad elements. Tried
 * with Gmsh 4.8.4: blossom is best where it works; its full-quad form leaves slivers here and
 * there; triangles of twice the size, divided in three, work where arcs are fine enough that no
 * triangle has two sides on one, with more elements for the same; where a thin crescent is left
 * between an arc and another edge, elements have to be as short as it is thin. curvature: elements
 * to a full turn. */
static const struct recipe {
  int recombine, algorithm, subdivision, curvature;
  double size;
} recipes[] = {
    {1, 1, 0, 12, 1}, {1, 3, 0, 12, 1}, {0, 1, 1, 20, 2}, {0, 1, 1, 40, 1}, {0, 1, 1, 80, 1}};
enum { RECIPES = sizeof recipes / sizeof recipes[0] };
static const double good_jacobian = 0.2; // smallest Jacobian with which another way is not tried

static void write_settings(struct dea_text *out, const struct dea_gmsh_plan *plan,
                           const struct recipe *recipe)
{
  dea_text_add(
      out,
      "SetFactory(\"OpenCASCADE\");\nGeneral.Terminal = 1;\nMesh.Binary = 0;\n"
      "Mesh.MshFileVersion = 4.1;\nMesh.SaveAll = 0;\nMesh.SaveParametric = 0;\n"
      "Mesh.Algorithm = 6;\nMesh.RecombineAll = %d;\nMesh.RecombinationAlgorithm = %d;\n"
      "Mesh.SubdivisionAlgorithm = %d;\nMesh.ElementOrder = %d;\n"
      "Mesh.SecondOrderLinear = 0;\nMesh.SecondOrderIncomplete = 0;\n"
      "Mesh.MeshSizeExtendFromBoundary = 0;\nMesh.MeshSizeFromPoints = 0;\n"
      "Mesh.MeshSizeFromCurvature = %d;\nMesh.MeshSizeMin = 0;\nMesh.MeshSizeMax = %.10g;\n",
      recipe->recombine, recipe->algorithm, recipe->subdivision, plan->order, recipe->curvature,
      mm * plan->size_m * recipe->size);
}

/* Numbers of what was written last; decimals: of coordinates. */
struct numbers {
  size_t point, curve, surface;
  int decimals;
};

/* Digits after the point, to 1e-10 of an element: gmsh meshes equal shapes in different ways when
 * their last bits differ, as those of one shape do that was moved or read from a file. */
static int decimals_of(const struct dea_gmsh_plan *plan)
{
  return dea_whole(10 - floor(log10(mm * plan->size_m)), 0, 300);
}

static void write_place(struct dea_text *out, int decimals, const double x[2])
{
  double rounded[2], unit = pow(10, -decimals);
  for (int i = 0; i < 2; i++) { // never -0
    rounded[i] = fabs(mm * x[i]) < 0.5 * unit ? 0 : mm * x[i];
  }
  dea_text_add(out, "{%.*f, %.*f, 0}", decimals, rounded[0], decimals, rounded[1]);
}

static void write_point(struct dea_text *out, struct numbers *last, const double x[2])
{
  dea_text_add(out, "Point(%zu) = ", ++last->point);
  write_place(out, last->decimals, x);
  dea_text_add(out, ";\n");
}

/* The curves of a piece, from the last point written to the point `to` (0: one that is made). An
 * arc is written in parts of at most a quarter: OpenCASCADE takes the shorter way. */
static void write_piece(struct dea_text *out, struct numbers *last, const struct dea_piece *piece,
                        size_t to)
{
  int parts = piece->arc ? (int)ceil(fabs(piece->sweep) / (0.5 * DEA_PI) - 1e-9) : 1;
  size_t from = last->point, centre = 0;
  if (piece->arc) {
    write_point(out, last, piece->centre);
    centre = last->point;
  }
  for (int k = 1; k <= parts; k++) {
    double x[2];
    size_t next = k == parts && to != 0 ? to : last->point + 1;
    dea_piece_point(piece, (double)k / parts, x);
    if (next == last->point + 1) {
      write_point(out, last, k == parts ? piece->to : x);
    }
    if (centre != 0) {
      dea_text_add(out, "Circle(%zu) = {%zu, %zu, %zu};\n", ++last->curve, from, centre, next);
    } else {
      dea_text_add(out, "Line(%zu) = {%zu, %zu};\n", ++last->curve, from, next);
    }
    from = next;
  }
}

/* A contour as a surface. */
static void write_contour(struct dea_text *out, struct numbers *last,
                          const struct dea_contour *contour)
{
  size_t count = dea_contour_pieces(contour), curve = last->curve + 1, first;
  const struct dea_piece start = dea_contour_piece(contour, 0);
  write_point(out, last, start.from);
  first = last->point;
  for (size_t i = 0; i < count; i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    write_piece(out, last, &piece, i + 1 == count ? first : 0);
  }
  last->surface++;
  dea_text_add(out, "Curve Loop(%zu) = {%zu:%zu};\nPlane Surface(%zu) = {%zu};\n", last->surface,
               curve, last->curve, last->surface, last->surface);
}

/* A field of sizes that grow from `fine` at the contours; its number is twice `source`. Distances
 * are those to points half a fine element apart. */
static void write_field(struct dea_text *out, const struct dea_gmsh_plan *plan,
                        const struct dea_gmsh_shape *shape, size_t source,
                        const struct recipe *recipe)
{
  double fine = shape->edge_size_m, step = 0.5 * fine, scale = mm * recipe->size;
  double growth = plan->growth > 0 ? plan->growth : 0.4;
  double length = 0;
  for (size_t k = 0; k < shape->count; k++) {
    length += dea_contour_length_m(&shape->contours[k]);
  }
  step = fmax(step, length / SAMPLES_MAX);
  dea_text_add(out, "p = newp;\nn = 0;\n");
  for (size_t k = 0; k < shape->count; k++) {
    for (size_t i = 0; i < dea_contour_pieces(&shape->contours[k]); i++) {
      const struct dea_piece piece = dea_contour_piece(&shape->contours[k], i);
      int parts = dea_whole(ceil(piece.length_m / step - 1e-9), 0, SAMPLES_MAX) + 1;
      for (int j = 0; j <= parts; j++) {
        double x[2];
        dea_piece_point(&piece, (double)j / parts, x);
        dea_text_add(out, "Point(p + n) = ");
        write_place(out, decimals_of(plan), x);
        dea_text_add(out, "; n++;\n");
      }
    }
  }
  dea_text_add(out,
               "Field[%zu] = Distance;\nField[%zu].PointsList = {p:p + n - 1};\n"
               "Field[%zu] = Threshold;\nField[%zu].IField = %zu;\nField[%zu].LcMin = %.10g;\n"
               "Field[%zu].LcMax = %.10g;\nField[%zu].DistMin = %.10g;\nField[%zu].DistMax = "
               "%.10g;\n",
               2 * source - 1, 2 * source - 1, 2 * source, 2 * source, 2 * source - 1, 2 * source,
               scale * fine, 2 * source, scale * plan->size_m, 2 * source, mm * fine, 2 * source,
               mm * (fine + fmax(plan->size_m - fine, 1e-3 * fine) / growth));
}

/* The smallest of the plan's sizes as they grow away from their places. */
static double size_at(const struct dea_gmsh_plan *plan, double growth, double x, double y)
{
  double least = INFINITY;
  for (size_t i = 0; i < plan->size_count; i++) {
    const double *at = plan->sizes[i];
    double away = hypot(x - at[0], y - at[1]) - 0.5 * at[2];
    least = fmin(least, at[2] + growth * fmax(0, away));
  }
  return least;
}

/* The sizes on a lattice of points around all of them, which gmsh interpolates: its file. */
static void write_sizes(struct dea_text *out, const struct dea_gmsh_plan *plan,
                        const struct recipe *recipe)
{
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, largest = 0;
  double growth = plan->growth > 0 ? plan->growth : 0.4;
  for (size_t i = 0; i < plan->size_count; i++) {
    largest = fmax(largest, plan->sizes[i][2]);
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], plan->sizes[i][k]);
      high[k] = fmax(high[k], plan->sizes[i][k]);
    }
  }
  double step = (fmax(high[0] - low[0], high[1] - low[1]) + 2 * largest) / LATTICE;
  int count[2];
  for (int k = 0; k < 2; k++) {
    low[k] -= largest;
    count[k] = (int)ceil((high[k] + largest - low[k]) / step) + 1;
  }
  dea_text_add(out, "%.10g %.10g 0\n%.10g %.10g 1\n%d %d 1\n", mm * low[0], mm * low[1], mm * step,
               mm * step, count[0], count[1]);
  for (int i = 0; i < count[0]; i++) {
    for (int j = 0; j < count[1]; j++) {
      double size = size_at(plan, growth, low[0] + i * step, low[1] + j * step);
      dea_text_add(out, "%.6g\n", mm * recipe->size * size);
    }
  }
}

static void write_fields(struct dea_text *out, const struct dea_gmsh_plan *plan,
                         const struct recipe *recipe)
{
  size_t sources = 0;
  if (plan->size_count > 0) {
    dea_text_add(out, "Field[1] = Structured;\nField[1].FileName = \"" SIZES_FILE "\";\n"
                      "Field[1].TextFormat = 1;\nBackground Field = 1;\n");
    return;
  }
  for (size_t i = 0; i < plan->shape_count + plan->curve_count; i++) {
    if (curve_of(plan, i)->edge_size_m > 0) {
      write_field(out, plan, curve_of(plan, i), ++sources, recipe);
    }
  }
  if (sources > 0) {
    dea_text_add(out, "Field[%zu] = Min;\nField[%zu].FieldsList = {", 2 * sources + 1,
                 2 * sources + 1);
    for (size_t i = 1; i <= sources; i++) {
      dea_text_add(out, "%s%zu", i > 1 ? ", " : "", 2 * i);
    }
    dea_text_add(out, "};\nBackground Field = %zu;\n", 2 * sources + 1);
  }
}

static void write_script(struct dea_text *out, const struct dea_gmsh_plan *plan,
                         const struct recipe *recipe)
{
  struct numbers last = {.decimals = decimals_of(plan)};
  void *locale = dea_c_locale_enter();
  write_settings(out, plan, recipe);
  for (size_t i = 0; i < plan->shape_count; i++) {
    for (size_t k = 0; k < plan->shapes[i].count; k++) {
      write_contour(out, &last, &plan->shapes[i].contours[k]);
    }
  }
  if (last.surface > 1) {
    dea_text_add(out, "BooleanFragments{ Surface{1}; Delete; }{ Surface{2:%zu}; Delete; }\n",
                 last.surface);
  }
  dea_text_add(out, "Physical Surface(\"all\") = Surface{:};\n"
                    "Physical Curve(\"all\") = Curve{:};\n");
  write_fields(out, plan, recipe);
  dea_c_locale_leave(locale);
}

// The program -------------------------------------------------------------------------------------

static const char *last_words(const char *said)
{
  return said[strspn(said, " \n")] != '\0' ? "it said last:\n" : "it said nothing";
}

static dea_status explain(struct dea_context *ctx, enum dea_program_end end, int number,
                          double limit_s, const char *said)
{
  const char *last = dea_last_lines(said, LINES_SAID), *words = last_words(last);
  switch (end) {
  case DEA_PROGRAM_DONE:
    return DEA_OK;
  case DEA_PROGRAM_FAILED:
    return dea_fail(ctx, DEA_E_TOOL, "gmsh failed (exit code %d); %s%s", number, words, last);
  case DEA_PROGRAM_CRASHED:
    return dea_fail(ctx, DEA_E_TOOL, "gmsh crashed (signal %d); %s%s", number, words, last);
  case DEA_PROGRAM_TOO_LONG:
    return dea_fail(ctx, DEA_E_TOOL,
                    "gmsh took more than %g s of processor time (or ten times that by the clock) "
                    "and was ended; %s%s",
                    limit_s, words, last);
  default:
    return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted while gmsh made a mesh");
  }
}

static dea_status run_gmsh(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                           const char *folder, char said[DEA_PROGRAM_SAID])
{
  char program[200], script[] = "mesh.geo", plane[] = "-2", to[] = "-o", mesh[] = "mesh.msh";
  char format[] = "-format", msh41[] = "msh41", quiet[] = "-nopopup";
  char *const argv[] = {program, script, plane, to, mesh, format, msh41, quiet, NULL};
  struct dea_program running;
  double limit_s = plan->time_limit_s > 0 ? plan->time_limit_s : 120;
  int number;
  snprintf(program, sizeof program, "%s", plan->program != NULL ? plan->program : "gmsh");
  int reason = dea_program_start(argv, folder, true, &running);
  if (reason == ENOENT) {
    return dea_fail(ctx, DEA_E_TOOL,
                    "%s is not installed (on Debian: apt install gmsh); a mesh can be made "
                    "elsewhere and read from its .msh file",
                    program);
  }
  if (reason != 0) {
    return dea_fail(ctx, DEA_E_TOOL, "%s cannot be started: %s", program, strerror(reason));
  }
  enum dea_program_end end = dea_program_wait(ctx, &running, limit_s, said, &number);
  return explain(ctx, end, number, limit_s, said);
}

/* Names of the shapes whose edges are as near to an element as it is long. */
static void name_near(const struct dea_gmsh_plan *plan, const struct dea_plane_mesh *mesh, size_t e,
                      struct dea_text *out)
{
  const double *first =
      mesh->x + 2 * mesh->quads[e * (size_t)((mesh->order + 1) * (mesh->order + 1))];
  double middle[2];
  dea_plane_mesh_middle(mesh, e, middle);
  double length_m = 2 * hypot(first[0] - middle[0], first[1] - middle[1]);
  const char *before = "edges of ";
  bool cut = plan->curve_count > 0; // shapes: they have the edges of a sector, too
  const struct dea_gmsh_shape *shapes = cut ? plan->curves : plan->shapes;
  for (size_t i = 0; i < (cut ? plan->curve_count : plan->shape_count); i++) {
    if (distance_to(&shapes[i], middle) <= length_m) {
      dea_text_add(out, "%s'%s'", before, shapes[i].name);
      before = ", ";
    }
  }
  if (before[0] == 'e') {
    dea_text_add(out, "no edge");
  }
}

/* DEA_E_DESIGN for elements that are too bad to use, with where and between what. */
static dea_status check_quality(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                                const struct dea_plane_mesh *mesh)
{
  size_t worst = 0;
  double least = dea_plane_mesh_smallest_jacobian(mesh, &worst), middle[2];
  if (least >= DEA_MSH_JACOBIAN_MIN) {
    return DEA_OK;
  }
  struct dea_text near_it = {.ctx = ctx};
  dea_plane_mesh_middle(mesh, worst, middle);
  name_near(plan, mesh, worst, &near_it);
  dea_status status = dea_fail(
      ctx, DEA_E_DESIGN,
      "an element near (%.4g, %.4g) mm, by %s, is too bad: its smallest Jacobian is %.3g "
      "of the mean one, at least %g is wanted; where edges touch or meet at a small angle, "
      "part them or let shapes overlap by more",
      mm * middle[0], mm * middle[1], dea_text_get(&near_it), least, DEA_MSH_JACOBIAN_MIN);
  dea_text_free(&near_it);
  return status;
}

static dea_status mesh_in(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                          const struct recipe *recipe, const char *folder,
                          struct dea_plane_mesh **out)
{
  struct dea_text script = {.ctx = ctx};
  char said[DEA_PROGRAM_SAID];
  write_script(&script, plan, recipe);
  dea_status status = dea_text_write(ctx, &script, folder, "mesh.geo");
  if (status == DEA_OK && plan->size_count > 0) {
    struct dea_text sizes = {.ctx = ctx};
    void *locale = dea_c_locale_enter();
    write_sizes(&sizes, plan, recipe);
    dea_c_locale_leave(locale);
    status = dea_text_write(ctx, &sizes, folder, SIZES_FILE);
    dea_text_free(&sizes);
  }
  dea_text_free(&script);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, run_gmsh(ctx, plan, folder, said));
  char *mesh = dea_path_join(ctx, folder, "mesh.msh");
  DEA_TRY_MEMORY(mesh != NULL);
  char *text = NULL;
  size_t length;
  if (!dea_path_exists(mesh)) {
    status =
        dea_fail(ctx, DEA_E_TOOL, "gmsh wrote no mesh; %s%s",
                 last_words(dea_last_lines(said, LINES_SAID)), dea_last_lines(said, LINES_SAID));
  } else {
    status = dea_file_read(ctx, mesh, DEA_MSH_FILE_MAX, &text, &length);
  }
  status = status == DEA_OK ? dea_msh_parse(ctx, text, NULL, unit_m, out) : status;
  status = status == DEA_OK ? check_quality(ctx, plan, *out) : status;
  dea_free(ctx, text);
  dea_free(ctx, mesh);
  return status;
}

/* All that gmsh meshes, in one group and one curve "all". */
static dea_status mesh_all(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                           struct dea_plane_mesh **out)
{
  char folder[DEA_TEMPORARY_SIZE];
  *out = NULL;
  DEA_TRY(ctx, dea_folder_create_temporary(ctx, "gmsh", folder));
  dea_status status = DEA_E_DESIGN;
  double best = -INFINITY;
  for (size_t i = 0; i < RECIPES && status == DEA_E_DESIGN && best < good_jacobian; i++) {
    struct dea_plane_mesh *mesh = NULL;
    status = mesh_in(ctx, plan, &recipes[i], folder, &mesh);
    double jacobian = status == DEA_OK ? dea_plane_mesh_smallest_jacobian(mesh, NULL) : -INFINITY;
    if (jacobian > best) {
      dea_plane_mesh_destroy(ctx, *out);
      *out = mesh;
      mesh = NULL;
      best = jacobian;
    }
    dea_plane_mesh_destroy(ctx, mesh);
    status = status == DEA_OK ? DEA_E_DESIGN : status; // perhaps the next one is better
  }
  if (status == DEA_E_DESIGN && *out != NULL) {
    status = DEA_OK;
  } else {
    dea_plane_mesh_destroy(ctx, *out);
    *out = NULL;
  }
  dea_folder_remove_temporary(folder);
  if (status == DEA_E_DESIGN) {
    char said[400];
    snprintf(said, sizeof said, "%s", dea_context_message(ctx));
    return dea_fail(ctx, DEA_E_TOOL, "gmsh made a mesh that cannot be used: %s", said);
  }
  return status;
}

// Shapes of the elements --------------------------------------------------------------------------

/* Keeps the elements in shapes, with their regions; closes the gaps in the numbers of nodes.
 * number: [node_count] of mesh. */
static dea_status read_elements(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                                unsigned char *within, int *number, struct dea_plane_mesh *mesh)
{
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1)), quads = 0, nodes = 0;
  for (size_t e = 0; e < mesh->quad_count; e++) {
    bool inside = false;
    double x[2];
    dea_plane_mesh_middle(mesh, e, x);
    for (size_t i = 0; i < plan->shape_count; i++) {
      within[i] = is_inside(&plan->shapes[i], x);
      inside = inside || within[i] != 0;
    }
    if (inside) {
      memmove(mesh->quads + quads * per_quad, mesh->quads + e * per_quad,
              per_quad * sizeof *mesh->quads);
      DEA_TRY(ctx, dea_plane_mesh_region(ctx, mesh, within, &mesh->region[quads]));
      quads++;
    }
  }
  mesh->quad_count = quads;
  for (size_t i = 0; i < quads * per_quad; i++) {
    number[mesh->quads[i]] = 1;
  }
  for (size_t n = 0; n < mesh->node_count; n++) {
    if (number[n] != 0) {
      memmove(mesh->x + 2 * nodes, mesh->x + 2 * n, 2 * sizeof *mesh->x);
      number[n] = (int)++nodes; // from 1: 0 is none
    }
  }
  mesh->node_count = nodes;
  for (size_t i = 0; i < quads * per_quad; i++) {
    mesh->quads[i] = number[mesh->quads[i]] - 1;
  }
  return DEA_OK;
}

/* Sides of elements that lie on a contour. before: as gmsh made them; number: as above. */
static dea_status read_edges(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                             const int *before, size_t before_count, const int *number,
                             double close, struct dea_plane_mesh *mesh)
{
  size_t per = (size_t)mesh->order + 1, curves = plan->shape_count + plan->curve_count;
  mesh->edges = dea_alloc(ctx, before_count * curves, per * sizeof *mesh->edges);
  mesh->edge_curve = dea_alloc(ctx, before_count * curves, sizeof *mesh->edge_curve);
  DEA_TRY_MEMORY(mesh->edges != NULL && mesh->edge_curve != NULL);
  for (size_t i = 0; i < before_count; i++) {
    for (size_t k = 0; k < curves; k++) {
      bool on = true;
      for (size_t n = 0; n < per && on; n++) {
        int node = number[before[i * per + n]] - 1;
        on = node >= 0 && distance_to(curve_of(plan, k), mesh->x + 2 * node) < close;
      }
      if (on) {
        for (size_t n = 0; n < per; n++) {
          mesh->edges[mesh->edge_count * per + n] = number[before[i * per + n]] - 1;
        }
        mesh->edge_curve[mesh->edge_count++] = (int)k;
      }
    }
  }
  return DEA_OK;
}

static dea_status name_all(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                           struct dea_plane_mesh *mesh)
{
  for (size_t i = 0; i < plan->shape_count; i++) {
    DEA_TRY(ctx, dea_plane_mesh_add_group(ctx, mesh, plan->shapes[i].name));
    DEA_TRY(ctx, dea_plane_mesh_add_curve(ctx, mesh, plan->shapes[i].name));
  }
  for (size_t i = 0; i < plan->curve_count; i++) {
    DEA_TRY(ctx, dea_plane_mesh_add_curve(ctx, mesh, plan->curves[i].name));
  }
  return DEA_OK;
}

static dea_status check_groups(struct dea_context *ctx, const struct dea_plane_mesh *mesh)
{
  for (size_t g = 0; g < mesh->group_count; g++) {
    bool used = false;
    for (size_t k = 0; k < mesh->region_count; k++) {
      used = used || mesh->within[k * mesh->group_count + g] != 0;
    }
    if (!used) {
      return dea_fail(ctx, DEA_E_TOOL, "gmsh made no element inside of '%s'", mesh->group[g]);
    }
  }
  return DEA_OK;
}

/* Shapes and curves in the place of the one group and the one curve that gmsh knows of. */
static dea_status classify(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                           struct dea_plane_mesh *mesh)
{
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a mesh that was read
  for (size_t i = 0; i < 2 * mesh->node_count; i++) {
    low[i % 2] = fmin(low[i % 2], mesh->x[i]);
    high[i % 2] = fmax(high[i % 2], mesh->x[i]);
  }
  double close = near * fmax(high[0] - low[0], high[1] - low[1]);
  int *before = mesh->edges;
  size_t before_count = mesh->edge_count;
  mesh->edges = NULL;
  mesh->edge_count = 0;
  dea_plane_mesh_forget_names(ctx, mesh);
  struct dea_arena memory = {.ctx = ctx};
  unsigned char *within = dea_arena_alloc(&memory, plan->shape_count, 1);
  int *number = dea_arena_alloc(&memory, mesh->node_count, sizeof *number);
  dea_status status = dea_arena_status(&memory);
  status = status == DEA_OK ? name_all(ctx, plan, mesh) : status;
  status = status == DEA_OK ? read_elements(ctx, plan, within, number, mesh) : status;
  status =
      status == DEA_OK ? read_edges(ctx, plan, before, before_count, number, close, mesh) : status;
  dea_arena_free(&memory);
  dea_free(ctx, before);
  DEA_TRY(ctx, status);
  return DEA_CHAIN(ctx, check_groups(ctx, mesh));
}

static dea_status add_layers(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                             struct dea_plane_mesh *mesh)
{
  struct dea_arena memory = {.ctx = ctx};
  double *width_m = dea_arena_alloc(&memory, mesh->curve_count, sizeof *width_m);
  bool *rigid = dea_arena_alloc(&memory, mesh->group_count, sizeof *rigid);
  dea_status status = dea_arena_status(&memory);
  for (size_t k = 0; status == DEA_OK && k < mesh->curve_count; k++) {
    width_m[k] = curve_of(plan, k)->layer_m;
  }
  for (size_t g = 0; status == DEA_OK && g < mesh->group_count; g++) {
    rigid[g] = plan->shapes[g].rigid;
  }
  if (status == DEA_OK) {
    const struct dea_edge_layers layers = {width_m, rigid, plan->layer_rows};
    status = dea_edge_layers_add(ctx, mesh, &layers);
  }
  dea_arena_free(&memory);
  return status;
}

static dea_status check_plan(struct dea_context *ctx, const struct dea_gmsh_plan *plan)
{
  bool good = plan->shape_count > 0 && (plan->order == 1 || plan->order == 2) && plan->size_m > 0 &&
              plan->size_m < INFINITY;
  for (size_t i = 0; i < plan->shape_count; i++) {
    const struct dea_gmsh_shape *shape = &plan->shapes[i];
    good = good && shape->count > 0 && shape->edge_size_m < INFINITY;
    for (size_t k = 0; k < shape->count; k++) {
      good = good && shape->contours[k].closed && dea_contour_pieces(&shape->contours[k]) >= 2;
    }
  }
  return good ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "a mesh takes closed contours of two pieces or more, a size above 0 and "
                         "the order 1 or 2");
}

dea_status dea_gmsh_mesh(struct dea_context *ctx, const struct dea_gmsh_plan *plan,
                         struct dea_plane_mesh **out)
{
  *out = NULL;
  DEA_TRY(ctx, check_plan(ctx, plan));
  dea_status status = mesh_all(ctx, plan, out);
  status = status == DEA_OK ? classify(ctx, plan, *out) : status;
  status = status == DEA_OK ? add_layers(ctx, plan, *out) : status;
  if (status != DEA_OK) {
    dea_plane_mesh_destroy(ctx, *out);
    *out = NULL;
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}
