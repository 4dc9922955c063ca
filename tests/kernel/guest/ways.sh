# SPDX-License-Identifier: MIT
# One wire and the ways to it: the genuine owserver, /dev/i2c-0, the kernel's drivers by files and by
# netlink. Each is taken away in turn; owsd takes the next, and the outputs go with it.
. /rig/lib.sh

sys=/sys/bus/i2c
moved_within=150
server=

# SIGNAL VALUE TARGET: good, with this value, and from there
served() {
	owsctl --json get $1 >/tmp/got && grep -q '"good":true' /tmp/got &&
		grep -q "\"value\":$2[,}]" /tmp/got && grep -q "\"target\":\"$3\"" /tmp/got
}

said() {
	grep -q "$1" /tmp/log/owsd
}

# TARGET STATE
is() {
	owsctl stats | grep -q "^target.* $1: $2,"
}

start_server() {
	owserver --i2c=/dev/i2c-0:ALL -p 127.0.0.1:4304 --foreground >>/tmp/log/owserver 2>&1 &
	server=$!
}

# It ends where its first look at the chip meets one of owsd: then once more, as a service manager does
served_again() {
	kill -0 $server 2>/dev/null || start_server
	served "$@"
}

answers() {
	owdump 4304 dir / | grep -q '^/28'
}

# But for the moment in which owsd looks whether the chip is to be had again
closed() {
	! ls -l /proc/$owsd/fd | grep -q i2c
}

# NAME VALUE TARGET: set, and seen at the pins of the board, by whatever way
switches() {
	owsctl set relays $2 || return 1
	does "$1" within $moved_within served pins $((255 - $2)) "$3"
}

plug ways.sim
for module in wire ds2482 w1_therm w1_ds2408; do
	modprobe $module
done
start_server
does "owserver serves the simulated network" within $moved_within answers
owsd -c /rig/ways.rio -t "localhost:4304 | i2c:/dev/i2c-0:0x18 | w1" >>/tmp/log/owsd 2>&1 &
owsd=$!
does "the first way serves" within $moved_within served warm 20.5 localhost:4304
switches "and switches" 1 localhost:4304
does "the second is kept closed" within $moved_within is i2c:/dev/i2c-0:0x18 suspended
does "and the third" within $moved_within is w1 suspended
does "nobody of owsd has the adapter open" within $moved_within closed

kill -9 $server
wait $server 2>/dev/null
sim set warm temperature 21.5
does "without owserver the adapter itself serves" within $moved_within \
	served warm 21.5 i2c:/dev/i2c-0:0x18
does "with the output as it was" within $moved_within served pins 254 i2c:/dev/i2c-0:0x18
switches "and switches it" 2 i2c:/dev/i2c-0:0x18

sim set warm temperature 22.5
echo ds2482 0x18 >$sys/devices/i2c-0/new_device
does "a kernel driver that takes the chip gets it" within $moved_within served warm 22.5 w1
does "which is said with what to do" \
	said "0x18 on /dev/i2c-0 is claimed by the kernel's ds2482 driver: use target w1, or echo 0-0018 > /sys/bus/i2c/drivers/ds2482/unbind"
does "with the output as it was" within $moved_within served pins 253 w1
switches "and switches it" 4 w1
does "the adapter is closed" within $moved_within closed

sim set warm temperature 23.5
echo 0-0018 >$sys/drivers/ds2482/unbind
does "what the message says gives it back" within $moved_within \
	served warm 23.5 i2c:/dev/i2c-0:0x18
does "with the output as it was" within $moved_within served pins 251 i2c:/dev/i2c-0:0x18

sim set warm temperature 24.5
start_server
does "an owserver that is there again is the first way again" within $moved_within \
	served_again warm 24.5 localhost:4304
does "with the output as it was" within $moved_within served pins 251 localhost:4304
does "the adapter is closed again" within $moved_within is i2c:/dev/i2c-0:0x18 suspended

owsctl stats | sed -n 's/^target/# target/p'
kill $owsd
wait $owsd
same "owsd ends when it is told to" 0 $?

sim set warm temperature 25.5
kill -9 $server
wait $server 2>/dev/null
owsd -c /rig/ways.rio -t auto >>/tmp/log/owsd 2>&1 &
owsd=$!
does "auto finds the chip" within $moved_within served warm 25.5 i2c:auto
bind() {
	echo 0-0018 >$sys/drivers/ds2482/bind
}
within $moved_within bind
does "or the driver that has it" within $moved_within served warm 25.5 w1
kill $owsd
wait $owsd

sim set warm temperature 26.5
owsd -c /rig/ways.rio -t "i2c:/dev/i2c-0:0x18 | w1:netlink" >>/tmp/log/owsd 2>&1 &
owsd=$!
does "the driver's master serves as a wire too" within $moved_within served warm 26.5 w1:netlink
switches "and switches" 8 w1:netlink
sim set warm temperature 27.5
echo 0-0018 >$sys/drivers/ds2482/unbind
does "until the driver lets go" within $moved_within served warm 27.5 i2c:/dev/i2c-0:0x18
does "with the output as it was" within $moved_within served pins 247 i2c:/dev/i2c-0:0x18
switches "which is switched" 16 i2c:/dev/i2c-0:0x18
sim set warm temperature 28.5
within $moved_within bind
does "and when it takes the chip again" within $moved_within served warm 28.5 w1:netlink
does "with the output as it was" within $moved_within served pins 239 w1:netlink
kill $owsd
wait $owsd
finish
