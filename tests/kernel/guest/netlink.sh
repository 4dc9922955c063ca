# SPDX-License-Identifier: MIT
# Target w1:netlink on the kernel's ds2482: the devices, values, alarms and writes of the way over
# /dev/i2c-0; refused, it serves by files; driver, module and adapter that go and come under owsd.
. /rig/lib.sh

i2c=/sys/bus/i2c/devices/i2c-0
W1=/sys/bus/w1/devices
told_within=90
back_within=150

# Fed by the wire: there is no strong pull-up over netlink
parasite=28.A0B1C2010028

# FILE of paths: those of netlink.sim's devices
ours() {
	awk 'FILENAME ~ /sim$/ { if ($2 ~ /^[0-9A-F][0-9A-F]\./) has[$2] = 1; next }
		/^\// { path = $1; sub("^/uncached", "", path); split(path, part, "/")
			if (part[2] in has && part[2] != "'$parasite'") print }' /rig/netlink.sim $1
}

devices() {
	sed -n 's|^/\([0-9A-F][0-9A-F]\.[0-9A-F]*\)$|\1|p' $1 | sort
}

# TARGET FILES: what it says, into FILES.dir .read .write .after .alarms
survey() {
	busdump $1 dir / /alarm >$2.dir 2>>/tmp/log/busdump
	busdump $1 read </tmp/paths >$2.read 2>>/tmp/log/busdump
	busdump $1 write </tmp/writes >$2.write 2>>/tmp/log/busdump
	sed 's/ .*//' /tmp/writes | busdump $1 read >$2.after 2>>/tmp/log/busdump
	busdump $1 dir /alarm /alarm/05,29 >$2.alarms 2>>/tmp/log/busdump
}

bind() {
	echo ds2482 0x18 >$i2c/new_device
	echo ds2482 0x19 >$i2c/new_device
}

slaves() {
	cat $W1/w1_bus_master*/w1_master_slaves | grep -c '^[0-9a-f]*-'
}

get() {
	owsctl get $1 2>/tmp/reason
}

bad() {
	get $1 >/tmp/value
	[ $? -eq 3 ]
}

reads() {
	[ "$(get $1)" = "$2" ]
}

# Each look gets a value of its own, so that an old one cannot pass for it
warm=21
next_value() {
	warm=$((warm + 1))
	sim set warm temperature $warm
}

sed 's|^/|/uncached/|' /rig/expect.txt >/tmp/expected
ours /tmp/expected | sed 's/ .*//' >/tmp/paths
echo /uncached/2D.A0B1C200002D/memory >>/tmp/paths
echo /uncached/05.A0B1C2000005/present >>/tmp/paths
ours /rig/writes.txt >/tmp/writes

plug netlink.sim
survey i2c:/dev/i2c-0 /tmp/i2c
unplug
plug netlink.sim
modprobe ds2482
bind
survey w1:netlink /tmp/netlink
same "every device is found" "$(devices /tmp/i2c.dir)" "$(devices /tmp/netlink.dir)"
for what in read write after; do
	awk -v what=$what -f /rig/compare.awk /tmp/i2c.$what /tmp/netlink.$what || failed=1
done
same "the conditional search finds the same devices" "$(grep ^/alarm/ /tmp/i2c.dir | sort)" \
	"$(grep ^/alarm/ /tmp/netlink.dir | sort)"
same "after they were told others, too" "$(sort /tmp/i2c.alarms)" "$(sort /tmp/netlink.alarms)"
same "and there are some" 0 "$(grep -q ^/alarm/ /tmp/netlink.alarms; echo $?)"
kernel_has_all() {
	[ "$(slaves)" = 10 ]
}
does "the kernel has found them, too" within 120 kernel_has_all
same "a thermometer fed by the wire is refused" "ret=-95" \
	"$(echo /$parasite/temperature | busdump w1:netlink read 2>&1 | cut -f 2)"
busdump w1:netlink dir $(yes /alarm | head -n 15) >/tmp/said 2>&1
same "15 conditional searches do not make the kernel forget a device" 10 "$(slaves)"

# The connector asks for no right to send, on this kernel; only one network namespace has it
other=/uncached/28.A0B1C2040028/templow
echo $other >/tmp/path
echo "nobody:x:65534:65534:::/bin/sh" >/etc/passwd
echo "nobody:x:65534:" >/etc/group
start-stop-daemon -S -c 65534:65534 -x /rig/bin/busdump -- w1:netlink/w1_bus_master2 read \
	</tmp/path >/tmp/said 2>/tmp/note
same "any user may use it" 70 "$(cut -f 2 /tmp/said | tr -d ' ')"
same "and is told nothing" "" "$(cat /tmp/note)"
modprobe w1_therm
unshare -n busdump w1:netlink/w1_bus_master2 read </tmp/path >/tmp/said 2>/tmp/note
same "where netlink is refused, files serve" 70 "$(cut -f 2 /tmp/said | tr -d ' ')"
same "and it says why" "busdump: netlink refused: the connector is in another network namespace; \
served by files as target w1" "$(head -n 1 /tmp/note)"

owsd -c /rig/netlink.rio -t w1:netlink >/tmp/log/owsd 2>&1 &
owsd=$!
next_value
does "owsd reads over netlink" within $told_within reads warm $warm
does "but not a thermometer fed by the wire" within $told_within bad cold
owsctl set relays 5
does "an output switches its pins" within $told_within reads pins 184
echo 0x18 >$i2c/delete_device
does "a driver unbound from a chip makes its signals bad" within $told_within bad warm
does "not those of another chip" within $told_within reads other 12.5
echo ds2482 0x18 >$i2c/new_device
next_value
does "bound again, they are good" within $back_within reads warm $warm
within 30 rmmod ds2482
does "a module unloaded makes all bad" within $told_within bad other
modprobe ds2482
next_value
does "loaded again, they are good" within $back_within reads warm $warm
sim remove adapter
does "an adapter unplugged makes all bad" within $told_within bad other
within $told_within adapter_gone
sim end remove adapter
within $back_within test -d $i2c && bind
next_value
does "plugged in and bound again, they are good" within $back_within reads warm $warm
does "and the output is as commanded" within $back_within reads pins 184
does "owsd lives" kill -0 $owsd
kill $owsd
wait $owsd
same "and ends when it is told to" 0 $?
finish
