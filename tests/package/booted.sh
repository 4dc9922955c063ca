#!/bin/sh
# SPDX-License-Identifier: MIT
#
# In a Debian that its own systemd has booted: all packages with all their units enabled through
# reloads, upgrade, reboot, removal, reinstallation and purge, and then each package alone. Is run at each
# boot: the second goes on after the reboot.
exec >>/root/test/lines 2>&1
cd /root/test || exit 1
. ./lib.sh
export DEBIAN_FRONTEND=noninteractive LC_ALL=C
packages=$(for p in owsd*_*.deb; do echo "${p%%_*}"; done)

# units PACKAGE: what is enabled of it. HOUSE is a second instance
units() {
	case $1 in
	owsd-web) echo owsd-web@OWS.socket owsd-web@OWS.service owsd-writer@OWS.socket ;;
	*) echo "$1@OWS.service $1@HOUSE.service" ;;
	esac
}
# What runs of owsd: pid, program; "(deleted)" after it if it is an old one
programs() {
	for d in /proc/[0-9]*; do
		exe=$(readlink "$d/exe") && case $exe in /usr/sbin/owsd*) echo "${d#/proc/} $exe" ;; esac
	done
}
# listening: the sockets of owsd at which somebody could ask
listening() {
	ss -H -l -x | grep -o '/run/owsd/[^ ]*' | sort
	ss -H -l -t -n | grep -o '127.0.0.1:8080' | sort
}
links() { find /etc/systemd/system -name '*owsd*' | sort; }
pid_of() { systemctl show -P MainPID "$1"; }
pids() { for u in $1; do echo "$u $(pid_of "$u")"; done; }
# serving UNIT: active, and a service runs the program that is on the disk
serving() {
	systemctl -q is-active "$1" || return 1
	case $1 in
	*.service) case $(readlink "/proc/$(pid_of "$1")/exe") in /usr/sbin/owsd*' (deleted)' | '') return 1 ;; esac ;;
	esac
}
all_serving() { for u in $1; do serving "$u" || return 1; done; }
# asks PATH: somebody answers there
asks() {
	python3 -c 'import socket, sys
s = socket.socket(socket.AF_UNIX); s.settimeout(20); s.connect(sys.argv[1])
s.sendall(b"GET /api/signals HTTP/1.1\r\nHost: localhost\r\n\r\n")
sys.exit(not s.recv(1))' "$1"
}
writer_comes() {
	python3 -c 'import socket; s = socket.socket(socket.AF_UNIX); s.connect("/run/owsd/OWS.config")' &&
		within 20 serving owsd-writer@OWS.service
}
# broker TEXT: a client sends it first
broker() {
	python3 -c 'import socket, sys
s = socket.create_server(("127.0.0.1", 1883))
s.settimeout(40)
while sys.argv[1].encode() not in s.accept()[0].recv(4096):
    pass' "$1"
}
# secrets: the password in /etc/credstore reaches the broker, and no user of owsd can plant another
secrets() {
	install -d -m 700 /etc/credstore
	install -m 600 /dev/null /etc/credstore/owsd-mqtt.mqtt-password
	echo "the password" >/etc/credstore/owsd-mqtt.mqtt-password
	sed -i 's,^}$,  Mqtt {\n    Broker "mqtt://127.0.0.1"\n    User "pi"\n    PasswordFile "mqtt-password"\n  }\n},' /etc/owsd/OWS.rio
	broker 'the password' &
	broker=$!
	systemctl restart owsd-mqtt@OWS.service
	does 'the service hands the password over' wait $broker
	for user in $packages owsd-writer; do
		does "$user makes no file among the secrets" sh -c "! setpriv --reuid $user --regid owsd \
			--init-groups ln -s /etc/shadow /etc/credstore/owsd-mqtt.$user && ! setpriv --reuid $user \
			--regid owsd --init-groups cat /etc/credstore/owsd-mqtt.mqtt-password"
	done
	cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
	rm /etc/credstore/owsd-mqtt.mqtt-password
	systemctl restart owsd-mqtt@OWS.service
}
# reloads: no unit says yes to a broken file and does nothing; each takes over a good one
reloads() {
	services=$(for p in $packages; do echo "$p@OWS"; done)
	before=$(pids "$services")
	echo 'OwsDrv { Period wrong }' >/etc/owsd/OWS.rio
	for s in $services; do
		does "$s refuses a broken file" sh -c "! timeout 40 systemctl reload $s"
		does "$s goes on" systemctl -q is-active "$s"
	done
	does 'the status of owsd says so' sh -c "systemctl status --no-pager owsd@OWS | \
		grep -q 'Status: \"reload refused, all goes on as before: /etc/owsd/OWS.rio:1:'"
	does 'and list' sh -c "owsctl list 2>&1 | grep -q 'OWS.rio:1:'"
	sed 's,127.0.0.1:8080,127.0.0.1:8081,' /etc/owsd/HOUSE.rio >/etc/owsd/OWS.rio
	for s in $services; do does "$s takes a good file" timeout 40 systemctl reload "$s"; done
	does 'the page listens where Listen says now' within 20 sh -c 'ss -H -l -t -n | grep -q 127.0.0.1:8081'
	does 'and there alone' within 20 sh -c '! ss -H -l -t -n | grep -q 127.0.0.1:8080'
	does 'list has nothing more to say of it' sh -c "! owsctl list 2>&1 | grep -q 'OWS.rio:1:'"
	cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
	for s in $services; do does "$s takes the first file" timeout 40 systemctl reload "$s"; done
	same 'the same processes run' "$before" "$(pids "$services")"
}
# switches: owsctl enable and disable do it, for each face and under the name that people have for one;
# the writer comes and goes with the page, which asks it
switches() {
	for face in web mqtt influx history notify modbus; do
		unit=$(case $face in history) echo owsd-recorder ;; *) echo "owsd-$face" ;; esac)
		own=$(units "$unit" | tr ' ' '\n' | grep @OWS | xargs)
		does "owsctl disable $face" owsctl disable $face
		does "$face is off" sh -c "! systemctl -q is-active $own && ! systemctl -q is-enabled $own"
		does "$face of another instance goes on" all_serving "$(units "$unit" | tr ' ' '\n' | grep HOUSE)"
		does "owsctl enable $face" owsctl enable $face
		does "$face runs" within 20 all_serving "$own"
	done
	same 'enable says where the page is' 'page: http://127.0.0.1:8080/ /run/owsd/OWS.web' "$(owsctl enable web | grep page:)"
}
# remedy FAULT COMMAND: it is the first thing that doctor says, and what it says mends
remedy() {
	same "doctor: $1" "1. sudo $2" "$(owsctl doctor | head -n 1)"
	does "doctor: $1: the command is done" sh -c "$2"
}
doctors() {
	# a file without signals would be the first thing to do
	sed 's,^}$,  Item {\n    Name "room"\n    Path "/28.A0B1C2000001/temperature"\n    Type "double"\n    IO "input"\n  }\n},' \
		/etc/owsd/HOUSE.rio >/etc/owsd/room.rio
	cp /etc/owsd/room.rio /etc/owsd/OWS.rio
	systemctl reload owsd@OWS
	for unit in owsd-modbus@OWS.service owsd@OWS.service; do
		systemctl stop $unit
		remedy "$unit was stopped" "systemctl start $unit"
		does "$unit runs" within 20 serving $unit
	done
	# that moves no output, while owsd may have been stopped so that none moves
	systemctl stop owsd-modbus@OWS owsd@OWS
	does 'doctor --fix runs' sh -c 'owsctl doctor --fix; true'
	does 'doctor --fix has started owsd-modbus' within 20 serving owsd-modbus@OWS.service
	does 'and not owsd' sh -c '! systemctl -q is-active owsd@OWS'
	systemctl start owsd@OWS
	echo 'OwsDrv { Period wrong }' >/etc/owsd/OWS.rio
	systemctl reload owsd@OWS
	does 'doctor: a refused reload comes first, with file and line' sh -c "owsctl doctor | head -n 3 | grep -q OWS.rio:1:"
	mv /etc/owsd/room.rio /etc/owsd/OWS.rio
	systemctl reload owsd@OWS
	does 'doctor: after a good one nothing of it' sh -c '! owsctl doctor | grep -q OWS.rio:1:'
	cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
	systemctl reload owsd@OWS
}
# pages: what they say to the service manager and of groups can be done as it stands there
pages() {
	groupadd -f i2c
	for user in pi plc anna; do useradd -m "$user"; done
	export USER=pi
	while read -r page command; do
		systemctl reset-failed
		systemctl start owsd@OWS
		does "$page: $command" sh -c "timeout 40 $command"
	done <page-commands
	systemctl restart owsd
}
enable_units() {
	# shellcheck disable=SC2046 # units are words
	systemctl enable --now $(units "$1")
}
# takes WHAT PACKAGE...: their units run, as they are on the disk
takes() {
	what=$1
	shift
	for t; do
		for u in $(units "$t"); do
			does "$what: $u runs as it is on the disk" within 20 serving "$u"
			within 0 serving "$u" || systemctl status --no-pager -n 20 "$u"
		done
		case $t in owsd-web)
			does "$what: the page answers at its socket" asks /run/owsd/OWS.web
			does "$what: it listens where Listen says" within 20 sh -c 'ss -H -l -t -n | grep -q 127.0.0.1:8080'
			does "$what: the writer comes when somebody connects" writer_comes
			;;
		esac
	done
	same "$what: no old program runs" '' "$(programs | grep deleted)"
}
# gone WHAT PACKAGE...: nothing of them runs or listens
gone() {
	what=$1
	shift
	for g; do
		for u in $(units "$g"); do
			does "$what: $u is not active" sh -c "! systemctl -q is-active $u"
		done
		same "$what: no program of $g runs" '' "$(programs | grep -E "/$g( |\$)")"
		case $g in owsd-web)
			same "$what: no writer runs" '' "$(programs | grep /owsd-writer)"
			same "$what: nothing listens" '' "$(listening | grep -E '\.web$|\.config$|8080')"
			;;
		esac
	done
}
finish() {
	[ $failed = 0 ] || journalctl -b -o short-monotonic --no-pager -n 60
	echo '# the end'
	systemctl poweroff
	exit 0
}

