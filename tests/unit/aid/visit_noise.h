/* SPDX-License-Identifier: MIT */
/* Chips on a wire on which one bit in a thousand is turned over: the truth or an error. */
#ifndef TESTS_UNIT_AID_VISIT_NOISE_H
#define TESTS_UNIT_AID_VISIT_NOISE_H

/* Those of the list, which ends with NULL; one of each name. */
void visit_noise(const char *const *chips);

#endif
