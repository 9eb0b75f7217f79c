#!/usr/bin/env bash
# Every view that cw2 lists is among VIEW... and has a golden.
# Usage: check_views.sh CW2 GOLDENS VIEW...
set -euo pipefail

cw2=$1 goldens=$2
shift 2
status=0
while read -r view _; do
    [[ " $* " == *" $view "* ]] || { echo "$view: add it to the views in CMakeLists.txt" && status=1; }
    [[ -f $goldens/$view.png ]] || { echo "$view: $goldens/$view.png is missing" && status=1; }
done < <("$cw2" --list-views)
exit $status
