/* SPDX-License-Identifier: MIT */
/* No trouble, no restart and no noise makes a memory say what is not true (visit_group.h). */
#include "tests/unit/aid/visit_group.h"

static const struct visit writes[] = {
	{.chip = "DS2423", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS2430A", .property = "memory", .write = "some bytes", .stride = 3},
	{.chip = "DS2431", .property = "pages/page.1", .write = "123456789", .stride = 3},
	{.chip = "DS2433", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS28EC20", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS1992", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS1963L", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS1963S", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS1977", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS28E04", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS2404", .property = "pages/page.3", .write = "0123456789abcdef", .stride = 3},
	{.chip = "DS2415", .property = "user", .write = "6"},
	{.chip = "DS2890", .property = "wiper", .write = "77"},
	{.chip = "DS2890", .property = "chargepump", .write = "1"},
	{0},
};

VISIT_GROUP(VISIT_MEMORIES)

int main(void)
{
	UNITY_BEGIN();
	VISIT_RUN(VISIT_MEMORIES)
	return UNITY_END();
}
