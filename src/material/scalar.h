/* The number type of the material kernels.
 *
 * The files of src/material that hold formulas are compiled twice: with double for the library, and
 * with double complex for the tests (DEA_COMPLEX), where an imaginary step of 1e-20 in an argument
 * gives the derivative of the very same source to rounding error (Squire and Trapp, SIAM Review 40,
 * 1998). So: elementary functions through <tgmath.h>, comparisons on DEA_RE(x) only, no fabs, fmax,
 * conj or abs on such numbers. */
#pragma once

#include <tgmath.h>

#ifdef DEA_COMPLEX
typedef double _Complex dea_scalar;
#define DEA_RE(x) creal(x)
#define DEA_NAME(name) name##_complex
#else
typedef double dea_scalar;
#define DEA_RE(x) (x)
#define DEA_NAME(name) name
#endif
