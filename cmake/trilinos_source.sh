# shellcheck shell=bash
# Builds parts of Debian's Trilinos source package, once, into a cache outside the source tree;
# sourced by build_trilinos.sh and build_stk.sh.
#
# The cache is ${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}. The name of a prefix
# contains a hash of the options, the patch and the versions of compiler and MPI: a change of these
# builds anew. JOBS (default: all cores) limits the number of compilers that run at once.

# Options that all parts share.
# shellcheck disable=SC2034
trilinos_options=(
  -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
  -DCMAKE_CXX_STANDARD=17 -DKokkos_CXX_STANDARD=17
  -DTPL_ENABLE_MPI=ON -DMPI_USE_COMPILER_WRAPPERS=ON
  -DTrilinos_ENABLE_Fortran=OFF -DTrilinos_ENABLE_ALL_OPTIONAL_PACKAGES=OFF
  -DTrilinos_ENABLE_TESTS=OFF -DTrilinos_ENABLE_EXAMPLES=OFF
  -DTrilinos_ENABLE_OpenMP=ON -DTrilinos_ENABLE_Kokkos=ON -DKokkos_ENABLE_OPENMP=ON -DKokkos_ENABLE_SERIAL=ON
  -DTPL_ENABLE_BLAS=OFF -DTPL_ENABLE_LAPACK=OFF -DTPL_ENABLE_DLlib=ON
)
patch_source() { :; } # redefined by scripts that change the unpacked source, whose folder is $1

fail() {
  echo "setup: $1 (log: $log)" >&2
  tail -n 20 "$log" >&2 || true
  exit 1
}

# Downloads and unpacks the source package with a deb-src list made from the system's own sources,
# used only here.
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

# install_from_source NAME PARTS CMAKE_OPTIONS...: builds and installs PARTS (words for messages),
# unless the cache has them, and prints the install prefix on standard output.
install_from_source() {
  local name=$1 parts=$2 cache key prefix source_dir log work # fail and fetch_source read the last two
  shift 2
  cache=$(realpath -m "${BRICKWALL_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/brickwall}")
  key=$({
    printf '%s\n' "$@"
    declare -f patch_source
    g++ -dumpfullversion
    uname -m
    mpicxx -show 2>/dev/null || true
    mpicxx -E -dM -x c++ -include mpi.h /dev/null 2>/dev/null | grep 'MPI.*_VERSION' || true
  } | sha256sum | cut -c1-12)
  prefix=$cache/$name-$key
  log=$prefix.log
  work=$cache/work-$name-$key
  mkdir -p "$cache"
  exec 9>"$cache/.lock-$name"
  flock 9 # two set-ups at once build one copy
  if [[ -e $prefix/.complete ]]; then
    echo "$prefix"
    return
  fi
  rm -rf "$work" "$prefix"
  mkdir -p "$work/lists/partial"
  echo "setup: building $parts from Debian's Trilinos source (once, several minutes)" >&2
  fetch_source >"$log" 2>&1 || fail "could not get Debian's Trilinos source package"
  source_dir=$(echo "$work"/trilinos-*/)
  [[ -d $source_dir ]] || fail "Debian's Trilinos source package did not unpack"
  patch_source "$source_dir"
  cmake -G Ninja -S "$source_dir" -B "$work/build" "-DCMAKE_INSTALL_PREFIX=$prefix" "$@" >>"$log" 2>&1 ||
    fail "$parts did not configure"
  cmake --build "$work/build" --parallel "${JOBS:-$(nproc)}" >>"$log" 2>&1 || fail "$parts did not build"
  cmake --install "$work/build" >>"$log" 2>&1 || fail "$parts did not install"
  rm -rf "$work"
  touch "$prefix/.complete"
  echo "$prefix"
}
