#!/bin/sh
# SPDX-License-Identifier: MIT
# owsd and all programs beside it in real time, for as many minutes as the file /rig/endurance says,
# with faults of everything; at the end nothing of them is there but what they keep.
. /rig/lib.sh

read -r minutes seed </rig/endurance
cp /rig/endurance.rio /tmp/a.rio
# The other table: slower, and with a signal more
sed -e '$d' -e 's/^  Period .*/  Period 0.2/' -e '/ItemCount/d' /tmp/a.rio >/tmp/b.rio
cat >>/tmp/b.rio <<-END
	  Item {
	    Name "more"
	    Path "/28.A0B1C2000028/type"
	    Type "string"
	    IO "input"
	  }
	}
END
printf '%s\n' 'listener 1883 127.0.0.1' 'allow_anonymous true' 'user root' >/tmp/broker.conf
# What takes the lines of owsd-influx, and the messages of owsd-notify
mkdir -p /tmp/page /tmp/history /tmp/taker/cgi-bin
cat >/tmp/taker/cgi-bin/write <<-'END'
	#!/bin/sh
	line="$(grep signal=air | tail -n 1)"
	[ -z "$line" ] || echo "$line" >/tmp/line
	printf 'Status: 204 No Content\r\n\r\n'
END
cat >/tmp/tell <<-'END'
	#!/bin/sh
	echo "$2" | grep '^pins' >>/tmp/told
END
chmod 755 /tmp/tell /tmp/taker/cgi-bin/write
plug endurance.sim

processes() {
	cat /proc/[0-9]*/comm 2>/dev/null | grep -e owsd -e owsctl -e mosquitto -e curl -e mbpoll -e httpd
}

listens() {
	netstat -lnt | grep :
	netstat -lnx | grep -e owsd -e OWS
}

files() {
	find /run /dev/shm /var /root /.local /tmp ! -type d 2>/dev/null |
		grep -v -e ^/tmp/log/ -e ^/tmp/taker/ | sort
}

before="$(files)"
kept="/run/owsd/OWS.force
/run/owsd/OWS.image
/run/owsd/OWS.lock
/tmp/history/history.sqlite
/tmp/history/history.sqlite-shm
/tmp/history/history.sqlite-wal
/tmp/history/lock
/tmp/line
/tmp/present.rio
/tmp/told
/tmp/told.taken
/var/lib/owsd-influx/OWS/reached
/var/lib/owsd-modbus/OWS/lock
/var/lib/owsd-modbus/OWS/map
/var/lib/owsd-notify/OWS/lock
/var/lib/owsd-notify/OWS/told"
# shellcheck disable=SC2034 # lib.sh looks at it
endurance "$minutes" "$seed" || failed=1
owsctl stats | sed 's/^/# /'
echo "# the log has $(wc -l </tmp/log/owsd) lines in $(wc -c </tmp/log/owsd) bytes"
same "no process is left" "" "$(processes)"
same "no socket is left" "" "$(listens)"
same "no file is left but those that they keep" "" "$(files | grep -vxF -e "$before" -e "$kept")"
finish
