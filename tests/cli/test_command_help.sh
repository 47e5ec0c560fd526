#!/bin/sh
# ctest: quick, heavy
# examples, doctor, completion and the manual page, used as a user would.
set -u
source=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PATH=$(dirname "$DEA_COMMAND"):$PATH
failed=0
# expect CODE WHAT COMMAND...: its exit code; output is left in $folder/out and $folder/err.
expect() {
  wanted=$1 what=$2
  shift 2
  "$@" >"$folder/out" 2>"$folder/err" </dev/null
  code=$?
  if [ "$code" -ne "$wanted" ]; then
    echo "$what: exit code $code, wanted $wanted"
    cat "$folder/err"
    failed=1
  fi
}
# has FILE TEXT: the output has this text.
has() {
  grep -qF -- "$2" "$folder/$1" || {
    echo "'$2' is missing in: $(head -c 2000 "$folder/$1")"
    failed=1
  }
}

# examples
expect 0 "list of examples" dea examples
has out frdea-4
expect 0 "one example" dea examples frdea-4
cmp -s "$folder/out" "$source/examples/frdea-4.yaml" || { echo "frdea-4 differs"; failed=1; }
expect 0 "an example in a folder, by its last name" dea examples fig02.yaml
cmp -s "$folder/out" "$source/examples/paper/fig02.yaml" || { echo "fig02 differs"; failed=1; }
for example in "$source"/examples/*.yaml "$source"/examples/paper/*.yaml; do
  expect 0 "example ${example##*/}" dea check "$example"
done
expect 2 "unknown example" dea examples frdea-5
has err "did you mean 'frdea-4'?"
expect 2 "unknown option" dea examples --all
expect 2 "--copy without a folder" dea examples --copy
expect 2 "two names" dea examples frdea-4 frdea-8
expect 0 "copy" dea examples --copy "$folder/new/deep"
cmp -s "$folder/new/deep/paper/fig02.yaml" "$source/examples/paper/fig02.yaml" ||
  { echo "the copy differs"; failed=1; }
for example in silicone breakdown device; do # with the measurements that they name
  expect 0 "copy of fit/$example" dea fit "$folder/new/deep/fit/$example.yaml" -o "$folder/$example.fit"
done
expect 5 "copy over what is there" dea examples --copy "$folder/new/deep"
has err "--force"
expect 0 "copy by force" dea examples --force --copy "$folder/new/deep"
echo x >"$folder/file"
expect 5 "copy into a file" dea examples --copy "$folder/file"

# the designs in the README and on the page of devices are valid ones
for page in README.md docs/devices.md; do
  awk -v to="$folder/page-" '/^```/ { inside = /yaml/; count += inside; next }
    inside { print >(to count ".yaml") }' "$source/$page"
  for design in "$folder"/page-*.yaml; do
    expect 0 "design of $page" dea check "$design"
  done
  rm "$folder"/page-*.yaml
done

# the tables that scripts/docs puts into the pages
grep -h '^<!-- dea ' "$source"/docs/*.md >"$folder/tables"
while read -r _ _ arguments; do
  # shellcheck disable=SC2086 # one argument a word
  expect 0 "table of $arguments" dea ${arguments% -->}
  has out "|---|---|"
done <"$folder/tables"
[ "$(grep -c . "$folder/tables")" -gt 6 ] || { echo "hardly any table in docs/"; failed=1; }

# doctor
expect 0 "doctor" dea doctor
has out "HDF5"
has out "materials"
expect 2 "doctor with an argument" dea doctor now

# completion: what bash offers for a command line that ends in the word to be completed; the lines
# are gathered, and one bash completes them all
offers() { # TEXT WORD...: among the offers
  echo "$*" >>"$folder/lines"
}
offers examples dea exa
offers --copy dea examples --c
offers frdea-4 dea examples fr
offers bash dea completion b
offers axisymmetric dea run a.yaml --model a
offers convergence dea run a.yaml --study c
offers film.thickness dea run a.yaml --set film
offers mode_shapes dea plot a.run --figure mode
offers fibre_tip_z_m dea compare a b --quantity fibre
offers pdf dea plot a.run --format p
if ! dea import --help | grep -q 'Not in this build'; then
  offers rate dea drive a.yaml --set r
  offers tdms dea import a.dat --format t
fi
offers vhb-4910 dea materials v
cd "$folder" || exit 1
offers new dea examples --copy ne
expect 0 "completion man" dea completion man
mv out man
expect 2 "completion of an unknown shell" dea completion fish
expect 0 "help" dea --help
mv out help
expect 0 "names" dea completion names commands
mv out commands
while read -r command; do
  offers "$command" dea "$command"
  # Each long option of the help text is offered.
  expect 0 "help on $command" dea "$command" --help
  sed '1,2d' out | awk '/^$/ { prose = 1 } !prose || /^ +-/' | sed 's/  [A-Za-z].*//' |
    grep -oE -- '--[a-z][a-z-]*' | sort -u | while read -r option; do
    offers "$option" dea "$command" "$option"
  done
  grep -qE "^  $command +[A-Z]" help || { echo "$command: no capital in --help"; failed=1; }
  grep -qx "\.Ss $command" man || { echo "the manual lacks $command"; failed=1; }
done <commands
cat >complete.bash <<'END'
source <(dea completion bash)
compopt() { :; }
while read -r text words; do
  read -ra COMP_WORDS <<<"$words"
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  COMPREPLY=()
  _dea
  printf '%s\n' "${COMPREPLY[@]}" | grep -qxF -- "$text" ||
    echo "completion of '$words' lacks '$text': ${COMPREPLY[*]}"
done <lines
END
expect 0 "completion in bash" bash complete.bash
if [ -s out ] || [ -s err ]; then
  cat out err
  failed=1
fi
expect 0 "help on a command" dea help run
has out "Usage: dea run"
has man ".It Fl q , Fl -quiet"
# Output that is lost is a failure; a closed one is not wanted.
cp "$source/examples/frdea-4.yaml" "$folder/a.yaml"
expect 5 "a full disk" sh -c 'dea check a.yaml >/dev/full'
has err "standard output could not be written"
expect 5 "a full disk" sh -c 'dea schema >/dev/full'
expect 0 "no output" sh -c 'dea schema >&-'
expect 2 "completion for an unknown shell" dea completion tcsh
expect 2 "completion without a shell" dea completion
exit $failed
