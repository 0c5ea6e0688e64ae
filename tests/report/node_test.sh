#!/usr/bin/env bash
# node_test.sh TEST ARGUMENT...: runs a test that needs Node.js alone.
set -euo pipefail
if ! command -v node >/dev/null; then
  echo "skipped: it needs Node.js; run ./dev test-report"
  exit 77
fi
exec node "$@"
