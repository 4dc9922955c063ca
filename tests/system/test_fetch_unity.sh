#!/bin/sh
# SPDX-License-Identifier: MIT
# board/fetch-unity takes Unity with the sums that it has, from wherever it comes, and no other
set -eu

# No network: what is not here cannot be had
mkdir bin home other
for tool in sh cp mv mkdir chmod sha256sum echo dirname; do
	ln -s "$(command -v $tool)" bin/$tool
done
unity=''
for dir in "$OWSD_SOURCE/build/unity" "$OWSD_BUILD/unity"; do
	[ ! -e "$dir/unity.c" ] || unity=$dir
done
[ -n "$unity" ] || { echo "Unity is not here (make unit)"; exit 77; }
for f in unity.c unity.h unity_internals.h; do cp "$unity/$f" other; done
fetch() {
	rm -rf got
	env -i PATH="$PWD/bin" HOME="$PWD/home" OWSD_CMOCK="$1" sh "$OWSD_SOURCE/board/fetch-unity" got >log 2>&1
}

fetch "$PWD/other" || { cat log; echo "the genuine one is not taken"; exit 1; }
for f in unity.c unity.h unity_internals.h; do cmp "$unity/$f" "got/$f"; done
echo '/* of another version */' >>other/unity_internals.h
if fetch "$PWD/other"; then
	echo "another Unity is taken"
	exit 1
fi
[ ! -e got ]
grep -q "make UNITY=$PWD/other" log || { cat log; echo "it does not say how to use it"; exit 1; }
if fetch "$PWD/none" || grep -q "$PWD/none" log; then
	cat log
	echo "it speaks of one that is not there"
	exit 1
fi
