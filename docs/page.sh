#!/usr/bin/env bash
# Writes docs/figures.md, or another OUTPUT: the template figures.md.in, in which
#     @{PATH|TEXT}   is a link to the one line of the file that has the text,
#     @{frames}      are the table's rows: what each form of the tangent frames does to the demo scene.
# Usage: docs/page.sh BUILD_DIRECTORY [OUTPUT]
set -euo pipefail
build=$(realpath "$1")
output=$(realpath "${2:-$(dirname "$0")/figures.md}")
cd "$(dirname "$0")"

bake=$build/bin/cw2-bake
model=$build/assets/demo/courtyard.obj
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

frames() {
    local form
    for form in f32:16 half3:6 quat48:6 quat32:4; do
        "$bake" "$model" -o "$work/scene.cw2mesh" --tangent-frame "${form%:*}" --textures none \
            --quiet --stats "$work/stats.json"
        # Two digits: more would depend on the machine's floats.
        awk -v form="${form%:*}" -v bytes="${form#*:}" '
            function degrees(x) { return x < 0.00005 ? "below 0.0001" : sprintf("%.2g", x) }
            $1 == "\"error_mean_degrees\":" { mean = $2 + 0 }
            $1 == "\"error_max_degrees\":" { worst = $2 + 0 }
            END { printf "| `%s` | %d | %s | %s |\n", form, bytes, degrees(mean), degrees(worst) }
        ' "$work/stats.json"
    done
}

link_to() {
    local path=$1 text=$2 lines
    mapfile -t lines < <(grep -nF -- "$text" "../$path" | cut -d: -f1)
    if [[ ${#lines[@]} -ne 1 ]]; then
        echo "docs/figures.md.in: ${#lines[@]} lines of $path have '$text'" >&2
        return 1
    fi
    printf '[%s:%d](../%s#L%d)' "$path" "${lines[0]}" "$path" "${lines[0]}"
}

while IFS= read -r line; do
    while [[ $line =~ @\{([^|}]*)\|([^}]*)\} ]]; do
        marker=${BASH_REMATCH[0]}
        link=$(link_to "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}")
        line=${line/"$marker"/"$link"}
    done
    if [[ $line == '@{frames}' ]]; then frames; else printf '%s\n' "$line"; fi
done <figures.md.in >"$work/page.md"
mv "$work/page.md" "$output"
