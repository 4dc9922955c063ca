# SPDX-License-Identifier: MIT
# owsd on target w1 while parts, drivers and adapter go and come: the signal says so, comes back with
# the value of that moment, alarms are told, and another target goes on.
. /rig/lib.sh
. /rig/w1lib.sh

told_within=100
back_within=150
parts=4

get() {
	owsctl get $1 2>/tmp/reason
}

bad() {
	get $1 >/tmp/value
	[ $? -eq 3 ]
}

reads() {
	[ "$(get $1)" = "$2" ]
}

said() {
	grep -q "$1" /tmp/log/owsd
}

# NAME: readings so far
readings() {
	owsctl --json get $1 | sed 's/.*"count":\([0-9]*\).*/\1/'
}

more_than() {
	[ "$(readings other)" -gt $1 ] && owsctl get other >/dev/null
}

warm=21
next_value() {
	warm=$((warm + 1))
	sim set warm temperature $warm
}

# NAME [SIGNAL]: it tells of a fault, with what quality; the other target goes on
told() {
	does "$1: ${2:-warm} says so" within $told_within bad ${2:-warm}
	sed 's/^/# /' /tmp/reason
	does "$1: the other target goes on" within $told_within more_than $(($(readings other) + 1))
}

over() {
	does "$1: it is over" within $back_within reads warm $warm
	does "$1: and the board is good" within $back_within owsctl get pins relays
}

# Who waits in the kernel, and where
blocked() {
	for process in /proc/[0-9]*/task/*; do
		grep -q '^State:.*D' $process/status 2>/dev/null || continue
		echo "$process $(cat $process/comm)"
		cat $process/stack
	done
}

masters() {
	[ "$(ls -d $W1/w1_bus_master* 2>/dev/null | wc -l)" = $1 ]
}

plug w1.sim
# What the kernel's driver can only read: the latches of all pins are alarms
same "the board's latches are its alarms" "/29.A0B1C2000029/set_alarm	ret=0" \
	"$(echo /29.A0B1C2000029/set_alarm 133333333 | busdump i2c:/dev/i2c-0 write 2>/dev/null)"
# Its own search every three seconds; a part that one of them missed is gone
load_drivers timeout=3 slave_ttl=1
bind 0x18
does "the kernel finds every part" within $back_within all_found $parts
search_no_more

owsd-sim -v -c /rig/w1.rio >/tmp/log/owsd 2>&1 &
owsd=$!
does "a thermometer is read" within $back_within reads warm 21
# A search of the kernel's while it converts ends the strong pull-up: 6.1 leaves it the wire
does "one that the wire feeds, while the kernel does not search" within $back_within \
	reads cold -10.125
owsctl watch >/tmp/log/watch 2>&1 &
echo -1 >$W1/w1_bus_master1/w1_master_search
does "pins" within $back_within reads pins 253
does "another target" within $back_within reads other 5
owsctl set relays 5
does "an output switches its pin" within $told_within reads pins 248

# --- Alarms
sim set board pin.7 0
does "an input that moved is read" within $told_within reads pins 120
history() {
	owsctl --json alarms history | tr '}' '\n' | grep '"pins","alarm":"device"' >/tmp/history
}
does "as an alarm" within $told_within history
sed 's/^/# /' /tmp/history
sim set board pin.7 1
does "the way back is read, too" within $told_within reads pins 248

# --- What goes and comes
sim unplug warm
told "part removed"
does "part removed: the board stays good" owsctl get pins relays
next_value
sim plug warm
over "part removed"

within 60 modprobe -r w1_therm
told "module unloaded"
does "module unloaded: which is in the log" within $told_within said "no driver that owsd uses has it"
does "module unloaded: the board stays good" owsctl get pins relays
next_value
modprobe w1_therm
over "module unloaded"

unbind() {
	echo 0-0018 >/sys/bus/i2c/drivers/ds2482/unbind
	echo unbound >/tmp/unbound
}
unbind &
told "driver unbound"
told "driver unbound" pins
does "driver unbound: which is in the log" within $told_within said "no 1-Wire master in the kernel\|the adapter is gone"
does "driver unbound: the kernel has let go of it" within $told_within test -e /tmp/unbound
[ -e /tmp/unbound ] || { blocked >/tmp/log/blocked; finish; }
next_value
echo 0-0018 >/sys/bus/i2c/drivers/ds2482/bind
over "driver unbound"
does "driver unbound: the output is as commanded" within $told_within reads pins 248

# A transfer that does not end: whoever reads an attribute hangs in the kernel
kill -STOP $simchip_pid
told "a read that does not return"
told "a read that does not return" pins
kill -CONT $simchip_pid
next_value
over "a read that does not return"

sim remove adapter
told "adapter unplugged"
does "adapter unplugged: the kernel has let go of it" within $told_within masters 0
within $told_within adapter_gone
next_value
sim end remove adapter
does "adapter unplugged: another is there" within $back_within test -c /dev/i2c-0
bind 0x18
over "adapter unplugged"
does "adapter unplugged: the output is as commanded" within $told_within reads pins 248

does "owsd lives" kill -0 $owsd
same "no false value was ever good" "" "$(awk '
	$4 != "good" { next }
	$2 == "warm" && $3 !~ /^2[0-9]$/ { print }
	$2 == "cold" && $3 != "-10.1" { print }
	$2 == "other" && $3 != "5" { print }' /tmp/log/watch)"
does "which the watch has seen" [ $(grep -c " warm .* good" /tmp/log/watch) -gt 5 ]
same "nothing is said of alarms that can be told" 0 "$(grep -c "no alarm search" /tmp/log/owsd)"
owsctl stats | sed 's/^/# /'
kill $owsd
wait $owsd
same "and ends when it is told to" 0 $?

# --- A table with an item whose alarm sysfs cannot tell
owsd -v -c /rig/w1pair.rio >/tmp/log/pair 2>&1 &
owsd=$!
does "a DS2406 with an alarm is read as an input" within $back_within reads pair 0
does "that it has none is said" within $told_within grep -q "no alarm search" /tmp/log/pair
sleep 2 # it is not said again
same "once" 1 "$(grep -c "no alarm search: alarm items are read as ordinary inputs" /tmp/log/pair)"
kill $owsd
wait $owsd
finish
