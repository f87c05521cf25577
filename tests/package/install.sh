#!/usr/bin/env bash
# An installed tree must work wherever it lies. Usage: install.sh BUILD SOURCE program|embed.
# Installs the build folder, moves the tree, and runs the program in it, or builds and runs
# examples/embed with it.
set -euo pipefail
build=$1 source=$2 what=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/first" >"$work/log" || { cat "$work/log"; exit 1; }
mv "$work/first" "$work/moved"
cd "$work"  # the program would find the scenarios of the source folder

case $what in
  program)
    # The scenario is given by name and by path. The robot and the box come from the tree as well.
    for scenario in box_9kg scenarios/dual_ur5.yaml; do
      moved/bin/predictor simulate "$scenario" --duration 1 --json "$work/summary.json" --force --quiet
      test -s "$work/summary.json"
    done
    if ldd moved/bin/predictor | grep -E "not found|$source|$build"; then
      echo "The installed program is linked with libraries outside the tree."
      exit 1
    fi
    for library in libmujoco libtinyxml2; do
      ldd moved/bin/predictor | grep "$library" | grep -q "moved/bin/../lib/predictor/"
    done
    grep -q "^.TH PREDICTOR 1" moved/share/man/man1/predictor.1
    grep -q "complete.* predictor" moved/share/bash-completion/completions/predictor
    grep -q MuJoCo moved/share/doc/predictor/THIRD_PARTY_NOTICES
    ;;
  embed)
    {
      cmake -S "$source/examples/embed" -B "$work/embed" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/moved"
      cmake --build "$work/embed"
    } >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
    "$work/embed/embed" | tee "$work/said"
    grep -q "1.000 s" "$work/said"
    ;;
esac
