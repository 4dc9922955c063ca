/* SPDX-License-Identifier: MIT */
/* A word of a command that somebody may paste into a shell: a file can have any name. Pure. */
#pragma once

#define SHELL_WORD 2048

/*
 * The word as it stands, or, if the shell would take a character of it for its own, in text in
 * single quotes. What does not fit is left out at the end.
 */
const char *shell_word(const char *word, char text[SHELL_WORD]);
