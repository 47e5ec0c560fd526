/* The identity of a device: every key of the schema and every number of a material is part of it,
 * but those that are said not to matter. */
#include "device/identity.h"
#include "study/design_file.h"

#include "testing.h"

#include "context_fixture.h"

#include <stdio.h>
#include <string.h>

static struct dea_text text_of_material(const struct dea_material *material)
{
  struct dea_text text = {.ctx = ctx};
  dea_material_identity(material, &text);
  assert_false(text.failed);
  return text;
}

#define MEMBER(member)                                                                             \
  {                                                                                                \
    offsetof(struct dea_material, member),                                                         \
        offsetof(struct dea_material, member) + sizeof((struct dea_material *)NULL)->member        \
  }

/* Whatever word of the struct changes, a new member's too: only names, and how sure the numbers
 * are, do not matter. */
TEST(test_every_number_of_a_material)
{
  static const struct {
    size_t from, to;
  } others[] = {MEMBER(name), MEMBER(law_id), MEMBER(viscosity_id), MEMBER(param_std),
                MEMBER(correlation)};
  size_t changed = 0;
  struct dea_material material = {.law = dea_law_find("holzapfel-gasser-ogden"),
                                  .breakdown = {.known = true, .exponent_known = true},
                                  .viscosity_assumed = true};
  struct dea_text before = text_of_material(&material);
  for (size_t at = 0; at + sizeof(double) <= sizeof material; at += sizeof(double)) {
    struct dea_material other = material;
    bool matters = true;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
      matters = matters && (at < others[i].from || at >= others[i].to);
    }
    const struct dea_law *law = dea_law_find("yeoh");
    const double number = 1.5; // of which the first byte is 0: of a bool false
    if (at == offsetof(struct dea_material, law)) {
      memcpy((char *)&other + at, &law, sizeof law);
    } else {
      memcpy((char *)&other + at, &number, sizeof number);
    }
    struct dea_text after = text_of_material(&other);
    if ((strcmp(dea_text_get(&before), dea_text_get(&after)) != 0) != matters) {
      fail_msg("word at %zu of a material", at);
    }
    changed += matters;
    dea_text_free(&after);
  }
  assert_true(changed > 40);
  dea_text_free(&before);
}

static const char disc_text[] =
    "dea: 1\nfilm: {material: elastosil-2030, thickness: 90 um}\npre_stretch: 1.3\n"
    "frame: {inner_diameter: 40 mm}\nelectrodes: {diameter: 11 mm stretched}\n"
    "fibres: {count: 6, width: 0.3 mm, thickness: 90 um, length: 16 mm stretched, material: pet}\n"
    "compute: {solid: {adapt: {monitor: m}}}\n";
static const char layout_text[] =
    "dea: 1\nshapes:\n"
    "  - {name: film, kind: circle, radius: 19 mm}\n  - {name: hub, kind: circle, radius: 3 mm}\n"
    "plies: [{name: film, shape: film, material: elastosil-2030, thickness: 90 um}]\n"
    "electrodes: [{ply: film, side: bottom, shape: hub, channel: a}]\n"
    "channels: [{name: a}]\nsupports: [{edge: film}]\n"
    "bodies: [{name: hub, shape: hub}]\n"
    "springs: [{body: hub, direction: z, stiffness: 7 N/m}]\n"
    "pressures: [{ply: film, side: top, shape: film, pressure: 5 Pa}]\n"
    "contacts: [{ply: film, side: bottom, shape: film, gap: 1 mm}]\n"
    "monitors: [{name: m, from: [1 mm, 1 mm], to: [2 mm, 1 mm]}]\n"
    "compute: {solid: {adapt: {monitor: m}}}\n";

/* Identity of a design with a key set; "" where it cannot be read so. */
static struct dea_text identity_with(const char *text, const char *key, const char *value)
{
  struct dea_text out = {.ctx = ctx};
  struct dea_design *design;
  const struct dea_override override = {key, value};
  const dea_status status =
      dea_design_read_memory(ctx, "d.yaml", text, strlen(text), &override, key != NULL, &design);
  if (status == DEA_OK) {
    dea_device_identity(design, NULL, NULL, &out);
    assert_false(out.failed);
    dea_design_destroy(ctx, design);
  }
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return out;
}

struct walk {
  const char *text;     // of the design that is changed
  struct dea_text base; // its identity
  size_t keys;          // that were changed
};

/* Whether a value of the key gives another identity; *read: of those that can be read. */
static bool changes(struct walk *walk, const char *path, const char *value, bool *read)
{
  struct dea_text after = identity_with(walk->text, path, value);
  const bool differs =
      after.length > 0 && strcmp(dea_text_get(&walk->base), dea_text_get(&after)) != 0;
  *read = *read || after.length > 0;
  dea_text_free(&after);
  return differs;
}

