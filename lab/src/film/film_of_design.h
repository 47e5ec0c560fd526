/* The film on the bench, of a design file by a model. */
#ifndef DEA_JOB_FILM_OF_DESIGN_H
#define DEA_JOB_FILM_OF_DESIGN_H

#include "protocol/bench_film.h"

extern const struct dea_bench_film_type dea_film_of_design;

#endif
