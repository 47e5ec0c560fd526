"""Page docs/verification/trust.md: what the estimated errors of model 3d are worth, on designs of many
kinds. The default meshes alone are run, and their estimates set beside the errors found in trust.csv where the value is
still that of the file. Arguments: the command, the source tree; --meshes: errors are found anew, on all meshes (hours);
--small: that, of two designs; --only "NAME;NAME": of these; --keep FOLDER: runs that are there are not made again;
--jobs N: designs at once, of error_bars.py."""

import csv
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import textwrap

DEA, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])
SMALL = "--small" in sys.argv
ONLY = sys.argv[sys.argv.index("--only") + 1].split(";") if "--only" in sys.argv else None
FOLDER = tempfile.TemporaryDirectory(prefix="dea-trust-")
WORK = pathlib.Path(sys.argv[sys.argv.index("--keep") + 1] if "--keep" in sys.argv else FOLDER.name)
JOBS = int(sys.argv[sys.argv.index("--jobs") + 1]) if "--jobs" in sys.argv else 1
ESTIMATES = "--meshes" not in sys.argv and not SMALL and ONLY is None
WITHIN = (0.5, 2)
HEAD = """# Estimated errors of model 3d against finer meshes

Made by `scripts/verify trust`; not to be edited. {source}{count} designs: [frdea-4.yaml](../../examples/frdea-4.yaml) and what is
changed of it, [plain-disc.yaml](../../examples/plain-disc.yaml), devices of `examples/devices/`; each at half the voltage and at
the voltage that is written, taut or with its tension lost in places, with the default mesh, whose run estimates its error
([theory](../theory/trust.md)). How many numbers are within what is stated: [error-bars.md](error-bars.md).

* **Found**: the error of the default mesh (order 2, one element through the film) against a limit, extrapolated from it and two finer
  meshes (`MESHES` in `verify/trust.py`; with a `*`: from meshes of order 2 that were computed once, `FINE`).
  Errors go with (size / order^2)^p (Babuska and Suri 1987); p is the one observed, between 1 (as of stresses of 1/sqrt(r), also where
  none is observed) and 2.
* **+-**: how far the limit may be off, in % of the quantity: its change between p = {least_order:g} (or the observed p, if
  larger) and p = 2; without an observed order three times the last change.
* **Effectivity**: estimated over found, of root mean squares over both voltages. Not counted: both below
  {negligible:g} % of the quantity.
* Nothing of the estimate is fitted to these designs. The sum around corners was chosen with the first set, the larger side
  with the first two.
* All rows are in [trust.csv](trust.csv): values in um (stretches: 1) at the voltage, errors in % of the value. Where a mesh did not reach
  the voltage, the row is of half of it. The tables below have the numbers outside of {within[0]:g} to {within[1]:g} whose limit is known (+- at most a third of what is found)."""
COLUMNS = """
| design | kV | quantity | limit | found (%) | +- (%) | estimated (%) | effectivity |
|---|---|---|---|---|---|---|---|"""
CSV_COLUMNS = ("set,design,voltage (kV),quantity,default mesh,limit,order at half the voltage,order,found (%),+- (%),estimated (%),"
               "effectivity,counted,true error known to a factor of 1.5")
