# SPDX-License-Identifier: MIT
# Sourced by the commands that need the project built (tests/run, tests/sanitize, addon/package, blend-samples/run):
# what is missing on the machine, the virtual environment, the build. Each step looks first, and is quick when nothing is to be done.
# The caller has `set -euo pipefail` and stands in the project's root.

say() { printf '%s\n' "-- $*"; }
die() { printf '%s\n' "$*" >&2; exit 1; }

python_wanted=3.11  # Blender's, from 4.1 to 5.0 and in Debian 12
build_packages=(g++ cmake ninja-build libeigen3-dev python3-dev python3-venv)
# Blender and what its interface needs on a machine without a screen.
blender_packages=(blender python3-numpy xvfb xauth libgl1-mesa-dri)
# What the bpy wheels expect to find.
bpy_packages=(libxrender1 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1)

# install_packages WHAT_FOR PACKAGE...: those of the Debian packages that are missing.
install_packages() {
  local what=$1 package missing=(); shift
  command -v dpkg-query >/dev/null || { say "Not a Debian: expecting to find, for $what: $*"; return 0; }
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local root=()
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || die "Installing ${missing[*]} needs root: run this as root, install sudo, or install them yourself."
    root=(sudo)
  fi
  say "Installing for $what: ${missing[*]}"
  mkdir -p .cache
  { "${root[@]}" apt-get update -q &&
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
  } >".cache/apt-${what// /-}.log" 2>&1 ||
    { tail -n 20 ".cache/apt-${what// /-}.log" >&2; die "apt-get could not install ${missing[*]}."; }
}

# find_python: sets `python`. Other interpreters may come first on PATH, so it is named, not searched.
find_python() {
  local candidate
  for candidate in ${SADDLEBACK_PYTHON_EXE:-/usr/bin/python3 /usr/bin/python$python_wanted}; do
    if "$candidate" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$python_wanted')" 2>/dev/null; then
      python=$candidate
      return
    fi
  done
  die "Python $python_wanted is needed (the one of Debian 12 and of Blender 4.1 to 5.0), but /usr/bin/python3 is" \
    "$(/usr/bin/python3 --version 2>&1 || true). Name another interpreter with SADDLEBACK_PYTHON_EXE=/path/to/python$python_wanted."
}

# fill_venv FOLDER WHAT PYTHON PIP_ARGUMENT...: a virtual environment with these packages; nothing to do when its stamp for
# this purpose tells so.
fill_venv() {
  local folder=$1 what=$2 interpreter=$3 stamp="$1/${2// /-}.stamp" argument wanted; shift 3
  wanted=$({ printf '%s\n' "$interpreter" "$@"; for argument in "$@"; do [ ! -f "$argument" ] || cat "$argument"; done; } | sha256sum)
  [ "$(cat "$stamp" 2>/dev/null)" != "$wanted" ] || return 0
  say "Installing $what into $folder"
  [ -x "$folder/bin/python" ] || "$interpreter" -m venv "$folder"
  "$folder/bin/python" -m pip install -q --disable-pip-version-check --no-input "$@" ||
    die "pip could not install $what into $folder."
  printf '%s\n' "$wanted" >"$stamp"
}

# build_native PRESET FOLDER [CMAKE_ARGUMENT...]: configures once, then builds what changed.
build_native() {
  local preset=$1 folder=$2 launcher=(); shift 2
  ! command -v ccache >/dev/null || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON)
  if [ ! -f "$folder/build.ninja" ] || [ CMakePresets.json -nt "$folder/build.ninja" ]; then
    say "Configuring $folder"
    mkdir -p "$folder"
    cmake --preset "$preset" -B "$folder" "${launcher[@]}" "$@" >"$folder/configure.log" 2>&1 ||
      { cat "$folder/configure.log" >&2; die "CMake could not configure $folder."; }
  fi
  say "Building $folder"
  ninja -C "$folder" -j "$(nproc)" --quiet >"$folder/build.log" 2>&1 || { cat "$folder/build.log" >&2; die "The build failed."; }
}

# set_up_tools: what the build needs; sets `python`.
set_up_tools() {
  install_packages "the build" "${build_packages[@]}"
  find_python
  fill_venv .venv "the build and test tools" "$python" -r tests/requirements.txt
}

# set_up_site: after set_up_tools; what docs/site/build needs.
set_up_site() {
  fill_venv .venv "the reference site's tools" "$python" -r tests/requirements.txt -r docs/site/requirements.txt
}

# set_up_build: after set_up_tools; .venv/bin/python can `import saddleback` afterwards.
set_up_build() {
  local site
  build_native release build
  site=$(echo .venv/lib/python*/site-packages)
  printf '%s\n' "$PWD/build/python" >"$site/saddleback.pth"
  .venv/bin/python -c 'import saddleback' || die "The module was built but cannot be imported."
}

# set_up_debian_blender: Debian's Blender, and a screen for it.
set_up_debian_blender() { install_packages "Blender" "${blender_packages[@]}"; }

# set_up_bpy VERSION: Blender VERSION as a Python module, in an environment of its own.
set_up_bpy() {
  local interpreter=$python extra=()
  install_packages "the bpy wheels" "${bpy_packages[@]}"
  if needs_newer_python "$1"; then
    interpreter=$(find_interpreter 3.13)
    extra=("pybind11>=3.0,<4")  # a build of its own, for its own Python
  fi
  fill_venv ".cache/bpy-$1" "Blender $1" "$interpreter" "bpy==$1.*" "pytest>=8.3,<10" "hypothesis>=6.100,<7" "${extra[@]}"
  if needs_newer_python "$1"; then
    build_native release "build-bpy-$1" -DPython_EXECUTABLE="$PWD/.cache/bpy-$1/bin/python"
  fi
}

# needs_newer_python VERSION: Blender went on to Python 3.13 with 5.1.
needs_newer_python() { case $1 in 5.[1-9]*) ;; *) return 1 ;; esac; }

# find_interpreter VERSION: prints the path of a python of that version which one can build for, from PATH or from pyenv.
find_interpreter() {
  local candidate
  for candidate in "$(command -v "python$1")" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/"bin/python$1"; do
    if "$candidate" -c 'import ensurepip, os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null; then
      echo "$candidate"
      return
    fi
  done
  return 1
}
