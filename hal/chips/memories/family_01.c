/* SPDX-License-Identifier: MIT */
/* DS2401, DS1990A: an id and nothing else. */
#include "hal/chips/family.h"

const struct family family_01 = {
	.code = 0x01, .proof = PROOF_NONE_READ, .type = "DS2401", SCAN({"present", "present"})};
