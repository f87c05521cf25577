# shellcheck shell=bash
# The commands `./dev soak` and `./dev fuzz`. `dev` reads this file and provides the functions that install and build.

# Runs the long versions of the sampled tests: all, or those whose names match. Adds a row for each to
# docs/soak-record.csv.
soak() {
  case ${1:-} in
    tsan) soak_tsan; return ;;
    asan) PRESET=asan-all run_tests; return ;;
    extending) soak_extending "${@:2}"; return ;;
    package) soak_package; return ;;
  esac
  need_spin
  [ -n "${1:-}" ] || need_browser
  [[ -n "${1:-}" && opensim != *"${1:-}"* ]] || need_opensim
  [[ -n "${1:-}" && MyoArmPackage != *"${1:-}"* ]] || need_myo
  build release
  # The output of a fault's runs is its row of the fault table, so the output is printed. Runs that the same build has
  # already completed are kept in build/faults and not repeated.
  mkdir -p build/faults
  local code=0 results=$PWD/build/release/soak.xml
  PREDICTOR_FAULTS=$PWD/build/faults PREDICTOR_SOAK=1 ctest --test-dir build/release --output-on-failure ${1:+--verbose} \
    --test-output-size-passed 1000000 --output-junit "$results" -R "${1:-}.*Soak|Soak.*${1:-Soak}" || code=$?
  # A shortened trial does not count as a long run.
  if [ -z "${PREDICTOR_SOAK_SECONDS:-}" ]; then
    python3 tests/soak/record.py docs/soak-record.csv "$(commit)" "$results"
  fi
  return $code
}

# Prints the commit, with a + if the sources differ from it.
commit() {
  local differs=""
  git diff --quiet HEAD -- . ':!docs/soak-record.csv' || differs=+
  echo "$(git rev-parse --short HEAD)$differs"
}

# Adds a row to the record of long runs: the command's name and exit code.
add_row() {
  printf '%s,%s,%s,-,%s,%s\n' "$(date +%F)" "$(commit)" "$1" "$SECONDS" "$([ "$2" -eq 0 ] && echo passed || echo failed)" \
    >>docs/soak-record.csv
}

# Applies, builds and runs the patches of tests/extending, or those named.
soak_extending() {
  local code=0
  setup
  tests/extending/run.sh "$@" || code=$?
  [ $# -gt 0 ] || add_row extending $code
  return $code
}

# Installs, runs and removes the package in a bare Debian 12.
soak_package() {
  local code=0
  need_packages deps/apt-bare.txt
  package
  tests/package/bare_debian.sh build/package/predictor_*.deb || code=$?
  add_row package $code
  return $code
}

# Runs the program's threads under the thread sanitizer: viewer, recorder, supervisor, watchdog, ROS-TCP and the loop,
# each by the tests of its module. Findings in any of their processes are written to build/tsan/findings.*.
soak_tsan() {
  local test tests=(core watchdog ros_tcp recording viewer) code=0 results=$PWD/build/tsan
  build tsan predictor "${tests[@]/#/test_}" test_process test_emulator
  rm -f "$results"/findings.*
  # The sandbox refuses system calls that the thread sanitizer makes when its process ends.
  for test in "${tests[@]}" 'process:-SandboxTest.RefusesAllThatIsNotNeeded' 'emulator:RealTime*'; do
    say "Thread sanitizer: ${test%%:*}"
    # The thread sanitizer's memory map does not work with every randomised address space layout of the kernel.
    # Some tests fork while they have threads.
    TSAN_OPTIONS="die_after_fork=0 log_path=$results/findings suppressions=$PWD/tests/soak/tsan.supp second_deadlock_stack=1" \
      setarch "$(uname -m)" -R build/tsan/bin/"test_${test%%:*}" --gtest_brief=1 \
      --gtest_filter="$(if [[ $test == *:* ]]; then echo "${test#*:}"; else echo '*'; fi)" || code=1
  done
  if compgen -G "$results/findings.*" >/dev/null; then
    cat "$results"/findings.* >&2
    code=1
  fi
  add_row tsan $code
  return $code
}

# Findings are written to build/fuzz/found; tests/fuzz/pack.sh adds useful ones to the corpus.
fuzz() {
  local name=${1:?a target of tests/fuzz} seconds=${2:-60}
  setup
  need_packages deps/apt-fuzz.txt
  [ -f build/fuzz/build.ninja ] || CC=clang-14 CXX=clang++-14 cmake -G Ninja -B build/fuzz -DCMAKE_BUILD_TYPE=Release \
    -DPREDICTOR_FUZZ=ON -DPREDICTOR_WERROR=OFF -DPREDICTOR_PRECOMPILE=OFF -DPREDICTOR_UNITY=OFF \
    -DCMAKE_CXX_FLAGS="-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all" >/dev/null
  ninja -C build/fuzz "fuzz_$name" >&2
  mkdir -p "build/fuzz/found/$name"
  (cd "build/fuzz/found/$name" && ../../bin/"fuzz_$name" -max_total_time="$seconds" -print_final_stats=1 \
    . ../../tests/fuzz/corpus/"$name")
}
