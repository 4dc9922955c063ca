# SPDX-License-Identifier: MIT
# GPIO lines of a real kernel driver, with each libgpiod: signals, lamps, the line of a supply, and
# what goes wrong. What the kernel says of a line is taken from its own list.
. /rig/lib.sh

within_s=90
mount -t debugfs debugfs /sys/kernel/debug
base=$(cat /sys/class/gpio/gpiochip*/base)
echo 'guest:x:1000:1000::/:/bin/sh' >/etc/passwd

# LINE: "out hi", "in lo IRQ", nothing for a line that nobody has
line() {
	sed -n "s/^ gpio-$((base + $1)) *(.*|[^)]*) *//p" /sys/kernel/debug/gpio |
		awk '{ print $1 ($2 == "" ? "" : " " $2) }'
}

is() {
	[ "$(line $1)" = "$2" ]
}

get() {
	owsctl get $1 2>/tmp/reason
}

# SIGNAL VALUE: good, and this one
reads() {
	local value
	value=$(get $1) && [ "$value" = "$2" ]
}

bad() {
	get $1 >/tmp/value
	[ $? -eq 3 ]
}

said() {
	grep -q "$1" /tmp/log/$owsd
}

counter() {
	owsctl stats | awk -v n=$1 '$2 == n { print $1 }'
}

# The counter NAME is at least N
counted() {
	[ "$(counter $1)" -ge $2 ]
}

# What the last press of the key was to bring has come
pressed() {
	[ -s /tmp/pressed ] && counted bus_edges $edges
}

end() {
	kill $pid
	wait $pid
}

# Both levels are seen on a line within three seconds
blinks() {
	local seen=
	for i in $(seq 60); do
		seen="$seen $(line $1)"
		usleep 50000 # pace
	done
	case $seen in *"out hi"*) ;; *) return 1 ;; esac
	case $seen in *"out lo"*) ;; *) return 1 ;; esac
}

with() {
	local generation=$1 version=$2
	owsd=owsd-gpiod-$generation
	echo "# libgpiod $version"

	same "$generation: it says which libgpiod it has" "with libgpiod $version" \
		"$($owsd -V | grep libgpiod)"
	echo $((base + 4)) >/sys/class/gpio/export
	mv /dev/gpiochip0 /dev/hidden
	$owsd -c /rig/gpio.rio >/tmp/log/$owsd 2>&1 &
	pid=$!
	does "$generation: a missing chip is said" within $within_s said "no /dev/gpiochip0"
	does "$generation: and its signals are bad" within $within_s bad level
	mv /dev/hidden /dev/gpiochip0
	does "$generation: it is served when it comes" within $within_s reads level 0
	same "$generation: an input is one for the kernel" "in lo" "$(line 0)"

	does "$generation: an output is set" owsctl set -w 60 out 1
	same "$generation: and the line is high" "out hi" "$(line 1)"
	does "$generation: it reads back" within $within_s reads back 1
	does "$generation: the alarm line is on" within $within_s is 6 "out hi"
	does "$generation: the output is reset" owsctl set -w 60 out 0
	same "$generation: and the line is low" "out lo" "$(line 1)"
	does "$generation: the alarm waits for somebody" is 6 "out hi"
	owsctl alarms ack back >/dev/null
	does "$generation: and goes when it was seen" within $within_s is 6 "out lo"
	does "$generation: an active-low output is 1 when low" within $within_s is 2 "out lo"
	does "$generation: it is set to 0" owsctl set -w 60 low 0
	same "$generation: which is high" "out hi" "$(line 2)"
	does "$generation: the heartbeat blinks" blinks 7

	does "$generation: a line in use is bad" bad taken
	does "$generation: and the log names its user" within $within_s said 'line 4 of .*pl061 is in use by "sysfs"'
	echo $((base + 4)) >/sys/class/gpio/unexport
	does "$generation: it comes when it is free" within $within_s reads taken 0
	does "$generation: a line that the chip has not is bad" bad none

	# 10 ms, a tenth of the period. A busy host may keep the guest from its interrupts for as long,
	# and what was over before the kernel looked nobody has seen: then it is pressed again.
	owsctl wait -t 120 key = 1 >/tmp/pressed 2>&1 &
	waiter=$!
	within $within_s grep -q futex /proc/$waiter/wchan || echo "# owsctl does not wait"
	for press in 1 2 3 4 5; do
		edges=$(($(counter bus_edges) + 2))
		echo "@@RIG-POWER-KEY"
		within 10 pressed && break
		echo "# press $press was too short"
	done
	does "$generation: a press of the key is seen" wait $waiter
	does "$generation: and that it is over" within $within_s reads key 0
	does "$generation: both edges came" counted bus_edges $edges

	same "$generation: a line of owsd is busy for others" "owsctl: /gpio/2: Device or resource busy" \
		"$(owsctl -t gpio:gpiochip0 read /gpio/2 2>&1)"
	does "$generation: one that nobody has is looked at" owsctl -t gpio:gpiochip0 read /gpio/5
	end
	same "$generation: the chip by its label; the driver has kept the level" 1 \
		"$(owsctl -t gpio:9030000.pl061 read /gpio/2 2>&1)"
	chmod 600 /dev/gpiochip0
	su guest -c '/rig/bin/owsctl -t gpio:gpiochip0 read /gpio/2' >/tmp/reason 2>&1
	chmod 666 /dev/gpiochip0
	does "$generation: without the right the group is named" grep "no permission.*(gpio)" /tmp/reason

	$owsd -c /rig/gpio-supply.rio >/tmp/log/$owsd.supply 2>&1 &
	pid=$!
	does "$generation: the supply of a wire is on" within $within_s is 5 "out hi"
	does "$generation: its chip is awake" within $within_s is 1 "out hi"
	does "$generation: its devices are read" within $within_s reads warm 20
	does "$generation: a chip that hangs is cycled" within $within_s counted bus_recover_power_cycle 1
	does "$generation: and read again" within $within_s reads warm 20
	same "$generation: the supply is on" "out hi" "$(line 5)"
	end
}

with 1 1.6.3
with 2 2.2.1
finish