/* Tries values of a key until one can be read and is another one: its example, its choices, and
 * what all kinds of keys take. */
static void check_key(struct walk *walk, const struct dea_field *field, const char *path)
{
  static const char *const more[] = {"another",
                                     "0.31 mm",
                                     "[2 mm, 7 mm]",
                                     "[3d]",
                                     "3 mm stretched",
                                     "[[0 mm, 0 mm], [7 mm, 0 mm], [7 mm, 9 mm]]",
                                     "{kind: sine, amplitude: 2 kV, frequency: 1 Hz}"};
  bool read = false, differs = false;
  for (size_t i = 0; field->choices != NULL && field->choices[i] != NULL && !differs; i++) {
    char list[64];
    snprintf(list, sizeof list, field->list_max > 0 ? "[%s]" : "%s", field->choices[i]);
    differs = changes(walk, path, list, &read);
  }
  differs = differs || (field->example != NULL && changes(walk, path, field->example, &read));
  for (int k = 1; k < 4 && !differs && field->unit != NULL; k++) {
    char number[64];
    snprintf(number, sizeof number, field->list_min > 1 ? "[%g %s, 0 %s]" : "%g %s", 0.5 * k,
             strcmp(field->unit, "1") != 0 ? field->unit : "",
             strcmp(field->unit, "1") != 0 ? field->unit : "");
    differs = changes(walk, path, number, &read);
  }
  for (size_t i = 0; i < sizeof more / sizeof more[0] && !differs; i++) {
    differs = changes(walk, path, more[i], &read);
  }
  if (!read && strcmp(path, "dea") != 0) {
    fail_msg("no value of %s can be read", path);
  }
  if (differs != dea_identity_has(path)) {
    fail_msg("%s: %s the identity", path, differs ? "changes" : "does not change");
  }
  walk->keys++;
}

/* All keys of a record; of lists those of the first item. */
static void check_record(struct walk *walk, const struct dea_record *record, const char *path)
{
  for (size_t i = 0; i < record->field_count; i++) {
    const struct dea_field *field = &record->fields[i];
    char own[200];
    snprintf(own, sizeof own, "%s%s%s", path, path[0] != '\0' ? "." : "", field->key);
    if (field->elsewhere != NULL || strcmp(own, "shapes") == 0 || !dea_identity_has(own)) {
      continue; // none here; of kinds of their own; the whole section does not matter
    }
    if (dea_field_has_record(field)) {
      snprintf(own + strlen(own), sizeof own - strlen(own), "%s", field->list_max > 0 ? "[0]" : "");
      check_record(walk, field->record, own);
    } else {
      check_key(walk, field, own);
    }
  }
}

TEST(test_every_key_of_a_design)
{
  struct dea_design_schema schema;
  dea_design_file_schema(&schema);
  struct walk disc = {disc_text, identity_with(disc_text, NULL, NULL), 0};
  struct walk layout = {layout_text, identity_with(layout_text, NULL, NULL), 0};
  assert_true(disc.base.length > 0 && layout.base.length > 0);
  check_record(&disc, &schema.disc.record, "");
  check_record(&layout, &schema.general.record, "");
  assert_true(disc.keys > 50 && layout.keys > 60);
  dea_text_free(&disc.base);
  dea_text_free(&layout.base);
}

/* Keys of every kind of shape. */
TEST(test_every_key_of_a_shape)
{
  struct dea_design_schema schema;
  dea_design_file_schema(&schema);
  for (size_t k = 0; k < schema.shapes.count; k++) {
    const struct dea_record *record = &schema.shapes.record[k];
    char text[2000];
    size_t used =
        (size_t)snprintf(text, sizeof text, "dea: 1\nshapes:\n  - {kind: %s", record->name);
    for (size_t i = 0; i < record->field_count; i++) {
      const struct dea_field *field = &record->fields[i];
      if (field->required && strcmp(field->key, "kind") != 0) {
        used += (size_t)snprintf(text + used, sizeof text - used, ", %s: %s", field->key,
                                 field->example);
      }
    }
    snprintf(text + used, sizeof text - used,
             "}\nplies: [{name: film, shape: film, material: elastosil-2030, thickness: 90 um}]\n");
    struct walk walk = {text, identity_with(text, NULL, NULL), 0};
    assert_true(walk.base.length > 0);
    for (size_t i = 0; i < record->field_count; i++) {
      char path[80];
      snprintf(path, sizeof path, "shapes[0].%s", record->fields[i].key);
      if (strcmp(record->fields[i].key, "kind") != 0) {
        check_key(&walk, &record->fields[i], path);
      }
    }
    dea_text_free(&walk.base);
  }
}

TESTS(context_set_up, context_tear_down)
