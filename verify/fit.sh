#!/bin/sh
# dea fit beside python3-lmfit and python3-emcee, on the same data and laws: a page on stdout. Called
# by scripts/verify with the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
/usr/bin/python3 -c 'import emcee, lmfit' 2>/dev/null || {
  echo "python3-lmfit or python3-emcee is not here" >&2
  exit 77
}
exec env PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 "$root/verify/fit_lmfit.py" "$1/src/dea" "$root"
