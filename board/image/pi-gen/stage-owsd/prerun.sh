#!/bin/bash -e
# SPDX-License-Identifier: MIT
if [ ! -d "${ROOTFS_DIR}" ]; then
	copy_previous
fi
