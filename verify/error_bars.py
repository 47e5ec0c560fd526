"""Page docs/verification/error-bars.md: how many numbers of model 3d are within the error that is stated beside them,
on 40 devices, 20 of them of plies. Arguments: as of trust.py, whose runs and limits these are; --jobs N: devices at once."""

import concurrent.futures
import csv
import math
import sys

from trust import JOBS, MESHES, MESHES_PLIES, ONLY, ROOT, SHORT, SMALL, WELL_KNOWN, design_rows

NEGLIGIBLE = 1e-3  # of the quantity: with less found and estimated, a number is not counted for effectivities
SMALLEST = {"um": 1e-2, "1": 1e-6}  # what changes by less on finer meshes is not seen
WANTED = (0.7, 3)

FILM = "material: elastosil-2030, thickness: %s um, pre_stretch: %s"


def electrodes(shape):
    return [f"{{ply: film, side: bottom, shape: {shape}, channel: ground}}",
            f"{{ply: film, side: top, shape: {shape}, channel: drive}}"]


def design(shapes, plies, **parts):
    """A design of plies, from the lines of its lists."""
    lists = {"shapes": shapes, "plies": plies} | parts
    text = ["dea: 1", "title: a device of plies"]
    for key, lines in ((key, lines) for key, lines in lists.items() if lines):
        text += [f"{key}: {lines}"] if isinstance(lines, str) else [f"{key}:"] + [f"  - {line}" for line in lines]
    return "\n".join(text) + "\ncompute: {voltage: {to: 1 kV}}\n"


def cone(hub_mm, mass_g, thickness_um, stretch, held="z"):
    return design(
        ["{name: film, kind: circle, radius: 20 mm}", f"{{name: hub, kind: circle, radius: {hub_mm} mm}}",
         "{name: active, kind: difference, of: [film, hub]}"],
        ["{name: film, shape: film, " + FILM % (thickness_um, stretch) + "}"], electrodes=electrodes("active"),
        supports=["{edge: film}"], bodies=[f"{{name: hub, shape: hub, mass: {mass_g} g, free: [{held}]}}"],
        monitors=["{name: hub, body: hub}", "{name: middle, at: [12 mm, 0 mm]}"], gravity="top_up")


def diaphragm(shape, thickness_um, stretch, pressure):
    active = shape.replace("film", "active").replace("10 mm", "8.5 mm").replace("14 mm", "12 mm")
    return design([shape, active], ["{name: film, shape: film, " + FILM % (thickness_um, stretch) + "}"],
                  electrodes=electrodes("active"), supports=["{edge: film}"],
                  pressures=[f"{{ply: film, side: bottom, shape: film, pressure: {pressure} Pa}}"],
                  monitors=["{name: middle, at: [0 mm, 0 mm]}", "{name: active, shape: active}",
                            "{name: aside, at: [4 mm, 3 mm]}"])


def stiff(stiff_um, inner_mm, outer_mm, thickness_um, stretch, pressure):
    """A disc of electrode that ends beside a ring of something stiff."""
    return design(
        ["{name: film, kind: circle, radius: 15 mm}",
         f"{{name: stiff, kind: ring, inner_radius: {inner_mm} mm, outer_radius: {outer_mm} mm}}",
         "{name: active, kind: circle, radius: 5 mm}"],
        ["{name: film, shape: film, " + FILM % (thickness_um, stretch) + "}",
         f"{{name: stiff, shape: stiff, material: pet, thickness: {stiff_um} um}}"],
        electrodes=electrodes("active"), supports=["{edge: film}"],
        pressures=[f"{{ply: film, side: bottom, shape: film, pressure: {pressure} Pa}}"] if pressure else [],
        monitors=["{name: edge, at: [5 mm, 0 mm], ply: film}", "{name: middle, at: [0 mm, 0 mm], ply: film}",
                  "{name: active, shape: active, ply: film}"])


def bar(width_mm, height_mm, thickness_um, stretch, force_mN):
    """A rigid bar in the middle of a clamped film, pulled along it."""
    return design(
        [f"{{name: film, kind: rectangle, width: {width_mm} mm, height: {height_mm} mm}}",
         f"{{name: bar, kind: rectangle, width: 2 mm, height: {height_mm / 2} mm}}",
         f"{{name: active, kind: rectangle, x: {width_mm / 4} mm, width: {width_mm / 2 - 4} mm, height: {height_mm - 4} mm}}"],
        ["{name: film, shape: film, " + FILM % (thickness_um, stretch) + "}"], electrodes=electrodes("active"),
        supports=["{edge: film}"], bodies=[f"{{name: bar, shape: bar, free: [x], force_x: {force_mN} mN}}"],
        monitors=["{name: bar, body: bar}", "{name: active, shape: active}",
                  f"{{name: side, at: [{width_mm / 4 + 1} mm, 2 mm]}}"])


