#!/bin/sh
# The lines of `candela plan` by GNU parallel, then its merges; what is done already is left out.
# gnu_parallel.sh LIST.txt [--sshlogin a,b,c,: and other options of parallel]
set -eu
list=$1
shift
for lines in "$list" "${list%.txt}-merge.txt"; do
  [ -e "$lines" ] || continue
  # A line uses all cores of its machine.
  parallel --jobs 1 --retries 3 --joblog "$lines.log" --resume-failed "$@" <"$lines"
done
