#include "recording/series.h"

#include <string.h>

static const char cannot_write[] = "cannot write";

// Writing ----------------------------------------------------------------------------------------

void dea_series_create(struct h5 *h, hid_t group, const char *name, size_t width, size_t capacity,
                       const char *unit, const char *meaning)
{
  if (h->status != DEA_OK) {
    return;
  }
  int rank = width == 1 ? 1 : 2;
  hsize_t size[2] = {0, width}, most[2] = {H5S_UNLIMITED, width}, chunk[2] = {capacity, width};
  hid_t space = H5Screate_simple(rank, size, most);
  hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, rank, chunk);
  H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER); // no row is counted before it is written
  H5Pset_obj_track_times(properties, false);
  hid_t set = H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  if (set < 0) {
    dea_h5_fail(h, cannot_write);
  }
  dea_h5_write_text(h, set, "unit", unit);
  dea_h5_write_text(h, set, "meaning", meaning);
  dea_h5_close(set);
  dea_h5_close(properties);
  dea_h5_close(space);
}

void dea_series_open(struct h5 *h, hid_t group, const char *name, size_t width, size_t capacity,
                     struct dea_recorded_series *series)
{
  *series =
      (struct dea_recorded_series){.set = H5I_INVALID_HID, .width = width, .capacity = capacity};
  if (h->status != DEA_OK) {
    return;
  }
  hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  H5Pset_chunk_cache(access, 0, 0, 0.0); // straight to the file
  series->set = H5Dopen2(group, name, access);
  dea_h5_close(access);
  if (series->set < 0) {
    dea_h5_fail(h, cannot_write);
    return;
  }
  series->rows = dea_alloc(h->ctx, capacity, width * sizeof *series->rows);
  if (series->rows == NULL) {
    h->status = DEA_E_MEMORY;
  }
}

void dea_series_close(struct dea_context *ctx, struct dea_recorded_series *series)
{
  dea_h5_close(series->set);
  dea_free(ctx, series->rows);
  *series = (struct dea_recorded_series){.set = H5I_INVALID_HID};
}

/* The rows [first, first + count) of a dataset. */
static hid_t rows_of(hid_t set, size_t width, hsize_t first, size_t count)
{
  hsize_t start[2] = {first, 0}, size[2] = {count, width};
  hid_t space = H5Dget_space(set);
  if (space >= 0 && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) < 0) {
    H5Sclose(space);
    return H5I_INVALID_HID;
  }
  return space;
}

/* Writes what waits. */
static void store(struct h5 *h, struct dea_recorded_series *series)
{
  if (h->status != DEA_OK || series->used == 0) {
    return;
  }
  hsize_t size[2] = {series->stored + series->used, series->width};
  hsize_t numbers = series->used * series->width;
  hid_t memory = H5Screate_simple(1, &numbers, NULL), space = H5I_INVALID_HID;
  if (H5Dset_extent(series->set, size) < 0 ||
      (space = rows_of(series->set, series->width, series->stored, series->used)) < 0 ||
      H5Dwrite(series->set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, series->rows) < 0) {
    dea_h5_fail(h, cannot_write);
  } else {
    series->stored += series->used;
    series->used = 0;
  }
  dea_h5_close(space);
  dea_h5_close(memory);
}

void dea_series_add(struct h5 *h, struct dea_recorded_series *series, const double *rows,
                    size_t count)
{
  while (count > 0 && h->status == DEA_OK) {
    // up to the end of a chunk, so that every full one is written once and in one piece
    size_t capacity = series->capacity - (size_t)(series->stored % series->capacity) - series->used;
    size_t n = count < capacity ? count : capacity;
    memcpy(series->rows + series->used * series->width, rows,
           n * series->width * sizeof *series->rows);
    series->used += n;
    rows += n * series->width;
    count -= n;
    if (n == capacity) {
      store(h, series);
    }
  }
}

void dea_series_flush(struct h5 *h, struct dea_recorded_series *series)
{
  store(h, series);
  if (h->status == DEA_OK && H5Dflush(series->set) < 0) {
    dea_h5_fail(h, cannot_write);
  }
}

// Reading ----------------------------------------------------------------------------------------

static void damaged(struct h5 *h, const char *name, const char *why)
{
  if (h->status == DEA_OK) {
    h->status = dea_fail(h->ctx, DEA_E_IO, "%s is damaged or no recording: dataset '%s' %s",
                         h->path, name, why);
  }
}

enum { DEFLATE_MAX = 1032 }; // bytes that one byte of deflate can become at most

/* What is known of a dataset before anything of it is read. */
struct shape {
  int rank;
  hsize_t size[2], chunk[2];
  bool chunked;    // as a recorder writes it: what is there of it is read
  size_t row_size; // bytes of a row in the file
  hsize_t file_size;
};

/* Bytes of one of a dataset's numbers; 0 when they are none. */
static size_t number_size(hid_t set)
{
  hid_t type = H5Dget_type(set);
  H5T_class_t class = type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS;
  size_t size = class == H5T_FLOAT || class == H5T_INTEGER ? H5Tget_size(type) : 0;
  dea_h5_close(type);
  return size;
}

