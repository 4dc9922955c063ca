# SPDX-License-Identifier: MIT
# The GPIO driver of the Raspberry Pi, with each libgpiod: chips by label, lines by name, and what
# this driver does with an output that is let go of.
. /rig/lib.sh

mount -t debugfs debugfs /sys/kernel/debug

# NAME: "out hi", "in lo IRQ"
line() {
	sed -n "s/^ gpio-[0-9]* *($1 *|owsd *) *//p" /sys/kernel/debug/gpio |
		awk '{ print $1, $2 }'
}

# PIN: what the pin controller has it as
pin() {
	sed -n "s/^pin $1 .*function \([a-z_0-9]*\) .*/\1/p" /sys/kernel/debug/pinctrl/*/pins
}

reads() {
	local value
	value=$(owsctl get $1 2>/dev/null) && [ "$value" = "$2" ]
}

for generation in 1 2; do
	owsd-gpiod-$generation -c /rig/gpio-pi.rio >/tmp/log/$generation 2>&1 &
	pid=$!
	does "$generation: an output by its name is set" within 90 reads out 1
	same "$generation: it is high" "out hi" "$(line GPIO23)"
	does "$generation: an active-low one" within 90 reads low 0
	same "$generation: is high when it is 0" "out hi" "$(line GPIO22)"
	does "$generation: an input is read" within 90 owsctl get in
	same "$generation: the kernel watches its edges" "in lo IRQ" \
		"$(line GPIO17) $(grep -c 'GPIO17 .*owsd.* IRQ' /sys/kernel/debug/gpio | sed 's/1/IRQ/')"
	owsctl get exp >/dev/null 2>&1
	same "$generation: a line of another chip is none of this one" 3 $?
	kill $pid
	wait $pid
	same "$generation: this driver makes what owsd let go of an input" "gpio_in gpio_in" \
		"$(pin 22) $(pin 23)"
done
finish
