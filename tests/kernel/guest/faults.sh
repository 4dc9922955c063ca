# SPDX-License-Identifier: MIT
# Faults happen to the chip and its devices under a running owsd: the signal says so in time, comes
# back when the fault is over, with the value of that moment, and is never good with a false one.
. /rig/lib.sh

told_within=90
back_within=150

get() {
	owsctl get $1 2>/tmp/reason
}

bad() {
	get $1 >/tmp/value
	[ $? -eq 3 ]
}

reads() {
	[ "$(get $1)" = "$2" ] && get $1 >/tmp/value
}

# Each look at the thermometer gets a value of its own, so that an old one cannot pass for it
warm=20
next_value() {
	warm=$((warm + 1))
	sim set warm temperature $warm
}

all_good() {
	get cold && get pins && get relays
}

# NAME SIGNAL COMMAND...: a fault that lasts until it is ended
lasting() {
	local name=$1 signal=$2
	shift 2
	sim "$@"
	does "$name: the signal says so" within $told_within bad $signal
	sed 's/^/# /' /tmp/reason
	sim end "$@"
	next_value
	does "$name: it is over" within $back_within reads warm $warm
	does "$name: and the others are good again" within $back_within all_good
}

# NAME COMMAND...: a fault that owsd itself gets rid of
passing() {
	local name=$1
	shift
	sim "$@"
	next_value
	does "$name: owsd recovers by itself" within $back_within reads warm $warm
}

# The chip is in the hands of that program, and whoever asks is told so
refused_by() {
	! owsctl -t i2c:/dev/i2c-0 read /28.A0B1C2000028/type >/tmp/refusal 2>&1 &&
		grep "0x18 on /dev/i2c-0 is in use by $1 (process $owsd)" /tmp/refusal
}

plug faults.sim
owsd -c /rig/faults.rio >/tmp/log/owsd 2>&1 &
owsd=$!
does "the first value is there" within $back_within reads warm 20
owsctl watch >/tmp/log/watch 2>&1 &
does "and that of the one fed by the wire" within $back_within reads cold -10.125
does "and the inputs" within $back_within reads pins 253
owsctl set relays 5
does "an output is written" within $back_within reads pins 248

does "a second master is refused" refused_by owsd
lasting "part removed" warm unplug warm
lasting "checksum error" warm corrupt warm each 1
lasting "short" warm short 0x18
lasting "address refused" warm refuse 0x18
lasting "data refused" warm refuse-data 0x18
lasting "busy whatever the host does" warm jam 0x18
lasting "adapter unplugged" warm remove adapter
passing "now and then a checksum error" corrupt warm each 3 for 5s
passing "now and then an address refused" refuse 0x18 each 20 for 5s
passing "chip reset" reset 0x18
passing "stuck busy bit" stick 0x18
sim brownout board
sim set board pin.1 1
does "with Restore, outputs are written again after a restart of their device" within $back_within reads pins 250

does "owsd lives" kill -0 $owsd
same "no false value was ever good" "" "$(awk '
	$4 != "good" { next }
	$2 == "warm" && $3 !~ /^(2[0-9]|3[01])$/ { print }
	$2 == "cold" && $3 != "-10.1" { print }' /tmp/log/watch)"
owsctl stats | sed 's/^/# /'
kill $owsd
wait $owsd
does "once owsd has ended the chip is free" owsctl -t i2c:/dev/i2c-0 scan
sed 's/^/# /' /tmp/said
finish
