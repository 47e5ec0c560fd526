/* Where HDF5 writes a recording to: a driver of ours below it, for the sake of failing well.
 *
 * When a write fails (a full disk), HDF5 must not go on and change other places of the file, and
 * must still be able to close it. So the first write that fails is remembered and is the last that
 * reaches the file, which then is as if the program had been killed at that moment; HDF5 itself is
 * told that all is well. A file that another program has cut off is no longer written either, and
 * no longer read: HDF5 would take what is missing for its own tables. */
#pragma once

#include "base/h5.h"

enum { DEA_DISK_CUT = -1 };

struct dea_disk {
  int error;    // errno of the write that failed, or DEA_DISK_CUT; 0: none has
  int file;     // descriptor, locked against other writers; -1: closed
  bool lasting; // waits for the disk when the file is made and when it is closed
};

/* Sets the driver in a list of file access properties; false: HDF5 failed. disk: lent, outlives the
 * file. */
bool dea_disk_use(hid_t access, struct dea_disk *disk);

/* Whether the file still has that name: somebody may have removed or replaced it. */
bool dea_disk_is_named(const struct dea_disk *disk, const char *path);
/* Brings what was written so far to the disk itself. */
void dea_disk_sync(struct dea_disk *disk);
