/* What the commands share in reading their options. */
#include "cli/cli.h"

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

int cli_option_error(struct dea_cli *cli, const struct dea_command *command, int option,
                     char **argv)
{
  const char *word = argv[optind - 1];
  if (option == ':') {
    return cli_usage_error(cli, command, "option '%s' needs a value", word);
  }
  return cli_usage_error(cli, command, "there is no option '%s'", word);
}
