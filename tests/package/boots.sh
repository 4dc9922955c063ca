# SPDX-License-Identifier: MIT
# What boots a Debian with its own systemd, for booted and pages: root, and in the source.
native=$(dpkg --print-architecture)
work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
trap 'exit 130' INT TERM HUP

# able WHAT OR_SKIP [PROGRAM]: what is needed is here, else the end, which is a skip with yes
able() {
	why=''
	if [ "$(id -u)" != 0 ]; then
		why='a systemd is booted by root alone'
	elif [ -z "$(findmnt -n -t cgroup2)" ]; then
		why='no cgroup2 is mounted here'
	elif ! unshare -m -p -f -u -i -n -C true 2>/dev/null; then
		why='no namespaces are to be had here (unshare -m -p -u -i -n -C)'
	elif [ $# -gt 2 ] && ! command -v "$3" >/dev/null; then
		why="no $3 is here: sh board/install-deps chroot repository"
	fi
	[ -n "$why" ] || return 0
	[ "$2" = yes ] || { echo "tests/package: $1: $why" >&2 && exit 2; }
	echo "skip - $1: $why"
	echo '0 passed, 0 failed, 1 skipped'
	exit 0
}

# boots WHAT TIMES COMMAND: the system in $work/tree, so many times, with this as a service of it, which
# writes its lines to /root/test/lines and as the last one "# the end". Prints them and their sum
boots() {
	begun=$(date +%s)
	: >"$work/tree/root/test/lines"
	cat >"$work/tree/etc/systemd/system/rig.service" <<-UNIT
		[Unit]
		Description=The test
		[Service]
		Type=oneshot
		ExecStart=$3
		[Install]
		WantedBy=multi-user.target
	UNIT
	mkdir -p "$work/tree/etc/systemd/system/multi-user.target.wants"
	# There is no console to log in at
	ln -s /dev/null "$work/tree/etc/systemd/system/console-getty.service"
	ln -s ../rig.service "$work/tree/etc/systemd/system/multi-user.target.wants/"
	for _ in $(seq "$2"); do tests/package/container "$work/tree" 900; done
	lines=$work/tree/root/test/lines
	cat "$lines"
	passed=$(grep -c '^ok - ' "$lines") failed=$(grep -c '^not ok - ' "$lines") skipped=$(grep -c '^skip - ' "$lines")
	if ! grep -q '^# the end' "$lines"; then
		echo "not ok - $1: the test did not come to its end"
		failed=$((failed + 1))
	fi
	echo "# $1: $(($(date +%s) - begun)) s"
	[ "$skipped" = 0 ] && echo "$passed passed, $failed failed" || echo "$passed passed, $failed failed, $skipped skipped"
	[ "$failed" = 0 ]
}
