"""The paper's measurements read backwards: what pre-stretch, thickness, overlap, glue and hold would
give them. Prints docs/validation/paper-inverse.md. Called by verify/paper-inverse.sh with the command
and the folder of the source."""
import csv
import json
import math
import os
import signal
import subprocess
import sys
import tempfile

command, root = sys.argv[1:3]
limit_s = 300 # of processor time of one run
work = tempfile.mkdtemp(prefix="dea-inverse-")
design = os.path.join(root, "examples", "frdea-4.yaml")
paper = ["film.material=paper-table-1", "film.law=null", "film.permittivity=null"]


def processor_s(pid):
    """Processor time of a process so far, so that what is found does not depend on what else runs."""
    with open("/proc/%d/stat" % pid) as file:
        words = file.read().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def run(model, sets, study="sweep"):
    """Rows of the curve of a study of the design with values in place of its own."""
    folder = os.path.join(work, "run")
    words = [command, "run", design, "--model", model, "--study", study, "-o", folder, "--force",
             "--no-figures"]
    for text in paper + sets:
        words += ["--set", text]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as dea:
        said, limit = None, limit_s
        while said is None:
            try:
                said = dea.communicate(timeout=5)[1]
            except subprocess.TimeoutExpired: # a slack film whose next state is not found: keeps the rest
                if processor_s(dea.pid) > limit:
                    dea.send_signal(signal.SIGINT)
                    limit = math.inf
    name = os.path.join(folder, "%s_%s.csv" % (model, study))
    if not os.path.exists(name):
        sys.exit(said)
    with open(name) as file:
        return [{k: float(v) if v else math.nan for k, v in row.items() if k != "flags"}
                for row in csv.DictReader(file)]


def voltages(*kv):
    return "compute.voltage={values: [%s]}" % ", ".join("%g kV" % v for v in kv)


# What is on the film at 8 kV ---------------------------------------------------------------------

thicknesses = [80, 90, 100, 110, 120, 150, 200]
stretches = [1.0, 1.1, 1.2, 1.3, 1.4, 1.5]
fields = {}
for h in thicknesses:
    for s in stretches:
        row = run("axisymmetric", ["film.thickness=%g um" % h, "pre_stretch=%g" % s,
                                   voltages(0, 2, 4, 6, 8)])
        last = row[-1]
        fields[h, s] = ((last["true field (V/um)"], last["smallest tension (N/m)"] < 0,
                         s * last["electrode stretch"])
                        if last["V (kV)"] == 8 else None)
nominal = fields[100, 1.5]


def exponent(at_rest):
    return math.log(nominal[0] / at_rest) / math.log(nominal[2])


# One key at a time through the membrane film -----------------------------------------------------

def membrane(sets, kv=(0, 2, 4, 5, 6, 7, 8)):
    rows = run("3d", ["compute.solid.film=membrane", voltages(*kv)] + sets)
    last = rows[-1]
    return last if last["V (kV)"] == kv[-1] else None


