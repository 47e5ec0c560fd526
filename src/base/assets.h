/* Files of web/ that go into a page, and sources that are written, embedded by CMake
 * (cmake/embed.cmake). */
#pragma once

#include <stddef.h>

extern const char dea_asset_style[]; // report.css
extern const size_t dea_asset_style_length;
extern const char dea_asset_script[]; // the scripts, one after the other
extern const size_t dea_asset_script_length;
extern const char dea_asset_reduced[]; // reduced_core.h and reduced_core.c of model/reduced
extern const size_t dea_asset_reduced_length;
extern const char dea_asset_fmi3[]; // fmi3.c of model/reduced/fmi
extern const size_t dea_asset_fmi3_length;
extern const char dea_asset_studio_page[]; // the page of dea studio, with its own style and script
extern const size_t dea_asset_studio_page_length;
extern const char dea_asset_studio_style[];
extern const size_t dea_asset_studio_style_length;
extern const char dea_asset_studio_script[];
extern const size_t dea_asset_studio_script_length;
