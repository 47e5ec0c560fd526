#include "instrument/line_reader.h"

const char *dea_line_next(struct dea_line_reader *reader, const char **bytes, size_t *length)
{
  while (*length > 0) {
    char c = **bytes;
    ++*bytes;
    --*length;
    if (c == '\r' || c == '\n') {
      bool good = reader->length > 0 && !reader->too_long;
      reader->dropped += reader->too_long;
      reader->line[reader->length] = '\0';
      reader->length = 0;
      reader->too_long = false;
      if (good) {
        return reader->line;
      }
    } else if (((unsigned char)c < ' ' && c != '\t') || reader->length + 1 >= DEA_LINE_SIZE) {
      reader->too_long = true;
    } else {
      reader->line[reader->length++] = c;
    }
  }
  return NULL;
}
