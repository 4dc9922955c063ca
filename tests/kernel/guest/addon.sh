# SPDX-License-Identifier: MIT
# The add-on of Home Assistant under its AppArmor profile: in a root and namespaces of its own, as
# Docker makes them, it does all that it is for, and nothing is denied; what others would make of it is.
. /rig/lib.sh
. /rig/w1lib.sh
. /rig/usblib.sh

there=/tmp/addon
self=local_owsd # as Supervisor calls it
docker=-all,+chown,+dac_override,+fsetid,+fowner,+mknod,+net_raw,+setgid,+setuid,+setfcap,+setpcap
docker=$docker,+net_bind_service,+sys_chroot,+kill,+audit_write
patience=300

container() {
	cd $there/root
	hostname local-owsd
	mount -t proc proc proc
	mount -o bind /sys sys
	mount -o remount,bind,ro sys
	mount -t tmpfs -o mode=755 tmpfs run
	mount -t tmpfs -o mode=755 tmpfs dev
	mkdir -p dev/shm dev/bus/usb
	mount -t tmpfs tmpfs dev/shm
	mount -o bind /dev/bus/usb dev/bus/usb
	for node in null:1:3 zero:1:5 full:1:7 random:1:8 urandom:1:9; do
		mknod -m 666 dev/${node%%:*} c $(echo ${node#*:} | tr : ' ')
	done
	# The adapter, a serial port and a GPIO chip behind which is nothing
	mknod -m 600 dev/i2c-0 c 89 0
	mknod -m 600 dev/ttyUSB0 c 4 66
	mknod -m 600 dev/gpiochip0 c 254 0
	mount -o bind $there/config etc/owsd
	mount -o bind $there/data data
	mount -o move . /
	exec chroot . /usr/bin/setpriv --bounding-set $docker /bin/sh -c "exec </dev/null &&
		echo 'exec $self' >/proc/self/attr/apparmor/exec && exec /usr/sbin/docker-init -c 'exec owsd-addon'"
}

# A pipe takes what it says: a file elsewhere would be denied
start() {
	rm -f /tmp/outer /tmp/ended
	{
		SUPERVISOR_TOKEN=f00d PATH=/usr/local/sbin:/usr/sbin:/usr/bin:/bin \
			/bin/unshare -m -u -p -f /bin/sh /rig/addon.sh container &
		echo $! >/tmp/outer
		wait $!
		echo $? >/tmp/ended
	} 2>&1 | cat >>/tmp/log/addon &
	within 60 first_process
}

first_process() {
	addon=$(awk -v parent="$(cat /tmp/outer)" '$4 == parent { print $1 }' /proc/[0-9]*/stat)
	[ -n "$addon" ]
}

# NAME
ends() {
	kill $addon
	within $patience test -s /tmp/ended
	same "$1" 0 "$(cat /tmp/ended)"
}

# PROFILE CAPABILITIES COMMAND...: in the container, as root with these; "": with all
enter() {
	local profile=$1 drop="${2:+/usr/bin/setpriv --bounding-set $2}"
	shift 2
	cat | {
		PATH=/usr/local/sbin:/usr/sbin:/usr/bin:/bin /bin/nsenter -t $addon -m -u -p -r $drop /bin/sh -c \
			'echo "exec $0" >/proc/self/attr/apparmor/exec && exec "$@"' $profile "$@"
		echo $? >/tmp/status
	} 2>&1 | cat
	return $(cat /tmp/status)
}

# As docker exec does, by a shell: what root starts by itself is in no other profile than the shell
inside() {
	enter $self $docker /bin/sh -c 'exec "$@"' sh "$@"
}

# SIGNAL VALUE
reads() {
	[ "$(inside owsctl get $1)" = "$2" ]
}

# SIGNAL
fails() {
	! inside owsctl get $1
}

says() {
	grep -q "$1" /tmp/log/addon
}

# STATE: as in /proc
recorder_is() {
	cat /proc/[0-9]*/stat | grep -q "(owsd-recorder) $1"
}

# PATH [OPTION...]: of the page, as ingress asks for it
page() {
	local path=$1
	shift
	curl -sf -m 120 --interface 172.30.32.2 -H 'X-Remote-User-Name: anna' -H 'X-Remote-User-Id: 0123' \
		-H 'Origin: http://house.example:8123' -H 'Host: house.example:8123' -H 'X-Owsd: 1' \
		-H 'Content-Type: application/json' "$@" http://127.0.0.1:8099/api/$path
}

page_has() {
	page $1 | grep -q "$2"
}

# FILTER PATH: what the page takes, made of what it gave, to that path
send_back() {
	page config | inside jq -c "$1" >$there/order && page $2 -d @$there/order
}

published() {
	mosquitto_sub -h 127.0.0.1 -W 5 -C 1 -t owsd/homeassistant/$1 | grep -q "$2"
}

denied() {
	dmesg | grep 'apparmor="DENIED"'
}

# The name of each process, and its profile
confined() {
	for process in /proc/[0-9]*; do
		[ "$(readlink $process/ns/pid)" = "$(readlink /proc/$addon/ns/pid)" ] &&
			label=$(cat $process/attr/apparmor/current 2>/dev/null) && echo "$(cat $process/comm) $label"
	done
}

# NAME PROFILE COMMAND...: somebody with all capabilities fails, and because of the profile
refused() {
	local what=$1 profile=$2 before="$(denied | wc -l)"
	shift 2
	if enter $profile '' "$@" >/tmp/said; then
		not_ok "$what" "it was done"
	else
		does "$what" test "$(denied | wc -l)" -gt $before
	fi
}

if [ "${1:-}" = container ]; then
	container
fi

# --- What Docker and Supervisor do ----------------------------------------------------------------
mount -t securityfs securityfs /sys/kernel/security
echo 0 >/proc/sys/kernel/printk_ratelimit
sed "s/^profile owsd /profile $self /" /rig/apparmor.txt >/tmp/profile
does "the profile is loaded as hosts do it" apparmor_parser -r -K /tmp/profile
does "and so that all is mediated that this kernel can" apparmor_parser -r -K \
	--override-policy-abi /sys/kernel/security/apparmor/features /tmp/profile
same "as two that are enforced" 2 "$(grep -c "^$self.*(enforce)" /sys/kernel/security/apparmor/profiles)"

modprobe overlay
mkdir -p $there/installed $there/upper $there/work $there/root $there/config $there/data
tar xf /rig/addon.tar -C $there/installed && rm /rig/addon.tar
mount -t overlay -o lowerdir=$there/installed,upperdir=$there/upper,workdir=$there/work overlay $there/root
ip addr add 172.30.32.2/32 dev lo
mkdir -p /tmp/supervisor/services
echo '{"result": "ok", "data": {"host": "core-mosquitto", "port": 1883, "ssl": false,
	"username": "addons", "password": "secret"}}' >/tmp/supervisor/services/mqtt
