# SPDX-License-Identifier: MIT
# What the package tests share: one line for each check, as in tests/kernel.

ok() { echo "ok - $1"; }
failed=0
not_ok() {
	echo "not ok - $1: $2"
	failed=1
}

# does NAME COMMAND...: it succeeds
does() {
	name=$1
	shift
	if "$@" >/tmp/said 2>&1; then ok "$name"; else not_ok "$name" "$* ($(tail -n 3 /tmp/said | tr '\n' ' '))"; fi
}

# same NAME WANTED GOT
same() {
	if [ "$2" = "$3" ]; then ok "$1"; else not_ok "$1" "wanted '$2', got '$3'"; fi
}

# within SECONDS COMMAND...: it succeeds before they are over
within() {
	deadline=$(($(date +%s) + $1))
	shift
	until "$@"; do
		[ "$(date +%s)" -lt $deadline ] || return 1
		sleep 0.2 # pace
	done
}

# reads SIGNAL VALUE: good, and this one
reads() { [ "$(owsctl get "$1" 2>&1)" = "$2" ]; }

# newer DEB VERSION DIR: the same package with another version, in DIR
newer() {
	rm -rf "$3/newer"
	mkdir -p "$3"
	dpkg-deb -R "$1" "$3/newer"
	sed -i "s/$(dpkg-deb -f "$1" Version)/$2/g" "$3/newer/DEBIAN/control"
	dpkg-deb -b --root-owner-group "$3/newer" "$3" >/dev/null
	rm -rf "$3/newer"
}
