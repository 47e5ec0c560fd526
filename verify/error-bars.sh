#!/bin/sh
# How many numbers of model 3d are within their stated error: a page on stdout. Called by scripts/verify with the folder
# of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=$1
shift
exec env PYTHONDONTWRITEBYTECODE=1 python3 "$root/verify/error_bars.py" "$build/src/dea" "$root" "$@"
