/* SPDX-License-Identifier: MIT */
/* owsctl alarms: calls the function of the word that follows, or lists the present alarms. */
#include <string.h>

#include "src/owsctl/alarms_ack.h"
#include "src/owsctl/alarms_history.h"
#include "src/owsctl/alarms_live.h"
#include "src/owsctl/alarms_shelve.h"
#include "src/owsctl/verbs.h"

static const struct {
	const char *word;
	int (*run)(struct ctl *ctl, int argc, char **argv);
} words[] = {{ALARMS_HISTORY, alarms_history},
             {ALARMS_ACK, alarms_ack},
             {ALARMS_SHELVE, alarms_shelve},
             {ALARMS_UNSHELVE, alarms_unshelve}};
#define WORDS (sizeof(words) / sizeof(words[0]))

int verb_alarms(struct ctl *ctl, int argc, char **argv)
{
	for (size_t i = 0; argc > 1 && i < WORDS; i++)
		if (strcmp(argv[1], words[i].word) == 0)
			return words[i].run(ctl, argc - 1, argv + 1);
	return alarms_live(ctl, argc, argv);
}
