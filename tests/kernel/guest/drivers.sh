#!/bin/sh
# SPDX-License-Identifier: MIT
# The kernel's drivers that no other suite loads, and owsd itself over /dev/i2c-0, on the same
# simulated chips: each reads what the other reads and has written, byte by byte.
. /rig/lib.sh
. /rig/w1lib.sh

PACK=30.A0B1C2000030 ONE=32.A0B1C2000032 TWO=3D.A0B1C200003D
SWITCH=1C.A0B1C200001C BRIDGE=19.A0B1C2000019
# 30 bytes and their CRC16, as w1_ds28e04 wants a page
BY_OWSD=7772697474656e206279206f77736400000000000000000000000000000008c3
BY_DRIVER=7772697474656e20627920746865206472697665720000000000000000000fcb
PORT=4304

# --- owsd
owsd_has_all() {
	[ "$(owdump $PORT dir / | grep -c '^/[0-9A-F][0-9A-F]\.A0B1C2')" = 5 ]
}

start_owsd() {
	owsd -c /rig/drivers.rio -l $PORT >>/tmp/log/owsd 2>&1 &
	owsd=$!
	within 60 owsd_has_all && return
	not_ok "owsd finds the five chips" "$(owdump $PORT dir / | tr '\n' ' ')"
	finish
}

stop_owsd() {
	kill $owsd
	wait $owsd 2>/dev/null
}

# PATH: the value, without blanks
told() {
	echo /uncached/$1 | owdump $PORT read | sed 's/^[^	]*	//' | tr -d ' '
}

# The value of owdump's or busdump's line, its bytes in hex
in_hex() {
	sed 's/^[^	]*	//' | awk '
		BEGIN { for (i = 32; i < 127; i++) ORD[sprintf("%c", i)] = i }
		{
			for (text = $0; text != ""; )
				if (substr(text, 1, 2) == "\\x") {
					printf "%s", substr(text, 3, 2)
					text = substr(text, 5)
				} else {
					printf "%02x", ORD[substr(text, 1, 1)]
					text = substr(text, 2)
				}
		}'
}

# PATH: the bytes of the value in hex
ours() {
	echo /uncached/$1 | owdump $PORT read | in_hex
}

# The memories to files, by owsd's driver alone: it takes longer than a client of owsd would wait
read_memories() {
	for chip in $PACK $ONE $TWO $SWITCH; do
		echo /$chip/memory
	done | busdump i2c:/dev/i2c-0 read 2>>/tmp/log/busdump >/tmp/memories
	for chip in $PACK $ONE $TWO $SWITCH; do
		grep "^/$chip/" /tmp/memories | in_hex >/tmp/$chip
	done
}

# PATH: the same by owsd's target w1
by_files() {
	echo /uncached/$1 | busdump w1 read 2>>/tmp/log/busdump | in_hex
}

# TARGET PATH HEX
writes() {
	echo "/uncached/$2 $(escaped $3)" | busdump $1 write 2>>/tmp/log/busdump | sed 's/.*ret=//'
}

# HEX as owdump and busdump take it, and as printf
escaped() {
	echo $1 | sed 's/../\\x&/g'
}

# WHAT PATH VALUE
tells() {
	same "$1" 0 "$(printf '/uncached/%s %s\n' "$2" "$3" | owdump $PORT write | sed 's/.*ret=//')"
}

# --- The kernel
power() {
	cat /sys/class/power_supply/ds2760-battery*/$1 2>/dev/null
}

# FILE VALUE
power_set() {
	for supply in /sys/class/power_supply/ds2760-battery*; do
		echo $2 >$supply/$1
	done
}

# A search has to attach the DS2760: its driver goes on using the name of its power supply, which is on
# the stack of who attached it. Of modprobe nothing is left by then, and the kernel falls over it.
attach_all() {
	modprobe wire
	for module in ds2482 ds2760_battery w1_ds2780 w1_ds2781 w1_ds28e04 w1_ds28e17; do
		does "the module $module" modprobe $module
	done
	bind 0x18
	bind 0x19
	does "the kernel's search finds the five chips" within 150 all_found 5
	search_no_more
}

attached() {
	[ -e $W1/$switch/eeprom ] && [ -e $W1/$pack/w1_slave ]
}

# PAGE of the DS28E04 in hex
page_of() {
	dd if=$W1/$switch/eeprom bs=32 skip=$1 count=1 2>/dev/null | od -An -v -t x1 | tr -d ' \n'
}

