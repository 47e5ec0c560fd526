#!/bin/sh
# Each header compiles alone as strict C17, and the whole interface as C++17; dea.h names every
# header that its headers include.
set -eu
source=$1 build=$2
flags="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Wvla -Werror"
includes="-I$source/src -I$build/src"
for folder in $DEA_INCLUDES; do
  includes="$includes -isystem $folder"
done
bad=0
for header in $(cd "$source/src" && find . -name '*.h' | sed 's|^\./||'); do
  # shellcheck disable=SC2086 # one argument a flag
  printf '#include "%s"\nextern int not_empty;\n' "$header" |
    "$CC" -std=c17 -x c $flags $includes -fsyntax-only - || {
    echo "src/$header does not compile alone"
    bad=1
  }
done
listed=$(sed -n 's/^#include "\(.*\)".*/\1/p' "$source/src/dea.h")
for header in $listed; do
  file=$source/src/$header
  [ -f "$file" ] || continue # made at configuration
  # shellcheck disable=SC2013 # a header has no white space in its name
  for needed in $(sed -n 's/^#include "\(.*\)".*/\1/p' "$file"); do
    printf '%s\n' "$listed" | grep -qxF "$needed" || {
      echo "src/dea.h lacks $needed, which $header includes"
      bad=1
    }
  done
done
if command -v clang-14 >/dev/null 2>&1; then
  printf '#include "dea.h"\nint main() { return dea_status_exit_code(DEA_OK); }\n' |
    clang-14 -std=c++17 -x c++ -Wall -Wextra -Werror "-I$source/src" "-I$build/src" -fsyntax-only - ||
    { echo "dea.h does not compile as C++17"; bad=1; }
fi
exit $bad
