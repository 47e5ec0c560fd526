/* Orders for qsort. */
#pragma once

/* Numbers, rising. */
int dea_rising(const void *a, const void *b);
