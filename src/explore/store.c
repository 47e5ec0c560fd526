#define _DEFAULT_SOURCE // fsync, flock, ftruncate
#include "explore/store.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "base/write_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

enum { FILE_MAX_BYTES = 2000000000 };
static const char prefix[] = "part-", first_word[] = "# dea explore";
static const double sync_every_s = 0.5;

struct dea_store {
  struct dea_context *ctx;
  const struct dea_evaluator *evaluator;
  char hash[65], *path;    // of the part that is written; NULL: none
  int file;                // -1: none
  struct dea_case **cases; // [room], count of them there; each with its own values only
  size_t count, capacity;
  size_t *table, table_size; // open addressing: 1 + index of a case, 0: free
  size_t torn;
  double synced_s, wait_s; // last fsync, and how long the next one waits
};

// Cases in memory ---------------------------------------------------------------------------------

static uint64_t hash_of(const void *bytes, size_t length)
{
  uint64_t hash = 14695981039346656037U; // FNV-1a
  for (size_t i = 0; i < length; i++) {
    hash = (hash ^ ((const unsigned char *)bytes)[i]) * 1099511628211U;
  }
  return hash ^ (hash >> 32);
}

/* The place in the table of the case of these numbers, or the free one where it would be. */
static size_t *place_of(const struct dea_store *store, const double *p)
{
  const size_t length = store->evaluator->param_count * sizeof *p;
  size_t k = (size_t)hash_of(p, length) % store->table_size;
  while (store->table[k] != 0 && memcmp(store->cases[store->table[k] - 1]->p, p, length) != 0) {
    k = (k + 1) % store->table_size;
  }
  return &store->table[k];
}

static dea_status grow(struct dea_store *store)
{
  const size_t capacity = store->capacity > 0 ? 2 * store->capacity : 1024;
  struct dea_case **cases =
      dea_resize(store->ctx, store->cases, capacity, sizeof(struct dea_case *));
  size_t *table = cases != NULL ? dea_alloc(store->ctx, 2 * capacity, sizeof *table) : NULL;
  store->cases = cases != NULL ? cases : store->cases;
  DEA_TRY_MEMORY(table != NULL);
  dea_free(store->ctx, store->table);
  store->table = table;
  store->table_size = 2 * capacity;
  store->capacity = capacity;
  for (size_t i = 0; i < store->count; i++) {
    *place_of(store, store->cases[i]->p) = i + 1;
  }
  return DEA_OK;
}

/* Keeps a case that is not there yet. */
static dea_status remember(struct dea_store *store, const struct dea_case *done)
{
  DEA_TRY(store->ctx, store->count == store->capacity ? grow(store) : DEA_OK);
  size_t *place = place_of(store, done->p);
  if (*place != 0) {
    return DEA_OK;
  }
  const size_t size =
      offsetof(struct dea_case, q) + dea_evaluator_values(store->evaluator) * sizeof done->q[0];
  struct dea_case *kept = dea_alloc(store->ctx, 1, size);
  DEA_TRY_MEMORY(kept != NULL);
  memcpy(kept, done, size);
  store->cases[store->count++] = kept;
  *place = store->count;
  return DEA_OK;
}

// Lines -------------------------------------------------------------------------------------------

static void add_number(struct dea_text *out, double value)
{
  if (isnan(value)) {
    dea_text_add(out, ",");
  } else {
    dea_text_add(out, ",%.17g", value);
  }
}

static void add_line(struct dea_text *out, const struct dea_evaluator *evaluator,
                     const struct dea_case *done)
{
  dea_text_add(out, "%zu,%s,%.4g,", done->number, done->id, done->wall_s); // as in tables
  for (const char *c = done->why; *c != '\0'; c++) {
    dea_text_add(out, "%c", *c == ',' ? ';' : (unsigned char)*c < 0x20 ? ' ' : *c);
  }
  for (size_t j = 0; j < evaluator->param_count; j++) {
    add_number(out, done->p[j]);
  }
  for (size_t i = 0; i < dea_evaluator_values(evaluator); i++) {
    add_number(out, done->q[i]);
  }
  for (size_t k = 0; k < evaluator->mark_count; k++) {
    dea_text_add(out, ",%u", done->marks[k]);
  }
  dea_text_add(out, ",%08" PRIx32 "\n", (uint32_t)hash_of(out->data, out->length));
}

/* The next field of a line, which ends with the line's end; NULL after the last. */
static char *next_field(char **cursor)
{
  char *field = *cursor;
  if (field != NULL) {
    char *comma = strchr(field, ',');
    *cursor = comma != NULL ? comma + 1 : NULL;
    if (comma != NULL) {
      *comma = '\0';
    }
  }
  return field;
}

static bool read_number(char **cursor, double *out)
{
  const char *end, *field = next_field(cursor);
  if (field == NULL) {
    return false;
  }
  *out = *field == '\0' ? NAN : dea_text_to_double(field, &end);
  return *field == '\0' || *end == '\0';
}

