#!/bin/sh
# SPDX-License-Identifier: MIT
# make install puts everything below DESTDIR, a program builds against it, uninstall removes it all;
# the service is where systemd and udev look, and starts the owsd that was installed with it
set -eu

root=$PWD/root
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES
# What is there is installed, whatever flags it was built with
on_copy() {
	make -s -o "$OWSD_BUILD/with/cc" -o "$OWSD_BUILD/with/ld" -C "$OWSD_SOURCE" --no-print-directory B="$OWSD_BUILD" DESTDIR="$root" PREFIX=/opt/owsd "$@"
}
[ -e "$OWSD_BUILD/libows.so" ] || { echo "libows is not built"; exit 1; }
on_copy install

for f in lib/libows.so lib/libows.so.1 lib/libows.a lib/pkgconfig/libows.pc include/ows.h \
	lib/libows-history.so lib/libows-history.so.1 lib/libows-history.a \
	lib/pkgconfig/libows-history.pc include/ows_history.h \
	include/ows_layout.h share/owsd/boards/raspberry-pi-4.board share/owsd/faces \
	share/owsd/examples/openplc/owsd.cpp share/owsd/examples/linuxcnc/owsd_hal.c; do
	[ -s "$root/opt/owsd/$f" ] || { echo "missing: $f"; exit 1; }
done
if [ -e "$OWSD_BUILD/owsd-web" ]; then
	"$root/opt/owsd/sbin/owsd-web" -V | grep -q '^owsd-web '
	[ ! -e "$OWSD_SOURCE/src/faces/web/page/index.html" ] || [ -s "$root/opt/owsd/share/owsd/web/index.html" ]
fi
if grep -q 'dygraphs yes' "$OWSD_BUILD/with/libraries"; then
	[ -s "$root/opt/owsd/share/owsd/web/dygraph.min.js" ]
	grep -q 'Permission is hereby granted' "$root/opt/owsd/share/owsd/dygraphs.copyright"
fi

