/* SPDX-License-Identifier: MIT */
/*
 * DS2401, DS1990A, and DS1420, which is that of an iButton for USB (data sheet 19-4890): an id and
 * nothing else.
 */
#include "hal/chips/family.h"

const struct family family_01 = {
	.code = 0x01, .proof = PROOF_NONE_READ, .type = "DS2401", SCAN({"present", "present"})};
const struct family family_81 = {.code = 0x81, .proof = PROOF_NONE_READ, .type = "DS1420"};
