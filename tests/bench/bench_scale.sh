#!/usr/bin/env bash
# Bakes and draws scenes of many triangles and prints what both take: seconds, peak memory, bytes.
# A scene is so many copies of a room, side by side: a bumpy sphere of a million triangles with UVs
# and normals.
# Usage: tests/bench/bench_scale.sh [MILLIONS...]    default: 1 10 50; 50 want 7 GB of disk
# Wants GNU time. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."

work=build/bench
bin=build/release/bin
mkdir -p "$work"

# make_rooms COUNT FILE
make_rooms() {
    awk -v count="$1" 'BEGIN {
        n = 707; pi = atan2(0, -1)
        for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) {
            t = pi * (0.01 + 0.98 * y / n); p = 2 * pi * x / n
            r = 1.2 + 0.05 * sin(9 * p) * sin(7 * t) + 0.01 * sin(61 * p + 43 * t)
            nx = sin(t) * cos(p); ny = cos(t); nz = sin(t) * sin(p)
            i = y * (n + 1) + x
            px[i] = r * nx; py[i] = r * ny; pz[i] = r * nz
            rest[i] = sprintf("vt %.5f %.5f\nvn %.4f %.4f %.4f", x / n, y / n, nx, ny, nz)
        }
        vertices = (n + 1) * (n + 1)
        columns = int(sqrt(count - 1)) + 1
        for (room = 0; room < count; ++room) {
            ox = 3 * (room % columns); oz = 3 * int(room / columns)
            printf "o room%d\n", room
            for (i = 0; i < vertices; ++i)
                printf "v %.6f %.6f %.6f\n%s\n", ox + px[i], py[i], oz + pz[i], rest[i]
            for (y = 0; y < n; ++y) for (x = 1; x <= n; ++x) {
                a = room * vertices + y * (n + 1) + x; b = a + 1; c = a + n + 1; d = c + 1
                printf "f %d/%d/%d %d/%d/%d %d/%d/%d\nf %d/%d/%d %d/%d/%d %d/%d/%d\n", \
                    a, a, a, b, b, b, d, d, d, a, a, a, d, d, d, c, c, c
            }
        }
    }' >"$2"
}

# measure COMMAND...: prints "wall cpu KiB" of one run.
measure() {
    /usr/bin/time -f '%e %U %S %M' -o "$work/time" "$@" >/dev/null 2>"$work/log" || {
        cat "$work/log" >&2
        exit 1
    }
    awk '{ print $1, $2 + $3, $4 }' "$work/time"
}

printf '%9s  %-22s %8s %8s %8s %12s\n' triangles '' 'wall s' 'CPU s' MiB 'bytes each'
(($#)) || set -- 1 10 50
obj=$work/rooms.obj baked=$work/rooms.cw2mesh
for million; do
    make_rooms "$million" "$obj"
    # row TITLE RUN
    row() {
        awk -v m="$million M" -v t="$1" -v n=$((million * 2 * 707 * 707)) -v run="$2" 'BEGIN {
            split(run, r)
            printf "%9s  %-22s %8.2f %8.2f %8.0f %12.1f\n", m, t, r[1], r[2], r[3] / 1024, r[3] * 1024 / n
        }'
    }
    row "bake, $(($(stat -c %s "$obj") / 1000000)) MB" \
        "$(measure "$bin/cw2-bake" "$obj" -o "$baked" --quiet)"
    rm "$obj"
    row 'picture, 1 sample' "$(measure "$bin/cw2" "$baked" --output "$work/rooms.png" --samples 1)"
    row 'picture, 4 samples' "$(measure "$bin/cw2" "$baked" --output "$work/rooms.png")"
    rm "$baked"
done
