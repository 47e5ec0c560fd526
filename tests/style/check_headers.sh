#!/bin/sh
# Each header compiles alone as strict C17, no two define a struct of one name, and the public one
# compiles as its users compile it.
set -eu
source=$1 build=$2
flags="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wstrict-prototypes -Wvla -Werror"
includes="-I$source/src -I$build/src -I$source/lab/src"
for folder in $DEA_INCLUDES; do
  includes="$includes -isystem $folder"
done
bad=0
# None has changed since all were good: that takes ten seconds.
good=$build/check_headers.good headers=.
[ -e "$good" ] &&
  [ -z "$(find "$0" "$source/src" "$source/lab/src" "$build/src" -newer "$good" \( -name '*.h' -o -name '*.sh' \))" ] &&
  headers=
touch "$good.new"
for header in $([ -z "$headers" ] || { cd "$source" && find src lab/src -name '*.h' | sed 's|.*src/||'; }); do
  # shellcheck disable=SC2086 # one argument a flag
  printf '#include "%s"\nextern int not_empty;\n' "$header" |
    "$CC" -std=c17 -x c $flags $includes -fsyntax-only - || {
    echo "$header does not compile alone"
    bad=1
  }
done
# One name, one struct; the public header is a world of its own.
twice=$(cd "$source" && find src lab/src -name '*.h' ! -path src/api/dea.h -exec grep -hoE '^(struct|enum|union) [a-z_0-9]+ \{' {} + | sort | uniq -d)
if [ -n "$twice" ]; then
  echo "defined in two headers: $twice"
  bad=1
fi
# The public one, as users compile it: alone and twice in a file, in C and in C++; and without macros, for
# wrappers that read the declarations between its marks.
flags="-Wall -Wextra -Wpedantic -Werror -fsyntax-only -I$source/src/api"
user='#include <dea.h>
#include <dea.h>
int main(void) { return dea_version() == 0; }'
# shellcheck disable=SC2086
printf '%s\n' "$user" | "$CC" -std=c99 -x c $flags - || { echo "dea.h does not compile as C99"; bad=1; }
for compiler in c++ clang++-14; do
  if command -v $compiler >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    printf '%s\n' "$user" | $compiler -std=c++11 -x c++ $flags - || {
      echo "dea.h does not compile with $compiler"
      bad=1
    }
  fi
done
declarations=$(sed -n '/\[declarations\]/,/\[end\]/p' "$source/src/api/dea.h")
[ "$(printf '%s\n' "$declarations" | grep -c '(.*);')" -gt 30 ] || {
  echo "no declarations between the marks of dea.h: the check is broken"
  bad=1
}
if printf '%s\n' "$declarations" | grep -n '^ *#'; then
  echo "dea.h has a line of the preprocessor between its marks"
  bad=1
fi
[ $bad -ne 0 ] || mv "$good.new" "$good"
exit $bad