# Every manual page has the day of the news, and no other is in the source
day=$(sh "$OWSD_SOURCE/board/make-deb" --day)
dd=$(LC_ALL=C date -u -d "$day" '+%B %-d, %Y')
for page in "$root"/opt/owsd/share/man/man*/*; do
	grep -q "^\.TH [^ ]* [0-9] \"$day\" \|^\.Dd $dd\$" "$page" || { echo "no day $day: $page"; exit 1; }
	head -n 1 "$page" | grep -q SPDX
done
[ "$(SOURCE_DATE_EPOCH=86400 sh "$OWSD_SOURCE/board/make-deb" --day)" = 1970-01-02 ] ||
	! grep -q '^## .*not yet' "$OWSD_SOURCE/NEWS.md" || { echo "the day is not that of the epoch"; exit 1; }

# The page has each file a second time, as a browser takes it
for f in "$root"/opt/owsd/share/owsd/web/*.gz; do
	gzip -dc "$f" | cmp - "${f%.gz}"
	[ ! "${f%.gz}" -nt "$f" ] || { echo "older than what it is made of: $f"; exit 1; }
done
# Cockpit gets the same files; in index.html stands its library in place of the manifest
page=$root/opt/owsd/share/cockpit/owsd
python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$page/manifest.json"
diff -r -q -x "*.gz" "$root/opt/owsd/share/owsd/web" "$page" >differences || true
[ "$(wc -l <differences)" = 2 ] && grep -q 'index.html differ$' differences && grep -q ': manifest.json$' differences
diff "$OWSD_SOURCE/src/faces/web/page/index.html" "$page/index.html" | grep '^[<>]' >differences || true
[ "$(grep -c '^>' differences)" = 1 ] && grep -q '^> <script src="../base1/cockpit.js"></script>$' differences
[ "$(grep -c '^<' differences)" = 1 ] && grep -q '^< <link rel="manifest" ' differences

for face in "$OWSD_BUILD"/owsd-*; do
	[ -x "$root/opt/owsd/sbin/${face##*/}" ] || { echo "missing: ${face##*/}"; exit 1; }
done

# Only ows_* is offered by the one library, and only ows_history_* by the other, in both forms
for library in libows:ows_ libows-history:ows_history_; do
	name=${library%:*}
	nm -D --defined-only "$root/opt/owsd/lib/$name.so.1" | awk 'NF == 3 { sub(/@.*/, "", $3); print $3 }' >dynamic
	nm -g --defined-only "$root/opt/owsd/lib/$name.a" | awk 'NF == 3 { print $3 }' >static
	for list in dynamic static; do
		[ -s $list ]
		if grep -v "^${library#*:}" $list; then
			echo "the $list library $name exports the names above"
			exit 1
		fi
	done
done

# The headers say everything they need, in C11, C17 and C++11
cat >t.c <<'END'
#include <ows.h>
int main(void)
{
	struct ows *h;

	return ows_open("no-such-instance", OWS_READ, &h) == 0;
}
END
cat >h.c <<'END'
#include <ows_history.h>
int main(void)
{
	struct ows_history *h;

	return ows_history_open("no-such-instance", 0, &h) == 0;
}
END
cat >l.c <<'END'
#include <ows_layout.h>
int main(void)
{
	return sizeof(struct ows_record) != 320;
}
END
export PKG_CONFIG_PATH="$root/opt/owsd/lib/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$root"
flags="-Wall -Wextra -Werror ${EXTRA_CFLAGS:-} $(pkg-config --cflags --libs libows)"
for compiler in 'gcc -std=c11 -x c' 'gcc -std=c17 -x c' 'g++ -std=c++11 -x c++'; do
	# shellcheck disable=SC2086
	$compiler t.c -x none -o t $flags
	LD_LIBRARY_PATH=$root/opt/owsd/lib ./t
	# shellcheck disable=SC2086
	$compiler h.c -x none -o h $flags $(pkg-config --cflags --libs libows-history)
	LD_LIBRARY_PATH=$root/opt/owsd/lib ./h
	# shellcheck disable=SC2086
	$compiler l.c -x none -o l $flags
	LD_LIBRARY_PATH=$root/opt/owsd/lib ./l
done

# The data of boards is found beside the program
env -u OWSD_BOARDS "$root/opt/owsd/sbin/owsd" --board=unipi-1.1 >board || [ $? = 1 ]
grep -q 'UniPi 1.1' board

on_copy uninstall
nothing_left() {
	if find "$root" ! -type d | grep .; then
		echo "uninstall left the files above"
		exit 1
	fi
}
nothing_left

for prefix in /usr/local /usr /opt /opt/owsd/ /; do
	case $prefix in
	/usr*) in=$root$prefix/lib ;;
	*) in=$root/etc ;;
	esac
	on_copy install-service PREFIX=$prefix >said
	for f in systemd/system/owsd.service sysusers.d/owsd.conf tmpfiles.d/owsd.conf \
		systemd/system/owsd-web@.socket sysusers.d/owsd-web.conf \
		systemd/system/owsd-writer@.service systemd/system/owsd-writer@.socket \
		sysusers.d/owsd-writer.conf tmpfiles.d/owsd-writer.conf \
		modules-load.d/owsd.conf udev/rules.d/60-owsd.rules; do
		[ -s "$in/$f" ] || { echo "PREFIX=$prefix: missing: $in/$f"; exit 1; }
	done
	# what runs, and devices that are there, know nothing of the new files by themselves
	for command in 'udevadm trigger --action=add --subsystem-match=w1' 'systemctl enable --now owsd ' \
		"systemctl try-restart 'owsd\*'"; do
		grep -q -- "$command" said || { cat said; exit 1; }
	done
	for face in $(awk -F ' *[|] *' '/^owsd/ { print $1 }' "$OWSD_SOURCE/board/faces"); do
		[ "$face" != owsd-writer ] || continue # web brings it
		[ ! -x "$OWSD_BUILD/$face" ] || grep -q "owsctl enable .*\<${face#owsd-}\>" said || { cat said; exit 1; }
	done
	grep -qx "ExecStart=${prefix%/}/sbin/owsd -n %i \$OWSD_OPTIONS" "$in/systemd/system/owsd@.service"
	# the genuine one finds them, and enables the instance that the unit names
	if command -v systemctl >/dev/null; then
		systemctl --root="$root" enable owsd 2>enabled || { cat enabled; exit 1; }
		[ -L "$root/etc/systemd/system/owsd.service.wants/owsd@OWS.service" ]
		systemctl --root="$root" disable owsd 2>/dev/null
		# as owsctl enable and doctor do it: one instance alone starts with the machine
		for unit in "$in"/systemd/system/owsd*@.service; do
			unit=$(basename "$unit" @.service)
			[ "$unit" != owsd-writer ] || continue # its socket starts it
			systemctl --root="$root" enable "$unit@HOUSE" 2>enabled || { cat enabled; exit 1; }
			find "$root/etc/systemd/system" -path "*/multi-user.target.wants/$unit@HOUSE.service" | grep -q . ||
				{ echo "$unit@HOUSE does not start with the machine"; exit 1; }
			systemctl --root="$root" disable "$unit@HOUSE" 2>/dev/null
		done
	fi
	if command -v systemd-sysusers >/dev/null; then
		systemd-sysusers --root="$root" --cat-config | grep -q '^u owsd '
		systemd-tmpfiles --root="$root" --cat-config | grep -q '^d /run/owsd 0755 owsd owsd'
		systemd-tmpfiles --root="$root" --cat-config | grep -q '^d /etc/owsd 0755 owsd-writer root'
	fi
	on_copy uninstall-service PREFIX=$prefix
	rm "$root/etc/owsd/OWS.rio"
	nothing_left
done
for prefix in opt '' '/opt/%h' '/opt/a,b' /home/plc/.local /root /tmp/owsd; do
	if on_copy install-service PREFIX="$prefix" >said 2>&1; then
		echo "install-service: PREFIX=$prefix is not refused"
		exit 1
	fi
	grep -q "install-service: PREFIX is '$prefix'" said || { cat said; exit 1; }
	nothing_left
done