[ -e rebooted ] || [ ! -d was ] || . ./upgraded.sh

if [ -e rebooted ]; then
	takes 'after a reboot' $packages
else
	does 'all are installed' dpkg -i ./*.deb
	cat >/etc/owsd/HOUSE.rio <<'RIO'
OwsDrv {
  TargetName "localhost:4304"
  Web {
    Listen "127.0.0.1:8080"
    Configure on
  }
  Influx {
    Url "http://127.0.0.1:8428/write"
  }
}
RIO
	cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
	cp /etc/owsd/HOUSE.rio /etc/owsd/THIRD.rio
	systemctl restart owsd
	same 'no door is open before it is asked for' '' "$(listening | grep -E '\.web$|\.config$|8080')"
	for p in $packages; do does "all of $p is enabled" enable_units "$p"; done
	takes 'as installed' $packages
	[ $failed = 0 ] || finish
	reloads
	secrets
	switches
	doctors

	for p in $packages; do
		newer ./"$p"_*.deb 8.0 next
		others=$(pids "$(for o in $packages; do [ "$o" = "$p" ] || units "$o"; done | grep -v socket)")
		does "an upgrade of $p alone" dpkg -i next/"$p"_8.0_*.deb
		takes "upgraded $p" $packages
		same "the others ran on" "$others" "$(pids "$(echo "$others" | cut -d ' ' -f 1)")"
		newer ./"$p"_*.deb 9.0 next
	done
	does "one is started by hand" systemctl start owsd-mqtt@THIRD.service
	systemctl disable --now owsd-influx@HOUSE.service 2>/dev/null
	does 'an upgrade of all' dpkg -i next/*_9.0_*.deb
	does 'one that was started by hand runs as it is on the disk' within 20 serving owsd-mqtt@THIRD.service
	does 'one that was disabled stays off' sh -c '! systemctl -q is-active owsd-influx@HOUSE'
	systemctl stop owsd-mqtt@THIRD.service
	systemctl enable --now owsd-influx@HOUSE.service
	takes 'all upgraded' $packages
	pages
	takes 'as the pages say' $packages
	touch rebooted
	systemctl reboot
	exit 0
fi

for p in $packages; do
	does "$p is removed" dpkg -r "$p"
	gone "$p removed" "$p"
	for o in $packages; do
		[ "$o" = "$p" ] || does "$p removed: $o goes on" all_serving "$(units "$o")"
	done
	does "$p is installed again" dpkg -i next/"$p"_9.0_*.deb
	takes "$p again" "$p"
done
does 'owsd alone is purged' dpkg -P owsd
cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
does 'and installed again' dpkg -i next/owsd_9.0_*.deb
does 'all of it is enabled' enable_units owsd
does 'the page answers at its socket' asks /run/owsd/OWS.web
does 'the writer comes when somebody connects' writer_comes
does 'all are removed' dpkg -r $packages
gone 'all removed' $packages
same 'all removed: nothing listens' '' "$(listening)"
same 'all removed: nothing runs' '' "$(programs)"
same 'all removed: systemd misses nothing' '' "$(systemctl list-units --no-legend --plain --failed 'owsd*')"
does 'all are installed again' dpkg -i next/*_9.0_*.deb
takes 'all again' $packages
# What is on the machine without them
does 'all are purged' dpkg -P $packages
gone 'all purged' $packages
same 'all purged: nothing listens' '' "$(listening)"
same 'all purged: nothing runs' '' "$(programs)"
same 'all purged: nothing is enabled' '' "$(links)"
same 'all purged: nothing is left of a unit' '' "$(systemctl list-units --all --no-legend --plain 'owsd*')"

for p in $packages; do
	cp /etc/owsd/HOUSE.rio /etc/owsd/OWS.rio
	does "$p alone is installed" dpkg -i ./"$p"_*.deb
	does "$p alone: all of it is enabled" enable_units "$p"
	for u in $(units "$p"); do does "$p alone: $u runs" within 20 serving "$u"; done
	does "$p alone is upgraded" dpkg -i next/"$p"_9.0_*.deb
	for u in $(units "$p"); do does "$p alone, upgraded: $u runs as it is on the disk" within 20 serving "$u"; done
	does "$p alone is removed" dpkg -r "$p"
	gone "$p alone, removed" "$p"
	does "$p alone is purged" dpkg -P "$p"
	same "$p alone, purged: nothing runs" '' "$(programs)"
	same "$p alone, purged: nothing listens" '' "$(listening)"
	same "$p alone, purged: nothing is enabled" '' "$(links)"
done
finish
