/* A material in one line, {yeoh: [120 kPa, 5 kPa, 1 kPa], permittivity: 2.9, density: 1.1 g/cm^3},
 * becomes an item of `materials` that its user names, so that all else is as for those. */
#include "design/design_schema.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

enum { VALUES_MAX = 32, NAMES_MAX = 32 };

/* What is not the law, and how `materials` has it; "$" stands for the value. */
static const struct {
  const char *key, *form;
  bool elastic;
} properties[] = {
    {"permittivity", "permittivity: [{id: own, at_rest: $, source: own}]", false},
    {"breakdown", "breakdown: [{id: own, at_rest: $, source: own}]", false},
    {"density", "density: {value: $, source: own}", false},
    {"resistivity", "resistivity: {value: $, source: own}", false},
    {"young_modulus", "young_modulus: $", true},
    {"poisson_ratio", "poisson_ratio: $", true},
};
enum { PROPERTIES = sizeof properties / sizeof properties[0] };

struct line {
  struct dea_context *ctx;
  struct dea_yaml *yaml;
  const struct dea_node *values[VALUES_MAX]; // that stand for each "$" of the text
  size_t value_count;
  struct dea_text plain, elastic;
  const struct dea_law *law;
  bool wrong;
};

static dea_status refuse_key(struct line *line, const struct dea_node *key)
{
  size_t count, named = 0;
  const struct dea_law *const *laws = dea_law_all(&count);
  const char *names[NAMES_MAX];
  char hint[DEA_HINT_SIZE];
  for (size_t i = 0; i < PROPERTIES + count && named < NAMES_MAX; i++) {
    if (i < PROPERTIES || laws[i - PROPERTIES]->compressible == NULL) {
      names[named++] = i < PROPERTIES ? properties[i].key : laws[i - PROPERTIES]->name;
    }
  }
  dea_name_hint_list(key->key, names, named, " It has: ", "; it has: ", hint);
  return dea_finding_add(line->ctx, DEA_ERROR, key->key_place,
                         "a material in one line has no '%.60s'%s", key->key, hint);
}

/* "laws: [{id: own, law: yeoh, parameters: {c1: $, c2: $}, source: own}]"; of a list of values in
 * the order of the law's parameters, of which the last optional ones may be left out. */
static dea_status add_law(struct line *line, const struct dea_law *law, const struct dea_node *node)
{
  const bool lone = node->kind == DEA_NODE_VALUE;
  const size_t given = lone ? 1 : node->kind == DEA_NODE_LIST ? node->child_count : 0;
  size_t least = 0;
  struct dea_text order = {.ctx = line->ctx};
  for (size_t i = 0; i < law->param_count; i++) {
    least += law->params[i].required;
    dea_text_add(&order, "%s%s", i > 0 ? ", " : "", law->params[i].key);
  }
  dea_status status = DEA_OK;
  line->wrong = line->wrong || line->law != NULL || given < least || given > law->param_count;
  if (line->law != NULL) {
    status = dea_finding_add(line->ctx, DEA_ERROR, node->key_place,
                             "a material in one line has one law, and '%s' stands there already",
                             line->law->name);
  } else if (line->wrong) {
    status = dea_finding_add(line->ctx, DEA_ERROR, node->location,
                             "the law '%s' has the parameters [%s], each with its unit; here "
                             "%zu of them are given",
                             law->name, dea_text_get(&order), given);
  }
  dea_text_free(&order);
  line->law = law;
  const struct dea_node *value = lone ? node : node->child;
  dea_text_add(&line->plain, ", laws: [{id: own, law: %s, source: own, parameters: {", law->name);
  for (size_t i = 0; i < given && i < law->param_count; i++, value = value->next) {
    dea_text_add(&line->plain, "%s%s: $", i > 0 ? ", " : "", law->params[i].key);
    line->values[line->value_count++] = value;
  }
  dea_text_add(&line->plain, "}}]");
  return status;
}

