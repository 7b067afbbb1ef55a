#!/usr/bin/env bash
# Installs the Debian packages that Brickwall builds with. Says what it installs; asks for nothing
# when everything is there. Needs apt-get (and sudo when not root) only if something is missing.
set -euo pipefail

packages=(
  # toolchain
  g++ make cmake ninja-build git ca-certificates
  # unpacking Debian's Trilinos source package
  dpkg-dev patch
  # libraries
  libopenmpi-dev openmpi-bin libnetcdf-dev libhdf5-dev zlib1g-dev
  libtoml11-dev libcli11-dev nlohmann-json3-dev libgtest-dev
  # the picture of the wall
  python3 python3-netcdf4 python3-matplotlib
)
if [[ "${1:-}" == "--with-format" ]]; then
  packages+=(clang-format)
fi

missing=()
for package in "${packages[@]}"; do
  # A virtual or pre-release state is not "installed": ask dpkg for the exact status.
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ "$status" == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

if ! command -v apt-get >/dev/null; then
  echo "setup: these packages are missing and there is no apt-get to install them: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: not root and no sudo; ask an administrator for: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "setup: installing Debian packages: ${missing[*]}"
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get -qq -y --no-install-recommends install "${missing[@]}" </dev/null >/dev/null
