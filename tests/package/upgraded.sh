# SPDX-License-Identifier: MIT
#
# A part of booted.sh: all packages of an earlier commit, in was/, run and keep a history. By the apt
# repository in released/ they become those of today, which run in their place and go on with that
# history. All are purged then.
old=$(for p in was/*.deb; do dpkg-deb -f "$p" Package; done)
running=$(for p in $packages; do echo "$old" | grep -x "$p"; done)
history=/var/lib/owsd-recorder/OWS/history.sqlite

# kept: times and values of the boiler in the history, oldest first
kept() {
	python3 -c 'import sqlite3, sys
for row in sqlite3.connect(f"file:{sys.argv[1]}?mode=ro", uri=True).execute(
        "select time, value from trend where name = ? and quality = ? order by time", ("boiler", "good")):
    print(*row)' $history
}
# keeps LINES: there are as many. The recorder writes them when it ends
keeps() {
	sleep 2 # pace
	systemctl restart owsd-recorder@OWS.service && [ "$(kept | wc -l)" -ge "$1" ]
}
# then_units PACKAGE: what was enabled of it. The writer had another name
then_units() { units "$1" | sed 's/owsd-writer/owsd-config/'; }

does 'then: all are installed' dpkg -i was/*.deb
cp /usr/sbin/owsd-sim /tmp/simulator
house=/usr/share/doc/owsd-sim/examples/house
mkdir /tmp/house
OWS_DIR=/tmp/house /tmp/simulator -n SIM -t sim:$house.sim -l 127.0.0.1:4304 >/tmp/house/log 2>&1 &
simulator=$!
sed 's,sim:house.sim,localhost:4304,; s,^}$,  Web {\n    Listen "127.0.0.1:8080"\n  }\n},' \
	$house.rio >/etc/owsd/OWS.rio
cp /etc/owsd/OWS.rio /etc/owsd/HOUSE.rio
cp /etc/owsd/OWS.rio /tmp/house/OWS.rio
systemctl restart owsd
for p in $running; do
	# shellcheck disable=SC2046 # units are words
	does "then: all of $p is enabled" systemctl enable --now $(then_units "$p")
	for u in $(then_units "$p"); do does "then: $u runs" within 20 serving "$u"; done
done
does 'then: it has values' within 60 owsctl get boiler
does 'then: and keeps them' within 60 keeps 3
kept >/tmp/house/kept

apt='apt-get -q -y -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any'
cp released/*.sources /etc/apt/sources.list.d/owsd.sources
does 'apt takes the repository of today' $apt -o Dir::Etc::sourcelist=sources.list.d/owsd.sources \
	-o Dir::Etc::sourceparts=- update
# At a question of dpkg it would find no answer, and fail
does 'all become those of today' $apt upgrade
for p in $old; do
	same "$p is the new one" "$(dpkg-deb -f ./owsd_*.deb Version)" "$(dpkg-query -W -f '${Version}' "$p")"
done
takes 'from then to today' $running
same 'nothing runs of the writer of then' '' \
	"$(systemctl list-units --all --no-legend --plain 'owsd-config*'; programs | grep owsd-config)"
same 'no file of dpkg waits for an answer' '' "$(find /etc -name '*.dpkg-*' -o -name '*.ucf-*')"
same 'no file of a configuration is left behind' '' \
	"$(dpkg-query -W -f '${Conffiles}\n' $old | grep obsolete)"
does 'the configuration is as it was' cmp /etc/owsd/OWS.rio /tmp/house/OWS.rio
does 'owsd takes it' owsd --check
does 'it has values again' within 60 owsctl get boiler
does 'and keeps them' within 60 keeps $(($(wc -l </tmp/house/kept) + 3))
same 'behind the history of then' "$(cat /tmp/house/kept)" "$(kept | head -n "$(wc -l </tmp/house/kept)")"
same 'which owsctl shows' "$(awk '{ print $2 + 0 }' /tmp/house/kept)" "$(owsctl trend --csv boiler |
	awk -F , '$4 == "\"good\"" { print $3 + 0 }' | head -n "$(wc -l </tmp/house/kept)")"

does 'all are purged' dpkg -P $old
gone 'from then to today, purged' $running
same 'nothing is enabled' '' "$(links)"
kill $simulator
rm -r /etc/owsd /etc/apt/sources.list.d/owsd.sources
