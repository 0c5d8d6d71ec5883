# Sourced by abn.sh and test.sh: installs what is missing, configures, builds. All chatter goes to stderr.
# Needs: $root = the source tree.

packages=(
  g++ cmake ninja-build                                        # toolchain
  libopenimageio-dev libopencv-core-dev libopencv-imgproc-dev  # images
  libeigen3-dev libboost-dev                                   # headers: matrices, Sobol tables
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libfmt-dev
  libgtest-dev libbenchmark-dev                                # tests, benchmarks
)
# Threads that wait sleep: spinning (the default) makes everything many times slower as soon as another process wants a core.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
build_dir=$root/build/release
stamp=$build_dir/.abn-built

say() { printf '%s\n' "abn: $*" >&2; }

# Installs missing packages, as root or with sudo; says what to do where neither is possible.
install_missing() {
  local missing=() package
  for package in "${packages[@]}"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      say "these packages are missing and neither root nor sudo is at hand; have them installed, then try again:"
      say "  apt-get install --no-install-recommends ${missing[*]}"
      return 3
    fi
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  { "${as_root[@]}" apt-get update -q && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "${missing[@]}"; } >&2 || {
    say "apt-get failed (see above): check the network and /etc/apt/sources.list, then try again"
    return 3
  }
}

revision() { git -C "$root" rev-parse HEAD 2>/dev/null || echo none; }

# True if the last build is younger than every source and was made at this revision: 10 ms instead of a build system's start.
up_to_date() {
  [[ -x $build_dir/abn && -f $stamp && $(<"$stamp") == "$(revision)" ]] || return 1
  [[ -z $(find "$root"/CMakeLists.txt "$root"/CMakePresets.json "$root"/cmake "$root"/sampling "$root"/sph_cuda "$root"/harness -newer "$stamp" -print -quit) ]]
}

# build [target...]: the release preset; nothing given = everything.
build() {
  install_missing || return
  local began
  began=$(mktemp)
  if [[ ! -f $build_dir/build.ninja ]]; then
    say "configuring into $build_dir"
    (cd "$root" && cmake --preset release) >&2 || { rm -f "$began"; say "configuring failed (see above)"; return 1; }
  fi
  say "building${1:+ $1} with $(nproc) processes (minutes the first time)"
  cmake --build "$build_dir" -j "$(nproc)" ${1:+--target "$@"} >&2 || { rm -f "$began"; say "the build failed (see above)"; return 1; }
  revision >"$stamp"
  touch -r "$began" "$stamp"  # a source saved while the build ran is newer than the stamp
  rm -f "$began"
}
