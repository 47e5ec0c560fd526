#!/bin/sh
# The shapes that dea fab writes of each example, read back by layer: the same areas.
# ctest: workshop
set -u
source=$1
[ -f "$(dirname "$DEA_COMMAND")/dea_geos_module.so" ] || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PYTHONPATH="$source/tests" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 - "$source" "$folder" <<'PYTHON'
import glob, os, sys
from fab_again import again, areas

source, folder, bad, seen = sys.argv[1], sys.argv[2], 0, 0
command = os.environ["DEA_COMMAND"]
for design in sorted(glob.glob(f"{source}/examples/devices/*.yaml")):
    wanted, found = areas(command, design), areas(command, again(command, design, folder))
    for name, area in found.items():
        seen += 1
        if not abs(area - wanted[name]) <= 1e-9 * wanted[name]:
            print(design, name, wanted[name], area)
            bad += 1
if seen < 30:
    print("only", seen, "shapes were read back")
    bad += 1
sys.exit(bad > 0)
PYTHON
