#!/bin/sh
# Devices that others built and measured: a page on stdout, docs/validation/devices.csv and docs/figures/devices.svg
# beside it. Called by scripts/verify with the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
exec env PYTHONDONTWRITEBYTECODE=1 python3 "$root/verify/devices.py" "$1/src/dea" "$root"
