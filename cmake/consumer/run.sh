#!/usr/bin/env bash
# Installs a build into a scratch prefix, then configures, builds and runs the outside consumer against it.
set -euo pipefail
build=$1 scratch=$2 generator=$3
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$scratch"
cmake --install "$build" --prefix "$scratch/prefix" >/dev/null
cmake -G "$generator" -S "$here" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$scratch/build" >/dev/null
"$scratch/build/consumer"
