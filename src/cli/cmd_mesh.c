#include "base/write_file.h"
#include "cli/cli.h"
#include "model/solid/actuator/disc_mesh.h"
#include "model/solid/actuator/mesh_file.h"

struct request {
  const char *design, *output; // output: NULL for none
  struct cli_overrides overrides;
  bool json, force;
};

/* Elements of a membrane. */
static size_t count_flat(const struct dea_grid *grid)
{
  size_t count = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    count += grid->levels[e] == 1;
  }
  return count;
}

/* Elements, nodes, and displacements of all nodes, those that are held too, as model 3d counts
 * them. */
static void print_size(const struct dea_grid *grid)
{
  int face = (grid->order + 1) * (grid->order + 1); // nodes
  size_t flat = count_flat(grid);
  printf("%-20s %zu, ", "elements", grid->element_count);
  if (flat > 0) {
    printf("%zu of them flat, of %d nodes, the others ", flat, face);
  }
  printf("of %d nodes\n", face * (grid->order_z + 1));
  printf("%-20s %zu\n", "nodes", grid->node_count);
  printf("%-20s %zu\n", "unknowns", 3 * grid->node_count);
}

/* Which part of the device it is of. */
static void print_domain(const struct dea_layout_mesh *mesh)
{
  size_t copies = dea_layout_sector_copies(&mesh->sector);
  if (mesh->plate.order > 0) {
    printf("%-20s %g degrees\n", "domain", dea_fibre_disc_angle(&mesh->plate) * 180 / DEA_PI);
  } else if (copies > 1) {
    printf("%-20s one of %zu mirrored sectors, a free mesh\n", "domain", copies);
  } else {
    printf("%-20s the whole device, a free mesh\n", "domain");
  }
}

static void print_mesh(const struct request *request, const struct dea_layout_mesh *mesh)
{
  const struct dea_grid *grid = mesh->grid;
  const struct dea_fibre_disc *plate = &mesh->plate;
  const bool disc = plate->order > 0;
  if (request->json) {
    json_t *json = json_pack(
        "{s:I, s:I, s:I, s:I, s:f}", "elements", (json_int_t)grid->element_count, "flat_elements",
        (json_int_t)count_flat(grid), "nodes", (json_int_t)grid->node_count, "unknowns",
        (json_int_t)(3 * grid->node_count), "smallest_jacobian", dea_grid_smallest_jacobian(grid));
    if (disc) {
      json_object_set_new(json, "angle_deg", json_real(dea_fibre_disc_angle(plate) * 180 / DEA_PI));
      json_object_set_new(json, "size_m", json_real(plate->size));
      json_object_set_new(json, "edge_size_m", json_real(plate->edge));
    }
    cli_print_json(json);
    return;
  }
  print_domain(mesh);
  print_size(grid);
  if (disc) {
    printf("%-20s %.3g mm, %.3g mm at the electrode edge and the ends of fibres\n", "size",
           1e3 * plate->size, 1e3 * plate->edge);
  }
  printf("%-20s %.3f of an element's mean\n", "smallest Jacobian",
         dea_grid_smallest_jacobian(grid));
  if (request->output != NULL) {
    printf("%-20s %s\n", "file", request->output);
  }
}

static dea_status build_mesh(struct dea_cli *cli, const void *user, const struct dea_design *design,
                             const struct dea_device *device)
{
  const struct request *request = user;
  const struct dea_model_settings settings = dea_model_settings_of(design);
  struct dea_layout_mesh mesh;
  dea_status status = dea_device_mesh_create(cli->ctx, device, &settings, &mesh);
  if (status == DEA_OK && request->output != NULL) {
    status = dea_layout_mesh_write(cli->ctx, &mesh, request->output);
  }
  if (status == DEA_OK) {
    print_mesh(request, &mesh);
  }
  dea_layout_mesh_free(cli->ctx, &mesh);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  if (request->output != NULL && !request->force && dea_path_exists(request->output)) {
    return dea_fail(cli->ctx, DEA_E_IO, "'%s' already exists; --force replaces it",
                    request->output);
  }
  return cli_with_device(cli, request->design, &request->overrides, build_mesh, request);
}

static const struct cli_option options[] = {
    CLI_DESIGN_ROW,
    CLI_OUTPUT_ROW(CLI_NEW_FILE, "FILE", "write the mesh as FILE, in Gmsh's format 2.2 (.msh)"),
    CLI_FORCE_ROW('f', "replace a file of that name"),
    CLI_SET_ROW(0, CLI_KEY, "compute.solid.refinement=2"),
    CLI_JSON_ROW("size and quality of the mesh as JSON"),
    {0}};

const struct dea_command cmd_mesh = {
    .name = "mesh", .summary = "Make the mesh of model 3d, and write it for Gmsh", CLI_RUN};
