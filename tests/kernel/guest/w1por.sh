# SPDX-License-Identifier: MIT
# A restart of a DS2408 behind the kernel's w1_ds2408, which cannot write set_alarm: por stays set, and
# that is one restart.
. /rig/lib.sh
. /rig/w1lib.sh

within_s=100

reads() {
	[ "$(owsctl get $1 2>/dev/null)" = "$2" ]
}

said() {
	grep -q "$1" /tmp/log/owsd
}

lines() {
	grep -c "$1" /tmp/log/owsd
}

# por entries of the journal
restarts() {
	owsctl --json alarms history | tr '}' '\n' | grep -c '"alarm":"power-on reset"'
}

# of outputs: relays is the only one
writes() {
	owsctl stats | sed -n 's/^ *\([0-9]*\)  writes of w1$/\1/p'
}

plug w1.sim
load_drivers
bind 0x18
does "the kernel finds every part" within 150 all_found 4
search_no_more

owsd -v -c /rig/w1por.rio >/tmp/log/owsd 2>&1 &
owsd=$!
does "the output has its InitValue" within $within_s reads relays 5
does "the restart before owsd's start is seen" within $within_s said "the device has restarted"
does "its alarm cannot be armed, and the log says why" within $within_s \
	said "the alarm cannot be armed: SetAlarm: set_alarm cannot be written: "
sed 's/^/# /' /tmp/log/owsd
does "the chip has the InitValue" within $within_s reads pins 248
sleep 10 # no second one comes
same "it is one restart in the log" 1 "$(lines 'the device has restarted')"
same "and in the journal" 1 "$(restarts)"
same "its reason is logged once" 1 "$(lines 'cannot be armed')"
same "the output has its InitValue, once more after the restart, and no more" 2 "$(writes)"
owsctl alarms | sed 's/^/# /'
does "owsctl says so" sh -c "owsctl alarms | grep -q 'cannot be armed: '"
sim set board pin.7 0
does "the inputs are read all the same" within $within_s reads pins 120
kill $owsd
wait $owsd
same "and ends when it is told to" 0 $?
finish
