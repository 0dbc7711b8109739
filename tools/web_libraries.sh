#!/usr/bin/env bash
# tools/web_libraries.sh FOLDER: the libraries that `./dev web` needs, as WebAssembly in FOLDER/prefix. They are compiled from the source
# packages of this Debian, which apt-get fetches and verifies as it does packages. What is there already is kept.
set -euo pipefail

say() { printf '%s\n' "$*" >&2; }
die() { say "web_libraries: $*"; exit 1; }

[ $# -eq 1 ] || die "usage: tools/web_libraries.sh FOLDER"
mkdir -p "$1"
folder=$(cd "$1" && pwd)
prefix=$folder/prefix
sources=$folder/sources
jobs=${JOBS-$(nproc)}

toolchain=$(em-config EMSCRIPTEN_ROOT)/cmake/Modules/Platform/Emscripten.cmake
[ -f "$toolchain" ] || die "emscripten has no toolchain file for CMake: $toolchain"
# Every object of a program has to agree on how exceptions and longjmp() work.
flags="-O2 -fwasm-exceptions -sSUPPORT_LONGJMP=wasm -msimd128"

# apt-get with lists of its own, of sources alone: those of the system stay as they are.
apt_options=(-q -o Dir::Etc::sourcelist="$folder/apt/sources.list" -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$folder/apt/lists")
own_apt() { apt-get "${apt_options[@]}" "$@"; }
own_apt_cache() { apt-cache "${apt_options[@]}" "$@"; }

prepare_apt() {
  [ ! -d "$folder/apt/lists" ] || return 0
  mkdir -p "$folder/apt/lists/partial"
  # The mirror that packages come from has their sources, too.
  # shellcheck disable=SC2016  # the fields are apt's
  apt-get indextargets --format '$(ORIGIN)|deb-src $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    sed -n 's/^Debian|//p' | awk '!seen[$0]++' >"$folder/apt/sources.list"
  [ -s "$folder/apt/sources.list" ] || die "apt knows no repository of Debian, whose sources are needed"
  own_apt update >&2 || { rm -rf "$folder/apt/lists"; die "the lists of Debian's sources cannot be fetched"; }
}

# The newest version whose sources can be had: some mirrors of security updates have none.
unpack() {
  local package=$1 version
  for version in $(own_apt_cache showsrc --only-source "$package" | sed -n 's/^Version: //p' | sort -urV); do
    # As root apt would warn that its own user cannot write here.
    (cd "$sources/$package" && own_apt -o APT::Sandbox::User=root source --only-source "$package=$version" >&2) && return 0
    say "web_libraries: $package $version cannot be fetched"
    rm -rf "${sources:?}/$package"
    mkdir -p "$sources/$package"
  done
  die "the sources of $package cannot be fetched"
}

# build PACKAGE COMMAND…: one source package, by a command that is called in its folder and installs into the prefix.
build() {
  local package=$1
  shift
  local done=$folder/done/$package
  [ ! -f "$done" ] || return 0
  say "== $package"
  prepare_apt
  rm -rf "${sources:?}/$package"
  mkdir -p "$sources/$package" "$folder/done"
  unpack "$package"
  (cd "$sources/$package"/*/ && "$@" >&2) || die "$package could not be compiled"
  rm -rf "${sources:?}/$package"
  touch "$done"
}

# Its own CMake file names what Debian's sources leave out.
by_configure() {
  CC=emcc AR=emar RANLIB=emranlib CFLAGS="$flags" ./configure --static --prefix="$prefix" &&
    make -j "$jobs" libz.a &&
    mkdir -p "$prefix/lib" "$prefix/include" &&
    cp libz.a "$prefix/lib/" &&
    cp zlib.h zconf.h "$prefix/include/"
}

# by_cmake SUBFOLDER [options…]
by_cmake() {
  local tree=$1 into=candela-build
  shift
  cmake -S "$tree" -B "$into" -G Ninja --log-level=WARNING -Wno-dev -Wno-deprecated \
    -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE=-DNDEBUG -DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" \
    -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_FIND_ROOT_PATH="$prefix" \
    -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF "${sizes[@]}" "$@" &&
    cmake --build "$into" -j "$jobs" --target "${target-install}"
}

# Draco's CMake file makes a module of JavaScript for emscripten; wanted is its decoder. What it supports stands in Debian's header.
by_hand_draco() {
  local file object=()
  mkdir -p objects "$prefix/lib" "$prefix/include/draco"
  grep -v TRANSCODER /usr/include/draco/draco_features.h >src/draco/draco_features.h
  while IFS= read -r file; do
    object+=("$(printf '%s' "${file%.cc}.o" | tr / _)")
    printf '%s\0%s\0' "$file" "objects/${object[-1]}"
  done < <(find src/draco/{attributes,compression,core,mesh,metadata,point_cloud} -name '*.cc' ! -name '*test*' ! -name '*encode*' &&
    ls src/draco/core/encoder_buffer.cc) |
    xargs -0 -n 2 -P "$jobs" sh -c "em++ -std=c++14 $flags -DNDEBUG -Isrc -c \"\$0\" -o \"\$1\"" &&
    emar rcs "$prefix/lib/libdraco.a" objects/*.o &&
    (cd src && find draco -name '*.h' -exec cp --parents {} "$prefix/include/" ';')
}

# CMake finds no sizes of types in what emscripten compiles: has_size NAME BYTES… says them.
has_size() {
  while [ $# -gt 1 ]; do
    sizes+=("-DHAVE_$1=TRUE" "-D$1=$2")
    shift 2
  done
}
sizes=()
has_size SIZE_T 4 UNSIGNED_LONG 4 SIZEOF_SIZE_T 4 SIZEOF_OFF_T 8
for bits in 8 16 32 64; do has_size "INT${bits}_T_LIBZIP" $((bits / 8)) "UINT${bits}_T_LIBZIP" $((bits / 8)); done

# No library is installed where none is shared.
by_cmake_turbojpeg() {
  target=turbojpeg-static by_cmake "$@" &&
    cp candela-build/libturbojpeg.a "$prefix/lib/" &&
    cp turbojpeg.h "$prefix/include/"
}

build zlib by_configure
build libzstd by_cmake build/cmake -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF -DZSTD_LEGACY_SUPPORT=OFF -DZSTD_MULTITHREAD_SUPPORT=OFF
build fmtlib by_cmake . -DFMT_TEST=OFF -DFMT_DOC=OFF
build libpng1.6 by_cmake . -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DPNG_EXECUTABLES=OFF
build libjpeg-turbo by_cmake_turbojpeg . -DENABLE_SHARED=OFF -DWITH_SIMD=OFF -DWITH_JPEG8=OFF
build libwebp by_cmake . -DWEBP_BUILD_ANIM_UTILS=OFF -DWEBP_BUILD_CWEBP=OFF -DWEBP_BUILD_DWEBP=OFF -DWEBP_BUILD_GIF2WEBP=OFF -DWEBP_BUILD_IMG2WEBP=OFF \
  -DWEBP_BUILD_VWEBP=OFF -DWEBP_BUILD_WEBPINFO=OFF -DWEBP_BUILD_WEBPMUX=OFF -DWEBP_BUILD_EXTRAS=OFF -DWEBP_ENABLE_SIMD=OFF -DWEBP_USE_THREAD=OFF
build imath by_cmake . -DPYTHON=OFF
build openexr by_cmake . -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DOPENEXR_ENABLE_THREADING=OFF
build draco by_hand_draco
build libzip by_cmake . -DENABLE_BZIP2=OFF -DENABLE_LZMA=OFF -DENABLE_ZSTD=OFF -DENABLE_COMMONCRYPTO=OFF -DENABLE_GNUTLS=OFF -DENABLE_MBEDTLS=OFF \
  -DENABLE_OPENSSL=OFF -DBUILD_TOOLS=OFF -DBUILD_REGRESS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_DOC=OFF
