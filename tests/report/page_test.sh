#!/usr/bin/env bash
# page_test.sh WEB: whether WEB/dist/page.html is what WEB/src makes.
set -euo pipefail
if ! command -v node >/dev/null || [[ ! -d $1/node_modules/esbuild ]]; then
  echo "skipped: it needs Node.js and what npm installs; run ./dev test-report"
  exit 77
fi
exec node "$1/build.mjs" --check
