/* Drawings and process sheets: words that do not lie on each other, amounts by closed forms, and
 * allocations that fail. */
#include "fabricate/pages.h"
#include "fabricate/picture.h"
#include "fabricate/process.h"
#include "failing_allocator.h"
#include "workshop_fixture.h"

static const double pi = 3.14159265358979323846;

/* ---- a canvas that notes where words are ---- */

enum { WORDS_MAX = 4000 };
static struct {
  double box[4];
  char text[80];
} words[WORDS_MAX];
static size_t word_count, page_start, pages;
static double page_width, page_height;

static void check_page(void)
{
  for (size_t i = page_start; i < word_count; i++) {
    const double *a = words[i].box;
    if (a[0] < 0 || a[1] < 0 || a[2] > page_width || a[3] > page_height) {
      fail_msg("page %zu: '%s' leaves the page", pages, words[i].text);
    }
    for (size_t j = page_start; j < i; j++) {
      const double *b = words[j].box;
      if (a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]) {
        fail_msg("page %zu: '%s' lies on '%s'", pages, words[i].text, words[j].text);
      }
    }
  }
  page_start = word_count;
  pages++;
}

static void fake_page(struct dea_canvas *canvas, double width_mm, double height_mm)
{
  check_page();
  page_width = width_mm;
  page_height = height_mm;
}

static void fake_contour(struct dea_canvas *canvas, const struct dea_contour *contour, double scale,
                         double x_mm, double y_mm)
{
  for (size_t i = 0; i < dea_contour_pieces(contour); i++) {
    const struct dea_piece piece = dea_contour_piece(contour, i);
    assert_true(isfinite(x_mm + scale * piece.from[0]) && isfinite(y_mm + scale * piece.from[1]));
  }
}

static void fake_line(struct dea_canvas *canvas, double x0, double y0, double x1, double y1)
{
  assert_true(isfinite(x0) && isfinite(y0) && isfinite(x1) && isfinite(y1));
}

static void fake_fill(struct dea_canvas *canvas, unsigned colour, double opacity, bool keep)
{
  (void)canvas, (void)colour, (void)opacity, (void)keep;
}

static void fake_stroke(struct dea_canvas *canvas, double width_mm, unsigned colour, double dash_mm)
{
  (void)canvas, (void)width_mm, (void)colour, (void)dash_mm;
}

static void fake_clip(struct dea_canvas *canvas)
{
}

static double fake_width(struct dea_canvas *canvas, double size_mm, bool bold, const char *text)
{
  return size_mm * (bold ? 0.68 : 0.6) * (double)strlen(text); // as DejaVu Sans has it, about
}

static void fake_text(struct dea_canvas *canvas, double x_mm, double y_mm, double size_mm,
                      enum dea_align align, bool bold, unsigned colour, const char *text)
{
  assert_true(word_count < WORDS_MAX);
  double width = fake_width(canvas, size_mm, bold, text);
  double x = x_mm - (align == DEA_ALIGN_LEFT ? 0 : align == DEA_ALIGN_CENTRE ? 0.5 : 1) * width;
  double *box = words[word_count].box;
  box[0] = x, box[1] = y_mm - 0.2 * size_mm, box[2] = x + width, box[3] = y_mm + 0.75 * size_mm;
  snprintf(words[word_count++].text, 80, "%.79s", text);
}

static const struct dea_canvas_type fake = {.page = fake_page,
                                            .contour = fake_contour,
                                            .line = fake_line,
                                            .box = fake_line,
                                            .fill = fake_fill,
                                            .stroke = fake_stroke,
                                            .clip = fake_clip,
                                            .unclip = fake_clip,
                                            .text = fake_text,
                                            .text_width = fake_width};
static const struct dea_paper paper = {&fake, NULL};

static void begin(double width_mm, double height_mm)
{
  word_count = page_start = pages = 0;
  page_width = width_mm;
  page_height = height_mm;
}

/* ---- designs ---- */

static void make(const struct dea_override *sets, size_t count)
{
  if (workshop_make(GOOD_DESIGN, sets, count) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s", dea_context_message(ctx));
  }
}

static const struct variant {
  struct dea_override sets[4];
  size_t count;
} variants[] = {
    {.count = 0},
    {{{"fibres", "null"}}, 1},
    {{{"fibres.count", "1"},
      {"title", "A title that is far too long to fit onto the first line of "
                "a page of A4, so that it has to be cut somewhere"}},
     2},
    {{{"fibres.count", "8"},
      {"fibres.tip_width", "1 mm"},
      {"fabrication.leads.width", "0.5 mm unstretched"},
      {"fibres.bond.thickness", "50 um"}},
     4},
    {{{"fibres.outer_end", "free"},
      {"electrodes.diameter", "20 mm stretched"},
      {"fabrication.copies", "3"}},
     3},
    {{{"frame.inner_diameter", "200 mm"}, {"fabrication.sheet", "{width: 1 m, height: 1 m}"}}, 2},
    {{{"pre_stretch", "1"}}, 1},
};
enum { VARIANTS = sizeof variants / sizeof variants[0] };