glue = ["fibres.bond.thickness=100 um", "fibres.bond.modulus=0.1 MPa"]
keys = [
    ("nominal", []),
    ("pre_stretch 1.4", ["pre_stretch=1.4", "electrodes.diameter=7.5 mm stretched"]),
    ("pre_stretch 1.3", ["pre_stretch=1.3", "electrodes.diameter=7.5 mm stretched"]),
    ("pre_stretch 1.2", ["pre_stretch=1.2", "electrodes.diameter=7.5 mm stretched"]),
    ("film.thickness 90 um", ["film.thickness=90 um"]),
    ("film.thickness 110 um", ["film.thickness=110 um"]),
    ("film.thickness 120 um", ["film.thickness=120 um"]),
    ("fibres.overlap 1 mm", ["fibres.overlap=1 mm stretched"]),
    ("fibres.overlap 2 mm", ["fibres.overlap=2 mm stretched"]),
    ("fibres.overlap -1 mm (a gap)", ["fibres.overlap=-1 mm stretched"]),
    ("glue 50 um of 1 MPa", ["fibres.bond.thickness=50 um"]),
    ("glue 100 um of 1 MPa", ["fibres.bond.thickness=100 um"]),
    ("glue 100 um of 0.1 MPa", glue),
    ("fibres 50 um thick", ["fibres.thickness=50 um"]),
    ("fibres 200 um thick", ["fibres.thickness=200 um"]),
    ("hinged at the frame", ["fibres.outer_end=hinged"]),
    ("free, 1 mm from the frame", ["fibres.outer_end=free"]),
    ("overlap 1 mm, glue 100 um of 1 MPa, fibres 50 um",
     ["fibres.overlap=1 mm stretched", "fibres.bond.thickness=100 um", "fibres.thickness=50 um"]),
    ("overlap 1 mm, glue 100 um of 1 MPa, fibres 50 um, film 90 um",
     ["fibres.overlap=1 mm stretched", "fibres.bond.thickness=100 um", "fibres.thickness=50 um",
      "film.thickness=90 um"]),
]
scan = [(name, membrane(sets)) for name, sets in keys]
together = run("3d", ["compute.solid.film=membrane", voltages(2, 4, 5)] + keys[-2][1])

# The paper's glue through the solid film ---------------------------------------------------------

def with_glue(um, mpa, overlap, fibre):
    """Rows up to 8 kV; None: it ends before."""
    rows = run("3d", [voltages(0, 2, 4, 5, 6, 7, 8), "fibres.bond.thickness=%g um" % um, "fibres.bond.modulus=%g MPa" % mpa,
                      "fibres.overlap=%g mm stretched" % overlap, "fibres.thickness=%g um" % fibre])
    return {row["V (kV)"]: row for row in rows} if rows[-1]["V (kV)"] == 8 else None


builds = [(0, 100), (0, 50), (1, 100), (1, 50)] # overlap (mm), fibre (um)
glues = [(0, 1)] + [(um, mpa) for um in (25, 50, 100) for mpa in (0.1, 0.3, 1)]
bonded = {(g, b): with_glue(*g, *b) for g in glues for b in builds}

# Force -------------------------------------------------------------------------------------------

depths = [0, 0.5, 1, 2]


def held(side):
    rows = run("3d", ["compute.solid.film=membrane", voltages(0, 3, 6),
                      "compute.force={indenter: flat, radius: 1.5 mm, side: %s, depth: [%s]}"
                      % (side, ", ".join("%g mm" % d for d in depths))], "force")
    return [rows[3 * k:3 * k + 3] for k in range(len(depths))]


forces = {side: held(side) for side in ("fibres", "back")}
lumped = run("lumped", [voltages(0, 3, 6)])


