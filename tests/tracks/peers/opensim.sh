#!/bin/sh
# Runs the test of the exported files in OpenSim in ./dev soak. Otherwise the test is skipped (77).
[ "${PREDICTOR_SOAK:-}" = 1 ] || exit 77
exec "$1" "$(dirname "$0")/opensim_torques.py"
