/* base: context, arena, text, what a schema prints, places for files. */
#include "base/arena.h"
#include "base/schema.h"
#include "base/text.h"
#include "base/write_file.h"
#include "failing_allocator.h"
#include "testing.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

TEST(test_fail_keeps_message_and_chain)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_int_equal(dea_fail(ctx, DEA_E_IO, "cannot open %s", "x"), DEA_E_IO);
  dea_fail_chain(ctx, DEA_E_IO, "inner", "a.c", 3);
  dea_fail_chain(ctx, DEA_E_IO, "outer", "b.c", 4);
  assert_string_equal(dea_context_message(ctx), "cannot open x");
  assert_string_equal(dea_context_chain(ctx), "inner (a.c:3) < outer (b.c:4)");
  dea_context_destroy(ctx);
}

TEST(test_trials_nest)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  const size_t outer = dea_finding_trial_begin(ctx), inner = dea_finding_trial_begin(ctx);
  dea_finding_trial_end(ctx, inner);
  dea_finding_add(ctx, DEA_ERROR, (struct dea_location){0}, "tried");
  dea_finding_trial_end(ctx, outer);
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), 0);
  dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0}, "kept");
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), 1);
  dea_context_destroy(ctx);
}

TEST(test_alloc_refuses_overflow)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_null(dea_alloc(ctx, SIZE_MAX / 2, 16));
  assert_int_equal(dea_context_status(ctx), DEA_E_MEMORY);
  void *nothing = dea_alloc(ctx, 0, 8);
  assert_non_null(nothing);
  dea_free(ctx, nothing);
  dea_context_destroy(ctx);
}

TEST(test_nearest_name)
{
  const char *const names[] = {"thickness", "width", "pre_stretch"};
  assert_string_equal(dea_nearest_name("thicknes", names, 3), "thickness");
  assert_string_equal(dea_nearest_name("Widht", names, 3), "width");
  assert_string_equal(dea_nearest_name("prestretch", names, 3), "pre_stretch");
  assert_null(dea_nearest_name("colour", names, 3));
  assert_string_equal(dea_nearest_name("thick", names, 3), "thickness");
  assert_string_equal(dea_nearest_name("Width-of-it", names, 3), "width");
  assert_null(dea_nearest_name("th", names, 3));
  static const char *const films[] = {"vhb-4905", "vhb-4910", "elastosil-2030"};
  assert_string_equal(dea_nearest_name("vhb-4910-viscous", films, 3), "vhb-4910");
  assert_string_equal(dea_nearest_name("elastosil", films, 3), "elastosil-2030");
  assert_null(dea_nearest_name("vhb", films, 3)); // one of two
}

TEST(test_flat_text)
{
  char text[] = "a\nb\x1b[1m\x7f \xc2\x9b\xc2\xb5 \xff\x9b.";
  dea_text_flatten(text);
  assert_string_equal(text, "a b [1m    \xc2\xb5 \xff\x9b."); // bytes that are no letters stay
  // what turns the direction of what follows: "V 0008" for "8000 V"
  char turned[] = "a\xe2\x80\xae"
                  "8\xe2\x80\xac\xe2\x81\xa6\xd8\x9c\xe2\x80\x8f\xe2\x80\x90.";
  dea_text_flatten(turned);
  assert_string_equal(turned, "a   8           \xe2\x80\x90.");
}

struct arena_use {
  struct dea_arena arena;
  double *x[20];
};

static dea_status fill_arena(struct dea_context *ctx)
{
  struct arena_use use = {.arena = {.ctx = ctx}};
  for (size_t i = 0; i < 20; i++) {
    use.x[i] = dea_arena_alloc(&use.arena, 100 + i, sizeof(double));
  }
  dea_status status = dea_arena_status(&use.arena);
  if (status == DEA_OK) { // zeroed, apart from each other, and moved with its arena
    struct arena_use moved = use;
    for (size_t i = 0; i < 20; i++) {
      for (size_t k = 0; k < 100 + i; k++) {
        assert_true(moved.x[i][k] == 0);
        moved.x[i][k] = (double)i + 1;
      }
    }
    use = moved;
  } else {
    assert_null(dea_arena_alloc(&use.arena, 1, 1)); // stays failed
  }
  dea_arena_free(&use.arena);
  assert_null(use.arena.last);
  return status;
}

TEST(test_arena_gives_and_frees_all)
{
  assert_int_equal(failing_ends(fill_arena, DEA_OK), 20);
}

/* A file is in the way until it may be replaced; a folder stays. */
TEST(test_way_for_a_file)
{
  struct dea_context *ctx;
  char here[] = "way-XXXXXX", name[64];
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  assert_non_null(mkdtemp(here));
  assert_int_equal(dea_path_create_folders(ctx, here, "a", false), DEA_OK);
  snprintf(name, sizeof name, "%s/a", here);
  assert_int_equal(dea_file_write_into(ctx, here, "a", "text", 4), DEA_OK);
  assert_true(dea_path_exists(name));
  assert_int_equal(dea_path_create_folders(ctx, here, "a", false), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "already exists"));
  assert_true(dea_path_exists(name));
  assert_int_equal(dea_path_create_folders(ctx, here, "a", true), DEA_OK);
  assert_false(dea_path_exists(name));
  assert_int_equal(dea_folder_create(ctx, name), DEA_OK);
  assert_int_equal(dea_path_create_folders(ctx, here, "a", false), DEA_OK);
  assert_int_equal(dea_path_create_folders(ctx, here, "a", true), DEA_OK);
  assert_true(dea_path_is_folder(name));
  assert_true(rmdir(name) == 0 && rmdir(here) == 0);
  dea_context_destroy(ctx);
}

TEST(test_letters)
{
  static const char *const bad[] = {"\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\x80",
                                    "\xf0\x9f"};
  unsigned code;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    assert_int_equal(dea_letter_read(bad[i], &code), 0);
    assert_int_equal(code, 0xfffd);
  }
  assert_int_equal(dea_letter_read("\xf0\x9f\x98\x80", &code), 4);
  assert_int_equal(code, 0x1f600);
}

TESTS(NULL, NULL)