ROUND, SQUARE = "{name: film, kind: circle, radius: 10 mm}", "{name: film, kind: rectangle, width: 20 mm, height: 14 mm}"
SOLID = {"compute.solid.film": "solid"}
# name, voltage [kV], an example or the text of a design, what is changed of it
OF_PLIES = [
    ("cone, pre-stretch 1.1", 5, cone(5, 20, 100, 1.1), {}),
    ("cone, pre-stretch 1.2", 5, cone(5, 20, 100, 1.2), {}),
    ("cone, pre-stretch 1.05, film of 200 um", 4, cone(5, 30, 200, 1.05), {}),
    ("cone, film of 50 um, 5 g", 2, cone(5, 5, 50, 1.2), {}),
    ("cone, hub of 10 mm, 40 g", 4, cone(10, 40, 100, 1.15), {}),
    ("cone, hub of 3 mm, 10 g", 4, cone(3, 10, 100, 1.3), {}),
    ("cone (membrane)", 5, cone(5, 20, 100, 1.1), {"compute.solid.film": "membrane"}),
    ("diaphragm", 4, "devices/diaphragm", {}),
    ("diaphragm, pre-stretch 1.3", 4, diaphragm(ROUND, 100, 1.3, 1000), {}),
    ("diaphragm, film of 200 um", 4, diaphragm(ROUND, 200, 1.1, 1000), {}),
    ("rectangular diaphragm", 3, diaphragm(SQUARE, 100, 1.15, 500), {}),
    ("two electrodes", 4, "devices/two-electrodes", SOLID),
    ("two electrodes, film of 200 um", 5, "devices/two-electrodes", SOLID | {"plies.film.thickness": "200 um"}),
    ("beside a stiff ring", 3, stiff(250, 6, 9, 100, 1.2, 0), {}),
    ("beside a stiff ring, at its edge", 3, stiff(250, 5, 7, 100, 1.2, 0), {}),
    ("beside a stiff ring, under pressure", 3, stiff(100, 6, 12, 100, 1.15, 300), {}),
    ("bar in a clamped film", 3, bar(24, 12, 100, 1.2, 50), {}),
    ("bar in a clamped film of 200 um", 4, bar(24, 12, 200, 1.15, 80), {}),
    ("cone, pre-stretch 1.3, 60 g", 4, cone(5, 60, 100, 1.3), {}),
    ("two electrodes (membrane)", 4, "devices/two-electrodes", {"compute.solid.film": "membrane"}),
]
OF_DISCS = [
    ("as built", 4, "frdea-4", {}),
    ("two fibres", 3, "frdea-4", {"fibres.count": 2}),
    ("three fibres", 3, "frdea-4", {"fibres.count": 3}),
    ("six fibres", 3, "frdea-4", {"fibres.count": 6}),
    ("eight fibres", 3, "frdea-4", {"fibres.count": 8}),
    ("fibre 3 mm wide", 3, "frdea-4", {"fibres.width": "3 mm"}),
    ("fibre 1 mm wide", 3, "frdea-4", {"fibres.width": "1 mm"}),
    ("fibre 200 um thick", 3, "frdea-4", {"fibres.thickness": "200 um"}),
    ("fibre 50 um thick", 3, "frdea-4", {"fibres.thickness": "50 um"}),
    ("pre-stretch 1.2", 3.5, "frdea-4", {"pre_stretch": 1.2}),
    ("pre-stretch 1.3", 3, "frdea-4", {"pre_stretch": 1.3}),
    ("film of 50 um", 1.6, "frdea-4", {"film.thickness": "50 um"}),
    ("film of 200 um", 5, "frdea-4", {"film.thickness": "200 um"}),
    ("glue of 50 um", 3, "frdea-4", {"fibres.bond.thickness": "50 um"}),
    ("overlap 1 mm", 3, "frdea-4", {"fibres.overlap": "1 mm stretched"}),
    ("gap of 0.5 mm", 3, "frdea-4", {"fibres.overlap": "-0.5 mm stretched"}),
    ("hinged at the frame", 3, "frdea-4", {"fibres.outer_end": "hinged"}),
    ("no fibres", 3, "plain-disc", {}),
    ("no fibres, pre-stretch 1.1", 3, "plain-disc", {"pre_stretch": 1.1}),
    ("no fibres, film of 50 um", 1.6, "plain-disc", {"film.thickness": "50 um"}),
]


def rows_of_device(name, kV, design, sets):
    """[(name, kV, quantity, value, limit, how far that may be off, stated)]"""
    meshes = MESHES_PLIES if "\n" in design or design.startswith("devices/") else MESHES
    per, _ = design_rows(name, kV, design, sets, meshes)
    return [(name, V, quantity, value, limit, off, stated) for quantity, states in per.items()
            for V, value, limit, _, off, stated in states if stated > 0]


