#include "import/import.h"
#include "table/csv_text.h"
#include "table/text_file.h"

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  (void)file;
  return dea_text_file_is(head, length);
}

const struct dea_importer dea_import_csv = {
    .name = "csv",
    .formats = "CSV and other text with lines of numbers",
    .recognise = recognise,
    .read_text = dea_table_read_text,
};
