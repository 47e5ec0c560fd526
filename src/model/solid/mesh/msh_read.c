/* First the file is parsed into a list of nodes and one of elements with the physical groups that
 * they are in; then the quadrilaterals are sorted along a curve that fills the plane, numbered, and
 * brought into the order of nodes of the project's elements. */
#include "model/solid/mesh/msh_read.h"

#include "base/context.h"
#include "base/file.h"
#include "base/write_file.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAID_MAX = 400, NODES_MAX = 10, NAME_SIZE = 128 };
static const double flat = 1e-6; // of the mesh's size: nodes further apart in z are no plane
static const double same = 1e-9; // of the mesh's size: one place
static const double size_least_m = 1e-9, size_most_m = 1e6;

/* Gmsh's types of elements that are known here. */
static const struct kind {
  int type, nodes, dimension, order;
  bool triangle;
} kinds[] = {
    {15, 1, 0, 0, false}, {1, 2, 1, 1, false},  {8, 3, 1, 2, false}, {3, 4, 2, 1, false},
    {16, 8, 2, 2, false}, {10, 9, 2, 2, false}, {2, 3, 2, 1, true},  {9, 6, 2, 2, true},
    {20, 9, 2, 3, true},  {21, 10, 2, 3, true},
};

struct raw_node {
  long long tag;
  double x[3];
};

struct raw_element {
  const struct kind *kind;
  long long group; // of 2.2: physical; of 4.1: entity
  long long nodes[NODES_MAX];
  size_t line;
  uint64_t key; // along the curve
};

struct physical {
  int dimension;
  long long tag;
  size_t index; // among the groups or curves of the mesh; SIZE_MAX: none yet
  char name[NAME_SIZE];
};

/* That an entity (4.1) is in a physical group. */
struct member {
  int dimension;
  long long entity, physical;
};

struct list {
  void *data;
  size_t count, capacity;
};

/* Once the status is not DEA_OK, nothing more is read or said: what reads returns 0. */
struct reader {
  struct dea_context *ctx;
  dea_status status;
  const char *file; // interned; NULL: none, and no findings
  const char *at;
  size_t line;
  const char *section;
  int version; // 2 or 4
  struct list nodes, elements, physicals, members;
  union {
    struct raw_node node;
    struct raw_element element;
    struct physical physical;
    struct member member;
  } spare; // the item of a list for which there was no memory
};

// Faults, lists, words ----------------------------------------------------------------------------

static dea_status fault(struct reader *r, size_t line, const char *format, ...) DEA_PRINTF(3, 4);

static dea_status fault(struct reader *r, size_t line, const char *format, ...)
{
  char said[SAID_MAX];
  va_list args;
  if (r->status != DEA_OK) {
    return r->status;
  }
  va_start(args, format);
  vsnprintf(said, sizeof said, format, args);
  va_end(args);
  const struct dea_location location = {r->file, line, 0};
  if (r->file != NULL) {
    r->status = dea_finding_add(r->ctx, DEA_ERROR, location, "%s", said);
  }
  if (r->status == DEA_OK) {
    r->status = r->file == NULL ? dea_fail(r->ctx, DEA_E_DESIGN, "%s", said)
                : line > 0      ? dea_fail(r->ctx, DEA_E_DESIGN, "%s:%zu: %s", r->file, line, said)
                                : dea_fail(r->ctx, DEA_E_DESIGN, "%s: %s", r->file, said);
  }
  return r->status;
}

/* Room for one more, zeroed. */
static void *list_add(struct reader *r, struct list *list, size_t size)
{
  if (dea_array_grow(r->ctx, &list->data, list->count, &list->capacity, size) != DEA_OK) {
    r->status = r->status == DEA_OK ? DEA_E_MEMORY : r->status;
    return memset(&r->spare, 0, sizeof r->spare);
  }
  return memset((char *)list->data + list->count++ * size, 0, size);
}

static void skip_space(struct reader *r)
{
  for (; isspace((unsigned char)*r->at); r->at++) {
    r->line += *r->at == '\n';
  }
}

