# SPDX-License-Identifier: MIT
# Of 50 thermometers the first 1 to 50 read anew, by every way there is: seconds, I2C transactions
# and bytes, and the time that the model's 1-Wire slots took. The temperatures change before each
# row, so that no old value passes.
. /rig/lib.sh

SENSORS=50
COUNTS='1 2 5 10 20 50'
FEW=10
STEADY=30
PORT=4304
W1=/sys/bus/w1/devices
i2c=/sys/bus/i2c/devices/i2c-0
rows=0

# NUMBER ID KERNEL-NAME of each; a chip DS2482-100 at 100 kHz
awk -v n=$SENSORS 'BEGIN {
	for (i = 1; i <= n; i++) {
		x = (i * 2654435) % 16777216
		a = int(x / 65536); b = int(x / 256) % 256; c = x % 256
		printf "%d 28.%02X%02X%02X0000%02X 28-%02x0000%02x%02x%02x\n", i, a, b, c, i, i, c, b, a
	}
}' >/tmp/sensors
{
	echo "i2c speed 100"
	echo "chip DS2482-100 0x18"
	while read -r number id _; do
		echo "DS18B20 $id as t$number temperature 20"
	done </tmp/sensors
} >/rig/bench.sim

# COUNT: other temperatures than before for so many, in steps that 12 bits resolve
change() {
	rows=$((rows + 1))
	head -n $1 /tmp/sensors | awk -v r=$rows '{ print $1, $2, $1 / 2 + r + 0.0625 }' >/tmp/changed
	while read -r number id value; do
		sim set t$number temperature $value || sim set t$number temperature $value
	done </tmp/changed
	cut -d ' ' -f 2- /tmp/changed >/tmp/want
}

uptime_s() {
	cut -d ' ' -f 1 /proc/uptime
}

# NAME SENSORS COMMAND...: the command leaves "ID VALUE" lines in /tmp/have
row() {
	local name=$1 count=$2
	shift 2
	sim stats >/tmp/before
	local begun=$(uptime_s)
	"$@"
	local ended=$(uptime_s)
	sim stats >/tmp/after
	head -n $count /tmp/want >/tmp/wanted
	if cmp -s /tmp/wanted /tmp/have; then
		ok "$name: all values are those of now"
	else
		not_ok "$name: all values are those of now" \
			"$(diff /tmp/wanted /tmp/have | grep -c '^-[^-]') are not"
	fi
	awk -v name="$name" -v count=$count -v s=$begun -v e=$ended '
		NR == FNR { before[$1] = $2; next }
		{ d[$1] = $2 - before[$1] }
		END {
			printf "# | %-54s | %7d | %6.2f | %12d | %9d | %7d | %6d |\n", name, count,
				e - s, d["messages"], d["bytes"], d["wire_us"] / 1000, d["resets"]
		}' /tmp/before /tmp/after >>/tmp/table
}

# From "PATH<tab>VALUE" lines
values() {
	awk -F '\t' '/\t/ { split($1, p, "/"); printf "%s %g\n", p[3], $2 }' >/tmp/have
}

paths() {
	awk -v property=$1 '{ print "/uncached/" $2 "/" property }' /tmp/sensors
}

# --- owsd; waiting for its answers takes none of the guest's one processor
# COUNT
one_round() {
	echo $1 >&3
	awk '/^round$/ { exit } { print }' <&4 | values
}

# From its start on; nothing is known of the wire
from_start() {
	echo | busdump i2c:/dev/i2c-0 rounds $(paths temperature12) 2>/tmp/log/busdump | values
}

# What the one asked for least often waits for a new value. It says in which conversion each began
by_owsd_steady() {
	printf 'round\nsteady %d\n' $STEADY | busdump i2c:/dev/i2c-0 rounds \
		$(paths temperature12) 2>/tmp/log/busdump >/tmp/steady
	local status=$?
	same "owsd, steady: each value is of a conversion of its own" 0 $status
	awk -v count=$SENSORS '/^round$/ { on = 1; next }
		on && $2 > longest { longest = $2 }
		END { printf "# | %-54s | %7d | %6.2f | %12s | %9s | %7s | %6s |\n",
			"owsd direct, steady", count, longest, "", "", "", "" }' \
		/tmp/steady >>/tmp/table
}

