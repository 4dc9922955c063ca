# SPDX-License-Identifier: MIT
# owsd as it is run: over /dev/i2c-0 while a kernel driver has the chips and when it lets go of them,
# values of all channels, an output, parts and adapter that go and come, an owsd that is killed.
. /rig/lib.sh

i2c=/sys/bus/i2c/devices/i2c-0
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

said() {
	grep -q "$1" /tmp/log/owsd
}

run_owsd() {
	owsd -c /rig/daemon.rio -t i2c:/dev/i2c-0 >>/tmp/log/owsd 2>&1 &
	owsd=$!
}

all_good() {
	owsctl get warm cold old far pins relays volt count analog there
}

plug house.sim
modprobe ds2482
echo ds2482 0x18 >$i2c/new_device
echo ds2482 0x1b >$i2c/new_device
# Nine wires, searched every ten seconds, are all that a slow machine can do
for master in /sys/bus/w1/devices/w1_bus_master*; do
	echo 0 >$master/w1_master_search
done
run_owsd
does "a chip that a kernel driver owns is said plainly" within $told_within \
	said "0x1[8b] on /dev/i2c-0 is claimed by the kernel's ds2482 driver: use target w1, or echo 0-001[8b] > /sys/bus/i2c/drivers/ds2482/unbind"
does "and the signals are not good" within $told_within bad warm
echo 0x18 >$i2c/delete_device
does "a chip that the driver let go of is served" within $back_within reads warm 21.0625
does "the one that it kept is not" bad pins
echo 0x1b >$i2c/delete_device
does "until that is free, too" within $back_within reads pins 189

does "everything is good" within $back_within all_good
same "a thermometer fed by the wire" -10.125 "$(get cold)"
same "a DS18S20" 25.375 "$(get old)"
same "one on channel 7" 13.75 "$(get far)"
same "a voltage of a DS2438" 2.3 "$(get volt)"
same "a counter" 70000 "$(get count)"
near "a voltage of a DS2450" 3.75 0.001 "$(get analog)"
owsctl set relays 5
does "an output switches its pin" within $told_within reads pins 184

if owsctl -t i2c:/dev/i2c-0 dir / >/dev/null 2>/tmp/reason; then
	not_ok "a second master is refused" "it was not"
else
	ok "a second master is refused"
fi
sed 's/^/# /' /tmp/reason

sim unplug warm
does "a part that is gone makes its signal bad" within $told_within bad warm
same "and the next one stays good" -10.125 "$(get cold)"
sim plug warm
sim set warm temperature 22
does "it comes back with the value of now" within $back_within reads warm 22

sim remove adapter
does "an adapter that is gone makes all bad" within $told_within bad pins
does "the others too" within $told_within bad warm
sim set warm temperature 23
sim end remove adapter
does "it comes back" within $back_within reads warm 23
does "with everything" within $back_within all_good
does "and the output as commanded" within $told_within reads pins 184

kill -9 $owsd
wait $owsd 2>/dev/null
does "what owsd left when it was killed is not good" within $told_within bad warm
sim set warm temperature 24
run_owsd
does "another owsd takes over" within $back_within reads warm 24
does "with InitValue, for who commanded has ended" within $back_within reads relays 0
does "which the chip does" within $back_within reads pins 189
does "owsd lives" kill -0 $owsd
kill $owsd
wait $owsd
same "and ends when it is told to" 0 $?
finish
