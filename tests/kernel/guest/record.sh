# SPDX-License-Identifier: MIT
# owsctl record on a real kernel: an I2C adapter, the kernel's drivers and masters, the genuine
# owserver; what was recorded replays the same table. With a file /rig/traces the recordings are
# printed, as remarks that have their names in front: so those of tests/traces were made.
. /rig/lib.sh
. /rig/w1lib.sh

answers() {
	owdump 4304 dir / | grep -q '^/28'
}

# FILE: the table without ids, and without what a replay says of itself
table() {
	sed -e 's/ (simulated)//' -e 's/\([0-9A-F][0-9A-F]\)\.[0-9A-F]\{12\}/\1/g' -e 's/  */ /g' $1
}

# NAME TARGET [OPTION]
records() {
	does "$1 is recorded" owsctl -t $2 record $3 /tmp/$1.trace
	cp /tmp/said /tmp/$1.table
	sed -i '/^owsctl:/d' /tmp/$1.table
	owsctl-sim -t replay:/tmp/$1.trace scan >/tmp/$1.again 2>/tmp/$1.notes
	same "$1 replays the same table" "$(table /tmp/$1.table)" "$(table /tmp/$1.again)"
	same "$1 has the answers that it had" "" "$(grep -e 'was .* is' -e 'never asked' /tmp/$1.notes)"
	[ ! -e /rig/traces ] || sed "s/^/# $1.trace: /" /tmp/$1.trace
}

plug netlink.sim
records kernel-i2c i2c:/dev/i2c-0 --anonymous
does "the adapter's bytes are recorded" owsctl -t i2c:/dev/i2c-0:0x19 record --i2c /tmp/bytes.trace
does "with the bytes of a search" grep -q ' i2c transfer 19 w A5F0' /tmp/bytes.trace

owserver --i2c=/dev/i2c-0:ALL -p 127.0.0.1:4304 --foreground >>/tmp/log/owserver 2>&1 &
server=$!
does "owserver serves the simulated network" within 150 answers
records kernel-owserver localhost:4304 --anonymous
kill -9 $server
wait $server 2>/dev/null

load_drivers
bind 0x18
bind 0x19
does "the kernel finds every chip" within 150 all_found 10
records kernel-w1 w1 --anonymous
records kernel-w1-netlink w1:netlink --anonymous
finish
