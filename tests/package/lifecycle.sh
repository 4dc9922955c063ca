#!/bin/sh
# SPDX-License-Identifier: MIT
#
# In a clean Debian without a running systemd: the packages of the apt repository beside this script,
# which is there before and after a release, are installed, each alone and all, used, upgraded while
# they run, removed, installed again and purged. Changes the whole system.
set -u
cd "$(dirname "$0")"
. ./lib.sh
# The runlevel of a system that runs: without one invoke-rc.d starts nothing
export DEBIAN_FRONTEND=noninteractive LC_ALL=C RUNLEVEL=2 PREVLEVEL=N
apt='apt-get -q -y --no-install-recommends -o APT::Sandbox::User=root -o DPkg::Lock::Timeout=60 -o Acquire::Retries=5'
rm -f /usr/sbin/policy-rc.d

# everything DIR: what is on the disk, less what the package system itself remembers
everything() {
	find / -xdev \( -path /proc -o -path /sys -o -path /tmp -o -path /run -o -path "$PWD" -o -path /root \
		-o -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log \
		-o -path /var/lib/systemd \) -prune -o -print | grep -v -x -E \
		'/etc/(passwd|group|shadow|gshadow|subuid|subgid)-?|/etc/ld.so.cache|/etc/\.pwd\.lock' | sort
}
pid() { cat "/run/owsd.OWS.pid" 2>/dev/null; }
mode() { stat -c '%a %U %G' "$1"; }
member() { useradd -M -N -g nogroup ${2:+-G "$2"} "$1"; }
as_user() { user=$1 && shift && setpriv --reuid "$user" --regid nogroup --init-groups "$@"; }
refused() { ! "$@"; }