static bool is_end_of_word(char c)
{
  return c == '\0' || isspace((unsigned char)c);
}

static size_t word_length(const char *word)
{
  size_t n = 0;
  while (!is_end_of_word(word[n])) {
    n++;
  }
  return n;
}

/* What stands there is not what was wanted. */
static void not_that(struct reader *r, const char *wanted)
{
  size_t n = word_length(r->at);
  if (n == 0) {
    fault(r, r->line, "the file ends in %s", r->section);
  } else {
    fault(r, r->line, "'%.*s' in %s is not %s", (int)(n < 30 ? n : 30), r->at, r->section, wanted);
  }
}

static long long read_int(struct reader *r, const char *what)
{
  char *end;
  skip_space(r);
  const long long value = strtoll(r->at, &end, 10);
  if (end == r->at || !is_end_of_word(*end) || value > INT32_MAX || value < -INT32_MAX) {
    not_that(r, what);
  }
  r->at = r->status == DEA_OK ? end : r->at;
  return r->status == DEA_OK ? value : 0;
}

static size_t read_count(struct reader *r, const char *what)
{
  const long long value = read_int(r, what);
  if (value < 0) {
    fault(r, r->line, "%lld in %s is not %s", value, r->section, what);
  }
  return r->status == DEA_OK ? (size_t)value : 0;
}

static double read_number(struct reader *r)
{
  char *end;
  skip_space(r);
  const double value = strtod(r->at, &end);
  if (end == r->at || !is_end_of_word(*end) || !isfinite(value)) {
    not_that(r, "a number");
  }
  r->at = r->status == DEA_OK ? end : r->at;
  return r->status == DEA_OK ? value : 0;
}

static void skip_numbers(struct reader *r, size_t count)
{
  for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
    read_number(r);
  }
}

// Sections of the file ----------------------------------------------------------------------------

static void read_format(struct reader *r)
{
  const double version = read_number(r);
  const long long binary = read_int(r, "0 (ASCII) or 1 (binary)");
  read_int(r, "a size");
  if (binary != 0) {
    fault(r, r->line, "the file is binary: write it as ASCII (Mesh.Binary = 0)");
  } else if (version != 2.2 && version != 4.1) {
    fault(r, r->line, "format %g is not known: 4.1 and 2.2 are (Mesh.MshFileVersion = 4.1)",
          version);
  }
  r->version = version < 4 ? 2 : 4;
}

static struct physical *find_physical(const struct reader *r, int dimension, long long tag)
{
  struct physical *all = r->physicals.data;
  for (size_t i = 0; i < r->physicals.count; i++) {
    if (all[i].dimension == dimension && all[i].tag == tag) {
      return &all[i];
    }
  }
  return NULL;
}

static struct physical *add_physical(struct reader *r, int dimension, long long tag)
{
  struct physical *physical = list_add(r, &r->physicals, sizeof *physical);
  *physical = (struct physical){.dimension = dimension, .tag = tag, .index = SIZE_MAX};
  snprintf(physical->name, NAME_SIZE, "%lld", tag);
  return physical;
}

static void read_physical_names(struct reader *r)
{
  const size_t count = read_count(r, "a number of names");
  for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
    const size_t dimension = read_count(r, "a dimension");
    const long long tag = read_int(r, "the number of a group");
    skip_space(r);
    const size_t n = *r->at == '"' ? strcspn(r->at + 1, "\"\n") : 0;
    if (n == 0 || r->at[1 + n] != '"') {
      not_that(r, "a name in quotes");
    } else if (n >= NAME_SIZE) {
      fault(r, r->line, "a name of %zu bytes is too long: %d at most", n, NAME_SIZE - 1);
    } else if (dimension > 3 || find_physical(r, (int)dimension, tag) != NULL) {
      fault(r, r->line, "the group %lld of dimension %zu is there twice, or cannot be", tag,
            dimension);
    } else {
      snprintf(add_physical(r, (int)dimension, tag)->name, NAME_SIZE, "%.*s", (int)n, r->at + 1);
      r->at += n + 2;
    }
  }
}

