#!/bin/sh
# install_package.sh DIR NAME VERSION: puts an npm package, an oracle, in DIR/node_modules. Ends 77
# where it cannot: the tests then do with less, and say so.
set -u
[ -d "$1/node_modules/$2" ] && exit 0
mkdir -p "$1"
if ! npm install --prefix "$1" --no-save --ignore-scripts --no-audit --no-fund \
    --fetch-retries=0 --fetch-timeout=20000 "$2@$3"; then
    rm -rf "$1/node_modules/$2"
    echo "skipped: $2 $3 could not be installed"
    exit 77
fi
