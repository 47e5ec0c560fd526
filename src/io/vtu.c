#include "io/vtu.h"

#include "base/version.h"
#include "base/write_file.h"

#include <stdint.h>
#include <string.h>

enum { CELL_NODES_MAX = 27 };

/* ---- cells ---- */

/* A way to write elements: VTK's number of the type, and how many cells of how many nodes. A node
 * is its place [i, j, k] on the lattice of the cell. */
struct cell_type {
  unsigned char number;
  int order, nodes;
  signed char at[CELL_NODES_MAX][3];
};

static const struct cell_type quad = {9, 1, 4, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
static const struct cell_type biquadratic_quad = {28,
                                                  2,
                                                  9,
                                                  {{0, 0, 0},
                                                   {2, 0, 0},
                                                   {2, 2, 0},
                                                   {0, 2, 0},
                                                   {1, 0, 0},
                                                   {2, 1, 0},
                                                   {1, 2, 0},
                                                   {0, 1, 0},
                                                   {1, 1, 0}}};
static const struct cell_type hexahedron = {
    12,
    1,
    8,
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
/* Corners, then edges (bottom, top, upright), faces (-x +x -y +y -z +z), middle. */
static const struct cell_type triquadratic_hexahedron = {
    29, 2, 27, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2},
                {0, 2, 2}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}, {1, 0, 2}, {2, 1, 2},
                {1, 2, 2}, {0, 1, 2}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {0, 1, 1},
                {2, 1, 1}, {1, 0, 1}, {1, 2, 1}, {1, 1, 0}, {1, 1, 2}, {1, 1, 1}}};

static const struct cell_type *cell_type_of(const struct dea_mesh_block *block)
{
  if (block->order_z == 0) {
    return block->order == 2 ? &biquadratic_quad : &quad;
  }
  return block->order == 2 && block->order_z == 2 ? &triquadratic_hexahedron : &hexahedron;
}

/* Cells along the plane's axes, and through the thickness, that an element becomes. */
static int pieces(const struct dea_mesh_block *block)
{
  return block->order / cell_type_of(block)->order;
}

static int pieces_z(const struct dea_mesh_block *block)
{
  return block->order_z == 0 ? 1 : block->order_z / cell_type_of(block)->order;
}

static size_t cells_of(const struct dea_mesh_block *block)
{
  return (size_t)(pieces(block) * pieces(block) * pieces_z(block));
}

/* ---- arrays ---- */

/* Everything that is written. */
struct grid {
  const struct dea_field_mesh *mesh;
  size_t copies;       // that each block holds, one after the other
  size_t cells, nodes; // of all copies; nodes: of all cells
};

static void add_int(struct dea_text *out, int32_t value)
{
  dea_text_add_bytes(out, &value, sizeof value);
}

static void add_numbers(struct dea_text *out, const double *values, size_t count, bool in_double)
{
  if (in_double) {
    dea_text_add_bytes(out, values, count * sizeof *values);
  }
  for (size_t i = 0; i < count && !in_double; i++) {
    const float single = (float)values[i];
    dea_text_add_bytes(out, &single, sizeof single);
  }
}

static bool is_double(const struct dea_mesh_field *field)
{
  return field->kind == DEA_MESH_VECTOR;
}

/* Values of points, or of cells, each as often as its element has pieces. */
static void add_field(struct dea_text *out, const struct grid *grid,
                      const struct dea_mesh_field *field)
{
  const struct dea_field_mesh *mesh = grid->mesh;
  const size_t n = (size_t)field->components;
  const double *values = field->values;
  if (!field->of_cells) {
    add_numbers(out, values, mesh->point_count * n, is_double(field));
    return;
  }
  for (size_t b = 0; b < mesh->block_count; b++) {
    for (size_t e = 0; e < mesh->blocks[b].count; e++, values += n) {
      for (size_t k = 0; k < cells_of(&mesh->blocks[b]); k++) {
        add_numbers(out, values, n, is_double(field));
      }
    }
  }
}

