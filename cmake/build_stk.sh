#!/usr/bin/env bash
# Builds STKSearch, the k-d tree search of Trilinos, with what it needs, from the Debian source package that
# build_trilinos.sh builds Kokkos from; for the peer benchmarks of verification/performance only. Prints the install
# prefix on standard output: cmake -DBRICKWALL_PEER_STK=ON -DSTK_ROOT=$(cmake/build_stk.sh).
#
# It lies in the same cache under a name of its own, so that nobody else's libraries are built anew. About 150 files; JOBS
# (default: all cores) sets how many at once.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
cache=${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}
key=$({ cat "${BASH_SOURCE[0]}"; g++ -dumpfullversion; uname -m; } | sha256sum | cut -c1-12)
prefix=$cache/stk-$key
log=$cache/stk-$key.log

if [[ -e $prefix/.complete ]]; then
  echo "$prefix"
  exit 0
fi

mkdir -p "$cache"
exec 9>"$cache/.lock-stk"
flock 9 # two set-ups at once build only one copy
if [[ -e $prefix/.complete ]]; then
  echo "$prefix"
  exit 0
fi
work=$cache/work-stk-$key
rm -rf "$work" "$prefix"
mkdir -p "$work/lists/partial"

fail() {
  echo "setup: $1 (log: $log)" >&2
  tail -n 20 "$log" >&2 || true
  exit 1
}

# The download is that of build_trilinos.sh, read from there: a file of its own for both would change the hash that names
# the Trilinos cache.
eval "$(sed -n '/^fetch_source() {$/,/^}$/p' "$here/build_trilinos.sh")"

echo "setup: building STKSearch from Debian's Trilinos source (once, some minutes)" >&2
fetch_source >"$log" 2>&1 || fail "could not get Debian's Trilinos source package"
source_dir=$(echo "$work"/trilinos-*/)
[[ -d $source_dir ]] || fail "Debian's Trilinos source package did not unpack"

# STKSearch asks for KokkosKernels, of which it reads one header; without its explicit instantiations that is 5 files.
# Kokkos is built as build_trilinos.sh has it, since the benchmark links that one. The C++ bindings of MPI stay out, which
# we do not link.
options=(
  -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
  -DCMAKE_CXX_STANDARD=17 -DKokkos_CXX_STANDARD=17 "-DCMAKE_CXX_FLAGS=-DOMPI_SKIP_MPICXX -DMPICH_SKIP_MPICXX"
  -DTPL_ENABLE_MPI=ON -DMPI_USE_COMPILER_WRAPPERS=ON
  -DTrilinos_ENABLE_Fortran=OFF -DTrilinos_ENABLE_ALL_OPTIONAL_PACKAGES=OFF
  -DTrilinos_ENABLE_TESTS=OFF -DTrilinos_ENABLE_EXAMPLES=OFF
  -DTrilinos_ENABLE_OpenMP=ON -DTrilinos_ENABLE_Kokkos=ON -DKokkos_ENABLE_OPENMP=ON -DKokkos_ENABLE_SERIAL=ON
  -DTrilinos_ENABLE_STKSearch=ON -DKokkosKernels_ADD_DEFAULT_ETI=OFF
  -DTPL_ENABLE_BLAS=OFF -DTPL_ENABLE_LAPACK=OFF -DTPL_ENABLE_Boost=OFF -DTPL_ENABLE_DLlib=ON
)
cmake -G Ninja -S "$source_dir" -B "$work/build" "-DCMAKE_INSTALL_PREFIX=$prefix" "${options[@]}" \
  >>"$log" 2>&1 || fail "STKSearch did not configure"
cmake --build "$work/build" --parallel "${JOBS:-$(nproc)}" >>"$log" 2>&1 || fail "STKSearch did not build"
cmake --install "$work/build" >>"$log" 2>&1 || fail "STKSearch did not install"
rm -rf "$work"
touch "$prefix/.complete"
echo "$prefix"