/* Which entities of 4.1 are in which groups. */
static void read_entities(struct reader *r)
{
  size_t counts[4];
  for (int i = 0; i < 4; i++) {
    counts[i] = read_count(r, "a number of entities");
  }
  for (int dimension = 0; dimension < 4; dimension++) {
    for (size_t i = 0; i < counts[dimension] && r->status == DEA_OK; i++) {
      const long long tag = read_int(r, "the number of an entity");
      skip_numbers(r, dimension == 0 ? 3 : 6);
      for (size_t left = read_count(r, "a number of groups"); left > 0 && r->status == DEA_OK;
           left--) {
        struct member *member = list_add(r, &r->members, sizeof *member);
        // negative: the other way round
        *member = (struct member){dimension, tag, llabs(read_int(r, "the number of a group"))};
      }
      if (dimension > 0) {
        skip_numbers(r, read_count(r, "a number of bounds"));
      }
    }
  }
}

static void read_place(struct reader *r, struct raw_node *node)
{
  for (int i = 0; i < 3; i++) {
    node->x[i] = read_number(r);
  }
}

static void read_nodes_2(struct reader *r)
{
  const size_t count = read_count(r, "a number of nodes");
  for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
    struct raw_node *node = list_add(r, &r->nodes, sizeof *node);
    node->tag = read_int(r, "the number of a node");
    read_place(r, node);
  }
}

/* Head of a section of 4.1: blocks, items, least and largest number. Returns the blocks. */
static size_t read_head(struct reader *r, const char *what)
{
  const size_t blocks = read_count(r, what);
  for (int i = 0; i < 3; i++) {
    read_count(r, what);
  }
  return blocks;
}

static void read_nodes_4(struct reader *r)
{
  const size_t blocks = read_head(r, "a number of nodes");
  for (size_t b = 0; b < blocks && r->status == DEA_OK; b++) {
    const size_t dimension = read_count(r, "a dimension"), first = r->nodes.count;
    read_int(r, "the number of an entity");
    const bool parametric = read_count(r, "0 or 1") != 0;
    const size_t count = read_count(r, "a number of nodes");
    for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
      struct raw_node *node = list_add(r, &r->nodes, sizeof *node);
      node->tag = read_int(r, "the number of a node");
    }
    for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
      read_place(r, (struct raw_node *)r->nodes.data + first + i);
      skip_numbers(r, parametric && dimension < 3 ? dimension : 0);
    }
  }
}

static const struct kind *read_kind(struct reader *r)
{
  const long long type = read_int(r, "a type of elements");
  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
    if (kinds[i].type == type) {
      return &kinds[i];
    }
  }
  fault(r, r->line,
        "elements of Gmsh's type %lld cannot be used: a plane mesh of quadrilaterals of "
        "first or second order is wanted (types 3, 10, 16)",
        type);
  return kinds;
}

static void read_element(struct reader *r, const struct kind *kind, long long group)
{
  struct raw_element *element = list_add(r, &r->elements, sizeof *element);
  *element = (struct raw_element){.kind = kind, .group = group, .line = r->line};
  for (int n = 0; n < kind->nodes; n++) {
    element->nodes[n] = read_int(r, "the number of a node");
  }
}

static void read_elements_2(struct reader *r)
{
  const size_t count = read_count(r, "a number of elements");
  for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
    long long group = 0;
    read_int(r, "the number of an element");
    const struct kind *kind = read_kind(r);
    const size_t tags = read_count(r, "a number of tags");
    for (size_t k = 0; k < tags && r->status == DEA_OK; k++) {
      const long long tag = read_int(r, "a tag");
      group = k == 0 ? llabs(tag) : group;
    }
    read_element(r, kind, group);
  }
}

static void read_elements_4(struct reader *r)
{
  const size_t blocks = read_head(r, "a number of elements");
  for (size_t b = 0; b < blocks && r->status == DEA_OK; b++) {
    read_count(r, "a dimension");
    const long long entity = read_int(r, "the number of an entity");
    const struct kind *kind = read_kind(r);
    const size_t count = read_count(r, "a number of elements");
    for (size_t i = 0; i < count && r->status == DEA_OK; i++) {
      read_int(r, "the number of an element");
      read_element(r, kind, entity);
    }
  }
}

