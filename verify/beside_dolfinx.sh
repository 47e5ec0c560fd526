#!/bin/sh
# A free mesh of 300 k unknowns beside python3-dolfinx, and on two ranks, and the paper's actuator at equal
# error: a page on stdout. Called by scripts/verify with the folder of the build.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
/usr/bin/python3 -c 'import dolfinx' 2>/dev/null || {
  echo "python3-dolfinx is not here" >&2
  exit 77
}
export PYTHONDONTWRITEBYTECODE=1
/usr/bin/python3 "$root/verify/beside_dolfinx.py" "$1/src/dea" "$root"
exec /usr/bin/python3 "$root/verify/beside_dolfinx_tip.py" "$1/src/dea" "$root"