/* One cell of an element: the piece at [from]. */
static void add_cell(struct dea_text *out, const struct dea_mesh_block *block, const int *nodes,
                     const int from[3])
{
  const struct cell_type *type = cell_type_of(block);
  int row = block->order + 1;
  for (int n = 0; n < type->nodes; n++) {
    int i = from[0] + type->at[n][0], j = from[1] + type->at[n][1], k = from[2] + type->at[n][2];
    add_int(out, nodes[(k * row + j) * row + i]);
  }
}

static void add_connectivity(struct dea_text *out, const struct grid *grid)
{
  for (size_t b = 0; b < grid->mesh->block_count; b++) {
    const struct dea_mesh_block *block = &grid->mesh->blocks[b];
    int n = pieces(block), nz = pieces_z(block), order = cell_type_of(block)->order;
    for (size_t e = 0; e < block->count; e++) {
      const int *nodes = block->nodes + e * (size_t)dea_mesh_block_nodes(block);
      for (int k = 0; k < n * n * nz; k++) {
        const int from[3] = {order * (k % n), order * (k / n % n), order * (k / (n * n))};
        add_cell(out, block, nodes, from);
      }
    }
  }
}

/* What is said of each cell: where its nodes end in the connectivity, VTK's number of its type, the
 * copy that it is of. */
enum cell_number { END, TYPE, COPY };

static void add_cell_numbers(struct dea_text *out, const struct grid *grid, enum cell_number what)
{
  int32_t end = 0;
  for (size_t b = 0; b < grid->mesh->block_count; b++) {
    const struct dea_mesh_block *block = &grid->mesh->blocks[b];
    const size_t cells = block->count * cells_of(block), of_copy = cells / grid->copies;
    for (size_t k = 0; k < cells; k++) {
      end += cell_type_of(block)->nodes;
      if (what == TYPE) {
        dea_text_add_bytes(out, &cell_type_of(block)->number, 1);
      } else {
        add_int(out, what == END ? end : (int32_t)(k / of_copy));
      }
    }
  }
}

/* ---- file ---- */

/* Text in front, and how far the arrays behind it have come. */
struct file {
  struct dea_text head, data;
  size_t block; // where the size of the open array stands
};

static void open_array(struct file *file, const char *type, const char *name, int components)
{
  dea_text_add(&file->head,
               "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
               "offset=\"%zu\"/>\n",
               type, name, components, file->data.length);
  file->block = file->data.length;
  dea_text_add_bytes(&file->data, &(uint64_t){0}, sizeof(uint64_t));
}

static void close_array(struct file *file)
{
  const uint64_t size = file->data.length - file->block - sizeof size;
  if (!file->data.failed) {
    memcpy(file->data.data + file->block, &size, sizeof size);
  }
}

static void add_fields(struct file *file, const struct grid *grid, bool of_cells)
{
  const char *section = of_cells ? "CellData" : "PointData";
  dea_text_add(&file->head, "<%s>\n", section);
  for (size_t i = 0; i < grid->mesh->field_count; i++) {
    const struct dea_mesh_field *field = &grid->mesh->fields[i];
    if (field->of_cells == of_cells) {
      open_array(file, is_double(field) ? "Float64" : "Float32", field->name, field->components);
      add_field(&file->data, grid, field);
      close_array(file);
    }
  }
  if (of_cells) {
    open_array(file, "Int32", "copy", 1);
    add_cell_numbers(&file->data, grid, COPY);
    close_array(file);
  }
  dea_text_add(&file->head, "</%s>\n", section);
}

static void add_cells(struct file *file, const struct grid *grid)
{
  dea_text_add(&file->head, "<Points>\n");
  open_array(file, "Float64", "Points", 3);
  add_numbers(&file->data, grid->mesh->X, 3 * grid->mesh->point_count, true);
  close_array(file);
  dea_text_add(&file->head, "</Points>\n<Cells>\n");
  open_array(file, "Int32", "connectivity", 1);
  add_connectivity(&file->data, grid);
  close_array(file);
  open_array(file, "Int32", "offsets", 1);
  add_cell_numbers(&file->data, grid, END);
  close_array(file);
  open_array(file, "UInt8", "types", 1);
  add_cell_numbers(&file->data, grid, TYPE);
  close_array(file);
  dea_text_add(&file->head, "</Cells>\n");
}

