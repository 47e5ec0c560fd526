/* base: context, text. */
#include "base/text.h"
#include "testing.h"

#include <stdint.h>
#include <string.h>

static void test_fail_keeps_message_and_chain(void **state)
{
  (void)state;
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(dea_fail(ctx, DEA_E_IO, "cannot open %s", "x"), DEA_E_IO);
  dea_fail_chain(ctx, DEA_E_IO, "inner", "a.c", 3);
  dea_fail_chain(ctx, DEA_E_IO, "outer", "b.c", 4);
  assert_string_equal(dea_context_message(ctx), "cannot open x");
  assert_string_equal(dea_context_chain(ctx), "inner (a.c:3) < outer (b.c:4)");
  dea_context_destroy(ctx);
}

static void test_alloc_refuses_overflow(void **state)
{
  (void)state;
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_null(dea_alloc(ctx, SIZE_MAX / 2, 16));
  assert_int_equal(dea_context_status(ctx), DEA_E_MEMORY);
  void *nothing = dea_alloc(ctx, 0, 8);
  assert_non_null(nothing);
  dea_free(ctx, nothing);
  dea_context_destroy(ctx);
}

static void test_nearest_name(void **state)
{
  (void)state;
  const char *const names[] = {"thickness", "width", "pre_stretch"};
  assert_string_equal(dea_nearest_name("thicknes", names, 3), "thickness");
  assert_string_equal(dea_nearest_name("Widht", names, 3), "width");
  assert_string_equal(dea_nearest_name("prestretch", names, 3), "pre_stretch");
  assert_null(dea_nearest_name("colour", names, 3));
}

static void test_text_to_double_ignores_locale(void **state)
{
  (void)state;
  const char *end;
  assert_close(dea_text_to_double("1.5 mm", &end), 1.5, 0, 0);
  assert_string_equal(end, " mm");
}

static void test_text_grows(void **state)
{
  (void)state;
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_text text = {.ctx = ctx};
  assert_string_equal(dea_text_get(&text), "");
  for (int i = 0; i < 1000; i++) {
    dea_text_add(&text, "%d,", i % 10);
  }
  assert_int_equal(text.length, 2000);
  assert_int_equal(strlen(dea_text_get(&text)), 2000);
  dea_text_free(&text);
  dea_context_destroy(ctx);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_fail_keeps_message_and_chain),
      cmocka_unit_test(test_alloc_refuses_overflow),
      cmocka_unit_test(test_nearest_name),
      cmocka_unit_test(test_text_to_double_ignores_locale),
      cmocka_unit_test(test_text_grows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