httpd -p 127.0.0.1:80 -h /tmp/supervisor
printf '%s\n' 'listener 1883 127.0.0.1' 'allow_anonymous true' 'user root' >/tmp/mosquitto.conf
mosquitto -c /tmp/mosquitto.conf >/tmp/log/mosquitto 2>&1 &

# --- What it is for -------------------------------------------------------------------------------
plug addon.sim
start
does "it finds what is there" within $patience says "signals of what was found"
does "a thermometer has its value" within $patience reads temperature1 21.5
same "all of it is confined" "" "$(confined | grep -v "^[^ ]* $self.*(enforce)$")"
same "and what is not the script more so" "" "$(confined | grep '^owsd' | grep -v '^owsd-addon' | grep -v //programs)"
confined | sort -u | sed 's/^/# /'
does "the container is healthy" inside sh -c 'owsctl instances | grep -q running'
does "MQTT has the value" within $patience published temperature1 '"v":21.5'
name=$(page signals | inside jq -r '.signals[] | select(.path | endswith("PIO.0")).name')
mosquitto_pub -h 127.0.0.1 -t owsd/homeassistant/$name/set -m on
does "MQTT moves an output" within $patience reads $name 1
does "the page has the signals" page_has signals temperature1
does "and what is on the wires" within $patience page_has devices 28.A0B1C2000028
does "it checks a configuration" send_back '{text, do: "check"}' config/draft
does "and saves one" send_back '{text: (.text + "# saved\n"), base: .tag}' config/save
does "which is there" grep -q '^# saved' $there/config/OWS.rio
does "the served protocol has the value" sh -c \
	'echo /28.A0B1C2000028/temperature | owdump 4304 read | grep -q 21.5'