/* That of numbers in memory, as the files have them. */
static const char *byte_order(void)
{
  const uint16_t one = 1;
  unsigned char first;
  memcpy(&first, &one, 1);
  return first == 1 ? "LittleEndian" : "BigEndian";
}

static void build(struct file *file, const struct grid *grid, double voltage_V)
{
  dea_text_add(&file->head,
               "<?xml version=\"1.0\"?>\n<!-- dea %s; SI units; places in the stretched flat film "
               "-->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"%s\" "
               "header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n<DataArray "
               "type=\"Float64\" Name=\"voltage_V\" NumberOfTuples=\"1\" format=\"ascii\">%.17g"
               "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n",
               DEA_VERSION, byte_order(), voltage_V, grid->mesh->point_count, grid->cells);
  add_fields(file, grid, false);
  add_fields(file, grid, true);
  add_cells(file, grid);
  dea_text_add(&file->head, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
  dea_text_add_bytes(&file->head, file->data.data, file->data.length);
  dea_text_add(&file->head, "\n</AppendedData>\n</VTKFile>\n");
}

static dea_status write(struct dea_context *ctx, const struct dea_field_mesh *mesh, size_t copies,
                        double voltage_V, const char *path)
{
  struct grid grid = {.mesh = mesh, .copies = copies};
  struct file file = {.head = {.ctx = ctx}, .data = {.ctx = ctx}};
  for (size_t b = 0; b < mesh->block_count; b++) {
    const size_t cells = mesh->blocks[b].count * cells_of(&mesh->blocks[b]);
    grid.cells += cells;
    grid.nodes += cells * (size_t)cell_type_of(&mesh->blocks[b])->nodes;
  }
  if (grid.nodes > INT32_MAX) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "a VTU file takes at most %d nodes of cells",
                    INT32_MAX);
  }
  build(&file, &grid, voltage_V);
  dea_text_free_in(&file.data, &file.head);
  return dea_text_write_path(ctx, &file.head, path);
}

dea_status dea_vtu_write(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                         double voltage_V, bool whole, const char *path)
{
  const size_t copies = whole ? dea_copy_count(mesh) : 1;
  struct dea_field_mesh *all = NULL;
  DEA_TRY(ctx, copies > 1 ? dea_field_mesh_whole(ctx, mesh, &all) : DEA_OK);
  const dea_status status = write(ctx, all != NULL ? all : mesh, copies, voltage_V, path);
  dea_field_mesh_destroy(ctx, all);
  return status;
}

dea_status dea_pvd_write(struct dea_context *ctx, const struct dea_pvd_entry *entries,
                         size_t entry_count, const char *path)
{
  bool rising = true;
  for (size_t i = 1; i < entry_count; i++) {
    rising = rising && entries[i].voltage_V > entries[i - 1].voltage_V;
  }
  struct dea_text text = {.ctx = ctx};
  dea_text_add(&text,
               "<?xml version=\"1.0\"?>\n<!-- dea %s; time: %s -->\n<VTKFile type=\"Collection\" "
               "version=\"0.1\" byte_order=\"%s\">\n<Collection>\n",
               DEA_VERSION, rising ? "voltage in V" : "number of the point in the sweep",
               byte_order());
  for (size_t i = 0; i < entry_count; i++) {
    dea_text_add(&text, "<DataSet timestep=\"%.10g\" group=\"\" part=\"0\" file=\"%s\"/>\n",
                 rising ? entries[i].voltage_V : (double)i, entries[i].file);
  }
  dea_text_add(&text, "</Collection>\n</VTKFile>\n");
  return dea_text_write_path(ctx, &text, path);
}
