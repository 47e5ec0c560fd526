"""What the gradients of model 3d save a search: examples/explore/six.yaml with them, with
differences of designs, without either, and at random. Prints a page."""

import csv
import os
import re
import resource
import subprocess
import sys
import tempfile

command, root = sys.argv[1], sys.argv[2]


def run(folder, method, gradients):
    with open(os.path.join(root, "examples/explore/six.yaml"), encoding="utf-8") as file:
        text = file.read()
    design = os.path.join(root, "examples/explore/fibres-3d.yaml")
    text = re.sub(r"^design:.*$", "design: " + design, text, flags=re.M)
    text = re.sub(r"^method:.*$", f"method: {method}\ngradients: {gradients}", text, flags=re.M)
    name = os.path.join(folder, f"{method}-{gradients}")
    with open(name + ".yaml", "w", encoding="utf-8") as file:
        file.write(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([command, "optimise", name + ".yaml", "-q", "-j", "1", "-o", name],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    with open(os.path.join(name, "cases.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))

    def value(row, key):
        return float(next(v for k, v in row.items() if k.startswith(key)) or "nan")

    def within(row):
        return (value(row, "breakdown_margin") >= -1e-6
                and value(row, "min_tension_N_per_m") >= 1 - 1e-6)

    good = [value(row, "centre_z_m") for row in rows if within(row)]
    if not good:  # none within the limits
        return len(rows), "-", float("nan"), seconds
    near = next(i for i, row in enumerate(rows)
                if within(row) and value(row, "centre_z_m") <= 0.99 * min(good))
    return len(rows), near + 1, 1e6 * min(good), seconds


print("""# A search in model 3d, with its gradients and without

The largest stroke of the paper's actuator at 6 kV, breakdown and tension as limits, by six of its
numbers (width, overlap and thickness of four fibres, electrode, film, pre-stretch;
`examples/explore/six.yaml`; a membrane, a sector of the disc), from one start, with one process.
`to 1 %`: designs until one within the limits is within 1 % of the stroke in the row. Processor time
is of the whole command.

| method | gradients | designs | to 1 % | stroke (um) | processor time (s) |
|---|---|---|---|---|---|""")
with tempfile.TemporaryDirectory() as work:
    for how in (("slsqp", "model"), ("slsqp", "differences"), ("mma", "model"),
                ("cobyla", "model"), ("random", "model")):
        count, near, best, seconds = run(work, *how)
        gradients = "none" if how[0] in ("cobyla", "random") else how[1]
        print(f"| {how[0]} | {gradients} | {count} | {near} | {best:.1f} | {seconds:.1f} |", flush=True)
print("""
A local search finds a local optimum: where a row ends elsewhere, the stroke has more than one maximum, and `starts` is for that.""")
