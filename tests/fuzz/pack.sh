#!/usr/bin/env bash
# Packs the inputs of a fuzz target: tests/fuzz/pack.sh NAME FOLDER writes tests/fuzz/corpus/NAME.tar.gz.
# Every build unpacks it into tests/fuzz/corpus/NAME of the build folder. To add an input, put a file there, pack that
# folder, and increase the target's number of INPUTS in tests/fuzz/CMakeLists.txt.
set -euo pipefail
name=${1:?the name of a fuzz target}
folder=${2:?the folder that holds its inputs}
out=$(dirname "${BASH_SOURCE[0]}")/corpus/$name.tar.gz
# The archive depends only on the files' names and contents.
(cd "$folder" && find . -type f -printf '%P\0' | sort -z) |
  tar -C "$folder" --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u=rw,go=r --format=ustar \
    --null --files-from=- -cf - | gzip -9n >"$out"
echo "$out: $(tar tzf "$out" | wc -l) inputs"