# The default mesh and two finer ones: order of the elements (all three directions) and elements in a length (in
# the plane and through the film). The error at a singular edge goes with length / order^2.
MESHES = ((2, 1, 1), (3, 1, 1), (3, 2, 2))
MESHES_PLIES = ((2, 1, 1), (2, 2, 2), (2, 3, 3))  # gmsh's meshes of plies are of order 2 in the plane
MESHES_EDGES = ((2, 1, 1), (2, 4, 1), (2, 8, 1))  # of a solid film without stiff parts
MESHES_HALVED = ((2, 1, 1), (2, 2, 1), (2, 4, 1))  # where an eighth takes too long
MESHES_COUPLED = ((2, 1, 6), (2, 2, 6), (2, 3, 6))
SOLID_FILMS = ("plain-disc", "devices/two-electrodes", "devices/diaphragm", "devices/cone-mass", "devices/pure-shear")
HALVED_FILMS = ("devices/pure-shear",)
MEMBRANES = ("devices/pure-shear",)  # unless the design is changed
ORDERS = (1, 2)  # that are believed; LEAST_SEEN: below it no order is seen
LEAST_SEEN = 0.1
LEAST_ORDER = 0.5  # by which a limit may be off; WITHOUT_ORDER: times the last change without an order
WITHOUT_ORDER = 3
WELL_KNOWN = 1 / 3  # of what is found, that the limit may be off
# Meshes of elements of order 2 that were computed once for all: quantity at half the voltage and at the voltage, by refinement and
# elements through the film. They stand in place of the finer ones above.
FINE = {
    ("pre-stretch 1.3", "fibre tip"): {
        (1, 1): (-1.24655, -5.41394), (1, 2): (-1.24229, -5.40051), (1, 4): (-1.23651, -5.37693),
        (1, 8): (-1.23990, -5.35942), (1, 16): (-1.24192, -5.34363), (2, 1): (-1.24273, -5.39128),
        (2, 2): (-1.24231, -5.39084), (2, 4): (-1.23163, -5.35408), (2, 8): (-1.22952, -5.33302),
        (2, 16): (-1.23075, -5.31988), (3, 1): (-1.23783, -5.36389), (3, 2): (-1.23920, -5.37061),
        (3, 4): (-1.22892, -5.33733), (3, 8): (-1.22231, -5.31410), (4, 4): (-1.22986, -5.33532),
    },
    ("overlap 1 mm", "fibre tip"): {
        (1, 1): (-1.88986, -8.23739), (1, 2): (-1.88584, -8.21467), (1, 4): (-1.88265, -8.19914),
        (1, 8): (-1.88198, -8.19467), (2, 1): (-1.88659, -8.22557), (2, 2): (-1.88303, -8.20601),
        (2, 4): (-1.87825, -8.18108), (2, 8): (-1.87618, -8.17049), (3, 1): (-1.88289, -8.20701),
        (3, 2): (-1.88337, -8.20754), (3, 4): (-1.88034, -8.19136), (3, 8): (-1.87703, -8.17430),
        (4, 4): (-1.88174, -8.19677),
    },
    ("electrodes of 10 um", "edge"): {
        (1, 1): (-138.78353, -87.40172), (1, 2): (-140.48891, -89.21097), (1, 4): (-139.98950, -88.67543),
        (1, 8): (-139.98855, -88.67666), (2, 1): (-139.66817, -88.02440), (2, 2): (-141.37620, -89.87187),
        (2, 4): (-140.84465, -89.29256), (2, 8): (-140.82657, -89.27506), (3, 1): (-139.99240, -88.25555),
        (3, 2): (-141.73381, -90.13458), (3, 4): (-141.21398, -89.56005),
    },
    ("overlap 0.4 mm", "fibre tip"): {
        (1, 1): (-1.73029, -7.49668), (1, 2): (-1.72723, -7.47813), (1, 4): (-1.72370, -7.46160),
        (2, 1): (-1.72322, -7.46660), (2, 2): (-1.72074, -7.45150), (2, 4): (-1.71503, -7.42282),
        (2, 8): (-1.71245, -7.40844), (3, 2): (-1.71904, -7.44091), (3, 4): (-1.71499, -7.42247),
    },
}
HALVED = (1, 2, 4)  # elements in a length of another way to the limit
SMALLEST = 1e-2  # um; of what moves less nothing is said
NEGLIGIBLE = 2e-3  # of the quantity: an error that is found and estimated to be smaller is not counted
MOVED = []  # designs whose default mesh has other values than the file
TOLERATED = (0.25, 4)  # of the small form
DISC = ("z centre (um)", "z fibre tip (um)", "u electrode edge (um)")
SHORT = {"z centre (um)": "centre", "z fibre tip (um)": "fibre tip", "u electrode edge (um)": "edge"}
# name, largest voltage [kV], design, what is changed of it
DESIGNS = [
    ("as built", 4, "frdea-4", {}),
    ("no fibres", 3, "plain-disc", {}),
    ("two electrodes (membrane)", 4, "devices/two-electrodes", {"compute.solid.film": "membrane"}),
    ("fibre 3 mm wide", 3, "frdea-4", {"fibres.width": "3 mm"}),
    ("two fibres", 4, "frdea-4", {"fibres.count": 2}),
    ("three fibres", 3, "frdea-4", {"fibres.count": 3}),
    ("glue of 50 um", 3, "frdea-4", {"fibres.bond.thickness": "50 um"}),
    ("eight fibres", 3, "frdea-4", {"fibres.count": 8}),
    ("pre-stretch 1.2", 3.5, "frdea-4", {"pre_stretch": 1.2}),
    ("pre-stretch 1.05, tension lost", 5, "frdea-4", {"pre_stretch": 1.05}),
    ("pre-stretch 1.3", 3, "frdea-4", {"pre_stretch": 1.3}),
    ("pre-stretch 2", 3, "frdea-4", {"pre_stretch": 2}),
    ("film of 50 um", 1.6, "frdea-4", {"film.thickness": "50 um"}),
    ("film of 200 um", 5, "frdea-4", {"film.thickness": "200 um"}),
    ("electrodes of 10 um", 3, "frdea-4",
     {"electrodes.thickness": "10 um", "electrodes.material": "sylgard-186"}),
    ("fibre 200 um thick", 3, "frdea-4", {"fibres.thickness": "200 um"}),
    ("fibre 1 mm wide", 3, "frdea-4", {"fibres.width": "1 mm"}),
    ("coupled field, no fibres", 3, "plain-disc", {"compute.solid.field": "coupled"}),
    ("overlap 1 mm", 3, "frdea-4", {"fibres.overlap": "1 mm stretched"}),
    ("gap of 0.5 mm", 3, "frdea-4", {"fibres.overlap": "-0.5 mm stretched"}),
    ("hinged at the frame", 3, "frdea-4", {"fibres.outer_end": "hinged"}),
    ("electrodes of 8 mm", 3, "frdea-4", {"electrodes.diameter": "8 mm unstretched"}),
    ("no fibres, pre-stretch 1.1", 3, "plain-disc", {"pre_stretch": 1.1}),
    ("electrodes, solid film", 4, "devices/two-electrodes", {"compute.solid.film": "solid"}),
    ("pure shear (membrane)", 4, "devices/pure-shear", {}),
    ("diaphragm", 4, "devices/diaphragm", {}),
    ("cone (membrane)", 5, "devices/cone-mass", {"compute.solid.film": "membrane"}),
    ("contractile (membrane)", 3, "devices/contractile", {}),
    ("bender", 1, "devices/bender", {}),
    ("stack (membrane)", 1, "devices/stack-10", {}),
]
# That nobody had looked at when the estimate was made.
HELD_BACK = [
    ("five fibres", 3, "frdea-4", {"fibres.count": 5}),
    ("two fibres, pre-stretch 1.4", 3, "frdea-4", {"fibres.count": 2, "pre_stretch": 1.4}),
    ("eight fibres on 150 um", 4, "frdea-4", {"fibres.count": 8, "film.thickness": "150 um"}),
    ("fibre 50 um thick", 3, "frdea-4", {"fibres.thickness": "50 um"}),
    ("overlap 0.4 mm", 3, "frdea-4", {"fibres.overlap": "0.4 mm stretched"}),
    ("electrodes of 6 mm", 3, "frdea-4", {"electrodes.diameter": "6 mm unstretched"}),
    ("pre-stretch 1.8", 3, "frdea-4", {"pre_stretch": 1.8}),
    ("pre-stretch 1.05, three fibres, tension lost", 5, "frdea-4", {"pre_stretch": 1.05, "fibres.count": 3}),
    ("pre-stretch 1.1, fibre 3 mm wide, tension lost", 6.3, "frdea-4", {"pre_stretch": 1.1, "fibres.width": "3 mm"}),
    ("no fibres, pre-stretch 1.3", 3, "plain-disc", {"pre_stretch": 1.3}),
    ("no fibres, film of 50 um", 1.6, "plain-disc", {"film.thickness": "50 um"}),
    ("electrodes, solid film of 200 um", 6, "devices/two-electrodes",
     {"compute.solid.film": "solid", "plies.film.thickness": "200 um"}),
    ("diaphragm, pre-stretch 1.3", 4, "devices/diaphragm", {"plies.film.pre_stretch": 1.3}),
    ("cone, solid film", 5, "devices/cone-mass", {"compute.solid.film": "solid"}),
    ("pure shear, solid film, tension lost", 3, "devices/pure-shear", {"compute.solid.film": "solid"}),
]
# That nobody had looked at when the larger side was taken in place of the sum of both.
NEWER = [
    ("six fibres", 3, "frdea-4", {"fibres.count": 6}),
    ("overlap 1.5 mm", 3, "frdea-4", {"fibres.overlap": "1.5 mm stretched"}),
    ("fibre 2.5 mm wide on 150 um", 4, "frdea-4", {"fibres.width": "2.5 mm", "film.thickness": "150 um"}),
    ("pre-stretch 1.15, three fibres", 3.5, "frdea-4", {"pre_stretch": 1.15, "fibres.count": 3}),
    ("gap of 0.3 mm on 80 um", 2.4, "frdea-4", {"fibres.overlap": "-0.3 mm stretched", "film.thickness": "80 um"}),
    ("electrodes of 5 um", 3, "frdea-4",
     {"electrodes.thickness": "5 um", "electrodes.material": "sylgard-186"}),
    ("hinged, two fibres of 200 um", 3, "frdea-4",
     {"fibres.outer_end": "hinged", "fibres.count": 2, "fibres.thickness": "200 um"}),
    ("diaphragm of 80 um", 3, "devices/diaphragm", {"plies.film.thickness": "80 um"}),
]
if SMALL:
    HELD_BACK = []
    NEWER = []
    DESIGNS = [d for d in DESIGNS if d[0] in ("three fibres", "hinged at the frame")]

