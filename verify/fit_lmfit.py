"""dea fit, lmfit and emcee (which know nothing of this project) on the same data, in one run.

Prints a page: values, standard uncertainties, 68 % intervals by profile and by samples, and times as
ratios. Stresses are written down here by hand. Exit code 1 where they differ by more than the page says.
"""
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
import time

import emcee
import lmfit
import numpy as np
from scipy.optimize import brentq

command, root = sys.argv[1:3]
folder = os.path.join(root, "examples", "fit", "silicone")
LARGE = 1000  # rows of each test of the large fit


def read(name):
    with open(os.path.join(folder, name + ".csv"), encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))[1:]
    return np.array(rows, dtype=float).T


def with_std(tests):
    return [(l, l2, s, np.hypot(0.01 * s, 1.0)) for l, l2, s in tests]  # kPa


def silicone():
    displacement, force = read("uniaxial")
    l = 1 + displacement / 100
    wide, bulge = read("planar"), read("equibiaxial")
    return with_std([(l, l**-0.5, force / 4 * 1e3), (wide[0], np.ones_like(wide[0]), wide[1]),
                     (bulge[0], bulge[0], bulge[1])])


def nominal(law, p, l, l2):
    """Nominal stress in kPa: dW/dl1 along incompressible stretches."""
    l3 = 1 / (l * l2)
    I1, I2 = l**2 + l2**2 + l3**2, l**-2 + l2**-2 + l3**-2
    x, y = I1 - 3, I2 - 3
    W2 = 0
    if law == "yeoh":
        W1 = p["c1"] + 2 * p["c2"] * x + 3 * p["c3"] * x**2
    elif law == "gent":
        W1 = p["mu"] / 2 / (1 - x / p["jm"])
    else:  # third order: c10, c01, c11, c20, c30
        W1 = p["c10"] + p["c11"] * y + 2 * p["c20"] * x + 3 * p["c30"] * x**2
        W2 = p["c01"] + p["c11"] * x
    return 2 * (W1 + W2 * l2**2) * (l - l3**2 / l)


TRUTH = {"c10": 500.0, "c01": -14.0, "c11": 14.0, "c20": -16.0, "c30": 5.0}  # kPa, of the large fit


def large():
    noise = np.random.default_rng(4)
    tests = []
    for to, across in (3.0, lambda l: l**-0.5), (3.0, np.ones_like), (2.0, lambda l: l):
        l = np.linspace(1, to, LARGE + 1)[1:]
        s = nominal("third-order", TRUTH, l, across(l))
        tests.append((l, across(l), s + np.hypot(0.01 * s, 1.0) * noise.standard_normal(LARGE)))
    return with_std(tests)


def residual(parameters, law, tests):
    p = parameters.valuesdict()
    return np.concatenate([(nominal(law, p, l, l2) - s) / std for l, l2, s, std in tests])


START = {"yeoh": {"c1": 100, "c2": 0, "c3": 0}, "gent": {"mu": 300, "jm": 50},
         "third-order": {"c10": 100, "c01": 0, "c11": 0, "c20": 0, "c30": 0}}


def by_lmfit(law, tests):
    parameters = lmfit.Parameters()
    for name, value in START[law].items():
        parameters.add(name, value, min=4 if name == "jm" else -np.inf)
    begin = time.process_time()
    fitter = lmfit.Minimizer(residual, parameters, fcn_args=(law, tests), scale_covar=False)
    result = fitter.minimize(ftol=1e-13, xtol=1e-13)
    ends = {}
    for name in START[law]:
        def rise(value, name=name):  # lmfit's conf_interval takes an F distribution: wider
            fixed = result.params.copy()
            fixed[name].set(value=value, vary=False)
            again = lmfit.minimize(residual, fixed, args=(law, tests), ftol=1e-13, xtol=1e-13)
            return again.chisqr - result.chisqr - 1
        value, std = result.params[name].value, result.params[name].stderr
        ends[name] = [brentq(rise, value + side * 0.3 * std, value + side * 3 * std) for side in (-1, 1)]
    return result, ends, time.process_time() - begin


def by_emcee(law, tests, result):
    """Quantiles 16, 50, 84 % and standard deviation of each parameter."""
    names = list(START[law])
    best = np.array([result.params[name].value for name in names])
    spread = np.linalg.cholesky(result.covar)
    parameters = result.params.copy()

    def log_likelihood(p):
        for name, value in zip(names, p):
            parameters[name].value = value
        return -0.5 * np.sum(residual(parameters, law, tests)**2)

    walkers, steps = 32, 3000
    random = np.random.RandomState(5)
    begin = time.process_time()
    sampler = emcee.EnsembleSampler(walkers, len(names), log_likelihood)
    sampler.random_state = random.get_state()
    sampler.run_mcmc(best + 0.5 * random.standard_normal((walkers, len(names))) @ spread.T, steps)
    seconds = time.process_time() - begin
    chain = sampler.get_chain(discard=500, flat=True)
    return np.percentile(chain, [16, 50, 84], axis=0).T, chain.std(axis=0), seconds


