#!/bin/sh
# The command, the library and every module as built: position independent, addresses read-only and
# bound before main, no executable stack, marks on the stack. Checked copies where it is optimised.
set -eu
build=$2
command -v readelf >/dev/null || exit 77
if grep -q '^DEA_SANITIZE:[A-Z]*=.' "$build/CMakeCache.txt"; then
  echo "built with sanitizers, which bring their own checks"
  exit 77
fi
bad=0
say() { # FILE WHAT
  echo "$1: $2"
  bad=1
}
copies=0 files=0
for file in "$DEA_COMMAND" ${DEA_SHARED_LIBRARY:+"$DEA_SHARED_LIBRARY"} "$build"/src/*_module.so; do
  [ -e "$file" ] || continue
  files=$((files + 1))
  headers=$(readelf -Wld "$file")
  symbols=$(nm -D --undefined-only "$file")
  printf '%s' "$headers" | grep -q 'Elf file type is DYN' || say "$file" "not position independent"
  printf '%s' "$headers" | grep -q 'GNU_RELRO' || say "$file" "tables of addresses can be written to"
  printf '%s' "$headers" | grep -q 'BIND_NOW' || say "$file" "addresses are bound as it runs"
  printf '%s' "$headers" | grep -E 'GNU_STACK' | grep -q 'RWE' && say "$file" "the stack can be executed"
  printf '%s' "$symbols" | grep -q '__stack_chk_fail' || say "$file" "no marks on the stack"
  printf '%s' "$symbols" | grep -q '_chk\(@\|$\)' && copies=$((copies + 1))
done
[ "$files" -ge 2 ] || say "$build" "hardly anything was found: the check is broken"
if [ "$copies" -eq 0 ] && ! grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Debug' "$build/CMakeCache.txt"; then
  say "$build" "no checked copies (_FORTIFY_SOURCE)"
fi
exit $bad
