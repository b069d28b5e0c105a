#!/usr/bin/env bash
# Installs Curvecast, moves it, and builds a program of somebody else's against it: through find_package and through pkg-config. The
# programs take points from a server that is the installed command. Run by CTest, which sets the environment.
set -euo pipefail

fail() {
  echo "install_test: $1" >&2
  exit 1
}
# expect WHAT WANTED FOUND
expect() { [[ $3 == "$2" ]] || fail "$1: '$3' instead of '$2'"; }

consumer=$CURVECAST_SOURCE/tests/install/consumer
output=$CURVECAST_OUTPUT
rm -rf -- "$output"
mkdir -p -- "$output"
export XDG_CACHE_HOME=$output/cache

# What is installed may be moved, and knows nothing of where it was built.
"$CMAKE" --install "$CURVECAST_BUILD" --prefix "$output/installed" >/dev/null
mv "$output/installed" "$output/moved"
prefix=$output/moved
package=$(find "$prefix" -name curvecastConfig.cmake)
export PKG_CONFIG_PATH
PKG_CONFIG_PATH=$(dirname -- "$(find "$prefix" -name curvecast-client.pc)")
if grep --recursive --files-with-matches --fixed-strings --regexp="$CURVECAST_SOURCE" --regexp="$CURVECAST_BUILD" \
  "$(dirname -- "$package")" "$PKG_CONFIG_PATH" "$prefix/include"; then
  fail 'these files name the folders of the build'
fi
[[ -s $prefix/share/doc/curvecast/LICENSE ]] || fail 'there is no license'

# One version for all of it.
read -r name version _ <<<"$("$prefix/bin/curvecast" --version)"
expect 'version of the command' "curvecast $CURVECAST_VERSION" "$name $version"
expect 'version of the pkg-config file' "$CURVECAST_VERSION" "$(pkg-config --modversion curvecast-client)"

# Headers take each other from where they are installed, with no warnings for those who want many, and nothing of Draco's.
for header in "$prefix"/include/curvecast/client/*.h; do
  printf '#include <curvecast/client/%s>\n' "${header##*/}"
done >"$output/headers.cpp"
[[ $(wc --lines <"$output/headers.cpp") -gt 5 ]] || fail 'headers are missing'
read -ra flags <<<"$(pkg-config --cflags curvecast-client)"
read -ra launcher <<<"${CMAKE_CXX_COMPILER_LAUNCHER-}"
"$CXX" -std=c++20 -Wall -Wextra -Wpedantic -Werror "${flags[@]}" -H -fsyntax-only "$output/headers.cpp" 2>"$output/headers.log" ||
  fail "headers do not compile: see $output/headers.log"
! grep '^\.* .*/draco/' "$output/headers.log" || fail 'headers include Draco'

# Through pkg-config, as the lines would be in somebody's Makefile: linked to what is shared, and with nothing shared at all.
"${launcher[@]}" "$CXX" -std=c++20 "${flags[@]}" -c "$consumer/main.cpp" -o "$output/main.o"
read -ra libraries <<<"$(pkg-config --libs curvecast-client)"
"$CXX" "$output/main.o" "${libraries[@]}" -o "$output/pkg_config"
read -ra libraries <<<"$(pkg-config --static --libs curvecast-client)"
"$CXX" -static "$output/main.o" "${libraries[@]}" -o "$output/pkg_config_static" 2>"$output/static.log" ||
  fail "$(<"$output/static.log")"

# Through CMake. None of the options that Curvecast itself is compiled with is meant for others.
"$CMAKE" -S "$consumer" -B "$output/find_package" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCURVECAST_VERSION="$CURVECAST_VERSION" \
  >"$output/configure.log" || fail "$(<"$output/configure.log")"
"$CMAKE" --build "$output/find_package" >"$output/build.log" || fail "$(<"$output/build.log")"
! grep -E -- ' -(W|ffp-contract)' "$output/find_package/compile_commands.json" || fail 'options leak to those who use the client'

log=$output/server.log
: >"$log" # it is read at once, maybe before the server is there to make it
"$prefix/bin/curvecast" serve --listen 127.0.0.1:0 --http none >>"$log" 2>&1 &
server=$!
trap 'kill "$server" 2>/dev/null || true' EXIT
address=
for ((i = 0; i < 300; ++i)); do
  address=$(sed -n 's/^listening on //p' "$log")
  if [[ -n $address ]] || ! kill -0 "$server" 2>/dev/null; then break; fi
  sleep 0.1
done
[[ -n $address ]] || fail "the server did not start: $(tail --lines=1 "$log")"
for program in pkg_config pkg_config_static find_package/consumer; do
  expect "$program" '1000 points' "$("$output/$program" "$address" 1000)"
done
expect caller '1 sessions' "$("$output/find_package/caller" "$address")"
