/* Parts of the program that are loaded when they are needed, since the libraries that they bring
 * along take longer to load than most commands to run. */
#pragma once

#include "base/context.h"

/* Before the declaration of the symbol that a module is opened for: all others are hidden. */
#if defined(__GNUC__)
#define DEA_MODULE_SYMBOL __attribute__((visibility("default")))
#else
#define DEA_MODULE_SYMBOL
#endif

/* Path of a module's file ("dea_solid_module.so") into out[size]: in the folder that DEA_MODULES
 * names, installed, or built here. false when it is in none of them. */
bool dea_module_find(const char *file, char *out, size_t size);
/* Loads it for good and finds a symbol of it. what, advice: for the message ("the 3D engine", "it
 * is built when ..."). DEA_E_UNSUPPORTED when it is not there or cannot be loaded. */
dea_status dea_module_open(struct dea_context *ctx, const char *file, const char *symbol,
                           const char *what, const char *advice, const void **out);
