#!/bin/sh
# 1,000 runs of `dea drive` on imitated supplies, each with a fault at a random moment: a page on
# stdout, and its figure in docs/figures. The imitations are parts of tests: it needs a build with
# tests in build/. COUNT=100 makes fewer runs.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
[ -x "$root/build/tests/test_lab_faults" ] && [ -x "$root/build/src/dea" ] || exit 77
exec python3 "$root/verify/drive_faults.py" "$root" "${COUNT:-1000}"
