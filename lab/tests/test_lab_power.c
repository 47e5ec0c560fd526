/* lab/recording: the computer's power fails. A layer below HDF5 keeps every write, and what the
 * program waited for (fsync); of what came after the last wait, a disk may have nothing, all, some
 * of the writes, or some pages of each. What was announced by then has to be there, and what is
 * read is right. 40 cuts by fixed seeds; `test_lab_power COUNT [SEED [TABLE]]` makes as many as
 * wanted (verify/recordings.sh), and also breaks pages into sectors, of which it only tells. */
#include "own_folder.h"
#include "recording_samples.h"

#include <string.h>
#include <sys/syscall.h>
#include <sys/uio.h>

enum { CYCLES = 60, PAGE = 4096, SECTOR = 512, PAGES = 3, SECTORS = 4, OPERATIONS = 20000 };

enum kind { WRITE, LENGTH, SYNC, ANNOUNCED };
struct operation {
  enum kind kind;
  off_t at; // of a write; the length
  size_t size;
  unsigned char *bytes;
  size_t cycles; // that were announced
};
static struct operation *operations;
static size_t operation_count;

static const char *const modes[] = {"nothing", "all", "some writes", "some pages",
                                    "some sectors of pages"};

static struct operation *add(enum kind kind)
{
  assert_true(operation_count < OPERATIONS);
  struct operation *o = &operations[operation_count++];
  *o = (struct operation){.kind = kind};
  return o;
}

// The layer: in place of the C library's ----------------------------------------------------------

ssize_t pwrite(int file, const void *from, size_t size, off_t at)
{
  struct operation *o = add(WRITE);
  o->at = at;
  o->size = size;
  o->bytes = malloc(size);
  assert_non_null(o->bytes);
  memcpy(o->bytes, from, size);
  return pwritev(file, &(struct iovec){(void *)(uintptr_t)from, size}, 1, at);
}

int ftruncate(int file, off_t length)
{
  add(LENGTH)->at = length;
  return (int)syscall(SYS_ftruncate, file, length);
}

int fsync(int file)
{
  add(SYNC);
  return 0;
}

// A recording, and what is left of it -------------------------------------------------------------

/* As lab/drive/writer does it: a cycle is announced when the disk has it. */
static void record(const char *file)
{
  struct dea_recorder *recorder;
  operations = calloc(OPERATIONS, sizeof *operations);
  assert_non_null(operations);
  assert_int_equal(sample_create(ctx, file, false, 100, &recorder), DEA_OK);
  for (size_t i = 0; i < CYCLES; i++) {
    struct dea_recorded_cycle cycle = sample_cycle(i);
    for (size_t part = 0; part < 7; part++) {
      assert_int_equal(sample_add(recorder, i * SAMPLE_CYCLE + part * 100, 100), DEA_OK);
    }
    assert_int_equal(sample_add_reading(recorder, i), DEA_OK);
    assert_int_equal(sample_add_frame(recorder, i), DEA_OK);
    assert_int_equal(dea_recorder_sync(recorder), DEA_OK);
    assert_int_equal(dea_recorder_add_cycle(recorder, &cycle), DEA_OK);
    assert_int_equal(dea_recorder_sync(recorder), DEA_OK);
    add(ANNOUNCED)->cycles = i + 1;
  }
  assert_int_equal(dea_recorder_finish(recorder, NULL), DEA_OK);
}

struct disk {
  unsigned char *bytes;
  size_t length;
};

static void apply(struct disk *disk, const struct operation *o, size_t from, size_t size)
{
  if (o->kind == LENGTH) {
    disk->length = (size_t)o->at;
  } else if (o->kind == WRITE && size > 0) {
    size_t begin = (size_t)o->at + from;
    if (begin > disk->length) {
      memset(disk->bytes + disk->length, 0, begin - disk->length);
    }
    memcpy(disk->bytes + begin, o->bytes + from, size);
    disk->length = begin + size > disk->length ? begin + size : disk->length;
  }
}

/* Some of an operation, by chance. */
static void apply_some(struct disk *disk, const struct operation *o, int mode, unsigned *seed)
{
  if (mode == 0) {
    return;
  }
  size_t whole = mode == SECTORS ? SECTOR : PAGE;
  if (mode < PAGES || o->kind != WRITE) {
    if (mode == 1 || rand_r(seed) % 2 == 0) {
      apply(disk, o, 0, o->size);
    }
    return;
  }
  for (size_t at = 0; at < o->size;) {
    size_t left = whole - ((size_t)o->at + at) % whole;
    size_t size = o->size - at < left ? o->size - at : left;
    if (rand_r(seed) % 2 == 0) {
      apply(disk, o, at, size);
    }
    at += size;
  }
}

