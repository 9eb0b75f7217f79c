#!/usr/bin/env bash
# install_packages.sh beside programs that stand in for apt's. Usage: test_install_packages.sh FOLDER
set -euo pipefail
installer=$(cd "$(dirname "$0")/../../third_party" && pwd)/install_packages.sh
work=$1
rm -rf "$work"
mkdir -p "$work/bin" "$work/no_apt"

fail() {
    echo "test_install_packages.sh: $*" >&2
    exit 1
}

for tool in bash dirname sed grep awk cat env; do
    ln -s "$(command -v $tool)" "$work/bin/"
    ln -s "$(command -v $tool)" "$work/no_apt/"
done
program() {
    printf '#!/bin/bash\n%s\n' "$2" >"$work/bin/$1"
    chmod +x "$work/bin/$1"
}
# All is installed but these, of which apt does not have one.
program dpkg-query "sed -E '/^(libfmt-dev|libglm-dev|libopenimageio-dev|xvfb) /d; /^#/d; /^\$/d; s/ .*//; s/^/installed /' \
    '${installer%/*}/packages.txt'"
program apt-cache 'shift
for name; do
    [[ $name == libglm-dev ]] || printf "%s:\n  Installed: (none)\n  Candidate: 1\n" "$name"
done'
program apt-get "echo \"\$*\" >>'$work/calls'"
program sudo '"$@"'

PATH=$work/bin "$installer" --needed >"$work/out" 2>"$work/err"
grep -q -- 'update' "$work/calls" || fail "apt's lists are old"
grep -q -- 'install -y --no-install-recommends libfmt-dev -qq$' "$work/calls" ||
    fail "not what is needed: $(<"$work/calls")"
grep -q 'apt does not have here: libglm-dev$' "$work/err" || fail "$(<"$work/err")"
: >"$work/calls"
PATH=$work/bin "$installer" >"$work/out" 2>"$work/err"
grep -q 'recommends libfmt-dev libopenimageio-dev xvfb -qq$' "$work/calls" ||
    fail "not all: $(<"$work/calls")"

# Nothing is missing: nothing is done.
program dpkg-query "sed -E '/^#/d; /^\$/d; s/ .*//; s/^/installed /' '${installer%/*}/packages.txt'"
: >"$work/calls"
PATH=$work/bin "$installer"
[[ ! -s $work/calls ]] || fail "$(<"$work/calls")"

# Where apt fails, so does it.
program dpkg-query 'exit 0'
program apt-get 'echo "E: no network"; exit 100'
if PATH=$work/bin "$installer" >"$work/out" 2>"$work/err"; then fail "apt has failed, and nobody says so"; fi
grep -q 'E: no network' "$work/err" || fail "$(<"$work/err")"

PATH=$work/no_apt "$installer" 2>"$work/err" || fail "it does not go on without apt"
grep -q 'no apt here' "$work/err" || fail "$(<"$work/err")"
