#!/usr/bin/env bash
# Installs the packages of packages.txt that are missing, where there is apt and it has them. What
# it cannot install it names, and ends well all the same: CMake tells whether the rest is enough.
# Usage: install_packages.sh [--needed]    (--needed: neither what is optional nor tests)
set -euo pipefail
cd "$(dirname "$0")"

say() {
    echo "install_packages.sh: $*" >&2
}

wanted=$(sed -E "$([[ ${1:-} == --needed ]] && echo '/^# optional/,$d;') /^#/d; /^\$/d; s/[[:space:]].*//" packages.txt)

if ! command -v apt-get >/dev/null; then
    say "there is no apt here, and nothing is installed; CMake says what it does not find"
    exit 0
fi
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p')
names=$(grep -vxF "$installed" <<<"$wanted" || true)
[[ -n $names ]] || exit 0
mapfile -t missing <<<"$names"

as_root=()
if [[ $EUID -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
        say "root or sudo is needed to install: ${missing[*]}"
        exit 0
    fi
    as_root=(sudo)
fi

# Runs apt-get: on a terminal it shows what it does, else only if it fails.
apt_get() {
    local command=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
        apt-get -o DPkg::Lock::Timeout=300 "$@") output
    if [[ -t 1 ]]; then
        "${command[@]}" </dev/null && return
    else
        output=$("${command[@]}" -qq </dev/null 2>&1) && return
        echo "$output" >&2
    fi
    say "failed: apt-get $*"
    exit 1
}

apt_get update
# With a candidate to install; of what apt does not know it prints nothing.
known=$(apt-cache policy "${missing[@]}" |
    awk '/^[^ ]/ { name = $1; sub(/:$/, "", name) } / Candidate: / && $2 != "(none)" { print name }')
unknown=$(grep -vxF "$known" <<<"$names" || true)
[[ -z $unknown ]] || say "apt does not have here:" $unknown
mapfile -t missing < <(grep -xF "$known" <<<"$names")
[[ ${#missing[@]} -gt 0 ]] || exit 0
echo "installing, with what they depend on: ${missing[*]}"
apt_get install -y --no-install-recommends "${missing[@]}"