does "history is kept" within $patience test -s $there/data/owsd-recorder/OWS/history.sqlite
inside owsd-addon hold
does "it holds still for a backup" within 60 recorder_is T
inside owsd-addon go
does "and goes on" within 60 recorder_is S
if inside owsctl -t i2c:/dev/i2c-0 dir / >/tmp/reason 2>&1; then
	not_ok "another program is refused" "it was not"
else
	does "another program is refused, and told who has the adapter" grep owsd /tmp/reason
fi
for target in serial:/dev/ttyUSB0 uart:/dev/ttyUSB0 serial: usb: w1:netlink gpio:/dev/gpiochip0:4; do
	inside owsctl -t $target dir / 2>&1 | sed "s|^|# $target: |"
done
inside owsctl doctor 2>&1 | sed 's/^/# /'
inside sh -c 'kill -9 $(sed -n 1p /run/owsd-web.pid)'
does "what dies is started again" within $patience says "owsd-web has ended with status 137"
does "and the page is back" within $patience page_has signals temperature1
sim remove adapter
does "without an adapter there is no value" within $patience fails temperature1
sim end remove adapter
sim set warm temperature 22.5
does "an adapter comes back" within $patience reads temperature1 22.5
ends "it ends when it is told to"
unplug

plug_usb
usb=$!
start
does "a DS9490R is taken" within $patience reads temperature1 21.0625
ends "and given back"
kill $usb
within 60 no_adapter

plug addon.sim
load_drivers
bind 0x18
does "the kernel finds the chips" within 150 all_found 2
start
does "its files are read where it has the adapter" within $patience reads temperature1 21.5
denied | sed 's/.*apparmor=/# /; s/ pid=[0-9]*//' | sort | uniq -c | head -n 40
same "and in all that nothing was denied" 0 "$(denied | wc -l)"

# --- What it is not for ---------------------------------------------------------------------------
# As if a program were taken over: one that both profiles may start is busybox, and may do all
cp /bin/busybox $there/root/usr/bin/cp
mkdir $there/root/usr/bin/as
for name in cat chroot cp env insmod mknod mount ping; do
	ln -s ../cp $there/root/usr/bin/as/$name
done
cp /bin/busybox $there/data/owsd-web/own
page=$(inside sed -n 1p /run/owsd-web.pid)
for profile in $self $self//programs; do
	refused "$profile writes no file of the image" $profile /usr/bin/as/cp /etc/passwd /etc/group
	refused "$profile makes no program of another" $profile /usr/bin/as/cp /etc/passwd /usr/local/sbin/owsd-addon
	refused "$profile starts nothing of its own" $profile /usr/bin/as/env /data/owsd-web/own true
	refused "$profile reads no memory of others" $profile /usr/bin/as/cat /proc/$page/mem
	refused "$profile reads no environment" $profile /usr/bin/as/cat /proc/1/environ
	refused "$profile sets nothing of the kernel" $profile /usr/bin/as/cp /etc/passwd /proc/sys/kernel/core_pattern
	refused "$profile mounts nothing" $profile /usr/bin/as/mount -t tmpfs tmpfs /tmp
	refused "$profile loads no module" $profile /usr/bin/as/insmod /etc/passwd
	refused "$profile makes no device" $profile /usr/bin/as/mknod /data/owsd-web/mem c 1 1
	refused "$profile leaves no root" $profile /usr/bin/as/chroot /tmp /bin/sh
	refused "$profile has no raw sockets" $profile /usr/bin/as/ping -c 1 127.0.0.1
done
refused "the script has no adapter" $self /usr/bin/as/cp /dev/i2c-0 /dev/null
refused "programs have no shell" $self//programs /usr/bin/as/env /bin/sh -c true
refused "nor anything else of the image" $self//programs /usr/bin/as/env /usr/bin/curl http://supervisor
finish
