#!/usr/bin/env bash
# Runs test.sh in a clean Debian: `./test.sh --root RELEASE ...` calls it. The first run makes the
# root, build/roots/RELEASE, by debootstrap; later ones use it and its build again. The mirror is
# debootstrap's own, or $MIRROR.
# Usage: in_root.sh bookworm|trixie [ARGUMENT OF test.sh ...]
set -euo pipefail
sources=$(cd "$(dirname "$0")/.." && pwd)

fail() {
    echo "in_root.sh: $*" >&2
    exit 1
}

release=${1:-}
[[ $release == bookworm || $release == trixie ]] || fail "--root takes bookworm or trixie"
shift
[[ $EUID -eq 0 ]] || fail "a root is made and entered as root"
command -v debootstrap >/dev/null || fail "debootstrap is missing: apt install debootstrap"

root=$sources/build/roots/$release
if [[ ! -d $root ]]; then
    echo "making $root"
    rm -rf "$root.new"
    mkdir -p "$root.new"
    debootstrap --variant=minbase "$release" "$root.new" ${MIRROR:+"$MIRROR"} >"$root.log" 2>&1 ||
        fail "debootstrap failed; see $root.log"
    mkdir "$root.new/src" "$root.new/build"
    mv "$root.new" "$root"
fi
cp -L /etc/resolv.conf "$root/etc/"

# In a mount namespace of its own: whatever ends this, nothing stays mounted.
exec unshare --mount --pid --fork --kill-child bash -c '
    set -euo pipefail
    root=$1 sources=$2
    shift 2
    mount -t proc proc "$root/proc"
    mount -t tmpfs tmpfs "$root/tmp"
    mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"
    mkdir -p "$root/dev/shm"
    mount -t tmpfs tmpfs "$root/dev/shm"
    mount --bind "$sources" "$root/src"
    mount --bind "$root/build" "$root/src/build"
    # What the caller sets for compilers holds here, too.
    mapfile -t settings < <(env | grep -E "^(CCACHE|CMAKE|CXX)\w*=" || true)
    exec chroot "$root" env -i HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" "${settings[@]}" \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin /src/test.sh "$@"
    ' bash "$root" "$sources" "$@"
