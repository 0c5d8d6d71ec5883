#!/usr/bin/env bash
# abn.sh [ARGUMENTS…]  installs what is missing (apt, with sudo if needed), builds, and runs `abn ARGUMENTS…`.
# Without arguments it runs the main job: apple 3000² → 200², 240 000 samples, eight strategies, pictures, error maps, table.
# Works from any folder and never changes it; its own messages go to stderr.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
# shellcheck source=cmake/setup.sh
. "$root/cmake/setup.sh"
up_to_date || build abn
if (($# == 0)); then
  set -- run main --out "$root/results/runs/main" --overwrite
fi
exec "$build_dir/abn" "$@"
