/* SPDX-License-Identifier: MIT */
/*
 * Server-Sent Events: changes of values, alarms, the loss and return of owsd. The id of an event is
 * the generation of the table and a cursor (recent.h): a browser that comes back with it goes on
 * there.
 */
#pragma once

#include "src/faces/web/http.h"

#define EVENTS_ALIVE_S 15 /* an event at least so often */

int events_answer(struct request *request);
/* Keep an alarm for the streams. */
void events_alarm(struct web *web, const struct ows_alarm *alarm);
/* Alarms were missed: streams that go on from a time before now get an event that says so. */
void events_miss_alarms(struct web *web);
void events_forget_alarms(struct web *web);
