# SPDX-License-Identifier: MIT
# What the scripts share besides tests/package/lib.sh: the port to the rig, and looks at the service.
exec </dev/null >/dev/ttyS0 2>&1
stty -F /dev/ttyS0 raw -echo
cd /run/rig || exit 1
export LC_ALL=C PATH=/run/rig/bin:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin
. ./lib.sh

file=/etc/owsd/OWS.rio
patience=400 # at most; a busy host is slow
start=400
done=/var/lib/owsd/firstboot.done
packaged=/usr/share/owsd/OWS.rio

logs() {
	[ $failed = 0 ] && return
	systemctl --no-pager --failed
	journalctl -b -o short-monotonic --no-pager -n 80 -u 'owsd*' -u simchip
}
finish() {
	logs
	echo "@@RIG-EXIT $failed"
	sleep 1 # the line leaves the console
	systemctl poweroff --force --force
}
# Nothing is written out before
cut() {
	logs
	[ $failed = 0 ] || finish
	echo '@@RIG-CUT'
	sleep 600 # until the power is cut
}
restart() {
	logs
	[ $failed = 0 ] || finish
	trap - INT TERM
	echo '@@RIG-RESTART'
	systemctl reboot
	sleep 600 # until the power is cut
}
trap 'failed=1; finish' INT TERM

active() { systemctl -q is-active "$1"; }
refused() { ! "$@"; }
# log UNIT TEXT: it has said so since it was started last
log() { journalctl -b _SYSTEMD_INVOCATION_ID="$(systemctl show -P InvocationID "$1")" | grep -q -F -- "$2"; }
# said UNIT TEXT: at any time since the start
said() { journalctl -b -u "$1" | grep -q -F -- "$2"; }
signals() { owsctl list | wc -l; }
uptime() { cut_at=$(cat /proc/uptime) && echo "${cut_at%% *}"; }

# NAME: until the signal is good; the figure that is wanted
first_value() {
	does "the first value is there" within $start owsctl get "$1"
	echo "# figure: $2: first value of $1 $(uptime) s after the kernel's start, the service was started at" \
		"$(systemctl show -P ExecMainStartTimestampMonotonic owsd@OWS | sed 's/.....$//; s/.$/.&/') s"
}
