#!/bin/sh
# SPDX-License-Identifier: MIT
#
# In a guest that has booted with the packages: the service under its own systemd, with devices
# behind a real /dev/i2c-0.
exec </dev/null >/dev/ttyS1 2>&1
stty -F /dev/ttyS1 raw -echo
cd /root/test || exit 1
. ./lib.sh
export LC_ALL=C
finish() {
	[ $failed = 0 ] || journalctl -b -o short-monotonic --no-pager -n 80
	echo "@@RIG-EXIT $1"
	sleep 1 # the line leaves the console
	systemctl poweroff --force --force
}
trap 'finish 1' INT TERM
house() { systemctl show -P "$1" owsd@HOUSE; }
reads() { [ "$(owsctl -n HOUSE get "$1" 2>&1)" = "$2" ]; }
active() { systemctl -q is-active "$1"; }
refused() { ! "$@"; }
# restarted PID: another one serves
restarted() { now=$(house MainPID) && [ "$now" != 0 ] && [ "$now" != "$1" ] && active owsd@HOUSE; }
status_says() { systemctl status --no-pager -n 40 owsd@HOUSE | grep -q -F "$1"; }
got() { reads relays 5 && owsctl -n HOUSE get warm; }
# InitValue, for who commanded the output has ended
begins() { reads relays 0 && reads pins 189 && owsctl -n HOUSE get warm; }

does 'the default instance comes up by itself, without a device' within 60 active owsd@OWS
does 'and serves' within 10 owsctl list
does 'its exposure is below 2.0' systemd-analyze security --threshold=20 --no-pager owsd@OWS

# opens MAJOR: what runs beside owsd@OWS may open such a device, were there one
opens() {
	mknod /dev/owsd-test c "$1" 9
	sh -c 'echo $$ >"/sys/fs/cgroup$1/cgroup.procs" && : <>/dev/owsd-test' sh \
		"$(systemctl show -P ControlGroup owsd@OWS)" 2>/tmp/opens
	rm /dev/owsd-test
	cat /tmp/opens && grep -q 'No such device' /tmp/opens
}
does 'of a console it may open none' refused opens 29
for major in 89 166 188; do does "an adapter of major $major may come later" opens $major; done

# auto would take the chips that are to be another instance's
sed -i 's,"auto","localhost:4304",' /etc/owsd/OWS.rio
does 'it is sent elsewhere' systemctl restart owsd@OWS

modprobe vhci-hcd && modprobe i2c-tiny-usb && modprobe i2c-dev
./simchip house.sim >/tmp/simchip 2>&1 &
does 'an adapter comes' within 20 test -c /dev/i2c-0
does 'and belongs to its group' within 20 sh -c '[ "$(stat -c "%a %G" /dev/i2c-0)" = "660 i2c" ]'

sed 's,"localhost:4304","i2c:/dev/i2c-0",' daemon.rio >/etc/owsd/HOUSE.rio
does 'another instance is enabled' systemctl enable --now owsd@HOUSE
same 'it is ready when systemctl returns' active "$(house ActiveState)"
same 'it runs as its user' owsd "$(ps -o user= -p "$(house MainPID)" | tr -d ' ')"
same 'without a capability' 0000000000000000 \
	"$(sed -n 's/^CapBnd:[[:space:]]*//p' "/proc/$(house MainPID)/status")"
does 'through its sandbox it reads the chip' within 60 reads warm 21.0625
same 'who may look is a group, under its filter too' '640 owsd owsd' \
	"$(stat -c '%a %U %G' /run/owsd/HOUSE.image)"
same 'who may act is for owsd to decide' '666 owsd owsd' \
	"$(stat -c '%a %U %G' /run/owsd/HOUSE.control)"
# GROUP,... COMMAND...: as a user who is in these groups and nothing else
as_one_of() {
	# shellcheck disable=SC2046 # names of groups are words
	groups=$(getent group $(echo "$1" | tr , ' ') | cut -d: -f3 | paste -s -d,)
	shift
	setpriv --reuid=4711 --regid=4711 --groups="$groups" --bounding-set=-all --no-new-privs "$@"
}
does 'one of the group owsd reads' as_one_of owsd owsctl -n HOUSE get warm
does 'and does not set' refused as_one_of owsd owsctl -n HOUSE set relays 1
does 'somebody else reads nothing' refused as_one_of games owsctl -n HOUSE get warm
does 'one of owsd-control sets' as_one_of owsd,owsd-control owsctl -n HOUSE set relays 5
does 'an output' within 30 got
same 'it says what it does' 1 "$(systemctl status --no-pager owsd@HOUSE | grep -c 'Status: ".*signals')"

# Inputs that the board holds low, and those of the relays that are on
does 'and the chip has it' within 30 reads pins 184

pid=$(house MainPID)
for where in /dev/shm /run/owsd /var/lib/owsd; do
	does "in its sandbox no program of $where is run" nsenter -t "$pid" -m \
		sh -c "cp /bin/true $where/true && ! $where/true && rm $where/true"