debs=$(echo after/pool/*/*"$(cat version)"_*.deb)
packages=$(for p in $debs; do dpkg-deb -f "$p" Package; done)
# The libraries first, so that what is compared is ours
libraries=$(for p in $debs; do dpkg-deb -f "$p" Depends; done |
	tr ',' '\n' | sed -n 's/^ *\(lib[a-z0-9.+-]*\|cockpit-bridge\).*/\1/p' | grep -v '^libows\|^libc6$' | sort -u | tr '\n' ' ')
does "what it needs is in the system's archive ($libraries)" \
	sh -c "apt-get -q update && $apt install $libraries"
everything >/tmp/before

# release WHEN: what apt finds from now on
release() {
	ln -s -f -n "$1" released && apt-get -q -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any \
		-o Dir::Etc::sourcelist=sources.list.d/owsd.sources -o Dir::Etc::sourceparts=- -o APT::Get::List-Cleanup=0 update
}
cp before/*.sources /etc/apt/sources.list.d/owsd.sources
does 'apt takes the repository' release before
for p in $packages; do
	does "$p is installed alone" $apt install "$p"
	does 'and purged' $apt purge --autoremove "$p"
done
everything | grep -v -x /etc/apt/sources.list.d/owsd.sources >/tmp/after
same 'nothing stays of any' '' "$(diff /tmp/before /tmp/after)"

# shellcheck disable=SC2086
does 'the packages are installed' $apt install $packages
same 'their user is in the groups that it needs' 'dialout gpio i2c owsd owsd-config owsd-control' \
	"$(id -nG owsd | tr ' ' '\n' | sort | tr '\n' ' ' | sed 's/ $//')"
same 'who cannot log in' /usr/sbin/nologin "$(getent passwd owsd | cut -d: -f7)"
does 'and that it has I2C' sh -c 'owsd --version | grep -q "^ *i2c "'
same 'there is a configuration' '644 root root' "$(mode /etc/owsd/OWS.rio)"
does 'that owsd takes' owsd --check
does 'and serves at once' within 90 service owsd status
does 'a service for systemd is enabled' test -L /etc/systemd/system/owsd.service.wants/owsd@OWS.service

does 'each link of a page leads to a file that is there' python3 - <<'END'
import pathlib, re, sys
pages = list(pathlib.Path("/usr/share/doc/owsd").rglob("*.md"))
missing = [f"{page}: {link}" for page in pages
           for link in re.findall(r"\]\(([^)#:\s]+)[#)]", page.read_text())
           if not (page.parent / link).exists()]
sys.exit(" ".join(missing) if missing or len(pages) < 20 else 0)
END

# shellcheck disable=SC2086
does 'each sbom names the packages of all libraries that are loaded' python3 - $packages <<'END'
import json, pathlib, re, subprocess, sys
def said(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True).stdout
missing, looked = [], 0
for package in sys.argv[1:]:
    bom = json.loads(pathlib.Path(f"/usr/share/doc/{package}/sbom.cdx.json").read_text())
    names = {c["name"] for c in (bom["metadata"]["component"], *bom["components"])}
    for file in map(pathlib.Path, said("dpkg", "-L", package).splitlines()):
        if file.is_symlink() or not file.is_file() or file.read_bytes()[:4] != b"\x7fELF":
            continue
        for library in re.findall(r"(\S+) => /", said("ldd", str(file))):
            looked += 1
            owners = re.findall(r"^([^:]+):", said("dpkg", "-S", "*/" + library), re.M)
            if not names & set(owners):
                missing.append(f"{package}: {library} of {owners}")
sys.exit(" ".join(missing) if missing or looked < 20 else 0)
END

# The devices: a simulated house behind the served protocol
house=/usr/share/doc/owsd-sim/examples/house
does 'owsd itself has no simulator' refused owsd --check -c $house.rio
mkdir /tmp/sim
OWS_DIR=/tmp/sim owsd-sim -n SIM -t sim:$house.sim -l 127.0.0.1:4304 >/tmp/sim/log 2>&1 &
simulator=$!
sed 's/sim:house.sim/localhost:4304/' $house.rio >/etc/owsd/OWS.rio
cp /etc/owsd/OWS.rio /tmp/OWS.rio
does 'a restart takes another configuration' service owsd restart
does 'with values' within 90 owsctl get boiler
same 'it runs as its user' owsd "$(ps -o user= -p "$(pid)" | tr -d ' ')"
same 'who may look is a group' '640 owsd owsd' "$(mode /run/owsd/OWS.image)"
same 'who may act is for owsd to decide' '666 owsd owsd' "$(mode /run/owsd/OWS.control)"
does 'Cockpit has the page' sh -c 'cockpit-bridge --packages | grep -q "^owsd  *1-Wire "'
member looker owsd
member actor owsd,owsd-control
member stranger ''
does 'a member of the first reads' as_user looker owsctl get boiler
does 'but does not set' refused as_user looker owsctl set pump 1
does 'a member of both sets' as_user actor owsctl set pump 1
does 'others do not even read' refused as_user stranger owsctl get boiler
does 'the output is there' within 90 reads pump 1
records() { setpriv --reuid owsd-recorder --regid owsd --init-groups timeout --preserve-status 5 \
	owsd-recorder -d "$1" 2>/tmp/recorder; }
same 'the recorder has a user of its own, who may look' owsd \
	"$(id -nG owsd-recorder | tr ' ' '\n' | grep -x owsd)"
does 'a service of it is enabled' \
	test -L /etc/systemd/system/owsd-recorder.service.wants/owsd-recorder@OWS.service
install -d -o owsd-recorder -g owsd -m 750 /var/lib/owsd-recorder /var/lib/owsd-recorder/OWS
does 'it records' records /var/lib/owsd-recorder/OWS
does 'all signals' grep -q '^recording [0-9]* of [0-9]* signals' /tmp/recorder
same 'into a file for the group' '640 owsd-recorder owsd' \
	"$(mode "$(ls /var/lib/owsd-recorder/OWS/history.sqlite)")"
pushes() { setpriv --reuid owsd-influx --regid owsd --init-groups timeout --preserve-status 5 \
	owsd-influx 2>/tmp/influx; }
same 'owsd-influx has a user of its own, who may look' owsd "$(id -nG owsd-influx | tr ' ' '\n' | grep -x owsd)"
does 'a service of it is enabled' test -L /etc/systemd/system/owsd-influx.service.wants/owsd-influx@OWS.service
does 'it runs' pushes
does 'and pushes nothing, as no server is named' grep -q 'no Influx block: nothing is pushed' /tmp/influx
same 'owsd-writer has a user of its own, who may read' 'owsd owsd-config owsd-writer' \
	"$(id -nG owsd-writer | tr ' ' '\n' | sort | tr '\n' ' ' | sed 's/ $//')"
same 'owsd-mqtt has a user of its own, who may look' owsd "$(id -nG owsd-mqtt | tr ' ' '\n' | grep -x owsd)"
does 'and is off until somebody enables it' refused test -L /etc/systemd/system/owsd-mqtt.service.wants/owsd-mqtt@OWS.service
does 'the page may not write the configuration' refused sh -c 'id -nG owsd-web | grep -q -w owsd-config'
for u in service socket; do
	does "its $u is there" test -e /usr/lib/systemd/system/owsd-writer@.$u
done
does 'and nothing of it is enabled' refused sh -c 'find /etc/systemd/system | grep owsd-writer'
does 'its directory gets its user at the next start' test -e /usr/lib/tmpfiles.d/owsd-web.conf
does 'Python reads it' python3 -c 'import ows
with ows.Ows() as signals:
    assert signals.get("pump").value == 1 and signals.get("pump").good'

before=$(pid)
does 'the next release is there' release after
does 'an upgrade while it runs' $apt upgrade
for p in $packages; do same "$p is the new one" "$(cat version)" "$(dpkg-query -W -f '${Version}' "$p")"; done
version=$(cat version)
same 'owsd says its version' "owsd ${version%+*}" "$(owsd --version | head -n 1)"
does 'starts it anew' within 90 service owsd status
does 'as another process' test "$(pid)" != "$before"
does 'with InitValue, for who commanded has ended' within 90 reads pump 0
does 'and the configuration as it was' cmp /etc/owsd/OWS.rio /tmp/OWS.rio

echo 'OwsDrv { Period wrong }' >/etc/owsd/OWS.rio
newer after/pool/*/owsd_"$version"_*.deb "$version+next" /tmp/next
does 'an upgrade with a broken configuration ends' $apt install /tmp/next/owsd_*.deb
does 'and owsd is not there' refused service owsd status
service owsd start >/tmp/broken 2>&1
does 'but says where it is broken' grep -q '/etc/owsd/OWS.rio:1:' /tmp/broken
cp /tmp/OWS.rio /etc/owsd/OWS.rio
does 'mended, it starts' service owsd start
does 'with values' within 90 owsctl get boiler

does 'the package is removed' $apt remove owsd
does 'nothing runs' refused pgrep -x owsd
does 'the configuration stays' cmp /etc/owsd/OWS.rio /tmp/OWS.rio
does 'the user too' getent passwd owsd
does 'installed again' $apt install owsd
does 'it has values' within 90 owsctl get boiler
rm /etc/owsd/OWS.rio
does 'and again' $apt install --reinstall owsd
does 'a configuration that was deleted stays deleted' test ! -e /etc/owsd/OWS.rio

cp /tmp/OWS.rio /etc/owsd/OWS.rio
cp /tmp/OWS.rio /etc/owsd/HOUSE.rio
service owsd restart
# shellcheck disable=SC2086
does 'all are purged' $apt purge $packages
does 'nothing runs' refused pgrep -x owsd
same 'no segment and no history stays' '' "$(find /run/owsd /var/lib/owsd* 2>/dev/null)"
does 'what its owner has made does' test -e /etc/owsd/HOUSE.rio
rm -r /etc/owsd
kill $simulator
rm /etc/apt/sources.list.d/owsd.sources
everything >/tmp/after
same 'nothing else stays' '' "$(diff /tmp/before /tmp/after)"
