/* SPDX-License-Identifier: MIT */
/* What a person may do: set outputs, acknowledge and shelve alarms. */
#ifndef WEB_COMMAND_H
#define WEB_COMMAND_H

struct request;

int command_set(struct request *request);
int command_alarm(struct request *request);

#endif
