/* SPDX-License-Identifier: MIT */
#pragma once

#include <stdbool.h>

/*
 * May the server's answer to a READ of path be what the idle wire gives for a chip that is away?
 * Then only a search for the device shows that it was there.
 */
bool proof_is_needed(const char *path);