/* A line without its end; false: it is not whole. */
static bool read_line(const struct dea_evaluator *evaluator, char *line, struct dea_case *out)
{
  char *sum = strrchr(line, ','), *end, *cursor = line;
  if (sum == NULL || strlen(sum) != 9 ||
      strtoul(sum + 1, &end, 16) != (uint32_t)hash_of(line, (size_t)(sum - line)) || *end != '\0') {
    return false;
  }
  *sum = '\0';
  const char *number = next_field(&cursor), *id = next_field(&cursor);
  *out = (struct dea_case){.number = (size_t)strtoull(number, NULL, 10)};
  if (id == NULL || !read_number(&cursor, &out->wall_s)) {
    return false;
  }
  const char *why = next_field(&cursor);
  snprintf(out->id, sizeof out->id, "%s", id);
  snprintf(out->why, sizeof out->why, "%s", why != NULL ? why : "");
  bool good = why != NULL;
  for (size_t j = 0; j < evaluator->param_count && good; j++) {
    good = read_number(&cursor, &out->p[j]);
  }
  for (size_t i = 0; i < dea_evaluator_values(evaluator) && good; i++) {
    good = read_number(&cursor, &out->q[i]);
  }
  for (size_t k = 0; k < evaluator->mark_count && good; k++) {
    const char *mark = next_field(&cursor);
    good = mark != NULL;
    out->marks[k] = good ? (unsigned)strtoul(mark, NULL, 10) : 0;
  }
  return good && cursor == NULL;
}

// Files -------------------------------------------------------------------------------------------

static void add_head(struct dea_text *out, const struct dea_store *store)
{
  dea_text_add(out, "%s %s %zu %zu\n", first_word, store->hash, store->evaluator->param_count,
               dea_evaluator_values(store->evaluator) + store->evaluator->mark_count);
}

static dea_status read_lines(struct dea_store *store, const char *path, char *bytes)
{
  struct dea_text head = {.ctx = store->ctx};
  struct dea_case *read = dea_alloc(store->ctx, 1, sizeof *read);
  dea_status status = read != NULL ? DEA_OK : DEA_E_MEMORY;
  add_head(&head, store);
  const size_t length = strlen(dea_text_get(&head));
  if (status == DEA_OK && strncmp(bytes, dea_text_get(&head), length) != 0 &&
      strchr(bytes, '\n') != NULL) {
    status = dea_fail(store->ctx, DEA_E_IO,
                      "'%s' has the cases of another question: of another design, other variables "
                      "or quantities; choose another folder (-o), or --force to replace them",
                      path);
  }
  char *line = strchr(bytes, '\n') != NULL ? strchr(bytes, '\n') + 1 : NULL;
  while (status == DEA_OK && line != NULL && *line != '\0') {
    char *stop = strchr(line, '\n');
    if (stop != NULL) {
      *stop = '\0';
    }
    if (stop != NULL && read_line(store->evaluator, line, read)) {
      status = remember(store, read);
    } else if (*line != '\0') {
      store->torn++;
    }
    line = stop != NULL ? stop + 1 : NULL;
  }
  dea_free(store->ctx, read);
  dea_text_free(&head);
  return status;
}

static bool is_part(const char *name)
{
  return strncmp(name, prefix, strlen(prefix)) == 0;
}

static dea_status read_part(struct dea_context *ctx, void *user, const char *name, const char *path)
{
  char *bytes;
  size_t length;
  if (!is_part(name)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_file_read(ctx, path, FILE_MAX_BYTES, &bytes, &length));
  dea_status status = read_lines(user, path, bytes);
  dea_free(ctx, bytes);
  return status;
}

/* Adds a text to the own part, and frees it. */
static dea_status write_text(struct dea_store *store, struct dea_text *text)
{
  dea_status status = text->failed ? DEA_E_MEMORY : DEA_OK;
  if (status == DEA_OK && !dea_write_all(store->file, dea_text_get(text), text->length)) {
    status = dea_fail(store->ctx, DEA_E_IO, "cannot write '%s': %s", store->path, strerror(errno));
  }
  dea_text_free(text);
  return status;
}

static dea_status sync_now(struct dea_store *store)
{
  const double began_s = dea_clock_s();
  const bool good = store->file < 0 || fsync(store->file) == 0;
  store->synced_s = dea_clock_s();
  store->wait_s = fmax(sync_every_s, 20 * (store->synced_s - began_s)); // on a slow disk less often
  return good ? DEA_OK
              : dea_fail(store->ctx, DEA_E_IO, "cannot write '%s': %s", store->path,
                         strerror(errno));
}

/* Whether a part is this process' alone. */
static bool lock_part(int file)
{
  bool locked = false; // the processes of a program that was killed hold it for a moment
  for (int tries = 0; tries < 20 && !locked; tries++) {
    locked = flock(file, LOCK_EX | LOCK_NB) == 0;
    dea_clock_wait(locked ? 0 : 0.1);
  }
  return locked;
}

static dea_status in_use(struct dea_context *ctx, const char *path)
{
  return dea_fail(ctx, DEA_E_IO, "another process writes to '%s'", path);
}

