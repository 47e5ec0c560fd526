#define _GNU_SOURCE // pread, pwrite, ftruncate, fsync, F_OFD_SETLK
#include "recording/disk.h"

#include "base/write_file.h"
#include "recording/recorder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What HDF5 copies into the list of properties. */
struct disk_of_list {
  struct dea_disk *disk;
};

struct disk_file {
  H5FD_t common; // first: HDF5's own
  struct dea_disk *disk;
  int file;
  haddr_t allocated, size;
  /* The file's first bytes, as HDF5 wrote them: with them it closes a file that it can no longer
   * read. */
  unsigned char head[4096];
  dev_t device;
  ino_t inode;
};

/* Against other writers. Not with flock, which readers that use HDF5 take. */
static bool lock_file(int file)
{
  struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return fcntl(file, F_OFD_SETLK, &all) == 0;
}

static H5FD_t *disk_open(const char *name, unsigned flags, hid_t access, haddr_t most)
{
  (void)most;
  const struct disk_of_list *of_list = H5Pget_driver_info(access);
  int how = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  how |=
      ((flags & H5F_ACC_TRUNC) != 0 ? O_TRUNC : 0) | ((flags & H5F_ACC_CREAT) != 0 ? O_CREAT : 0);
  how |= (flags & H5F_ACC_EXCL) != 0 ? O_EXCL : 0;
  struct disk_file *opened = calloc(1, sizeof *opened); // freed by HDF5's call of disk_close
  if (opened == NULL || of_list == NULL) {
    free(opened);
    return NULL;
  }
  struct stat info;
  opened->disk = of_list->disk;
  opened->file = open(name, how | O_CLOEXEC, 0666);
  bool writes = (how & O_RDWR) != 0;
  if (opened->file < 0 || (writes && !lock_file(opened->file)) || fstat(opened->file, &info) != 0) {
    opened->disk->error = (flags & H5F_ACC_CREAT) != 0 ? errno : 0;
    if (opened->file >= 0) {
      close(opened->file);
    }
    free(opened);
    return NULL;
  }
  opened->size = (haddr_t)info.st_size;
  opened->device = info.st_dev;
  opened->inode = info.st_ino;
  opened->disk->file = opened->file;
  if (writes && opened->disk->lasting) {
    dea_folder_sync(name);
  }
  return &opened->common;
}

static herr_t disk_close(H5FD_t *file)
{
  struct disk_file *own = (struct disk_file *)file;
  if (own->disk->lasting) {
    dea_disk_sync(own->disk);
  }
  if (close(own->file) != 0 && own->disk->error == 0) {
    own->disk->error = errno;
  }
  own->disk->file = -1;
  free(own);
  return 0;
}

static int disk_compare(const H5FD_t *a, const H5FD_t *b)
{
  const struct disk_file *x = (const struct disk_file *)a, *y = (const struct disk_file *)b;
  if (x->device != y->device) {
    return x->device < y->device ? -1 : 1;
  }
  return (x->inode > y->inode) - (x->inode < y->inode);
}

