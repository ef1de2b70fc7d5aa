#!/bin/bash
# The steps of distribution/Dockerfile in a throw-away folder, where no docker is: a wheel, an environment of its own, a cache
# that only its owner reads, and a check. `bash distribution/container.sh [FOLDER]` leaves FOLDER/env/bin/seatrial to use.
set -euo pipefail
source=$(cd "$(dirname "$0")/.." && pwd)
folder=${1:-$(mktemp -d)}
mkdir -p "$folder"

# build
python3 -m venv "$folder/build"
"$folder/build/bin/pip" wheel --quiet --no-deps --wheel-dir "$folder/wheels" "$source"

# run
python3 -m venv "$folder/env"
wheel=$(ls "$folder"/wheels/seatrial-*.whl)
"$folder/env/bin/pip" install --quiet --constraint "$source/constraints.txt" "$wheel[app,formats,logs]"
install --directory --mode 700 "$folder/cache"
SEATRIAL_CACHE="$folder/cache" OPENBLAS_NUM_THREADS=1 "$folder/env/bin/seatrial" doctor
