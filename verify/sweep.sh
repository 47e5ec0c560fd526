#!/bin/sh
# Many designs: bands, kills, and what a design costs. A page on stdout; called by scripts/verify with
# the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
exec python3 "$root/verify/sweep.py" "$1/src/dea" "$root"