static herr_t disk_query(const H5FD_t *file, unsigned long *flags)
{
  (void)file;
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_SUPPORTS_SWMR_IO |
           H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

static haddr_t disk_get_allocated(const H5FD_t *file, H5FD_mem_t type)
{
  (void)type;
  return ((const struct disk_file *)file)->allocated;
}

static herr_t disk_set_allocated(H5FD_t *file, H5FD_mem_t type, haddr_t address)
{
  (void)type;
  ((struct disk_file *)file)->allocated = address;
  return 0;
}

static haddr_t disk_get_size(const H5FD_t *file, H5FD_mem_t type)
{
  (void)type;
  return ((const struct disk_file *)file)->size;
}

/* Whether all that was written is still there: another program may have cut the file off. HDF5
 * would take zeros for its own tables then, and wait for what never comes. */
static bool is_whole(struct disk_file *file)
{
  struct stat info;
  if (file->disk->error == 0 && fstat(file->file, &info) != 0) {
    file->disk->error = errno;
  } else if (file->disk->error == 0 && (haddr_t)info.st_size < file->size) {
    file->disk->error = DEA_DISK_CUT;
  }
  return file->disk->error == 0;
}

static herr_t disk_read(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size,
                        void *buffer)
{
  (void)type;
  (void)transfer;
  struct disk_file *own = (struct disk_file *)file;
  char *to = buffer;
  if (!is_whole(own)) {
    bool kept = address < sizeof own->head && size <= sizeof own->head - address;
    if (kept) {
      memcpy(to, own->head + address, size);
    }
    return kept ? 0 : -1;
  }
  while (size > 0) {
    ssize_t n = pread(own->file, to, size, (off_t)address);
    if (n < 0 && errno != EINTR) {
      return -1;
    }
    if (n == 0) { // behind the end of what was written, within what was allocated
      memset(to, 0, size);
      return 0;
    }
    if (n > 0) {
      to += n;
      size -= (size_t)n;
      address += (haddr_t)n;
    }
  }
  return 0;
}

static herr_t disk_write(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address,
                         size_t size, const void *buffer)
{
  (void)type;
  (void)transfer;
  struct disk_file *own = (struct disk_file *)file;
  const char *from = buffer;
  haddr_t end = address + size;
  if (address < sizeof own->head) {
    memcpy(own->head + address, from,
           size < sizeof own->head - address ? size : sizeof own->head - address);
  }
  while (is_whole(own) && size > 0) {
    ssize_t n = pwrite(own->file, from, size, (off_t)address);
    if (n < 0 && errno != EINTR) {
      own->disk->error = errno;
    }
    if (n > 0) {
      from += n;
      size -= (size_t)n;
      address += (haddr_t)n;
    }
  }
  own->size = end > own->size ? end : own->size;
  return 0;
}

static herr_t disk_truncate(H5FD_t *file, hid_t transfer, hbool_t closing)
{
  (void)transfer;
  (void)closing;
  struct disk_file *own = (struct disk_file *)file;
  if (own->disk->error == 0 && own->size != own->allocated &&
      ftruncate(own->file, (off_t)own->allocated) != 0) {
    own->disk->error = errno;
  }
  own->size = own->allocated;
  return 0;
}

/* HDF5's own locks; the file is locked since it was opened. */
static herr_t disk_lock(H5FD_t *file, hbool_t write)
{
  (void)file;
  (void)write;
  return 0;
}

static herr_t disk_unlock(H5FD_t *file)
{
  (void)file;
  return 0;
}

static const H5FD_class_t disk_class = {
#ifdef H5FD_CLASS_VERSION
    .version = H5FD_CLASS_VERSION,
    .value = 600,
#endif
    .name = "dea recording",
    .maxaddr = ((haddr_t)1 << 63) - 1,
    .fc_degree = H5F_CLOSE_WEAK,
    .fapl_size = sizeof(struct disk_of_list),
    .open = disk_open,
    .close = disk_close,
    .cmp = disk_compare,
    .query = disk_query,
    .get_eoa = disk_get_allocated,
    .set_eoa = disk_set_allocated,
    .get_eof = disk_get_size,
    .read = disk_read,
    .write = disk_write,
    .truncate = disk_truncate,
    .lock = disk_lock,
    .unlock = disk_unlock,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

bool dea_disk_use(hid_t access, struct dea_disk *disk)
{
  const struct disk_of_list of_list = {disk};
  hid_t driver = H5FDregister(&disk_class);
  bool good = driver >= 0 && H5Pset_driver(access, driver, &of_list) >= 0;
  if (driver >= 0) {
    H5FDunregister(driver); // the list keeps it
  }
  return good;
}

bool dea_disk_is_named(const struct dea_disk *disk, const char *path)
{
  struct stat ours, named;
  return disk->file >= 0 && fstat(disk->file, &ours) == 0 && stat(path, &named) == 0 &&
         ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

void dea_disk_sync(struct dea_disk *disk)
{
  if (disk->error == 0 && disk->file >= 0 && fsync(disk->file) != 0 && errno != EINVAL) {
    disk->error = errno; // EINVAL: what is no file on a disk
  }
}

bool dea_recording_is_written(const char *path)
{
  int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct flock all = {.l_type = F_RDLCK, .l_whence = SEEK_SET};
  bool written = file >= 0 && fcntl(file, F_OFD_GETLK, &all) == 0 && all.l_type == F_WRLCK;
  if (file >= 0) {
    close(file);
  }
  return written;
}
