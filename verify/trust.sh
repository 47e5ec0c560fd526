#!/bin/sh
# What the estimated errors of model 3d are worth: a page on stdout. Numbers come from the command alone.
# Called by scripts/verify with the folder of the build; --small as second argument: two designs, as a test.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=$1
shift
exec env PYTHONDONTWRITEBYTECODE=1 python3 "$root/verify/trust.py" "$build/src/dea" "$root" "$@"