/* Goes on behind the end of a section; rest: over what is left of it. */
static void end_section(struct reader *r, const char *name, size_t length, bool rest)
{
  while (r->status == DEA_OK) {
    skip_space(r);
    size_t n = word_length(r->at);
    bool end = n > 4 && n == length + 3 && strncmp(r->at, "$End", 4) == 0 &&
               strncmp(r->at + 4, name + 1, n - 4) == 0;
    if (!end && (!rest || n == 0)) {
      not_that(r, "its end");
    }
    r->at += n;
    if (end) {
      return;
    }
  }
}

static void read_sections(struct reader *r)
{
  static const struct {
    const char *name;
    void (*read[2])(struct reader *r); // of 2.2, 4.1
  } sections[] = {
      {"$MeshFormat", {read_format, read_format}},
      {"$PhysicalNames", {read_physical_names, read_physical_names}},
      {"$Entities", {NULL, read_entities}},
      {"$Nodes", {read_nodes_2, read_nodes_4}},
      {"$Elements", {read_elements_2, read_elements_4}},
  };
  enum { KNOWN = sizeof sections / sizeof sections[0] };
  for (skip_space(r); *r->at != '\0' && r->status == DEA_OK; skip_space(r)) {
    const char *name = r->at;
    size_t length = word_length(name), k = 0;
    while (k < KNOWN &&
           (strlen(sections[k].name) != length || strncmp(sections[k].name, name, length) != 0)) {
      k++;
    }
    if (name[0] != '$' || (r->version == 0 && k != 0)) {
      fault(r, r->line,
            "this is no .msh file: it begins with $MeshFormat, and has sections "
            "such as $Nodes and $Elements");
      return;
    }
    void (*read)(struct reader *) = k < KNOWN ? sections[k].read[r->version == 4] : NULL;
    r->section = k < KNOWN ? sections[k].name : "a section";
    r->at += length;
    if (read != NULL) {
      read(r);
    }
    end_section(r, name, length, read == NULL);
  }
}

// From what was read to a mesh --------------------------------------------------------------------

static int compare_nodes(const void *a, const void *b)
{
  long long x = ((const struct raw_node *)a)->tag, y = ((const struct raw_node *)b)->tag;
  return (x > y) - (x < y);
}

/* By key, then by nodes: the copies of an element in several groups follow each other. */
static int compare_elements(const void *a, const void *b)
{
  const struct raw_element *x = a, *y = b;
  if (x->key != y->key) {
    return (x->key > y->key) - (x->key < y->key);
  }
  for (int n = 0; n < NODES_MAX; n++) {
    if (x->nodes[n] != y->nodes[n]) {
      return (x->nodes[n] > y->nodes[n]) - (x->nodes[n] < y->nodes[n]);
    }
  }
  return (x->line > y->line) - (x->line < y->line);
}

static bool is_copy(const struct raw_element *a, const struct raw_element *b)
{
  return memcmp(a->nodes, b->nodes, sizeof a->nodes) == 0;
}

static const struct raw_node *find_node(const struct reader *r, long long tag)
{
  const struct raw_node wanted = {.tag = tag};
  return r->nodes.count > 0
             ? bsearch(&wanted, r->nodes.data, r->nodes.count, sizeof wanted, compare_nodes)
             : NULL;
}

/* Middle of an element's corners. */
static void middle_of(const struct reader *r, const struct raw_element *e, double out[2])
{
  int corners = e->kind->dimension == 1 ? 2 : e->kind->triangle ? 3 : 4;
  out[0] = out[1] = 0;
  for (int n = 0; n < corners; n++) {
    const struct raw_node *node = find_node(r, e->nodes[n]);
    out[0] += node->x[0] / corners;
    out[1] += node->x[1] / corners;
  }
}

/* Place of a point of [0, 1)^2 along Hilbert's curve, which fills the plane: points that are near
 * on the curve are near each other. */
