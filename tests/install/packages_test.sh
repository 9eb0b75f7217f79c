#!/usr/bin/env bash
# Makes the packages and looks into them. Usage: packages_test.sh BUILD_FOLDER WORK_FOLDER
set -euo pipefail
build=$1
work=$2

fail() {
    echo "packages_test.sh: $*" >&2
    exit 1
}

rm -rf "$work"
mkdir -p "$work/archive"
(cd "$build" && cpack -B "$work" >"$work/cpack.txt" 2>&1) || { cat "$work/cpack.txt" && exit 1; }
if grep -A3 'Warning' "$work/cpack.txt"; then fail "cpack warns"; fi

# In the archive is all that the programs load, and their licences.
tar -xzf "$work"/cw2-*.tar.gz -C "$work/archive" --strip-components=1
cd "$work/archive"
for program in bin/cw2 bin/cw2-bake lib/cw2/draco_reader.so; do
    mapfile -t elsewhere < <(ldd "$program" | sed -n 's/.*=> \([^ ]*\).*/\1/p' |
        grep -vE "^$PWD/|/(libc|libm|libgcc_s|libstdc\+\+|libdl|libpthread|librt|libresolv)\.so")
    # A module finds them through the program.
    [[ $program == *.so || ${#elsewhere[@]} -eq 0 ]] || fail "$program loads ${elsewhere[*]}"
done
[[ $(env -i "$PWD/bin/cw2-bake" --version) == "cw2-bake "* ]] || fail "the archive's cw2-bake"
[[ $(env -i "$PWD/bin/cw2" --list-views | wc -l) -gt 10 ]] || fail "the archive's cw2"
[[ -e share/cw2/DejaVuSans.ttf ]] || fail "the archive has no font"
for library in libfmt libtbb zlib libglfw; do
    compgen -G "share/doc/cw2/licenses/$library*" >/dev/null || fail "no licence of $library"
done

# shellcheck disable=SC2144 # one of each
[[ -e $(echo "$work"/cw2_*.deb) ]] || { echo "skipped: Debian packages take dpkg-dev and file" && exit 77; }
maintainer=$(sed -n 's/^CW2_MAINTAINER:STRING=//p' "$build/CMakeCache.txt")
for package in "$work"/*.deb; do
    [[ $(dpkg-deb -f "$package" Maintainer) == "$maintainer" ]] || fail "$package does not name '$maintainer'"
    [[ $(dpkg-deb --fsys-tarfile "$package" | tar -xO --wildcards '*/changelog.gz' | zcat) == *" -- $maintainer  "* ]] ||
        fail "the changelog of $package does not name '$maintainer'"
done
depends=$(dpkg-deb -f "$work"/cw2_*.deb Depends)
for library in libc6 libfmt libglfw3 libvulkan1; do
    [[ $depends == *$library* ]] || fail "cw2 does not depend on $library: $depends"
done
[[ $depends != *openimageio* ]] || fail "cw2 depends on OpenImageIO"
[[ $(dpkg-deb -f "$work"/cw2-openimageio_*.deb Depends) == *"cw2 (= "*libopenimageio* ]] ||
    fail "cw2-openimageio depends on $(dpkg-deb -f "$work"/cw2-openimageio_*.deb Depends)"
if command -v lintian >/dev/null; then
    lintian --allow-root --fail-on error "$work"/*.deb >"$work/lintian.txt" || { cat "$work/lintian.txt" && exit 1; }
fi
