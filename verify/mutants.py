#!/usr/bin/env python3
"""Changes one place of the source at a time and looks whether a test notices.

    mutants.py [--known] [--sample 20 --seed 1] [--in lab/src/reduce]... [--build FOLDER] [--jobs 2]
               [--cmake OPTION]...

--known    every change of each line of KNOWN, lines that changes once survived in
--in       only files whose names begin so
--sample   so many changes of lines drawn from the files that OWN_TESTS names

The source is copied into FOLDER (a temporary one, kept where it is named) and built there without
optimisation, only with the tests of the changed file. Prints a line for each change: caught (and by
what), survived, or the same (a reason stands in SAME). Exit 1 where one survived.
"""
import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

# Tests that are to notice a change of these files; targets are test_NAME.
OWN_TESTS = [
    ("lab/src/reduce/figures.c", "cli_reduce"),
    ("lab/src/reduce/", "lab_reduce_parts lab_reduce_little lab_reduce"),
    ("src/model/solid/point/tension_field.c", "solid_tension"),
    ("src/model/solid/mesh/cuts.c", "solid_plate"),
    ("src/model/solid/element/", "solid_recover solid_element"),
    ("src/model/solid/recovery/", "solid_recover"),
    ("src/material/law_", "material_law"),
    ("src/waveform/", "waveform"),
    ("src/material/catalogue", "catalogue"),
    ("src/material/", "material_point material_plane material_law"),
    ("src/geometry/", "geometry_region geometry_boolean geometry_symmetry geometry_drawing"),
    ("lab/src/drive/arc_watch.c", "lab_drive_output"),
    ("lab/src/drive/leak_watch.c", "lab_leak"),
    ("lab/src/instrument/timed_output.c", "lab_scpi"),
    ("lab/src/instrument/scpi_parse.c", "lab_scpi"),
    ("lab/src/drive/drive_watch.c", "lab_drive_output lab_leak lab_drive"),
    ("lab/src/drive/drive_output.c", "lab_drive_output"),
    ("lab/src/protocol/protocol_export.c", "lab_export"),
    ("lab/src/protocol/protocol_check.c", "lab_leak lab_checks"),
    ("lab/src/protocol/", "lab_checks lab_protocol"),
    ("lab/src/import/import_mat.c", "lab_mat"),
    ("lab/src/import/", "lab_import lab_import_odd lab_import_frames lab_import_mapping "
                        "lab_import_lvm lab_import_tdms"),
    ("src/base/dense.c", "dense"),
    ("src/base/h5.c", "io_h5 lab_recording"),
    ("lab/src/recording/", "lab_recording lab_damaged"),
    ("src/design/", "design design_errors"),
    ("src/identify/weibull.c", "identify_weibull"),
    ("src/identify/", "identify identify_fit identify_weibull device_fit cli_fit cli_fit_breakdown"),
    ("src/explore/optim", "explore_optimise"),
    ("src/explore/best.c", "explore_optimise"),
    ("src/explore/slopes.c", "explore_optimise"),
    ("src/explore/", "explore cli_sweep"),
    ("src/studio/", "studio"),
    ("src/fabricate/dxf_write.c", "fab fab_drawing geometry_drawing"),
    ("src/fabricate/", "fab fab_contour fab_errors fab_layout cli_fab fab_drawing"),
    ("src/study/", "study_compare study_convergence study_force study_loading study_map "
                   "study_states study_transient study_uncertainty study_vibration path "
                   "layout_modes cli_run plane_gradient"),
    ("src/base/", "base units design_errors"),
]

# What a test loads, and its target does not bring along.
MODULES = {"lab_mat": ["dea_matio_module"], "cli_reduce": ["dea"], "cli_fit": ["dea"],
           "cli_fit_breakdown": ["dea"], "cli_sweep": ["dea"], "cli_fab": ["dea"],
           "cli_run": ["dea"]}

