/* What the scripts of `dea drive --export` end with, embedded by CMake. */
#pragma once

extern const char dea_asset_play_python[]; // play_nidaqmx.py
extern const char dea_asset_play_matlab[]; // play_matlab.m