def fit(name, text, table):
    with open(os.path.join(work, name + ".csv"), "w") as file:
        file.write(table)
    with open(os.path.join(work, name + ".yaml"), "w") as file:
        file.write(text)
    done = subprocess.run([command, "fit", os.path.join(work, name + ".yaml"), "--json", "--force",
                           "-o", os.path.join(work, name)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


# What to measure next ----------------------------------------------------------------------------

glued = "fibres.bond.thickness=30 um"
taut = run("3d", ["compute.solid.film=membrane", voltages(2, 3, 4, 5)])
with open(os.path.join(work, "membrane.yaml"), "w") as file:
    text = "\n".join(line for line in open(design).read().split("\n")
                     if "  law:" not in line and "  permittivity:" not in line)
    text = text.replace("elastosil-2030", "paper-table-1").replace("compute:", "compute:\n  solid: {film: membrane}")
    file.write(text.replace("fibres:\n", "fibres:\n  bond: {thickness: 30 um}\n"))
next_fit = fit("next", """dea_fit: 1
name: next
source: heights of the fibre tip of a design, not measured
design: membrane.yaml
model: 3d
parameters:
  - {name: film.thickness, prior: 100 um, prior_std: 5 um}
  - {name: pre_stretch, prior: 1.5, prior_std: 0.1}
  - {name: fibres.bond.thickness, low: 1 um, high: 200 um, prior: 30 um, prior_std: 30 um}
curves:
  - {name: tip, file: next.csv, uncertainty_absolute: 2 um}
""", "V (kV),z fibre tip (um)\n" + "".join(
    "%g,%.6f\n" % (r["V (kV)"], r["z fibre tip (um)"])
    for r in run("3d", ["compute.solid.film=membrane", voltages(2, 3, 4, 5), glued])))

# The page ----------------------------------------------------------------------------------------

tips = [(n, r["z fibre tip (um)"]) for n, r in scan if r is not None]
most = max(tips, key=lambda t: abs(t[1]))
far = [(n, max(abs(r["highest z (um)"]), abs(r["lowest z (um)"]))) for n, r in scan if r]
print(f"""# The paper's measurements read backwards

Made by `scripts/verify paper-inverse`; not to be edited. Which values of what the paper does not give would
give what was measured; nothing here is a prediction.

## What there is to go by

The numbers of the paper's text (its curves exist as pictures only):

| place | number |
|---|---|
| 4.2.1, 6 (Figs 8, 10) | largest displacement 500 um: four fibres, film of 100 um, 8 kV |
| 5.1 (Fig 10) | measured over simulated: 50 to 65 %; simulated: about 1.5 mm (four), 1.25 mm (eight), up to 7 kV (4.1) |
| 4.2.1 (Fig 11) | eight fibres, 7 kV: the same size with fibres on top and at the bottom, "on the side of the fibers", and down with the fibres on top; no number |
| 4.2.2, 5.1 (Fig 12) | 0.18 N at 6 kV, linear in the voltage from 1 to 6 kV, four and eight fibres 0.13 % apart |
| 3.2, 4.2.1 | no breakdown is reported at 8 kV on 100 um and 16 kV on 200 um, 15 cycles at each voltage |

No uncertainty and no number of samples go with any of them. Two do not go together: 50 to 65 % of 1.5 mm is 0.75 to 0.98 mm, where
0.5 mm is the largest that was measured.

## The film that survived 8 kV

True field at 8 kV (V/um) by model `axisymmetric` (film and electrode without fibres, which hold it back a
little: {nominal[0]:.0f} V/um here, {dict(scan)["nominal"]["true field (V/um)"]:.0f} with four fibres through the membrane film), for thickness before and pre-stretch.
A star: the model's film has lost its tension, a real one wrinkles and the number is no longer its own.
A dash: no equilibrium at 8 kV.

| thickness | {" | ".join("%g" % s for s in stretches)} |
|---|{"---|" * len(stretches)}""")
for h in thicknesses:
    cells = []
    for s in stretches:
        f = fields[h, s]
        cells.append("-" if f is None else "%.0f%s" % (f[0], "*" if f[1] else ""))
    print("| %g um | %s |" % (h, " | ".join(cells)))
held_taut = [(h, s) for (h, s), f in fields.items() if f and not f[1] and f[0] <= 100]
print(f"""
The field of the data sheet, 80 to 100 V/um, is that of unstretched film
([catalogue](../../data/materials/elastosil-2030.yaml)). A taut film is at or below 100 V/um here with:
{", ".join("%g um at %g" % c for c in held_taut)}. A film of 100 um has {fields[100, 1.1][0]:.0f} V/um with a pre-stretch of 1.1 and
{fields[100, 1.0][0]:.0f} V/um without any, and one of 120 um still {fields[120, 1.5][0]:.0f} V/um at 1.5. So thickness and pre-stretch can bring the
field to that of the data sheet only far from what the paper says of them. What is left otherwise:

* **the film holds more when stretched**: if thickness and pre-stretch were nominal, its breakdown field at
  the total stretch {nominal[2]:.2f} is at least {nominal[0]:.0f} V/um. As a power of the stretch, from 80 V/um at rest, that is an
  exponent of at least {exponent(80):.2f}; from 100 V/um at least {exponent(100):.2f}. That is a lower bound from one survivor, not a value;
* **the film was not at 8 kV all over**, or lost less thickness than the model says: stiffer electrodes, less than nominal
  pre-stretch, fibres and glue that hold the electrode; each lowers the strain too.

## 500 um at 8 kV

Four fibres, film and law of Table 1; one thing changed at a time from `examples/frdea-4.yaml`, then the
favourable ones together. Through the membrane film, a preview, which has no wrinkles: the column "anywhere" is that of the fibres' bending
only. Pre-stretch: the electrode stays 3.75 mm in radius.

| changed | fibre tip (um) | anywhere (um) | 500 um over tip | true field (V/um) |
|---|---|---|---|---|""")
for name, row in scan:
    if row is None:
        print("| %s | no state found at 8 kV in the time given | | | |" % name)
    else:
        tip = row["z fibre tip (um)"]
        print("| %s | %.0f | %.0f | %.1f | %.0f |"
              % (name, tip, max(row["highest z (um)"], -row["lowest z (um)"]), 500 / abs(tip),
                 row["true field (V/um)"]))
reach = [t for t in tips if abs(t[1]) >= 500]


def span(kv, at, keys):
    values = [row[kv][at] for k, row in bonded.items() if row and k in keys]
    return "%.0f to %.0f" % (max(values), min(values))


def bonded_cell(g, b):
    row = bonded[g, b]
    return "none" if row is None else "%.0f / %.0f / %.0f" % (row[6]["z fibre tip (um)"], row[8]["z fibre tip (um)"],
                                                             row[8]["z centre (um)"])


TIP = "z fibre tip (um)"
as_built = [(g, (0, 100)) for g in glues[1:]]
far_glued = [(g, b) for (g, b), row in bonded.items() if row and row[8][TIP] <= -500]
print(f"""
{"No single change comes to 500 um at the fibre tip. These together do: " + "; ".join(n for n, _ in reach) + "." if reach else
 "None of them reaches 500 um at the fibre tip; the farthest is '%s' with %.0f um." % (most[0], most[1])}
All tips go away from the fibres' side (negative). In the solid film of
[paper.md](paper.md) what is slack buckles in front of the tips, and with less than 1.1 of pre-stretch left the centre bulges by more than 1 mm at 8 kV. So there are three readings of the 500 um:

1. wrinkles of a slack film above 6 kV, at any pre-stretch: 0.2 to 0.65 mm in paper.md, not at the fibre tip;
2. little pre-stretch left (1.05 to 1.1): a bulge of that height in the centre, from about 6 kV on;
3. compliant glue, overlap and thin fibres together, in many combinations: the fibre tip itself,
   downwards, growing smoothly from the first kilovolt.

They differ below 6 kV.

## The glue that the paper names

Fibres are bonded with ARclear 8932EE (3.1), whose thickness and modulus no source at hand gives: 25 to 100 um and 0.1 to 1 MPa are
**assumed**. Solid film, model `3d`; fibre tip at 6 kV / fibre tip at 8 kV / centre at 8 kV (um), negative: away from the fibres.

| glue | {" | ".join("overlap %g mm, fibres %g um" % b for b in builds)} |
|---|{"---|" * len(builds)}""")
for g in glues:
    print("| %s | %s |" % ("none" if g[0] == 0 else "%g um of %g MPa" % g, " | ".join(bonded_cell(g, b) for b in builds)))
changes = [rows[2]["force (mN)"] - rows[0]["force (mN)"] for side in forces for rows in forces[side]]
gain, loss = max(changes), -min(changes)
print(f"""
With the fibres of [paper.md](paper.md) (100 um thick, no overlap) the glue puts the tip at {span(6, TIP, as_built)} um at 6 kV and {span(8, TIP, as_built)} um at 8 kV
where it is {bonded[glues[0], builds[0]][6][TIP]:.0f} and {bonded[glues[0], builds[0]][8][TIP]:.0f} um without: that band is what "as built" means. All of them move away from the fibres' side, as the paper says,
and grow smoothly to 6 kV; at 8 kV {sum(1 for r in bonded.values() if r and r[8]["trusted"] < 1)} of {len(bonded)} films are slack somewhere (flagged: a bound, not a prediction).
500 um at the tip are reached with {"; ".join("overlap %g mm and fibres of %g um, glue of %s um at each modulus" % (*b, " and ".join("%g" % um for um in sorted({g[0] for g, k in far_glued if k == b}))) for b in builds if any(k == b for _, k in far_glued)) or "none of them"}.
Which of overlap, thickness of the fibres, and glue it is, the profile can tell: centre over tip at 8 kV is
{min(abs(r[8]["z centre (um)"] / r[8][TIP]) for r in bonded.values() if r):.2f} to {max(abs(r[8]["z centre (um)"] / r[8][TIP]) for r in bonded.values() if r):.2f}.

## 0.18 N at 6 kV

Flat tip of 1.5 mm radius, membrane film, nominal design, pressed in by 0 to 2 mm from either side: the largest gain of force by 6 kV is {gain:.1f} mN, 180 mN in
the paper; the largest loss {loss:.1f} mN. The upper bound of model `lumped` (rigid fibres, nothing in their way, eqs 18 to 20) is {lumped[-1]["force (mN)"]:.0f} mN at 6 kV, and
goes with V to the power {math.log(lumped[-1]["force (mN)"] / lumped[1]["force (mN)"]) / math.log(2):.1f} from 3 to 6 kV, not 1.

**None of the depths and sides computed gives the paper's force**, and its form does
not depend on the design: as long as the film is taut all that follows from the field's stress goes with V^2.

A signal coupled into the cell would fit ([paper.md](paper.md)).

## What to measure next

In the order of what it decides for what it costs:

1. **The electrode's diameter at 0 V**, through the frame, by a camera: the pre-stretch to 1 %. 7.5 mm is 1.5; reading 2 needs 5.3 to 5.5 mm.
2. **The capacitance at 0 V**, to 1 %: it goes with l_pre^4/H, 24.6 pF as nominal; with 1 the film's thickness to 4 %.
3. **The height of tip and centre between 1 and 6 kV**, in steps of 0.5 kV: taut film, one state, no wrinkles. Reading 3
   gives a fibre tip that moves by {abs(together[-1]["z fibre tip (um)"]):.0f} um at 5 kV (overlap 1 mm, glue 100 um, fibres 50 um), reading 1 {abs(taut[-1]["z fibre tip (um)"]):.0f} um, reading 2 no more than that.
4. **Force at 0 V against the tip's depth**, then with the voltage: its slope is the film's tension, and its zero
   the contact height that Fig 12 lacks.
5. **Which samples broke**, at which voltage, and their thickness: a breakdown field needs those as much as those that lived.

What `dea fit` says of 3 alone: from heights of the fibre tip of the nominal design with 30 um of glue of 1 MPa,
at 2, 3, 4 and 5 kV, to 2 um each, with what is known before of thickness (5 %), pre-stretch (0.1) and
glue (30 um), all assumed:
""")
for p in next_fit["parameters"]:
    shown = 1e6 if p["unit"] == "m" else 1
    print("* `%s`: +- %.2g%s, known before to %.2g%s"
          % (p["name"], shown * p["standard_uncertainty"], " um" if shown > 1 else "",
             shown * p["prior_std"], " um" if shown > 1 else ""))
for pair in next_fit["advice"]["not_told_apart"]:
    print("* `%s` and `%s` are hardly told apart; this would tell: %s"
          % (pair["first"], pair["second"], pair["would_tell"]))
for k, row in enumerate(next_fit["advice"]["next_measurements"][:3]):
    print("* %s: %s (error bars x %.2f)"
          % ("most would tell" if k == 0 else "then", row["measurement"], row["error_bars_times"]))
