#!/bin/sh
# validate_export.sh CW2_BAKE SOURCE OUTPUT NODE PACKAGE_DIR: exports SOURCE to the glTF OUTPUT and
# validates it. Ends 77 where the validator is not installed.
set -eu
"$1" "$2" -o "$3" --quiet
exec "$4" "$(dirname "$0")/validate_gltf.mjs" "$5" "$3"
