#!/usr/bin/env bash
# Applies each patch of this folder to a copy of the tree, builds the tests that cases.txt names for it, and runs them.
# This proves how many files an extension touches. run.sh [NAME...] runs only the named patches.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD work=$PWD/build/extending code=0

trim() { sed 's/^[[:space:]]*//; s/[[:space:]]*$//' <<<"$1"; }

# Counts the files that a patch touches outside tests. Generated files do not count.
touched() { sed -n 's|^+++ b/||p' "$1" | grep -v '^tests/' || true; }

# Lists tracked and new files, except removed ones.
copy_tree() {
  mkdir -p "$1"
  git ls-files -z --cached --others --exclude-standard |
    while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar --null --no-recursion -T - -cf - | tar -xf - -C "$1"
  ln -s "$root/.deps" "$1/.deps"
  [ ! -d web/dist ] || cp -a web/dist "$1/web/"
}

run_case() {
  local name=$1 most=$2 generate=$3 tests=$4 patch=$root/tests/extending/$1.patch files test
  files=$(touched "$patch")
  echo "== $name: $(wc -l <<<"$files") files ($(tr '\n' ' ' <<<"$files"))"
  if [ "$(wc -l <<<"$files")" -gt "$most" ]; then echo "$name: more than $most files" >&2; return 1; fi
  rm -rf "$work"
  copy_tree "$work"
  cd "$work"
  patch -p1 --quiet --no-backup-if-mismatch <"$patch" || { echo "$name: the patch does not apply" >&2; return 1; }
  cmake --preset release >/dev/null || return 1
  if [ "$generate" != - ]; then
    ninja -C build/release "${generate%%:*}" >&2 || return 1
    BIN=$PWD/build/release/bin bash -c "${generate#*:}" || return 1
  fi
  for test in $tests; do
    ninja -C build/release "${test%%:*}" >&2 || return 1
    build/release/bin/"${test%%:*}" --gtest_filter="${test#*:}" 2>&1 | tee log || return 1
    grep -q '^\[  PASSED  \] [1-9]' log || { echo "$name: no test of $test ran" >&2; return 1; }
  done
}

while IFS='|' read -r name most generate tests; do
  name=$(trim "$name")
  case $name in '' | '#'*) continue ;; esac
  [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
  (run_case "$name" "$(trim "$most")" "$(trim "$generate")" "$(trim "$tests")") || { echo "FAILED: $name" >&2; code=1; }
done <tests/extending/cases.txt
rm -rf "$work"
exit $code
