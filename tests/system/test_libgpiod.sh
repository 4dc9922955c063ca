#!/bin/sh
# SPDX-License-Identifier: MIT
# The makefile takes the libgpiod that the compiler sees, whatever a pkg-config says of this machine's
set -eu

unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CFLAGS LDFLAGS EXTRA_CFLAGS CROSS_COMPILE LIBGPIOD
mkdir both lib1 lib2 none
printf '#!/bin/sh\ncase "$*" in *--libs*) echo -lgpiod ;; esac\n' >says-2
printf '#!/bin/sh\ncase "$*" in *--atleast-version*) exit 1 ;; *--libs*) echo -lgpiod ;; esac\n' >says-1
printf '#!/bin/sh\nexit 127\n' >says-nothing
chmod +x says-*
echo 'struct gpiod_chip; void gpiod_chip_close(struct gpiod_chip *chip);' >both/both.h
printf '#include "../both/both.h"\nconst char *gpiod_chip_name(struct gpiod_chip *chip);\n' >lib1/gpiod.h
printf '#include "../both/both.h"\nvoid *gpiod_chip_get_info(struct gpiod_chip *chip);\n' >lib2/gpiod.h
echo '#error none here' >none/gpiod.h
echo 'void gpiod_chip_close(void) {} void gpiod_chip_name(void) {}' >lib1/all.c
echo 'void gpiod_chip_close(void) {} void gpiod_chip_get_info(void) {}' >lib2/all.c
for n in 1 2; do
	gcc -shared -fPIC -nostdlib -o lib$n/libgpiod.so lib$n/all.c
done

# taken DIR PKG_CONFIG: 1, 2 or nothing
taken() {
	make -s -n -p -C "$OWSD_SOURCE" --no-print-directory B="$PWD/out" LIBI2C=0 PKG_CONFIG="$PWD/$2" \
		CC="gcc -I$PWD/$1 -L$PWD/$1" clean 2>/dev/null | sed -n 's/^LIBGPIOD := *//p'
}
for n in 1 2; do
	for says in says-1 says-2 says-nothing; do
		got=$(taken lib$n $says)
		[ "$got" = $n ] || { echo "lib$n with a pkg-config that $says: '$got'" && exit 1; }
	done
done
got=$(taken none says-2)
[ -z "$got" ] || { echo "without a header: '$got'" && exit 1; }
