/* Files that are embedded by CMake (cmake/embed.cmake): those of web/ that go into a page, and what
 * the scripts of `dea drive --export` end with. */
#ifndef DEA_BASE_ASSETS_H
#define DEA_BASE_ASSETS_H

#include <stddef.h>

extern const char dea_asset_style[]; // report.css
extern const size_t dea_asset_style_length;
extern const char dea_asset_script[]; // the scripts, one after the other
extern const size_t dea_asset_script_length;
extern const char dea_asset_core[]; // web/explorer.c as WebAssembly; length 0: not built
extern const size_t dea_asset_core_length;
extern const char dea_asset_play_python[]; // lab/protocol/play_nidaqmx.py
extern const size_t dea_asset_play_python_length;
extern const char dea_asset_play_matlab[]; // lab/protocol/play_matlab.m
extern const size_t dea_asset_play_matlab_length;

#endif
