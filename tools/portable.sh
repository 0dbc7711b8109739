#!/usr/bin/env bash
# Makes a folder that runs from any place on any Linux machine with a C library that is not older than this one's: what
# `cmake --install` gives for the program, and the libraries that it is linked with, each with its licence.
set -euo pipefail

usage() { echo "usage: tools/portable.sh BUILD FOLDER"; }
die() { printf 'portable: %s\n' "$*" >&2; exit 1; }

[ $# -eq 2 ] || { usage >&2; exit 2; }
build=$1 folder=$2
command -v patchelf >/dev/null || die "needs the package patchelf"

rm -rf "$folder"
cmake --install "$build" --prefix "$folder" --component program --strip >&2
program=$folder/bin/candela libraries=$folder/lib/candela papers=$folder/share/doc/candela/libraries
mkdir -p "$libraries" "$papers"

missing=$(ldd "$program" | sed -n 's/ => not found//p' | xargs)
[ -z "$missing" ] || die "$program lacks $missing"
# Left to the machine: the C library and its loader, and what the machine's graphics drivers share with us.
left='^(ld-linux.*|linux-vdso|lib(c|m|dl|rt|pthread|resolv|gcc_s|stdc\+\+))\.so'
ldd "$program" | sed -n 's/^[[:space:]]*\([^ ]*\) => \(\/[^ ]*\) .*/\1 \2/p' | grep -vE "$left" | while read -r name path; do
  cp -L "$path" "$libraries/$name"
  chmod 644 "$libraries/$name"
  real=$(realpath "$path")
  # The package system knows a library by its place before or after /lib became a link to /usr/lib.
  owner=$(dpkg-query -S "$real" "${real#/usr}" 2>/dev/null | head -n 1 | cut -d : -f 1) || true
  [ -n "$owner" ] || die "no package owns $real, so that its licence is unknown"
  cp "/usr/share/doc/$owner/copyright" "$papers/$owner"
done
# Of the older kind (DT_RPATH), which holds for the libraries of libraries too.
# shellcheck disable=SC2016  # the loader's variable, not the shell's
patchelf --force-rpath --set-rpath '$ORIGIN/../lib/candela' "$program"
cp LICENSE "$folder/share/doc/candela/LICENSE"
