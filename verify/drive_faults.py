"""Page docs/verification/drive-faults.md: what `dea drive` says and how long it takes when a supply,
the program or the disk fails at a random moment, or a meter or an output does something else than it
should. Arguments: the source tree, the number of runs, and a table of runs with such meters where
they were made already: then only that part of the page is printed."""

import csv
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT, COUNT = pathlib.Path(sys.argv[1]), int(sys.argv[2])
TESTS = ROOT / "build" / "tests"
FOLDER = tempfile.TemporaryDirectory(prefix="dea-faults-")
WORK = pathlib.Path(FOLDER.name)
EDGES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, float("inf")]
MEANINGS = {
    "none": "nothing goes wrong",
    "delay": "each command takes 0.02 to 1.2 s",
    "hang": "nothing is read, done or answered; the output stays",
    "lie": "as delay, but each question is answered at once",
    "garbage": "answers are noise",
    "disconnect": "the connection is closed, and each new one",
    "SIGSTOP": "the program is stopped, for 4 s at most",
    "kill -9": "the program is killed",
    "SEGV": "the program crashes",
    "full disk": "the recording cannot be written any more",
    "Ctrl-C": "somebody ends it",
}
COLOURS = ["#0072B2", "#56B4E9", "#D55E00", "#CC79A7", "#E69F00", "#999999", "#009E73", "#000000",
           "#F0E442", "#66A61E", "#7570B3"]


