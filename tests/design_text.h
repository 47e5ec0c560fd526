/* A small good design, and reading it in tests. */
#pragma once

#include "device/device.h"
#include "study/design_file.h"
#include "testing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Materials of the tests stand in the file itself, so that the catalogue may change. */
#define FILM_MATERIAL                                                                              \
  "materials:\n"                                                                                   \
  "  - name: film\n"                                                                               \
  "    kind: elastomer\n"                                                                          \
  "    laws:\n"                                                                                    \
  "      - {id: a, law: yeoh, parameters: {c1: 178.4 kPa, c2: -6 kPa, c3: 4.2 kPa},\n"             \
  "         stretch_range: [1, 2], source: test}\n"                                                \
  "      - {id: b, law: neo-hookean, parameters: {mu: 300 kPa}, source: test}\n"                   \
  "    permittivity:\n"                                                                            \
  "      - {id: flat, at_rest: 2.8, source: test}\n"                                               \
  "      - {id: sloped, at_rest: 2.48, slope: -0.28, source: test}\n"                              \
  "    breakdown:\n"                                                                               \
  "      [{id: x, at_rest: 80 V/um, exponent: 1.5, source: test},"                                 \
  "       {id: y, at_rest: 100 V/um, source: test}]\n"                                             \
  "  - name: stiff\n"                                                                              \
  "    kind: plastic\n"                                                                            \
  "    elastic: {young_modulus: 2950 MPa, poisson_ratio: 0.38, source: test}\n"

#define GOOD_DESIGN                                                                                \
  "dea: 1\n"                                                                                       \
  "film: {material: film, thickness: 100 um}\n"                                                    \
  "pre_stretch: 1.5\n"                                                                             \
  "frame: {inner_diameter: 30 mm}\n"                                                               \
  "electrodes: {diameter: 5 mm unstretched}\n"                                                     \
  "fibres: {count: 4, material: stiff}\n" FILM_MATERIAL

/* The first finding of that severity whose text holds part, or NULL. */
static inline const struct dea_finding *find_finding(const struct dea_context *ctx,
                                                     enum dea_severity severity, const char *part)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == severity && strstr(findings[i].text, part) != NULL) {
      return &findings[i];
    }
  }
  return NULL;
}

static inline const struct dea_finding *find_error(const struct dea_context *ctx, const char *part)
{
  return find_finding(ctx, DEA_ERROR, part);
}

static inline void print_findings(const struct dea_context *ctx)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    print_message("%s:%zu:%zu: %s\n", findings[i].location.file, findings[i].location.line,
                  findings[i].location.column, findings[i].text);
  }
}

/* Reads and builds; both stay NULL after a failure. */
static inline dea_status read_and_build(struct dea_context *ctx, const char *text,
                                        const struct dea_override *overrides, size_t count,
                                        struct dea_design **design, struct dea_device **device)
{
  *device = NULL;
  dea_status status =
      dea_design_read_memory(ctx, "t.yaml", text, strlen(text), overrides, count, design);
  return status == DEA_OK ? dea_device_build(ctx, *design, device) : status;
}
