/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a logger say what is not true. */
#include "tests/unit/aid/visit_group.h"

#define WRITE(part, name, text) \
	{ \
		.chip = (part), .property = name, .write = (text), .stride = 7 \
	}

static const struct visit writes[] = {
	WRITE("DS1921G", "pages/page.3", "a logger"),
	WRITE("DS1921G", "alarm_trigger", "2"),
	WRITE("DS1921G", "mission/delay", "300"),
	WRITE("DS1921G", "mission/clear", "1"),
	WRITE("DS1921G", "overtemp/temperature", "30"),
	WRITE("DS1921G", "set_alarm/temphigh", "1"),
	WRITE("DS1922L", "pages/page.0", "a logger"),
	WRITE("DS1922L", "clock/running", "0"),
	WRITE("DS1923", "mission/delay", "70000"),
	WRITE("DS1923", "mission/interval", "36000"),
	WRITE("DS1923", "mission/rollover", "1"),
	WRITE("DS1923", "pages/page.15", "a logger"),
	{0},
};

VISIT_GROUP(VISIT_LOGGERS)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_LOGGERS)
	return UNITY_END();
}