/* Opens the own part for this process alone. */
static dea_status open_part(struct dea_store *store, const char *folder,
                            const struct dea_shard *shard)
{
  char name[64];
  snprintf(name, sizeof name, "%s%zu-of-%zu.csv", prefix, shard->part, shard->parts);
  store->path = dea_path_join(store->ctx, folder, name);
  DEA_TRY_MEMORY(store->path != NULL);
  store->file = open(store->path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (store->file < 0) {
    return dea_fail(store->ctx, DEA_E_IO, "cannot open '%s': %s", store->path, strerror(errno));
  }
  return lock_part(store->file) ? DEA_OK : in_use(store->ctx, store->path);
}

/* Has the own part begin with its head and end with a whole line: without what a program that was
 * killed left, or the zeros of a computer that failed, behind which nothing would be read. */
static dea_status mend_part(struct dea_store *store)
{
  char *bytes;
  size_t length;
  struct dea_text text = {.ctx = store->ctx};
  DEA_TRY(store->ctx, dea_file_read(store->ctx, store->path, FILE_MAX_BYTES, &bytes, &length));
  const char *last = strrchr(bytes, '\n');
  const size_t whole = last != NULL ? (size_t)(last - bytes) + 1 : 0;
  dea_free(store->ctx, bytes);
  if (whole < length && ftruncate(store->file, (off_t)whole) != 0) {
    return dea_fail(store->ctx, DEA_E_IO, "cannot write '%s': %s", store->path, strerror(errno));
  }
  if (whole == 0) {
    add_head(&text, store);
  }
  DEA_TRY(store->ctx, write_text(store, &text));
  return sync_now(store);
}

static dea_status open_all(struct dea_store *store, const char *folder,
                           const struct dea_shard *shard)
{
  DEA_TRY(store->ctx, dea_folder_create(store->ctx, folder));
  if (shard != NULL) {
    DEA_TRY(store->ctx, open_part(store, folder, shard)); // before the others are read
  }
  DEA_TRY(store->ctx, dea_folder_visit(store->ctx, folder, read_part, store));
  return shard != NULL ? mend_part(store) : DEA_OK;
}

dea_status dea_store_open(struct dea_context *ctx, const char *folder, const char *hash,
                          const struct dea_evaluator *evaluator, const struct dea_shard *shard,
                          struct dea_store **out)
{
  *out = NULL;
  struct dea_store *store = dea_alloc(ctx, 1, sizeof *store);
  DEA_TRY_MEMORY(store != NULL);
  *store = (struct dea_store){.ctx = ctx, .evaluator = evaluator, .file = -1};
  snprintf(store->hash, sizeof store->hash, "%s", hash);
  dea_status status = grow(store);
  status = status == DEA_OK ? open_all(store, folder, shard) : status;
  DEA_TRY_ELSE(ctx, status, dea_store_close(store));
  *out = store;
  return DEA_OK;
}

void dea_store_close(struct dea_store *store)
{
  if (store == NULL) {
    return;
  }
  if (store->file >= 0) {
    fsync(store->file);
    close(store->file);
  }
  for (size_t i = 0; i < store->count; i++) {
    dea_free(store->ctx, store->cases[i]);
  }
  dea_free(store->ctx, store->cases);
  dea_free(store->ctx, store->table);
  dea_free(store->ctx, store->path);
  dea_free(store->ctx, store);
}

/* Removes a part that nobody writes to: what they compute would be lost. */
static dea_status remove_part(struct dea_context *ctx, void *user, const char *name,
                              const char *path)
{
  (void)user;
  if (!is_part(name)) {
    return DEA_OK;
  }
  const int file = open(path, O_RDWR | O_CLOEXEC);
  const bool used = file >= 0 && !lock_part(file);
  const bool removed = !used && unlink(path) == 0;
  const int error = errno;
  if (file >= 0) {
    close(file);
  }
  return removed ? DEA_OK
         : used  ? in_use(ctx, path)
                 : dea_fail(ctx, DEA_E_IO, "cannot remove '%s': %s", path, strerror(error));
}

dea_status dea_store_remove(struct dea_context *ctx, const char *folder)
{
  return dea_folder_visit(ctx, folder, remove_part, NULL);
}

dea_status dea_store_add(struct dea_store *store, const struct dea_case *done)
{
  struct dea_text line = {.ctx = store->ctx};
  add_line(&line, store->evaluator, done);
  DEA_TRY(store->ctx, write_text(store, &line));
  DEA_TRY(store->ctx, remember(store, done));
  return dea_clock_s() - store->synced_s > store->wait_s ? sync_now(store) : DEA_OK;
}

size_t dea_store_count(const struct dea_store *store)
{
  return store->count;
}

const struct dea_case *dea_store_get(const struct dea_store *store, size_t index)
{
  return store->cases[index];
}

const struct dea_case *dea_store_find(const struct dea_store *store, const double *p)
{
  const size_t *place = place_of(store, p);
  return *place != 0 ? store->cases[*place - 1] : NULL;
}

size_t dea_store_torn(const struct dea_store *store)
{
  return store->torn;
}
