# SPDX-License-Identifier: MIT
# For the guest's scripts about the kernel's 1-Wire drivers.

W1=/sys/bus/w1/devices
i2c=/sys/bus/i2c/devices/i2c-0

# FAMILY NUMBER: the kernel's name of a device of house.sim or drivers.sim; it
# prints the six id bytes as one number
name() {
	echo "$(echo $1 | tr A-F a-f)-$(echo $1 | tr A-F a-f)00${2}c2b1a0"
}

text() {
	cat "$W1/$1" 2>/dev/null
}

# FILE: its bytes in hex, without blanks
hex() {
	od -An -v -t x1 "$W1/$1" 2>/dev/null | tr -d ' \n'
}

# FILE OCTAL: one byte into it
put() {
	printf "\\$2" >"$W1/$1"
}

# [OPTION=VALUE...] of the module wire
load_drivers() {
	modprobe wire "$@"
	for module in ds2482 w1_therm w1_smem w1_ds2405 w1_ds2406 w1_ds2408 w1_ds2413 w1_ds2423 \
		w1_ds2430 w1_ds2431 w1_ds2433 w1_ds2438; do
		modprobe $module 2>/dev/null || echo "# this kernel has no module $module"
	done
}

bind() {
	echo ds2482 $1 >$i2c/new_device
}

release() {
	echo $1 >$i2c/delete_device
}

all_found() {
	[ "$(ls $W1 | grep -c '^[0-9a-f]*-')" = "$1" ]
}

# From now on only when it is asked to
search_no_more() {
	for master in $W1/w1_bus_master*; do
		echo 0 >$master/w1_master_search
	done
}
