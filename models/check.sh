#!/usr/bin/env bash
# Checks the model of the safety state machine (safety.pml) with Spin: each property must hold in
# every state that can be reached, and each defect of defects.txt must be found.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

usage() {
  cat <<'TEXT'
Usage: models/check.sh [properties|defects]

  properties   every property, all at once, with few messages under way; with PREDICTOR_SOAK set
               also with more of them, and every property by itself (about ten minutes)
  defects      every seeded defect: the property that guards against it must be violated
  (nothing)    both

A search that is not complete, or too deep for its stack, counts as failed.
TEXT
}

die() { printf 'check.sh: %s\n' "$*" >&2; exit 2; }

cc=${CC:-cc}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

small=(-DWIRE=1 -DMAIL=1 -DROOM=1 -DPRESSES=1)
on_the_wire=(-DWIRE=2 -DMAIL=1 -DROOM=1 -DPRESSES=1)
at_the_run=(-DWIRE=1 -DMAIL=2 -DROOM=2 -DPRESSES=2)
deepest=2000000  # steps of a search's stack

# make_search NAME CFLAGS MODEL_FLAGS... builds the program that searches, $work/NAME/pan.
make_search() {
  local folder=$work/$1 cflags=$2
  mkdir -p "$folder"
  cp "$here"/*.pml "$folder"  # Spin writes a counterexample next to its model
  (
    cd "$folder"
    spin -a "${@:3}" safety.pml >spin.log 2>&1 || { cat spin.log; exit 1; }
    # shellcheck disable=SC2086
    $cc -w $cflags -DMEMLIM=2000 -o pan pan.c
  ) || die "the model does not compile"
}

field() { sed -n "s/$2/\\1/p" "$1" | head -1; }

violation='\(assertion violated  *! *( *! *(\|acceptance cycle\|end state in claim reached\)'

# Runs one search. Sets errors, and the reason why the search does not count ("" if it does).
search() {
  local log=$work/log
  (cd "$work/$1" && ./pan -b -m"$deepest" -w22 "${@:3}" -N "$2") >"$log" 2>&1 || true
  errors=$(field "$log" '.*errors: \([0-9]*\).*')
  states=$(field "$log" ' *\([0-9.e+]*\) states, stored.*')
  depth=$(field "$log" '.*depth reached \([0-9]*\),.*')
  seconds=$(field "$log" 'pan: elapsed time \([0-9.]*\) seconds')
  memory=$(field "$log" ' *\([0-9.]*\).*total actual memory usage.*')
  why=""
  if [ -z "$errors" ] || grep -q 'unexpected\|error:' "$log"; then
    why="no result: $(tail -1 "$log")"
  elif grep -q 'max search depth too small' "$log"; then
    why="too deep"
  elif [ "$errors" = 0 ] && grep -q 'Search not completed' "$log"; then
    why="not complete"
  elif [ "$errors" != 0 ] && ! grep -q "^pan:1: $violation" "$log"; then
    why=$(grep '^pan:1:' "$log")  # the log contains another failure than that of the property
  fi
}

row() { printf '%-26s %-9s %12s %9s %8s %8s  %s\n' "$@"; }

# expect VIOLATED SEARCH PROPERTY FLAGS...: VIOLATED is "no" or "yes".
expect() {
  local verdict=ok
  search "${@:2}"
  if [ -n "$why" ]; then
    verdict="FAILED: $why"
  elif [ "$1" = no ] && [ "$errors" != 0 ]; then
    verdict="FAILED: violated"
  elif [ "$1" = yes ] && [ "$errors" = 0 ]; then
    verdict="FAILED: not possible"
  fi
  [ "$verdict" = ok ] || failed=1
  row "$3" "${errors:--}" "${states:--}" "${depth:--}" "${seconds:-0} s" "${memory:--} MB" "$verdict"
}

properties() { sed -n 's/^ltl \([a-z_]*\) .*/\1/p' "$here/safety.pml"; }

# Returns whether a property can be violated only by pages and leases. The violation of any other
# property is found much sooner if the viewer may do anything.
of_pages() { [[ $1 =~ ^(one_holder|holder_commands|runs_out|passed_on|can_hand_over)$ ]]; }

check_properties() {
  # The end of a stop hardly depends on who requested the stop, so only the long check also searches a viewer that does
  # not lie.
  local ends=(-DLIES) fast="-O2 -DSAFETY -DNOREDUCE" property
  row property errors states depth time memory ""
  if [ -n "${PREDICTOR_SOAK:-}" ]; then
    ends=()
    make_search on_the_wire "$fast" "${on_the_wire[@]}"
    expect no on_the_wire all
    make_search at_the_run "$fast" "${at_the_run[@]}"
    expect no at_the_run all
  fi
  make_search small "$fast" "${small[@]}"
  expect no small all
  # If no search reached a statement, the model would check less than it seems to.
  if grep -E 'state [0-9]+, "' "$work/log" | grep -v -e '"-end-"'; then failed=1; fi
  for property in ${PREDICTOR_SOAK:+$(properties | grep -vE '^(all|standstill|can_.*)$')}; do
    expect no small "$property"
  done
  make_search cycles "-O2 -DNFAIR=3" "${small[@]}" "${ends[@]}"
  expect no cycles standstill -a -f
  printf '\nWhat must be possible: a property that says it is not must be violated.\n'
  make_search possible -O1 "${small[@]}"
  make_search possible_here -O1 "${small[@]}" -DLIES
  for property in $(properties | grep '^can_'); do
    if of_pages "$property"; then expect yes possible "$property" -a
    else expect yes possible_here "$property" -a; fi
  done
}

# The list and the model must contain the same defects, and each property must have one.
check_list() {
  local listed
  listed=$(grep -v '^#' "$here/defects.txt")
  diff <(cut -d' ' -f1 <<<"$listed" | sort -u) \
    <(grep -oh 'DEFECT [!=]= [1-9][0-9]*' "$here"/*.pml | grep -o '[0-9]*' | sort -u) ||
    die "defects.txt and the model do not have the same defects"
  diff <(awk '{print $2}' <<<"$listed" | sort -u) \
    <(properties | grep -vE '^(all|can_.*)$' | sort -u) ||
    die "there are properties that no defect violates"
}

check_defects() {
  local number property words
  check_list
  printf 'Defects on purpose: each must violate the property that guards against it.\n'
  row property errors states depth time memory ""
  while read -r number property words; do
    local flags=(-DLIES) how=()
    if of_pages "$property"; then flags=(); fi
    if [ "$property" = standstill ]; then how=(-a -f); fi
    make_search "defect$number" "-O0 -DNFAIR=3" "${small[@]}" "${flags[@]}" "-DDEFECT=$number"
    expect yes "defect$number" "$property" "${how[@]}"
    printf '    %s. %s\n' "$number" "$words"
  done < <(grep -v '^#' "$here/defects.txt")
}

command -v spin >/dev/null || die "Spin is missing: apt-get install spin (deps/apt-models.txt)"
case ${1:-} in
  properties) check_properties ;;
  defects) check_defects ;;
  "") check_properties; printf '\n'; check_defects ;;
  *) usage; exit 2 ;;
esac
if [ $failed -ne 0 ]; then printf '\nFAILED\n'; exit 1; fi
printf '\nAll as it should be.\n'
