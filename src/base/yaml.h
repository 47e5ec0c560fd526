/* YAML text as a tree of nodes with places, read event by event: libyaml's documents would take
 * minutes for a few megabytes of "[".
 *
 * Only what a design needs is taken: one document of sections, lists and values. Anchors with
 * aliases, tags, several documents and repeated keys are errors, each with its place. */
#pragma once

#include "base/context.h"

enum {
  DEA_YAML_SIZE_MAX = 4 * 1024 * 1024, // bytes of a file
  DEA_YAML_NODES_MAX = 100000,
  DEA_YAML_DEPTH_MAX = 32,
};

enum dea_node_kind { DEA_NODE_VALUE, DEA_NODE_LIST, DEA_NODE_SECTION };

/* A node; all of it belongs to its document. */
struct dea_node {
  enum dea_node_kind kind;
  const char *text;              // of a value, never NULL; "" of lists and sections
  bool empty;                    // nothing was written: "key:", "~" or "null"
  bool overridden;               // comes from an override, or holds a node that does
  const char *key;               // in a section; NULL otherwise
  struct dea_location location;  // of the value
  struct dea_location key_place; // of the key
  struct dea_node *child, *next; // first member of a list or section; next sibling
  size_t child_count;
};

struct dea_yaml;

/* name stands for the file in places and is interned. DEA_E_DESIGN after at least one finding.
 * A key that stands twice is a finding too, but the tree is made, so that the rest can be checked:
 * count the errors before and after. out: owned by the caller, NULL on failure. */
dea_status dea_yaml_parse(struct dea_context *ctx, const char *name, const char *bytes,
                          size_t length, struct dea_yaml **out);
/* NULL is fine. */
void dea_yaml_destroy(struct dea_context *ctx, struct dea_yaml *yaml);
/* The outermost node; lent. Its place is the first line. */
const struct dea_node *dea_yaml_root(const struct dea_yaml *yaml);
/* One override of --set: key is the dotted path in the file ("film.thickness"), value as it would
 * stand in the file ("200 um"). */
struct dea_override {
  const char *key, *value;
};

/* Puts value, YAML text such as "200 um" or "[1 kV, 2 kV]", at a dotted path of sections, where an
 * item of a list goes by its `name` ("plies.film.thickness"), or its number from 0
 * ("springs[0].stiffness"); sections that are missing are made,
 * "null" takes the key away. Places of new nodes are "--set PATH", line
 * 0. DEA_E_DESIGN after a finding. */
dea_status dea_yaml_override(struct dea_context *ctx, struct dea_yaml *yaml, const char *path,
                             const char *value);
/* The same with every value of a section: keys may be dotted paths, and sections within it are
 * paths too. Values keep their places and texts: `changes` outlives the document. */
dea_status dea_yaml_merge(struct dea_context *ctx, struct dea_yaml *yaml,
                          const struct dea_node *changes);
/* A node of its own from YAML text (the default of a list), kept by the document; places = place.
 */
dea_status dea_yaml_fragment(struct dea_context *ctx, struct dea_yaml *yaml,
                             struct dea_location location, const char *text,
                             const struct dea_node **out);
/* Appends YAML text, in which each value "$" stands for the next of `values`, to the list `list` of
 * the outermost section, which is made where there is none, and puts the value `name` in the place
 * of the node `used` of the document. text: NULL for nothing to append. */
dea_status dea_yaml_define(struct dea_context *ctx, struct dea_yaml *yaml,
                           const struct dea_node *used, const char *list, const char *name,
                           const char *text, const struct dea_node *const values[]);
/* Member of a section with that key, or NULL. */
const struct dea_node *dea_node_find(const struct dea_node *section, const char *key);
