#!/usr/bin/env bash
# What the README's table says: the demo scene baked beside gltfpack, and drawn beside f3d and, where
# Chromium is, three.js. Builds what that takes. RUNS=N sets how often each runs [5]. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."
cmake --preset release >/dev/null
cmake --build --preset release --target cw2 cw2-bake demo-scene bench_frames -- --quiet
tests/bench/bench_bake.sh build/release/assets/demo/courtyard.obj
tests/bench/bench_render.sh
