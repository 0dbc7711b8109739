# shellcheck shell=bash
# Minimal Debians in folders, for the scripts that source this. They need root and debootstrap, and are gone with the script.

say() { printf '%s\n' "$*" >&2; }
die() { say "$(basename "$0" .sh): $*"; exit 1; }

# The name of a release that is given as 12 or 13; nothing of another.
release_name() {
  case "$1" in
    12) echo bookworm ;;
    13) echo trixie ;;
  esac
}

roots=() keep_roots=false
objects="" # a folder in which ccache keeps what is compiled, from run to run; empty = none
# shellcheck disable=SC2317  # a trap calls it
remove_roots() {
  local root
  for root in "${roots[@]}"; do
    umount "$root"/* 2>/dev/null || true
    if $keep_roots || mountpoint -q "$root/ccache"; then
      say "left behind: $root"
    else
      rm -rf --one-file-system "$root"
    fi
  done
}

# own_mounts "$0" "$@": begins the script again with mounts of its own, which are gone with it, however it ends.
own_mounts() {
  [ "$(id -u)" -eq 0 ] || die "needs root, as debootstrap does"
  command -v debootstrap >/dev/null || die "needs the package debootstrap"
  [ -n "${CANDELA_OWN_MOUNTS-}" ] || CANDELA_OWN_MOUNTS=1 exec unshare --mount --propagation private -- "$@"
  trap remove_roots EXIT
}

# make_root RELEASE [PACKAGES]: leaves the folder's path in `root`; PACKAGES are separated by commas.
make_root() {
  root=$(mktemp -d "${TMPDIR:-/var/tmp}/candela-$1-XXXXXX")
  roots+=("$root")
  say "== a minimal Debian ($1) in $root"
  local packages=${2-}
  [ -z "$objects" ] || packages+=${packages:+,}ccache
  debootstrap --variant=minbase ${packages:+--include="$packages"} "$1" "$root" >&2
  mount -t proc proc "$root/proc"
  mount --bind /dev "$root/dev"
  [ -n "$objects" ] || return 0
  mkdir -p "$objects" "$root/ccache"
  mount --bind "$objects" "$root/ccache"
}

# in_root ROOT [NAME=VALUE…] COMMAND…: runs it there with a bare environment.
in_root() {
  local into=$1
  shift
  chroot "$into" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    CCACHE_DIR=/ccache http_proxy="${http_proxy-}" https_proxy="${https_proxy-}" "$@"
}
