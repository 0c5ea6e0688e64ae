#!/usr/bin/env bash
# cluster_test.sh FOLDER, that of bench/reproduce: the test that needs Dask, of Debian's Python.
set -euo pipefail
if ! /usr/bin/python3 -c 'import distributed' 2>/dev/null; then
  echo "skipped: it needs python3-distributed; run ./dev test"
  exit 77
fi
exec /usr/bin/python3 -B "$(dirname "${BASH_SOURCE[0]}")/cluster_test.py" "$@"