static uint64_t along_hilbert(double u, double v)
{
  enum { BITS = 20 };
  uint64_t x = (uint64_t)(u * (1 << BITS)), y = (uint64_t)(v * (1 << BITS)), key = 0;
  for (uint64_t side = (uint64_t)1 << (BITS - 1); side > 0; side >>= 1) {
    uint64_t right = (x & side) != 0, up = (y & side) != 0;
    key += side * side * ((3 * right) ^ up);
    if (up == 0) { // turn the quarter
      if (right != 0) {
        x = 2 * side - 1 - (x & (2 * side - 1));
        y = 2 * side - 1 - (y & (2 * side - 1));
      }
      uint64_t keep = x;
      x = y;
      y = keep;
    }
  }
  return key;
}

/* What the mesh is made of: box of its nodes, order, numbers. */
struct survey {
  double low[3], high[3], size;
  int order;
  size_t quads, lines, edges, triangles, ungrouped; // edges: at most
  const struct raw_element *first_triangle, *first_ungrouped;
};

static bool is_quad(const struct raw_element *e)
{
  return e->kind->dimension == 2 && !e->kind->triangle;
}

/* The physical groups of an element one after the other, *cursor from 0; 0 after the last. */
static long long next_group(const struct reader *r, const struct raw_element *e, size_t *cursor)
{
  if (r->version == 2) {
    return (*cursor)++ == 0 ? e->group : 0;
  }
  const struct member *all = r->members.data;
  while (*cursor < r->members.count) {
    const struct member *m = &all[(*cursor)++];
    if (m->dimension == e->kind->dimension && m->entity == e->group) {
      return m->physical;
    }
  }
  return 0;
}

static dea_status check_element(struct reader *r, const struct raw_element *e, struct survey *s)
{
  for (int n = 0; n < e->kind->nodes; n++) {
    const struct raw_node *node = find_node(r, e->nodes[n]);
    if (node == NULL) {
      return fault(r, e->line, "there is no node %lld", e->nodes[n]);
    }
    for (int i = 0; i < 3; i++) {
      s->low[i] = fmin(s->low[i], node->x[i]);
      s->high[i] = fmax(s->high[i], node->x[i]);
    }
  }
  if (e->kind->triangle) {
    s->first_triangle = s->triangles++ == 0 ? e : s->first_triangle;
  } else if (is_quad(e)) {
    if (s->order != 0 && s->order != e->kind->order) {
      return fault(r, e->line, "quadrilaterals of first and of second order in one mesh");
    }
    size_t cursor = 0;
    s->order = e->kind->order;
    s->quads++;
    if (next_group(r, e, &cursor) == 0) {
      s->first_ungrouped = s->ungrouped++ == 0 ? e : s->first_ungrouped;
    }
  } else if (e->kind->dimension == 1) {
    s->lines++;
    for (size_t cursor = 0; next_group(r, e, &cursor) != 0;) {
      s->edges++;
    }
  }
  return DEA_OK;
}