by_owsd() {
	mkfifo /tmp/next /tmp/said
	exec 4<>/tmp/said
	busdump i2c:/dev/i2c-0 rounds $(paths temperature12) </tmp/next >&4 2>/tmp/log/busdump &
	local busdump=$!
	exec 3>/tmp/next
	sleep 4
	change $SENSORS
	row "owsd direct, the first scan of all" $SENSORS one_round $SENSORS
	for count in $COUNTS; do
		change $count
		row "owsd direct" $count one_round $count
	done
	exec 3>&- 4>&-
	wait $busdump
	change $SENSORS
	row "owsd direct, from its start to all values" $SENSORS from_start
	by_owsd_steady
}

# All 50 as signals of the daemon, from its start until the last is good
first_good() {
	owsd -c /tmp/bench.rio >/tmp/log/owsd 2>&1 &
	daemon=$!
	names=$(awk '{ print "t" $1 }' /tmp/sensors)
	for try in $(seq 240); do
		owsctl get $names >/dev/null 2>&1 && return
		usleep 500000
	done
}

signals_have() {
	owsctl get $(awk '{ print "t" $1 }' /tmp/sensors) >/tmp/got
	paste -d ' ' /tmp/sensors /tmp/got | awk '{ printf "%s %g\n", $2, $NF }' >/tmp/have
}

by_daemon() {
	{
		echo 'OwsDrv { TargetName "i2c:/dev/i2c-0" MaxRetries 2 Timeout 10 Period 0.1'
		echo "ItemCount $SENSORS"
		awk '{ printf "Item { Name \"t%d\" Path \"/%s/temperature12\" Type \"double\" " \
			"IO \"input\" InitValue \"0\" Uncached \"on\" }\n", $1, $2 }' /tmp/sensors
		echo '}'
	} >/tmp/bench.rio
	change $SENSORS
	row "owsd, the daemon: from its start to all values" $SENSORS daemon_values
	kill $daemon
	wait $daemon 2>/dev/null
}

daemon_values() {
	first_good
	signals_have
}

# --- the genuine owserver
answers() {
	owdump $PORT dir /uncached | grep -q '^/uncached/28'
}

uncached() {
	paths temperature12 | head -n $FEW | owdump $PORT read | values
}

# COUNT
simultaneous() {
	echo "/simultaneous/temperature 1" | owdump $PORT write >/dev/null
	usleep 800000
	paths latesttemp | head -n $1 | owdump $PORT read | values
}

by_owserver() {
	owserver --i2c=/dev/i2c-0:ALL -p 127.0.0.1:$PORT --foreground >/tmp/log/owserver 2>&1 &
	local server=$!
	within 30 answers
	change $FEW
	row "owserver, /uncached temperature12" $FEW uncached
	for count in $COUNTS; do
		change $count
		row "owserver, /simultaneous, 0.8 s, /uncached latesttemp" $count simultaneous $count
	done
	kill $server
	wait $server 2>/dev/null
}

# --- the kernel
all_found() {
	[ "$(ls $W1 | grep -c '^28-')" = $SENSORS ]
}

# COUNT
temperatures() {
	head -n $1 /tmp/sensors >/tmp/first
	cat $(awk -v w1=$W1 '{ print w1 "/" $3 "/temperature" }' /tmp/first) | paste /tmp/first - |
		awk '{ printf "%s %g\n", $2, sprintf("%.4f", $4 / 1000) }' >/tmp/have
}

# COUNT; it gives thousandths, cut off
change_for_kernel() {
	change $1
	sed -i 's/\.\([0-9]\{3\}\)[0-9]*$/.\1/' /tmp/want
}

bulk_done() {
	[ "$(cat $W1/w1_bus_master1/therm_bulk_read)" = 1 ]
}

# COUNT
bulk() {
	echo trigger >$W1/w1_bus_master1/therm_bulk_read
	until bulk_done; do
		usleep 20000
	done
	temperatures $1
}

by_kernel() {
	modprobe wire
	modprobe ds2482
	modprobe w1_therm
	echo ds2482 0x18 >$i2c/new_device
	within 120 all_found
	echo 0 >$W1/w1_bus_master1/w1_master_search
	sleep 2
	for count in $COUNTS; do
		change_for_kernel $count
		row "kernel w1, therm_bulk_read, then each temperature" $count bulk $count
	done
	for count in $COUNTS; do
		change_for_kernel $count
		row "kernel w1, one by one" $count temperatures $count
	done
}

plug bench.sim
by_owsd
by_daemon
by_owserver
by_kernel
echo "# | way                                                    | sensors | wall s | transactions |" \
	"I2C bytes | wire ms | resets |"
echo "# |---|---|---|---|---|---|---|"
cat /tmp/table
echo "# aims for owsd: below 2.56 s and 3000 transactions; owserver's /uncached would take" \
	"$((SENSORS / FEW)) times as much for all $SENSORS"
finish