def by_dea(law, tests):
    kinds = ["uniaxial", "planar", "equibiaxial"]
    with tempfile.TemporaryDirectory() as work:
        text = "dea_fit: 1\nname: beside\nlaws: [%s]\ntests:\n" % law
        for kind, (l, _, s, _) in zip(kinds, tests):
            np.savetxt(os.path.join(work, kind + ".csv"), np.column_stack([l, s]), "%.10g", ",",
                       header="stretch,stress (kPa)", comments="")
            text += ("  - {name: %s, kind: %s, file: %s.csv, uncertainty: 1 %%, uncertainty_absolute: 1 kPa}\n"
                     % (kind, kind, kind))
        path = os.path.join(work, "fit.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        begin = resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run([command, "fit", path, "--profile", "--json", "--format", "svg", "-o",
                              os.path.join(work, "out")], capture_output=True, text=True, check=True)
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return json.loads(run.stdout), end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime


bad = False


def shown(value, *others):
    """The values; notes where one of the others, each with its tolerance, is beyond it."""
    global bad
    bad = bad or any(abs(value - other) > tolerance for other, tolerance in others)
    return " | ".join(f"{x:.5g}" for x in [value] + [other for other, _ in others])


print("""# dea fit beside lmfit and emcee

Made by `scripts/verify fit`; not to be edited. lmfit %s and emcee %s with the stresses written by hand,
uncertainties taken as known (1 %% and 1 kPa, squares added); lmfit's intervals by its own fits where
chi-square has grown by 1, emcee's are the quantiles 16 and 84 %% of samples (flat prior, 32 walkers of 3000
steps, of which 500 are left out). Tolerances: of lmfit, values and ends of intervals 2 %% of a standard
uncertainty, uncertainties 1 %%; of samples, whose own error is about 2 %%, 10 %% of a standard uncertainty.
""" % (lmfit.__version__, emcee.__version__))
CASES = [("yeoh", "the three tests of `examples/fit/silicone.yaml`", silicone()),
         ("gent", "the same tests, which this law does not fit", silicone()),
         ("third-order", "%d points of three synthetic tests" % (3 * LARGE), large())]
times = []
for law, what, tests in CASES:
    result, ends, by_fits = by_lmfit(law, tests)
    quantiles, stds, by_samples = by_emcee(law, tests, result)
    fit, own = by_dea(law, tests)
    times.append((law, sum(len(t[0]) for t in tests), len(START[law]), own, by_fits, by_samples))
    print(f"## {law}: {what}\n")
    print("| parameter | dea | lmfit | std: dea | lmfit | emcee | low: dea | lmfit | emcee | high: dea | lmfit | emcee |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|")
    widened = any(test["neighbour_correlation"] > 0 for test in fit["tests"]) or fit["widened"]
    for k, row in enumerate(fit["parameters"]):
        factor = 1e-3 if row["unit"] == "Pa" else 1
        p = result.params[row["name"]]
        std = p.stderr
        # what dea has widened is not compared
        strict, rough = (np.inf, np.inf) if widened else (0.02 * std, 0.1 * std)
        low, high = ends[row["name"]]
        print(f"| {row['name']} | " + " | ".join([
            shown(factor * row["value"], (p.value, 0.02 * std)),
            shown(factor * row["standard_uncertainty"], (std, 0.5 * strict), (stds[k], rough)),
            shown(factor * row["interval_low"], (low, strict), (quantiles[k][0], rough)),
            shown(factor * row["interval_high"], (high, strict), (quantiles[k][2], rough))]) + " |")
    print(f"\nchi-square: {fit['chi_square']:.4f} and {result.chisqr:.4f}.\n")
    bad = bad or abs(fit["chi_square"] - result.chisqr) > 1e-3 * result.chisqr
    if widened:
        print("The law does not fit: dea fit widens its error bars for that; the others, told to take the uncertainties as known, do not. "
              "Only the values are compared.\n")
print("""## Times

Processor time of the whole command, with reading, all profiles, figure and files, against lmfit's fits and
intervals and emcee's samples in a process that is already there.

| law | points | parameters | lmfit / dea | emcee / dea | dea below 1 s |
|---|---|---|---|---|---|""")
for law, points, count, own, by_fits, by_samples in times:
    print(f"| {law} | {points} | {count} | {by_fits / own:.2g} | {by_samples / own:.2g} | {'yes' if own < 1 else 'no'} |")
sys.exit(1 if bad else 0)
