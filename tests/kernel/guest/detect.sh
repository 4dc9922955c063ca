# SPDX-License-Identifier: MIT
# i2cdetect and single SMBus calls see the chips where the scenario puts them, and only there.
. /rig/lib.sh

if ! plug house.sim; then
	not_ok "the simulated adapter is plugged in" "no /dev/i2c-0"
	finish
fi
ok "the simulated adapter is plugged in"

seen=$(i2cdetect -y 0 | sed -n '2,$s/^[0-7]0: //p' | tr -s ' ' '\n' | grep '^[0-9a-f]' | tr '\n' ' ')
same "i2cdetect sees the chips of the scenario and no others" "18 1b " "$seen"

reset_status() {
	i2cset -y 0 $1 0xf0 >/dev/null && i2cget -y 0 $1
}
for chip in 0x18 0x1b; do
	same "the status of $chip after a device reset is RST and LL" 0x18 "$(reset_status $chip)"
	same "the configuration of $chip is read back without its complement" 0x01 \
		"$(i2cset -y 0 $chip 0xd2 0xe1 && i2cget -y 0 $chip)"
	same "the status of $chip tells no reset after that" 0x08 \
		"$(i2cset -y 0 $chip 0xe1 0xf0 && i2cget -y 0 $chip)"
done
i2cset -y 0 0x18 0xc3 0xf0 2>/dev/null
same "the DS2482-100 refuses a channel" 1 $?
same "the DS2482-800 answers a channel with its code" 0xa3 \
	"$(i2cset -y 0 0x1b 0xc3 0xc3 && i2cget -y 0 0x1b)"
finish
