"""dea fit and lmfit (which knows nothing of this project) on the three tests of examples/fit/silicone.

Prints a page: values, standard uncertainties, 68 % intervals by profile, and times as ratios.
Stresses are written down here by hand. Exit code 1 where the two differ by more than the page says.
"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import time

import lmfit
import numpy as np
from scipy.optimize import brentq

command, root = sys.argv[1:3]
folder = os.path.join(root, "examples", "fit", "silicone")


def read(name):
    with open(os.path.join(folder, name + ".csv"), encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    return np.array(rows, dtype=float).T


displacement, force = read("uniaxial")
TESTS = [(1 + displacement / 100, force / 4 * 1e3, lambda l: l**-0.5),
         (*read("planar"), np.ones_like),
         (*read("equibiaxial"), lambda l: l)]
TESTS = [(l, across(l), s, np.hypot(0.01 * s, 1.0)) for l, s, across in TESTS]  # kPa


def slope(law, p, I1):
    """dW/dI1 in kPa."""
    x = I1 - 3
    if law == "yeoh":
        return p["c1"] + 2 * p["c2"] * x + 3 * p["c3"] * x**2
    return p["mu"] / 2 / (1 - x / p["jm"])


def residual(parameters, law):
    p = parameters.valuesdict()
    parts = []
    for l, l2, s, std in TESTS:
        l3 = 1 / (l * l2)
        model = 2 * slope(law, p, l**2 + l2**2 + l3**2) * (l - l3**2 / l)
        parts.append((model - s) / std)
    return np.concatenate(parts)


START = {"yeoh": {"c1": 100, "c2": 0, "c3": 0}, "gent": {"mu": 300, "jm": 50}}


def by_lmfit(law):
    parameters = lmfit.Parameters()
    for name, value in START[law].items():
        parameters.add(name, value, min=4 if name == "jm" else -np.inf)
    begin = time.perf_counter()
    fitter = lmfit.Minimizer(residual, parameters, fcn_args=(law,), scale_covar=False)
    result = fitter.minimize(ftol=1e-13, xtol=1e-13)
    ends = {}
    for name in START[law]:
        def rise(value, name=name):  # lmfit's conf_interval takes an F distribution: wider
            fixed = result.params.copy()
            fixed[name].set(value=value, vary=False)
            again = lmfit.minimize(residual, fixed, args=(law,), ftol=1e-13, xtol=1e-13)
            return again.chisqr - result.chisqr - 1
        value, std = result.params[name].value, result.params[name].stderr
        ends[name] = [brentq(rise, value + side * 0.3 * std, value + side * 3 * std) for side in (-1, 1)]
    return result, ends, time.perf_counter() - begin


def by_dea(law):
    with open(os.path.join(root, "examples", "fit", "silicone.yaml"), encoding="utf-8") as file:
        text = file.read()
    text = text.replace("file: silicone/", "file: " + folder + "/")
    text = text.replace("[neo-hookean, mooney-rivlin, yeoh, gent]", "[" + law + "]")
    with tempfile.TemporaryDirectory() as work:
        path = os.path.join(work, "fit.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        begin = time.perf_counter()
        run = subprocess.run([command, "fit", path, "--profile", "--json", "--format", "svg", "-o",
                              os.path.join(work, "out")], capture_output=True, text=True, check=True)
        spent = time.perf_counter() - begin
    return json.loads(run.stdout), spent


bad = False


def shown(value, other, tolerance):
    """The larger of two differences; notes what is beyond the tolerance."""
    global bad
    off = abs(value - other)
    bad = bad or off > tolerance
    return f"{value:.6g} | {other:.6g}"


print("""# dea fit beside lmfit

Made by `scripts/verify fit`; not to be edited. The three tests of
[examples/fit/silicone.yaml](../../examples/fit/silicone.yaml), their uncertainties taken as known; lmfit %s with the
stresses written by hand, its intervals by its own fits where chi-square has grown by 1. Tolerances: values and ends
of intervals 2 %% of a standard uncertainty, uncertainties 1 %%.
""" % lmfit.__version__)
spent = [0, 0]
for law in START:
    result, ends, seconds = by_lmfit(law)
    fit, own = by_dea(law)
    spent[0] += seconds
    spent[1] += own
    print(f"## {law}\n")
    print("| parameter | dea | lmfit | std, dea | std, lmfit | low, dea | low, lmfit | high, dea | high, lmfit |")
    print("|---|---|---|---|---|---|---|---|---|")
    correlated = any(test["neighbour_correlation"] > 0 for test in fit["tests"])
    for row in fit["parameters"]:
        factor = 1e-3 if row["unit"] == "Pa" else 1
        p = result.params[row["name"]]
        std = p.stderr
        cells = [shown(factor * row["value"], p.value, 0.02 * std)]
        if correlated or fit["widened"]:
            cells.append(f"{factor * row['standard_uncertainty']:.4g} | {std:.4g}")
            cells.append(f"{factor * row['interval_low']:.6g} | {ends[row['name']][0]:.6g}")
            cells.append(f"{factor * row['interval_high']:.6g} | {ends[row['name']][1]:.6g}")
        else:
            cells.append(shown(factor * row["standard_uncertainty"], std, 0.01 * std))
            cells.append(shown(factor * row["interval_low"], ends[row["name"]][0], 0.02 * std))
            cells.append(shown(factor * row["interval_high"], ends[row["name"]][1], 0.02 * std))
        print(f"| {row['name']} | " + " | ".join(cells) + " |")
    print(f"\nchi-square: {fit['chi_square']:.4f} and {result.chisqr:.4f}.\n")
    bad = bad or abs(fit["chi_square"] - result.chisqr) > 1e-3 * result.chisqr
    if correlated or fit["widened"]:
        print("The law does not fit: its residuals are structured. dea fit widens its error bars for that "
              "(by the number of rows that count, and by the misfit); lmfit, told to take the uncertainties as "
              "known, does not. They are not compared.\n")
print(f"Time of the whole command, with reading, profiles, figure and files, over that of lmfit's fits and intervals: "
      f"{spent[1] / spent[0]:.1f}.")
sys.exit(1 if bad else 0)
