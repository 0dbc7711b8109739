#!/usr/bin/env bash
# Tries what ./dev package made as somebody would who installs it: in minimal Debians in folders, by apt and by tar.
# shellcheck disable=SC2016,SC2317  # shells in folders fill in variables, and it_is_true calls functions
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/test_packages.sh 12|13 [--keep] [--ccache DIR] [DIR]

  12, 13     the release of Debian
  --keep     leave the folders behind, and say where they are
  --ccache DIR
             keep what is compiled there, for the next run
  DIR        what ./dev package made there; without, it is made first, from what is committed

Needs root, debootstrap, about 6 GB in TMPDIR (/var/tmp), the network and, without DIR, half an hour. Logs go to stderr.
TEXT
}

# shellcheck source=tools/debian_root.sh
. "$(dirname "${BASH_SOURCE[0]}")/debian_root.sh"

number="" packages=""
all=("$@")
while [ $# -gt 0 ]; do
  case "$1" in
    12 | 13) number=$1 ;;
    --keep) keep_roots=true ;;
    --ccache) objects=${2?"--ccache: the folder is missing"}; shift ;;
    -h | --help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) packages=$1 ;;
  esac
  shift
done
[ -n "$number" ] || { usage >&2; exit 2; }
own_mounts "$0" "${all[@]}"

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
release=$(release_name "$number")
root=""

failed=0
# it_is_true WHAT COMMAND…: says whether the command succeeded.
it_is_true() {
  local what=$1 log
  shift
  if log=$("$@" 2>&1); then
    echo "passed: $what"
  else
    failed=1
    printf 'FAILED: %s\n%s\n' "$what" "$log"
  fi
}

# Commands in the folder at hand, as a user with an empty folder would give them.
here() { in_root "$root" DEBIAN_FRONTEND=noninteractive sh -euc 'mkdir -p /data; cd /data; eval "$1"' sh "$1"; }
says() { here "$1" 2>&1 | grep -q -- "$2"; }
is_absent() { [ -z "$(find "$root" -mindepth 1 -xdev -path "$root/tmp" -prune -o -iname '*candela*' -print)" ]; }
size_of() { du -sm -x "$root" | cut -f 1; }

if [ -z "$packages" ]; then
  make_root "$release" ca-certificates,git
  git clone -q "file://$repository" "$root/candela"
  in_root "$root" /candela/dev package >&2
  packages=$root/candela/out
fi
objects="" # nothing else is compiled that is worth it
program=("$packages"/candela_*~deb"$number"_*.deb)
library=("$packages"/libcandela-dev_*~deb"$number"_*.deb)
portable=("$packages"/candela-*-linux-*.tar.xz)
for file in "${program[0]}" "${library[0]}" "${portable[0]}"; do
  [ -f "$file" ] || die "$packages has no $(basename "$file")"
done
version=$(dpkg-deb -f "${program[0]}" Version)

echo "== $(basename "${program[0]}")"
make_root "$release"
before=$(size_of)
here "apt-get update -q" >&2
cp "${program[0]}" "${library[0]}" "$root/tmp/"
it_is_true "apt installs it on a machine that has nothing else" here "apt-get install -y -q --no-install-recommends /tmp/candela_*.deb && apt-get clean"
echo "        with what it needs it takes $(($(size_of) - before)) MB"
it_is_true "candela --version is the package's" says "candela --version" "^candela ${version%%-*}\$"
it_is_true "candela render makes a picture" here "candela render demo:spheres -o a.png --size 64x48 --spp 4 && candela info a.png"
it_is_true "other formats are read, in a process of their own" here "printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > a.obj && candela check a.obj"
it_is_true "what is missing is said in one line" says "candela render demo:spheres -o b.png --engine raster --size 64x48 || echo code \$?" "^code 1"
it_is_true "apt adds a driver that draws without a GPU" here "apt-get install -y -q --no-install-recommends libgl1-mesa-dri && apt-get clean"
it_is_true "candela render --engine raster makes a picture" here "candela render demo:spheres -o b.png --engine raster --size 64x48 && candela info b.png"
it_is_true "every verb has a page of the manual" here 'candela --help | sed -n "/^Verbs:/,/^\$/s/^  \([a-z]*\) .*/\1/p" | while read -r verb; do zcat /usr/share/man/man1/candela-"$verb".1.gz | grep -q "^.SH OPTIONS"; done'
it_is_true "bash completes" here 'bash -c ". /usr/share/bash-completion/completions/candela; COMP_LINE=\"candela prev\"; COMP_POINT=12; COMP_WORDS=(candela prev); COMP_CWORD=1; _candela; [ \${COMPREPLY[0]} = preview ]"'
it_is_true "zsh would find its function" here 'head -n 1 /usr/share/zsh/vendor-completions/_candela | grep -q "^#compdef candela"'
it_is_true "its files are as they were packed" here 'test -z "$(dpkg --verify candela)"'
it_is_true "apt installs the library with what find_package(candela) looks for" here "apt-get install -y -q --no-install-recommends /tmp/libcandela-dev_*.deb cmake g++ make && apt-get clean"
cp -R "$repository/examples" "$root/tmp/examples"
it_is_true "the examples build against it" here "cmake -S /tmp/examples -B /tmp/built -DCMAKE_BUILD_TYPE=Release && cmake --build /tmp/built"
it_is_true "and make a picture" here "/tmp/built/render_gltf demo:spheres c.png && candela info c.png"
it_is_true "apt removes both" here "apt-get purge -y -q candela libcandela-dev && rm -rf /data ~/.cache/candela"
it_is_true "and leaves no file of that name" is_absent

echo "== $(basename "${portable[0]}")"
make_root "$release"
tar -C "$root/opt" -xJf "${portable[0]}"
folder=$(cd "$root/opt" && echo candela-*)
echo "        unpacked it takes $(du -sm "$root/opt" | cut -f 1) MB"
it_is_true "it runs where nothing was installed" says "/opt/$folder/bin/candela --version" "^candela ${version%%-*}\$"
it_is_true "through a link in PATH, it makes a picture" here "ln -s /opt/$folder/bin/candela /usr/local/bin/ && candela render demo:spheres -o a.png --size 64x48 --spp 4 && candela info a.png"
it_is_true "from another place, too" here "mv /opt/$folder '/data/a place' && '/data/a place/bin/candela' render demo:spheres -o b.png --size 64x48 --spp 4"
it_is_true "what is missing is said in one line" says "'/data/a place/bin/candela' render demo:spheres -o b.png --engine raster --size 64x48 || echo code \$?" "^code 1"
it_is_true "each of its libraries has its licence" here 'test "$(ls "/data/a place/lib/candela" | wc -l)" -ge "$(ls "/data/a place/share/doc/candela/libraries" | wc -l)" && test -s "/data/a place/share/doc/candela/libraries/libtbb12"'
exit $failed
