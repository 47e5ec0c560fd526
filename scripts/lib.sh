# Common parts of the scripts; to be sourced. POSIX shell.
# shellcheck shell=sh

: "${root:?the caller sets it to the root of the repository}"

# say TEXT...: a line about what is going on, on stderr.
say() {
  printf '== %s\n' "$*" >&2
}

die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# packages SECTION...: the packages of these sections of packages.txt, one a line.
packages() {
  awk -v wanted=" $* " '
    /^\[/ { take = index(wanted, " " substr($0, 2, length($0) - 2) " ") > 0; next }
    /^[a-z0-9]/ && take { print $1 }' "$root/packages.txt"
}

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# as_root COMMAND...: runs it as root, if that can be done without a question where nobody answers.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    if [ -t 0 ]; then sudo "$@"; else sudo -n "$@"; fi
  else
    return 1
  fi
}

apt_install() {
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -q --no-install-recommends "$@" </dev/null >&2
}

# need SECTION...: installs what is missing of these sections; does nothing when all is there.
need() {
  if ! command -v dpkg-query >/dev/null 2>&1; then
    say "this is not Debian; these packages or their like are needed: $(packages "$@" | tr '\n' ' ')"
    return 0
  fi
  missing=
  for package in $(packages "$@"); do
    is_installed "$package" || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  say "installing:$missing"
  # The package lists may be empty or old, so a failure is tried once more with new ones.
  # shellcheck disable=SC2086 # one argument a package
  apt_install $missing || {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q </dev/null >&2 || true
    apt_install $missing
  } || die "could not install the packages; as root: apt-get install --no-install-recommends$missing"
}

# configure_release FOLDER [CMAKE OPTION...]: an optimised build there, still to be made; it is $build.
configure_release() {
  build=$1
  shift
  cmake -G Ninja -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release "$@" >&2
}

# build_release FOLDER [CMAKE OPTION...]: an optimised build there. What runs without tests has a
# folder of its own: the same one would leave old test programs behind that still pass.
build_release() {
  configure_release "$@"
  cmake --build "$build" >&2
}

# build_program: the command and what it opens, optimised, without tests, benchmarks and verification; it is $dea.
build_program() {
  say "building (build/release/)"
  configure_release "$root/build/release" -DDEA_BUILD_TESTS=OFF
  cmake --build "$build" --target dea >&2
  # shellcheck disable=SC2034 # for the caller
  dea=$build/src/dea
}
