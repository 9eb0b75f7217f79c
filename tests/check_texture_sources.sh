#!/usr/bin/env bash
# Checks that every file of the project that cw2-bake/textures/*.cpp include, directly or not, is among
# those whose contents decide whether an earlier bake's textures may be used again.
# Usage: check_texture_sources.sh LIST_OF_HASHED_FILES
set -euo pipefail
cd "$(dirname "$0")/.."

hashed=$(xargs -d '\n' realpath --relative-to=. <"$1")
to_read=$(echo cw2-bake/textures/*.cpp)
included=""
while [[ -n $to_read ]]; do
    # shellcheck disable=SC2086 # names of ours have no spaces
    headers=$(sed -nE 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*"([^"]+)".*/\1/p' $to_read)
    to_read=$(comm -13 <(sort <<<"$included") <(sort -u <<<"$headers"))
    included+=$'\n'$to_read
done

missing=$(comm -13 <(sort <<<"$hashed") <(sort -u <<<"$included" | sed '/^$/d'))
[[ -z $missing ]] || { sed 's/$/: not hashed by cw2-bake\/CMakeLists.txt/' <<<"$missing" && exit 1; }