/* The file after a cut behind `count` operations; the number of cycles announced by then. */
static size_t cut_power(const char *file, size_t count, int mode, unsigned seed, size_t *lost)
{
  size_t synced = 0, cycles = 0, most = 0;
  for (size_t i = 0; i < operation_count; i++) {
    size_t end = (size_t)operations[i].at + operations[i].size;
    most = end > most ? end : most;
    synced = i < count && operations[i].kind == SYNC ? i + 1 : synced;
    cycles = i < count && operations[i].kind == ANNOUNCED ? operations[i].cycles : cycles;
  }
  struct disk disk = {.bytes = calloc(most, 1)};
  assert_non_null(disk.bytes);
  *lost = 0;
  for (size_t i = 0; i < count; i++) {
    const struct operation *o = &operations[i];
    if (i < synced) {
      apply(&disk, o, 0, o->size);
    } else {
      *lost += o->kind == WRITE;
      apply_some(&disk, o, mode, &seed);
    }
  }
  FILE *out = fopen(file, "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(disk.bytes, 1, disk.length, out), disk.length);
  assert_int_equal(fclose(out), 0);
  free(disk.bytes);
  return cycles;
}

static size_t cut_count = 40, mode_count = PAGES + 1;
static unsigned first_seed = 1;
static const char *table_name;

struct cut {
  size_t at, in_doubt, announced, found; // operations before it, writes after the last wait, cycles
};

/* One at a moment after the first cycle; before there is nothing to lose. What is read of the
 * cycles is right. */
static struct cut make_cut(const char *file, int mode, unsigned seed)
{
  struct dea_recording *recording = NULL;
  struct cut cut = {0};
  size_t first = 0;
  while (operations[first].kind != ANNOUNCED) {
    first++;
  }
  cut.at = first + 1 + (size_t)rand_r(&seed) % (operation_count - first);
  cut.announced = cut_power(file, cut.at, mode, seed, &cut.in_doubt);
  if (dea_recording_read(ctx, file, &recording) == DEA_OK) {
    cut.found = recording->cycle_count;
  }
  if (recording != NULL && mode != SECTORS) {
    for (size_t c = 0; c < SAMPLE_CHANNELS; c++) { // no sample beyond its cycles counts
      struct dea_channel *channel = &recording->channels[c];
      size_t whole = cut.found * (c < 2 ? SAMPLE_CYCLE : 1);
      assert_true(channel->count >= whole);
      channel->count = whole;
    }
    recording->profiles.count = cut.found;
    sample_check(recording, cut.found * SAMPLE_CYCLE, cut.found, cut.found, cut.found);
  }
  dea_recording_destroy(ctx, recording);
  return cut;
}

TEST(test_power_cuts)
{
  char file[700];
  size_t wrong = 0, broken = 0;
  record(in_folder("whole.h5"));
  snprintf(file, sizeof file, "%s", in_folder("cut.h5"));
  FILE *table = table_name != NULL ? fopen(table_name, "wb") : NULL;
  if (table != NULL) {
    fprintf(table, "seed,what came after the last wait,operations,writes in doubt,"
                   "cycles announced,cycles read\n");
  }
  for (size_t k = 0; k < cut_count; k++) {
    unsigned seed = first_seed + (unsigned)k;
    int mode = (int)(k % mode_count);
    struct cut cut = make_cut(file, mode, 2654435761U * seed);
    bool lost = cut.found < cut.announced;
    wrong += lost && mode != SECTORS;
    broken += lost && mode == SECTORS;
    if (lost && mode != SECTORS) {
      print_message("seed %u, %s of %zu writes: %zu cycles of %zu; %s\n", seed, modes[mode],
                    cut.in_doubt, cut.found, cut.announced, dea_context_message(ctx));
    }
    if (table != NULL) {
      fprintf(table, "%u,%s,%zu,%zu,%zu,%zu\n", seed, modes[mode], cut.at, cut.in_doubt,
              cut.announced, cut.found);
    }
  }
  assert_true(table == NULL || fclose(table) == 0);
  for (size_t i = 0; i < operation_count; i++) {
    free(operations[i].bytes);
  }
  free(operations);
  print_message("%zu cuts, %zu lost; by broken pages %zu\n", cut_count, wrong, broken);
  assert_int_equal(wrong, 0);
}

int main(int count, char **arguments)
{
  cut_count = count > 1 ? (size_t)strtoul(arguments[1], NULL, 10) : cut_count;
  first_seed = count > 2 ? (unsigned)strtoul(arguments[2], NULL, 10) : 1;
  table_name = count > 3 ? arguments[3] : NULL;
  mode_count += count > 1 ? 1 : 0;
  return run_all(set_up, tear_down);
}
