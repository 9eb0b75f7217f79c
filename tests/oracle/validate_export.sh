#!/bin/sh
# validate_export.sh CW2_BAKE SOURCE OUTPUT PACKAGE_DIR: exports SOURCE to the glTF OUTPUT and
# validates it. Ends 77 where Node or the validator is not installed.
set -eu
command -v node >/dev/null || { echo "skipped: needs Node" && exit 77; }
"$1" "$2" -o "$3" --quiet
exec node "$(dirname "$0")/validate_gltf.mjs" "$4" "$3"
