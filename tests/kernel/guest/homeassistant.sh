# SPDX-License-Identifier: MIT
# A DS9490R on the way that docs/bring-up.md and docs/mqtt.md lead, up to the genuine Home Assistant at a
# broker of the host (tests/system/test_homeassistant.py): nothing is typed there, and it asks for nothing.
. /rig/lib.sh
. /rig/w1lib.sh
. /rig/usblib.sh

chips=4 # of homeassistant.sim
file=/tmp/OWS.rio
host=10.0.2.2
patience=150

# ENTITY TEXT: of its state and all else that Home Assistant says of it
shows() {
	mosquitto_sub -h $host -p $broker -W 10 -C 1 -t judge/states | tr ';' '\n' | grep "^$1=" >/tmp/shown
	grep "^$1=$2" /tmp/shown
}

# NAME ENTITY TEXT
sees() {
	if within $patience shows $2 "$3"; then ok "$1"; else not_ok "$1" "$(cat /tmp/shown)"; fi
}

# ACTION ENTITY
act() {
	mosquitto_pub -h $host -p $broker -q 1 -t judge/act -m "{\"action\": \"$1\", \"entity\": \"$2\", \"data\": {}}"
}

listed() {
	owsctl -t usb: scan --rio --bits >$file
}

pins() {
	[ "$(owsctl get input1)" = "$1" ]
}

for module in virtio_pci virtio_net; do
	modprobe $module
done
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up

plug_usb homeassistant.sim
does "the kernel has all chips" within $patience all_found $chips
does "a scan takes the adapter from it" within $patience listed
does "owsd understands what the scan wrote" owsd --check -c $file
does "the broker is named" owsctl config $file set Mqtt Broker=mqtt://$host:$broker Node=pi7 Write=on
owsd -c $file >/tmp/log/owsd 2>&1 &
STATE_DIRECTORY=/tmp/mqtt owsd-mqtt -c $file >/tmp/log/mqtt 2>&1 &

sees "Home Assistant has a thermometer with value and unit" sensor.temperature1 '21.5=.*=°C$'
sees "and one below zero" sensor.temperature2 '-10.125=.*=°C$'
sim set warm temperature 23.25
sees "it follows" sensor.temperature1 23.25=
relay=switch.ds2413_3a_a0b1c200003a_output1
sees "it has a relay" $relay off=
act switch.turn_on $relay
sees "which it switches" $relay on=
does "and the pin is low" within $patience pins 0
act switch.turn_off $relay
sees "on and off" $relay off=
does "and the pin is high" within $patience pins 1

sim remove adapter
sees "without the adapter the thermometer is unavailable" sensor.temperature1 unavailable=
sees "and the relay" $relay unavailable=
sees "and it says why" binary_sensor.temperature1_problem 'on=.*=target down='
owsctl doctor >/tmp/advice
does "doctor's first line is the adapter" grep -q '^1\. owsd says: the adapter is gone' /tmp/advice
sim end remove adapter
sim set warm temperature 24.5
sees "it comes back by itself" sensor.temperature1 24.5=
sees "with the relay" $relay off=

sim unplug warm
sees "a sensor that is pulled off is unavailable" sensor.temperature1 unavailable=
sees "and the other one is not" sensor.temperature2 -10.125=
sim plug warm
sees "and comes back" sensor.temperature1 24.5=
finish
