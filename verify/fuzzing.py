#!/usr/bin/env python3
"""Runs fuzz targets for a share of processor time each, and keeps count of it.

    fuzzing.py --build FOLDER --kept FOLDER --hours H [--jobs N] [--write] TARGET...

Each TARGET goes on from its seeds, from tests/fuzz/corpus, and from what earlier runs left in
KEPT/TARGET, in rounds of some minutes, until it has had its share of H hours of processor time; what
breaks it is KEPT/TARGET-crash-* (timeout-*, oom-*), and ends it unless the same input does nothing a
second time (one that took long because others had the machine). Prints a line a target and adds it to
KEPT/record.csv; the exit code is 1 if anything was found.

--write puts into tests/fuzz/corpus SMALL inputs of at most LARGEST bytes, of all sizes, among those that
reach all that is reached (-set_cover_merge). With --hours 0 it does only that.
"""
import argparse
import concurrent.futures
import csv
import datetime
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COLUMNS = ["date", "commit", "target", "processor_s", "inputs", "edges", "found"]
ROUND_S = 300  # by the clock
PATIENCE = 20  # a target that waits more than it works ends after this many times its share, by the clock
SMALL, LARGEST = 6, 4096
writing = threading.Lock()


def seeds(name):
    """The folders that a target begins from."""
    places = [os.path.join(ROOT, "tests", "fuzz", kind, name) for kind in ("seeds", "corpus")]
    return [p for p in places + [os.path.join(ROOT, "examples")] if os.path.isdir(p)]


def environment(name):
    """As in tests/fuzz/CMakeLists.txt."""
    env = dict(os.environ, LSAN_OPTIONS="print_suppressions=0:suppressions=" +
               os.path.join(ROOT, "tests", "lsan.supp"))
    if name == "import_mat":
        env["ASAN_OPTIONS"] = "allocator_may_return_null=1"
    return env


def run(args, name, options, log):
    """(processor seconds, exit status) of one call of the target."""
    program = os.path.join(args.build, "tests", "fuzz", "fuzz_" + name)
    with open(log, "wb") as out:
        child = subprocess.Popen([program] + options, stdout=out, stderr=subprocess.STDOUT,
                                 env=environment(name))
        ends = threading.Timer(10 * ROUND_S, child.kill)  # libFuzzer may wait for itself when it is told to end
        ends.start()
        _, status, used = os.wait4(child.pid, 0)
        ends.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
    return used.ru_utime + used.ru_stime, child.returncode


def breaks_again(args, name):
    """Whether one of the inputs that broke the target does so by itself; those that do not are removed."""
    found = False
    for file in sorted(os.listdir(args.kept)):
        if re.fullmatch(re.escape(name) + r"-(crash|timeout|oom|leak)-[0-9a-f]+", file):
            path = os.path.join(args.kept, file)
            _, status = run(args, name, ["-timeout=60", "-rss_limit_mb=2048", path], path + ".log")
            found = found or status != 0
            if status == 0:
                os.remove(path)
                os.remove(path + ".log")
    return found


def number(pattern, text):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def fuzz(args, name, share_s):
    """Rounds of one target; its row."""
    kept = os.path.join(args.kept, name)
    os.makedirs(kept, exist_ok=True)
    row = dict.fromkeys(COLUMNS, 0)
    row.update(date=datetime.date.today().isoformat(), commit=args.commit, target=name)
    begun = datetime.datetime.now()
    while row["processor_s"] < share_s and not row["found"]:
        elapsed = (datetime.datetime.now() - begun).total_seconds()
        if elapsed > PATIENCE * share_s:
            break
        left = max(share_s - row["processor_s"], 5)
        options = [f"-max_total_time={int(min(ROUND_S, left))}", "-timeout=60",
                   "-rss_limit_mb=2048", "-max_len=65536", "-print_final_stats=1",
                   f"-artifact_prefix={args.kept}/{name}-", kept] + seeds(name)
        log = os.path.join(args.kept, name + ".log")
        seconds, status = run(args, name, options, log)
        with open(log, encoding="utf-8", errors="replace") as lines:
            text = lines.read()
        row["processor_s"] += seconds
        row["inputs"] += number(r"stat::number_of_executed_units: *(\d+)", text)
        row["edges"] = max(row["edges"], number(r"cov: (\d+)", text))
        row["found"] = int(status != 0 and breaks_again(args, name))
    row["processor_s"] = round(row["processor_s"])
    with writing:
        print(f"{name}: {row['inputs']} inputs in {row['processor_s']} s of processor time, "
              f"{row['edges']} edges, {len(os.listdir(kept))} kept" +
              (f"; FOUND something: {args.kept}/{name}-*" if row["found"] else ""), flush=True)
        add(os.path.join(args.kept, "record.csv"), [row])
    return row


def add(path, rows):
    new = not os.path.exists(path)
    with open(path, "a", newline="", encoding="utf-8") as out:
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        if new:
            table.writeheader()
        table.writerows(rows)


def keep_small(args, name):
    """Some inputs of a cover, of all sizes, go into the repository."""
    home = os.path.join(ROOT, "tests", "fuzz", "corpus", name)
    with tempfile.TemporaryDirectory() as cover:
        options = ["-set_cover_merge=1", "-rss_limit_mb=2048", "-max_len=65536", cover,
                   os.path.join(args.kept, name)] + [p for p in seeds(name) if p != home]
        options += [home] if os.path.isdir(home) else []
        _, status = run(args, name, options, os.path.join(args.kept, name + "-merge.log"))
        inputs = [(os.path.getsize(os.path.join(cover, f)), f) for f in os.listdir(cover)]
        inputs = sorted(i for i in inputs if 0 < i[0] <= LARGEST)
        step = max(len(inputs) / SMALL, 1)
        inputs = [inputs[int((k + 1) * step) - 1] for k in range(int(len(inputs) / step + 1e-9))]
        if status != 0 or not inputs:
            print(f"{name}: the corpus is left as it is (merge ended with {status})", file=sys.stderr)
            return
        shutil.rmtree(home, ignore_errors=True)
        os.makedirs(home)
        for _, file in inputs:
            shutil.copyfile(os.path.join(cover, file), os.path.join(home, file))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True)
    parser.add_argument("--kept", required=True)
    parser.add_argument("--hours", type=float, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("targets", nargs="+", metavar="TARGET")
    args = parser.parse_args()
    args.commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], check=True,
                                 capture_output=True, text=True).stdout.strip()
    share_s = 3600 * args.hours / len(args.targets)
    rows = []
    if share_s > 0:
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            rows = list(pool.map(lambda name: fuzz(args, name, share_s), args.targets))
    if args.write:
        for name in args.targets:
            keep_small(args, name)
    sys.exit(any(row["found"] for row in rows))


if __name__ == "__main__":
    main()