if ONLY is not None:
    DESIGNS = [d for d in DESIGNS if d[0] in ONLY]
    HELD_BACK = [d for d in HELD_BACK if d[0] in ONLY]
    NEWER = [d for d in NEWER if d[0] in ONLY]


def meshes_of(design, sets):
    if sets.get("compute.solid.field") == "coupled":
        return MESHES_COUPLED
    film = sets.get("compute.solid.film", "membrane" if design in MEMBRANES else "solid")
    if design in SOLID_FILMS and film != "membrane":
        return MESHES_HALVED if design in HALVED_FILMS else MESHES_EDGES
    return MESHES_PLIES if design.startswith("devices/") else MESHES


def sweep(name, kV, design, sets, order, elements, through):
    """Runs half the voltage and the voltage of an example, or of a design's text; returns the run's folder."""
    folder = WORK / f"{'-'.join(re.findall('[a-z0-9.]+', name))}-{kV:g}kV-{order}-{elements}-{through}"
    if (folder / "summary.json").exists():
        return folder
    path = ROOT / "examples" / f"{design}.yaml"
    if "\n" in design:
        WORK.mkdir(parents=True, exist_ok=True)
        path = WORK / f"{folder.name}.yaml"
        path.write_text(design, encoding="utf-8")
    keys = sets | {
        "compute.voltage": f"{{from: {kV / 2} kV, to: {kV} kV, step: {kV / 2} kV}}",
        "compute.solid.order": order,
        "compute.solid.order_z": order,
        "compute.solid.elements_z": through,
        "compute.solid.refinement": 1 + math.log2(elements),
    }
    words = [DEA, "run", path, "--model", "3d", "--study", "sweep", "--no-figures"]
    words += ["--force", "--quiet", "-o", folder] + [w for k, v in keys.items() for w in ("--set", f"{k}={v}")]
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(words, env=os.environ | one, capture_output=True, text=True, check=False)
    if not (folder / "summary.json").exists():
        sys.exit(f"{name}, order {order}, {elements}, {through}: {done.stderr}")
    return folder


