#!/usr/bin/env python3
"""Lines and branches of src/ and lab/src/ that were reached, by folder, from what gcov counted.

    coverage.py --build FOLDER [--files N]

Reads every .gcno below FOLDER/src and FOLDER/lab by `gcov --json-format`; a source that several targets compile
counts where any of them reached it, and one that no program ran counts as not reached. Prints a table, and the N files (10) with most lines that were not.
"""
import argparse
import collections
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
ROOMS = ("src/model/solid",)  # told room by room


def counted(build):
    """One gcov file of JSON after the other."""
    found = []
    for part in ("src", "lab"):
        for folder, _, names in os.walk(os.path.join(build, part)):
            found += [os.path.join(folder, n) for n in names if n.endswith(".gcno")]
    for i in range(0, len(found), 50):
        text = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities"] +
                              found[i:i + 50], cwd=build, check=True, capture_output=True,
                              text=True).stdout
        for line in text.split("\n"):
            if line.startswith("{"):
                yield json.loads(line)


class Source:
    def __init__(self):
        self.lines = collections.Counter()
        self.branches = collections.Counter()

    def add(self, lines):
        for line in lines:
            n = line["line_number"]
            self.lines[n] += line["count"]
            for k, branch in enumerate(line["branches"]):
                self.branches[n, k] += branch["count"]

    def missed(self):
        return sum(c == 0 for c in self.lines.values())


def sources(build):
    out = collections.defaultdict(Source)
    for one in counted(build):
        for file in one["files"]:
            path = os.path.realpath(os.path.join(one["current_working_directory"], file["file"]))
            path = os.path.relpath(path, ROOT)
            if path.startswith(("src/", "lab/src/")):
                out[path].add(file["lines"])
    return out


def folder_of(path):
    parts = path.split("/")
    if parts[0] == "lab":
        return "lab/" + parts[2]
    for room in ROOMS:
        if path.startswith(room + "/"):
            depth = room.count("/") + 2
            return "/".join(parts[1:depth]) if len(parts) > depth else room[4:]
    return parts[1] if len(parts) > 2 else "src"


def share(counts):
    return "%.1f" % (100.0 * sum(c > 0 for c in counts) / len(counts)) if counts else ""


def table(all_sources):
    folders = collections.defaultdict(list)
    for path, source in all_sources.items():
        folders[folder_of(path)].append(source)
        folders[""].append(source)
    rows = ["| folder | lines | reached % | branches | reached % |", "|---|---|---|---|---|"]
    for name in sorted(folders, key=lambda n: (n == "", n)):
        lines = [c for s in folders[name] for c in s.lines.values()]
        branches = [c for s in folders[name] for c in s.branches.values()]
        rows.append("| %s | %d | %s | %d | %s |" % ("`%s`" % name if name else "all", len(lines),
                                                    share(lines), len(branches), share(branches)))
    return "\n".join(rows)


def least(all_sources, count):
    rows = ["| file | lines not reached | of |", "|---|---|---|"]
    worst = sorted(all_sources, key=lambda p: (-all_sources[p].missed(), p))[:count]
    rows += ["| `%s` | %d | %d |" % (p, all_sources[p].missed(), len(all_sources[p].lines))
             for p in worst]
    return "\n".join(rows)


def main():
    p = argparse.ArgumentParser(description=__doc__,
                                formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--build", required=True)
    p.add_argument("--files", type=int, default=10)
    a = p.parse_args()
    found = sources(os.path.abspath(a.build))
    if not found:
        sys.exit("no .gcno below %s/src: it was not built with --coverage" % a.build)
    text = table(found) + "\n"
    if a.files > 0:
        text += "\nMost lines that no test of the selection reaches:\n\n" + \
            least(found, a.files) + "\n"
    print(text)


if __name__ == "__main__":
    sys.exit(main())
