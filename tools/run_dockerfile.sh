#!/usr/bin/env bash
# Does what the Dockerfile says without Docker: each FROM is a minimal Debian in a folder, each RUN is run in it by chroot.
# Knows the instructions that the file has, and refuses others.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/run_dockerfile.sh [--keep] [--ccache DIR] [--packages DIR] [ARGUMENT...]

  --keep           leave the folders behind, and say where they are
  --ccache DIR     keep what is compiled there, for the next run
  --packages DIR   put the packages that it makes there, too
  ARGUMENT         of the image's program, which is run with DIR, or an empty folder, as /data [--version]

Needs root, debootstrap, about 5 GB in TMPDIR (/var/tmp), the network and a quarter of an hour. Logs go to stderr.
TEXT
}

# shellcheck source=tools/debian_root.sh
. "$(dirname "${BASH_SOURCE[0]}")/debian_root.sh"

all=("$@") packages=""
while [ $# -gt 0 ]; do
  case "$1" in
    --keep) keep_roots=true ;;
    --ccache) objects=${2?"--ccache: the folder is missing"}; shift ;;
    --packages) packages=${2?"--packages: the folder is missing"}; shift ;;
    -h | --help) usage; exit 0 ;;
    *) break ;;
  esac
  shift
done
arguments=("$@")
[ ${#arguments[@]} -gt 0 ] || arguments=(--version)
own_mounts "$0" "${all[@]}"

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
declare -A stages=()
root="" workdir=/ entrypoint=()

from() { # IMAGE [AS NAME]
  local release
  release=$(release_name "$(sed -n 's/^debian:\([0-9]*\)-slim$/\1/p' <<<"$1")")
  [ -n "$release" ] || die "Dockerfile: FROM knows debian:12-slim and debian:13-slim, not $1"
  make_root "$release"
  stages[${3:-last}]=$root
  workdir=/ entrypoint=()
}

copy() { # [--from=STAGE] SOURCE TARGET
  local source=$repository
  if [[ $1 == --from=* ]]; then
    source=${stages[${1#--from=}]}
    shift
  fi
  if [ "$1" = . ]; then # the context: what is committed, so that nothing of this machine comes along
    git clone -q "file://$source" "$root$2"
  else
    # shellcheck disable=SC2086  # the pattern is meant
    cp -R "$source"/$1 "$root$2"
  fi
}

while read -r instruction rest; do
  case "$instruction" in
    '' | '#'*) continue ;;
  esac
  say "== $instruction $rest"
  # shellcheck disable=SC2086  # an instruction's arguments are words
  case "$instruction" in
    FROM) from $rest ;;
    COPY) copy $rest ;;
    RUN) in_root "$root" DEBIAN_FRONTEND=noninteractive sh -c "cd '$workdir' && $rest" >&2 </dev/null ;;
    WORKDIR) workdir=$rest && mkdir -p "$root$workdir" ;;
    ENTRYPOINT) mapfile -t entrypoint < <(python3 -c 'import json, sys; print(*json.loads(sys.argv[1]), sep="\n")' "$rest") ;;
    *) die "Dockerfile: unknown instruction $instruction" ;;
  esac
done <"$repository/Dockerfile"

if [ -n "$packages" ]; then
  mkdir -p "$packages"
  cp "${stages[build]}"/candela/out/* "$packages"
fi
say "== the image has $(du -sh -x "$root" | cut -f 1); it runs: ${entrypoint[*]} ${arguments[*]}"
# shellcheck disable=SC2016  # the shell in the folder fills it
in_root "$root" sh -c 'cd "$1" && shift && exec "$@"' sh "$workdir" "${entrypoint[@]}" "${arguments[@]}"
