#!/usr/bin/env bash
# Installs the Debian packages that Brickwall needs, and prints their names. Does nothing if all are
# installed; otherwise it needs apt-get, and sudo if not run as root.
#
#   cmake/install_packages.sh [--check] [--with-format] [--with-tidy]
#
# --check installs nothing and only prints the packages that are not installed. That may be right if
# the user provides the dependencies (modules, Spack).
set -euo pipefail

packages=(
  # toolchain
  g++ make cmake ninja-build git ca-certificates
  # unpacking Debian's Trilinos source package
  dpkg-dev patch
  # libraries
  libopenmpi-dev openmpi-bin libnetcdf-dev libhdf5-dev zlib1g-dev
  libtoml11-dev libcli11-dev nlohmann-json3-dev libgtest-dev
  # pictures and plots
  python3 python3-netcdf4 python3-matplotlib python3-pil
  # schemas, in tests
  python3-jsonschema
)
check_only=no
for option in "$@"; do
  case $option in
    --check) check_only=yes ;;
    --with-format) packages+=(clang-format) ;;
    --with-tidy) packages+=(clang-tidy libomp-dev) ;;
    *) echo "setup: unknown argument $option" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  # dpkg also knows packages that were removed or half installed: only the exact status counts.
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ "$status" == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

if [[ $check_only == yes ]]; then
  if command -v dpkg-query >/dev/null; then
    echo "setup: not installed as Debian packages, expected from elsewhere: ${missing[*]}"
  fi
  exit 0
fi
if ! command -v apt-get >/dev/null; then
  echo "setup: packages are missing and there is no apt-get to install them: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: neither root nor sudo; ask an administrator to run: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "setup: installing Debian packages: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
tries=0
until {
  "${as_root[@]}" env LC_ALL=C apt-get -qq update &&
    "${as_root[@]}" env LC_ALL=C DEBIAN_FRONTEND=noninteractive \
      apt-get -qq -y --no-install-recommends install "${missing[@]}" </dev/null
} >"$log" 2>&1; do
  # A machine that has just started may update itself at the same time.
  if ((++tries > 60)) || ! grep -q 'Could not get lock' "$log"; then
    echo "setup: apt-get failed:" >&2
    tail -n 20 "$log" >&2
    exit 1
  fi
  sleep 10
done
