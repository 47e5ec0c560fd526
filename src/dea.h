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
#include "base/file.h"
#include "base/schema.h"
#include "base/status.h"
#include "base/text.h"
#include "base/units.h"
#include "base/value.h"
#include "base/version.h"
#include "base/yaml.h"
#include "design/design.h"
#include "design/fabrication.h"
#include "device/device.h"
#include "fabricate/contour.h"
#include "fabricate/fab_geometry.h"
#include "fabricate/files.h"
#include "fabricate/part.h"
#include "fabricate/workshop.h"
#include "lab/drive/drive.h"
#include "lab/import/import.h"
#include "lab/import/mat.h"
#include "lab/instrument/zero.h"
#include "lab/protocol/export.h"
#include "lab/protocol/protocol.h"
#include "lab/recording/recorder.h"
#include "lab/recording/recording.h"
#include "lab/recording/table.h"
#include "lab/reduce/reduce.h"
#include "material/branch.h"
#include "material/catalogue.h"
#include "material/law.h"
#include "material/material.h"
#include "material/plane.h"
#include "material/point.h"
#include "material/scalar.h"
#include "model/circuit.h"
#include "model/film.h"
#include "model/lumped/lumped.h"
#include "model/model.h"
#include "output/csv.h"
#include "output/plot.h"
#include "output/report/report.h"
#include "output/results_h5.h"
#include "output/run_folder.h"
#include "output/summary.h"
#include "result/columns.h"
#include "result/field_mesh.h"
#include "result/load_point.h"
#include "result/profile.h"
#include "result/provenance.h"
#include "result/result.h"
#include "result/state.h"
#include "result/time_series.h"
#include "study/study.h"
#include "waveform/waveform.h"

#ifdef __cplusplus
}
#endif

#endif