# (file, what its line holds): found by its text, since lines move.
KNOWN = [
    ("lab/src/reduce/filter.c", "return cutoff_Hz > 0.0 ? 15.0 * time_constant(cutoff_Hz)"),
    ("lab/src/reduce/noise.c", "bt[p][i] = (i >= column ? b[p][i - column] : 0.0) +"),
    ("lab/src/reduce/profiles.c", "levelling->offset_std_m = n > 1.0 ?"),
    ("src/model/solid/element/hex.c", "if (status == DEA_OK && E == NULL && thin_V_per_m != 0) {"),
    ("src/model/solid/mesh/cuts.c", "if (!(length / widest < (double)max && first > 0 && last > 0))"),
    ("lab/src/reduce/order_statistics.c", "size_t more = *room > 0 ? 2 * *room : 32;"),
    ("src/model/solid/point/tension_field.c", "double low = l > 1 ? l : 1, high = low, stress = 0, slope;"),
    ("lab/src/reduce/discharges.c", "if (s->plateau_count == 0 && n > 0) {"),
    ("lab/src/reduce/level.c", "if (supports(l, x[i]) && fabs(off) <= limit) {"),
    ("lab/src/reduce/figures.c", "panel->x_min = table->rows > 0 ? table->time_s[0] : 0.0;"),
    ("lab/src/reduce/discharges.c", "return k < channel->count ? channel->values[k] : NAN;"),
    ("src/base/h5.c", "if (h->status == DEA_OK && H5Lcreate_hard(from, name, to, name,"),
    ("lab/src/import/import_mat.c", 'return (marked && memcmp(head, "MATLAB ", 7) == 0) ||'),
    ("lab/src/import/import_mat.c", "if (fseek(stream, 0, SEEK_END) == 0) {"),
    ("src/base/write_file.c", "if (path == NULL) {"),
    ("src/base/schema_print.c", "bool listed = field->kinds != NULL && !field->kinds_elsewhere;"),
    ("lab/src/protocol/protocol_export.c", "bool good = strchr(\"'\\\\\", *c) == NULL"),
    ("src/geometry/svg_read.c", "r->drawing->unit_is_known |= known && view[2 + k] > 0;"),
    ("lab/src/import/import_tdms.c", "if (n < NAME_SIZE - 1) {"),
]

# Changes that change nothing: (part of the line, what it becomes, why).
SAME = [
    ("15.0 * time_constant", "cutoff_Hz > 1.0", "no cutoff between 0 and 1 Hz is in use"),
    ("offset_std_m = n > 1.0", "n >= 1.0", "of one frame: 0/0, not a number either way"),
    ("offset_std_m = n > 1.0", "fmax(1.0,", "a guard against rounding"),
    ("first > 0 && last > 0", "<= (double)max", "the count below refuses it too"),
    ("2 * *room : 32", ": 33", "how much room is taken first"),
    ("2 * *room : 32", "3 * *room", "how fast it grows"),
    ("l > 1 ? l : 1", "l >= 1", "1 either way"),
    ("l > 1 ? l : 1", "l < 1", "a search from further below for the same root"),
    ("l > 1 ? l : 1", "l > 2", "a search from further below for the same root"),
    ("stress = 0, slope", "stress = 1", "the stress of a step is looked at before"),
    ("fabs(off) <= limit", "fabs(off) < limit", "a point that is off by the limit to the last digit"),
    ("table->rows > 0 ? table->time_s[0]", "rows >= 0", "there is a row where a figure is drawn"),
    ("table->rows > 0 ? table->time_s[0]", ": 1.0", "there is a row where a figure is drawn"),
    ("table->rows > 0 ? table->time_s[0]", "rows > 1", "one sample is no line in time"),
    ("(unsigned char)*c >= ' '", "*c > ' '", "a blank becomes a blank"),
    ("(a->number > b->number)", "(a->number >= b->number)", "no two have one number"),
    ("field.length < 40", "< 41", "how many letters of a name a message has"),
]

SWAPS = {"<=": ["<", ">="], ">=": [">", "<="], "==": ["!="], "!=": ["=="], "&&": ["||"],
         "||": ["&&"], " < ": [" <= ", " > "], " > ": [" >= ", " < "], " + ": [" - "],
         " - ": [" + "], " * ": [" / "], " / ": [" * "]}


def code_of(line):
    """The line without its comment and texts, which keep their length."""
    line = re.sub(r'"(\\.|[^"\\])*"', lambda m: "_" * len(m.group()), line)
    return re.sub(r"//.*|/\*.*?(\*/|$)", lambda m: " " * len(m.group()), line)


def changes_of(line):
    """All lines that it may become."""
    code, out = code_of(line), []
    if code.lstrip().startswith(("#", "*", "static const")) or not code.strip():
        return out
    for old, news in SWAPS.items():
        for m in re.finditer(re.escape(old), code):
            wide = code[max(0, m.start() - 1):m.end() + 1]
            if old in ("<=", ">=") and wide.count("<") + wide.count(">") > 1:
                continue  # a shift
            out += [line[:m.start()] + new + line[m.end():] for new in news]
    for m in re.finditer(r"(?<![\w.])(\d+)(\.0)?(?![\w.])", code):
        if "[" + m.group() + "]" not in code:
            out.append(line[:m.start()] + str(int(m.group(1)) + 1) + (m.group(2) or "") +
                       line[m.end():])
    return out


