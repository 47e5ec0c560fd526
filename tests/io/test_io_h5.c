/* output/h5: readers take what they have room for. */
#include "base/h5.h"
#include "testing.h"

/* An attribute with many texts or numbers where one is due would write past its reader's room. */
TEST(test_store_reads_single_attributes_only)
{
  enum { MANY = 1000 };
  static const char texts[MANY][8];
  static const long long numbers[MANY];
  const hsize_t many = MANY;
  struct h5 h;
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 16, false); // in memory only
  hid_t file = H5Fcreate("many.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  hid_t space = H5Screate_simple(1, &many, NULL), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, 8);
  hid_t of_texts = H5Acreate2(file, "texts", type, space, H5P_DEFAULT, H5P_DEFAULT);
  hid_t of_numbers = H5Acreate2(file, "numbers", H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Awrite(of_texts, type, texts) >= 0);
  assert_true(H5Awrite(of_numbers, H5T_NATIVE_LLONG, numbers) >= 0);
  char text[8];
  dea_h5_begin(&h, ctx, "many.h5");
  dea_h5_get_text(&h, file, "texts", text, sizeof text);
  assert_int_equal(h.status, DEA_E_IO);
  assert_string_equal(text, "");
  h.status = DEA_OK;
  dea_h5_get_int(&h, file, "numbers");
  assert_int_equal(h.status, DEA_E_IO);
  dea_h5_end(&h);
  H5Aclose(of_numbers);
  H5Aclose(of_texts);
  H5Tclose(type);
  H5Sclose(space);
  H5Fclose(file);
  H5Pclose(access);
  dea_context_destroy(ctx);
}

/* Files of libdea 0.1 say that long texts are UTF-8; now they say ASCII, for Octave. */
TEST(test_long_text_of_older_files)
{
  static const char text[] = "80 \302\265m";
  struct h5 h;
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  dea_h5_begin(&h, ctx, "texts.h5");
  hid_t file = dea_h5_file_create(&h);
  hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, sizeof text);
  H5Tset_cset(type, H5T_CSET_UTF8);
  hid_t old = H5Dcreate2(file, "old", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  assert_true(H5Dwrite(old, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0);
  dea_h5_write_long_text(&h, file, "new", text);
  char *of_old = dea_h5_get_long_text(&h, file, "old");
  char *of_new = dea_h5_get_long_text(&h, file, "new");
  assert_int_equal(h.status, DEA_OK);
  assert_string_equal(of_old, text);
  assert_string_equal(of_new, text);
  dea_free(ctx, of_new);
  dea_free(ctx, of_old);
  H5Dclose(old);
  H5Tclose(type);
  H5Sclose(space);
  H5Fclose(file);
  dea_h5_end(&h);
  dea_context_destroy(ctx);
}

TESTS(NULL, NULL)
