/* web/dense_wasm.c beside LAPACK's functions of the same names. */
#define dea_dense_solve small_dense_solve
#define dea_dense_negative small_dense_negative
#include "../web/dense_wasm.c"
