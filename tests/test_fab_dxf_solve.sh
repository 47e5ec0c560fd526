#!/bin/sh
# A device computed with the shapes of the DXF that dea fab writes of it: the same monitors.
# ctest: solid
set -u
source=$1
[ -f "$(dirname "$DEA_COMMAND")/dea_solid_module.so" ] || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
command -v gmsh >/dev/null || exit 77
PYTHONPATH="$source/tests" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 - "$source" "$folder" <<'PYTHON'
import json, os, subprocess, sys
from fab_again import again

source, folder, bad = sys.argv[1], sys.argv[2], 0
command = os.environ["DEA_COMMAND"]


def monitors(design, out):
    subprocess.run([command, "--quiet", "run", design, "-o", out, "--study", "sweep", "--set",
                    "compute.voltage={to: 2 kV, step: 2 kV}"], check=True)
    return json.load(open(f"{out}/summary.json"))["monitors"]


def kind(key):
    return "length" if key.endswith("_m") else key


for name in ("two-electrodes", "diaphragm", "pure-shear"):
    design = f"{source}/examples/devices/{name}.yaml"
    wanted = monitors(design, f"{folder}/{name}-run")
    found = monitors(again(command, design, folder), f"{folder}/{name}-run-again")
    largest, off = {}, 0
    for row in wanted:
        for key, value in row.items():
            if isinstance(value, float):
                largest[kind(key)] = max(largest.get(kind(key), 0), abs(value))
    for row, other in zip(wanted, found):
        bad += row.keys() != other.keys()
        for key, value in row.items():
            if isinstance(value, float):
                off = max(off, abs(value - other[key]) / max(largest[kind(key)], 1e-300))
    print(name, largest, "largest difference", off)
    bad += len(wanted) != len(found) or len(largest) < 2 or not off <= 1e-9
sys.exit(bad > 0)
PYTHON
