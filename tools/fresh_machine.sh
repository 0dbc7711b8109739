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

# shellcheck source=tools/debian_root.sh
. "$(dirname "${BASH_SOURCE[0]}")/debian_root.sh"

release="" compiler=g++ commands=()
for word in "$@"; do
  case "$word" in
    12 | 13) release=$(release_name "$word") ;;
    --clang) compiler=clang++ ;;
    --keep) keep_roots=true ;;
    -h | --help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) commands+=("$word") ;;
  esac
done
[ -n "$release" ] || { usage >&2; exit 2; }
[ ${#commands[@]} -gt 0 ] || commands=(demo test)
own_mounts "$0" "$@"

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=ca-certificates,git
[ "$compiler" = g++ ] || packages+=,clang
make_root "$release" "$packages"
git clone -q "file://$repository" "$root/candela"

failed=0 report=()
for command in "${commands[@]}"; do
  say "== ./dev $command"
  begin=$SECONDS
  # shellcheck disable=SC2086  # a command's arguments are words
  if in_root "$root" CXX="$compiler" /candela/dev $command >&2; then
    result=passed
  else
    result=FAILED failed=1
  fi
  report+=("$result: ./dev $command, $release, $compiler, $((SECONDS - begin)) s")
done
printf '%s\n' "${report[@]}"
exit $failed
