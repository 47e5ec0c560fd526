#!/bin/sh
# The Python package by pip, without a network, into a folder of its own; used from there.
set -eu
source=$1 build=$2
python=/usr/bin/python3
$python -c "import setuptools, pip, wheel, cffi, numpy" 2>/dev/null || exit 77
[ -f "$build/src/libdea.so" ] || exit 77
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
mkdir -p "$scratch/source/src/api"
cp -r "$source/python" "$scratch/source/"
cp "$source/src/api/dea.h" "$scratch/source/src/api/"
$python -m pip install --quiet --no-index --no-build-isolation --no-deps --no-warn-script-location \
  --root-user-action=ignore --target "$scratch/site" "$scratch/source/python"
cd "$scratch"
DEA_LIBRARY=$build/src/libdea.so PYTHONPATH=$scratch/site $python -c "
import dea
assert dea.__file__.startswith('$scratch/site'), dea.__file__
assert 'lumped' in dea.models()
print('dea', dea.version())"
