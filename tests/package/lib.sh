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

# repository ARGUMENTS...: what make-repository makes, signed by a key that is made once, in $work/gpg
repository() {
	export GNUPGHOME="$work/gpg"
	if [ ! -d "$GNUPGHOME" ]; then
		mkdir -m 700 "$GNUPGHOME" || return 1
		gpg --batch --passphrase '' --quick-generate-key packages ed25519 sign never || return 1
	fi
	sh board/make-repository "$@" packages
	set -- $?
	gpgconf --kill all
	return "$1"
}

# newest DEBS DIR: the packages of the newest version for this machine, in DIR
newest() {
	arch=$(dpkg --print-architecture)
	version=$(dpkg-deb -f "$(ls -t "$1"/owsd_*_"$arch".deb | head -n 1)" Version) || return 1
	mkdir "$2" && cp "$1"/*_"${version}_$arch".deb "$1"/*_"${version}"_all.deb "$2" || return 1
	rm -f "$2"/*-dbgsym_*
}
