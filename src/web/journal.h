/* SPDX-License-Identifier: MIT */
/* api/journal: alarms and commands, newest first, of owsd's memory. */
#ifndef WEB_JOURNAL_H
#define WEB_JOURNAL_H

struct request;

int journal_answer(struct request *request);

#endif
