#!/usr/bin/env bash
# Builds Kokkos (OpenMP + Serial), Zoltan and SEACAS Exodus with epu and exodiff from Debian's Trilinos
# source package, once, into a cache outside the source tree. Prints the install prefix on standard output.
#
# The cache is ${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}. The prefix's name holds a hash of
# this script and of the compiler's version, so a change of either builds anew and nothing else does.
set -euo pipefail

cache=${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}
key=$({ cat "${BASH_SOURCE[0]}"; g++ -dumpfullversion; uname -m; } | sha256sum | cut -c1-12)
prefix=$cache/trilinos-$key
log=$cache/trilinos-$key.log

if [[ -e $prefix/.complete ]]; then
  echo "$prefix"
  exit 0
fi

mkdir -p "$cache"
exec 9>"$cache/.lock"
flock 9 # two set-ups at once build only one copy
if [[ -e $prefix/.complete ]]; then
  echo "$prefix"
  exit 0
fi
work=$cache/work-$key
rm -rf "$work" "$prefix"
mkdir -p "$work/lists/partial"

fail() {
  echo "setup: $1 (log: $log)" >&2
  tail -n 20 "$log" >&2 || true
  exit 1
}

# A deb-src list made from the system's own sources, used for this one download only.
fetch_source() {
  {
    # One-line style entries (sources.list, *.list).
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
      sed -n 's/^deb \(.*debian.*\)/deb-src \1/p'
    # deb822 style entries (*.sources).
    for file in /etc/apt/sources.list.d/*.sources; do
      [[ -e $file ]] || continue
      awk -v RS= '/(^|\n)URIs:[^\n]*debian/ {
        n = split($0, line, "\n"); uris = suites = components = options = "";
        for (i = 1; i <= n; ++i) {
          if (line[i] ~ /^URIs:/) { sub(/^URIs:[ \t]*/, "", line[i]); uris = line[i] }
          if (line[i] ~ /^Suites:/) { sub(/^Suites:[ \t]*/, "", line[i]); suites = line[i] }
          if (line[i] ~ /^Components:/) { sub(/^Components:[ \t]*/, "", line[i]); components = line[i] }
          if (line[i] ~ /^Signed-By:[ \t]*\//) { sub(/^Signed-By:[ \t]*/, "", line[i]); options = "[signed-by=" line[i] "] " }
        }
        m = split(suites, suite, /[ \t]+/); k = split(uris, uri, /[ \t]+/);
        for (i = 1; i <= m; ++i) for (j = 1; j <= k; ++j) print "deb-src " options uri[j] " " suite[i] " " components
      }' "$file"
    done
  } | sort -u >"$work/sources.list"
  local apt_options=(-o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=-
    -o "Dir::State::lists=$work/lists" -o APT::Sandbox::User="$(id -un)")
  apt-get -q "${apt_options[@]}" update
  (cd "$work" && apt-get -q "${apt_options[@]}" source --only-source trilinos)
}

echo "setup: building Kokkos, Zoltan and SEACAS from Debian's Trilinos source (once, several minutes)" >&2
fetch_source >"$log" 2>&1 || fail "could not get Debian's Trilinos source package"
source_dir=$(echo "$work"/trilinos-*/)
[[ -d $source_dir ]] || fail "Debian's Trilinos source package did not unpack"

# netCDF 4.9 defines NC_SZIP_NN as a macro, which breaks SEACAS' own constant of that name.
sed -i '/^ *const int NC_SZIP_NN/d' \
  "$source_dir/packages/seacas/libraries/exodus/src/ex_utils.c"

multiarch=$(gcc -print-multiarch)
options=(
  -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
  -DCMAKE_CXX_STANDARD=17 -DKokkos_CXX_STANDARD=17
  -DTPL_ENABLE_MPI=ON -DMPI_USE_COMPILER_WRAPPERS=ON
  -DTrilinos_ENABLE_Fortran=OFF -DTrilinos_ENABLE_ALL_OPTIONAL_PACKAGES=OFF
  -DTrilinos_ENABLE_TESTS=OFF -DTrilinos_ENABLE_EXAMPLES=OFF -DTrilinos_ENABLE_SECONDARY_TESTED_CODE=OFF
  -DTrilinos_ENABLE_OpenMP=ON -DTrilinos_ENABLE_Kokkos=ON -DKokkos_ENABLE_OPENMP=ON -DKokkos_ENABLE_SERIAL=ON
  -DTrilinos_ENABLE_Zoltan=ON
  -DTrilinos_ENABLE_SEACASExodus=ON -DTrilinos_ENABLE_SEACASExodiff=ON -DTrilinos_ENABLE_SEACASEpu=ON
  -DTPL_ENABLE_Netcdf=ON -DTPL_ENABLE_HDF5=ON
  -DHDF5_INCLUDE_DIRS=/usr/include/hdf5/serial
  "-DHDF5_LIBRARY_DIRS=/usr/lib/$multiarch/hdf5/serial" "-DHDF5_LIBRARY_NAMES=hdf5_hl;hdf5"
  -DTPL_ENABLE_X11=OFF -DTPL_ENABLE_Matio=OFF -DTPL_ENABLE_BLAS=OFF -DTPL_ENABLE_LAPACK=OFF -DTPL_ENABLE_DLlib=ON
)
cmake -G Ninja -S "$source_dir" -B "$work/build" "-DCMAKE_INSTALL_PREFIX=$prefix" "${options[@]}" \
  >>"$log" 2>&1 || fail "Trilinos did not configure"
cmake --build "$work/build" >>"$log" 2>&1 || fail "Trilinos did not build"
cmake --install "$work/build" >>"$log" 2>&1 || fail "Trilinos did not install"
rm -rf "$work"
touch "$prefix/.complete"
echo "$prefix"