static dea_status check_all(struct reader *r, double unit_m, struct survey *s)
{
  const struct raw_node *nodes = r->nodes.data;
  const struct raw_element *elements = r->elements.data;
  double middle[2], mm = 1e3 * unit_m;
  *s = (struct survey){.low = {INFINITY, INFINITY, INFINITY},
                       .high = {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t i = 1; i < r->nodes.count; i++) {
    if (nodes[i].tag == nodes[i - 1].tag) {
      return fault(r, 0, "node %lld is there twice", nodes[i].tag);
    }
  }
  for (size_t i = 0; i < r->elements.count; i++) {
    DEA_TRY(r->ctx, check_element(r, &elements[i], s));
  }
  if (s->triangles > 0) {
    middle_of(r, s->first_triangle, middle);
    return fault(r, s->first_triangle->line,
                 "%zu triangle%s, the first at (%.4g, %.4g) mm: only quadrilaterals can be used "
                 "(Mesh.RecombineAll = 1, Mesh.RecombinationAlgorithm = 1)",
                 s->triangles, s->triangles > 1 ? "s" : "", mm * middle[0], mm * middle[1]);
  }
  if (s->quads == 0) {
    return fault(r, 0, "the file has no quadrilaterals");
  }
  if (s->ungrouped > 0) {
    middle_of(r, s->first_ungrouped, middle);
    return fault(r, s->first_ungrouped->line,
                 "%zu quadrilaterals are in no physical surface, the first at (%.4g, %.4g) mm: "
                 "name what they belong to (Physical Surface(\"film\") = ...)",
                 s->ungrouped, mm * middle[0], mm * middle[1]);
  }
  s->size = fmax(s->high[0] - s->low[0], s->high[1] - s->low[1]);
  double far = fmax(fmax(-s->low[0], s->high[0]), fmax(-s->low[1], s->high[1]));
  if (!(s->size * unit_m > size_least_m && s->size * unit_m < size_most_m && far < 1e6 * s->size)) {
    return fault(r, 0, "a mesh of %.3g mm, up to %.3g mm away from the origin, cannot be used",
                 mm * s->size, mm * far);
  }
  if (s->high[2] - s->low[2] > flat * s->size) {
    return fault(r, 0, "the mesh is not plane: z is from %.6g to %.6g mm", mm * s->low[2],
                 mm * s->high[2]);
  }
  return DEA_OK;
}

/* Quadrilaterals first, along the curve; then lines; then the rest. */
static void sort_elements(struct reader *r, const struct survey *s)
{
  struct raw_element *elements = r->elements.data;
  for (size_t i = 0; i < r->elements.count; i++) {
    struct raw_element *e = &elements[i];
    double middle[2], inside = 1 - 1e-9;
    if (is_quad(e)) {
      middle_of(r, e, middle);
      e->key = along_hilbert(inside * (middle[0] - s->low[0]) / s->size,
                             inside * (middle[1] - s->low[1]) / s->size);
    } else {
      e->key = UINT64_MAX - (e->kind->dimension == 1 ? 1 : 0);
    }
  }
  qsort(elements, r->elements.count, sizeof *elements, compare_elements);
}

/* Those with a name in the order of the file, then those without. */
static dea_status add_names(struct reader *r, struct dea_plane_mesh *mesh)
{
  const struct raw_element *elements = r->elements.data;
  for (size_t i = 0; i < r->elements.count; i++) {
    const struct raw_element *e = &elements[i];
    size_t cursor = 0;
    for (long long tag; (tag = next_group(r, e, &cursor)) != 0;) {
      if (find_physical(r, e->kind->dimension, tag) == NULL) {
        add_physical(r, e->kind->dimension, tag);
        DEA_TRY(r->ctx, r->status);
      }
    }
  }
  struct physical *all = r->physicals.data;
  for (size_t i = 0; i < r->physicals.count; i++) {
    size_t first = 0; // of that name, which several numbers may have
    while (all[first].dimension != all[i].dimension || strcmp(all[first].name, all[i].name) != 0) {
      first++;
    }
    if (first < i) {
      all[i].index = all[first].index;
    } else if (all[i].dimension == 2) {
      all[i].index = mesh->group_count;
      DEA_TRY(r->ctx, dea_plane_mesh_add_group(r->ctx, mesh, all[i].name));
    } else if (all[i].dimension == 1) {
      all[i].index = mesh->curve_count;
      DEA_TRY(r->ctx, dea_plane_mesh_add_curve(r->ctx, mesh, all[i].name));
    }
  }
  return DEA_OK;
}

/* Node of the mesh at that of the file. */
static int mesh_node(const struct reader *r, long long tag, double unit_m,
                     struct dea_point_map *nodes)
{
  const struct raw_node *node = find_node(r, tag);
  return (int)dea_point_map_add(nodes, (double[2]){unit_m * node->x[0], unit_m * node->x[1]});
}

/* Nodes of a quadrilateral in the project's order, counter-clockwise. */
static dea_status place_quad(const struct reader *r, const struct raw_element *e, double unit_m,
                             struct dea_point_map *nodes, int *quad)
{
  static const int order_1[4] = {0, 1, 3, 2}, order_2[9] = {0, 2, 8, 6, 1, 5, 7, 3, 4};
  int per = e->kind->order + 1;
  const int *order = per == 2 ? order_1 : order_2;
  for (int n = 0; n < e->kind->nodes; n++) {
    quad[order[n]] = mesh_node(r, e->nodes[n], unit_m, nodes);
  }
  DEA_TRY_MEMORY(!nodes->failed);
  if (e->kind->nodes == 8) { // middle of the polynomial that has no xi^2 eta^2
    double(*x)[2] = nodes->point, middle[2];
    for (int i = 0; i < 2; i++) {
      middle[i] = 0.5 * (x[quad[1]][i] + x[quad[3]][i] + x[quad[5]][i] + x[quad[7]][i]) -
                  0.25 * (x[quad[0]][i] + x[quad[2]][i] + x[quad[6]][i] + x[quad[8]][i]);
    }
    quad[4] = (int)dea_point_map_add(nodes, middle);
  }
  const double *a = nodes->point[quad[0]], *b = nodes->point[quad[per - 1]];
  const double *c = nodes->point[quad[per * per - 1]], *d = nodes->point[quad[per * per - per]];
  if ((c[0] - a[0]) * (d[1] - b[1]) - (c[1] - a[1]) * (d[0] - b[0]) < 0) {
    for (int i = 0; i < per; i++) {
      for (int j = 0; j < i; j++) {
        int keep = quad[per * i + j];
        quad[per * i + j] = quad[per * j + i];
        quad[per * j + i] = keep;
      }
    }
  }
  return DEA_OK;
}

/* The copies of one quadrilateral, elements[i] and on; *next: behind them. */
static dea_status add_quad(struct reader *r, size_t i, double unit_m, struct dea_point_map *nodes,
                           struct dea_plane_mesh *mesh, unsigned char *within, size_t *next)
{
  const struct raw_element *elements = r->elements.data;
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1));
  DEA_TRY(r->ctx,
          place_quad(r, &elements[i], unit_m, nodes, mesh->quads + mesh->quad_count * per_quad));
  memset(within, 0, mesh->group_count);
  for (*next = i; *next < r->elements.count && is_quad(&elements[*next]) &&
                  is_copy(&elements[i], &elements[*next]);
       (*next)++) {
    size_t cursor = 0;
    for (long long tag; (tag = next_group(r, &elements[*next], &cursor)) != 0;) {
      within[find_physical(r, 2, tag)->index] = 1;
    }
  }
  DEA_TRY(r->ctx, dea_plane_mesh_region(r->ctx, mesh, within, &mesh->region[mesh->quad_count]));
  mesh->quad_count++;
  return DEA_OK;
}

