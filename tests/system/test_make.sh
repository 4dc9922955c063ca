#!/bin/sh
# SPDX-License-Identifier: MIT
# make clean and make uninstall remove what make made and nothing else; odd folders are refused
set -eu

# With a B of the caller make clean would remove what is being tested
unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES B PREFIX DESTDIR LIBDIR MANDIR DATADIR
# The makefile alone: what goes wrong here may not cost the source
copy() {
	mkdir -p "$1/src"
	into=$PWD/$1
	(cd "$OWSD_SOURCE" && find Makefile tests -name Makefile -o -name '*.mk' | xargs -I '{}' cp --parents '{}' "$into")
	echo kept >"$1/src/kept.txt"
}
# refused WORDS MAKE-ARGUMENTS: in the folder $tree
refused() {
	words=$1
	shift
	if make -C "$tree" --no-print-directory "$@" >log 2>&1; then
		echo "make $* is not refused"
		exit 1
	fi
	grep -q "$words" log || { cat log; echo "make $* does not say: $words"; exit 1; }
}
rm -rf tree
copy tree
tree=tree
mkdir -p half half/share/owsd ' led/share/owsd'
for of in half ' led'; do echo kept >"$of/kept.txt"; done

refused 'with a blank' clean B="$PWD/half a folder"
refused 'with a blank' uninstall PREFIX="$PWD/half a folder"
refused 'with a blank' uninstall DESTDIR="$PWD/half a folder"
export PREFIX=' led'
refused 'with a blank' uninstall DESTDIR="$PWD/half"
unset PREFIX
refused 'is empty' clean B=
refused 'is empty' uninstall DESTDIR="$PWD/half" DATADIR=
for b in . .. "$PWD/tree" src ../tree/src; do
	refused 'would remove the source' clean B="$b"
done
[ -s half/kept.txt ] && [ -s ' led/kept.txt' ] && [ -s tree/src/kept.txt ]

copy 'a tree'
tree='a tree'
refused 'with a blank' all

# and ordinary ones are not
mkdir -p tree/build/x out
make -s -C tree --no-print-directory clean
make -s -C tree --no-print-directory clean B="$PWD/out"
[ ! -e tree/build ] && [ ! -e out ] && [ -s tree/src/kept.txt ]

# CROSS_COMPILE has its own tools, whatever the environment says
says() {
	env CC='ccache gcc' CXX='ccache g++' AR=ar OBJCOPY=objcopy \
		make -n -C "$OWSD_SOURCE" --no-print-directory B="$PWD/cross" V=1 LIBI2C=0 LIBGPIOD=0 "$@"
}
says CROSS_COMPILE=other- "$PWD/cross/src/memory/shm/futex.o" "$PWD/cross/libows.a" all >log 2>&1
for tool in gcc ar objcopy; do
	grep -q "^other-$tool " log || { cat log; echo "other-$tool is not called"; exit 1; }
done
if grep -E '^(ccache |gcc |ar |objcopy )|other-(other|ccache)' log; then
	echo "the above is not of CROSS_COMPILE"
	exit 1
fi
says "$PWD/cross/src/memory/shm/futex.o" | grep -q '^ccache gcc '

# Without a compiler it is said what installs one, once and before anything else
for goal in all "$PWD/none/src/memory/shm/futex.o"; do
	if make -C "$OWSD_SOURCE" --no-print-directory B="$PWD/none" CC=no-such-cc LIBI2C=0 LIBGPIOD=0 "$goal" >log 2>&1; then
		echo "make $goal needs no compiler"
		exit 1
	fi
	[ "$(grep -c 'no C compiler no-such-cc: sh board/install-deps build' log)" = 1 ] || { cat log; exit 1; }
	! grep -q 'no-such-cc: not found\|No such file' log || { cat log; exit 1; }
done

# musl-gcc finds the headers of the kernel
if command -v musl-gcc >/dev/null; then
	make -s -C "$OWSD_SOURCE" --no-print-directory B="$PWD/musl" CC=musl-gcc LIBI2C=0 LIBGPIOD=0 \
		"$PWD/musl/src/memory/shm/futex.o"
	[ -s musl/src/memory/shm/futex.o ]
fi

# After minutes of lines the end names what failed, and only then how much
cat >part <<'END'
#!/bin/sh
for goal; do
	case $goal in
	unit) printf 'ok   build/unit/test_a\nFAIL build/unit/test_b: ended with status 139\n3 passed, 1 failed\n' ;;
	system) printf 'FAIL test_c.py (2, 3 s)\nok   test_d.py (1, 1 s)\n5 passed, 1 failed, 2 skipped\n' ;;
	esac
done
exit 1
END
! sh "$OWSD_SOURCE/tests/both" sh part >log || { echo "a failure is none"; exit 1; }
printf 'failed: build/unit/test_b: ended with status 139\nfailed: test_c.py (2, 3 s)\n8 passed, 2 failed, 2 skipped\n' >want
tail -n 3 log | cmp - want
OF=other sh "$OWSD_SOURCE/tests/both" sh part >log || true
if grep -q test_b log; then echo "one that did not run is named"; exit 1; fi
