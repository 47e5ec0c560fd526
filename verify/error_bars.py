"""Page docs/verification/error-bars.md: how many numbers of model 3d are within the error that is stated beside them,
on 40 devices, 20 of them of plies. Arguments: the command, the source tree; --small: two of them; --only "NAME;NAME":
these; --keep FOLDER: runs that are there are not made again; --jobs N: at once."""

import concurrent.futures
import csv
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

DEA, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])


def argument(name, other):
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else other


SMALL = "--small" in sys.argv
ONLY = argument("--only", None)
JOBS = int(argument("--jobs", 1))
FOLDER = tempfile.TemporaryDirectory(prefix="dea-error-bars-")
WORK = pathlib.Path(argument("--keep", FOLDER.name))
NEGLIGIBLE = 1e-3  # of the quantity: with less found and estimated, a number is not counted for effectivities
SMALLEST = {"um": 1e-2, "1": 1e-6}  # what changes by less on finer meshes is not seen
ORDERS = (0.5, 2)  # in the size of elements, of the last three meshes, that are believed
WANTED = (0.7, 3)
# Order of the elements, refinement, elements through the film: the default mesh, and two that are finer in all directions.
PLIES = ((2, 1, 1), (2, 2, 2), (2, 2.5, 3))
DISCS = ((2, 1, 1), (3, 1, 1), (3, 2, 2))
# An edge length of those over that of the first, by length / order^2 where the stress is singular.
SIZES = {PLIES: (1, 1 / 2, 1 / math.sqrt(8)), DISCS: (1, 4 / 9, 2 / 9)}

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
DISC = {"z centre (um)": "centre", "z fibre tip (um)": "fibre tip", "u electrode edge (um)": "edge"}


def sweep(name, kV, source, sets, order, refinement, through):
    """Runs half the voltage and the voltage; returns the run's folder."""
    folder = WORK / f"{'-'.join(re.findall('[a-z0-9.]+', name))}-{order}-{refinement}-{through}"
    if (folder / "summary.json").exists():
        return folder
    path = ROOT / "examples" / f"{source}.yaml"
    if "\n" in source:
        path = WORK / ('-'.join(re.findall('[a-z0-9.]+', name)) + ".yaml")
        path.write_text(source, encoding="utf-8")
    keys = sets | {
        "compute.voltage": f"{{from: {kV / 2} kV, to: {kV} kV, step: {kV / 2} kV}}",
        "compute.solid.order": order,
        "compute.solid.order_z": order,
        "compute.solid.elements_z": through,
        "compute.solid.refinement": refinement,
    }
    words = [DEA, "run", path, "--model", "3d", "--study", "sweep", "--no-figures", "--force", "--quiet", "-o", folder]
    words += [w for k, v in keys.items() for w in ("--set", f"{k}={v}")]
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(words, env=os.environ | one, capture_output=True, text=True, check=False)
    if not (folder / "summary.json").exists():
        sys.exit(f"{name}, order {order}, {refinement}, {through}: {done.stderr}")
    return folder


def rows_of(path):
    with open(path, encoding="utf-8") as table:
        return list(csv.DictReader(table))


def number(row, key):
    return float(row.get(key) or "nan")


def read(folder):
    """{(quantity, unit, kV): (value, stated error)} of a run."""
    out = {}
    for r in rows_of(folder / "3d_sweep.csv"):
        for error in [key for key in r if key.startswith("error of ")]:
            q = error.removeprefix("error of ")
            monitor, component = q.split(" (")[0].rsplit(" ", 1)
            name = DISC.get(q) or (monitor if component in "xyz" else monitor.removesuffix(" area") + ", stretch")
            if q in DISC or not math.isnan(number(r, error)):
                out[name, "um" if "(um)" in q else "1", number(r, "V (kV)")] = (number(r, q), number(r, error))
    return out


def limit_of(f, sizes):
    """The value that three meshes go to, and the order in which they do; the last one where they do not."""
    first, second = f[1] - f[0], f[2] - f[1]
    if first * second <= 0 or abs(second) >= abs(first):
        return f[2], math.nan

    def ratio(p):
        return (sizes[0]**p - sizes[1]**p) / (sizes[1]**p - sizes[2]**p)
    low, high = ORDERS
    for _ in range(60):
        order = (low + high) / 2
        low, high = (order, high) if ratio(order) < first / second else (low, order)
    rest = second * sizes[2]**order / (sizes[1]**order - sizes[2]**order)
    return f[2] + rest, order


def rows_of_device(device, meshes):
    """[(name, kV, quantity, unit, value, limit, order, stated)]"""
    runs = [read(sweep(*device, *mesh)) for mesh in meshes]
    out = []
    for (quantity, unit, kV), (value, stated) in runs[0].items():
        values = [run.get((quantity, unit, kV), (math.nan,))[0] for run in runs]
        if math.isnan(stated) or any(math.isnan(v) for v in values):
            continue
        limit, order = limit_of(values, SIZES[meshes])
        out.append((device[0], kV, quantity, unit, value, limit, order, stated))
    return out


