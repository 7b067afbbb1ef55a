#!/usr/bin/env bash
# Installs packages, builds the cached Trilinos, configures and builds one preset. Skips the parts
# that are done, and prints one line for each part that it does; all other output goes to setup.log
# in the build folder.
#
#   cmake/setup.sh [--preset NAME] [--target TARGET] [--with-format]
#
# The preset "default" is built in build/, any other in build-NAME/. TARGET defaults to all.
#
# The user may provide a Kokkos by Kokkos_ROOT, Kokkos_DIR or CMAKE_PREFIX_PATH in the environment,
# or by a build folder that was configured without this script. Packages are checked then, but not
# installed, and Zoltan and SEACAS are built unless the user provides them in the same ways.
set -euo pipefail
[[ -z ${BRICKWALL_CACHE:-} ]] || BRICKWALL_CACHE=$(realpath -m "$BRICKWALL_CACHE")
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
if ! grep -qsF "\"name\": \"$preset\"" CMakePresets.json CMakeUserPresets.json; then
  echo "setup: found no preset \"$preset\" in CMakePresets.json; cmake --list-presets names them" >&2
  exit 2
fi
build=build
[[ $preset == default ]] || build=build-$preset
log=$build/setup.log

say() { echo "setup: $*"; }
fail() {
  echo "setup: $1; the last lines of $PWD/$log:" >&2
  tail -n 40 "$log" >&2
  exit 1
}

cached() { # the value of a variable in the CMake cache of the build folder
  sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt" 2>/dev/null || true
}
cache_folder=${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}

# users PACKAGE: prints the location of a package that the user provides; fails if there is none.
users() {
  local root=$1_ROOT dir=$1_DIR folder folders
  if [[ -n ${!root:-} || -n ${!dir:-} ]]; then
    echo "${!root:-${!dir}}"
    return
  fi
  IFS=: read -r -a folders <<<"${CMAKE_PREFIX_PATH:-}"
  for folder in ${folders[@]+"${folders[@]}"}; do
    if compgen -G "$folder/lib*/cmake/$1/$1Config.cmake" >/dev/null ||
      compgen -G "$folder/lib/*/cmake/$1/$1Config.cmake" >/dev/null; then
      echo "$folder"
      return
    fi
  done
  # Configured without this script, which leaves setup.dependencies beside the CMake cache.
  folder=$(cached "$1_DIR")
  if [[ -d $folder && ! -e $build/setup.dependencies && ($1 != Kokkos || $folder != "$cache_folder"/*) ]]; then
    echo "$folder"
    return
  fi
  return 1
}

if dependencies=$(users Kokkos); then
  cmake/install_packages.sh --check ${package_options[@]+"${package_options[@]}"}
  if ! { users Zoltan && users SEACASExodus; } >/dev/null; then
    others=$(cmake/build_trilinos.sh --without-kokkos)
    export CMAKE_PREFIX_PATH=${CMAKE_PREFIX_PATH:+$CMAKE_PREFIX_PATH:}$others
    dependencies+=" and $others"
  fi
else
  cmake/install_packages.sh ${package_options[@]+"${package_options[@]}"}
  dependencies=$(cmake/build_trilinos.sh)
  export CMAKE_PREFIX_PATH=$dependencies${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}
fi

mkdir -p "$build"
exec 8>"$build/setup.lock" # two builds in one folder would disturb each other
flock -n 8 || { say "waiting for another set-up of $build/"; flock 8; }
# CMake caches the location of each package, so other dependencies need a new cache.
if [[ -e $build/setup.dependencies && $(<"$build/setup.dependencies") != "$dependencies" ]]; then
  rm -rf "$build/CMakeCache.txt" "$build/CMakeFiles"
fi
if [[ ! -e $build/build.ninja || ! -e $build/CMakeCache.txt || CMakePresets.json -nt $build/CMakeCache.txt ]]; then
  say "configuring $build/ (preset $preset, dependencies from $dependencies)"
  cmake --preset "$preset" >"$log" 2>&1 || fail "configuration failed"
  touch "$build/CMakeCache.txt"
  [[ -n $(cached Kokkos_DIR) ]] && echo "$dependencies" >"$build/setup.dependencies"
fi

# Writes the lines of a build to the log and shows its progress: in place on a terminal, otherwise
# as a line every ten seconds. A few steps only record the commit and link; they need no message.
show_progress() {
  local line steps announced=no last=$SECONDS
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    [[ $line =~ ^\[[0-9]+/([0-9]+)\] ]] || continue
    steps=${BASH_REMATCH[0]}
    if [[ $announced == no && ${BASH_REMATCH[1]} -gt 5 ]]; then
      say "building $build/ ($jobs at a time)"
      announced=yes
    fi
    if [[ -t 1 ]]; then
      printf '\rsetup: %s\033[K' "$steps"
    elif ((SECONDS - last >= 10)); then
      say "$steps"
      last=$SECONDS
    fi
  done
  [[ ! -t 1 ]] || printf '\r\033[K'
}

# One compiler needs up to 1.5 GB of memory.
cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc) # nproc obeys these
fitting=$(awk '/^MemAvailable/ { print int($2 / 1.5e6) }' /proc/meminfo 2>/dev/null || echo "$cores")
jobs=$((fitting < cores ? fitting : cores))
jobs=$((jobs < 1 ? 1 : jobs))
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$jobs}
: >"$log"
cmake --build "$build" --target "$target" --parallel "$jobs" 2>&1 | show_progress || fail "the build failed"
