#!/usr/bin/env bash
# browser_test.sh WEB MAKE_REPORT FRONTLUX FOLDER: makes runs and reports in FOLDER and opens them in headless
# Chromium. FRONTLUX_CHROMIUM names another Chromium than that of the path.
set -euo pipefail
web=$1 make_report=$2 frontlux=$3 folder=$4
chromium=${FRONTLUX_CHROMIUM:-$(command -v chromium || true)}
if ! command -v node >/dev/null || [[ -z $chromium || ! -d $web/node_modules/playwright-core || ! -d $web/node_modules/axe-core ]]; then
  echo "skipped: it needs Node.js, Chromium and what npm installs; run ./dev test-report"
  exit 77
fi
rm -rf "$folder"
mkdir -p "$folder"
"$make_report" "$folder/runs" 9 storage 'alone=+storage'
"$make_report" "$folder/evil" 2 '<img src=x onerror=window.evil=1></script><script>window.evil=1</script>=room'
"$make_report" "$folder/long" 9 storage/400
"$frontlux" explore room -o "$folder/explored" --threads 2 >/dev/null
"$frontlux" explore room -o "$folder/lockstep" --lockstep --threads 2 >/dev/null
"$frontlux" report "$folder/explored" >/dev/null
mkdir "$folder/both"
"$frontlux" report "$folder/explored" "$folder/lockstep" -o "$folder/both/report.html" >/dev/null
exec node "$(dirname "$0")/browser_test.mjs" "$web" "$chromium" "$folder/screenshots" "$folder/runs" "$folder/evil" \
  "$folder/explored" "$folder/lockstep" "$folder/both" "$folder/long"
