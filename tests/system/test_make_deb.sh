#!/bin/sh
# SPDX-License-Identifier: MIT
# make deb ARCH=...: the build of another architecture is given all libraries that it needs, and not
# the caller's compiler or flags
set -eu

command -v dpkg-deb >/dev/null || { echo "not a Debian system"; exit 77; }
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES
mkdir tree bin
tree=$PWD/tree
(cd "$OWSD_SOURCE" && cp -r Makefile LICENSE ./*.md board "$tree" &&
	find tests src \( -name '*.mk' -o -name LICENSE \) -exec cp --parents '{}' "$tree" ';')
mkdir -p tree/hal tree/docs tree/src
# Nothing is installed, and the clean system is this one that says what it was given
mv tree/board/install-deps bin
cat >tree/board/install-deps <<END
[ "\$1" != --list ] || exec sh '$PWD/bin/install-deps' "\$@"
END
cat >bin/mmdebstrap <<END
#!/bin/sh
env >'$PWD/environment'
echo "\$@" | tr ' ,=' '\n' >'$PWD/packages'
exit 1
END
chmod +x bin/mmdebstrap
case $(dpkg --print-architecture) in arm64) other=armhf ;; *) other=arm64 ;; esac

if PATH=$PWD/bin:$PATH CC='ccache gcc' CFLAGS=-march=native LDFLAGS=-static LIBGPIOD=0 \
	make -C tree -j2 deb ARCH=$other CXX='ccache g++' B=elsewhere >log 2>&1; then
	echo "a package was built"
	exit 1
fi
[ -s environment ] || { cat log; echo "no clean system was asked for"; exit 1; }
if grep -E '^(CC|CXX|CFLAGS|LDFLAGS|LIBGPIOD|B|MAKEFLAGS|MFLAGS|MAKEOVERRIDES)=' environment; then
	echo "the build is given the above"
	exit 1
fi
for name in $(sed -n 's/^ \(lib[^ ,]*-dev\).*/\1/p' "$OWSD_SOURCE/board/debian/control"); do
	grep -qx "$name:$other" packages || { cat packages; echo "$name is not in the system"; exit 1; }
done