def rows_of(path):
    with open(path, encoding="utf-8") as table:
        return list(csv.DictReader(table))


def number(row, key):
    return float(row.get(key) or "nan")


def read(folder):
    """Values and estimated errors {quantity: {kV: (value, error)}} of a run, and {kV: flags}."""
    table = rows_of(folder / "3d_sweep.csv")
    flags, out = {number(r, "V (kV)"): r["flags"] for r in table}, {}
    for error in [key for key in table[0] if key.startswith("error of ")]:
        q = error.removeprefix("error of ")
        if math.isnan(number(table[-1], error)) or q in DISC and math.isnan(number(table[-1], q)):
            continue
        monitor, component = q.split(" (")[0].rsplit(" ", 1)
        name = SHORT[q] if q in DISC else monitor if component in "xyz" else monitor.removesuffix(" area") + ", stretch"
        out[name] = {
            number(r, "V (kV)"): (number(r, q), number(r, error)) for r in table}
    return out, flags


def sizes(meshes):
    return [1 / (order**2 * elements) for order, elements, _ in meshes]


def extrapolate(f, size):
    """The limit of three values, the order that they show (NAN where they are not monotone), and how far the limit may
    be off."""
    first, second = f[1] - f[0], f[2] - f[1]
    seen = math.nan

    def rest(p):
        return second * size[2] ** p / (size[1] ** p - size[2] ** p)
    if first * second > 0:
        def ratio(p):
            return (size[0] ** p - size[1] ** p) / (size[1] ** p - size[2] ** p)
        low, high = LEAST_SEEN / 10, 8.0
        for _ in range(60):
            seen = (low + high) / 2
            low, high = (seen, high) if ratio(seen) < first / second else (low, seen)
    p = min(max(seen, ORDERS[0]), ORDERS[1]) if not math.isnan(seen) else ORDERS[0]
    if math.isnan(seen) or seen < LEAST_SEEN:
        off = WITHOUT_ORDER * abs(second)
    else:
        off = max(abs(rest(p) - rest(q)) for q in (min(max(seen, LEAST_ORDER), p), ORDERS[1]))
    return f[2] + rest(p), seen, off


