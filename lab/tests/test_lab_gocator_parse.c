// The Gocator's messages: field by field, in pieces, and damaged.
#include "gocator_bytes.h"
#include "instrument/gocator_parse.h"
#include "testing.h"

static size_t count_events(struct dea_gdp *g, const struct gocator_bytes *b, size_t part,
                           size_t seen[8])
{
  size_t odd = 0;
  memset(seen, 0, 8 * sizeof *seen);
  for (size_t at = 0; at < b->length; at += part) {
    const unsigned char *bytes = b->bytes + at;
    size_t length = b->length - at < part ? b->length - at : part;
    enum dea_gdp_event event;
    while ((event = dea_gdp_next(g, &bytes, &length)) != DEA_GDP_MORE) {
      seen[event]++;
      odd += event == DEA_GDP_ODD;
      if (event == DEA_GDP_BROKEN) {
        return odd;
      }
    }
  }
  return odd;
}

TEST(test_messages)
{
  static struct gocator_bytes b;
  static struct dea_gdp g;
  static const double x_um[] = {-20, -10, 0, 10, 20};
  static const double z_um[] = {1000, 1050, 0, 900, 17383.5};
  for (size_t part = 1; part < 400; part += part < 20 ? 1 : 37) {
    size_t seen[8];
    memset(&g, 0, sizeof g);
    gocator_frame(&b, 0, 123456);
    count_events(&g, &b, part, seen);
    assert_int_equal(seen[DEA_GDP_STAMPS], 1);
    assert_int_equal(seen[DEA_GDP_MEASUREMENT], 2);
    assert_int_equal(seen[DEA_GDP_PROFILES], 1);
    assert_int_equal(seen[DEA_GDP_ODD], 0);
    assert_int_equal(g.stamps[0].time_us, 123456);
    assert_int_equal(g.profiles.width, GOCATOR_WIDTH);
    for (size_t i = 0; i < GOCATOR_WIDTH; i++) {
      double x_m, z_m;
      assert_int_equal(dea_gdp_point(&g.profiles, 0, i, &x_m, &z_m), i != 2);
      assert_close(x_m, 1e-6 * x_um[i], 1e-12, 1e-18);
      assert_true(i == 2 || fabs(z_m - 1e-6 * z_um[i]) < 1e-15);
    }
  }
}

/* Every field of the messages made wrong by itself: odd or broken, never more than is there. */
TEST(test_odd_messages)
{
  static struct gocator_bytes good, b;
  static struct dea_gdp g;
  gocator_frame(&good, 0, 1);
  for (size_t at = 0; at < good.length; at++) {
    static const unsigned char values[] = {0, 1, 0x7f, 0x80, 0xff};
    for (size_t v = 0; v < sizeof values; v++) {
      size_t seen[8];
      memset(&g, 0, sizeof g);
      b = good;
      b.bytes[at] = values[v];
      count_events(&g, &b, 64, seen);
      if (seen[DEA_GDP_PROFILES] > 0) {
        double x_m, z_m;
        size_t last = g.profiles.width - 1;
        dea_gdp_point(&g.profiles, g.profiles.count - 1, last, &x_m, &z_m);
      }
    }
  }
  size_t seen[8];
  b.length = 0; // a profile that claims four thousand million points
  gocator_profile(&b, 0, GOCATOR_WIDTH, 10000, 500, 0, 0, gocator_ranges);
  memset(b.bytes + 8, 0xff, 8);
  memset(&g, 0, sizeof g);
  assert_int_equal(count_events(&g, &b, b.length, seen), 1);
  memset(b.bytes, 0xff, 4); // a message of 4 GiB
  memset(&g, 0, sizeof g);
  count_events(&g, &b, b.length, seen);
  assert_int_equal(seen[DEA_GDP_BROKEN], 1);
}

TESTS(NULL, NULL)
