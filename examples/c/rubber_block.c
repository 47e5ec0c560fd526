/* A block of rubber, 10 x 10 x 40 mm, pulled to twice its length by the 3D engine: the force on its
 * end, beside that of the closed form mu A (l - 1/l^2). */
#include <dea.h>
#include <stdio.h>

int main(void)
{
  const double mu = 0.4e6, side = 10e-3, length = 40e-3;
  dea_part rubber = DEA_PART_INIT;
  rubber.law = "neo-hookean";
  rubber.parameters = &mu;
  rubber.parameter_count = 1;
  const dea_part *parts[] = {&rubber};
  dea_solid_options options = DEA_SOLID_OPTIONS_INIT;
  options.box_m[0] = options.box_m[1] = side;
  options.box_m[2] = length;
  options.elements[0] = options.elements[1] = 1;
  options.elements[2] = 2;
  options.parts = parts;
  options.part_count = 1;

  // the block stands on its lower end and leans on two planes of symmetry
  const double low[3] = {0, 0, 0}, high[3] = {side, side, length}, nothing[3] = {0, 0, 0};
  const double left[3] = {0, side, length}, front[3] = {side, 0, length};
  const double bottom[3] = {side, side, 0}, top[3] = {0, 0, length};
  dea_context *ctx = NULL;
  dea_solid *block = NULL;
  const dea_array *reaction;
  if (dea_context_new(NULL, &ctx) != DEA_OK) {
    return 2;
  }
  int bad = dea_solid_new(ctx, &options, &block) ||
            dea_solid_hold(ctx, block, low, left, 1, nothing) ||
            dea_solid_hold(ctx, block, low, front, 2, nothing) ||
            dea_solid_hold(ctx, block, low, bottom, 4, nothing);
  for (int step = 1; !bad && step <= 4; step++) {
    double stretch = 1 + 0.25 * step, move[3] = {0, 0, (stretch - 1) * length}, force = 0;
    bad = dea_solid_hold(ctx, block, top, high, 4, move) || dea_solid_solve(ctx, block, 0) ||
          dea_solid_array(ctx, block, "reaction_N", &reaction);
    for (size_t i = 0; !bad && i < reaction->shape[0]; i++) {
      force += reaction->data[3 * i + 2] > 0 ? reaction->data[3 * i + 2] : 0;
    }
    if (!bad) {
      printf("stretch %.2f: %7.3f N, closed form %7.3f N\n", stretch, force,
             mu * side * side * (stretch - 1 / (stretch * stretch)));
    }
  }
  if (bad) {
    fprintf(stderr, "%s\n", dea_error_message(ctx));
  }
  dea_solid_free(block);
  dea_context_free(ctx);
  return bad;
}
