/* Cuts of a line into elements whose size grows from its ends. */
#pragma once

#include <stddef.h>

/* Cuts of [0, 1] for a line of `length`: elements that are about `first` and `last` wide at its two
 * ends, grow by a factor of about `growth` (above 1) from one to the next, and are not wider than
 * `widest`. cuts: [at most max + 1], ascending from 0 to 1. Returns the number of elements, 0 for
 * more than max. */
size_t dea_cuts_graded(double length, double first, double last, double growth, double widest,
                       size_t max, double *cuts);

/* Cuts of [0, 1] into `count` elements, at least one, through a layer between two faces: from each
 * face each is twice as thick as the one before it, up to eight times. cuts: [count + 1]. */
void dea_cuts_through(size_t count, double *cuts);
