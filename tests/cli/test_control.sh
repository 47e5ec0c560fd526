#!/bin/sh
# examples/python/control.py on the strip in pure shear, as a coarse membrane: what its feed-forward,
# observer and loop leave of the errors.
# ctest: solid
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
"$DEA_COMMAND" reduce-order "$source/examples/devices/pure-shear.yaml" -s compute.solid.order=1 \
  -s "compute.reduced={monitor: bar, voltages: 5}" --fmu strip.fmu >out 2>&1 ||
  { cat out; exit 1; }
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$source/examples/python /usr/bin/python3 - <<'END'
import control
left = control.main("strip.fmu")
assert left["creep, feed-forward"] < 0.1 * left["creep, static"]
assert left["error, loop"] < 0.2 * left["error, feed-forward"] and left["error, loop"] < 0.02
assert left["observer, on levels"] < 0.02
END
