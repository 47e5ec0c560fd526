/* What is there: models with what each can do, studies, and the keys of a design with the values
 * that they have when nobody gives one. */
#include <dea.h>
#include <stdio.h>

int main(void)
{
  static const char design_text[] = "dea: 1\n"
                                    "film: {material: elastosil-2030, thickness: 100 um}\n"
                                    "pre_stretch: 1.5\n"
                                    "frame: {inner_radius: 15 mm}\n"
                                    "electrodes: {radius: 5 mm stretched}\n";
  dea_context *ctx;
  dea_design *design;
  const dea_model_info *model;
  const dea_study_info *study;
  const dea_value *value;
  if (dea_context_new(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  printf("libdea %s\n", dea_version());
  for (size_t i = 0; (model = dea_model_at(ctx, i)) != NULL; i++) {
    printf("model %s:%s%s%s%s\n", model->name, model->available ? "" : " (not installed)",
           model->abilities & DEA_CAN_PATH ? " path" : "",
           model->abilities & DEA_CAN_INDENT ? " indent" : "",
           model->abilities & DEA_CAN_TIME ? " time" : "");
  }
  for (size_t i = 0; (study = dea_study_at(ctx, i)) != NULL; i++) {
    printf("study %s%s%s\n", study->name, study->needs[0] != '\0' ? ", needs " : "", study->needs);
  }
  int bad = dea_design_parse(ctx, design_text, "disc", &design) != DEA_OK;
  for (size_t i = 0; !bad && (value = dea_design_value_at(design, i)) != NULL; i++) {
    printf("%s = %s%s\n", value->key, value->text,
           value->origin == DEA_DEFAULT ? " (default)" : "");
  }
  dea_design_free(design);
  dea_context_free(ctx);
  return bad;
}
