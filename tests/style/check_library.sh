#!/bin/sh
# The library as built: it exports dea_* only, keeps no global mutable state, and calls nothing that
# prints to the user or ends the program.
set -eu
library=$DEA_LIBRARY
lab=$DEA_LAB_LIBRARY
bad=0
report() { # TEXT SYMBOLS
  if [ -n "$2" ]; then
    echo "$1:"
    printf '%s\n' "$2" | sed 's/^/  /'
    bad=1
  fi
}
symbols=$(nm --format=posix "$library" ${lab:+"$lab"} 2>/dev/null)
[ "$(printf '%s\n' "$symbols" | grep -c '^dea_')" -gt 10 ] || {
  echo "hardly any symbol found in $library: the check is broken"
  exit 1
}
report "exported names that do not start with dea_" \
  "$(printf '%s\n' "$symbols" | awk '$2 ~ /^[TDBRVWCGS]$/ && $1 !~ /^dea_/ && $1 !~ /^_(init|fini)$/ { print $1 }')"
report "calls that print or end the program" "$(printf '%s\n' "$symbols" | awk '$2 == "U" { print $1 }' |
  grep -xE '(v?printf|puts|putchar|perror|warnx?|errx?|exit|_Exit|quick_exit|abort|__assert_fail|stdout|stderr|__printf_chk|__vprintf_chk|psignal|system)(@.*)?' |
  sort -u)"
# Tables of pointers lie in .data.rel.ro, which is read-only once the program runs. A *_lock is a
# mutex around a packaged library that has global state of its own.
report "variables that can change (global or static)" \
  "$(objdump -t "$library" ${lab:+"$lab"} | grep -E ' \.(data|bss|tdata|tbss)(\.[^[:space:]]*)?[[:space:]]' |
    grep -vE ' \.data\.rel\.ro|completed\.0$|__dso_handle$|_lock$' | awk '$(NF - 1) !~ /^0+$/ { print $NF }')"
exit $bad
