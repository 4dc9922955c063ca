# SPDX-License-Identifier: MIT
# owsctl record on a real kernel: an I2C adapter, the kernel's drivers and masters, the genuine
# owserver; what was recorded replays the same values. With a file /rig/traces the recordings are
# printed, as remarks that have their names in front: so those of tests/traces were made.
. /rig/lib.sh
. /rig/w1lib.sh

answers() {
	owdump 4304 dir / | grep -q '^/28'
}

sensor=/28.A0B1C2000028/temperature board=/29.A0B1C2000029/sensed.BYTE

# NAME TARGET [OPTION]
records() {
	does "$1 is recorded" owsctl -t $2 record $3 /tmp/$1.trace read -w 120 $sensor $board
	grep -v ^owsctl: /tmp/said >/tmp/$1.values
	owsctl-sim -t replay:/tmp/$1.trace $(sed -n '2s/^# owsctl [^ ]* -t [^ ]* //p' /tmp/$1.trace) \
		>/tmp/$1.again 2>/tmp/$1.notes
	same "$1 replays the same values" "$(cat /tmp/$1.values)" "$(cat /tmp/$1.again)"
	same "$1 asks for nothing else" "" "$(grep -e 'was .* is' -e 'never asked' /tmp/$1.notes)"
	[ ! -e /rig/traces ] || sed "s/^/# $1.trace: /" /tmp/$1.trace
}

plug netlink.sim
records kernel-i2c i2c:/dev/i2c-0 --anonymous
does "the adapter's bytes are recorded" \
	owsctl -t i2c:/dev/i2c-0:0x18 record --i2c /tmp/bytes.trace read -w 120 $board
does "with the bytes that select a chip" grep -q ' i2c: transfer 18 .*w A555' /tmp/bytes.trace

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
