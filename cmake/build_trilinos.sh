#!/usr/bin/env bash
# Builds Kokkos (OpenMP + Serial), Zoltan and SEACAS Exodus with epu and exodiff from Debian's
# Trilinos source package, once, into the cache (trilinos_source.sh). Prints the install prefix on
# standard output.
#
#   cmake/build_trilinos.sh [--without-kokkos]
#
# --without-kokkos builds the others alone, for a user who provides Kokkos: the prefix then has no
# headers of a second Kokkos.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/trilinos_source.sh"

# netCDF 4.9 defines NC_SZIP_NN as a macro, which breaks the constant of that name in SEACAS.
patch_source() {
  sed -i '/^ *const int NC_SZIP_NN/d' "$1/packages/seacas/libraries/exodus/src/ex_utils.c"
}
parts="Kokkos, Zoltan and SEACAS"
without=()
if [[ ${1:-} == --without-kokkos ]]; then
  parts="Zoltan and SEACAS"
  without=(-DTrilinos_ENABLE_Kokkos=OFF)
fi
multiarch=$(gcc -print-multiarch)
install_from_source trilinos "$parts" "${trilinos_options[@]}" \
  -DTrilinos_ENABLE_SECONDARY_TESTED_CODE=OFF -DTrilinos_ENABLE_Zoltan=ON \
  -DTrilinos_ENABLE_SEACASExodus=ON -DTrilinos_ENABLE_SEACASExodiff=ON -DTrilinos_ENABLE_SEACASEpu=ON \
  -DTPL_ENABLE_Netcdf=ON -DTPL_ENABLE_HDF5=ON -DHDF5_INCLUDE_DIRS=/usr/include/hdf5/serial \
  "-DHDF5_LIBRARY_DIRS=/usr/lib/$multiarch/hdf5/serial" "-DHDF5_LIBRARY_NAMES=hdf5_hl;hdf5" \
  -DTPL_ENABLE_X11=OFF -DTPL_ENABLE_Matio=OFF ${without[@]+"${without[@]}"}