def last_three(values, direction):
    """Of the lines of meshes that are halved in one direction (0: the plane, 1: through the film) and in nothing else,
    the three last ones of the longest line, of these the one that is finest in the other direction."""
    lines = []
    for other in {mesh[1 - direction] for mesh in values}:
        line = sorted(mesh for mesh in values if mesh[1 - direction] == other)
        lines.append((line[-1][direction], other, line[-3:]))
    return max(line for line in lines if len(line[2]) == 3)[2]


def size_of(mesh, direction):
    """Of the smallest elements: those in the plane are halved by refinement, those at the film's faces are half as thick
    as the next ones, up to an eighth (theory/mesh.md)."""
    if direction == 0:
        return 2 ** -mesh[0]
    return 1 / sum(2 ** min(k, mesh[1] - 1 - k, 3) for k in range(mesh[1]))


def fine_limit(values):
    """The limit of meshes of FINE, the order in the plane, and how far it may be off: the finest one, and what halving
    it in the plane and through the film would still bring, as it is seen where the other size stays."""
    def fineness(mesh):
        halvings = (mesh[0], math.log2(mesh[1]))
        return sum(halvings), -abs(halvings[0] - halvings[1]), mesh[0]
    finest = max(values, key=fineness)
    limit, off, orders = values[finest], 0, []
    for direction in (0, 1):
        line = last_three(values, direction)
        end, order, doubt = extrapolate([values[mesh] for mesh in line], [size_of(mesh, direction) for mesh in line])
        if order > ORDERS[1]:  # by chance
            doubt = WITHOUT_ORDER * abs(values[line[2]] - values[line[1]])
        limit += end - values[next(mesh for mesh in line if mesh[direction] == finest[direction])]
        off += doubt
        orders.append(order)
    return limit, orders[0], off


def design_rows(name, kV, design, sets, meshes=None):
    """Per quantity: [(kV, value, limit, order, how far that may be off, estimated)] and the flags at each voltage."""
    meshes = meshes or meshes_of(design, sets)
    runs = [read(sweep(name, kV, design, sets, *mesh)) for mesh in meshes]
    out = {}
    for quantity, at in runs[0][0].items():
        for V, (value, error) in at.items():
            values = [run[0].get(quantity, {}).get(V, (math.nan,))[0] for run in runs]
            if not any(math.isnan(v) for v in values):
                limit = extrapolate(values, sizes(meshes))
                if (name, quantity) in FINE:
                    at = 0 if V < kV else 1
                    limit = fine_limit({mesh: both[at] for mesh, both in FINE[name, quantity].items()})
                out.setdefault(quantity, []).append((V, value, *limit, error))
    return out, runs[0][1]


