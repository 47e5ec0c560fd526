#!/bin/sh
# ctest: solid
# Twenty random designs on a coarse mesh: what cannot be computed is said to be what it is. The share
# of "ours" is that of the day on which the test was written, and may only fall.
set -eu
command -v python3 >/dev/null || exit 77
exec python3 "$1/verify/random_designs.py" "$DEA_COMMAND" --count 20 --coarse --seconds 100 \
  --share 0.16
