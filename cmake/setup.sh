#!/usr/bin/env bash
# Makes everything ready to run: packages, the cached Trilinos, configuration and build of one preset. Does only what
# is not done yet, and prints one line for each thing that it does; the rest goes to setup.log in the build folder.
#
#   cmake/setup.sh [--preset NAME] [--target TARGET] [--with-format]
#
# Preset "default" is built in build/, any other in build-NAME/. TARGET defaults to everything.
#
# A Kokkos of the user's own is taken from Kokkos_ROOT, Kokkos_DIR or CMAKE_PREFIX_PATH in the environment, or from a
# build folder that was configured by hand. Then nothing is downloaded, and packages are only checked for.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=default
target=all
package_options=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --preset) preset=$2; shift 2 ;;
    --target) target=$2; shift 2 ;;
    --with-format) package_options+=(--with-format); shift ;;
    *) echo "setup: unknown argument $1" >&2; exit 2 ;;
  esac
done
build=build
[[ $preset == default ]] || build=build-$preset
log=$build/setup.log

say() { echo "setup: $*"; }
fail() {
  echo "setup: $1; the last lines of $PWD/$log:" >&2
  tail -n 40 "$log" >&2
  exit 1
}

cached() { # the value of a variable in the build folder's CMake cache
  sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt" 2>/dev/null || true
}
cache_folder=${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}

# Where the user keeps a Kokkos of his own; fails if there is none.
users_kokkos() {
  if [[ -n ${Kokkos_ROOT:-} || -n ${Kokkos_DIR:-} ]]; then
    echo "${Kokkos_ROOT:-$Kokkos_DIR}"
    return
  fi
  local folder folders
  IFS=: read -r -a folders <<<"${CMAKE_PREFIX_PATH:-}"
  for folder in ${folders[@]+"${folders[@]}"}; do
    if compgen -G "$folder/lib*/cmake/Kokkos/KokkosConfig.cmake" >/dev/null ||
      compgen -G "$folder/lib/*/cmake/Kokkos/KokkosConfig.cmake" >/dev/null; then
      echo "$folder"
      return
    fi
  done
  # Configured by hand: no note of ours beside the CMake cache.
  folder=$(cached Kokkos_DIR)
  if [[ -n $folder && ! -e $build/setup.dependencies && $folder != "$cache_folder"/* ]]; then
    echo "$folder"
    return
  fi
  return 1
}

if dependencies=$(users_kokkos); then
  cmake/install_packages.sh --check "${package_options[@]}"
else
  cmake/install_packages.sh "${package_options[@]}"
  dependencies=$(cmake/build_trilinos.sh)
  export CMAKE_PREFIX_PATH=$dependencies${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}
fi

# CMake remembers where it found a package, so other dependencies need a fresh start.
mkdir -p "$build"
if [[ -e $build/setup.dependencies && $(<"$build/setup.dependencies") != "$dependencies" ]]; then
  rm -rf "$build/CMakeCache.txt" "$build/CMakeFiles"
fi
if [[ ! -e $build/build.ninja || ! -e $build/CMakeCache.txt || CMakePresets.json -nt $build/CMakeCache.txt ]]; then
  say "configuring $build/ (preset $preset, Kokkos from $dependencies)"
  cmake --preset "$preset" >"$log" 2>&1 || fail "configuration failed"
  touch "$build/CMakeCache.txt"
  [[ -n $(cached Kokkos_DIR) ]] && echo "$dependencies" >"$build/setup.dependencies"
fi

# Lines of a build go to the log; now and then one is told: on a terminal in place, else as a line every ten seconds or so.
tell_progress() {
  local line steps last=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    [[ $line =~ ^\[[0-9]+/[0-9]+\] ]] || continue
    steps=${BASH_REMATCH[0]}
    if [[ -t 1 ]]; then
      printf '\rsetup: %s\033[K' "$steps"
    elif ((SECONDS - last >= 10)); then
      say "$steps"
      last=$SECONDS
    fi
  done
  [[ ! -t 1 ]] || printf '\r\033[K'
}

# One compiler takes up to 1.5 GB.
cores=$(nproc)
fitting=$(awk '/^MemAvailable/ { print int($2 / 1.5e6) }' /proc/meminfo 2>/dev/null || echo "$cores")
jobs=$((fitting < cores ? fitting : cores))
jobs=$((jobs < 1 ? 1 : jobs))
# A few steps only note the commit and link anew; they are not worth a line.
plan=$(ninja -C "$build" -n "$target" 2>&1 || true)
if [[ $plan != *"no work to do"* ]]; then
  steps=$(sed -n 's#^\[[0-9]*/\([0-9]*\)\].*#\1#p' <<<"$plan" | tail -n 1)
  [[ ${steps:-99} -le 5 && $plan != *"Re-running CMake"* ]] || say "building $build/ ($jobs at a time)"
  : >"$log"
  cmake --build "$build" --target "$target" --parallel "$jobs" 2>&1 | tell_progress || fail "the build failed"
fi
