/* SPDX-License-Identifier: MIT */
/* Entries of the two journals of owsd, of alarms and of commands, as events of history. Pure. */
#pragma once

#include "src/history/record.h"
#include "src/libows/ows.h"

struct history_event entries_alarm(const struct ows_alarm *alarm);
struct history_event entries_command(const struct ows_commanded *command);
