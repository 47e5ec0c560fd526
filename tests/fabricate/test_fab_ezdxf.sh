#!/bin/sh
# ctest: slow, heavy
# DXF files as another program reads them: python3-ezdxf finds nothing wrong, and its areas and
# lengths are those of the design.
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
/usr/bin/python3 -c 'import ezdxf' || {
  echo "python3-ezdxf is needed: apt-get install python3-ezdxf (packages.txt)"
  exit 1
}
for example in frdea-4 frdea-8 plain-disc devices/bender devices/quadrants; do
  mkdir -p "$folder/devices"
  "$DEA_COMMAND" --quiet fab "$source/examples/$example.yaml" -o "$folder/$example" --json \
    --set fabrication.kerf=0mm --set fabrication.copies=2 --set 'compute.voltage={values: [0 V]}' >"$folder/$example.json" || exit 1
done
/usr/bin/python3 - "$folder" <<'PYTHON'
import glob, json, math, os, sys
import ezdxf

folder, bad, read = sys.argv[1], 0, 0


def shape_of(entity):
    """Area and length of a closed entity, in mm."""
    if entity.dxftype() == "CIRCLE":
        r = entity.dxf.radius
        return math.pi * r * r, 2 * math.pi * r
    points = list(entity.get_points("xyb"))
    area = length = 0.0
    for (x, y, bulge), (u, v, _) in zip(points, points[1:] + points[:1]):
        chord = math.hypot(u - x, v - y)
        area += 0.5 * (x * v - u * y)
        if bulge:
            centre, start, end, radius = ezdxf.math.bulge_to_arc((x, y), (u, v), bulge)
            angle = (end - start) % (2 * math.pi)
            area += math.copysign(0.5 * radius * radius * (angle - math.sin(angle)), bulge)
            length += radius * angle
        else:
            length += chord
    return area, length


for example in ("frdea-4", "frdea-8", "plain-disc", "devices/bender", "devices/quadrants"):
    parts = {p["name"]: p for p in json.load(open(f"{folder}/{example}.json"))["parts"]}
    for name in sorted(glob.glob(f"{folder}/{example}/*.dxf")):
        drawing = ezdxf.readfile(name)
        audit = drawing.audit()
        read += 1
        if os.path.basename(name) == "layout.dxf":  # shapes by name, of which none is cut
            bad += len(audit.errors + audit.fixes) > 0 or drawing.units != 4
            continue
        part = parts[os.path.basename(name)[:-4]]
        area = length = 0.0
        for entity in drawing.modelspace():
            layer = entity.dxf.layer
            if layer in ("CUT_OUTER", "CUT_INNER"):
                a, l = shape_of(entity)
                area += a if layer == "CUT_OUTER" else -a
                length += l
        wanted = 1e6 * part["area_m2"] * part["copies"], 1e3 * part["cut_length_m"] * part["copies"]
        # 1 um along the whole edge
        wrong = abs(length - wanted[1]) > 1e-3 or abs(area - wanted[0]) > 1e-3 * max(1, length)
        if audit.errors or audit.fixes or drawing.units != 4 or drawing.dxfversion != "AC1015" or wrong:
            print(name, [e.message for e in audit.errors + audit.fixes], drawing.units, area, length, wanted)
            bad += 1
if read != 32:
    print("wanted 32 files, found", read)
    bad += 1
sys.exit(bad > 0)
PYTHON
