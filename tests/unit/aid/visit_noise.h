/* SPDX-License-Identifier: MIT */
/* Chips on a wire on which one bit in a thousand is turned over: the truth or an error. */
#pragma once

/* Those of the list, which ends with NULL; one of each name. */
void visit_noise(const char *const *chips);
