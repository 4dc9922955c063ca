# SPDX-License-Identifier: MIT
# One of each simulated family on one wire, by the genuine owserver and by owsd, each behind the same
# client, over one kept connection, one request at a time: from the start until all are found, the
# listing of all their directories, a read of the properties that owserver lists, one in SHARE of them.
# Each begins with a fresh adapter and fresh chips, and nothing in its caches. Seconds, I2C
# transactions and bytes, and the time that the model's 1-Wire slots took. And the memory of both with
# none, one and all of them on the wire.
. /rig/lib.sh

PORT=4304
# One in so many properties is read
share=$(cat /rig/devices-share)

owwalk sim 100 >/rig/devices.sim
head -n 2 /rig/devices.sim >/rig/none.sim
head -n 3 /rig/devices.sim >/rig/one.sim

# The devices of a scenario. A DS28E18 shows its id only to who has loaded it, which owserver has not.
devices_of() {
	tail -n +3 /rig/$1 | awk '{ print substr($2, 1, 15) }' | grep -v '^56' | sort
}

is_listed() {
	owwalk $PORT dir 2>/tmp/said | sort >/tmp/devices
	grep -v '^56' /tmp/devices >/tmp/found
	cmp -s /tmp/all /tmp/found
}

start() {
	case $1 in
	owsd) owsd -t i2c:/dev/i2c-0 -l $PORT >>/tmp/log/owsd 2>&1 & ;;
	owserver) owserver --i2c=/dev/i2c-0:ALL -p 127.0.0.1:$PORT --foreground >>/tmp/log/owserver 2>&1 & ;;
	esac
	server=$!
}

# SERVER: from its start
find_all() {
	local begun=$(cut -d ' ' -f 1 /proc/uptime)
	start $1
	within 300 is_listed
	echo "$(wc -l </tmp/devices) $(cut -d ' ' -f 1 /proc/uptime)" |
		awk -v begun=$begun '{ print $1, $2 - begun }' >/tmp/said
}

# SERVER WHAT: "COUNT SECONDS" is in /tmp/said, the statistics of before and after in their files, as
# often as there were pieces
tell() {
	awk -v name="devices, $1: $2" '
		/^#/ { said = said $0; next }
		FILENAME ~ /said$/ { count = $1; s = $2; next }
		{ d[$1] += FILENAME ~ /before$/ ? -$2 : $2 }
		END {
			printf "# | %-54s | %7d | %6.2f | %12d | %9d | %7d | %6d |\n", name, count,
				s, d["messages"], d["bytes"], d["wire_us"] / 1000, d["resets"]
			if (said)
				print said
		}' /tmp/said /tmp/before /tmp/after
}

# SERVER WHAT COMMAND...
row() {
	local who=$1 what=$2
	shift 2
	sim stats >/tmp/before
	"$@"
	sim stats >/tmp/after
	tell $who $what
}

# Which board a device is, both have to learn: its directory depends on that
learn() {
	sed 's|.*|/&/type|' /tmp/devices | owwalk $PORT read >/tmp/types 2>/dev/null
}

list() {
	owwalk $PORT list </tmp/devices 2>/tmp/said | sort >$1.paths
}

# SERVER FILE-OF-PATHS: what ends the server is told, and left out; it starts again for the others
read_all() {
	local left=/tmp/left
	cp $2 $left
	: >$1.answers
	: >/tmp/before
	: >/tmp/after
	while [ -s $left ]; do
		sim stats >>/tmp/before
		owwalk $PORT read <$left >/tmp/answers 2>/dev/null
		sim stats >>/tmp/after
		cat /tmp/answers >>$1.answers
		sed -i "1,$(wc -l </tmp/answers)d" $left
		tail -n 1 /tmp/answers | grep -q ' -1000 ' || break
		echo "# $(tail -n 1 /tmp/answers | cut -d ' ' -f 1) ends $who"
		wait $server 2>/dev/null
		start $who
		within 300 is_listed
	done
	awk '$2 >= 0 { n++ } { s += $3 } END { print n + 0, s }' $1.answers >/tmp/said
}

# SERVER HOW-MANY: the pages of its own, which it has written; in the guest's file system all others are
# pages of its files
memory() {
	awk -v name="$1, $2 on the wire" '/^(Anonymous|Rss):/ { kib[$1] += $2 }
		END { printf "# memory | %-30s | %5d | %5d |\n", name, kib["Anonymous:"], kib["Rss:"] }' \
		/proc/$server/smaps_rollup
}

# SERVER SCENARIO
begin() {
	plug $2
	devices_of $2 >/tmp/all
	: >/tmp/found
}

end() {
	kill $server
	wait $server 2>/dev/null
	unplug
}

echo "# | way                                                    |   count | wall s | transactions |" \
	"I2C bytes | wire ms | resets |"
echo "# memory | server and wire | own KiB | resident KiB |"
echo "# one in $share of the properties is read"
for who in owserver owsd; do
	for few in none one; do
		begin $who $few.sim
		find_all $who
		list /tmp/few
		read_all /tmp/few /tmp/few.paths
		memory $who $few
		end
	done
done
for who in owserver owsd; do
	begin $who devices.sim
	row $who scan find_all $who
	same "$who finds one of each" "" "$(diff /tmp/all /tmp/found | grep '^[-+][0-9A-F]')"
	learn
	row $who list list /tmp/$who
	# The ids of a DS28E18 differ
	[ $who = owsd ] || grep -v '^/56' /tmp/owserver.paths | awk "NR % $share == 1 % $share" >/tmp/paths
	read_all /tmp/$who /tmp/paths
	tell $who read
	memory $who all
	end
done
# The time of those that both have read
awk 'FNR == NR { if ($2 >= 0) theirs[$1] = $3; else refused["owserver"]++; next }
	$2 < 0 { refused["owsd"]++ }
	$2 >= 0 && $1 in theirs { both++; us += $3; them += theirs[$1] }
	END {
		printf "# both | %d | %.1f | %.1f | refused by owsd %d, by owserver %d\n", both, us, them,
			refused["owsd"], refused["owserver"]
		print (both ? "ok" : "not ok") " - both have read the same properties: " both + 0
	}' /tmp/owserver.answers /tmp/owsd.answers
finish