def tests_of(path):
    return next((names.split() for part, names in OWN_TESTS if path.startswith(part)), None)


class Copy:
    """The source in a folder of its own, built there."""

    def __init__(self, root, folder, jobs, options):
        self.source, self.build = os.path.join(folder, "source"), os.path.join(folder, "build")
        self.jobs = str(jobs)
        os.makedirs(self.source, exist_ok=True)
        files = subprocess.run(["git", "-C", root, "ls-files"], check=True, capture_output=True,
                               text=True).stdout
        for name in files.split("\n")[:-1]:
            there = os.path.join(self.source, name)
            os.makedirs(os.path.dirname(there), exist_ok=True)
            shutil.copy2(os.path.join(root, name), there, follow_symlinks=False)
        self.run(["cmake", "-G", "Ninja", "-S", self.source, "-B", self.build,
                  "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-O0", "-DDEA_BUILD_TESTS=ON",
                  "-DDEA_LONG_TESTS=OFF"] + options)

    def run(self, command, seconds=3600):
        try:
            return subprocess.run(command, capture_output=True, timeout=seconds).returncode
        except subprocess.TimeoutExpired:
            return -1

    def make(self, tests):
        targets = ["test_" + t for t in tests] + [m for t in tests for m in MODULES.get(t, [])]
        return self.run(["ninja", "-C", self.build, "-j", self.jobs] + targets)

    def noticed_by(self, tests):
        """The first test that fails; None: none does."""
        for name in tests:
            if self.run([os.path.join(self.build, "tests", "test_" + name)], 300) != 0:
                return name
        return None


def try_change(copy, path, number, new):
    """"caught by NAME", "caught by the compiler" or "survived"."""
    file = os.path.join(copy.source, path)
    text = open(file).read()
    lines = text.split("\n")
    lines[number] = new
    tests = tests_of(path)
    with open(file, "w") as f:
        f.write("\n".join(lines))
    try:
        if copy.make(tests) != 0:
            return "caught by the compiler"
        name = copy.noticed_by(tests)
        return "caught by " + name if name else "survived"
    finally:
        with open(file, "w") as f:
            f.write(text)


def known_changes(root, inside):
    out = []
    for path, holds in KNOWN:
        if not path.startswith(tuple(inside)):
            continue
        lines = open(os.path.join(root, path)).read().split("\n")
        at = [i for i, line in enumerate(lines) if holds in line]
        if not at:
            sys.exit("%s: no line holds '%s': KNOWN is behind the source" % (path, holds))
        out += [(path, i, lines[i], new) for i in at for new in changes_of(lines[i])]
    return out


def drawn_changes(root, count, seed, inside):
    files = subprocess.run(["git", "-C", root, "ls-files"] + inside, check=True,
                           capture_output=True, text=True).stdout.split()
    r, out = random.Random(seed), []
    every = [(path, i, line, new) for path in files if path.endswith(".c") and tests_of(path)
             for i, line in enumerate(open(os.path.join(root, path)).read().split("\n"))
             for new in changes_of(line)]
    while every and len(out) < count:
        out.append(every.pop(r.randrange(len(every))))
    return out


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--known", action="store_true")
    p.add_argument("--sample", type=int, default=0)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--in", dest="inside", action="append")
    p.add_argument("--build")
    p.add_argument("--jobs", type=int, default=2)
    p.add_argument("--cmake", action="append", default=[], help="one more option: --cmake=-DX=Y")
    a = p.parse_args()
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    changes = known_changes(root, a.inside or ["src"]) if a.known else []
    changes += drawn_changes(root, a.sample, a.seed, a.inside or ["src"])
    copy = Copy(root, a.build or tempfile.mkdtemp(prefix="dea-mutants-"), a.jobs, a.cmake)
    tests = sorted({t for path, _, _, _ in changes for t in tests_of(path)})
    if copy.make(tests) != 0 or copy.noticed_by(tests):
        sys.exit("the tests do not pass as it is")
    counts = {"caught": 0, "survived": 0, "the same": 0}
    for path, number, old, new in changes:
        why = next((why for part, becomes, why in SAME if part in old and becomes in new), None)
        said = "the same: " + why if why else try_change(copy, path, number, new)
        counts[next(k for k in counts if said.startswith(k))] += 1
        print("%s:%d: %s\n    %s" % (path, number + 1, said, new.strip()), flush=True)
    print(", ".join("%d %s" % (n, k) for k, n in counts.items()))
    return counts["survived"] > 0


if __name__ == "__main__":
    sys.exit(main())
