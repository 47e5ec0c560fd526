#!/bin/sh
# A search in model 3d with its gradients and without: a page on stdout; called by scripts/verify with
# the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
exec python3 "$root/verify/optimise_3d.py" "$1/src/dea" "$root"
