#!/usr/bin/env bash
# Builds STKSearch, the k-d tree search of Trilinos, and its dependencies from Debian's Trilinos
# source package, once, into the cache (trilinos_source.sh); for the peer benchmarks of
# verification/performance only. Prints the install prefix on standard output:
#   cmake -DBRICKWALL_PEER_STK=ON -DSTK_ROOT=$(cmake/build_stk.sh)
# It compiles about 150 files.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/trilinos_source.sh"

# STKSearch requires KokkosKernels, of which it reads one header; without its explicit
# instantiations that is 5 files. Kokkos has the options of build_trilinos.sh, since the benchmark
# links that one. The C++ bindings of MPI are not linked.
install_from_source stk STKSearch "${trilinos_options[@]}" \
  "-DCMAKE_CXX_FLAGS=-DOMPI_SKIP_MPICXX -DMPICH_SKIP_MPICXX" \
  -DTrilinos_ENABLE_STKSearch=ON -DKokkosKernels_ADD_DEFAULT_ETI=OFF -DTPL_ENABLE_Boost=OFF