TEST(test_words_do_not_overlap)
{
  for (size_t v = 0; v < VARIANTS; v++) {
    double size[2];
    make(variants[v].sets, variants[v].count);
    dea_picture_size(workshop, size);
    begin(size[0], size[1]);
    dea_picture_draw(&paper, workshop);
    check_page();
    assert_true(word_count > 8);
    dea_pages_first_size(workshop, size);
    begin(size[0], size[1]);
    dea_pages_draw(&paper, workshop);
    check_page();
    assert_int_equal(pages,
                     workshop->count + (workshop->plan.copies > 1 ? workshop->count - 1 : 0));
    struct dea_text html = {.ctx = ctx};
    assert_int_equal(dea_process_write(ctx, workshop, NULL, &html), DEA_OK);
    dea_text_free(&html);
  }
}

/* The same of devices of any layout: drawing, parts, and process sheet. */
TEST(test_words_of_devices)
{
  static const char *const names[] = {"quadrants", "stack-10",   "two-electrodes",
                                      "bender",    "pure-shear", "diaphragm"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    char path[500], text[8000];
    snprintf(path, sizeof path, "%s/examples/devices/%s.yaml", DEA_SOURCE_DIR, names[i]);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_int_equal(workshop_make(text, NULL, 0), DEA_OK);
    double size[2];
    dea_picture_size(workshop, size);
    begin(size[0], size[1]);
    dea_picture_draw(&paper, workshop);
    check_page();
    assert_true(word_count > 12);
    dea_pages_first_size(workshop, size);
    begin(size[0], size[1]);
    dea_pages_draw(&paper, workshop);
    check_page();
    assert_int_equal(pages, workshop->count);
    struct dea_text html = {.ctx = ctx};
    assert_int_equal(dea_process_write(ctx, workshop, NULL, &html), DEA_OK);
    dea_text_free(&html);
  }
}

/* ---- numbers ---- */

TEST(test_amounts)
{
  const struct dea_override sets[] = {{"electrodes.thickness", "10 um"},
                                      {"electrodes.material", "stiff"},
                                      {"fibres.bond.thickness", "50 um"},
                                      {"fabrication.marks.diameter", "1.2 mm unstretched"}};
  struct dea_amounts a;
  make(sets, 4);
  dea_amounts_find(workshop, &a);
  // blank of 70/1.5 mm; disc of 5, pad of 5/1.5, lead of 1 mm between them, three marks
  double r = 2.5, p = 2.5 / 1.5, w = 1, apart = 20 / 1.5;
  double cut_r = r * r * asin(0.5 * w / r) - 0.5 * w * sqrt(r * r - 0.25 * w * w);
  double cut_p = p * p * asin(0.5 * w / p) - 0.5 * w * sqrt(p * p - 0.25 * w * w);
  double lead = w * (apart - sqrt(r * r - 0.25 * w * w) - sqrt(p * p - 0.25 * w * w));
  double one = pi * (r * r + p * p) - cut_r - cut_p + lead, marks = 3 * pi * 0.36;
  assert_close(a.film_area_m2, 1e-6 * pi * 35 * 35 / 2.25, 1e-9, 0);
  assert_close(a.ink_area_m2, 2e-6 * (one + marks), 1e-9, 0);
  assert_close(a.ink_volume_m3, 2e-6 * (one + marks) * 10e-6, 1e-9, 0);
  assert_close(a.transfer_glue_area_m2, 1e-6 * (one - pi * p * p), 1e-9, 0);
  // four strips of 2 mm from 3.75 to 15 mm and 3 mm more, outer ends along a circle, straight tips
  // as simulated
  double area = 0;
  for (int i = 0; i < 100000; i++) {
    double y = -1 + 2 * (i + 0.5) / 100000;
    area += 4 * (sqrt(18 * 18 - y * y) - 3.75) * 2 / 100000;
  }
  assert_close(a.bond_area_m2, 1e-6 * area, 1e-7, 0);
  assert_close(a.bond_volume_m3, 1e-6 * area * 50e-6, 1e-7, 0);
  make(NULL, 0);
  dea_amounts_find(workshop, &a);
  assert_true(isnan(a.ink_volume_m3) && isnan(a.bond_volume_m3)); // never invented
}

static dea_status write_document(struct dea_context *failing)
{
  struct dea_text html = {.ctx = failing};
  dea_status status = dea_process_write(failing, workshop, NULL, &html);
  dea_text_free(&html);
  return status;
}

TEST(test_each_allocation)
{
  make(NULL, 0);
  struct failing_attempt attempt = {.call = write_document};
  struct failing_count count;
  long n = 0;
  for (; failing_run(failing_attempt_run, &attempt, n, &count); n++) {
    assert_int_equal(attempt.status, DEA_E_MEMORY);
  }
  assert_int_equal(attempt.status, DEA_OK);
  assert_true(n > 2);
}

TESTS(workshop_set_up, workshop_tear_down)
