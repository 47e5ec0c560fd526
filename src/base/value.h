/* A value of an input file: the value, where it comes from and where it stands. */
#pragma once

#include "base/context.h"

enum { DEA_TITLE_SIZE = 256 };

enum dea_origin {
  DEA_ABSENT,   // not given and no default: the value is NAN (or -1)
  DEA_DEFAULT,  // from the schema; listed by `dea check`
  DEA_GIVEN,    // in the file
  DEA_OVERRIDE, // from --set
};

/* A number in SI. place: of the value; for a default the place of the section it belongs to. */
struct dea_quantity {
  double si;
  enum dea_origin origin;
  struct dea_location location;
};

/* Which film a length lies in. */
enum dea_film_state { DEA_STRETCHED, DEA_UNSTRETCHED };
/* "stretched" or "unstretched", as people read and write it. */
const char *dea_film_state_name(enum dea_film_state state);

/* A length in the plane of the film, always with the film state it was measured in. */
struct dea_inplane_length {
  struct dea_quantity length; // [m] as written
  enum dea_film_state state;
};

struct dea_choice {
  int value; // an enumerator; -1 when absent
  enum dea_origin origin;
  struct dea_location location;
};

struct dea_label {
  char text[DEA_TITLE_SIZE];
  enum dea_origin origin;
  struct dea_location location;
};

/* One line of the list of all values of a file (`dea check`). */
struct dea_listed {
  char *path;       // "film.thickness", "materials[0].laws[1].id"; owned
  const char *text; // as written, or the default as it would be written; lent by document or schema
  const char *unit; // SI unit of the number; NULL for what is none
  double si;        // NAN for what is no number
  enum dea_origin origin;
  struct dea_location location;
};

/* The list; owned by whoever reads the file. */
struct dea_listing {
  struct dea_listed *items;
  size_t count, capacity;
};

void dea_listing_free(struct dea_context *ctx, struct dea_listing *listing);
