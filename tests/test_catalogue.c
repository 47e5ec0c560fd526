/* The catalogue: every material of the tree reads, and own directories go first. */
#define _POSIX_C_SOURCE 200809L // setenv, mkdtemp
#include "command.h"
#include "material/catalogue.h"

static struct dea_context *ctx;

static int set_up(void **state)
{
  if (dea_context_create(NULL, &ctx) != DEA_OK || command_set_up(state) != 0) {
    return -1;
  }
  return setenv("DEA_MATERIALS", command_folder, 1);
}

static int tear_down(void **state)
{
  unsetenv("DEA_MATERIALS");
  dea_context_destroy(ctx);
  return command_tear_down(state);
}

#define OWN(name, modulus)                                                                         \
  "dea_material: 1\nname: " name "\nkind: plastic\n"                                               \
  "elastic: {young_modulus: " modulus ", poisson_ratio: 0.3, source: test}\n"

static const struct dea_location nowhere = {"", 0, 0};

static void test_all_read_and_have_sources(void **state)
{
  (void)state;
  const char **names;
  size_t count;
  assert_int_equal(dea_catalogue_names(ctx, &names, &count), DEA_OK);
  assert_true(count >= 5);
  for (size_t i = 0; i < count; i++) {
    struct dea_catalogue_entry *entry;
    if (dea_catalogue_read(ctx, names[i], nowhere, &entry) != DEA_OK) {
      fail_msg("%s: %s", names[i], dea_context_message(ctx));
    }
    assert_string_equal(entry->data.name.text, names[i]);
    for (size_t j = 0; j < entry->data.law_count; j++) {
      assert_non_null(entry->data.laws[j].law);
      assert_true(strlen(entry->data.laws[j].notes.source) > 0);
    }
    dea_catalogue_destroy(ctx, entry);
  }
  dea_free(ctx, names);
}

static void test_elastosil_has_the_numbers_of_the_paper(void **state)
{
  (void)state;
  struct dea_catalogue_entry *entry;
  struct dea_material film;
  const struct dea_material_choice first = {0}, second = {.law = "yeoh-181"};
  assert_int_equal(dea_catalogue_read(ctx, "elastosil-2030", nowhere, &entry), DEA_OK);
  assert_int_equal(dea_material_select(ctx, &entry->data, &first, &film), DEA_OK);
  assert_string_equal(film.law->name, "yeoh");
  assert_close(film.param[0], 178.4e3, 1e-14, 0);
  assert_close(film.param[1], -6.0e3, 1e-14, 0);
  assert_close(film.param[2], 4.2e3, 1e-14, 0);
  assert_close(film.permittivity.at_rest, 2.8, 1e-14, 0);
  assert_close(film.density_kg_per_m3, 970, 1e-14, 0);
  assert_int_equal(dea_material_select(ctx, &entry->data, &second, &film), DEA_OK);
  assert_close(film.param[0], 180.7e3, 1e-14, 0);
  dea_catalogue_destroy(ctx, entry);
}

static void test_own_directory_goes_first(void **state)
{
  (void)state;
  command_write("pet.yaml", OWN("pet", "1 GPa"));
  struct dea_catalogue_entry *entry;
  assert_int_equal(dea_catalogue_read(ctx, "pet", nowhere, &entry), DEA_OK);
  assert_close(entry->data.elastic.young_modulus_Pa.si, 1e9, 1e-14, 0);
  dea_catalogue_destroy(ctx, entry);
}

static void test_unknown_name_lists_all(void **state)
{
  (void)state;
  struct dea_catalogue_entry *entry;
  const struct dea_location location = {"x.yaml", 3, 4};
  assert_int_equal(dea_catalogue_read(ctx, "elastosil-203", location, &entry), DEA_E_DESIGN);
  assert_null(entry);
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  assert_int_equal(count, 1);
  assert_int_equal(findings[0].location.line, 3);
  assert_contains(findings[0].text, "did you mean 'elastosil-2030'?");
  assert_contains(findings[0].text, "vhb-4910");
}

static void test_names_do_not_leave_the_directories(void **state)
{
  (void)state;
  static const char *const names[] = {"../materials/pet", "/etc/passwd", ".", "", "a/b"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    struct dea_catalogue_entry *entry;
    assert_int_equal(dea_catalogue_read(ctx, names[i], nowhere, &entry), DEA_E_DESIGN);
  }
}

static void test_bad_files(void **state)
{
  (void)state;
  static const struct {
    const char *text, *part;
    size_t line;
  } bad[] = {
      {OWN("other", "1 GPa"), "must stand in a file 'other.yaml'", 2},
      {OWN("bad", "1 mm"), "'1 mm' is a length, but a pressure is due", 4},
      {"name: bad\nkind: plastic\n", "lacks 'dea_material'", 1},
      {"dea_material: 1\nname: bad\nkind: plastic\n"
       "laws:\n  - {id: a, law: neo-hookean, parameters: {mu: 1 kPa}, source: s}\n"
       "  - {id: a, law: neo-hookean, parameters: {mu: 1 kPa}, source: s}\n",
       "the id 'a' is taken", 6},
      {"dea_material: 1\nname: bad\nkind: plastic\n"
       "laws:\n  - {id: a, law: neo-hookean, parameters: {mu: 1 kPa}, source: s,\n"
       "     stretch_range: [2, 1]}\n",
       "stretch_range must rise", 6},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    struct dea_catalogue_entry *entry;
    command_write("bad.yaml", bad[i].text);
    dea_finding_clear(ctx);
    assert_int_equal(dea_catalogue_read(ctx, "bad", nowhere, &entry), DEA_E_DESIGN);
    size_t count;
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    assert_int_equal(count, 1);
    assert_contains(findings[0].text, bad[i].part);
    assert_int_equal(findings[0].location.line, bad[i].line);
  }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
  const struct CMUnitTest tests[] = {
      TEST(test_all_read_and_have_sources),
      TEST(test_elastosil_has_the_numbers_of_the_paper),
      TEST(test_own_directory_goes_first),
      TEST(test_unknown_name_lists_all),
      TEST(test_names_do_not_leave_the_directories),
      TEST(test_bad_files),
  };
#undef TEST
  return cmocka_run_group_tests(tests, NULL, NULL);
}