def moved(row):
    """What a number is relative to: a displacement, or a stretch less 1."""
    return abs(row[5] - (1 if row[3] == "1" else 0))


def quantiles(values):
    values = sorted(values)

    def at(share):
        place = share * (len(values) - 1)
        low = math.floor(place)
        high = min(low + 1, len(values) - 1)
        return values[low] + (place - low) * (values[high] - values[low])
    return [at(q) for q in (0, 0.05, 0.25, 0.5, 0.75, 0.95, 1)]


def summary(name, rows):
    seen = [r for r in rows if moved(r) > SMALLEST[r[3]]]
    inside = sum(abs(r[4] - r[5]) <= r[7] for r in seen)
    large = [r for r in seen if max(abs(r[4] - r[5]), r[7]) > NEGLIGIBLE * moved(r)]
    ratios = [r[7] / max(abs(r[4] - r[5]), 1e-12) for r in large]
    within = sum(WANTED[0] <= e <= WANTED[1] for e in ratios)
    spread = " | ".join(f"{q:.2f}" for q in quantiles(ratios)) if ratios else " | ".join("-" * 7)
    print(f"| {name} | {len(seen)} | {100 * inside / max(len(seen), 1):.0f} % | {len(large)} | {spread} | "
          f"{100 * within / max(len(large), 1):.0f} % |")
    return inside / max(len(seen), 1)


HEAD = """# How many numbers are within their stated error

Made by `scripts/verify error-bars`; not to be edited. {plies} devices of plies and {discs} discs with and without fibres, each at half the voltage and at the voltage that is written, with the default mesh, whose run states an error beside each
number ([theory](../theory/trust.md#the-estimated-error)).

* **Limit**: what the default mesh and two that are finer in all directions go to (of plies refinement 2 and 2.5 with two and three
  elements through each ply; of discs elements of order 3, then half as long and two through the film), by Richardson's
  extrapolation with the order p of the three, taken between {low:g} and {high:g}; where they do not go one way, or not by
  less and less, the value of the finest (order `-`).
* **Inside**: the limit is no farther from the value of the default mesh than the error that is stated.
* **Effectivity**: stated over found. Numbers whose error is both stated and found to be below {negligible:g} % of the motion
  count as inside or not, and not for the effectivity (in brackets).
* Values in um (stretches: 1), errors in % of the motion."""


def main():
    WORK.mkdir(parents=True, exist_ok=True)
    devices = [(d, PLIES) for d in OF_PLIES] + [(d, DISCS) for d in OF_DISCS]
    if SMALL:
        devices = [d for d in devices if d[0][0] in ("cone, pre-stretch 1.1", "no fibres")]
    if ONLY is not None:
        devices = [d for d in devices if d[0][0] in ONLY.split(";")]
    print(HEAD.format(plies=sum(d[1] is PLIES for d in devices), discs=sum(d[1] is DISCS for d in devices), low=ORDERS[0], high=ORDERS[1], negligible=100 * NEGLIGIBLE))
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool:
        rows = [r for some in pool.map(lambda d: rows_of_device(*d), devices) for r in some]
    print("\n| numbers of | count | inside | of those that matter | least effectivity | 5 % | 25 % | median | 75 % | 95 % | "
          "largest | between 0.7 and 3 |\n|---|---|---|---|---|---|---|---|---|---|---|---|")
    plies = {d[0][0] for d in devices if d[1] is PLIES}
    shares = [summary("plies", [r for r in rows if r[0] in plies])]
    for quantity in DISC.values():
        summary(quantity + " of discs", [r for r in rows if r[0] not in plies and r[2] == quantity])
    shares.append(summary("all", rows))
    print("\n| device | kV | quantity | default mesh | limit | order | found (%) | stated (%) | effectivity | inside |\n"
          "|---|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        found, stated, motion = abs(r[4] - r[5]), r[7], moved(r)
        if motion <= SMALLEST[r[3]]:
            continue
        digits = ".5f" if r[3] == "1" else ".3f"
        ratio = f"{stated / max(found, 1e-12):.2f}"
        ratio = ratio if max(found, stated) > NEGLIGIBLE * motion else f"({ratio})"
        print(f"| {r[0]} | {r[1]:g} | {r[2]} | {r[4]:{digits}} | {r[5]:{digits}} | "
              f"{'-' if math.isnan(r[6]) else format(r[6], '.1f')} | {100 * found / motion:.3f} | "
              f"{100 * stated / motion:.3f} | {ratio} | {'yes' if found <= stated else 'no'} |")
    if min(shares) < 0.9:
        sys.exit("too many numbers are outside of their stated error")


if __name__ == "__main__":
    main()
