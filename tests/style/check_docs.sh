#!/bin/sh
# Files of the source that the docs name exist, and so do files that they link to.
set -eu
cd "$1"
list=$(
  for page in *.md docs/*.md docs/*/*.md lab/docs/*.md; do
    [ "$page" = CHANGELOG.md ] && continue # it tells the past
    grep -oE '(lab/src|lab/tests|lab/examples|src|tests|benchmarks|verify|scripts|examples|cmake|web|matlab)/[A-Za-z0-9_./-]*[*<]?' "$page" |
      grep -v '[*<]$' | sed "s|[.-]*\$||; s|^|$page .|; s| \\.| |" || true
    grep -oE '\]\([^)#: ]+[)#]' "$page" | sed "s/^](//; s/[)#]\$//; s|^|$page $(dirname "$page")/|" || true
  done | sort -u
)
[ -n "$list" ] || { echo "no path found: the check is broken"; exit 1; }
# One version: CMake's, the Python package's, and the newest of the changelog.
version=$(sed -n 's/^project(libdea VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
grep -qx "version = \"$version\"" python/pyproject.toml || { echo "python/pyproject.toml: not version $version"; exit 1; }
grep -m 1 '^## ' CHANGELOG.md | grep -q "^## $version " || { echo "CHANGELOG.md does not begin with $version"; exit 1; }
# The program of docs/api.md is the example that is compiled and run.
# shellcheck disable=SC2016 # the fences of Markdown
sed -n '/^```c$/,/^```$/p' docs/api.md | grep -v '^```' | diff - examples/c/sweep.c ||
  { echo "the C program of docs/api.md is not examples/c/sweep.c"; exit 1; }
# Each test that the safety case names is a test of that file.
awk '/^\|.*`test_/ {
  file = ""
  n = split($0, part, "`")
  for (i = 2; i <= n; i += 2) {
    if (split(part[i], at, ": ") == 2) { file = at[1]; name = at[2] } else { name = part[i] }
    if (name ~ /^test_[a-z0-9_]*$/) { print file, name }
  }
}' lab/docs/safety.md | {
  count=0
  while read -r file name; do
    count=$((count + 1))
    grep -Eq "(unit_test[a-z_]*|TEST)\\(${name}[,)]" tests/*/"$file" "lab/tests/$file" 2>/dev/null || { echo "lab/docs/safety.md: $file has no test $name"; exit 1; }
  done
  [ "$count" -gt 20 ] || { echo "hardly any test found in lab/docs/safety.md: the check is broken"; exit 1; }
}
printf '%s\n' "$list" | {
  bad=0
  while read -r page path; do
    if [ ! -e "$path" ]; then
      echo "$page: $path is not there"
      bad=1
    fi
  done
  exit $bad
}
