# SPDX-License-Identifier: MIT
# The genuine owserver reads what house.sim says; then owsd's own bus, over the same /dev/i2c-0 and
# from the same start, gives the same text for every property, before and after writing.
. /rig/lib.sh

PORT=4304

answers() {
	owdump $PORT dir /uncached | grep -q '^/uncached/[0-9A-F][0-9A-F]\.'
}

devices() {
	grep -o '^/uncached/[0-9A-F][0-9A-F]\.[0-9A-F]*$' | sort
}

# FILE of owdump: is its text of each path in expect.txt the expected one?
expected() {
	awk -v file=$1 '
		FILENAME == file { said[$1] = substr($0, length($1) + 2); next }
		/^#/ || NF == 0 { next }
		{
			path = "/uncached" $1
			want = substr($0, length($1) + 2)
			have = said[path]
			gsub(/^ +/, "", want)
			gsub(/^ +/, "", have)
			gsub(/, +/, ",", have)
			if (have == want)
				print "ok - owserver reads " $1
			else
				print "not ok - owserver reads " $1 ": expected \x27" want \
					"\x27, have \x27" have "\x27"
		}' $1 /rig/expect.txt
}

plug house.sim
owserver --i2c=/dev/i2c-0:ALL -p 127.0.0.1:$PORT --foreground >/tmp/log/owserver 2>&1 &
server=$!
does "owserver serves the simulated network" within 30 answers
owdump $PORT dir /uncached | devices >/tmp/devices
same "and lists every device" "$(grep -c '^DS[0-9A-Z]* *[0-9A-F][0-9A-F]\.' /rig/house.sim)" \
	"$(wc -l </tmp/devices)"
# A walk through a thermometer takes owserver seven conversions: those that add nothing are left out
more='28.A0B1C20[235]\|10.A0B1C20[12]'
owdump $PORT walk $(grep -v "$more" /tmp/devices) >/tmp/theirs
expected /tmp/theirs
# Only what can only be written has no answer
same "owserver has an answer for every property" "" "$(grep '	ret=' /tmp/theirs | grep -v 'ret=-95')"
cut -f 1 /tmp/theirs >/tmp/paths
owdump $PORT write </rig/writes.txt >/tmp/theirs.writes
sed 's/ .*//' /rig/writes.txt | grep '^/' | owdump $PORT read >/tmp/theirs.after
kill $server
wait $server 2>/dev/null
unplug
sleep 1
same "owserver takes every write" "" "$(grep -v 'ret=0$' /tmp/theirs.writes)"

plug house.sim
if ! busdump i2c:/dev/i2c-0 dir /uncached >/tmp/ours.dir 2>/tmp/log/busdump; then
	not_ok "owsd's own bus opens the adapter" "$(tail -n 1 /tmp/log/busdump)"
	finish
fi
ok "owsd's own bus opens the adapter"
same "and finds the same devices" "$(cat /tmp/devices)" \
	"$(sed 's|^|/uncached|' /tmp/ours.dir | devices)"
busdump i2c:/dev/i2c-0 read </tmp/paths >/tmp/ours 2>>/tmp/log/busdump
awk -v what="read" -f /rig/compare.awk /tmp/theirs /tmp/ours || failed=1
busdump i2c:/dev/i2c-0 write </rig/writes.txt >/tmp/ours.writes 2>>/tmp/log/busdump
awk -v what="write" -f /rig/compare.awk /tmp/theirs.writes /tmp/ours.writes || failed=1
sed 's/ .*//' /rig/writes.txt | grep '^/' |
	busdump i2c:/dev/i2c-0 read >/tmp/ours.after 2>>/tmp/log/busdump
awk -v what="read after write" -f /rig/compare.awk /tmp/theirs.after /tmp/ours.after || failed=1
finish
