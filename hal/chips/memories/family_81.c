/* SPDX-License-Identifier: MIT */
/* DS1420 (data sheet 19-4890): the id of an iButton for USB, and nothing else. */
#include "hal/chips/family.h"

const struct family family_81 = {.code = 0x81, .proof = PROOF_NONE_READ, .type = "DS1420"};
