#!/usr/bin/env bash
# install_test.sh PACKAGES: in a Debian that has none of our packages, as root: installs those in the folder PACKAGES over
# older ones, tries each, purges them and fails if anything of them is left. `./dev package` runs it.
set -euo pipefail

sources=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(cd "$1" && pwd)
room=$sources/data/maps/room_0.1m.bt
names=(libfrontlux0 libfrontlux-dev frontlux python3-frontlux)
work=$(mktemp -d)
export DEBIAN_FRONTEND=noninteractive

say() { printf '== %s\n' "$*"; }

fail() {
  printf 'install_test: %s\n' "$1" >&2
  exit 1
}

# install FOLDER: our packages in it; all of them, and no others of ours.
install() {
  local name files=()
  for name in "${names[@]}"; do files+=("$1/$name"_*.deb); done
  apt-get install --yes --no-install-recommends "${files[@]}" </dev/null >"$work/apt.log" 2>&1 || {
    cat "$work/apt.log"
    fail "cannot install $1"
  }
}

purge() { apt-get purge --yes "${names[@]}" </dev/null >/dev/null; }

# All files but those that packages' tools keep for themselves.
files() {
  find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /var/cache -o -path /var/log -o \
    -path /var/lib/dpkg -o -path /var/lib/apt -o -path /root -o -path "$sources" \) -prune -o -print | sort
}

# older: the same packages with a lower version and one file that the new ones do not have.
older() {
  local name file tree version
  mkdir "$work/older"
  for name in "${names[@]}"; do
    file=$(ls "$packages/${name}_"*.deb)
    tree=$work/tree
    rm -rf "$tree"
    dpkg-deb --raw-extract "$file" "$tree"
    version=$(dpkg-deb --field "$file" Version)
    sed -i "s/^Version: .*/Version: $version~older/; s/(= $version)/(= $version~older)/g" "$tree/DEBIAN/control"
    sed -i "s/(>= ${version}[^)]*)/(>= 0)/g" "$tree/DEBIAN/control"
    echo gone >"$tree/usr/share/doc/$name/only_in_older"
    dpkg-deb --root-owner-group --build "$tree" "$work/older/$(basename "$file")" >/dev/null
  done
}

apt-get update </dev/null >/dev/null
apt-get install --yes --no-install-recommends cmake g++ make pkg-config python3-numpy </dev/null >/dev/null
say "installing an older version"
older
install "$work/older"
purge
files >"$work/before"  # with all that our packages depend on
install "$work/older"

say "upgrading"
install "$packages"
for name in "${names[@]}"; do
  version=$(dpkg-query --show --showformat='${Version}' "$name")
  [[ $version == $(dpkg-deb --field "$packages/$name"_*.deb Version) ]] || fail "$name is still $version"
  [[ ! -e /usr/share/doc/$name/only_in_older ]] || fail "the upgrade left a file of the older $name"
done

say "libfrontlux0: every library finds what it needs"
for library in /usr/lib/*/libfrontlux_*.so.*; do
  if ldd "$library" | grep 'not found'; then fail "$library"; fi
done

say "frontlux: an exploration and its report"
cd "$work"
frontlux --version
frontlux explore room --lockstep --seed 1 -o run >"$work/explore.log" 2>&1 || {
  cat "$work/explore.log"
  fail "frontlux explore"
}
tail -n 1 "$work/explore.log"
[[ -s run/report.html && -s run/map.bt ]] || fail "the exploration left no report or no map"
for page in frontlux frontlux-explore; do
  [[ -s /usr/share/man/man1/$page.1.gz ]] || fail "there is no manual page of $page"
done
[[ -s /usr/share/bash-completion/completions/frontlux ]] || fail "bash cannot complete commands"

say "libfrontlux-dev: consumers by CMake and by pkg-config"
for consumer in find_package planner; do
  cmake -S "$sources/tests/consumer/$consumer" -B "$work/$consumer" -DCMAKE_BUILD_TYPE=Release >/dev/null
  cmake --build "$work/$consumer" >/dev/null
done
"$work/find_package/consumer" 2>/dev/null  # OctoMap complains of a ray without a direction
"$work/planner/consumer" "$room"
# shellcheck disable=SC2046
g++ -std=c++20 -O2 "$sources/tests/consumer/planner/main.cpp" -o "$work/by_pkg_config" \
  $(pkg-config --cflags --libs "frontlux-planner >= 0.1")
"$work/by_pkg_config" "$room"

say "python3-frontlux: two examples"
python3 "$sources/docs/examples/next_best_view.py" "$room" | tee "$work/python.log"
grep -qx 'scan 6: 380598 voxels free, 36000 frontiers' "$work/python.log" || fail "the example prints something else"
python3 "$sources/docs/examples/explore_room.py" "$room" "$work/explored.bt" | tee "$work/python.log"
grep -q '^99.* % of the room' "$work/python.log" || fail "the exploration in Python ended early"

say "purging"
purge
files >"$work/after"
diff "$work/before" "$work/after" || fail "files are left behind, or gone"
if dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' '*frontlux*' 2>/dev/null | grep -v not-installed; then
  fail "dpkg still knows our packages"
fi
rm -rf "$work"
say "all is well"
