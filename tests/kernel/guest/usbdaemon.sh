# SPDX-License-Identifier: MIT
# owsd on a DS9490R: taken from the kernel's driver and given back; values of all chips, an output; a
# short, chips and adapter that go and come, endpoints that stall or say nothing, an owsd that is killed.
. /rig/lib.sh
. /rig/w1lib.sh
. /rig/usblib.sh

told_within=90
back_within=150

get() {
	owsctl get $1 2>/tmp/reason
}

bad() {
	get $1 >/tmp/value
	[ $? -eq 3 ]
}

# SIGNAL VALUE: good, and this one
reads() {
	[ "$(get $1)" = "$2" ]
}

run_owsd() {
	owsd -c /rig/usb.rio >>/tmp/log/owsd 2>&1 &
	owsd=$!
}

all_good() {
	owsctl get warm cold hot old pins lamp
}

# Each look at the thermometer gets a value of its own, so that an old one cannot pass for it
warm=30
next_value() {
	warm=$((warm + 1))
	sim set warm temperature $warm
}

# NAME COMMAND END...: a fault that lasts until it is ended
lasting() {
	sim $2
	does "$1: the signals say so" within $told_within bad warm
	sed 's/^/# /' /tmp/reason
	sim $3
	next_value
	does "$1: it is over" within $back_within reads warm $warm
	does "$1: and all is good again" within $back_within all_good
}

plug_usb
run_owsd
does "owsd takes the adapter from the driver" within $back_within reads warm 21.0625
does "whose master is gone" within 60 no_master
does "everything is good" within $back_within all_good
same "a thermometer fed by the wire" -10.125 "$(get cold)"
same "one of 9 bits" 124.5 "$(get hot)"
same "a DS18S20" 25.375 "$(get old)"
owsctl set lamp 1
does "an output switches its pin" within $told_within reads pins 2
if owsctl -t usb: read /28.A0B1C2000028/type >/tmp/reason 2>&1; then
	not_ok "another program is refused" "it was not"
else
	does "another program is refused, and told who has it" grep "owsd" /tmp/reason
fi
sed 's/^/# /' /tmp/reason

sim unplug warm
does "a chip that is gone makes its signal bad" within $told_within bad warm
same "and the next one stays good" -10.125 "$(get cold)"
sim plug warm
next_value
does "it comes back with the value of now" within $back_within reads warm $warm
lasting "a short" "short 0x18" "end short 0x18"
same "owsd does nothing that the data sheet forbids" 0 "$(stat_of forbidden)"
lasting "the adapter pulled out, and in at another port" "remove adapter" "end remove adapter"
lasting "a chip that no longer says its state" "silent 1" "well"
sim stall 3
next_value
does "a stalled endpoint: owsd recovers by itself" within $back_within reads warm $warm
does "and all is good again" within $back_within all_good
sim stats | sed 's/^/# /'

kill -9 $owsd
wait $owsd 2>/dev/null
next_value
run_owsd
does "after owsd was killed another takes over" within $back_within reads warm $warm
kill $owsd
wait $owsd
same "owsd ends when it is told to" 0 $?
does "and the kernel's driver has the adapter back" within 60 one_master
does "with every chip" within 120 all_found $chips
finish