/* Chunks without a filter: then every number takes its bytes in the file. */
static bool has_plain_chunks(hid_t set, int rank, hsize_t chunk[2])
{
  hid_t properties = H5Dget_create_plist(set);
  bool good = properties >= 0 && H5Pget_layout(properties) == H5D_CHUNKED &&
              H5Pget_nfilters(properties) == 0 && H5Pget_chunk(properties, rank, chunk) == rank &&
              chunk[0] > 0;
  dea_h5_close(properties);
  return good;
}

static void get_shape(struct h5 *h, hid_t set, const char *name, size_t width, struct shape *shape)
{
  hid_t space = H5Dget_space(set);
  shape->rank = width == 1 ? 1 : 2;
  shape->size[1] = shape->chunk[1] = 1;
  bool good = space >= 0 && H5Sget_simple_extent_ndims(space) == shape->rank &&
              H5Sget_simple_extent_dims(space, shape->size, NULL) == shape->rank;
  dea_h5_close(space);
  shape->file_size = dea_h5_file_size(h, set);
  shape->row_size = width * number_size(set);
  shape->chunked =
      good && has_plain_chunks(set, shape->rank, shape->chunk) && shape->chunk[1] == width;
  if (!good || shape->size[1] != width || shape->row_size == 0) {
    damaged(h, name, "is no list of numbers of the shape that lab/docs/bench.md says");
  } else if (shape->size[0] / (shape->chunked ? 1 : DEFLATE_MAX) >
             shape->file_size / shape->row_size) {
    damaged(h, name, "claims more values than the file can hold");
  }
}

/* Rows of a chunk whose bytes are within the file; wanted: those that the dataset counts. */
static size_t rows_present(hid_t set, const struct shape *shape, hsize_t first, size_t wanted)
{
  hsize_t offset[2] = {first, 0}, size = 0;
  haddr_t address = HADDR_UNDEF;
  unsigned filters = 0;
  if (H5Dget_chunk_info_by_coord(set, offset, &filters, &address, &size) < 0 ||
      address == HADDR_UNDEF || address >= shape->file_size) {
    return 0;
  }
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): a row has values
  hsize_t rows = (shape->file_size - address) / shape->row_size;
  return rows < wanted ? (size_t)rows : wanted;
}

/* Chunk after chunk until one is missing; the number of rows. rows: [size[0]][size[1]]. */
static size_t read_rows(hid_t set, const struct shape *shape, double *rows)
{
  size_t width = (size_t)shape->size[1], count = (size_t)shape->size[0], done = 0;
  if (!shape->chunked) { // of another program: whole or not at all
    return H5Dget_storage_size(set) > 0 &&
                   H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows) >= 0
               ? count
               : 0;
  }
  while (done < count) {
    size_t wanted = count - done < shape->chunk[0] ? count - done : (size_t)shape->chunk[0];
    size_t there = rows_present(set, shape, done, wanted);
    hsize_t numbers = there * width;
    hid_t space = there > 0 ? rows_of(set, width, done, there) : H5I_INVALID_HID;
    hid_t memory = there > 0 ? H5Screate_simple(1, &numbers, NULL) : H5I_INVALID_HID;
    bool good = space >= 0 && H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT,
                                      rows + done * width) >= 0;
    dea_h5_close(memory);
    dea_h5_close(space);
    done += good ? there : 0;
    if (!good || there < wanted) {
      break;
    }
  }
  return done;
}

void dea_series_read(struct h5 *h, hid_t group, const char *name, size_t width, double **rows,
                     size_t *count, bool *cut)
{
  struct shape shape = {.size = {0}};
  *rows = NULL;
  *count = 0;
  hid_t set = dea_h5_array_open(h, group, name);
  if (h->status == DEA_OK) {
    get_shape(h, set, name, width, &shape);
  }
  if (h->status == DEA_OK && shape.size[0] > 0) {
    *rows = dea_alloc(h->ctx, (size_t)shape.size[0], width * sizeof **rows);
    h->status = *rows != NULL ? DEA_OK : DEA_E_MEMORY;
  }
  if (h->status == DEA_OK && shape.size[0] > 0) {
    *count = read_rows(set, &shape, *rows);
    *cut = *cut || *count < shape.size[0];
    H5Eclear2(H5E_DEFAULT);
  }
  dea_h5_close(set);
}

size_t dea_series_width(struct h5 *h, hid_t group, const char *name)
{
  hid_t set = dea_h5_array_open(h, group, name);
  hid_t space = set >= 0 ? H5Dget_space(set) : H5I_INVALID_HID;
  hsize_t size[H5S_MAX_RANK] = {0};
  int rank = space >= 0 ? H5Sget_simple_extent_dims(space, size, NULL) : 0;
  dea_h5_close(space);
  dea_h5_close(set);
  return rank == 1 ? 1 : rank == 2 ? (size_t)size[1] : 0;
}
