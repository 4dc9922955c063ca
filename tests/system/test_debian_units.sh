#!/bin/sh
# SPDX-License-Identifier: MIT
# What an installation of a package restarts and starts: each unit once; what a purge takes away
set -eu

units=$PWD/units links=$PWD/etc/systemd/system
mkdir -p bin "$links" "$units/debian/owsd-modbus/usr/lib/systemd/system" run
touch "$units/debian/owsd-modbus/usr/lib/systemd/system/owsd-modbus.service" \
	"$units/debian/owsd-modbus/usr/lib/systemd/system/owsd-modbus@.service"
(cd units && sh "$OWSD_SOURCE/board/debian/units" owsd-modbus)
sed "s,/etc/systemd/system,$links,g; s,/run/systemd/system,$PWD/run,g" \
	units/debian/owsd-modbus.postinst >postinst

# A systemd in which the units of the file "active" are that
cat >bin/systemctl <<'END'
#!/bin/sh
case "$*" in
*list-units*) sed 's/$/ loaded active running x/' active ;;
*is-active*) for unit; do :; done; grep -qx "$unit" active ;;
esac
END
cat >bin/deb-systemd-invoke <<'END'
#!/bin/sh
echo "$@" >>asked
END
chmod +x bin/systemctl bin/deb-systemd-invoke

# restarts WHAT UNIT...: these alone, in any order
restarts() {
	what=$1
	shift
	: >asked
	PATH=$PWD/bin:$PATH sh postinst configure ''
	if [ "$(tr ' ' '\n' <asked | grep -vx restart | sort)" != "$(printf '%s\n' "$@" | sort)" ]; then
		cat asked
		echo "expected of $what: $*"
		exit 1
	fi
}
# enabled TARGET UNIT
enabled() {
	mkdir -p "$links/$1.wants"
	ln -s /nowhere "$links/$1.wants/$2"
}

: >active
restarts 'nothing that is enabled or runs'
enabled multi-user.target owsd-modbus.service
enabled owsd-modbus.service owsd-modbus@OWS.service
restarts 'a first installation' owsd-modbus.service
enabled multi-user.target owsd-modbus@OWS.service
restarts 'one with two links' owsd-modbus.service
enabled multi-user.target owsd-modbus@OLD.service
restarts 'one that is enabled elsewhere' owsd-modbus.service owsd-modbus@OLD.service
printf '%s\n' owsd-modbus.service owsd-modbus@OWS.service owsd-modbus@OLD.service owsd-modbus@HAND.service >active
restarts 'an upgrade' owsd-modbus.service
rm -r "$links"
echo owsd-modbus@HAND.service >active
restarts 'one that was started by hand' owsd-modbus@HAND.service

# A purge of owsd leaves the sockets of owsd-web, which may stay
sed "s,/run/owsd,$PWD/place,g; s,/var/lib/owsd,$PWD/kept,g; s,/etc/owsd,$PWD/own,g" \
	"$OWSD_SOURCE/board/debian/owsd.postrm" >postrm
mkdir place kept own
touch place/OWS.image place/OWS.sock place/OWS.web place/OWS.config kept/OWS.last own/OWS.rio
sh postrm purge
[ "$(echo place/*)" = 'place/OWS.config place/OWS.web' ] && [ ! -e kept ] && [ ! -e own ]
rm place/*
sh postrm purge
[ ! -e place ]
