#!/usr/bin/env bash
# deploy/check_layering finds what it is there to find: each breach, put into a small tree, and nothing in the tree without it.
set -euo pipefail

check=$(dirname -- "${BASH_SOURCE[0]}")/../deploy/check_layering
tree=$(mktemp --directory)
trap 'rm -rf "$tree"' EXIT

# put FILE LINE: a file of one line, and its folders.
put() {
  mkdir -p "$tree/${1%/*}"
  printf '%s\n' "$2" >"$tree/$1"
}

# found WHAT FILE LINE: with this file the check fails and names it; without, it passes again.
found() {
  local output
  put "$2" "$3"
  if output=$("$check" "$tree" 2>&1); then
    echo "not found: $1" && exit 1
  fi
  [[ $output == *"${2%/*}"* ]] || { echo "$1: $2 is not named in: $output" && exit 1; }
  rm "$tree/$2"
  rmdir --ignore-fail-on-non-empty "$tree/${2%/*}"
  "$check" "$tree" || { echo "fails without $1" && exit 1; }
}

put core/base/vec.h '#pragma once'
put core/curve/hilbert.h '#include "core/base/vec.h"'
put core/density/density.h '#include "core/curve/hilbert.h"'
put server/base/log.h '#include "core/base/vec.h"'
put server/frame/frame.h '#include "server/base/log.h"'
put server/server.h '#include "server/frame/frame.h"'
put client/lib/draco/reader.h '#pragma once'
put client/lib/client.h '#include "client/lib/draco/reader.h"'
put client/lib/CMakeLists.txt $'set(headers view.h\n    points.h)'
put client/lib/points.h '#pragma once'
put client/lib/view.h '#include "points.h"'
put client/cli/main.cpp '#include "client/lib/client.h"'
put client/lib/view.cpp '#include "core/base/mutex.h"'
put client/examples/orbit.cpp '#include <curvecast/client/client.h>'
put proto/tls/tls.h '#pragma once'
put tests/core/base/vec_test.cpp '#include "core/base/vec.h"'
"$check" "$tree"

found 'a cycle of folders in core' core/curve/cycle.h '#include "core/density/density.h"'
found 'folders of one level that include each other' core/refine/sideways.h '#include "core/sample/resample.h"'
found 'a cycle of folders in the server' server/base/cycle.h '#include "server/frame/frame.h"'
found 'a room of the server that knows the whole' server/frame/whole.h '#include "server/server.h"'
found 'a folder without a place' core/attic/old.h '#pragma once'
found 'core that knows the server' core/curve/up.h '#include "server/base/log.h"'
found 'core that knows the API' core/curve/proto.h '#include "curvecast/v1/curvecast.pb.h"'
found 'a client library that knows core' client/lib/core.h '#include "core/base/vec.h"'
found 'a client library that knows core in a header' client/lib/locked.h '#include "core/base/mutex.h"'
found 'a folder that includes the one around it' client/lib/draco/around.h '#include "client/lib/client.h"'
found 'the same by another path' client/lib/draco/hidden.h '#include "../client.h"'
found 'a command that knows the benchmarks' client/cli/bench.cpp '#include "client/bench/bench.h"'
found 'libcurl outside of its door' server/base/fetch.cpp '#include <curl/curl.h>'
found 'a heavy header in a header' core/curve/heavy.h '#include <CGAL/Simple_cartesian.h>'
put client/lib/view.h '#include "client/lib/points.h"'
! "$check" "$tree" 2>/dev/null || { echo 'not found: an installed header that another finds in the source tree alone' && exit 1; }
put client/lib/view.h '#include "points.h"'
"$check" "$tree"
for i in {1..51}; do put "core/curve/file_$i.h" '#pragma once'; done
! "$check" "$tree" 2>/dev/null || { echo 'not found: a folder of too many files' && exit 1; }
echo 'layering: every breach is found'
