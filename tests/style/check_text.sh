#!/bin/sh
# No file of the project names a folder of somebody's machine, ends lines in white space or with a
# carriage return, or lacks its last line end; but for those that are as other programs wrote them.
set -eu
cd "$1"
files() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files
  else
    find . \( -name .git -o -path './build*' -o -path ./runs -o -name '*.run' \) -prune -o -type f -print
  fi
}
texts=$(files | grep -vE '\.(png|gif|pdf|h5|mat|tdms|gdp)$|(^|/)(corpus|cases)/' | xargs ls -d 2>/dev/null)
[ -n "$texts" ] || { echo "no file found: the check is broken"; exit 1; }
bad=0
# A temporary file by mkstemp or mkdtemp (XXXXXX) is meant to lie in the machine's folder for them,
# which is the fallback for TMPDIR.
# shellcheck disable=SC2086 # one argument a file
if grep -nE '(^|[^A-Za-z0-9_.$}/])/(wor[k]|roo[t]|hom[e]|tm[p]|mn[t]|Users)(/|"|$)' $texts |
  grep -vE 'XXXXXX|: "/tm[p]"'; then
  echo "^ folders of a machine"
  bad=1
fi
# shellcheck disable=SC2046,SC2086
if grep -nE "[ 	]+\$|$(printf '\r')\$" $(printf '%s\n' $texts | grep -v '\.svg$'); then
  echo "^ white space at line ends"
  bad=1
fi
# A whole file is one record of grep -z. An empty one has none.
# shellcheck disable=SC2013,SC2086
for file in $(grep -LzP '\n\z' $texts); do
  if [ -s "$file" ]; then
    echo "$file: no line end at its end"
    bad=1
  fi
done
exit $bad