def effectivity(states):
    """Root mean squares over the voltages, over the quantity: of errors that are found, of how far they may be off, and
    of those estimated."""
    known = [s for s in states if s[5] > 0 and abs(s[1]) > SMALLEST]
    if not known:
        return None

    def mean(of):
        return math.sqrt(sum((of(s) / s[2]) ** 2 for s in known) / len(known))
    return mean(lambda s: s[2] - s[1]), mean(lambda s: s[4]), mean(lambda s: s[5])


def row_of(name, quantity, states, tally):
    """The row of the page, NONE where nothing is to be said, that of the file, and whether the number is outside."""
    relative = effectivity(states)
    if relative is None:
        return None
    found, off, estimated = relative
    counted, known = max(found, estimated) > NEGLIGIBLE, off <= WELL_KNOWN * found
    ratio = estimated / found
    if counted:
        tally.setdefault(quantity if quantity in SHORT.values() else "of plies", []).append((ratio, known))
    digits = ".5f" if "stretch" in quantity else ".3f"
    orders = ["-" if math.isnan(s[3]) else "none" if s[3] < LEAST_SEEN else f"{s[3]:.1f}" for s in states]
    star = " *" if (name, quantity) in FINE else ""
    errors = [f"{100 * x:.3f}" for x in relative]
    page = f"| {name} | {states[-1][0]:g} | {quantity}{star} | {states[-1][2]:{digits}} | {' | '.join(errors)} | {ratio:.2f} |"
    line = [name, f"{states[-1][0]:g}", quantity + star, f"{states[-1][1]:{digits}}", f"{states[-1][2]:{digits}}"]
    line += ([""] + orders)[-2:] + errors + [f"{ratio:.2f}", "yes" if counted else "no", "yes" if known else "no"]
    return page, line, counted and known and not WITHIN[0] <= ratio <= WITHIN[1]


def print_count(name, ratios):
    within = sum(WITHIN[0] <= r <= WITHIN[1] for r in ratios)
    print(f"* {name}: {len(ratios)} counted, effectivity from {min(ratios):.2f} to {max(ratios):.2f}, median "
          f"{statistics.median(ratios):.2f}; {within} between {WITHIN[0]:g} and {WITHIN[1]:g}, "
          f"{sum(r > WITHIN[1] for r in ratios)} above, {sum(r < WITHIN[0] for r in ratios)} below.")


def estimated_anew(name, kV, design, sets, old, tally):
    """Rows of a design, as of row_of, from those of the file and the estimates of the default mesh now, each over the
    value; None where the default mesh has other values than in the file."""
    run, _ = read(sweep(name, kV, design, sets, *meshes_of(design, sets)[0]))
    rows = []
    for line in old:
        quantity, digit = line[3].removesuffix(" *"), 10.0 ** -len(line[4].split(".")[1])
        states = [run.get(quantity, {}).get(V, (math.nan, math.nan)) for V in (float(line[2]) / 2, float(line[2]))]
        found, off = float(line[8]) / 100, float(line[9]) / 100
        if not abs(states[1][0] - float(line[4])) <= digit + 0.1 * found * abs(states[1][0]) or math.isnan(states[0][0]):
            return None
        estimated = math.sqrt(sum((error / value) ** 2 for value, error in states) / 2)
        ratio, counted, known = estimated / max(found, 1e-5), max(found, estimated) > NEGLIGIBLE, off <= WELL_KNOWN * found
        new = line[1:10] + [f"{100 * estimated:.3f}", f"{ratio:.2f}", "yes" if counted else "no", "yes" if known else "no"]
        page = f"| {' | '.join([*new[:3], new[4], *new[7:11]])} |"
        rows.append((page, new, counted and known and not WITHIN[0] <= ratio <= WITHIN[1], quantity, ratio, known))
    for *_, quantity, ratio, known in (r for r in rows if r[1][-2] == "yes"):
        tally.setdefault(quantity if quantity in SHORT.values() else "of plies", []).append((ratio, known))
    return [r[:3] for r in rows]


