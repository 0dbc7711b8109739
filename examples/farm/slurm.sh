#!/bin/sh
# The lines of `candela plan` as a Slurm array, its merges as a second one after it.
# slurm.sh LIST.txt [--cpus-per-task=16 --time=20 and other options of sbatch]
set -eu
list=$1 merges=${1%.txt}-merge.txt
shift
submit() { # LINES OPTION…
  lines=$1
  shift
  sbatch --parsable --requeue --array="1-$(wc -l <"$lines")" "$@" \
    --wrap "sh -c \"\$(sed -n \"\${SLURM_ARRAY_TASK_ID}p\" '$lines')\""
}
array=$(submit "$list" "$@")
echo "$array"
[ ! -e "$merges" ] || submit "$merges" --dependency="afterany:$array" "$@"
