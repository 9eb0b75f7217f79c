#!/usr/bin/env bash
# Installs the packages of packages.txt that are missing. Needs root or sudo only if some are.
# On anything but Debian 12 it installs nothing: it names what is missing and exits 1.
set -euo pipefail
cd "$(dirname "$0")"

fail() {
    echo "install_packages.sh: $*" >&2
    exit 1
}

# Prints the packages of the list that dpkg does not hold as installed.
missing_packages() {
    local installed
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p')
    grep -vxF "$installed" <<<"$wanted" || true
}

# Prints the packages whose commands cannot be run; the libraries are left to CMakeLists.txt,
# which names the packages of those that it does not find.
missing_tools() {
    local package_and_command
    for package_and_command in g++:c++ cmake:cmake ninja-build:ninja pkg-config:pkg-config; do
        command -v "${package_and_command#*:}" >/dev/null || echo "${package_and_command%:*}"
    done
}

wanted=$(sed 's/[[:space:]]*#.*//; /^$/d' packages.txt)
if command -v dpkg-query >/dev/null; then
    names=$(missing_packages)
else
    names=$(missing_tools)
fi
[[ -n $names ]] || exit 0
mapfile -t missing <<<"$names"

if ! grep -qsx 'ID=debian' /etc/os-release || ! grep -qsx 'VERSION_ID="12"' /etc/os-release; then
    fail "this is not Debian 12; missing here, by their names there: ${missing[*]}"
fi

as_root=()
if [[ $EUID -ne 0 ]]; then
    command -v sudo >/dev/null || fail "root or sudo is needed to install: ${missing[*]}"
    as_root=(sudo)
fi

# Runs apt-get and shows what it prints only if it fails.
apt_get() {
    local output
    output=$("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq -o DPkg::Lock::Timeout=300 "$@" </dev/null 2>&1) || {
        echo "$output" >&2
        fail "failed: apt-get $*"
    }
}

echo "installing, with what they depend on: ${missing[*]}"
apt_get update
apt_get install -y --no-install-recommends "${missing[@]}"
