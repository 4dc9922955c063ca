# SPDX-License-Identifier: MIT
# owsd's target w1 over the kernel's own drivers: every property that they offer reads as over
# /dev/i2c-0, what is written arrives in the chips, thermometers convert at once, alarms are told
# from what can be read.
. /rig/lib.sh
. /rig/w1lib.sh

# What the drivers cannot change, and what raw access cannot do without a strong pull-up
CANNOT='set_alarm \|/26\..*\(offset\|page\)\|/14\.'
# In the order of reading: what a conversion leaves behind
LATEST='/\(latesttemp\|scratchpad\)$'
# Adds nothing, and takes time: more thermometers of a kind, other resolutions of all but one, elements
# between the first and the last
MORE='28.A0B1C20[2-5]\|10.A0B1C20[12]'
MORE="$MORE\|/\(2[28].A0B1C2010028\|22.*\|3B.*\|42.*\)/\(temperature1[01]\|temperature9\|fasttemp\)"
MORE="$MORE\|/20.*\.[A-D0-9]$\|/29.*\.[1-6]$\|/23.*\.\([1-9]\|1[0-4]\|ALL\)$"
MORE="$MORE\|/1D.*\(\.A\|ALL\|count.1[2-4]\)$\|/26.*/H[IT].*[35]/\|/2D.*/page.[12]$"
# Holds what was converted last, and the order is free
UNORDERED='/26.*/page.0$'
# The driver has no bulk reading of the eighth, a DS28EA00
THERMOMETERS="28.A0B1C2000028/temperature12 28.A0B1C2010028/temperature12
	28.A0B1C2020028/temperature12 10.A0B1C2000010/temperature 10.A0B1C2010010/temperature
	22.A0B1C2000022/temperature12 3B.A0B1C200003B/temperature12"

begun=$(date +%s)
lap() {
	echo "# $1 after $(($(date +%s) - begun)) s"
}

busdump() {
	/rig/bin/busdump "$@" 2>>/tmp/log/busdump
}

entries() {
	grep '^/[0-9A-F][0-9A-F]\.[0-9A-F]*/[^/]' | grep -v '	ret='
}

# TARGET FILE: what it says to the paths in FILE, all at once but the latest
values() {
	grep -v "$LATEST" $2 >/tmp/first
	echo next | busdump $1 rounds $(cat /tmp/first) | grep -v '^round$'
	# The one that is read at each resolution: which came last, the order of the requests says
	grep '/28.A0B1C2000028/temperature12$' $2 | busdump $1 read >/dev/null
	grep "$LATEST" $2 | busdump $1 read
}

# TARGET NAME: read, write, read; into NAME.read, NAME.writes, NAME.after
exercise() {
	# A DS2450 is not known to have a supply of its own before it is told
	echo "/20.A0B1C2000020/power 1" | busdump $1 write >/dev/null
	values $1 /tmp/paths >/tmp/$2.read
	lap "$1 read"
	busdump $1 write </tmp/writes >/tmp/$2.writes
	values $1 /tmp/written >/tmp/$2.after
}

# WHAT PEER
compare() {
	awk -v what="$1" -v peer=i2c -v ours=w1 -f /rig/compare.awk $2 $3 || failed=1
}

alarms() {
	busdump w1 dir /alarm/$1 | tr '\n' ' '
}

# NAME of one of the simulator's totals
total() {
	sim stats | awk -v what=$1 '$1 == what { print $2 }'
}

plug house.sim
load_drivers
bind 0x18
bind 0x1b
all=$(grep -c '^DS[0-9A-Z]* *[0-9A-F][0-9A-F]\.' /rig/house.sim)
does "the kernel's masters find every device" within 150 all_found $all
search_no_more
lap "found"

busdump w1 dir / >/tmp/root
same "w1 lists the devices" $all "$(grep -c '^/[0-9A-F][0-9A-F]\.[0-9A-F]*$' /tmp/root)"
same "one master alone is a target" /28.A0B1C2030028 \
	"$(busdump w1:w1_bus_master2 dir / | grep '^/[0-9A-F][0-9A-F]\.')"

