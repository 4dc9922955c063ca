/* SPDX-License-Identifier: MIT */
/*
 * What a program sends to the writer of the configuration: the head of a request. It has one
 * verdict, whatever comes behind it, and what was read can be written and is read as the same.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/rio.h"
#include "src/faces/writer/order.h"
#include "tests/fuzz/fuzz.h"

size_t fuzz_memory(size_t n)
{
	return 60000 + 16 * n;
}

static void check_order(const struct order *order)
{
	TEST_ASSERT_TRUE(order->kind == ORDER_REPLACE || order->kind == ORDER_RESTORE ||
	                 order->kind == ORDER_RENAME);
	TEST_ASSERT_TRUE(order->length <= RIO_FILE_MAX);
	TEST_ASSERT_TRUE(strlen(order->base) == 0 || strlen(order->base) == TAG_TEXT - 1);
	TEST_ASSERT_NOT_NULL(memchr(order->person, '\0', sizeof(order->person)));
	for (const char *at = order->person; *at; at++)
		TEST_ASSERT_TRUE((unsigned char)*at >= ' ' && *at != 0x7f);
}

static void check_again(const struct order *order)
{
	static const char *const kinds[] = {[ORDER_REPLACE] = "replace",
	                                    [ORDER_RESTORE] = "restore",
	                                    [ORDER_RENAME] = "rename"};
	char text[ORDER_HEAD_MAX], base[TAG_TEXT + 8] = "", length[40] = "";
	struct order again;
	const char *why;
	int n;

	if (order->kind != ORDER_RENAME)
		snprintf(base, sizeof(base), "base: %s\n", order->base);
	if (order->kind != ORDER_RESTORE)
		snprintf(length, sizeof(length), "length: %zu\n", order->length);
	n = snprintf(text, sizeof(text), "owsd-writer 1\ndo: %s\n%sfor: %s\n%s\n",
	             kinds[order->kind], base, order->person, length);
	TEST_ASSERT_EQUAL_INT_MESSAGE(n, order_parse(text, (size_t)n, &again, &why), text);
	TEST_ASSERT_EQUAL_INT(order->kind, again.kind);
	TEST_ASSERT_EQUAL_STRING(order->base, again.base);
	TEST_ASSERT_EQUAL_STRING(order->person, again.person);
	TEST_ASSERT_EQUAL_size_t(order->length, again.length);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	const char *text = (const char *)bytes, *why;
	struct order order, before;
	int verdict = order_parse(text, n, &order, &why);

	TEST_ASSERT_TRUE(verdict == 0 || verdict == -EINVAL ||
	                 (verdict > 0 && verdict <= ORDER_HEAD_MAX && (size_t)verdict <= n));
	TEST_ASSERT_EQUAL(verdict == -EINVAL, why != NULL);
	TEST_ASSERT_TRUE(verdict != 0 || n < ORDER_HEAD_MAX);
	for (size_t len = n > 1100 ? n - 1100 : 0; len < n; len++) {
		int early = order_parse(text, len, &before, &why);

		TEST_ASSERT_TRUE_MESSAGE(early == 0 || early == verdict, "another verdict");
	}
	if (verdict <= 0)
		return;
	TEST_ASSERT_EQUAL_MEMORY("\n\n", text + verdict - 2, 2);
	check_order(&order);
	check_again(&order);
}