/* A line element, once for each curve that it is on. */
static dea_status add_line(struct reader *r, const struct raw_element *e, double unit_m,
                           struct dea_point_map *nodes, struct dea_plane_mesh *mesh)
{
  size_t per = (size_t)mesh->order + 1, cursor = 0, first = mesh->edge_count;
  for (long long tag; (tag = next_group(r, e, &cursor)) != 0;) {
    size_t known = nodes->count, twin = first;
    int *edge = mesh->edges + mesh->edge_count * per;
    int index = (int)find_physical(r, 1, tag)->index;
    if (e->kind->order != mesh->order) {
      return fault(r, e->line, "a line of another order than the quadrilaterals");
    }
    for (size_t n = 0; n < per; n++) { // both ends, then the middle
      edge[n == 0 ? 0 : n == 1 ? per - 1 : 1] = mesh_node(r, e->nodes[n], unit_m, nodes);
      DEA_TRY_MEMORY(!nodes->failed);
      if (nodes->count > known) {
        return fault(r, e->line, "a line of a physical curve is not on the side of an element");
      }
    }
    while (twin < mesh->edge_count && mesh->edge_curve[twin] != index) {
      twin++;
    }
    if (twin == mesh->edge_count) { // otherwise two numbers of one name
      mesh->edge_curve[mesh->edge_count++] = index;
    }
  }
  return DEA_OK;
}

