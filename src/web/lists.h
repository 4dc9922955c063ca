/* SPDX-License-Identifier: MIT */
/* What owsd has now besides values: present alarms, targets, counters, the log. */
#ifndef WEB_LISTS_H
#define WEB_LISTS_H

struct request;

int lists_alarms(struct request *request);
int lists_stats(struct request *request);
int lists_log(struct request *request);

#endif
