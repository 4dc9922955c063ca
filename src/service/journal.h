/* SPDX-License-Identifier: MIT */
#ifndef SERVICE_JOURNAL_H
#define SERVICE_JOURNAL_H

#include <stdbool.h>

/* Does stderr go to the journal of systemd, which reads levels from "<4>" prefixes? */
bool journal_is_stderr(void);

#endif
