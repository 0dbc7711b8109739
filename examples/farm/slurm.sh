#!/bin/sh
# The lines of `candela plan` as a Slurm array, its merges as a second one after it; each is tried three times.
# slurm.sh LIST.txt [--cpus-per-task=16 --time=20 and other options of sbatch]
set -eu
list=$1 merges=${1%.txt}-merge.txt
shift
submit() { # LINES OPTION…
  lines=$1
  shift
  sbatch --parsable --requeue --array="1-$(wc -l <"$lines")" "$@" <<TEXT
#!/bin/sh
sh -c "\$(sed -n "\${SLURM_ARRAY_TASK_ID}p" '$lines')" && exit
[ "\${SLURM_RESTART_COUNT:-0}" -ge 2 ] || scontrol requeue "\$SLURM_JOB_ID"
exit 1
TEXT
}
array=$(submit "$list" "$@")
echo "$array"
[ ! -e "$merges" ] || submit "$merges" --dependency="afterany:$array" "$@"
