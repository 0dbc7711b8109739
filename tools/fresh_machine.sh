#!/usr/bin/env bash
# Tries the repository as somebody with a new machine would: makes a minimal Debian in a folder, clones what is committed
# into it, runs ./dev demo and ./dev test there, and says how each went.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/fresh_machine.sh 12|13 [--clang] [--keep] [COMMAND...]

  12, 13     the release of Debian
  --clang    build with its clang++ in place of g++
  --keep     leave the folder behind, and say where it is
  COMMAND    of ./dev, each with its arguments in one word: demo, test, lint, "test --all" [demo test]

Needs root, debootstrap, about 6 GB in TMPDIR (/var/tmp), the network and half an hour. Logs go to stderr.
TEXT
}

say() { printf '%s\n' "$*" >&2; }
die() { say "fresh_machine: $*"; exit 1; }

release="" compiler=g++ keep=false commands=()
for word in "$@"; do
  case "$word" in
    12) release=bookworm ;;
    13) release=trixie ;;
    --clang) compiler=clang++ ;;
    --keep) keep=true ;;
    -h | --help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) commands+=("$word") ;;
  esac
done
[ -n "$release" ] || { usage >&2; exit 2; }
[ ${#commands[@]} -gt 0 ] || commands=(demo test)
[ "$(id -u)" -eq 0 ] || die "needs root, as debootstrap does"
command -v debootstrap >/dev/null || die "needs the package debootstrap"

# Mounts of a namespace of their own are gone with it, however this ends.
if [ -z "${CANDELA_OWN_MOUNTS-}" ]; then
  CANDELA_OWN_MOUNTS=1 exec unshare --mount --propagation private -- "$0" "$@"
fi

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
root=$(mktemp -d "${TMPDIR:-/var/tmp}/candela-$release-XXXXXX")
# shellcheck disable=SC2317  # the trap calls it
clean_up() {
  umount "$root/proc" "$root/dev" 2>/dev/null || true
  if $keep; then say "left behind: $root"; else rm -rf --one-file-system "$root"; fi
}
trap clean_up EXIT

packages=ca-certificates,git
[ "$compiler" = g++ ] || packages+=,clang
say "== a minimal Debian ($release) in $root"
debootstrap --variant=minbase --include="$packages" "$release" "$root" >&2
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
git clone -q "file://$repository" "$root/candela"

failed=0 report=()
for command in "${commands[@]}"; do
  say "== ./dev $command"
  begin=$SECONDS
  # shellcheck disable=SC2086  # a command's arguments are words
  if chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 CXX="$compiler" \
    http_proxy="${http_proxy-}" https_proxy="${https_proxy-}" /candela/dev $command >&2; then
    result=passed
  else
    result=FAILED failed=1
  fi
  report+=("$result: ./dev $command, $release, $compiler, $((SECONDS - begin)) s")
done
printf '%s\n' "${report[@]}"
exit $failed
