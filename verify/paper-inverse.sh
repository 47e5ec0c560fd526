#!/bin/sh
# The paper's measurements read backwards: a page on stdout. Called by scripts/verify with the folder
# of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
exec env PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 "$root/verify/paper_inverse.py" "$1/src/dea" "$root"