def rows_of_design(number, design, tally):
    """Rows of a design, as of row_of."""
    if ESTIMATES:
        with open(ROOT / "docs/verification/trust.csv", encoding="utf-8") as table:
            old = [line for line in csv.reader(table) if line[:2] == [str(number), design[0]]]
        anew = estimated_anew(*design, old, tally)
        if anew is None:
            MOVED.append(design[0])
            return [(None, line[1:10] + ["", "", "no", line[-1]], False) for line in old]
        return anew
    per, _ = design_rows(*design)
    rows = [row_of(design[0], quantity, states, tally) for quantity, states in per.items()]
    return [row for row in rows if row is not None]


def print_set(number, designs, lines):
    """How many numbers are within, and those that are not; adds the lines of the file, returns all effectivities."""
    tally, outside = {}, []
    for design in designs:
        for row in rows_of_design(number, design, tally):
            lines.append([number, *row[1]])
            outside += [row[0]] if row[2] else []
    print()
    every = [pair for ratios in tally.values() for pair in ratios]
    if every:
        print_count("all", [r for r, _ in every])
    if any(known for _, known in every):
        print_count("those whose true error is known to a factor of 1.5", [r for r, known in every if known])
    if outside:
        print(COLUMNS + "\n" + "\n".join(outside))
    return every


def main():
    version = subprocess.run([DEA, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    source = f"Estimates of version {version};\nerrors found with version 0.4.0. " if ESTIMATES else ""
    print(HEAD.format(source=source, count=len(DESIGNS) + len(HELD_BACK) + len(NEWER), negligible=100 * NEGLIGIBLE, least_order=LEAST_ORDER,
                      within=WITHIN))
    lines = []
    print("\n## First set")
    every = print_set(1, DESIGNS, lines)
    if HELD_BACK:
        print("\n## Second set\n\nComputed after the sum around corners had been chosen.")
        every += print_set(2, HELD_BACK, lines)
    if NEWER:
        print("\n## Third set\n\nComputed after the larger side had been chosen.")
        every += print_set(3, NEWER, lines)
    if ESTIMATES:
        print("\n## All sets\n")
        print_count("those whose true error is known to a factor of 1.5", [r for r, known in every if known])
    if MOVED:
        print("\n" + textwrap.fill("Not in these counts, since their default mesh has other values than when errors were found: " + "; ".join(MOVED) + ".", 130))
    if not SMALL and ONLY is None:
        with open(ROOT / "docs/verification/trust.csv", "w", encoding="utf-8", newline="") as table:
            table.write(CSV_COLUMNS + "\n")
            csv.writer(table, lineterminator="\n").writerows(lines)
        if not ESTIMATES:
            check_reference()
    if SMALL and not (every and all(TOLERATED[0] <= r <= TOLERATED[1] for r, _ in every)):
        sys.exit("effectivities are out of tolerance")


def check_reference():
    """The limit of as built by elements of order 2 that are halved twice in all directions."""
    name, kV, design, sets = DESIGNS[0]
    first = design_rows(name, kV, design, sets)[0]
    runs = [read(sweep(name, kV, design, sets, 2, elements, elements))[0] for elements in HALVED]
    print("\n## The limit\n\nThat of " + name + " and one from elements of order 2, halved twice in the plane and through the "
          "film.\n")
    print("| quantity | V (kV) | default mesh | limit | order | halved twice | its limit | order | found errors' ratio |")
    print("|---|---|---|---|---|---|---|---|---|")
    for quantity, states in first.items():
        for V, value, limit, seen, _, _ in states:
            values = [run[quantity][V][0] for run in runs]
            other, order, _ = extrapolate(values, [1 / n for n in HALVED])
            print(f"| {quantity} | {V:g} | {value:.4f} | {limit:.4f} | {seen:.2f} | {values[-1]:.4f} | {other:.4f} | "
                  f"{order:.2f} | {(limit - value) / (other - value):.2f} |")


if __name__ == "__main__":
    main()
