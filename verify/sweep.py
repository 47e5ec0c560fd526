"""Page docs/verification/sweep.md: dea sweep killed again and again, its bands and probabilities
beside plain random samples, and what a design costs. Arguments: the command, the source tree."""

import csv
import pathlib
import resource
import subprocess
import sys
import tempfile

DEA, ROOT = sys.argv[1], sys.argv[2]
FOLDER = tempfile.TemporaryDirectory(prefix="dea-sweep-")
WORK = pathlib.Path(FOLDER.name)
FAILED = []

SPREAD = """variables:
  - {name: film.thickness, distribution: normal, mean: 100 um, std: 3 um}
  - {name: pre_stretch, low: 1.45, high: 1.55}
  - {name: film.law.c1, distribution: lognormal, mean: 178.4 kPa, std: 9 kPa}
"""


def ask(name, model, voltages, quantities, rest, design=ROOT + "/examples/frdea-4.yaml"):
    (WORK / (name + ".yaml")).write_text(
        f"dea_explore: 1\nname: {name}\ndesign: {design}\nmodel: {model}\n"
        f"voltages: [{voltages}]\nquantities: [{quantities}]\n{rest}"
    )


def run(name, *options, limit=None):
    """Runs it, killed after `limit` seconds; processor time of all its processes [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(
        [DEA, "sweep", name + ".yaml", "-q", *options], cwd=WORK, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        process.wait(limit)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def rows(name, file):
    with open(WORK / (name + ".sweep") / file, newline="") as source:
        return list(csv.DictReader(source))


def check(what, good):
    if not good:
        FAILED.append(what)
        print(f"{what}: failed", file=sys.stderr)


def killed():
    more = SPREAD + "plan: sobol\nsamples: 1000\n"
    volts = ", ".join(f"{0.25 * k} kV" for k in range(1, 25))
    for name in ("whole", "killed"):
        ask(name, "axisymmetric", volts, "electrode_edge_u_m, breakdown_margin", more)
    run("whole")
    kills = 0
    while not (WORK / "killed.sweep/cases.csv").exists():
        run("killed", limit=1.5)
        kills += 1
    run("killed")
    drop = ("time (s)",)
    a, b = (
        [{k: v for k, v in row.items() if k not in drop} for row in rows(name, "cases.csv")]
        for name in ("whole", "killed")
    )
    lines = (WORK / "killed.sweep/part-1-of-1.csv").read_text().splitlines()
    numbers = [line.split(",")[0] for line in lines if line and not line.startswith("#")]
    twice = len(numbers) - len(set(numbers))
    check("killed", len(b) == 1000 and a == b)
    print("## Killed again and again\n")
    print(
        f"1000 designs of model axisymmetric on all cores, `kill -9` after 1.5 s, started again, until\n"
        f"done: {kills - 1} kills. In the table: {len(b)} designs; designs that were kept twice: {twice};\n"
        f"all numbers those of a sweep that was left alone: {'yes' if a == b else 'no'}.\n"
    )


def bands():
    volts = "1 kV, 2 kV, 3 kV, 4 kV, 5 kV"
    limit = "limits: [{quantity: electrode_edge_u_m, above: 400 um}]\n"
    plans = {"random": 100000, "sobol": 2048}
    for plan, count in plans.items():
        ask(plan, "lumped", volts, "electrode_edge_u_m", f"plan: {plan}\nsamples: {count}\n{limit}{SPREAD}")
        run(plan)
    tables = {plan: rows(plan, "statistics.csv") for plan in plans}
    shares = {plan: rows(plan, "limits.csv")[0] for plan in plans}
    print("## Bands\n")
    print(
        "Displacement of the electrode's edge of `frdea-4`, model lumped (um): film thickness normal\n"
        "(100 +- 3 um), pre-stretch uniform (1.45 to 1.55), c1 lognormal (178.4 kPa, 9 kPa).\n"
        "2048 samples beside 1e5 random ones.\n"
    )
    print("| V (kV) | | " + " | ".join(f"{p}, {n}" for p, n in plans.items()) + " |")
    print("|---|---|---|---|")
    for k in range(5):
        for key in ("mean", "2.5 %", "50 %", "97.5 %"):
            cells = [1e6 * float(tables[plan][k][key]) for plan in plans]
            print(f"| {k + 1} | {key} | " + " | ".join(f"{cell:.2f}" for cell in cells) + " |")
            check(f"bands at {k + 1} kV, {key}", all(abs(c / cells[0] - 1) < 0.01 for c in cells))
    line = " | ".join(
        f"{100 * float(s['probability']):.2f} +- {100 * float(s['standard error']):.2f}"
        for s in shares.values()
    )
    print(f"| 5 | below 400 um (%) | {line} |\n")


def costs():
    text = pathlib.Path(ROOT + "/examples/frdea-4.yaml").read_text()
    text = text.replace("models: [lumped, axisymmetric]", "models: [3d]\n  solid: {film: membrane}")
    (WORK / "fibres.yaml").write_text(text)
    print("## What a design costs\n")
    print(
        "Processor time of a design with one process (program, reading, and files included), on the\n"
        "machine that wrote this page. On paper: a million designs on 1000 cores.\n"
    )
    print("| model | voltages | designs | ms a design | designs an hour and core | bytes a design | 1e6 on 1000 cores |")
    print("|---|---|---|---|---|---|---|")
    wanted = "electrode_edge_u_m, breakdown_margin"
    for name, model, volts, count, design in (
        ("l", "lumped", "1 kV, 2 kV, 3 kV, 4 kV, 5 kV", 2000, ROOT + "/examples/frdea-4.yaml"),
        ("x", "axisymmetric", "1 kV, 2 kV, 3 kV, 4 kV, 5 kV", 500, ROOT + "/examples/frdea-4.yaml"),
        ("d", "3d", "6 kV", 60, "fibres.yaml"),
        ("r", "3d", "6 kV", 60, "fibres.yaml"),
    ):
        plan = f"plan: sobol\nsamples: {count}\nseed: 3\nbegin: {'rest' if name == 'r' else 'nearest'}\n"
        ask(name, model, volts, wanted, plan + SPREAD, design)
        cpu = run(name, "-j", "1") / count
        size = sum(f.stat().st_size for f in (WORK / (name + ".sweep")).iterdir()) / count
        what = {"d": "3d, membrane, sector", "r": "the same, `begin: rest`"}.get(name, model)
        print(
            f"| {what} | {volts.count(',') + 1} | {count} | {1e3 * cpu:.2g} | {3600 / cpu:.2g} | {size:.0f} "
            f"| {1e6 * cpu / 1000 / 60:.2g} min |"
        )
    key = "electrode_edge_u_m (m)"
    off = max(
        abs(float(a[key]) / float(b[key]) - 1)
        for a, b in zip(rows("d", "cases.csv"), rows("r", "cases.csv"))
    )
    check("nearest and rest", off < 1e-8)
    print(f"\nFrom a neighbour and from rest: edges of the electrode that differ by {off:.0e} at most.")
    print("Thousands of designs of model 3d, killed and by Slurm: [sweep-many.md](sweep-many.md).\n")


print("# Many designs\n")
killed()
bands()
costs()
sys.exit(1 if FAILED else 0)
