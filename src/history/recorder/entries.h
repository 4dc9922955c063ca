/* SPDX-License-Identifier: MIT */
/* Entries of the two journals of owsd, of alarms and of commands, as events of history. Pure. */
#pragma once

#include "src/history/file/record.h"
#include "src/public/ows.h"

struct history_event entries_alarm(const struct ows_alarm *alarm);
struct history_event entries_command(const struct ows_commanded *command);
