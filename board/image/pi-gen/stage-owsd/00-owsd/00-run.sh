#!/bin/bash -e
# SPDX-License-Identifier: MIT
# OWSD_DEBS: the folder of our packages (build/deb of this tree); OWSD_W1_GPIO=1: the overlay w1-gpio
image=$(cd ../../.. && pwd)
debs=${OWSD_DEBS:-$image/../../build/deb}

list=$("$image/debs" "$debs" "${ARCH}" "${RELEASE}")
# not /tmp: pi-gen mounts one over it
install -d "${ROOTFS_DIR}/var/cache/owsd"
while read -r deb; do
	install -m 644 "$deb" "${ROOTFS_DIR}/var/cache/owsd/"
done <<<"$list"
on_chroot <<-EOF
	apt-get install -y --no-install-recommends /var/cache/owsd/*.deb
EOF
rm -rf "${ROOTFS_DIR}/var/cache/owsd"

if [ "${OWSD_W1_GPIO:-0}" = 1 ]; then
	"$image/setup" --w1-gpio "${ROOTFS_DIR}"
else
	"$image/setup" "${ROOTFS_DIR}"
fi
