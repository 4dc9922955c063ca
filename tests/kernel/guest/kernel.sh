# SPDX-License-Identifier: MIT
# The kernel's own drivers bind to the simulated chips and read what house.sim says.
. /rig/lib.sh
. /rig/w1lib.sh

driver_of() {
	basename "$(readlink "$1/driver")"
}

# The bytes of house.sim's device lines between two chip lines
devices_of() {
	awk -v chip=$1 '$1 == "chip" { on = $3 == chip } on && /^DS[0-9A-Z]+ +[0-9A-F][0-9A-F]\./' \
		/rig/house.sim | wc -l
}

plug house.sim
for module in wire ds2482 w1_therm w1_smem w1_ds2405 w1_ds2406 w1_ds2408 w1_ds2413 w1_ds2423 \
	w1_ds2430 w1_ds2431 w1_ds2433 w1_ds2438; do
	modprobe $module 2>/dev/null || skip "module $module" "this kernel has none"
done

new=/sys/bus/i2c/devices/i2c-0/new_device
echo ds2482 0x18 >$new
same "ds2482 binds to the DS2482-100" ds2482 "$(driver_of /sys/bus/i2c/devices/0-0018)"
same "with one 1-Wire master" 1 "$(ls -d $W1/w1_bus_master* | wc -l)"
within 120 all_found $(devices_of 0x18)
same "its search finds every device" $(devices_of 0x18) "$(ls $W1 | grep -c '^[0-9a-f]*-')"
echo ds2482 0x1b >$new
same "ds2482 binds to the DS2482-800" ds2482 "$(driver_of /sys/bus/i2c/devices/0-001b)"
same "with eight more masters" 9 "$(ls -d $W1/w1_bus_master* | wc -l)"
all=$(($(devices_of 0x18) + $(devices_of 0x1b)))
within 120 all_found $all
for master in $W1/w1_bus_master*; do
	echo 0 >$master/w1_master_search
done
same "and each channel's devices" $all "$(ls $W1 | grep -c '^[0-9a-f]*-')"
for master in 2:1 3:2 4:2 5:2 6:3 7:4 8:0 9:1; do
	same "channel $((${master%:*} - 2)) has its own" ${master#*:} \
		"$(cat $W1/w1_bus_master${master%:*}/w1_master_slave_count)"
done

# Thermometers: millidegrees, resolution, supply
for line in 28:00:21062:12:1 28:01:-10125:12:0 28:02:124500:9:1 22:00:30500:12:1 3B:00:62:12:1 \
	42:00:-500:12:1 28:03:11000:12:1 28:04:12500:12:1 28:05:13750:12:0; do
	IFS=: read -r family number value resolution power <<-END
		$line
	END
	device=$(name $family $number)
	same "w1_therm reads $device" $value "$(text $device/temperature)"
	same "w1_therm sees the resolution of $device" $resolution "$(text $device/resolution)"
	same "w1_therm sees the supply of $device" $power "$(text $device/ext_power)"
done
near "w1_therm reads the DS18S20 with its remainder" 25400 65 "$(text $(name 10 00)/temperature)"
near "and below zero, fed by the wire" -7300 65 "$(text $(name 10 01)/temperature)"
device=$(name 28 00)
echo 10 >$W1/$device/resolution
same "w1_therm sets a resolution" 10 "$(text $device/resolution)"
same "which cuts the value" 21000 "$(text $device/temperature)"
echo "-5 30" >$W1/$device/alarms
same "w1_therm sets the alarm limits" "-5 30" "$(text $device/alarms)"
same "w1_slave's checksum is good" YES "$(text $device/w1_slave | sed -n '1s/.* //p')"
bulk_done() {
	[ "$(text w1_bus_master1/therm_bulk_read)" = 1 ]
}
echo trigger >$W1/w1_bus_master1/therm_bulk_read
does "w1_therm converts all of a wire at once" within 60 bulk_done
same "and reads them afterwards" -10125 "$(text $(name 28 01)/temperature)"
near "the DS18S20 too" 25400 65 "$(text $(name 10 00)/temperature)"

# Switches; some kernels give a DS2413's whole byte, some its lower half
device=$(name 29 00)
same "w1_ds2408 reads the pins" bd "$(hex $device/state)"
same "its outputs are off after power-on" ff "$(hex $device/output)"
same "its status tells the power-on and the supply" 88 "$(hex $device/status_control)"
does "w1_ds2408 writes the outputs" put $device/output 253
same "and reads them back" ab "$(hex $device/output)"
same "the pins are low where an output or the outside pulls" a9 "$(hex $device/state)"
device=$(name 3A 00)
same "w1_ds2413 reads pins and latches" b "$(hex $device/state | cut -c 2)"
does "w1_ds2413 writes the outputs" put $device/output 376
same "and the pin follows" 8 "$(hex $device/state | cut -c 2)"

device=$(name 12 00)
same "w1_ds2406 reads the outputs" 33 "$(hex $device/state)"
does "w1_ds2406 writes the outputs" put $device/output 062
same "and reads them back" 32 "$(hex $device/state)"
device=$(name 05 00)
same "w1_ds2405 reads the output" 1 "$(text $device/output)"
same "w1_ds2405 reads the pin" 1 "$(text $device/state)"
printf 0 >$W1/$device/output
same "w1_ds2405 switches the output" 0 "$(text $device/output)"
same "and the pin follows" 0 "$(text $device/state)"

# Counters: the kernel reads four pages, the last two count
device=$(name 1D 00)
same "w1_ds2423 reads the counters" "1234 70000 " \
	"$(text $device/w1_slave | sed -n 's/.*crc=YES c=//p' | tail -n 2 | tr '\n' ' ')"
for edge in 0 1 0 1 0; do
	sim set meter pin.A $edge
done
same "and counts falling edges" 1237 \
	"$(text $device/w1_slave | sed -n 's/.*crc=YES c=//p' | tail -n 2 | head -n 1)"

# Memory: whole size, text that house.sim put there, eight bytes written and read back
for line in 2D:128:32:48656c6c6f 23:512:480:6c617374 14:32:8:3a2d29; do
	IFS=: read -r family size at bytes <<-END
		$line
	END
	device=$(name $family 00)
	if [ ! -e $W1/$device/eeprom ]; then
		skip "the kernel reads all of $device" "this kernel has no driver for it"
		continue
	fi
	same "the kernel reads all of $device" $size "$(cat $W1/$device/eeprom | wc -c)"
	same "and what is at $at" $bytes \
		"$(hex $device/eeprom | cut -c $((2 * at + 1))-$((2 * at + ${#bytes})))"
	printf 'new text' | dd of=$W1/$device/eeprom bs=8 seek=2 conv=notrunc 2>/dev/null
	same "it writes to $device" 6e65772074657874 "$(hex $device/eeprom | cut -c 33-48)"
done

# DS2438: hundredths of a volt, 1/256 degrees
device=$(name 26 00)
same "w1_ds2438 reads the supply" 500 "$(text $device/vdd)"
same "w1_ds2438 reads the input" 230 "$(text $device/vad)"
same "w1_ds2438 reads the temperature" 5760 "$(text $device/temperature)"
same "w1_ds2438 reads page 0" 8 "$(hex $device/page0 | awk '{ print length($0) / 2 }')"
finish
