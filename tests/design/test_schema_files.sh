#!/bin/sh
# ctest: quick, heavy
# The JSON Schemas of data/schema are those of this program; they accept all files that ship and
# refuse what the tests of errors say is wrong.
set -eu
python=/usr/bin/python3
"$python" -c 'import jsonschema, yaml' 2>/dev/null || exit 77
folder=$(mktemp -d "${TMPDIR:-/tmp}/dea-schema.XXXXXX")
trap 'rm -rf "$folder"' EXIT
bench="protocol mapping"
"$DEA_COMMAND" drive --help | grep -q 'Not in this build' && bench=
for kind in design material $bench fit fit-device fit-breakdown fit-life explore; do
  option=--$kind
  [ "$kind" != design ] || option=
  # shellcheck disable=SC2086 # none, or one
  "$DEA_COMMAND" schema --json $option >"$folder/$kind.json"
  cmp "$folder/$kind.json" "$1/data/schema/$kind.json" || {
    echo "write it anew: dea schema --json $option >data/schema/$kind.json"
    exit 1
  }
done
errors=$(dirname "$DEA_COMMAND")/../tests/test_design_errors
mkdir "$folder/cases"
DEA_CASES=$folder/cases "$errors" >/dev/null 2>&1
exec "$python" "$1/tests/schema_files.py" "$1" "$folder/cases"
