/* Fuzz target: files of Gmsh, as plane meshes. */
#include "fuzz.h"

#include "model/solid/mesh/msh_read.h"

#include <stdint.h>

static void check(const struct dea_plane_mesh *mesh)
{
  size_t per_quad = (size_t)((mesh->order + 1) * (mesh->order + 1));
  for (size_t i = 0; i < mesh->quad_count * per_quad; i++) {
    if (mesh->quads[i] < 0 || (size_t)mesh->quads[i] >= mesh->node_count) {
      __builtin_trap();
    }
  }
  for (size_t e = 0; e < mesh->quad_count; e++) {
    if (mesh->region[e] < 0 || (size_t)mesh->region[e] >= mesh->region_count) {
      __builtin_trap();
    }
  }
  for (size_t i = 0; i < mesh->edge_count; i++) {
    if ((size_t)mesh->edge_curve[i] >= mesh->curve_count) {
      __builtin_trap();
    }
  }
  if (!(dea_plane_mesh_smallest_jacobian(mesh, NULL) >= DEA_MSH_JACOBIAN_MIN)) {
    __builtin_trap();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  struct dea_plane_mesh *mesh;
  char *text = dea_copy_text(ctx, (const char *)data, size);
  if (text == NULL) {
    return 0;
  }
  dea_status status = dea_msh_parse(ctx, text, "fuzz", 1e-3, &mesh);
  if (status == DEA_OK) {
    check(mesh);
  } else if (dea_context_message(ctx)[0] == '\0') {
    __builtin_trap(); // an error that nobody is told about
  }
  dea_plane_mesh_destroy(ctx, mesh);
  dea_free(ctx, text);
  return 0;
}