static dea_status fill(struct reader *r, const struct survey *s, double unit_m,
                       struct dea_point_map *nodes, struct dea_plane_mesh *mesh)
{
  const struct raw_element *elements = r->elements.data;
  DEA_TRY(r->ctx, add_names(r, mesh));
  unsigned char *within = dea_alloc(r->ctx, mesh->group_count, 1);
  mesh->edges = dea_alloc(r->ctx, s->edges * (size_t)(s->order + 1), sizeof *mesh->edges);
  mesh->edge_curve = dea_alloc(r->ctx, s->edges, sizeof *mesh->edge_curve);
  bool enough = within != NULL && mesh->edges != NULL && mesh->edge_curve != NULL;
  dea_status status = enough ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < s->quads && status == DEA_OK;) {
    status = add_quad(r, i, unit_m, nodes, mesh, within, &i);
  }
  for (size_t i = s->quads; i < s->quads + s->lines && status == DEA_OK; i++) {
    status = add_line(r, &elements[i], unit_m, nodes, mesh);
  }
  dea_free(r->ctx, within);
  return status;
}

static dea_status check_quality(struct reader *r, const struct dea_plane_mesh *mesh)
{
  size_t worst = 0;
  double least = dea_plane_mesh_smallest_jacobian(mesh, &worst), middle[2];
  if (least >= DEA_MSH_JACOBIAN_MIN) {
    return DEA_OK;
  }
  dea_plane_mesh_middle(mesh, worst, middle);
  return fault(r, 0,
               "the quadrilateral at (%.4g, %.4g) mm is too bad to use: its smallest Jacobian is "
               "%.3g of the mean one, at least %g is wanted",
               1e3 * middle[0], 1e3 * middle[1], least, DEA_MSH_JACOBIAN_MIN);
}

static dea_status build(struct reader *r, double unit_m, struct dea_plane_mesh **out)
{
  struct survey s;
  if (r->nodes.count > 0) {
    qsort(r->nodes.data, r->nodes.count, sizeof(struct raw_node), compare_nodes);
  }
  DEA_TRY(r->ctx, check_all(r, unit_m, &s));
  sort_elements(r, &s);
  *out = dea_plane_mesh_create(r->ctx, s.order, 0, s.quads);
  DEA_TRY_MEMORY(*out != NULL);
  (*out)->quad_count = 0;
  struct dea_point_map nodes = {.ctx = r->ctx, .tolerance_m = same * s.size * unit_m};
  DEA_TRY_ELSE(r->ctx, fill(r, &s, unit_m, &nodes, *out), dea_point_map_free(&nodes));
  DEA_TRY(r->ctx, dea_plane_mesh_set_nodes(r->ctx, *out, &nodes));
  return r->file != NULL ? check_quality(r, *out) : DEA_OK;
}

dea_status dea_msh_parse(struct dea_context *ctx, const char *text, const char *name, double unit_m,
                         struct dea_plane_mesh **out)
{
  struct reader r = {.ctx = ctx, .at = text, .line = 1};
  *out = NULL;
  r.file = name != NULL ? dea_intern(ctx, name) : NULL;
  if (name != NULL && r.file == NULL) {
    return DEA_E_MEMORY;
  }
  void *locale = dea_c_locale_enter();
  read_sections(&r);
  dea_status status = r.status == DEA_OK ? build(&r, unit_m, out) : r.status;
  dea_c_locale_leave(locale);
  if (status != DEA_OK) {
    dea_plane_mesh_destroy(ctx, *out);
    *out = NULL;
  }
  dea_free(ctx, r.nodes.data);
  dea_free(ctx, r.elements.data);
  dea_free(ctx, r.physicals.data);
  dea_free(ctx, r.members.data);
  return DEA_CHAIN(ctx, status);
}

dea_status dea_msh_read(struct dea_context *ctx, const char *file, double unit_m,
                        struct dea_plane_mesh **out)
{
  char *text;
  size_t length;
  *out = NULL;
  DEA_TRY(ctx, dea_file_read(ctx, file, DEA_MSH_FILE_MAX, &text, &length));
  dea_status status = dea_msh_parse(ctx, text, file, unit_m, out);
  dea_free(ctx, text);
  return status;
}
