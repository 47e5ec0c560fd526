#include "base/yaml_write.h"

#include <ctype.h>
#include <string.h>

/* Whether a text can stand without quotes, everywhere in a document: letters, digits and signs
 * that mean nothing to YAML; not what stands for nothing. */
static bool is_plain(const char *text)
{
  size_t length = strlen(text);
  if (length == 0 || text[length - 1] == ' ' || strcmp(text, "null") == 0 ||
      strcmp(text, "Null") == 0 || strcmp(text, "NULL") == 0 ||
      !(isalnum((unsigned char)text[0]) ||
        (strchr("-+.", text[0]) != NULL && isdigit((unsigned char)text[1])))) {
    return false;
  }
  for (size_t i = 0; i < length; i++) {
    if (!isalnum((unsigned char)text[i]) && strchr(" _./+-%()*^", text[i]) == NULL) {
      return false;
    }
  }
  return true;
}

void dea_yaml_add_quoted(struct dea_text *out, const char *text, size_t length)
{
  for (const char *c = text; c < text + length; c++) {
    if (*c == '"' || *c == '\\') {
      dea_text_add(out, "\\%c", *c);
    } else if ((unsigned char)*c < 0x20) {
      dea_text_add(out, "\\x%02x", (unsigned)*c);
    } else {
      dea_text_add(out, "%c", *c);
    }
  }
}

static void add_value(struct dea_text *out, const struct dea_node *node)
{
  if (node->empty) {
    dea_text_add(out, "null");
    return;
  }
  if (is_plain(node->text)) {
    dea_text_add(out, "%s", node->text);
    return;
  }
  dea_text_add(out, "\"");
  dea_yaml_add_quoted(out, node->text, strlen(node->text));
  dea_text_add(out, "\"");
}

/* Members of a list or section, each on lines of its own; recursion ends with the depth of a
 * document. `first`: the line of the first member has begun. */
static void add_members(struct dea_text *out, const struct dea_node *node, int indent, bool first)
{
  for (const struct dea_node *child = node->child; child != NULL; child = child->next) {
    dea_text_add(out, "%*s", first ? 0 : indent, "");
    first = false;
    if (child->key != NULL) {
      add_value(out, &(struct dea_node){.text = child->key});
      dea_text_add(out, ":");
    } else {
      dea_text_add(out, "-");
    }
    if (child->kind == DEA_NODE_VALUE) {
      dea_text_add(out, " ");
      add_value(out, child);
      dea_text_add(out, "\n");
    } else if (child->child == NULL) {
      dea_text_add(out, child->kind == DEA_NODE_LIST ? " []\n" : " {}\n");
    } else if (child->key == NULL) { // "- key: ..."
      dea_text_add(out, " ");
      add_members(out, child, indent + 2, true);
    } else {
      dea_text_add(out, "\n");
      add_members(out, child, indent + 2, false);
    }
  }
}

void dea_yaml_write(const struct dea_node *root, struct dea_text *out)
{
  if (root->kind == DEA_NODE_VALUE) {
    add_value(out, root);
    dea_text_add(out, "\n");
  } else {
    add_members(out, root, 0, false);
  }
}