done
same 'its directory is its own' '755 owsd owsd' "$(stat -c '%a %U %G' /run/owsd)"
does 'no other user makes a name there' refused as_one_of owsd,owsd-control touch /run/owsd/HOUSE.lock.new
cp /etc/owsd/HOUSE.rio good.rio
sed -e 's/^\( *ItemCount *\).*/\111/' -e '$d' good.rio >more.rio
cat >>more.rio <<'END'
  Item {
    Name                    "shed"
    Path                    "/28.A0B1C2040028/temperature"
    Type                    "double"
    IO                      "input"
  }
}
END
cp more.rio /etc/owsd/HOUSE.rio
does 'a changed file is loaded' systemctl reload owsd@HOUSE
does 'the signal that is new is read' within 60 reads shed 12.5
same 'by the same process' "$pid" "$(house MainPID)"
does 'an old one goes on' reads warm 21.0625
does 'the output too' reads relays 5
does 'on the chip as well' reads pins 184
does 'and can be set' owsctl -n HOUSE set -w 30 relays 4
does 'which the chip does' within 30 reads pins 185
does 'and back' owsctl -n HOUSE set -w 30 relays 5
same 'systemctl says how many there are now' 1 \
	"$(systemctl status --no-pager owsd@HOUSE | grep -c 'Status: "11 signals')"

echo 'OwsDrv { Period wrong }' >/etc/owsd/HOUSE.rio
does 'told to load a broken file, systemctl fails' refused timeout 40 systemctl reload owsd@HOUSE
does 'its status says that it was refused' within 20 status_says 'is refused: all goes on as before'
does 'in the status line too, and where it is broken' \
	status_says 'Status: "reload refused, all goes on as before: /etc/owsd/HOUSE.rio:1:17'
same 'the same process goes on' "$pid" "$(house MainPID)"
same 'as a service that is active' active "$(house ActiveState)"
does 'with the old ones' reads warm 21.0625
does 'and the one that was new' reads shed 12.5
cp good.rio /etc/owsd/HOUSE.rio
does 'all are told to load theirs, one mended and without the new one' systemctl reload owsd
does 'it has' within 20 status_says 'Status: "10 signals'
same 'in the same process' "$pid" "$(house MainPID)"
does 'with the output as it was' reads relays 5

kill -9 "$pid"
does 'killed, it is started again' within 30 restarted "$pid"
does 'with InitValue' within 60 begins

pid=$(house MainPID)
kill -STOP "$pid"
does 'stopped, the watchdog ends it and it is started again' within 60 restarted "$pid"
does 'with InitValue' within 60 begins

pid=$(house MainPID)
python3 ./stop-thread "$pid" owsd-engine >/tmp/stopped 2>&1 &
does "with only the engine's thread stopped, the same" within 60 restarted "$pid"
does 'a thread was stopped' sh -c 'cat /tmp/stopped && grep -q ^stopped /tmp/stopped'
does 'by the watchdog' sh -c 'journalctl -b -u owsd@HOUSE | grep -c "Watchdog timeout" | grep -qx 2'
does 'with InitValue' within 60 begins

pid=$(house MainPID)
other=$(systemctl show -P MainPID owsd@OWS)
does 'an upgrade while both run' dpkg -i next/owsd_*.deb
does 'restarts the one' within 30 restarted "$pid"
does 'and the other' within 30 sh -c "[ \$(systemctl show -P MainPID owsd@OWS) != $other ] && systemctl -q is-active owsd@OWS"
does 'with InitValue' within 60 begins

echo 'OwsDrv { Timeout wrong }' >/etc/owsd/HOUSE.rio
does 'a broken configuration fails' refused systemctl restart owsd@HOUSE
does 'and is told' sh -c 'journalctl -b -u owsd@HOUSE | grep -q /etc/owsd/HOUSE.rio:1:18'
cp good.rio /etc/owsd/HOUSE.rio
does 'mended, it comes up by itself' within 30 active owsd@HOUSE
does 'with InitValue' within 60 begins

for drop_in in *.conf; do
	install -D -m 644 "$drop_in" "/etc/systemd/system/owsd@HOUSE.service.d/$drop_in"
	systemctl daemon-reload
	does "with $drop_in it starts" systemctl restart owsd@HOUSE
	does 'and reads' within 60 begins
	rm -r /etc/systemd/system/owsd@HOUSE.service.d
done
systemctl daemon-reload
does 'without them too' systemctl restart owsd@HOUSE

does 'all are stopped as one' systemctl stop owsd
does 'the one' refused active owsd@HOUSE
does 'and the other' refused active owsd@OWS
does 'and started' systemctl start owsd
does 'both' within 20 systemctl -q is-active owsd@HOUSE owsd@OWS
does 'the package is removed' dpkg -r owsd
does 'nothing runs' refused pgrep -x owsd
does 'installed again, it comes up' dpkg -i next/owsd_*.deb
does 'both of it' within 30 systemctl -q is-active owsd@HOUSE owsd@OWS
does 'with InitValue' within 60 begins
does 'removed again' dpkg -r owsd
does 'nothing runs' refused pgrep -x owsd
does 'and purged' dpkg -P owsd
same 'no segment stays' '' "$(find /run/owsd /var/lib/owsd 2>/dev/null)"
same 'nor what enabled it' '' "$(find /etc/systemd -name '*owsd*')"
finish 0
