/* The table of studies of README.md is what the models can. */
#include "design_text.h"
#include "study/study.h"
#include "testing.h"

#include "base/file.h"
#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <stdio.h>
#include <string.h>

#define COMPUTE                                                                                    \
  "compute: {voltage: {values: [1 kV]}, solid: {path: yes}, operating_map: {rows: 3}}\n"

static const char disc[] = GOOD_DESIGN COMPUTE;
static const char other[] =
    "dea: 1\nshapes: [{name: film, kind: rectangle, width: 20 mm, height: 10 mm}]\n"
    "plies: [{name: film, shape: film, material: film, thickness: 50 um}]\n"
    "electrodes: [{ply: film, side: bottom, shape: film, channel: ground},"
    " {ply: film, side: top, shape: film, channel: drive}]\n"
    "supports: [{edge: film}]\n"
    "pressures: [{ply: film, side: bottom, shape: film, pressure: 100 Pa}]\n" FILM_MATERIAL COMPUTE;

struct built {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
};

static struct built build(const char *text)
{
  struct built b;
  const dea_status status = read_and_build(ctx, text, NULL, 0, &b.design, &b.device);
  if (status != DEA_OK) {
    print_findings(ctx);
  }
  assert_int_equal(status, DEA_OK);
  assert_int_equal(dea_result_create(ctx, b.design, b.device, &b.result), DEA_OK);
  return b;
}

static void end(struct built *b)
{
  dea_result_destroy(ctx, b->result);
  dea_device_destroy(ctx, b->device);
  dea_design_destroy(ctx, b->design);
}

/* Models that can make a study of a device: "lumped, 3d". */
static void list_models(const struct dea_study *study, const struct built *b, char out[80])
{
  size_t count;
  const struct dea_model_type *const *types = dea_model_all(&count);
  out[0] = '\0';
  for (size_t i = 0; i < count; i++) {
    const bool takes = b->device->disc || types[i]->any_layout;
    if (takes && (dea_study_known_to(study, types[i], b->result))) {
      snprintf(out + strlen(out), 80 - strlen(out), "%s`%s`", out[0] != '\0' ? ", " : "",
               types[i]->name);
    }
  }
}

TEST(test_table_of_studies)
{
  char *text;
  size_t length, count, wrong = 0;
  struct built discs = build(disc), others = build(other);
  const struct dea_study *const *all = dea_study_all(&count);
  assert_int_equal(dea_file_read(ctx, DEA_SOURCE_DIR "/README.md", 1 << 20, &text, &length),
                   DEA_OK);
  for (size_t i = 0; i < count; i++) {
    char row[300], of_disc[80], of_other[80];
    list_models(all[i], &discs, of_disc);
    of_disc[strcmp(all[i]->name, "loading") == 0 ? 0 : sizeof of_disc - 1] = '\0'; // of bodies
    list_models(all[i], &others, of_other);
    snprintf(row, sizeof row, "| `%s` | %s | %s |", all[i]->name,
             of_disc[0] != '\0' ? of_disc : "see `force`",
             of_other[0] != '\0' ? of_other : "see `loading`");
    if (strstr(text, row) == NULL) {
      fprintf(stderr, "README.md lacks the row: %s\n", row);
      wrong++;
    }
  }
  assert_int_equal(wrong, 0);
  dea_free(ctx, text);
  end(&discs);
  end(&others);
}

TESTS(context_set_up, context_tear_down)
