/* What the commands share in reading their options. */
#define _GNU_SOURCE // getopt_long
#include "cli/cli.h"

#include "base/file.h"

#include <getopt.h>
#include <string.h>

bool cli_parse_override(char *text, struct dea_override *overrides, size_t room, size_t *count)
{
  char *equals = strchr(text, '=');
  if (equals == NULL || equals == text || *count == room) {
    return false;
  }
  *equals = '\0';
  overrides[*count] = (struct dea_override){.key = text, .value = equals + 1};
  *count += 1;
  return true;
}

void cli_folder_name(const char *design, const char *ending, struct dea_text *out)
{
  size_t length;
  const char *name = dea_path_stem(design, &length);
  dea_text_add(out, "%.*s.%s", (int)length, name, ending);
}

int cli_option_error(struct dea_cli *cli, const struct dea_command *command, int option,
                     char **argv)
{
  const char *word = argv[optind - 1];
  if (option == ':') {
    return cli_usage_error(cli, command, "option '%s' needs a value", word);
  }
  return cli_usage_error(cli, command, "there is no option '%s'", word);
}

int cli_parse_design_arguments(struct dea_cli *cli, const struct dea_command *command,
                               enum cli_writes writes, int argc, char **argv,
                               struct cli_design_arguments *out)
{
  static const struct option longs[] = {
      {"drawing", no_argument, NULL, 'd'},      {"force", no_argument, NULL, 'f'},
      {"output", required_argument, NULL, 'o'}, {"set", required_argument, NULL, 's'},
      {"json", no_argument, NULL, 'j'},         {NULL, 0, NULL, 0}};
  static const char *const letters[] = {":", ":o:", ":o:f"};
  static const int first[] = {3, 2, 0}; // of longs
  int option;
  *out = (struct cli_design_arguments){0};
  opterr = 0;
  while ((option = getopt_long(argc, argv, letters[writes], longs + first[writes], NULL)) != -1) {
    switch (option) {
    case 's':
      if (!cli_parse_override(optarg, out->overrides, CLI_OVERRIDES_MAX, &out->override_count)) {
        return cli_usage_error(cli, command, "--set takes KEY=VALUE, not '%s'", optarg);
      }
      break;
    case 'j':
      out->json = true;
      break;
    case 'o':
      out->output = optarg;
      break;
    case 'f':
      out->force = true;
      break;
    case 'd':
      out->drawing = true;
      break;
    default:
      return cli_option_error(cli, command, option, argv);
    }
  }
  if (argc - optind != 1) {
    return cli_usage_error(
        cli, command, argc == optind ? "a design file is needed" : "one design file at a time");
  }
  out->design = argv[optind];
  return -1;
}

dea_status cli_build_device(struct dea_cli *cli, const struct cli_design_arguments *arguments,
                            struct dea_design **design, struct dea_device **device)
{
  *device = NULL;
  DEA_TRY(cli->ctx, dea_design_read(cli->ctx, arguments->design, arguments->overrides,
                                    arguments->override_count, design));
  return dea_device_build(cli->ctx, *design, device);
}
