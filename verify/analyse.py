#!/usr/bin/env python3
"""Static analysis: gcc -fanalyzer and clang-tidy 14. Exit 0 where neither finds anything.

    analyse.py [--changed] [--base BRANCH] [--only gcc|tidy] [--jobs N] [--build FOLDER] [FILE...]

FILE         files or folders of the source (src)
--changed    only files that differ from BRANCH (main), and what is not committed yet
--build      a configured build with compile_commands.json (build)

What clang-tidy looks for stands in .clang-tidy; a finding that is none is silenced at its place, by
NOLINT with the reason, and one of gcc by a line of FALSE below.
"""
import argparse
import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

# gcc 12 takes loops over arrays of three for ones that may set none; clang's analyser looks at that.
NOT_SET = "-Wno-analyzer-use-of-uninitialized-value"

# False findings of gcc 12: (file, warning, part of the source line, why it is none).
FALSE = [
    ("lab/src/import/import_mat.c", "-Wanalyzer-null-dereference", "type->", "open_module sets it or fails"),
    ("src/table/text_file.c", "-Wanalyzer-malloc-leak", "converter == (iconv_t)-1",
     "on that way none was opened"),
    ("src/geometry/dxf_text.c", "-Wanalyzer-malloc-leak", "return before + 4", "the same"),
    ("src/api/design.c", "-Wanalyzer-null-argument", "strlen(text)",
     "dea_design_text sets it or fails"),
    ("src/identify/fit.c", "-Wanalyzer-null-dereference", "lacking->", "known < rows: one lacks it"),
    ("src/job/device_fit_curves.c", "-Wanalyzer-null-dereference", "group->first",
     "each row of a curve is in a group"),
    ("src/io/results_h5.c", "-Wanalyzer-null-dereference", "run->", "made before or failed"),
    ("src/result/table.c", "-Wanalyzer-null-dereference", "quantity->header",
     "a table with that kind of column has quantities"),
    ("src/study/loading.c", "-Wanalyzer-null-dereference", "settings->voltages_V",
     "a design of that study has its settings"),
    ("src/study/states.c", "-Wanalyzer-null-dereference", "u[i] - v[i]",
     "films that were found have their shapes"),
    ("src/api/engine/own_mesh.c", "-Wanalyzer-null-dereference", "on[n]",
     "find_nodes sets it or fails"),
    ("src/model/solid_module.c", "-Wanalyzer-null-dereference", "type->",
     "a module that opened has its type"),
]


def commands(build):
    """The command of each source file, the first where several targets have it."""
    with open(os.path.join(build, "compile_commands.json")) as file:
        entries = json.load(file)
    out = {}
    for entry in entries:
        out.setdefault(os.path.relpath(entry["file"], ROOT), entry)
    return out


def changed(base):
    git = ["git", "-C", ROOT]
    names = subprocess.run(git + ["diff", "--name-only", "--merge-base", base], check=True,
                           capture_output=True, text=True).stdout
    names += subprocess.run(git + ["ls-files", "--others", "--exclude-standard"], check=True,
                            capture_output=True, text=True).stdout
    return [n for n in names.split("\n") if n.endswith(".c")]


def gcc(name, entry):
    words = shlex.split(entry["command"])
    words = words[1:] if "ccache" in words[0] else words
    keep = [w for w in words[1:] if w[:2] in ("-I", "-D", "-U", "-s") or w.startswith("-f")]
    for i, word in enumerate(words):
        keep += words[i:i + 2] if word == "-isystem" else []
    keep = [w for w in keep if not w.startswith("-fsanitize") and w != "-fno-sanitize-recover=all"]
    text = subprocess.run(["gcc", "-fanalyzer", NOT_SET, "-O1", "-S", "-o", os.devnull,
                           "-fdiagnostics-plain-output"] + keep + [entry["file"]],
                          cwd=entry["directory"], capture_output=True, text=True).stderr
    return [line for line in text.split("\n")
            if re.search(r": (warning|error|fatal error): ", line) and not is_false(name, line)]


def is_false(name, line):
    match = re.match(r"(.*?):(\d+):\d+: warning: .*\[(?:CWE-\d+\] \[)?(-W[\w-]+)\]$", line)
    if match is None:
        return False
    path = os.path.relpath(match.group(1), ROOT)
    with open(os.path.join(ROOT, path)) as file:
        source = file.read().split("\n")[int(match.group(2)) - 1]
    return any(path == at and match.group(3) == what and part in source
               for at, what, part, _ in FALSE)


def tidy(name, entry, build):
    text = subprocess.run(["clang-tidy-14", "-p", build, "--quiet", entry["file"]], cwd=ROOT,
                          capture_output=True, text=True).stdout
    return [line for line in text.split("\n") if re.search(r": (warning|error): ", line)]


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("files", nargs="*")
    p.add_argument("--changed", action="store_true")
    p.add_argument("--base", default="main")
    p.add_argument("--only", choices=["gcc", "tidy"])
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    p.add_argument("--build", default=os.path.join(ROOT, "build"))
    a = p.parse_args()
    known = commands(a.build)
    wanted = [os.path.relpath(os.path.abspath(f), ROOT) for f in a.files] or ["src", "lab/src"]
    names = [n for n in sorted(known)
             if any(n == w or n.startswith(w + "/") for w in wanted)]
    if a.changed:
        differ = set(changed(a.base))
        names = [n for n in names if n in differ]
    counts = 0
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        work = [pool.submit(gcc, n, known[n]) for n in names if a.only != "tidy"]
        work += [pool.submit(tidy, n, known[n], a.build) for n in names if a.only != "gcc"]
        for done in concurrent.futures.as_completed(work):
            for line in done.result():
                counts += 1
                print(line.replace(ROOT + "/", ""), flush=True)
    print("%d files, %d findings" % (len(names), counts))
    return counts > 0


if __name__ == "__main__":
    sys.exit(main())
