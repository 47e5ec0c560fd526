/* The film on the bench, of a design file by a model. */
#pragma once

#include "protocol/bench_film.h"

extern const struct dea_bench_film_type dea_film_of_design;
