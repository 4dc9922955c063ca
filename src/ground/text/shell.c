/* SPDX-License-Identifier: MIT */
/* Puts a word into single quotes, in which a shell takes all but their end as it stands. */
#include "src/ground/text/shell.h"

#include <string.h>

#define PLAIN \
	"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789" \
	"-_.,:/@%+="
#define QUOTE "'\\''" /* the end of the quotes, a quote, and their begin */

const char *shell_word(const char *word, char text[SHELL_WORD])
{
	char *out = text;

	/* zsh takes =WORD for the path of a command */
	if (*word && *word != '=' && !word[strspn(word, PLAIN)])
		return word;
	*out++ = '\'';
	for (; *word && out - text < SHELL_WORD - (int)sizeof(QUOTE) - 1; word++) {
		if (*word == '\'')
			out = stpcpy(out, QUOTE);
		else
			*out++ = *word;
	}
	*out++ = '\'';
	*out = '\0';
	return text;
}