# --- All thermometers of a wire
mkfifo /tmp/next /tmp/round
exec 4<>/tmp/round
busdump w1:w1_bus_master1 rounds $(printf "/uncached/%s " $THERMOMETERS) </tmp/next >&4 &
rounds=$!
exec 3>/tmp/next
one_round() {
	echo next >&3
	awk '/^round$/ { exit } { print }' <&4
}
one_round >/dev/null
sim set warm temperature 24.5
conversions=$(total conversions) resets=$(total resets)
one_round >/tmp/values
same "all thermometers of a wire convert once" 8 $(($(total conversions) - conversions))
same "by one command, and seven are read" 8 $(($(total resets) - resets))
same "the value is that of now" "        24.5" \
	"$(sed -n 's|^/uncached/28.A0B1C2000028/temperature12	||p' /tmp/values)"
same "none is missing" 0 "$(grep -c ret= /tmp/values)"
exec 3>&- 4>&-
wait $rounds
sim set warm temperature 21.0625
lap "converted"

# --- Every property that the kernel offers
grep '^/[0-9A-F][0-9A-F]\.' /tmp/root | grep -v "$MORE" >/tmp/devices
busdump w1 dir $(cat /tmp/devices) | entries >/tmp/entries
busdump w1 dir $(cat /tmp/entries) | entries >/tmp/below
sed 's|/[^/]*$||' /tmp/below | sort -u >/tmp/directories
grep -v -x -F -f /tmp/directories /tmp/entries | cat - /tmp/below |
	sed 's|^|/uncached|' | grep -v "$UNORDERED" >/tmp/all
sed 's/ .*//' /rig/writes.txt | grep -x -F -f - /tmp/all >/tmp/kept
grep -v "$MORE" /tmp/all | grep -v -x -F -f /tmp/kept | cat - /tmp/kept >/tmp/paths
number=$(wc -l </tmp/paths)
does "more than 200 properties are listed" [ $number -gt 200 ]
grep '^/' /rig/writes.txt | awk '
	NR == FNR { there[$1] = 1; next }
	$1 in there' /tmp/paths - >/tmp/possible
grep -v "$CANNOT" /tmp/possible >/tmp/writes
sed 's/ .*//' /tmp/writes >/tmp/written
exercise w1 w1
lap "$number properties read, $(wc -l </tmp/writes) written"
same "none of them too late" 0 "$(cat /tmp/w1.read /tmp/w1.after | grep -c 'ret=-62$')"
grep "$CANNOT" /tmp/possible | busdump w1 write >/tmp/refused
same "what the drivers cannot write is refused" "" "$(grep 'ret=0$' /tmp/refused)"

# --- Alarms of those that have no latch; w1daemon has one that has
sim set warm temperature 31
same "thermometers beyond their limits are in alarm" \
	"/alarm/28.A0B1C2000028 /alarm/28.A0B1C2010028 /alarm/28.A0B1C2020028 " \
	"$(alarms 28 | tr ' ' '\n' | grep '20[0-2]0028' | sort | tr '\n' ' ')"
sim set warm temperature 21.0625
same "and one between them is not" 0 "$(alarms 28 | grep -c 28.A0B1C2000028)"
same "a DS2406 tells nothing of its alarm" "/alarm/12	ret=-95 " "$(alarms 12)"
lap "alarms"

# --- In the chips themselves
release 0x18
release 0x1b
values i2c:/dev/i2c-0 /tmp/written >/tmp/chips
compare "in the chips after writing" /tmp/chips /tmp/w1.after
lap "compared with the chips"

unplug

# --- The same over i2c, from the same start
plug house.sim
exercise i2c:/dev/i2c-0 i2c
compare read /tmp/i2c.read /tmp/w1.read
compare write /tmp/i2c.writes /tmp/w1.writes
compare "read after write" /tmp/i2c.after /tmp/w1.after
lap "compared"
finish
