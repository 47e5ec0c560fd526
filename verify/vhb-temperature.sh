#!/bin/sh
# VHB 4905 at several temperatures: a page on stdout. Called by scripts/verify with the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
exec python3 "$root/verify/vhb_temperature.py" "$1/src/dea" "$root"
