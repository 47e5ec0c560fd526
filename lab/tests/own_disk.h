/* The disk of a test that links the core: a pwrite in place of the C library's. */
#pragma once

#include "base/clock.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdint.h>
#include <sys/uio.h>
#include <unistd.h>

enum { DISK_PAGE = 4096, DISK_ENDLESS = -1, DISK_FULL = -2 };

static atomic_bool disk_held;                // a write waits while it is set
static long disk_writes_left = DISK_ENDLESS; // it is full after so many more

/* Of the write that fills the disk the first page reaches it, because a program may be killed
 * between two pages. */
ssize_t pwrite(int file, const void *from, size_t size, off_t at)
{
  while (atomic_load(&disk_held)) {
    dea_clock_wait(0.001);
  }
  if (disk_writes_left == 0) {
    size_t page = DISK_PAGE - (size_t)at % DISK_PAGE;
    disk_writes_left = DISK_FULL;
    size = size > page ? page : 0;
  } else if (disk_writes_left > 0) {
    disk_writes_left--;
  } else if (disk_writes_left == DISK_FULL) {
    size = 0;
  }
  if (size == 0) {
    errno = ENOSPC;
    return -1;
  }
  return pwritev(file, &(struct iovec){(void *)(uintptr_t)from, size}, 1, at);
}