def serial(count, together=8):
    """Runs of the SHVPS on a pseudo-terminal: what was said of its output, and what it was."""
    share = -(-count // together)
    running = [
        subprocess.Popen([TESTS / "test_lab_shvps", str(share), str(1 + k * share)], cwd=WORK,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for k in range(together)
    ]
    rows, good = [], True
    for process in running:
        text = process.communicate()[0]
        good = good and process.returncode == 0
        rows += re.findall(r"s, exit code -?\d+, (at 0 V|not known), (\d+) V", text)
    return rows, good


def network(count):
    table = WORK / "runs.csv"
    process = subprocess.run([TESTS / "test_lab_faults", str(count), "1", table], cwd=WORK,
                             stdout=sys.stderr, stderr=sys.stderr)
    with open(table, newline="") as file:
        return list(csv.DictReader(file)), process.returncode == 0


def lying(count):
    """Runs with meters and outputs that do something else."""
    table = WORK / "meters.csv"
    process = subprocess.run([TESTS / "test_lab_faults", "meters", str(count), "1", table],
                             cwd=WORK, stdout=sys.stderr, stderr=sys.stderr)
    with open(table, newline="") as file:
        return list(csv.DictReader(file)), process.returncode == 0


def cell(own):
    """Runs, and of them "at 0 V" said wrongly and what was not noticed (or an honest one stopped)."""
    if not own:
        return "-"
    said = sum(r["said wrongly"] == "1" for r in own)
    judged = sum(r["judged wrongly"] == "1" for r in own)
    warned = sum(r["warned"] == "1" and r["exit"] == "0" and r["kind"] != "honest" for r in own)
    return f"{len(own)}: {said}, {judged}" + (f" (+{warned})" if warned else "")


def meters_text(rows):
    waves = list(dict.fromkeys(r["waveform"] for r in rows))
    kinds = list(dict.fromkeys(r["kind"] for r in sorted(rows, key=lambda r: r["kind"] != "honest")))
    said = sum(r["said wrongly"] == "1" for r in rows)
    honest = [r for r in rows if r["kind"] == "honest"]
    stopped = sum(r["judged wrongly"] == "1" for r in honest)
    missed = sum(r["judged wrongly"] == "1" for r in rows) - stopped
    warned = sum(r["warned"] == "1" and r["exit"] == "0" and r["kind"] != "honest" for r in rows)
    heard = [float(r["heard to 0 V (s)"]) for r in rows if r["kind"] == "deaf for 8 s"]
    serial = sum(r["supply"] == "shvps" for r in rows)
    print(f"""## Meters that lie, outputs that do something else

{len(rows)} drives of 12 s ({serial} on an imitated SHVPS, the others on a SCPI supply that is measured every
0.5 s) by five waveforms between 0 and 2 kV of 0.5, 1 and 2 Hz (pulses: a fifth of a cycle long), each
sixteen at a time. What goes wrong does so from the start, or at a random moment of the first 7.2 s;
an output that stays does so after it has moved. "At 0 V" said while the output was not: **{said}**.
Honest supplies stopped, or not believed at the end: **{stopped}** of {len(honest)}. Wrong outputs or meters
that nobody noticed (exit code 0): **{missed}** of {len(rows) - len(honest)}, beside {warned} of which the check had said that
they are too fast to be told.

Runs: "at 0 V" said wrongly, not noticed (of honest ones: stopped); in brackets, not noticed as the
check had said:
""")
    print("| | " + " | ".join(waves) + " | all |\n" + "|---" * (len(waves) + 2) + "|")
    for kind in kinds:
        own = [r for r in rows if r["kind"] == kind]
        print(f"| {kind} | " + " | ".join(cell([r for r in own if r["waveform"] == w])
                                          for w in waves) + f" | {cell(own)} |")
    print("| all | " + " | ".join(cell([r for r in rows if r["waveform"] == w]) for w in waves)
          + f" | {cell(rows)} |")
    print(f"""
Supplies that were deaf for 8 s: {sum(t < float("inf") for t in heard)} of {len(heard)} were at 0 V within 20 s of
their hearing again, at the latest {max([t for t in heard if t < float("inf")], default=float("nan")):.1f} s after it, by the drive itself or by its guard.
""")
    return said == 0 and stopped == 0 and missed == 0


def what_came(row):
    """Time from the fault to 0 V, or, where that was not to be had, to the alarm."""
    zero, alarm = float(row["at 0 V (s)"]), float(row["alarm (s)"])
    return ("0 V", zero) if zero < float("inf") else ("alarm", alarm)


def counts(rows, kind):
    bins = [0] * len(EDGES)
    for row in rows:
        what, time = what_came(row)
        if what == kind:
            bins[next(i for i, edge in enumerate(EDGES) if time < edge or edge == EDGES[-1])] += 1
    return bins


def draw(rows, faults):
    """Stacked bars, a colour a fault, in the style of the other figures."""
    data = WORK / "bars.dat"
    names = [f"< {edge:g}" for edge in EDGES[:-1]] + ["> 30"]
    with open(data, "w") as file:
        for i, name in enumerate(names):
            own = [[r for r in rows if r["fault"] == f] for f in faults]
            up = [counts(o, "0 V")[i] for o in own]
            alarm = counts(rows, "alarm")[i]
            file.write(f'"{name}" ' + " ".join(map(str, up)) + f" {alarm}\n")
    figure = ROOT / "docs" / "figures" / "drive-faults.svg"
    parts = [f"'{data}' using {k + 2}:xtic(1) title '{f}' lc rgb '{COLOURS[k]}'"
             for k, f in enumerate(faults)]
    parts.append(f"'{data}' using {len(faults) + 2} title 'not at 0 V, and said so' lc rgb '#000000' "
                 "fs pattern 5")
    script = f"""set terminal svg size 760,420 font 'Helvetica,13' background rgb 'white'
set output '{figure}'
set style data histograms
set style histogram rowstacked
set style fill solid 1 border -1
set boxwidth 0.8
set border 3
set tics nomirror out
set key outside right top Left reverse samplen 1 noenhanced
set xlabel 'Time from the fault to 0 V, or to the alarm (s)'
set ylabel 'Runs'
plot {", ".join(parts)}
"""
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def median(values):
    values = sorted(values)
    return values[len(values) // 2] if values else float("nan")


def table(rows, faults):
    print("| fault | meaning | runs | said \"at 0 V\" | said so and it was not | at 0 V after (s): "
          "median, longest | not at 0 V, all said to be so | alarm after (s): median, longest |")
    print("|---|---|---|---|---|---|---|---|")
    for fault in faults:
        own = [r for r in rows if r["fault"] == fault]
        zero = [t for k, t in map(what_came, own) if k == "0 V"]
        alarm = [float(r["alarm (s)"]) for r in own if float(r["alarm (s)"]) < float("inf")]
        said = [r for r in own if r["said at 0 V"] == "1"]
        lies = [r for r in own if r["wrong"] == "1"]
        left = len(own) - len(zero)
        print(f"| {fault} | {MEANINGS[fault]} | {len(own)} | {len(said)} | {len(lies)} | "
              f"{median(zero):.2f}, {max(zero, default=float('nan')):.2f} | {left} | "
              f"{median(alarm):.2f}, {max(alarm, default=float('nan')):.2f} |")


def histogram(rows):
    print("| time (s) | at 0 V | not at 0 V: alarm |\n|---|---|---|")
    low = 0
    for edge, zero, alarm in zip(EDGES, counts(rows, "0 V"), counts(rows, "alarm")):
        print(f"| {low:g} to {edge:g} | {zero} | {alarm} |")
        low = edge


def main():
    if len(sys.argv) > 3:
        with open(sys.argv[3], newline="") as file:
            sys.exit(0 if meters_text(list(csv.DictReader(file))) else 1)
    rows, good = network(COUNT)
    faults = [f for f in MEANINGS if any(r["fault"] == f for r in rows)]
    draw(rows, faults)
    wrong = sum(r["wrong"] == "1" for r in rows)
    print(f"""# High voltage with a fault at a random moment

{len(rows)} runs of `dea drive --arm` on an imitated SCPI supply (one queue of commands, an output that
follows at 5 to 100 kV/s, one or several connections, with and without a voltage that can be read
back): two triangles up to 2 kV, a fault between 0.2 and 1.4 s after the start, for good or for 0.1
to 3 s. What the supply's output really is, is asked of the imitation, and for 2 s after the
program's end. Runs in which "at 0 V" was said, or the supply taken for clean, and it was not:
**{wrong}**.

Times are upper bounds (other work on the machine). The
fault is at the moment 0; a run without one, or whose supply lives through it, comes to 0 V by the
end of its sequence.

![Time from the fault to 0 V, or to the alarm](../figures/drive-faults.svg)
""")
    histogram(rows)
    print()
    table(rows, faults)
    print("""
The alarm is the end of the program with its exit code; that of a program that was killed is its death. A hung supply keeps its
voltage: only its own switch helps.
""")
    line, line_good = serial(max(COUNT // 5, 8))
    lies = sum(said == "at 0 V" and int(volts) > 20 for said, volts in line)
    print(f"""The same on a serial line: {len(line)} runs with an imitated SHVPS on a pseudo-terminal (slow,
hung, lying, stuck, noise, errors, begun anew, pulled out; answers in pieces of 1 to 3 bytes too):
"at 0 V" was said in {sum(said == "at 0 V" for said, _ in line)}, wrongly in **{lies}**.
""")
    meters, meters_good = lying(max(3 * COUNT // 10, 8))
    meters_good = meters_text(meters) and meters_good
    print("""Made by `scripts/verify drive-faults`; in the tests, `test_lab_faults.c:
test_faults_at_random_moments` and `test_meters_that_lie`, and `test_lab_shvps.c:
test_faults_at_random_moments` make 12, 16 and 3 runs by fixed seeds.""")
    sys.exit(0 if good and line_good and meters_good and wrong == 0 and lies == 0 else 1)


main()
