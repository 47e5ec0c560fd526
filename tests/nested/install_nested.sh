#!/bin/sh
# Installs into a folder and uses what is there as a user would: a program built through pkg-config,
# the command, its data, its manual page.
#   install_nested.sh SOURCE BUILD - CMAKE_OPTION...
set -eu
source=$1 build=$2
shift 4
prefix=$build/prefix
rm -rf "$prefix"
cmake -G Ninja -S "$source" -B "$build" -DDEA_LONG_TESTS=OFF -DDEA_BUILD_BENCH=OFF \
  -DDEA_BUILD_VERIFY=OFF -DDEA_BUILD_TESTS=OFF -DCMAKE_C_FLAGS_RELEASE=-O2 -DCMAKE_INSTALL_PREFIX="$prefix" "$@"
cmake --build "$build"
cmake --install "$build" >/dev/null

library=$(dirname "$(find "$prefix" -name 'libdea.*' ! -name '*.pc' | head -n 1)")
PKG_CONFIG_PATH=$library/pkgconfig
LD_LIBRARY_PATH=$library
export PKG_CONFIG_PATH LD_LIBRARY_PATH

moved=$build/moved # another prefix than the one that was configured
rm -rf "$moved"
cmake --install "$build" --prefix "$moved" >/dev/null
there=$(dirname "$(find "$moved" -name libdea.pc)")
data=$(PKG_CONFIG_PATH=$there pkg-config --variable=datadir libdea)
[ "$(cd "$data" && pwd)" = "$moved/share/dea" ] || { echo "libdea.pc of $moved names $data"; exit 1; }
find "$prefix/include" -type f | grep -v '/include/dea\.h$' && { echo "more than dea.h was installed"; exit 1; }
# shellcheck disable=SC2046 # one argument a flag
cc -std=c17 -Wall -Wextra -Wpedantic -Werror "$source/examples/c/models.c" -o "$build/user" \
  $(pkg-config --cflags --libs libdea)
"$build/user" >"$build/models.txt"
grep -q '^model 3d: .*indent' "$build/models.txt" || { cat "$build/models.txt"; exit 1; }
if grep -q 'not installed' "$build/models.txt"; then
  echo "the library does not find the module of model 3d"
  exit 1
fi
# shellcheck disable=SC2046
cc -std=c17 "$source/examples/c/sweep.c" -o "$build/user-sweep" $(pkg-config --cflags --libs --static libdea)
"$build/user-sweep" "$source/examples/frdea-4.yaml" | grep ' 2000 V'
if command -v clang-14 >/dev/null 2>&1; then
  # shellcheck disable=SC2046
  printf '#include <dea.h>\nint main() { return dea_version() == nullptr; }\n' |
    clang-14 -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only $(pkg-config --cflags libdea) -
fi

# The MEX file, through pkg-config; a static library cannot be in one (its HDF5 is not made for it).
if [ -e "$library/libdea.so" ] && command -v mkoctfile >/dev/null 2>&1; then
  (cd "$prefix/share/dea/matlab" && env -u LD_LIBRARY_PATH octave-cli --no-init-file --eval \
    "dea_build; d = dea.Design('$source/examples/plain-disc.yaml'); r = dea.run(d); disp(r)")
fi

dea=$prefix/bin/dea
"$dea" --version
"$dea" materials >"$build/materials.txt"
[ -s "$build/materials.txt" ] || { echo "dea materials printed nothing"; exit 1; }
"$dea" examples >"$build/examples.txt" 2>/dev/null
grep -q '^frdea-4 ' "$build/examples.txt" || { echo "the example frdea-4 is missing"; exit 1; }
"$dea" doctor >"$build/doctor.txt"
cat "$build/doctor.txt"
for what in materials examples; do
  grep -q "^ok  *$what .* in $prefix/" "$build/doctor.txt" || {
    echo "dea takes its $what from elsewhere than the installed place"
    exit 1
  }
done
"$dea" examples frdea-4 >"$build/my.yaml"
"$dea" check "$build/my.yaml" >/dev/null
for file in share/man/man1/dea.1 share/bash-completion/completions/dea; do
  [ -s "$prefix/$file" ] || { echo "$file was not installed"; exit 1; }
done
echo installed and used
