#!/bin/sh
# Drawings that another program writes: the areas of layers of DXF files by python3-ezdxf are those
# that it computes itself, or closed forms.
# ctest: quick, heavy
set -u
/usr/bin/python3 -c 'import ezdxf' || {
  echo "python3-ezdxf is needed: apt-get install python3-ezdxf (packages.txt)"
  exit 1
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
/usr/bin/python3 - "$folder" <<'PYTHON'
import json, math, os, subprocess, sys
import ezdxf
from ezdxf import disassemble, path
from ezdxf.math import Vec3

folder, bad, command = sys.argv[1], 0, os.environ["DEA_COMMAND"]
pi = math.pi


def area_of(points):
    return 0.5 * abs(sum(p.x * q.y - p.y * q.x for p, q in zip(points, points[1:] + points[:1])))


def by_ezdxf(space):
    """Area of one closed contour as ezdxf flattens it, in mm2."""
    entities = list(disassemble.recursive_decompose(space))
    paths = [path.make_path(e) for e in entities]
    rest, points = paths[1:], list(paths[0].flattening(1e-6, 32))
    while rest:  # ends that follow each other
        end = points[-1]
        k = min(range(len(rest)), key=lambda i: min((rest[i].start - end).magnitude, (rest[i].end - end).magnitude))
        more = list(rest.pop(k).flattening(1e-6, 32))
        points += more if (more[0] - end).magnitude < (more[-1] - end).magnitude else more[::-1]
    return area_of(points)


def spline(space):
    control = [(0, 0), (10, 8), (20, -3), (30, 6)]
    space.add_open_spline(control, degree=3, dxfattribs={"layer": "a"})
    line(space, (30, 6), (30, -20), (0, -20), (0, 0))


def line(space, *points):
    for p, q in zip(points, points[1:]):
        space.add_line(p, q, dxfattribs={"layer": "a"})


RING = Vec3.list([(0, 0), (10, 8), (20, -3), (30, 6), (25, -12), (5, -9)])


def closed_spline(space):
    space.add_spline(dxfattribs={"layer": "a"}).set_closed(RING)


def area_of_closed_spline():
    """By the basis of uniform cubics."""
    points = []
    for k in range(len(RING)):
        p = [RING[(k + i) % len(RING)] for i in range(4)]
        for t in (i / 1000 for i in range(1000)):
            w = (1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3
            points.append(sum((q * (v / 6) for q, v in zip(p, w)), Vec3()))
    return area_of(points)


def rational(space):
    space.add_rational_spline([(0, 0), (10, 18), (20, -3), (30, 6)], [1, 3, 0.5, 1], degree=3,
                              dxfattribs={"layer": "a"})
    line(space, (30, 6), (30, -20), (0, -20), (0, 0))


def ellipse(space):
    space.add_ellipse((3, 4), (10, 5), 0.4, dxfattribs={"layer": "a"})


def part_of_ellipse(space, normal=(0, 0, 1)):
    e = space.add_ellipse((3, 4), (10, 5), 0.4, 0.5, 4.5, dxfattribs={"layer": "a", "extrusion": normal})
    line(space, e.end_point, e.start_point)


def ring(block, layer="0"):
    """A plate with a bulge and a spline, on layer 0."""
    block.add_lwpolyline([(0, 0, 0.3), (10, 0, -0.2), (10, 6, 0), (0, 6, 0)], format="xyb", close=True,
                         dxfattribs={"layer": layer})


def inserted(**how):
    def draw(space):
        b = space.doc.blocks.new("plate", base_point=(2, 1))
        ring(b)
        extra = {k: how[k] for k in ("count", "spacing") if k in how}
        attributes = {k: v for k, v in how.items() if k not in extra}
        insert = space.add_blockref("plate", (7, -3), dxfattribs={"layer": "a", **attributes})
        if extra:
            insert.grid(extra["count"], extra["spacing"])
    return draw


def nested(space):
    ring(space.doc.blocks.new("plate", base_point=(2, 1)))
    outer = space.doc.blocks.new("Outer")
    outer.add_blockref("plate", (5, 5), dxfattribs={"xscale": 2, "yscale": -1, "rotation": 20})
    space.add_blockref("OUTER", (100, 3), dxfattribs={"layer": "a", "rotation": 70, "xscale": -0.5, "extrusion": (0, 0, -1)})


def mirrored(space):
    p = space.add_lwpolyline([(-20, 5, 0), (-30, 5, 0.5), (-30, 10, 0), (-20, 10, 0.1)], format="xyb", close=True,
                             dxfattribs={"layer": "a"})
    p.dxf.extrusion = (0, 0, -1)


def mirrored_arc(space):
    a = space.add_arc((-5, 2), 4, 30, 200, dxfattribs={"layer": "a", "extrusion": (0, 0, -1)})
    line(space, a.end_point, a.start_point)


def flat(space):
    space.add_polyline3d([(0, 0, 3), (40, 0, 3), (40, 20, 3), (0, 20, 3)], close=True, dxfattribs={"layer": "a"})


def old(space):
    p = space.add_polyline2d([(0, 0, 0.4), (9, 1, 0), (4, 8, -0.3)], format="xyb", close=True, dxfattribs={"layer": "a"})
    p.dxf.extrusion = (0, 0, -1)


def plate(factor):
    """Area of so many of ring's."""

    def segment(bulge, chord):
        angle, r = 4 * math.atan(bulge), chord * (1 + bulge * bulge) / (4 * bulge)
        return 0.5 * r * r * (angle - math.sin(angle))
    return factor * (60 + segment(0.3, 10) - segment(0.2, 6))


DRAWINGS = {  # area; None: as ezdxf flattens it
    "spline": (spline, None), "closed_spline": (closed_spline, area_of_closed_spline()), "rational": (rational, None),
    "ellipse": (ellipse, pi * 125 * 0.4), "part": (part_of_ellipse, 0.5 * 50 * (4 - math.sin(4))),
    "part_below": (lambda s: part_of_ellipse(s, (0, 0, -1)), 0.5 * 50 * (4 - math.sin(4))),
    "insert": (inserted(), plate(1)), "scaled": (inserted(xscale=2, yscale=2, rotation=33), plate(4)),
    "uneven": (inserted(xscale=2, yscale=0.5, rotation=33), None),
    "mirror": (inserted(xscale=-1, rotation=33), plate(1)), "below": (inserted(extrusion=(0, 0, -1), rotation=33), plate(1)),
    "array": (inserted(count=(3, 2), spacing=(50, 60), rotation=33, xscale=2, yscale=2), plate(24)),
    "nested": (nested, None), "mirrored": (mirrored, None), "mirrored_arc": (mirrored_arc, None), "flat": (flat, 800),
    "old": (old, None),
}
DESIGN = """dea: 1
shapes: [{{name: film, kind: drawing, file: "{file}", layer: {layer}}}]
plies: [{{name: film, shape: film, material: elastosil-2030, thickness: 100 um}}]
electrodes: [{{ply: film, side: bottom, shape: film, channel: ground}}, {{ply: film, side: top, shape: film, channel: drive}}]
supports: [{{edge: film}}]
"""


def check(name, layer, wanted, near, ending="dxf"):
    global bad
    design = f"{folder}/{name}.yaml"
    with open(design, "w", encoding="utf-8") as out:
        out.write(DESIGN.format(file=f"{name}.{ending}", layer=layer))
    made = subprocess.run([command, "check", design, "--json"], capture_output=True, text=True)
    try:
        found = 1e6 * json.loads(made.stdout)["derived"]["area_m2"]["film"]
    except (ValueError, KeyError):
        found = math.nan
    if not abs(found - wanted) <= near:
        print(name, layer, "found", found, "wanted", wanted, made.stderr[-600:])
        bad += 1


for number, (name, (draw, wanted)) in enumerate(DRAWINGS.items()):
    document = ezdxf.new(("R2000", "R2018")[number % 2], units=4)
    draw(document.modelspace())
    document.saveas(f"{folder}/{name}.dxf")
    exact = wanted is not None and name not in ("closed_spline", "ellipse", "part", "part_below")
    wanted = by_ezdxf(document.modelspace()) if wanted is None else wanted
    check(name, "a", wanted, 1e-9 * wanted if exact else 0.02)  # 0.1 um along 200 mm

for page, layer in (("cp1252", "électrode"), ("cp1251", "рамка"), ("gbk", "外框"), ("cp932", "電極"), ("cp949", "전극"),
                    ("cp1253", "ηλεκτρόδιο"), ("cp1252", "外框")):  # the last one by escapes
    document = ezdxf.new("R2000", units=4)
    document.encoding = page
    document.layers.add(layer)
    document.modelspace().add_circle((0, 0), 3, dxfattribs={"layer": layer})
    document.saveas(f"{folder}/page.dxf", encoding=page)
    check("page", layer, 9 * pi, 1e-9)

def circle(x, y, r, h=0.5522847498):
    c = [(r, 0), (r, h * r), (h * r, r), (0, r), (-h * r, r), (-r, h * r), (-r, 0), (-r, -h * r), (-h * r, -r), (0, -r),
         (h * r, -r), (r, -h * r), (r, 0)]
    p = [f"{x + u:.8g},{y + v:.8g}" for u, v in c]
    return f"M {p[0]} C {' '.join(p[1:])} Z"


# 900 holes of four Bezier curves each
holes = " ".join(circle(15 + 2.4 * (i % 30), 15 + 2.4 * (i // 30), 0.4) for i in range(900))
with open(f"{folder}/perforated.svg", "w", encoding="utf-8") as out:
    out.write('<svg width="100mm" height="100mm" viewBox="0 0 100 100"><g id="film">'
              f'<path d="M 0,0 H 100 V 100 H 0 Z {holes}"/></g></svg>')
check("perforated", "film", 1e4 - 900 * pi * 0.16, 0.01, "svg")
sys.exit(bad > 0)
PYTHON
