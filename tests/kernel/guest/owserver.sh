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
			path = $1 in said ? $1 : "/uncached" $1
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
# A walk past owserver's cache looks for the device before each property, and one through a
# thermometer takes seven conversions: only thermometers, whose values its cache mixes, are walked so,
# and those that add nothing are left out.
thermometers='^/uncached/\(10\|22\|28\|3B\|42\)'
more='28.A0B1C20[2-5]\|10.A0B1C20[12]'
{
	grep "$thermometers" /tmp/devices | grep -v "$more"
	grep -v "$thermometers" /tmp/devices | sed 's|^/uncached||'
} >/tmp/walk
owdump $PORT walk $(cat /tmp/walk) >/tmp/theirs
echo /uncached/28.A0B1C2040028/temperature12 | owdump $PORT read >>/tmp/theirs
expected /tmp/theirs
# Only what can only be written, and boards that are not there, have no answer
same "owserver has an answer for every property" "" \
	"$(grep '	ret=' /tmp/theirs | grep -v 'ret=-95\|^/12\.[0-9A-F]*/\(TAI8570\|T8A\|aux\)')"
cut -f 1 /tmp/theirs >/tmp/paths
owdump $PORT write </rig/writes.txt >/tmp/theirs.writes
sed 's/ .*//' /rig/writes.txt | grep '^/' | owdump $PORT read >/tmp/theirs.after
kill $server
wait $server 2>/dev/null
unplug
same "owserver takes every write" "" "$(grep -v 'ret=0$' /tmp/theirs.writes)"

plug house.sim
if ! busdump i2c:/dev/i2c-0 dir /uncached >/tmp/ours.dir 2>/tmp/log/busdump; then
	not_ok "owsd's own bus opens the adapter" "$(tail -n 1 /tmp/log/busdump)"
	finish
fi
ok "owsd's own bus opens the adapter"
same "and finds the same devices" "$(cat /tmp/devices)" \
	"$(sed 's|^|/uncached|' /tmp/ours.dir | devices)"
sed '\|^/uncached|!s|^|/uncached|' /tmp/paths |
	busdump i2c:/dev/i2c-0 read 2>>/tmp/log/busdump | paste /tmp/paths - | cut -f 1,3 >/tmp/ours
awk -v what="read" -f /rig/compare.awk /tmp/theirs /tmp/ours || failed=1
busdump i2c:/dev/i2c-0 write </rig/writes.txt >/tmp/ours.writes 2>>/tmp/log/busdump
awk -v what="write" -f /rig/compare.awk /tmp/theirs.writes /tmp/ours.writes || failed=1
sed 's/ .*//' /rig/writes.txt | grep '^/' |
	busdump i2c:/dev/i2c-0 read >/tmp/ours.after 2>>/tmp/log/busdump
awk -v what="read after write" -f /rig/compare.awk /tmp/theirs.after /tmp/ours.after || failed=1
finish
