/* What cannot be built is said at its place in the design, and nothing crashes or leaks. */
// ctest: slow
#include "design_text.h"
#include "fabricate/dxf_write.h"
#include "fabricate/svg.h"
#include "failing_allocator.h"

#define DESIGN                                                                                     \
  "dea: 1\n"                                                                                       \
  "film: {material: film, thickness: 100 um}\n"                                                    \
  "pre_stretch: 1.5\n"                                                                             \
  "frame: {inner_diameter: 30 mm}\n"                                                               \
  "electrodes: {diameter: 5 mm unstretched}\n"                                                     \
  "fibres: {count: 4, material: stiff, width: 2 mm}\n"                                             \
  "fabrication:\n"                                                                                 \
  "  kerf: 0.2 mm\n"                                                                               \
  "  minimum_feature: 0.5 mm\n"                                                                    \
  "  copies: 1\n"                                                                                  \
  "  sheet: {width: 210 mm, height: 297 mm}\n"                                                     \
  "  leads: {width: 1 mm unstretched, pad_diameter: 5 mm stretched}\n"                             \
  "  ring: {width: 10 mm, contact_window: 3 mm}\n"                                                 \
  "  holder: {anchor: 3 mm, tab_width: 1 mm}\n"                                                    \
  "  marks: {diameter: 1 mm unstretched, grid: 5 mm unstretched}\n" FILM_MATERIAL

static dea_status make_files(struct dea_context *ctx, const struct dea_design *from,
                             const struct dea_device *built)
{
  struct dea_workshop *workshop = NULL;
  dea_status status = dea_workshop_create(ctx, from, built, &workshop);
  for (size_t i = 0; status == DEA_OK && i < workshop->count; i++) {
    struct dea_text text = {.ctx = ctx};
    status = dea_dxf_write(workshop, i, &text);
    status = status == DEA_OK ? dea_svg_write(workshop, i, &text) : status;
    dea_text_free(&text);
  }
  dea_workshop_destroy(ctx, workshop);
  return status;
}

static dea_status build(struct dea_context *ctx, const char *text, const struct dea_override *sets,
                        size_t count)
{
  struct dea_design *from = NULL;
  struct dea_device *built = NULL;
  dea_status status = read_and_build(ctx, text, sets, count, &from, &built);
  status = status == DEA_OK ? make_files(ctx, from, built) : status;
  dea_device_destroy(ctx, built);
  dea_design_destroy(ctx, from);
  return status;
}

/* One value changed in the text, so that the finding has a line; the line of the key is wanted. */
static void expect(const char *from, const char *to, const char *message, size_t line)
{
  struct dea_context *ctx;
  static char text[8192];
  const char *at = strstr(DESIGN, from);
  assert_non_null(at);
  snprintf(text, sizeof text, "%.*s%s%s", (int)(at - DESIGN), DESIGN, to, at + strlen(from));
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(build(ctx, text, NULL, 0), DEA_E_DESIGN);
  const struct dea_finding *finding = find_error(ctx, message);
  if (finding == NULL) {
    print_findings(ctx);
    fail_msg("'%s' is not said", message);
  } else if (finding->location.line != line) {
    print_findings(ctx);
    fail_msg("'%s' is said at line %zu, wanted %zu", message, finding->location.line, line);
  }
  dea_context_destroy(ctx);
}

TEST(test_what_cannot_be_built)
{
  expect("kerf: 0.2 mm", "kerf: 0.6 mm", "a cut of 0.6 mm width makes no features of 0.5 mm", 8);
  expect("width: 1 mm uns", "width: 0.4 mm uns", "only 0.4 mm lie between two edges", 12);
  expect("width: 1 mm uns", "width: 6 mm uns", "wider than the pad of 5 mm", 12);
  expect("pad_diameter: 5", "pad_diameter: 11", "does not fit on the ring of 10 mm", 12);
  expect("contact_window: 3", "contact_window: 6", "larger than the pad", 13);
  expect("contact_window: 3", "contact_window: 0.3", "smaller than the minimum feature", 13);
  expect("diameter: 1 mm uns", "diameter: 0.3 mm uns", "smaller than the minimum feature", 15);
  expect("diameter: 1 mm uns", "diameter: 9 mm uns", "do not fit on the fibres' holder", 15);
  expect("grid: 5 mm", "grid: 1 um", "more than 10000 crosses", 15);
  expect("anchor: 3 mm", "anchor: 9 mm", "a fibre is longer than the frame", 14);
  expect("tab_width: 1 mm", "tab_width: 2.5 mm", "wider than a fibre", 14);
  expect("tab_width: 1 mm", "tab_width: 0.2 mm", "only 0.2 mm lie between", 14);
  expect("width: 210 mm", "width: 40 mm", "too small for the part", 11);
  expect("height: 297 mm", "height: 40 mm", "too small for the part", 11);
  expect("copies: 1", "copies: 99", "copies: a sheet of 210 mm x 297 mm takes", 10);
  // fibres that nearly touch, and one that does not fit into its frame at all
  expect("count: 4", "count: 11", "lie between two edges", 6);
  expect("width: 2 mm}", "width: 2 mm, length: 16 mm stretched}", "reach beyond the centre", 6);
  expect("width: 2 mm}", "width: 0.2 mm}", "a tab of 1 mm width is wider than a fibre", 14);
}

TEST(test_parts_that_overlap)
{
  // fibres that overlap, and leads at a right angle that are nearly as wide as their electrode
  expect("count: 4", "count: 16", "overlap each other", 6);
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  const struct dea_override sets[] = {{"fibres.count", "2"},
                                      {"fabrication.leads.angle", "0 degree"},
                                      {"electrodes.diameter", "1.2 mm unstretched"},
                                      {"fibres.width", "1 mm"}};
  assert_int_equal(build(ctx, DESIGN, sets, 4), DEA_E_DESIGN);
  assert_non_null(find_error(ctx, "leads of the two electrodes overlap"));
  dea_context_destroy(ctx);
}

/* Designs that are read before, with a context of their own. */
static struct dea_design *design;
static struct dea_device *device;

static dea_status build_all(struct dea_context *ctx)
{
  return make_files(ctx, design, device);
}

TEST(test_each_allocation)
{
  static const struct dea_override sets[][1] = {
      {{"fabrication.marks.grid", "20 mm unstretched"}}, // good
      {{"fabrication.minimum_feature", "3 mm"}},         // things that are too narrow
      {{"fabrication.kerf", "1 mm"}}};
  for (size_t i = 0; i < 3; i++) {
    struct dea_context *ctx;
    assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
    assert_int_equal(read_and_build(ctx, DESIGN, sets[i], 1, &design, &device), DEA_OK);
    assert_true(failing_ends(build_all, i == 0 ? DEA_OK : DEA_E_DESIGN) > (i == 0 ? 20 : 2));
    dea_device_destroy(ctx, device);
    dea_design_destroy(ctx, design);
    dea_context_destroy(ctx);
  }
}

TESTS(NULL, NULL)
