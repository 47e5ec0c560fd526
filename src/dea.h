/* The whole public interface of libdea.
 *
 *   cc program.c $(pkg-config --cflags --libs libdea)
 *
 * Each header also stands alone in C17. A C++ program includes this one, which gives all of them C
 * linkage; the standard headers come first because they must stay outside of it. The list below is
 * also the list of the headers that are installed. */
#ifndef DEA_H
#define DEA_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <tgmath.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "base/context.h"
#include "base/status.h"
#include "base/text.h"
#include "base/version.h"
#include "design/design.h"
#include "device/device.h"
#include "material/law.h"
#include "material/material.h"
#include "material/plane.h"
#include "material/scalar.h"
#include "model/load_point.h"
#include "model/model.h"
#include "result/result.h"

#ifdef __cplusplus
}
#endif

#endif
