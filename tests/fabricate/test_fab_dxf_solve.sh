#!/bin/sh
# A device computed with the shapes of the DXF that dea fab writes of it: the same monitors. One with
# circles of Bezier curves costs what one with circles does, for the same answer.
# ctest: solid
set -u
source=$1
[ -f "$(dirname "$DEA_COMMAND")/dea_solid_module.so" ] || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
command -v gmsh >/dev/null || exit 77
PYTHONPATH="$source/tests" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 - "$source" "$folder" <<'PYTHON'
import json, os, re, subprocess, sys
from fab_again import again

source, folder, bad = sys.argv[1], sys.argv[2], 0
command = os.environ["DEA_COMMAND"]


def monitors(design, out):
    subprocess.run([command, "--quiet", "run", design, "-o", out, "--study", "sweep", "--set",
                    "compute.voltage={to: 2 kV, step: 2 kV}"], check=True)
    return json.load(open(f"{out}/summary.json"))["points"]


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
sizes, points = [], []
for name in ("arcs", "film"):
    made = subprocess.run([command, "run", f"{source}/tests/cases/drawings/bezier/{name}.yaml", "-o", f"{folder}/{name}"],
                          check=True, capture_output=True, text=True)
    sizes.append(int(re.search(r"(\d+) unknowns", made.stderr).group(1)))
    points.append(json.load(open(f"{folder}/{name}/summary.json"))["points"])
print("circles, and of cubics:", sizes, points)
area = [p[0]["capacitance_F"] for p in points]
edge = [p[-1]["edge_x_m"] for p in points]
# the same circle; and meshes that are not the same, so that each is off by its own error
bad += sizes[1] > 1.1 * sizes[0] or not abs(area[1] / area[0] - 1) <= 1e-7
bad += not abs(edge[1] - edge[0]) <= max(p[-1]["edge_x_error_m"] for p in points)
sys.exit(bad > 0)
PYTHON
