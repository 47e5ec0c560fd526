#!/bin/sh
# libdea.so shows what dea.h declares, and that is what tests/exported_symbols.txt lists: a symbol that
# goes or comes is a decision, and the list is where it is made.
set -eu
source=$1
library=$DEA_SHARED_LIBRARY
[ -f "$library" ] || { echo "no shared library in this build"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
nm -D --defined-only "$library" | awk '{ print $3 }' | sort >"$scratch/exported"
sort "$source/tests/exported_symbols.txt" >"$scratch/listed"
sed -n '/\[declarations\]/,/\[end\]/p' "$source/src/api/dea.h" | tr '\n' ' ' | sed 's|/\*[^*]*\*/||g' |
  grep -oE 'dea_[a-z_]+\([^(]' | sed 's/(.*//' | sort -u >"$scratch/declared"
[ "$(wc -l <"$scratch/declared")" -gt 30 ] || { echo "hardly a declaration found: the check is broken"; exit 1; }
bad=0
diff "$scratch/listed" "$scratch/exported" ||
  { echo "exported symbols (>) are not those of tests/exported_symbols.txt (<)"; bad=1; }
diff "$scratch/declared" "$scratch/exported" ||
  { echo "exported symbols (>) are not those that dea.h declares (<)"; bad=1; }
# a module shows what it is opened for, that of the engine three things
for module in "$(dirname "$library")"/dea_*_module.so; do
  [ -f "$module" ] || continue
  name=$(basename "$module" .so)
  others=$(nm -D --defined-only "$module" | awk '$2 !~ /[Ww]/ { print $3 }' |
    grep -vxE "$name|dea_own_mesh|_edata|_end|__bss_start|_init|_fini" || true)
  [ -z "$others" ] || { echo "$name shows more than itself: $others"; bad=1; }
done
exit $bad