# WHAT CHIP FILE LEAST: the file has at least so many bytes, and they are what owsd read of the chip
alike() {
	local bytes=$(hex $3)
	does "$1: $4 bytes and more" [ ${#bytes} -ge $((2 * $4)) ]
	same "$1" "$(part "$(cat /tmp/$2)" 0 $((${#bytes} / 2)))" "$bytes"
}

# HEX from BYTE on, N bytes
part() {
	echo "$1" | cut -c $((2 * $2 + 1))-$((2 * ($2 + $3)))
}

plug drivers.sim
printf 'at %s\n' "$BRIDGE sht4x 0x44" "$BRIDGE mcp23017 0x20 as io" |
	cat /rig/sensors.table - >/tmp/sensors.table

# --- owsd first: what it reads and has written
start_owsd
near "owsd reads the voltage of the DS2760" 3.904 0.0001 "$(told $PACK/volt)"
near "and its temperature" 22.25 0.0001 "$(told $PACK/temperature)"
near "and its current" -0.070625 0.000001 "$(told $PACK/current)"
sim set pack vis 0
tells "owsd writes a page of the DS2780" $ONE/pages/page.0 "$(escaped 00112233445566778899aabbccddeeff)"
tells "and of the DS2781" $TWO/pages/page.0 "$(escaped fedcba98765432100123456789abcdef)"
tells "and of the DS28E04" $SWITCH/pages/page.2 "$(escaped $BY_OWSD)"
tells "and some bytes of another" $SWITCH/pages/page.15 end
tells "owsd closes an output of the DS28E04" $SWITCH/PIO.BYTE 1
tells "owsd makes eight pins of the MCP23017 outputs" $BRIDGE/io/direction 65280
tells "and sets them" $BRIDGE/io/latch 90
pins=$(told $SWITCH/sensed.BYTE)
temperature=$(told $BRIDGE/temperature) io=$(told $BRIDGE/io/pins)
same "the pins are low where the output or the outside pulls" 0 "$pins"
near "owsd reads the SHT4x" 21.5 0.01 "$temperature"
same "and the pins of the MCP23017" $((0xa55a)) "$io"
stop_owsd
read_memories

# --- The kernel's drivers: the same bytes
pack=$(name 30 00) one=$(name 32 00) two=$(name 3D 00) switch=$(name 1C 00) bridge=$(name 19 00)
attach_all
alike "ds2760_battery reads the bytes that owsd reads" $PACK $pack/w1_slave 64
alike "w1_ds2780 too" $ONE $one/w1_slave 128
alike "w1_ds2781 too" $TWO $two/w1_slave 128
alike "w1_ds28e04 too" $SWITCH $switch/eeprom 512
same "w1_ds2780 reads what owsd wrote" 00112233445566778899aabbccddeeff \
	"$(part "$(hex $one/w1_slave)" 32 16)"
same "w1_ds2781 too" fedcba98765432100123456789abcdef "$(part "$(hex $two/w1_slave)" 32 16)"
same "w1_ds28e04 too" $BY_OWSD "$(page_of 2)"
same "w1_ds28e04 reads the pins" $pins $((0x$(hex $switch/pio) & 3))

sim set pack vis -1.765625
sleep 2 # the driver keeps what it has read for a second
same "ds2760_battery reads the voltage" 3904000 "$(power voltage_now)"
same "and tenths of a degree" 222 "$(power temp)"
same "and the current" -70625 "$(power current_now)"
sim set pack vis 0

# --- The sensors behind the DS28E17, from the kernel's side
n=$(grep -l '^w1-19-' /sys/bus/i2c/devices/i2c-*/name | sed 's|.*/i2c-\([0-9]*\)/name|\1|')
does "w1_ds28e17 makes an adapter of the bridge" test -c "/dev/i2c-$n"
same "i2cdetect sees the MCP23017 there, and no others" 20 \
	"$(i2cdetect -y -r $n 0x20 0x2f | sed -n '2,$s/^[0-7]0: //p' | tr -s ' ' '\n' | grep '^[0-9a-f]')"
same "i2cget reads its pins" 0xa55a "$(i2cget -y $n 0x20 0x12 w)"
same "and its directions, by one transfer with all registers to them" "0x00 0xff" \
	"$(i2ctransfer -y $n w1@0x20 0x00 r22 | cut -d ' ' -f 1-2)"
same "nobody answers at another address" 1 "$(i2cget -y $n 0x21 0x00 >/dev/null 2>&1; echo $?)"
i2ctransfer -y $n w1@0x44 0xfd
usleep 20000 # the chip measures
raw=$(i2ctransfer -y $n r6@0x44)
same "i2ctransfer reads the SHT4x with its checksums" "0x61 0x47 0x8a 0x5e 0x35 0x3b" "$raw"
same "which is the temperature that owsd reads" "$temperature" \
	"$(set -- $raw && awk -v n=$(($1 * 256 + $2)) 'BEGIN { printf "%.6g", -45 + 175 * n / 65535 }')"
same "the bridge has the speed that the driver sets" 0 "$(text $bridge/speed)"
does "and another" sh -c "echo 400 >$W1/$bridge/speed"
same "which it has then" 1 "$(text $bridge/speed)"
does "i2cset writes the latches of the MCP23017" i2cset -y $n 0x20 0x14 0xc3 0x0f i
same "and its output follows" 0xc3 "$(i2cget -y $n 0x20 0x12)"
does "i2ctransfer writes and reads without a STOP between" i2ctransfer -y $n w2@0x20 0x01 0xf0 w1@0x20 0x13 r1

# --- What the kernel's drivers write
printf 1 >$W1/$switch/crccheck
does "w1_ds28e04 writes a page" sh -c \
	"printf '$(escaped $BY_DRIVER)' | dd of=$W1/$switch/eeprom bs=32 seek=3 conv=notrunc"
same "and has it" $BY_DRIVER "$(page_of 3)"
same "but none with a wrong checksum" 1 "$(printf '%032d' 0 2>/dev/null |
	dd of=$W1/$switch/eeprom bs=32 seek=4 conv=notrunc 2>/dev/null; echo $?)"
printf 0 >$W1/$switch/crccheck
does "without crccheck it writes bytes over the end of a page" sh -c \
	"printf 'across pages' | dd of=$W1/$switch/eeprom bs=12 seek=18 conv=notrunc"
printf 1 >$W1/$switch/crccheck
same "target w1 reads the page that the driver wrote" $BY_DRIVER "$(by_files $SWITCH/pages/page.3)"
same "and writes one" 0 "$(writes w1 $SWITCH/pages/page.5 $BY_OWSD)"
same "which the driver has then" $BY_OWSD "$(page_of 5)"
same "but none without a checksum" -22 "$(writes w1 $SWITCH/pages/page.6 ${BY_OWSD%3}4)"
same "by netlink that page gets other bytes" 0 "$(writes w1:netlink $SWITCH/pages/page.5 $BY_DRIVER)"
same "but the driver keeps a page whose checksum is right" $BY_OWSD "$(page_of 5)"
for chip in $PACK $ONE $TWO $BRIDGE; do
	busdump w1 dir /$chip 2>/dev/null
done | sed 's|.*/||' | sort -u >/tmp/offered
does "target w1 lists the others, whose files it does not use" [ -s /tmp/offered ]
same "with nothing but what the id says" "" "$(grep -v -x \
	'address\|alias\|crc8\|family\|id\|locator\|r_address\|r_id\|r_locator\|type' /tmp/offered)"
does "w1_ds28e04 opens one output and closes the other" put $switch/pio 001
same "and its pin follows" 1 $((0x$(hex $switch/pio) & 3))
does "ds2760_battery sets the charge" power_set charge_now 468000
does "and the capacity" power_set charge_full 1072000
echo 1 >/sys/module/ds2760_battery/parameters/pmod_enabled
for device in $pack $switch; do
	echo $device >$W1/w1_bus_master1/w1_master_remove
done
echo 1 >$W1/w1_bus_master1/w1_master_search
does "the kernel finds two of them again" within 60 attached
for device in $pack $one $two; do
	hex $device/w1_slave >/tmp/$device
done
hex $switch/eeprom >/tmp/$switch
same "w1_ds28e04 reads the page anew" $BY_DRIVER "$(part "$(cat /tmp/$switch)" 160 32)"
release 0x18
release 0x19

# --- What owsd finds then
read_memories
for pair in "$PACK $pack" "$ONE $one" "$TWO $two" "$SWITCH $switch"; do
	set -- $pair
	size=$(wc -c </tmp/$2)
	does "the kernel read $1 last" [ $size -ge 128 ]
	same "owsd reads the same of it" "$(cat /tmp/$2)" "$(part "$(cat /tmp/$1)" 0 $((size / 2)))"
done
start_owsd
same "owsd reads the page that w1_ds28e04 wrote" $BY_DRIVER "$(ours $SWITCH/pages/page.3)"
same "and the bytes" 6163726f7373207061676573 "$(part "$(cat /tmp/$SWITCH)" 216 12)"
same "the page that it refused is as it was" ffffffff "$(part "$(cat /tmp/$SWITCH)" 128 4)"
same "the outputs are the driver's" 2 "$(told $SWITCH/PIO.BYTE)"
same "the pins too" 1 "$(told $SWITCH/sensed.BYTE)"
near "the charge is what ds2760_battery set" 0.468 0.0001 "$(told $PACK/amphours)"
sim brownout pack
same "the capacity is, and is in the EEPROM" 0430 "$(part "$(ours $PACK/pages/page.0)" 0 2)"
same "the sleep mode too" 1 "$(told $PACK/pmod)"
same "the MCP23017 has the kernel's latches" $((0x0fc3)) "$(told $BRIDGE/io/latch)"
same "and directions" $((0xf000)) "$(told $BRIDGE/io/direction)"
same "and levels" $((0xa5c3 & 0xf000 | 0x0fc3 & 0x0fff)) "$(told $BRIDGE/io/pins)"
near "the SHT4x is measured as before" 40 0.01 "$(told $BRIDGE/humidity)"
stop_owsd
finish
