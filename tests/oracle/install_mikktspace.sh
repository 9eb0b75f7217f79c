#!/bin/sh
# install_mikktspace.sh DIR: puts the npm package `mikktspace`, the oracle, in DIR/node_modules.
# Ends 0 also where it cannot: the test then takes the recorded results, and says so.
set -u
version=1.1.1
[ -d "$1/node_modules/mikktspace" ] && exit 0
mkdir -p "$1"
if ! npm install --prefix "$1" --no-save --ignore-scripts --no-audit --no-fund \
    --fetch-retries=0 --fetch-timeout=20000 "mikktspace@$version"; then
    rm -rf "$1/node_modules"
    echo "mikktspace $version could not be installed"
fi
exit 0
