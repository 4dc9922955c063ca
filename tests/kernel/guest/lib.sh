# SPDX-License-Identifier: MIT
# For the guest's scripts: results, the simulated adapter, waiting. Sourced by all of them.

failed=0

ok() {
	echo "ok - $1"
}

not_ok() {
	echo "not ok - $1: $2"
	failed=1
}

skip() {
	echo "skip - $1: $2"
}

# NAME EXPECTED ACTUAL
same() {
	if [ "$2" = "$3" ]; then ok "$1"; else not_ok "$1" "expected '$2', have '$3'"; fi
}

# NAME EXPECTED TOLERANCE ACTUAL
near() {
	if awk -v a="$4" -v e="$2" -v t="$3" \
		'BEGIN { exit !(a ~ /^ *-?[0-9.]+ *$/ && a - e <= t && e - a <= t) }'; then
		ok "$1"
	else
		not_ok "$1" "expected $2 within $3, have '$4'"
	fi
}

# NAME COMMAND...: the command succeeds
does() {
	local what=$1
	shift
	if "$@" >/tmp/said 2>&1; then ok "$what"; else not_ok "$what" "$(tail -n 1 /tmp/said)"; fi
}

# SECONDS COMMAND...: until it succeeds, tried ten times a second; false when time is over. It is
# the host that is slow when it takes long, and patience costs nothing where all is well.
within() {
	local end=$(($(date +%s) + $1))
	shift
	until "$@" >/dev/null 2>&1; do
		[ "$(date +%s)" -le $end ] || return 1
		usleep 100000 # pace
	done
}

finish() {
	exit $failed
}

# SCENARIO: plug the adapter in and wait for /dev/i2c-0; without it nothing can be judged
plug() {
	modprobe vhci-hcd && modprobe i2c-tiny-usb && modprobe i2c-dev
	simchip /rig/$1 >>/tmp/log/simchip 2>&1 &
	simchip_pid=$!
	within 60 simchip -c stats && within 60 test -c /dev/i2c-0 && return
	not_ok "the simulated adapter is plugged in" "no /dev/i2c-0"
	finish
}

# The kernel has let go of the adapter; whoever has the device open keeps its name alive
adapter_gone() {
	[ ! -e /dev/i2c-0 ] && [ ! -e /sys/bus/i2c/devices/i2c-0 ]
}

# Pull it out, and wait until another cannot be taken for it
unplug() {
	kill $simchip_pid
	wait $simchip_pid 2>/dev/null
	within 60 adapter_gone && return
	not_ok "the simulated adapter is unplugged" "/dev/i2c-0 is still there"
	finish
}

# COMMAND...: to the simulated chips
sim() {
	simchip -c "$@" 2>&1
}
