/* SPDX-License-Identifier: MIT */
/* What a quality that is not good means, and what to do. */
#include <stddef.h>

#include "src/ground/signal/quality.h"
#include "src/public/ows.h"

static const struct {
	uint8_t quality;
	const char *cause, *remedy;
} table[] = {
#define QUALITY(code, word, cause, remedy) {OWS_Q_##code, cause, remedy},
#define ERROR(err, word, remedy)
#include "src/ground/signal/words_list.h"
#undef ERROR
#undef QUALITY
};
#define QUALITIES (sizeof(table) / sizeof(table[0]))

static size_t quality_find(uint8_t quality)
{
	size_t i = 0;

	while (i < QUALITIES && table[i].quality != quality)
		i++;
	return i;
}

const char *quality_cause(uint8_t quality)
{
	size_t i = quality_find(quality);

	return i < QUALITIES ? table[i].cause : "";
}

const char *quality_remedy(uint8_t quality)
{
	size_t i = quality_find(quality);

	return i < QUALITIES ? table[i].remedy : "";
}