/* elastic: those of young_modulus and poisson_ratio, which are in a section of their own. */
static dea_status add_values(struct line *line, const struct dea_node *section, bool elastic)
{
  for (const struct dea_node *node = section->child; node != NULL; node = node->next) {
    size_t p = 0;
    while (p < PROPERTIES && strcmp(properties[p].key, node->key) != 0) {
      p++;
    }
    const struct dea_law *law = p == PROPERTIES ? dea_law_find(node->key) : NULL;
    if (p < PROPERTIES && properties[p].elastic == elastic) {
      dea_text_add(elastic ? &line->elastic : &line->plain, ", %s", properties[p].form);
      line->values[line->value_count++] = node;
    } else if (law != NULL && law->compressible == NULL && !elastic) {
      DEA_TRY(line->ctx, add_law(line, law, node));
    } else if (p == PROPERTIES && !elastic) {
      line->wrong = true;
      DEA_TRY(line->ctx, refuse_key(line, node));
    }
  }
  return DEA_OK;
}

static dea_status expand(struct line *line, const struct dea_node *node, const char *name)
{
  DEA_TRY(line->ctx, add_values(line, node, false));
  DEA_TRY(line->ctx, add_values(line, node, true));
  if (line->wrong) {
    return dea_yaml_define(line->ctx, line->yaml, node, "materials", name, NULL, NULL);
  }
  struct dea_text text = {.ctx = line->ctx};
  dea_text_add(&text, "{name: '%s', kind: %s%s", name, line->law != NULL ? "elastomer" : "plastic",
               dea_text_get(&line->plain));
  if (line->elastic.length > 0) {
    dea_text_add(&text, ", elastic: {source: own%s}", dea_text_get(&line->elastic));
  }
  dea_text_add(&text, "}");
  const bool failed = text.failed || line->plain.failed || line->elastic.failed;
  const dea_status status = failed ? DEA_E_MEMORY
                                   : dea_yaml_define(line->ctx, line->yaml, node, "materials", name,
                                                     dea_text_get(&text), line->values);
  dea_text_free(&text);
  return status;
}

/* The material of a section, if it is one in one line. */
static dea_status expand_of(struct dea_context *ctx, struct dea_yaml *yaml,
                            const struct dea_node *section, const char *name)
{
  const struct dea_node *node = dea_node_find(section, "material");
  if (section->kind != DEA_NODE_SECTION || node == NULL || node->kind != DEA_NODE_SECTION) {
    return DEA_OK;
  }
  struct line line = {.ctx = ctx, .yaml = yaml, .plain = {.ctx = ctx}, .elastic = {.ctx = ctx}};
  dea_status status = DEA_OK;
  if (node->child_count >= VALUES_MAX - DEA_LAW_PARAM_MAX) {
    status = dea_refuse(ctx, node->location, "a material in one line has too many keys");
  } else {
    status = expand(&line, node, name);
  }
  dea_text_free(&line.plain);
  dea_text_free(&line.elastic);
  return status;
}

dea_status dea_material_lines_expand(struct dea_context *ctx, struct dea_yaml *yaml)
{
  static const char *const sections[] = {"film", "electrodes", "fibres"};
  const struct dea_node *root = dea_yaml_root(yaml), *plies = dea_node_find(root, "plies");
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    const struct dea_node *section = dea_node_find(root, sections[i]);
    char name[DEA_NAME_SIZE];
    snprintf(name, sizeof name, "%s.material", sections[i]);
    DEA_TRY(ctx, section != NULL ? expand_of(ctx, yaml, section, name) : DEA_OK);
  }
  size_t number = 0;
  const struct dea_node *ply = plies != NULL ? plies->child : NULL;
  for (; ply != NULL; ply = ply->next, number++) {
    const struct dea_node *named = dea_node_find(ply, "name");
    const bool plain = named != NULL && strpbrk(named->text, "'\n") == NULL && *named->text != 0;
    char name[DEA_NAME_SIZE], own[24];
    snprintf(own, sizeof own, "[%zu]", number);
    snprintf(name, sizeof name, "plies.%.40s.material", plain ? named->text : own);
    DEA_TRY(ctx, expand_of(ctx, yaml, ply, name));
  }
  return DEA_OK;
}