def is_stretch(row):
    return row[2].endswith("stretch")


def moved(row):
    """What a number is relative to: a displacement, or a stretch less 1."""
    return abs(row[4] - is_stretch(row))


def found(row):
    return max(abs(row[3] - row[4]), 1e-12)


def matters(row):
    return max(found(row), row[6]) > NEGLIGIBLE * moved(row)


def is_known(row):
    return row[5] <= WELL_KNOWN * found(row)


def quantiles(values):
    values = sorted(values)

    def at(share):
        place = share * (len(values) - 1)
        low = math.floor(place)
        high = min(low + 1, len(values) - 1)
        return values[low] + (place - low) * (values[high] - values[low])
    return [at(q) for q in (0, 0.05, 0.25, 0.5, 0.75, 0.95, 1)]


def summary(name, rows):
    inside = sum(found(r) <= r[6] for r in rows) / max(len(rows), 1)
    ratios = [r[6] / found(r) for r in rows if matters(r)]
    within = sum(WANTED[0] <= e <= WANTED[1] for e in ratios)
    spread = " | ".join(f"{q:.2f}" for q in quantiles(ratios)) if ratios else " | ".join("-" * 7)
    print(f"| {name} | {len(rows)} | {100 * inside:.0f} % | {len(ratios)} | {spread} | "
          f"{100 * within / max(len(ratios), 1):.0f} % |")
    return inside


HEAD = """# How many numbers are within their stated error

Made by `scripts/verify error-bars`; not to be edited. {plies} devices of plies and {discs} discs with and without fibres, each at
half the voltage and at the voltage that is written, with the default mesh, whose run states an error beside each number
([theory](../theory/trust.md#the-estimated-error)).

* **Limit** and **+-**, how far that may be off: as in [trust.md](trust.md), of discs from elements of order 2, of order 3, and of half
  the size in all directions; of plies from elements of half and a third of the size in all directions. Where +- is above a third of
  what is found, that is known to be at most the sum of both.
* **Inside**: the limit is no farther from the value of the default mesh than the error that is stated.
* **Effectivity**: stated over found. Numbers whose error is both stated and found to be below {negligible:g} % of the motion
  count as inside or not, and not for the effectivity.
* All rows are in [error-bars.csv](error-bars.csv): values in um (stretches: 1), errors in % of the motion.

| numbers of | count | inside | of those that matter | least effectivity | 5 % | 25 % | median | 75 % | 95 % | largest | between {low:g} and {high:g} |
|---|---|---|---|---|---|---|---|---|---|---|---|"""


def write_rows(rows):
    with open(ROOT / "docs/verification/error-bars.csv", "w", encoding="utf-8", newline="") as table:
        out = csv.writer(table, lineterminator="\n")
        out.writerow(("device", "kV", "quantity", "default mesh", "limit", "found (%)", "+- (%)", "stated (%)", "effectivity",
                      "found known to a third", "matters", "inside"))
        for r in rows:
            digits = ".5f" if is_stretch(r) else ".3f"
            out.writerow((r[0], f"{r[1]:g}", r[2], f"{r[3]:{digits}}", f"{r[4]:{digits}}",
                          *(f"{100 * x / moved(r):.3f}" for x in (found(r), r[5], r[6])), f"{r[6] / found(r):.2f}",
                          *("yes" if word else "no" for word in (is_known(r), matters(r), found(r) <= r[6]))))


def main():
    devices = OF_PLIES + OF_DISCS
    if SMALL:
        devices = [d for d in devices if d[0] in ("cone, pre-stretch 1.1", "no fibres")]
    if ONLY is not None:
        devices = [d for d in devices if d[0] in ONLY]
    plies = {d[0] for d in OF_PLIES}
    print(HEAD.format(plies=sum(d[0] in plies for d in devices), discs=sum(d[0] not in plies for d in devices),
                      negligible=100 * NEGLIGIBLE, low=WANTED[0], high=WANTED[1]))
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        rows = [r for some in pool.map(lambda d: rows_of_device(*d), devices) for r in some]
    rows = [r for r in rows if moved(r) > SMALLEST["1" if is_stretch(r) else "um"]]
    groups = {"plies": [r for r in rows if r[0] in plies]}
    for quantity in SHORT.values():
        groups[quantity + " of discs"] = [r for r in rows if r[0] not in plies and r[2] == quantity]
    groups["all"] = rows
    shares = {}
    for name, some in groups.items():
        if some:
            shares[name] = summary(name, some)
            summary(name + ", found error known to a third", [r for r in some if is_known(r)])
    if not SMALL and ONLY is None:
        write_rows(rows)
    if min(shares.get(name, 1) for name in ("plies", "all")) < 0.95:
        sys.exit("too many numbers are outside of their stated error")


if __name__ == "__main__":
    main()
