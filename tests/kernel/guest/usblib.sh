# SPDX-License-Identifier: MIT
# For the guest's scripts about a DS2490 behind USB/IP.

chips=$(grep -c '^DS[0-9A-Z]* *[0-9A-F][0-9A-F]\.' /rig/usb.sim)

adapters() {
	cat /sys/bus/usb/devices/*/idProduct 2>/dev/null | grep -c 2490
}

one_adapter() {
	[ "$(adapters)" = 1 ]
}

no_adapter() {
	[ "$(adapters)" = 0 ]
}

masters() {
	ls -d $W1/w1_bus_master* 2>/dev/null | wc -l
}

one_master() {
	[ "$(masters)" = 1 ]
}

no_master() {
	[ "$(masters)" = 0 ]
}

# NAME: a number of the model
stat_of() {
	sim stats | sed -n "s/^$1 //p"
}

# [SCENARIO]: plug it in, and have the kernel's driver take it
plug_usb() {
	modprobe vhci-hcd
	simchip -u /rig/${1:-usb.sim} >>/tmp/log/simchip 2>&1 &
	if ! within 60 one_adapter; then
		not_ok "the simulated adapter is plugged in" "no device 04fa:2490"
		finish
	fi
	ok "the simulated adapter is plugged in"
	for module in wire w1_therm w1_smem w1_ds2413 w1_ds2431 ds2490; do
		modprobe $module
	done
	does "the kernel's driver takes it" within 60 one_master
}
