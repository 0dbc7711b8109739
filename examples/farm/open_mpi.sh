#!/bin/sh
# A worker on each machine that mpirun has; one that dies does not end the others.
# open_mpi.sh LIST.txt [--hostfile FILE and other options of Open MPI]
set -eu
list=$1
shift
mpirun --map-by ppr:1:node --bind-to none --enable-recovery "$@" candela worker "$list"
